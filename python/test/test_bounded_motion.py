# SPDX-License-Identifier: BSD-3-Clause
"""Motions of the user: answers equal those in C++ to the bit, and known ones; wrong functions."""

import gc
import math
import sys
import threading

import numpy as np
import pytest
import reference
from scenes import crumpled, grid, pose, sphere

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(8)
BALL = sphere(6, 8, 0.3)


def swing(a, b):
    """Swings about z by the angle a sin(t), and falls by b t^2: the class of reference.cpp."""

    def pose_at(t):
        angle = a * math.sin(t)
        c, s = math.cos(angle), math.sin(angle)
        return [[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, -b * t * t], [0, 0, 0, 1]]

    def rate_at(t):
        angle, speed = a * math.sin(t), a * math.cos(t)
        c, s = speed * math.cos(angle), speed * math.sin(angle)
        return [[-s, -c, 0, 0], [c, -s, 0, 0], [0, 0, 0, -2 * b * t], [0, 0, 0, 0]]

    def acceleration(center, radius, t0, t1):
        assert 0 <= t0 <= t1 <= 1
        x, y, z = center
        return (a + a * a) * (math.sqrt(x * x + y * y + z * z) + radius) + 2 * b

    return fcl_ccd.BoundedMotion(pose_at, rate_at, acceleration, lambda t0, t1: a)


def falls(**changes):
    """Falls by t^2, with some functions replaced."""

    def pose_at(t):
        return pose((0, 0, -t * t))

    def rate_at(t):
        out = np.zeros((4, 4))
        out[2, 3] = -2 * t
        return out

    given = {
        "pose": pose_at,
        "rate": rate_at,
        "acceleration_bound": lambda center, radius, t0, t1: 2,
        "angular_speed_bound": lambda t0, t1: 0,
    }
    return fcl_ccd.BoundedMotion(**{**given, **changes})


def test_as_in_cpp():
    """A ball that swings, beside a cloth and beside a box, both ways round."""
    box_command, box = reference.shape("Box", 0.6, 0.6, 0.5)
    raised, faces = BALL[0] + (0.5, 0.2, 0.8), BALL[1]
    cloth, ball = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES), fcl_ccd.RigidMesh(raised, faces)
    cloth.update(CURRENT)
    commands = [reference.deformable(PREVIOUS, CURRENT, TRIANGLES)]
    commands += [reference.rigid(raised, faces), box_command]
    still = f"translation {reference.poses(np.eye(4), np.eye(4))}"
    moves, motion = f"swing {(0.7).hex()} {(0.9).hex()}", swing(0.7, 0.9)
    quick = [{"query": "first"}, {"query": "any"}]
    asked = []
    for i, o, requests in ((0, cloth, quick), (2, box, [*quick, {}, {"toc_err": 0.0}])):
        for options in requests:
            request = reference.request(**options)
            commands.append(f"motions {i} 1 {still} {moves} {request}")
            asked.append(((o, ball, None, motion), options))
            commands.append(f"motions 1 {i} {moves} {still} {request}")
            asked.append(((ball, o, motion, None), options))
    for (arguments, options), lines in zip(asked, reference.run(commands)[3:]):
        result = fcl_ccd.collide(*arguments, **options)
        assert result.is_collide and 0 < result.time_of_contact < 1
        reference.require_same(result, lines)


def test_known_time():
    """A ball 0.5 above a plane touches it when it has fallen by 0.5."""
    plate = fcl_ccd.RigidMesh(*grid(3, 4.0))
    ball = fcl_ccd.RigidMesh(BALL[0] + (2, 2, 0.8), BALL[1])
    first = {"query": "first", "toc_err": 1e-9}
    for o in (fcl_ccd.Halfspace((0, 0, 1), 0), plate):
        time = fcl_ccd.collide(o, ball, motion2=falls(), **first).time_of_contact
        assert math.sqrt(0.5) - 2e-9 <= time <= math.sqrt(0.5)
    manager = fcl_ccd.CollisionManager()
    manager.register("plate", plate)
    manager.register("ball", ball, falls())
    (pair,) = manager.collide(**first).pairs
    assert pair.result.time_of_contact == time
    manager.update({"ball": np.eye(4)})
    assert not manager.collide()
    manager.update({"ball": falls()})
    assert manager.collide(query="any")
    block = fcl_ccd.candidates(plate, ball, motion2=falls())
    assert len(block) > 0 and block["window_lo"].min() <= math.sqrt(0.5)


