# SPDX-License-Identifier: BSD-3-Clause
"""A cloth falls on a ball, step by step, and passes through neither the ball nor itself.

    python3 falling_cloth.py [STEPS]

Each step moves the vertices freely, asks for all contacts of this motion, takes the
approaching velocity away from the features in contact, and asks again until no contact is
left. What still touches after some rounds stays where it was, so that the loop ends.
"""

import sys

import numpy as np

import fcl_ccd

N = 25  # vertices in a row
STEP = 0.01  # s
GRAVITY = np.array([0, 0, -9.81])  # m/s^2
ROUNDS = 20


def sheet(n):
    """A sheet of 1 m x 1 m: vertices, triangles, and pairs of vertices that are springs."""
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, n), np.linspace(-0.5, 0.5, n), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), np.full(n * n, 0.45)], axis=1)
    ids = np.arange(n * n).reshape(n, n)
    a, b, c, d = (part.ravel() for part in (ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    rows = np.stack([ids[:-1].ravel(), ids[1:].ravel()], axis=1)
    columns = np.stack([ids[:, :-1].ravel(), ids[:, 1:].ravel()], axis=1)
    diagonals = np.concatenate([np.stack([a, c], axis=1), np.stack([b, d], axis=1)])
    return vertices, triangles, np.concatenate([rows, columns, diagonals])


def ball(n, radius):
    """A sphere about the origin, from a cube of n x n squares a side."""
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + n + 1, corner + n + 2], axis=1),
            np.stack([corner, corner + n + 2, corner + 1], axis=1),
        ]
    )
    vertices, triangles = [], []
    for axis in range(3):
        for sign in (-1, 1):
            side = np.roll(np.stack([np.full(x.size, sign), x.ravel(), sign * y.ravel()], 1), axis, 1)
            triangles.append(faces + sum(map(len, vertices)))
            vertices.append(radius * side / np.linalg.norm(side, axis=1, keepdims=True))
    return fcl_ccd.RigidMesh(np.concatenate(vertices), np.concatenate(triangles))


def move_freely(x, velocity, springs, lengths):
    """The next positions under gravity, with springs made to fit (position based dynamics)."""
    x_next = x + STEP * (velocity + STEP * GRAVITY)
    a, b = springs.T
    share = np.bincount(springs.ravel(), minlength=len(x))[:, None]
    for _ in range(15):
        way = x_next[b] - x_next[a]
        length = np.linalg.norm(way, axis=1)
        correction = (0.5 * (1 - lengths / length))[:, None] * way
        moved = np.zeros_like(x)
        np.add.at(moved, a, correction)
        np.add.at(moved, b, -correction)
        x_next += 1.5 * moved / share
    return x_next


def push_apart(x, x_next, contacts, against_itself):
    """Takes the approaching motion from the vertices in contact. Returns which they are."""
    vertex_face = contacts["kind"] == fcl_ccd.Kind.VERTEX_FACE
    is_first = np.arange(4) < np.where(vertex_face, 1, 2)[:, None]
    # The normal points from o1 to o2, here from the cloth to the ball. In a contact of the
    # cloth with itself it points from the first feature to the second.
    along_normal = is_first if against_itself else is_first == contacts["first_on_o1"][:, None]
    sides = [(along_normal, 1)] + ([(~along_normal, -1)] if against_itself else [])
    ids, normal = contacts["vertices"][:, :4], contacts["normal"]
    change, count = np.zeros_like(x), np.zeros(len(x))
    involved = np.zeros(len(x), bool)
    for side, sign in sides:
        row, column = np.nonzero(side)
        vertex, direction = ids[row, column], sign * normal[row]
        approach = np.einsum("ij,ij->i", (x_next - x)[vertex], direction)
        approaching = approach > 0
        np.add.at(change, vertex, -1.05 * (approach * approaching)[:, None] * direction)
        np.add.at(count, vertex, approaching)
        involved[vertex] = True
    x_next += change / np.maximum(count, 1)[:, None]
    return involved


def step(cloth, body, x, velocity, springs, lengths):
    """One step without contact: the new positions, and how many contacts were solved."""
    x_next = move_freely(x, velocity, springs, lengths)
    solved, stays = 0, np.zeros(len(x), bool)
    while True:
        cloth.update(x, x_next)
        pairs = [(fcl_ccd.self_collide(cloth), True), (fcl_ccd.collide(cloth, body), False)]
        if not any(result for result, _ in pairs):
            return x_next, solved
        solved += 1
        for result, against_itself in pairs:
            assert not result.initially_crossing
            involved = push_apart(x, x_next, result.contacts, against_itself)
            if solved > ROUNDS:
                stays |= involved
        x_next[stays] = x[stays]


def main():
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    x, triangles, springs = sheet(N)
    cloth, body = fcl_ccd.DeformableMesh(x, triangles), ball(12, 0.3)
    lengths = np.linalg.norm(x[springs[:, 0]] - x[springs[:, 1]], axis=1)
    velocity, touched = np.zeros_like(x), 0
    for i in range(steps):
        x_next, rounds = step(cloth, body, x, velocity, springs, lengths)
        velocity, x = 0.99 * (x_next - x) / STEP, x_next
        touched += rounds > 0
        if i % 10 == 9:
            print(f"step {i + 1}: rounds {rounds}, height {x[:, 2].min():.3f} to {x[:, 2].max():.3f} m")
    print(f"{touched} of {steps} steps had contacts. None was left.")
    # The cloth lies on the ball: nothing is below the top of it there, and nothing is inside.
    near = np.linalg.norm(x[:, :2], axis=1) < 0.05
    assert touched > 0 and 0.29 < x[near, 2].min() < 0.35
    assert np.linalg.norm(x, axis=1).min() > 0.295


if __name__ == "__main__":
    main()
