# SPDX-License-Identifier: BSD-3-Clause
"""Half turns go the way of FCL's motions, which the last rounding of the poses decides.

The reference is integrate() of FCL's ScrewMotion and InterpMotion.
"""

import math

import numpy as np
from reference import poses, run
from scenes import pose

import fcl_ccd

AXES = np.eye(3)
# A corner at (1, 0, 0), so that a turn about the axis z moves it.
TIP = np.array([(1.01, 0, 0), (0.99, 0.01, 0), (0.99, -0.01, 0), (1, 0, 0.01)])
FACES = [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)]
# What is added to 180 degrees: 0, and 1e-16 to 1e-3 of both signs.
OFFSETS = [0.0] + [sign * 10.0**-k for k in range(16, 2, -1) for sign in (1, -1)]
PER_CIRCLE = 48  # 7.5 degrees
EACH = 37  # of all poses; it has no divisor in common with the other counts


def grid_pose(i):
    """Roll, pitch and yaw in steps of 7.5 degrees."""
    step = 2 * math.pi / PER_CIRCLE
    roll, pitch, yaw = (step * (i // PER_CIRCLE**k % PER_CIRCLE) for k in range(3))
    return pose(axis=AXES[2], angle=yaw) @ pose(axis=AXES[1], angle=pitch) @ pose(axis=AXES[0], angle=roll)


def half_turned(begin, axis, offset):
    """The pose after about half a turn about an axis of the body."""
    if offset == 0:  # Rounding has no part in this product.
        return begin @ np.diag([*(2 * AXES[axis] - 1), 1])
    return begin @ pose(axis=AXES[axis], angle=math.pi + offset)


def steps():
    """The axis, the offset, and both poses."""
    for n, i in enumerate(range(0, PER_CIRCLE**3, EACH)):
        axis, offset = n // len(OFFSETS) % 3, OFFSETS[n % len(OFFSETS)]
        begin = grid_pose(i)
        yield axis, offset, begin, half_turned(begin, axis, offset)


def side_of(halfway, begin, axis):
    """The way of a turn: 1 if the body turns by a positive angle about its own axis."""
    start = begin[:3, (axis + 1) % 3]
    return np.sign(np.dot(np.cross(start, halfway[:3, (axis + 1) % 3]), begin[:3, axis]))


def test_the_way_round():
    ball, sides = fcl_ccd.Sphere(0.05), set()
    meshes = [fcl_ccd.RigidMesh(np.roll(TIP, axis + 1, axis=1), FACES) for axis in range(3)]
    all_steps = list(steps())
    halfways = run([f"halfway {poses(begin, end)}" for _, _, begin, end in all_steps])
    assert len(halfways) == len(all_steps) > 2900
    for (axis, offset, begin, end), lines in zip(all_steps, halfways):
        of_screw, of_turn = (
            np.array([float.fromhex(word) for word in line]).reshape(4, 4) for line in lines
        )
        sides.add((axis, offset, side_of(of_screw, begin, axis)))
        for halfway, motion in (
            (of_screw, fcl_ccd.ScrewMotion(begin, end)),
            (of_turn, fcl_ccd.LinearMotion(begin, end)),
            (of_screw, (begin, end)),
        ):
            on_the_way = halfway[:3, (axis + 1) % 3]
            for center in (on_the_way, -on_the_way):
                at = pose(center)
                result = fcl_ccd.collide(meshes[axis], ball, motion, (at, at))
                assert result.is_collide == (center is on_the_way), (axis, offset, begin)
                if result.is_collide:
                    assert 0.45 < result.time_of_contact < 0.5
    # Rounding decides where the turn is exact, the offset where it is large.
    for axis in range(3):
        assert {(axis, 0.0, -1.0), (axis, 0.0, 1.0)} <= sides
        for offset in (1e-3, -1e-3):
            assert {side for a, o, side in sides if (a, o) == (axis, offset)} == {-np.sign(offset)}
