# SPDX-License-Identifier: BSD-3-Clause
"""Bodies of several geometries, against their parts by themselves; wrong inputs."""

import gc
import weakref

import numpy as np
import pytest
from scenes import crumpled, pose, sphere

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(8)
BALL = fcl_ccd.RigidMesh(*sphere(5, 6, 0.2))
# Translations by few digits, so that the products of poses are exact.
PARTS = [
    (fcl_ccd.Sphere(0.125), pose((0.25, 0, 0))),
    (BALL, pose((-0.25, 0.125, 0))),
    (fcl_ccd.Box(0.1, 0.2, 0.3), pose((0, 0, 0.125))),
]
WAY = pose((0.5, 0.5, 2)), pose((0.5, 0.25, -1.5))


def cloth():
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    mesh.update(CURRENT)
    return mesh


def with_offset(poses, offset):
    return tuple(p @ offset for p in poses)


def test_answers_as_its_parts():
    body, other = fcl_ccd.Compound(PARTS), cloth()
    assert body.num_parts == 3 and body.parts[1][0] is BALL
    np.testing.assert_array_equal(body.parts[2][1], PARTS[2][1])
    result = fcl_ccd.collide(other, body, motion2=WAY)
    assert result and (result.contacts["part1"] == -1).all()
    np.testing.assert_array_equal(result.contact_tf2[:2, :3], WAY[1][:2, :3])
    names = [name for name in fcl_ccd.contact_dtype.names if name != "part2"]
    first = []
    for i, (geometry, offset) in enumerate(PARTS):
        one = fcl_ccd.collide(other, geometry, motion2=with_offset(WAY, offset))
        of_part = result.contacts[result.contacts["part2"] == i]
        assert len(of_part) == len(one.contacts) > 0
        for name in names:
            np.testing.assert_array_equal(of_part[name], one.contacts[name])
        first.append(one.time_of_contact)
    assert result.time_of_contact == min(first)
    near = fcl_ccd.collide(other, body, motion2=WAY, query="first")
    assert abs(near.time_of_contact - min(first)) <= 1e-4
    assert near.contacts["part2"][0] == np.argmin(first)


def test_distance_names_the_part():
    row = fcl_ccd.Compound([(fcl_ccd.Sphere(0.5), pose((3 * i, 0, 0))) for i in range(4)])
    result = fcl_ccd.distance(row, fcl_ccd.Sphere(0.5), motion2=pose((6, 0, 3)))
    assert result.part1 == 2 and result.part2 == -1
    assert result.distance_lo <= 2 <= result.distance_hi


def test_managers_and_robots_take_it():
    manager = fcl_ccd.CollisionManager()
    manager.register("body", fcl_ccd.Compound(PARTS), WAY)
    (pair,) = manager.collide(cloth()).pairs
    result = pair.result
    assert {*result.contacts["part1"], *result.contacts["part2"]} > {-1}
    chain = fcl_ccd.JointChain()
    link = chain.add_revolute(axis=(0, 0, 1))
    robot = fcl_ccd.CollisionRobot(chain)
    robot.attach(link, fcl_ccd.Compound([(fcl_ccd.Sphere(0.1), pose((1, 0, 0)))]))
    obstacles = fcl_ccd.CollisionManager()
    obstacles.register("wall", fcl_ccd.Sphere(0.1), pose((0, 1, 0)))
    assert robot.check_edge([0], [1.2], obstacles)
    assert not robot.check_edge([0], [1.6], obstacles)


def test_show_refuses_it():
    result = fcl_ccd.collide(cloth(), fcl_ccd.Compound(PARTS), motion2=WAY)
    with pytest.raises(ValueError, match="o2 is a Compound, which show"):
        result.show(file="x.png")


def test_a_part_that_changes():
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    body = fcl_ccd.Compound([(mesh, None)])
    assert fcl_ccd.collide(body, BALL, motion2=WAY)
    mesh.update(PREVIOUS, PREVIOUS + 5)
    with pytest.raises(RuntimeError, match="part 0 was updated after the Compound had read it"):
        fcl_ccd.collide(body, BALL, motion2=WAY)
    with pytest.raises(ValueError, match="part 0 .* is a mesh that deforms"):
        fcl_ccd.Compound([(mesh, None)])


def test_a_part_is_not_updated_during_a_query():
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    body, tries = fcl_ccd.Compound([(mesh, None)]), []

    def update(b1, b2):
        with pytest.raises(RuntimeError, match="has not ended"):
            mesh.update(CURRENT)
        tries.append(b1)
        return True

    fcl_ccd.collide(body, BALL, motion2=WAY, accepts_triangles=update)
    assert tries
    mesh.update(CURRENT)


@pytest.mark.parametrize(
    ("parts", "error", "text"),
    [
        ([], ValueError, "parts is empty"),
        (3, TypeError, "parts is of type int. Give a list of"),
        ([BALL], TypeError, "part 0 is of type RigidMesh. Give a pair"),
        ([(BALL, None), (3, None)], TypeError, "part 1 is of type int"),
        ([(BALL, np.eye(3))], ValueError, "the offset of part 0"),
        ([(BALL, 2 * np.eye(4))], ValueError, "offset"),
        ([(BALL, np.full((4, 4), np.nan))], ValueError, "offset"),
        ([(fcl_ccd.Compound(PARTS), None)], ValueError, "is a compound too"),
    ],
)
def test_wrong_parts(parts, error, text):
    with pytest.raises(error, match=text):
        fcl_ccd.Compound(parts)


def test_candidates_refuse_it():
    with pytest.raises(TypeError, match="o1 is of type Compound"):
        fcl_ccd.candidates(fcl_ccd.Compound(PARTS), BALL)


def test_cycles_are_freed():
    class Marked(fcl_ccd.Sphere):
        pass

    ball = Marked(1)
    ball.body = fcl_ccd.Compound([(ball, None)])
    freed = weakref.ref(ball)
    del ball
    gc.collect()
    assert freed() is None


def test_not_built():
    body = fcl_ccd.Compound.__new__(fcl_ccd.Compound)
    assert repr(body) == "Compound(not built)"
    with pytest.raises(TypeError):
        fcl_ccd.collide(body, BALL)
