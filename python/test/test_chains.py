# SPDX-License-Identifier: BSD-3-Clause
"""Links of a robot: the same answers as in C++, and known times."""

import math
import threading

import numpy as np
import pytest
import reference
from scenes import crumpled, pose, sphere

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(8)
BALL = sphere(6, 8, 0.3)
JOINTS = (
    ("revolute", (0, 0, 0.2), (0.1, 0.2, 0.3), (0, 0, 2), -1),
    ("prismatic", (0.3, 0, 0), (0, 0, 0), (1, 1, 0), 0),
    ("fixed", (0, 0.1, 0), (0, 1, 0), (1, 0, 0), 1),
    ("revolute", (0.2, 0, 0), (1, 0, 0), (0, 1, 0.5), 0),
    ("fixed", (0, 0, 0.3), (0, 0, 1), (1, 0, 0), 3),
)


def robot():
    chain = fcl_ccd.JointChain()
    for kind, xyz, rpy, axis, parent in JOINTS:
        origin = fcl_ccd.urdf_origin(xyz, rpy)
        if kind == "fixed":
            chain.add_fixed(origin, parent)
        else:
            getattr(chain, f"add_{kind}")(origin, axis, parent)
    return chain


def command(kind, values, base, link):
    words = [kind, str(len(JOINTS))]
    for joint, xyz, rpy, axis, parent in JOINTS:
        origin = fcl_ccd.urdf_origin(xyz, rpy)
        words += [joint, reference._text(origin), reference._text(np.array(axis, float)), str(parent)]
    for of in values:
        words += [str(len(of)), reference._text(np.array(of, float))]
    return " ".join([*words, reference._text(base), str(link)])


def test_as_in_cpp():
    """Each link, with values that are linear and polynomials, beside a cloth and a box."""
    box_command, box = reference.shape("Box", 0.6, 0.6, 0.5)
    cloth, ball = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES), fcl_ccd.RigidMesh(*BALL)
    cloth.update(CURRENT)
    commands = [reference.deformable(PREVIOUS, CURRENT, TRIANGLES), reference.rigid(*BALL), box_command]
    base = fcl_ccd.urdf_origin((0.4, 0.4, 0.1), (0.1, 0.2, 0.3))
    linear = [(0.1, 7.0), (-0.3, 0.4), (0.5, -1.0)]
    curved = [(0.1, 2.0, -1.0), (0.2,), (0.0, 0.1, 0.2, -0.7)]
    begin, end = zip(*linear)
    motions = (
        ("link", linear, fcl_ccd.ChainMotion(robot(), begin, end, base)),
        ("polynomial", curved, fcl_ccd.ChainMotion.polynomial(robot(), curved, base)),
    )
    still = f"translation {reference.poses(np.eye(4), np.eye(4))}"
    asked = []
    for kind, values, motion in motions:
        for link in range(len(JOINTS)):
            moves = command(kind, values, base, link)
            for i, o in ((0, cloth), (2, box)):
                commands.append(f"motions {i} 1 {still} {moves} {reference.request(query='first')}")
                asked.append((o, ball, None, motion.link(link)))
    collided = 0
    for arguments, lines in zip(asked, reference.run(commands)[3:]):
        result = fcl_ccd.collide(*arguments, query="first")
        reference.require_same(result, lines)
        collided += result.is_collide
    assert collided >= 5


def test_twists_as_in_cpp():
    box_command, box = reference.shape("Box", 0.6, 0.6, 0.5)
    ball = fcl_ccd.RigidMesh(*BALL)
    commands = [box_command, reference.rigid(*BALL)]
    still = f"translation {reference.poses(np.eye(4), np.eye(4))}"
    begin = fcl_ccd.urdf_origin((1, 0, 0.1), (0.1, 0.2, 0.3))
    linear, angular, about = (0.2, 0.1, -0.1), (0.5, 1.0, 9.0), (-1.0, 0.1, 0.2)
    motions = []
    for path in ("screw", "straight"):
        numbers = " ".join(reference._text(np.asarray(x)) for x in (begin, linear, angular, about))
        moves = f"twist {numbers} {int(path == 'screw')}"
        commands.append(f"motions 0 1 {still} {moves} {reference.request(query='first')}")
        motions.append(fcl_ccd.TwistMotion(begin, linear, angular, path, about))
    collided = 0
    for motion, lines in zip(motions, reference.run(commands)[2:]):
        result = fcl_ccd.collide(box, ball, None, motion, query="first")
        reference.require_same(result, lines)
        collided += result.is_collide
    assert collided
    with pytest.raises(ValueError, match="path is 'round'. Give 'screw' or 'straight'"):
        fcl_ccd.TwistMotion(begin, linear, angular, "round")
    with pytest.raises(ValueError, match="radians"):
        fcl_ccd.TwistMotion(begin, linear, (1e7, 0, 0))


