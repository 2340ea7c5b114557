#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes frames to try the program with: make_frames.py FOLDER

A wrinkled cloth of 3,200 triangles falls on a ball in one step. Then:

    fcl-ccd run FOLDER/cloth_0.obj FOLDER/cloth_1.obj --against FOLDER/ball.obj --report report
"""

import argparse
import math
from pathlib import Path

N = 41  # vertices along a side of the cloth
RINGS, SECTORS = 24, 48  # of the ball
RADIUS = 0.5


def grid(rows, columns):
    """The triangles between rows of vertices."""
    for i in range(rows - 1):
        for j in range(columns - 1):
            a = i * columns + j
            yield a, a + columns, a + columns + 1
            yield a, a + columns + 1, a + 1


def cloth(x, y, is_end):
    wrinkle = math.cos(5 * x + 1) * math.cos(4 * y)
    if not is_end:
        return x, y, 0.62 + 0.024 * wrinkle
    square = x * x + y * y
    narrow = 1 - 0.1 * square
    return narrow * x, narrow * y, 0.36 - 0.38 * square + 0.04 * wrinkle


def ball():
    """Its poles are on the y axis. They are closed with fans."""
    vertices = [(0, RADIUS, 0), (0, -RADIUS, 0)]
    for i in range(1, RINGS):
        for j in range(SECTORS):
            a, b = math.pi * i / RINGS, 2 * math.pi * j / SECTORS
            ring = RADIUS * math.sin(a)
            vertices.append((ring * math.sin(b), RADIUS * math.cos(a), ring * math.cos(b)))

    def at(i, j):
        return 2 + (i - 1) * SECTORS + j % SECTORS

    triangles = []
    for j in range(SECTORS):
        triangles += [(0, at(1, j), at(1, j + 1)), (1, at(RINGS - 1, j + 1), at(RINGS - 1, j))]
        for i in range(1, RINGS - 1):
            corners = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            triangles += [corners[:3], (corners[0], *corners[2:])]
    return vertices, triangles


def write(path, vertices, triangles):
    lines = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in triangles]
    path.write_text("".join(lines), encoding="ascii")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="made if it is missing")
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    places = [(2 * i / (N - 1) - 1, 2 * j / (N - 1) - 1) for i in range(N) for j in range(N)]
    for frame in (0, 1):
        vertices = [cloth(x, y, frame == 1) for x, y in places]
        write(folder / f"cloth_{frame}.obj", vertices, list(grid(N, N)))
    write(folder / "ball.obj", *ball())


if __name__ == "__main__":
    main()
