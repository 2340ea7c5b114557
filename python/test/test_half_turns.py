# SPDX-License-Identifier: BSD-3-Clause
"""Half turns go the way of FCL's constructors, which rounding decides."""

import math

import numpy as np
from scenes import pose

import fcl_ccd

TIP = np.array([(1.01, 0, 0), (0.99, 0.01, 0), (0.99, -0.01, 0), (1, 0, 0.01)])
FACES = [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)]


def grid_pose(roll, pitch, yaw):
    return pose((0, 0, 0), (0, 0, 1), yaw) @ pose((0, 0, 0), (0, 1, 0), pitch) @ pose((0, 0, 0), (1, 0, 0), roll)


def is_backward(begin, end):
    """Whether FCL turns about the axis -z of the body, by the quaternion of R2 R1^T."""
    m = [[0.0] * 3 for _ in range(3)]
    for i in range(3):
        for j in range(3):
            a, b, c = (end[i, n] * begin[j, n] for n in range(3))
            # Eigen computes the first two rows as vectors, the last one by itself.
            m[i][j] = (a + b) + c if i < 2 else a + (b + c)
    trace = m[0][0] + m[1][1] + m[2][2]
    assert trace < 0
    i = 1 if m[1][1] > m[0][0] else 0
    if m[2][2] > m[i][i]:
        i = 2
    j, k = (i + 1) % 3, (i + 2) % 3
    vector = [0.0, 0.0, 0.0]
    vector[i] = 1 + m[i][i] - m[j][j] - m[k][k]
    vector[j] = m[j][i] + m[i][j]
    vector[k] = m[k][i] + m[i][k]
    along = np.dot(vector, begin[:3, 2])
    return (along < 0) != (m[k][j] - m[j][k] < 0)


def test_the_way_round():
    mesh, ball = fcl_ccd.RigidMesh(TIP, FACES), fcl_ccd.Sphere(0.05)
    step, ways = math.radians(45), set()
    for i in range(8**3):
        begin = grid_pose(i % 8 * step, i // 8 % 8 * step, i // 64 * step)
        end = begin @ np.diag([-1.0, -1, 1, 1])
        backward = is_backward(begin, end)
        ways.add(backward)
        on_the_way = begin[:3, 1] * (-1 if backward else 1)
        for motion in (fcl_ccd.ScrewMotion(begin, end), fcl_ccd.LinearMotion(begin, end), (begin, end)):
            for center in (on_the_way, -on_the_way):
                at = pose(center)
                result = fcl_ccd.collide(mesh, ball, motion, (at, at))
                assert result.is_collide == (center is on_the_way), i
                if result.is_collide:
                    assert 0.45 < result.time_of_contact < 0.5
    assert ways == {False, True}
