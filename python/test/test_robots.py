# SPDX-License-Identifier: BSD-3-Clause
"""CollisionRobot: known contacts, and the pairs of collide() for each pair, to the bit."""

import copy
import gc
import math
import pickle
import threading
import weakref

import numpy as np
import pytest
from scenes import sphere

import fcl_ccd

REACH = 1.0


def two_links():
    """Two links of the length 1 that turn about z."""
    chain = fcl_ccd.JointChain()
    chain.add_revolute(axis=(0, 0, 1))
    chain.add_revolute(fcl_ccd.urdf_origin((REACH, 0, 0)), (0, 0, 1))
    return chain


def at(x, y, z):
    return fcl_ccd.urdf_origin((x, y, z))


def wall(y):
    manager = fcl_ccd.CollisionManager()
    manager.register("wall", fcl_ccd.Box(4, 0.2, 1), at(1, y, 0))
    return manager


def test_known_contact():
    robot = fcl_ccd.CollisionRobot(two_links(), ["upper arm", "lower arm"])
    robot.attach(0, fcl_ccd.Sphere(0.1))
    tip = robot.attach(1, fcl_ccd.Sphere(0.1), at(1, 0, 0))
    result = robot.check_edge([0, 0], [0, 2], wall(1.15), query="first")
    angle = math.asin(0.95)
    assert not result and not result.is_free
    assert angle / 2 - 1e-4 <= result.time_of_contact <= angle / 2
    assert result.joint_values[0] == 0 and abs(result.joint_values[1] - angle) < 2e-4
    (pair,) = result.pairs
    assert (pair.part1, pair.link1, pair.object) == (tip, 1, "wall")
    assert (pair.part2, pair.link2) == (-1, -1)
    assert robot.name_of(pair.link1) == "link 1 (lower arm)"
    assert abs(pair.result.contacts["pos"][0][1] - 1.05) < 1e-3
    free = robot.check_edge([0, 0], [0, 2], wall(1.15), t_max=0.6)
    assert free and free.time_of_contact == 1 and (free.joint_values == [0, 2]).all()
    assert free.num_tested <= free.num_box_pairs
    assert robot.check_edge([0, 0], [0, 2])


def test_itself_and_what_it_holds():
    chain = two_links()
    chain.add_revolute(fcl_ccd.urdf_origin((REACH, 0, 0)), (0, 0, 1))
    robot = fcl_ccd.CollisionRobot(chain)
    ball = fcl_ccd.RigidMesh(*sphere(6, 8, 0.1))
    robot.attach(0, ball)
    held = robot.attach(2, ball, at(1, 0, 0))
    close = 2 * math.pi / 3
    result = robot.check_edge([0, 0, 0], [0, close, close], query="first")
    (pair,) = result.pairs
    assert (pair.part1, pair.part2, pair.link2, pair.object) == (0, held, 2, None)
    # As collide() says of the two, on the paths of their links.
    longer = fcl_ccd.JointChain()
    for origin in (None, at(REACH, 0, 0), at(REACH, 0, 0)):
        longer.add_revolute(origin, (0, 0, 1))
    first = longer.add_fixed(parent=0)
    last = longer.add_fixed(at(1, 0, 0), 2)
    motion = fcl_ccd.ChainMotion(longer, [0, 0, 0], [0, close, close])
    alone = fcl_ccd.collide(ball, ball, motion.link(first), motion.link(last), query="first")
    assert alone.time_of_contact == result.time_of_contact
    assert (alone.contacts == pair.result.contacts).all()
    robot.detach(held)
    assert robot.check_edge([0, 0, 0], [0, close, close])
    robot.attach(2, ball, at(1, 0, 0), touch_links=[0])
    assert robot.check_edge([0, 0, 0], [0, close, close])


def test_rules():
    robot = fcl_ccd.CollisionRobot(two_links())
    large = fcl_ccd.Sphere(2)
    for link in (-1, 0, 1):
        robot.attach(link, large)
    still = [0, 0]
    assert len(robot.check_edge(still, still, query="all").pairs) == 3
    robot.allow_neighbours()
    (pair,) = robot.check_edge(still, still, query="all").pairs
    assert (pair.link1, pair.link2) == (-1, 1)
    robot.allow(1, -1)
    assert robot.check_edge(still, still)
    obstacles = wall(0)
    obstacles.set_filter("wall", fcl_ccd.Filter(group=4))
    assert not robot.check_edge(still, still, obstacles)
    for link in (-1, 0, 1):
        robot.set_filter(link, mask=1)
    assert robot.check_edge(still, still, obstacles)


