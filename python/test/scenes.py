# SPDX-License-Identifier: BSD-3-Clause
"""Meshes and poses of the tests, and what a test may need."""

import importlib.util
import os

import numpy as np
import pytest


def require(*modules):
    """Skips a test for which a package is missing, but not in CI."""
    missing = [name for name in modules if importlib.util.find_spec(name) is None]
    if not missing:
        return
    message = f"missing: {', '.join(missing)} (cmake/dependencies.sh has the packages)"
    if os.environ.get("CI") == "true":
        pytest.fail(message)
    pytest.skip(message)


def grid(n, size=1.0):
    """A square of n x n vertices in the plane z = 0: vertices and triangles."""
    x, y = np.meshgrid(np.linspace(0, size, n), np.linspace(0, size, n), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(n * n)], axis=1)
    first = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    triangles = np.concatenate(
        [
            np.stack([first, first + n, first + n + 1], axis=1),
            np.stack([first, first + n + 1, first + 1], axis=1),
        ]
    )
    return vertices, triangles


def sphere(rings, segments, radius=1.0):
    """A closed sphere about the origin."""
    theta = np.pi * np.arange(1, rings) / rings
    phi = 2 * np.pi * np.arange(segments) / segments
    body = np.stack(
        [
            np.outer(np.sin(theta), np.cos(phi)),
            np.outer(np.sin(theta), np.sin(phi)),
            np.outer(np.cos(theta), np.ones(segments)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    vertices = radius * np.concatenate([[(0, 0, 1)], body, [(0, 0, -1)]])
    last = len(vertices) - 1
    triangles = []
    for s in range(segments):
        t = (s + 1) % segments
        triangles.append((0, 1 + s, 1 + t))
        for r in range(rings - 2):
            a, b = 1 + r * segments + s, 1 + r * segments + t
            triangles += [(a, a + segments, b + segments), (a, b + segments, b)]
        triangles.append((last, last - segments + t, last - segments + s))
    return vertices, np.array(triangles)


def crumpled(n, seed=1):
    """Two frames of a cloth with many contacts with itself, and its triangles."""
    random = np.random.default_rng(seed)
    vertices, triangles = grid(n)
    frames = []
    for fold in (0.2, 0.5):
        x = vertices.copy()
        x[:, 2] = fold * np.sin(9 * vertices[:, 0]) * np.cos(7 * vertices[:, 1])
        x[:, 0] += fold * np.cos(11 * vertices[:, 0])
        frames.append(x + random.normal(scale=0.3 / n, size=x.shape))
    return frames[0], frames[1], triangles


def rotation(axis, angle):
    """The matrix of a rotation, by Rodrigues' formula."""
    a = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def pose(translation=(0, 0, 0), axis=(0, 0, 1), angle=0.0):
    out = np.eye(4)
    out[:3, :3] = rotation(axis, angle)
    out[:3, 3] = translation
    return out
