# SPDX-License-Identifier: BSD-3-Clause
"""A planner whose edges are proved free of contact.

    python3 planner.py

A long bar has to pass a window in a wall. A planner grows a tree of poses. Before it adds
an edge it must know whether the bar can move along it. With FCL's Python binding such a
check reads

    request = fcl.ContinuousCollisionRequest(...)
    toc = fcl.continuousCollide(fcl.CollisionObject(bar, tf1), tf2,
                                fcl.CollisionObject(wall, tf), tf, request, result)

which samples the motion and can miss a contact between the samples. Here it is is_free().
"""

import numpy as np

import fcl_ccd

BOX = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
BOX_TRIANGLES = np.array(
    [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    + [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
)


def boxes(*centres_and_halves):
    """One mesh of several boxes."""
    vertices = [np.array(half) * BOX + centre for centre, half in centres_and_halves]
    triangles = [BOX_TRIANGLES + 8 * i for i in range(len(vertices))]
    return fcl_ccd.RigidMesh(np.concatenate(vertices), np.concatenate(triangles))


BAR = boxes(((0, 0, 0), (1.0, 0.1, 0.1)))
# A wall in the plane x = 0 with a window of 0.8 x 0.8.
WALL = boxes(
    ((0, -1.7, 0), (0.1, 1.3, 3)),
    ((0, 1.7, 0), (0.1, 1.3, 3)),
    ((0, 0, -1.7), (0.1, 0.4, 1.3)),
    ((0, 0, 1.7), (0.1, 0.4, 1.3)),
)


def pose(state):
    """A state is x, y, z and the angle about z; a pose is a 4x4 array."""
    c, s = np.cos(state[3]), np.sin(state[3])
    return np.array(
        [[c, -s, 0, state[0]], [s, c, 0, state[1]], [0, 0, 1, state[2]], [0, 0, 0, 1]]
    )


def is_free(begin, end):
    """Whether the bar touches the wall nowhere on its way from one state to another."""
    motion = pose(begin), pose(end)
    return not fcl_ccd.collide(BAR, WALL, motion, query="any", enable_contact=False)


def plan(start, goal, random, most=5000):
    """Grows a tree (RRT) from the start until an edge reaches the goal."""
    states, parents = [start], [-1]
    low, high = np.array([-2, -1, -1, -np.pi / 2]), np.array([2, 1, 1, np.pi / 2])
    for i in range(most):
        target = goal if i % 10 == 0 else random.uniform(low, high)
        nearest = int(np.argmin(np.linalg.norm(np.array(states) - target, axis=1)))
        way = target - states[nearest]
        length = np.linalg.norm(way)
        state = states[nearest] + way * min(1, 0.8 / length)
        if not is_free(states[nearest], state):
            continue
        states.append(state)
        parents.append(nearest)
        if np.array_equal(state, goal):
            path = [len(states) - 1]
            while parents[path[-1]] >= 0:
                path.append(parents[path[-1]])
            return [states[k] for k in reversed(path)]
    return None


def main():
    start, goal = np.array([-1.8, 0, 0, np.pi / 2]), np.array([1.8, 0, 0, np.pi / 2])
    straight = fcl_ccd.collide(BAR, WALL, (pose(start), pose(goal)), query="first")
    first = straight.contacts[0]
    print(f"Straight ahead the bar hits the wall at {straight.time_of_contact:.4f} of the way,")
    print(f"in the point {first['pos'].round(3)}")

    path = plan(start, goal, np.random.default_rng(2))
    assert path is not None
    print(f"A path of {len(path) - 1} edges, each free of contact:")
    for state in path:
        print("  x {:5.2f}  y {:5.2f}  z {:5.2f}  angle {:5.2f}".format(*state))
    # The bar's end is at x = -1.8 + 0.1 + 3.6 t and meets the wall's face, x = -0.1.
    assert abs(straight.time_of_contact - 1.6 / 3.6) < 1e-4
    assert all(is_free(a, b) for a, b in zip(path, path[1:]))


if __name__ == "__main__":
    main()
