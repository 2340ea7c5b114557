# SPDX-License-Identifier: BSD-3-Clause
"""A picture of the contacts of a cloth with itself.

    python3 contact_picture.py [PICTURE.png]

Two frames of a cloth that folds. The program prints the contacts and draws them on the
mesh at t = 1: vertex-face contacts in red, edge-edge contacts in blue. It needs matplotlib.
"""

import sys

import matplotlib
import numpy as np

import fcl_ccd

matplotlib.use("Agg")  # a file, no window
import matplotlib.pyplot as plt  # noqa: E402


def sheet(n):
    """A square sheet of n x n vertices: vertices (n * n, 3) and triangles (m, 3)."""
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(n * n)], axis=1)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    lower = np.stack([corner, corner + n, corner + n + 1], axis=1)
    upper = np.stack([corner, corner + n + 1, corner + 1], axis=1)
    return vertices, np.concatenate([lower, upper])


def fold(vertices, angle):
    """Rolls the half x > 0 of the sheet by an angle, with a small wave along y."""
    out = vertices.copy()
    right = vertices[:, 0] > 0
    x, y = vertices[right, 0], vertices[right, 1]
    radius = 0.12 + 0.01 * np.cos(7 * y)
    turn = np.minimum(x / radius, angle)
    rest = x - turn * radius  # what is straight after the bend
    out[right, 0] = radius * np.sin(turn) + rest * np.cos(turn)
    out[right, 2] = radius * (1 - np.cos(turn)) + rest * np.sin(turn)
    return out


def draw(vertices, triangles, contacts, path):
    figure = plt.figure(figsize=(7, 5))
    axes = figure.add_subplot(projection="3d")
    axes.plot_trisurf(
        *vertices.T, triangles=triangles, color="lightgrey", edgecolor="grey", linewidth=0.2, alpha=0.5
    )
    for kind, colour in ((fcl_ccd.Kind.EDGE_EDGE, "blue"), (fcl_ccd.Kind.VERTEX_FACE, "red")):
        of = contacts[contacts["kind"] == kind]
        label = f"{kind.name.lower().replace('_', '-')}: {len(of)}"
        axes.scatter(*of["pos"].T, color=colour, s=1, label=label, depthshade=False)
    axes.legend(markerscale=5)
    axes.set_box_aspect(np.ptp(vertices, axis=0))
    axes.view_init(elev=20, azim=-70)
    figure.savefig(path, dpi=120)
    plt.close(figure)


def largest_error(contacts, previous, current):
    """How far a contact's position is from its vertex on the way, for VF contacts."""
    of = contacts[contacts["kind"] == fcl_ccd.Kind.VERTEX_FACE]
    vertex, t = of["vertices"][:, 0], of["toc_lo"][:, None]
    return np.abs((1 - t) * previous[vertex] + t * current[vertex] - of["pos"]).max()


def main():
    path = sys.argv[1] if len(sys.argv) > 1 else "contacts.png"
    rest, triangles = sheet(60)
    previous, current = fold(rest, 0.95 * np.pi), fold(rest, 1.2 * np.pi)

    cloth = fcl_ccd.DeformableMesh(rest, triangles)
    cloth.update(previous, current)
    result = fcl_ccd.self_collide(cloth)

    print(result)
    draw(current, triangles, result.contacts, path)
    print(f"{path}: the cloth at t = 1, with a point for each contact")
    assert result.is_collide and not result.initially_crossing
    assert largest_error(result.contacts, previous, current) < 1e-9


if __name__ == "__main__":
    main()
