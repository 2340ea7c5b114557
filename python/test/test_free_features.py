# SPDX-License-Identifier: BSD-3-Clause
"""Free edges and points, against all pairs tested one by one."""

import itertools

import numpy as np
import pytest

import fcl_ccd

RNG = np.random.default_rng(39)
EDGES = np.array([(4 * c + k, 4 * c + k + 1) for c in range(12) for k in range(3)])
POINTS = np.arange(48, 60)
PREVIOUS = RNG.uniform(-1, 1, (60, 3))
CURRENT = PREVIOUS + RNG.uniform(-1, 1, (60, 3))


def cables(triangles=None):
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, triangles, edges=EDGES, points=POINTS)
    mesh.update(CURRENT)
    return mesh


def edge_pairs():
    pairs = [(a, b) for a, b in itertools.combinations(EDGES, 2) if not set(a) & set(b)]
    return np.array(pairs).reshape(-1, 4)


def test_edges_meet_edges():
    pairs = edge_pairs()
    truth = fcl_ccd.edge_edge(PREVIOUS[pairs], CURRENT[pairs])
    expected = {tuple(p) for p in pairs[truth["is_contact"]]}
    contacts = fcl_ccd.self_collide(cables()).contacts
    assert {tuple(c["vertices"][:4]) for c in contacts} == expected
    assert len(contacts) == len(expected) > 10
    assert (contacts["kind"] == fcl_ccd.Kind.EDGE_EDGE).all()
    assert (contacts["b1"] < len(EDGES)).all()


def test_a_point_meets_a_triangle():
    triangle = [(0, 1, 2)]
    plate = fcl_ccd.DeformableMesh([(-9, -9, 0), (9, -9, 0), (0, 9, 0)], triangle)
    cloud = fcl_ccd.DeformableMesh(PREVIOUS, None, points=POINTS)
    cloud.update(CURRENT)
    crosses = PREVIOUS[POINTS, 2] * CURRENT[POINTS, 2] < 0
    contacts = fcl_ccd.collide(cloud, plate).contacts
    assert sorted(contacts["vertices"][:, 0]) == sorted(POINTS[crosses])
    assert crosses.any()
    assert (contacts["b1"] + POINTS[0] == contacts["vertices"][:, 0]).all()


def test_points_come_near():
    pairs = np.array(list(itertools.combinations(POINTS, 2)))
    truth = fcl_ccd.vertex_vertex(PREVIOUS[pairs], CURRENT[pairs], min_distance=0.5)
    contacts = fcl_ccd.self_collide(cables(), min_distance=0.5).contacts
    two = contacts[contacts["kind"] == fcl_ccd.Kind.VERTEX_VERTEX]
    both_free = two[(two["vertices"][:, :2] >= POINTS[0]).all(axis=1)]
    expected = {tuple(p) for p in pairs[truth["is_contact"]]}
    assert {tuple(v[:2]) for v in both_free["vertices"]} == expected
    assert len(expected) > 3
    assert (both_free["b1"] >= len(EDGES)).all()


def test_attributes_and_change_of_topology():
    mesh = cables([(0, 4, 8)])
    assert (mesh.num_triangles, mesh.num_edges, mesh.num_points) == (1, 36, 12)
    assert repr(mesh) == "DeformableMesh(60 vertices, 1 triangles, 36 edges, 12 points)"
    mesh.update_topology(None, PREVIOUS, CURRENT, edges=EDGES, points=POINTS)
    one, other = fcl_ccd.self_collide(mesh), fcl_ccd.self_collide(cables())
    assert (one.contacts == other.contacts).all()
    mesh.update_topology([(0, 1, 2)], PREVIOUS, CURRENT)
    assert mesh.num_edges == 0


@pytest.mark.parametrize(
    "arguments, error, text",
    [
        ({"edges": [(0, 60)]}, ValueError, "free edge 0 refers to vertex 60 of 60"),
        ({"edges": [(0, 1), (2, 2)]}, ValueError, "free edge 1 joins vertex 2 to itself"),
        ({"edges": [(0, -1)]}, ValueError, "free edges have vertex -1"),
        ({"edges": [0, 1]}, ValueError, r"edges has the shape \(2,\)"),
        ({"edges": [(0.5, 1)]}, TypeError, "edges has elements of type float64"),
        ({"points": [3, 77]}, ValueError, "free point 1 refers to vertex 77 of 60"),
        ({"points": [[3]]}, ValueError, "points has the shape"),
        ({}, ValueError, "no triangles"),
    ],
)
def test_errors(arguments, error, text):
    with pytest.raises(error, match=text):
        fcl_ccd.DeformableMesh(PREVIOUS, None, **arguments)


def test_shapes_and_turns():
    """A lying edge falls on a ball and on a cable that turns below it."""
    lying = [[-1, 0, 1], [1, 0, 1]]
    edge = fcl_ccd.DeformableMesh(lying, None, edges=[(0, 1)])
    edge.update(np.asarray(lying) - [0, 0, 2])
    on_ball = fcl_ccd.collide(edge, fcl_ccd.Sphere(0.5), query="all")
    assert on_ball.time_of_contact == pytest.approx(0.25, abs=1e-4)
    assert on_ball.contacts["kind"].tolist() == [fcl_ccd.Kind.EDGE_SHAPE]
    below = fcl_ccd.DeformableMesh([[-1, 0, 0], [1, 0, 0]], None, edges=[(0, 1)])
    turn = np.eye(4)
    turn[:2, :2] = [[0, -1], [1, 0]]
    on_cable = fcl_ccd.collide(edge, below, motion2=fcl_ccd.ScrewMotion(np.eye(4), turn))
    assert on_cable.time_of_contact == pytest.approx(0.5, abs=1e-4)
