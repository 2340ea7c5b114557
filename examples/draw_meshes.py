#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws OBJ meshes beside each other, seen from one side: draw_meshes.py PICTURE.png MESH.obj ...

For the frames that the examples with engines write: triangles only. All are drawn in the frame
of the last one. It needs matplotlib.
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from mpl_toolkits.mplot3d.art3d import Poly3DCollection


def read(path):
    """The triangles of a mesh, each as three places."""
    vertices, triangles = [], []
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            vertices.append([float(x) for x in rest])
        elif word == "f":
            triangles.append([vertices[int(x) - 1] for x in rest])
    return triangles


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    picture, *paths = sys.argv[1:]
    figure = plt.figure(figsize=(4.8 * len(paths), 3.2))
    meshes = [read(path) for path in paths]
    # All in the same frame, which the last one fills.
    places = [place for triangle in meshes[-1] for place in triangle]
    low_high = [(min(p[k] for p in places) - 0.05, max(p[k] for p in places) + 0.05) for k in range(3)]
    for i, path in enumerate(paths):
        axes = figure.add_subplot(1, len(paths), i + 1, projection="3d")
        axes.add_collection3d(
            Poly3DCollection(
                meshes[i],
                facecolors="#2a9d8f70",  # seen through: large triangles hide nothing
                edgecolors="#1d3557",
                linewidths=0.15,
                clip_on=False,
            )
        )
        axes.set(xlim=low_high[0], ylim=low_high[1], zlim=low_high[2])
        axes.set_title(Path(path).stem.replace("_", " "))
        axes.set_box_aspect([high - low for low, high in low_high], zoom=1.5)
        axes.view_init(elev=10, azim=-55)
        axes.set_axis_off()
    figure.subplots_adjust(left=0, right=1, bottom=0, top=0.92, wspace=0)
    figure.savefig(picture, dpi=100)


if __name__ == "__main__":
    main()
