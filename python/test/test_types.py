# SPDX-License-Identifier: BSD-3-Clause
"""The types of the package, by mypy."""

import os
import subprocess
import sys
from pathlib import Path

from scenes import require

import fcl_ccd


def test_types(tmp_path):
    """The package and the examples' calls are typed; a wrong call is found."""
    require("mypy")
    program = tmp_path / "program.py"
    program.write_text(
        """
import numpy as np
import fcl_ccd

class Trimesh:
    vertices, faces = np.zeros((3, 3)), np.array([(0, 1, 2)])

class Open3d:
    vertices, triangles = [(0.0, 0.0, 0.0)], [(0, 1, 2)]

mesh = fcl_ccd.DeformableMesh(np.zeros((3, 3)), [(0, 1, 2)])
mesh.update(np.ones((3, 3)))
time: float = fcl_ccd.collide(mesh, mesh, np.eye(4), (np.eye(4), np.eye(4))).time_of_contact
done: bool = fcl_ccd.self_candidates(mesh, lambda block: None)
number: int = fcl_ccd.self_candidates(mesh).size
first = fcl_ccd.collide(mesh, mesh, query="first")
fcl_ccd.DeformableMesh(Trimesh()).update(Open3d())
fcl_ccd.collide(fcl_ccd.RigidMesh(Open3d()), Open3d())
fcl_ccd.collide(fcl_ccd.RigidMesh(Trimesh()), Trimesh())
fcl_ccd.DeformableMesh.from_trimesh(Trimesh()).update(Trimesh())
first.show(0.5, contact=None, file="first.png")
fcl_ccd.self_collide(3)
fcl_ccd.self_collide(mesh, query="last")
fcl_ccd.CollisionManager().collide(query="last")
""",
        encoding="utf-8",
    )
    package = Path(fcl_ccd.__file__).parent
    strict = ["--strict", "--no-error-summary", "--cache-dir", os.devnull]
    found = subprocess.run(
        [sys.executable, "-m", "mypy", *strict, package, program],
        capture_output=True,
        text=True,
        check=False,
        cwd=package.parent,
    )
    of_mesh, *of_queries = [line for line in found.stdout.splitlines() if ": error: " in line]
    assert "program.py:22:" in of_mesh and 'incompatible type "int"' in of_mesh, found.stdout
    for line, error in zip((23, 24), of_queries):
        assert f"program.py:{line}:" in error and "Literal['last']" in error, found.stdout
    assert len(of_queries) == 2, found.stdout


def test_stubs_are_those_of_the_compiled_part():
    require("mypy")
    found = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "fcl_ccd._core"],
        capture_output=True,
        text=True,
        check=False,
        cwd=Path(fcl_ccd.__file__).parent.parent,
    )
    assert found.returncode == 0, found.stdout + found.stderr
