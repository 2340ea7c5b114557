# SPDX-License-Identifier: BSD-3-Clause
"""Contacts as tables of pandas."""

import subprocess
import sys

import numpy as np
import pytest
from scenes import crumpled, require

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(7)
PLACES = [f"{name}_{axis}" for name in ("pos", "normal") for axis in "xyz"]


def mesh():
    made = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    made.update(CURRENT)
    return made


def test_contacts():
    require("pandas")
    result = fcl_ccd.self_collide(mesh())
    contacts, frame = result.contacts, result.to_dataframe()
    assert len(frame) == len(contacts) > 10
    for name in ("kind", "b1", "b2", "first_on_o1", "within_tolerance", "toc_lo", "toc_hi"):
        np.testing.assert_array_equal(frame[name], contacts[name])
        assert frame[name].dtype == contacts[name].dtype
    np.testing.assert_array_equal(frame[PLACES[:3]], contacts["pos"])
    np.testing.assert_array_equal(frame[PLACES[3:]], contacts["normal"])
    np.testing.assert_array_equal(frame[[f"vertices_{i}" for i in range(5)]], contacts["vertices"])
    np.testing.assert_array_equal(frame["penetration_depth"], contacts["penetration_depth"])
    for name in ("part1", "part2"):
        assert (frame[name] == -1).all()
    assert frame.shape[1] == 7 + 6 + 1 + 2 + 5
    faces = frame[frame["kind"] == fcl_ccd.Kind.VERTEX_FACE]
    assert 0 < len(faces) < len(frame)
    some = fcl_ccd.to_dataframe(contacts[::2])
    np.testing.assert_array_equal(some["pos_y"], contacts["pos"][::2, 1])
    frame.loc[0, "pos_x"] = 17.0  # a table of its own
    assert contacts["pos"][0, 0] != 17


def test_no_contacts():
    require("pandas")
    result = fcl_ccd.collide(mesh(), fcl_ccd.Sphere(1e-3), None, np.eye(4) + np.eye(4, k=3) * 9)
    assert list(result.to_dataframe().columns)[:3] == ["kind", "b1", "b2"]
    assert len(result.to_dataframe()) == 0


def test_other_records():
    require("pandas")
    candidates = fcl_ccd.self_candidates(mesh())
    frame = fcl_ccd.to_dataframe(candidates)
    assert list(frame.columns[2:6]) == [f"vertices_{i}" for i in range(4)]
    octree = fcl_ccd.OcTree(PREVIOUS, 0.1)
    cells = octree.cells(fcl_ccd.collide(mesh(), octree).contacts["b2"])
    assert list(fcl_ccd.to_dataframe(cells).columns) == ["center_x", "center_y", "center_z", "size"]
    t = np.zeros((3, 4, 3))
    assert len(fcl_ccd.to_dataframe(fcl_ccd.vertex_face(t, t))) == 3


def test_managers():
    require("pandas")
    manager = fcl_ccd.CollisionManager()
    manager.register("cloth", mesh(), self_collision=True)
    manager.register(("ball", 7), fcl_ccd.Sphere(0.3))
    result = manager.collide()
    frame = result.to_dataframe()
    assert list(frame.columns[:3]) == ["o1", "o2", "kind"]
    assert len(frame) == sum(len(pair.result.contacts) for pair in result.pairs)
    rows = 0
    for pair in result.pairs:
        (o1, o2), contacts = (pair.o1, pair.o2), pair.result.contacts
        part = frame[[(a, b) == (o1, o2) for a, b in zip(frame["o1"], frame["o2"])]]
        np.testing.assert_array_equal(part["toc_lo"], contacts["toc_lo"])
        rows += len(part)
    assert rows == len(frame) and len(result.pairs) == 2
    empty = fcl_ccd.CollisionManager().collide().to_dataframe()
    assert len(empty) == 0 and list(empty.columns[:3]) == ["o1", "o2", "kind"]


@pytest.mark.parametrize("wrong", [[1, 2], np.zeros(3), fcl_ccd.collide(mesh(), mesh())])
def test_what_has_no_columns(wrong):
    with pytest.raises(TypeError, match=r"to_dataframe\(\): records is of type .* Give a structured"):
        fcl_ccd.to_dataframe(wrong)


def test_without_pandas():
    """The package works, and the function says what it needs."""
    code = """
import sys
sys.modules["pandas"] = None
import numpy as np, fcl_ccd
mesh = fcl_ccd.RigidMesh(np.eye(3), [(0, 1, 2)])
try:
    fcl_ccd.collide(mesh, mesh).to_dataframe()
except ImportError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, check=True)
    assert done.stdout.startswith("to_dataframe() needs pandas") and "python3-pandas" in done.stdout