def test_motions_and_bases():
    robot = fcl_ccd.CollisionRobot(two_links(), base=at(0, -2, 0))
    robot.attach(0, fcl_ccd.Sphere(0.1), at(1, 0, 0))
    obstacles = wall(1)
    assert robot.check_edge([0, 0], [2, 0], obstacles)
    motion = fcl_ccd.ChainMotion.polynomial(robot.chain, [[0, 0, 2], [0.5]])
    result = robot.check_motion(motion, obstacles, query="first")
    assert abs(result.joint_values[0] - math.asin(0.8)) < 1e-3
    assert result.joint_values[1] == 0.5
    stranger = fcl_ccd.ChainMotion(two_links(), [0, 0], [1, 1])
    with pytest.raises(ValueError, match="not one of this robot's chain"):
        robot.check_motion(stranger)


def test_meshes_that_change():
    vertices, triangles = sphere(6, 8, 0.1)
    mesh = fcl_ccd.DeformableMesh(vertices, triangles)
    robot = fcl_ccd.CollisionRobot(two_links())
    robot.attach(0, mesh, at(0.5, 0, 0))
    assert robot.check_edge([0, 0], [0.1, 0], wall(1))
    mesh.update(10 * vertices)
    with pytest.raises(RuntimeError, match="part 0 was updated"):
        robot.check_edge([0, 0], [0.1, 0], wall(1))
    robot.update()
    assert not robot.check_edge([0, 0], [0.1, 0], wall(1))


def test_paths_for_pictures():
    """Result.show() draws a part where it is at a time."""
    robot = fcl_ccd.CollisionRobot(two_links())
    robot.attach(1, fcl_ccd.Sphere(0.1), at(1, 0, 0))
    result = robot.check_edge([0, 0], [0, 2], wall(1.15), query="first")
    (o1, path1, _), _ = result.pairs[0].result._queried
    place = path1.pose_at(o1, result.time_of_contact)[:3, 3]
    angle = result.joint_values[1]
    assert np.allclose(place, [1 + math.cos(angle), math.sin(angle), 0])


def test_threads():
    robot = fcl_ccd.CollisionRobot(two_links())
    robot.attach(1, fcl_ccd.RigidMesh(*sphere(6, 8, 0.1)), at(1, 0, 0))
    obstacles = wall(1.15)
    found = []

    def ask():
        for i in range(20):
            found.append(robot.check_edge([0, 0], [0, 2], obstacles, query="first").time_of_contact)

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 80 and len(set(found)) == 1


def test_copies_are_refused():
    robot = fcl_ccd.CollisionRobot(two_links())
    for make in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="a CollisionRobot cannot be copied or pickled"):
            make(robot)


def test_cycles_are_freed():
    """A mesh of the user that refers to the robot which holds it."""

    class Owned(fcl_ccd.RigidMesh):
        pass

    mesh = Owned(*sphere(6, 8, 0.1))
    mesh.robot = fcl_ccd.CollisionRobot(two_links())
    mesh.robot.attach(0, mesh)
    seen = weakref.ref(mesh)
    del mesh
    gc.collect()
    assert seen() is None


@pytest.mark.parametrize(
    "ask, words",
    [
        (lambda robot: fcl_ccd.CollisionRobot(fcl_ccd.JointChain()), "no joints"),
        (lambda robot: fcl_ccd.CollisionRobot(two_links(), ["arm"]), "1 names of 2 links"),
        (lambda robot: robot.attach(2, fcl_ccd.Sphere(1)), "no link 2"),
        (lambda robot: robot.attach(-2, fcl_ccd.Sphere(1)), "link is -2"),
        (lambda robot: robot.attach(0, fcl_ccd.Sphere(1), touch_links=[5]), "no link 5"),
        (lambda robot: robot.attach(0, fcl_ccd.Sphere(1), np.zeros((4, 4))), "origin"),
        (lambda robot: robot.detach(0), "no part 0"),
        (lambda robot: robot.allow(0, 7), "no link 7"),
        (lambda robot: robot.check_edge([0], [0, 0]), "begin has 1 values"),
        (lambda robot: robot.check_edge([0, 0], [0, math.nan]), "not finite"),
        (lambda robot: robot.check_edge([0, 0], [0, 0], t_max=2), "t_max"),
    ],
)
def test_errors(ask, words):
    with pytest.raises(ValueError, match=words):
        ask(fcl_ccd.CollisionRobot(two_links()))


def test_wrong_types():
    robot = fcl_ccd.CollisionRobot(two_links())
    for ask, words in (
        (lambda: fcl_ccd.CollisionRobot("chain"), "JointChain"),
        (lambda: fcl_ccd.CollisionRobot(two_links(), [1, 2]), "list of str"),
        (lambda: robot.attach(0, "mesh"), "an OcTree or a Compound"),
        (lambda: robot.check_edge([0, 0], [1, 1], "wall"), "CollisionManager, or None"),
        (lambda: robot.check_motion("motion"), "ChainMotion"),
    ):
        with pytest.raises(TypeError, match=words):
            ask()