def test_waypoints_as_in_cpp():
    box_command, box = reference.shape("Box", 0.6, 0.6, 0.5)
    ball = fcl_ccd.RigidMesh(*BALL)
    poses = [
        fcl_ccd.urdf_origin(xyz, rpy)
        for xyz, rpy in (
            ((1, 0, 0.1), (0.1, 0.2, 0.3)),
            ((1, 0, 0.1), (0.1, 0.2, 0.3)),
            ((0.9, 0.9, 0), (1, 2, 0.3)),
            ((0.1, 0.2, 0.7), (1, 2.5, -0.3)),
        )
    ]
    times = np.array([0, 0.2, 0.5, 1])
    moves = f"waypoints 4 {reference._text(np.array(poses))} {reference._text(times)}"
    still = f"translation {reference.poses(np.eye(4), np.eye(4))}"
    asks = f"motions 0 1 {still} {moves} {reference.request(query='first')}"
    lines = reference.run([box_command, reference.rigid(*BALL), asks])[2]
    motion = fcl_ccd.WaypointMotion(poses, times)
    result = fcl_ccd.collide(box, ball, None, motion, query="first")
    reference.require_same(result, lines)
    assert 0.2 < result.time_of_contact < 1


@pytest.mark.parametrize(
    "poses, times, text",
    [
        ([np.eye(4)], [0], "it has 1 pose"),
        ([np.eye(4)] * 2, [0, 0.5, 1], "2 poses have 3 times"),
        ([np.eye(4)] * 3, [0, 0.5, 0.5], "ascend"),
        ([np.eye(4)] * 2, [0, 0.5], "from 0 to 1"),
        ([np.eye(4)] * 2, [0, math.nan], "times has a number that is not finite"),
        ([np.eye(4), np.diag([2, 2, 2, 1])], [0, 1], "pose 1"),
        (np.eye(4), [0, 1], "shape"),
    ],
)
def test_wrong_waypoints(poses, times, text):
    with pytest.raises(ValueError, match=text):
        fcl_ccd.WaypointMotion(poses, times)


def test_known_time():
    """A ball at the end of an arm goes round 2.5 times, and meets one on its way."""
    chain = fcl_ccd.JointChain()
    arm = chain.add_revolute(axis=(0, 0, 1))
    tool = chain.add_fixed(fcl_ccd.urdf_origin((1, 0, 0)))
    assert (arm, tool, chain.num_links, chain.num_values) == (0, 1, 2, 1)
    ball, other = fcl_ccd.Sphere(0.25), fcl_ccd.Sphere(0.25)
    motion = fcl_ccd.ChainMotion(chain, [0], [5 * math.pi])
    place = pose((math.cos(5), math.sin(5), 0))  # after 5 radians
    time = (5 - 2 * math.asin(0.25)) / (5 * math.pi)
    first = {"query": "first", "toc_err": 1e-9}
    found = fcl_ccd.collide(ball, other, motion.link(tool), place, **first).time_of_contact
    assert time - 2e-9 <= found <= time
    manager = fcl_ccd.CollisionManager()
    manager.register("ball", ball, motion.link(tool))
    manager.register("other", other, place)
    (pair,) = manager.collide(**first).pairs
    assert pair.result.time_of_contact == found
    # Threads may share a motion.
    times = []

    def asks():
        for _ in range(20):
            result = fcl_ccd.collide(ball, other, motion.link(tool), place, **first)
            times.append(result.time_of_contact)

    threads = [threading.Thread(target=asks) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert times == 60 * [found]


@pytest.mark.parametrize(
    "call, text",
    [
        (lambda chain: chain.add_revolute(axis=(0, 0, 0)), "axis is zero"),
        (lambda chain: chain.add_revolute(np.diag([2, 2, 2, 1])), "more than 2"),
        (lambda chain: chain.add_prismatic(axis=(0, math.nan, 0)), "axis has a number that is not finite"),
        (lambda chain: chain.add_fixed(parent=7), "parent is 7"),
        (lambda chain: chain.add_fixed(parent=-2), "parent is -2"),
        (lambda chain: fcl_ccd.ChainMotion(chain, [0], [1, 2]), "end has 2 values"),
        (lambda chain: fcl_ccd.ChainMotion(chain, [0, 1], [1]), "begin has 2 values"),
        (lambda chain: fcl_ccd.ChainMotion(chain, [0], [math.inf]), "not finite"),
        (lambda chain: fcl_ccd.ChainMotion(chain, [0], [1e7]), "radians"),
        (lambda chain: fcl_ccd.ChainMotion.polynomial(chain, [[1e6, -2e6, 1e6]]), "coefficients"),
        (lambda chain: fcl_ccd.ChainMotion(chain, [[0]], [1]), "shape"),
        (lambda chain: fcl_ccd.ChainMotion(chain, [0], [1], np.zeros((4, 4))), "base"),
        (lambda chain: fcl_ccd.ChainMotion(fcl_ccd.JointChain(), [], []), "no joints"),
        (lambda chain: fcl_ccd.ChainMotion.polynomial(chain, [[]]), "0 coefficients"),
        (lambda chain: fcl_ccd.ChainMotion.polynomial(chain, [[1], [2]]), "has 2 values"),
        (lambda chain: fcl_ccd.ChainMotion(chain, [0], [1]).link(1), "no link 1"),
        (lambda chain: fcl_ccd.urdf_origin((0, 0, math.nan)), "xyz"),
    ],
)
def test_wrong_chains(call, text):
    chain = fcl_ccd.JointChain()
    chain.add_revolute()
    with pytest.raises(ValueError, match=text):
        call(chain)
    assert (chain.num_links, chain.num_values) == (1, 1)
