# SPDX-License-Identifier: BSD-3-Clause
"""Measures what Python adds to the time of C++. Not a test: machines are shared.

    overhead.py [DATA_FOLDER]

DATA_FOLDER has the public scenes (doc/data.md). Without it a generated cloth is measured.
Each row has the least processor time of many runs in milliseconds; Python and C++ take
turns.
FCL_CCD_PYTHON_REFERENCE names the program fcl_ccd_python_reference.
"""

import sys
import time
from pathlib import Path

import numpy as np
import reference
from scenes import crumpled

import fcl_ccd

TURNS, REPEATS = 6, 8
NUM_DIFFERENT, TIMES = 100_000, 10  # a million queries


def read_ply(path):
    """Vertices and triangles of a binary big-endian PLY file of floats."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    sizes = [int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element")]
    vertices = np.frombuffer(body, ">f4", 3 * sizes[0]).reshape(-1, 3).astype(float)
    face = np.dtype([("count", "u1"), ("ids", ">i4", 3)])
    faces = np.frombuffer(body, face, sizes[1], offset=12 * sizes[0])
    return vertices, faces["ids"].astype(int)


def least_time(call, repeats):
    least = float("inf")
    for _ in range(repeats):
        start = time.process_time()
        call()
        least = min(least, time.process_time() - start)
    return least


def compare(name, command, call):
    """Runs both in turn, so that a busy machine slows both."""
    cpp = python = float("inf")
    for _ in range(TURNS):
        cpp = min(cpp, float.fromhex(reference.run([command])[0][0][0]))
        python = min(python, least_time(call, REPEATS))
    print(f"{name}: C++ {1e3 * cpp:.2f} ms, Python {1e3 * python:.2f} ms, {python / cpp:.3f}")


def main():
    if len(sys.argv) > 1:
        folder = Path(sys.argv[1]) / "scenes" / "cloth-ball"
        (previous, triangles), (current, _) = read_ply(folder / "92.ply"), read_ply(folder / "93.ply")
    else:
        previous, current, triangles = crumpled(100)
    mesh = fcl_ccd.DeformableMesh(previous, triangles)

    def step(**options):
        mesh.update(previous, current)
        return fcl_ccd.self_collide(mesh, **options)

    arrays = reference.deformable(previous, current, triangles).split(" ", 1)[1]
    for options in ({}, {"query": "first"}):
        name = f"step of {len(triangles)} triangles, {len(step(**options).contacts)} contacts"
        command = f"time_step {REPEATS} {arrays} {reference.request(**options)}"
        compare(name, command, lambda options=options: step(**options))

    t0, t1 = np.random.default_rng(1).normal(size=(2, NUM_DIFFERENT, 4, 3))
    points = reference._text(np.concatenate([t0, t1], axis=1))
    command = f"time_vf {REPEATS} {NUM_DIFFERENT} {TIMES} {points}"
    t0, t1 = np.tile(t0, (TIMES, 1, 1)), np.tile(t1, (TIMES, 1, 1))
    compare(f"vertex_face of {len(t0)} queries", command, lambda: fcl_ccd.vertex_face(t0, t1))


if __name__ == "__main__":
    main()