def test_deforms_in_the_frame_that_moves():
    """A sheet that rises by t in a frame that falls by t^2 is at t - t^2: 0.25 at most."""
    vertices, triangles = grid(3)
    sheet = fcl_ccd.DeformableMesh(vertices, triangles)
    sheet.update(vertices + (0, 0, 1))
    touched = fcl_ccd.RigidMesh(vertices + (0.1, 0.1, 0.24), triangles)
    time = fcl_ccd.collide(sheet, touched, falls(), query="first", toc_err=1e-9).time_of_contact
    assert 0.4 - 2e-9 <= time <= 0.4
    above = fcl_ccd.RigidMesh(vertices + (0, 0, 0.26), triangles)
    assert not fcl_ccd.collide(sheet, above, falls())


def nan_at(t, value=math.nan):
    return pose((0, 0, value if t > 0 else 0))


@pytest.mark.parametrize(
    "changes, error, text",
    [
        ({"pose": 3}, TypeError, "pose is of type int. Give a function"),
        ({"rate": None}, TypeError, "rate is of type NoneType. Give a function"),
        ({"pose": lambda t: np.eye(3)}, ValueError, r"pose\(t\) has the shape \(3, 3\)"),
        ({"pose": lambda t: None}, (TypeError, ValueError), r"pose\(t\)"),
        ({"pose": lambda t: 2 * np.eye(4)}, ValueError, r"pose\(t\): the last row"),
        ({"pose": lambda t: np.diag([1, 1, -1, 1])}, ValueError, r"pose\(t\) is not a rotation"),
        (
            {"pose": lambda t: pose(angle=1).astype(np.float32)},
            ValueError,
            r"more than 2\^-40. Compute it in double",
        ),
        ({"pose": nan_at}, ValueError, r"pose\(t\) has a number that is not finite"),
        ({"rate": nan_at}, ValueError, r"rate\(t\)"),
        ({"rate": lambda t: np.eye(4)}, ValueError, r"rate\(t\): the last row"),
        ({"acceleration_bound": lambda *ball: -1}, ValueError, r"acceleration_bound\(\) is -1"),
        ({"acceleration_bound": lambda *ball: math.inf}, ValueError, "Give a finite number"),
        ({"acceleration_bound": lambda *ball: "2"}, TypeError, r"acceleration_bound\(\) is of type"),
        ({"angular_speed_bound": lambda *span: math.nan}, ValueError, "Give a finite number"),
        ({"angular_speed_bound": lambda t: 0}, TypeError, "2 were given"),
    ],
)
def test_wrong_functions(changes, error, text):
    with pytest.raises(error, match=text):
        falls(**changes)


def test_exceptions_in_a_query_reach_the_caller():
    """Also from a function that failed only after the motion was made."""
    ball = fcl_ccd.RigidMesh(BALL[0] + (0, 0, 0.8), BALL[1])
    is_wrong = False

    def acceleration(center, radius, t0, t1):
        if is_wrong:
            raise KeyError("my error")
        return 2

    motion = falls(acceleration_bound=acceleration)
    plate = fcl_ccd.RigidMesh(*grid(3))
    assert fcl_ccd.collide(plate, ball, motion2=motion, query="any")
    is_wrong = True
    manager = fcl_ccd.CollisionManager()
    manager.register("plate", plate)
    for call in (
        lambda: fcl_ccd.collide(plate, ball, motion2=motion),
        lambda: fcl_ccd.collide(fcl_ccd.Sphere(0.5), ball, motion2=motion),
        lambda: fcl_ccd.candidates(plate, ball, motion2=motion),
        lambda: manager.register("ball", ball, motion),
    ):
        with pytest.raises(KeyError, match="my error"):
            call()
    is_wrong = False
    assert list(manager) == ["plate"]
    assert fcl_ccd.collide(plate, ball, motion2=motion, query="any")


def test_threads_and_memory():
    """Threads share one motion; a motion frees its functions."""
    floor = fcl_ccd.Halfspace((0, 0, 1), 0)
    ball = fcl_ccd.RigidMesh(BALL[0] + (0, 0, 0.8), BALL[1])
    times = []

    def asks(motion):
        for _ in range(3):
            result = fcl_ccd.collide(floor, ball, motion2=motion, query="first")
            times.append(result.time_of_contact)

    def rate(t):
        return [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, -2 * t], [0, 0, 0, 0]]

    count = sys.getrefcount(rate)
    motion = falls(rate=rate)
    threads = [threading.Thread(target=asks, args=(motion,)) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(times) == 9 and len(set(times)) == 1
    del motion, threads, thread
    gc.collect()
    assert sys.getrefcount(rate) == count
