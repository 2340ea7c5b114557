# SPDX-License-Identifier: BSD-3-Clause
"""Answers in Python equal those in C++, to the bit."""

import numpy as np
import pytest
import reference
from scenes import crumpled, grid, pose, sphere

import fcl_ccd

N = 24  # vertices in a row of the cloth
PREVIOUS, CURRENT, TRIANGLES = crumpled(N)
BALL = sphere(12, 16, 0.4)
HALF = {
    "triangle_groups": np.arange(len(TRIANGLES)) % 2 + 1,
    "triangle_masks": np.full(len(TRIANGLES), 2),
}


def by_parity(b1, b2):
    return (b1 + b2) % 3 != 0


REQUESTS = [
    {},
    {"query": "first"},
    {"query": "any"},
    {"toc_err": 0.0},
    {"toc_err": 1e-2, "t_max": 0.3},
    {"num_max_contacts": 5},
    {"enable_contact": False},
    {"enable_crossings": True},
    {"filter1": HALF},
    {"filter1": {"group": 4, "mask": 3}},
    {"accepts_triangles": by_parity},
    {"min_distance": 0.004},
    {"min_distance": 0.02, "ignore_initially_closer": True, "query": "first"},
    {"min_approach_speed": 0.2},
    {"min_distance": 0.01, "min_approach_speed": 0.2, "query": "first"},
]


def cloth():
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    mesh.update(CURRENT)
    return mesh


def features(contacts, numbers):
    """The pairs of features of contacts, with other numbers of the vertices."""
    pairs = set()
    for kind, vertices in zip(contacts["kind"], contacts["vertices"]):
        size = 1 if kind == fcl_ccd.Kind.VERTEX_FACE else 2
        ids = numbers[vertices[:4]].tolist()
        pairs.add(frozenset([frozenset(ids[:size]), frozenset(ids[size:])]))
    assert len(pairs) == len(contacts)
    return pairs


def test_a_triangle_soup_is_noticed_and_joined():
    corners = TRIANGLES.ravel()
    previous, current = PREVIOUS[corners], CURRENT[corners]
    triangles = np.arange(len(corners)).reshape(-1, 3)
    soup = fcl_ccd.DeformableMesh(previous, triangles)
    soup.update(previous, current)
    result = fcl_ccd.self_collide(soup)
    expected = fcl_ccd.self_collide(cloth())
    assert result.is_triangle_soup and not expected.is_triangle_soup
    assert len(result.contacts) > len(expected.contacts)

    joined = fcl_ccd.weld_vertices([previous, current])
    first = {v: i for i, v in reversed(list(enumerate(corners)))}
    assert joined.tolist() == [first[v] for v in corners]
    mesh = fcl_ccd.DeformableMesh(previous, joined[triangles])
    mesh.update(previous, current)
    result = fcl_ccd.self_collide(mesh)
    assert not result.is_triangle_soup
    assert features(result.contacts, corners) == features(expected.contacts, np.arange(len(PREVIOUS)))
    # The corners of a sheet's neighbours part when they move.
    apart = current.copy()
    apart[0] += 1
    assert fcl_ccd.weld_vertices([previous, apart])[1:].min() > 0
    assert fcl_ccd.weld_vertices([previous, apart], eps=2.0)[0] == 0


def test_self_collide():
    commands = [reference.deformable(PREVIOUS, CURRENT, TRIANGLES)]
    commands += [f"self 0 {reference.request(**options)}" for options in REQUESTS]
    answers = reference.run(commands)[1:]
    mesh = cloth()
    for options, lines in zip(REQUESTS, answers):
        result = fcl_ccd.self_collide(mesh, **reference.in_python(options))
        reference.require_same(result, lines)
    # The scene tests something.
    assert int(answers[0][0][4]) > 500
    assert int(answers[7][0][5]) > 0
    assert 0 < int(answers[8][0][4]) < int(answers[0][0][4])
    assert int(answers[9][0][4]) == 0
    assert 0 < int(answers[10][0][4]) < int(answers[0][0][4])


BEGIN, END = pose((0.5, 0.5, 1.5)), pose((0.5, 0.45, -1.2))
TURNED = pose((0.3, 0.5, -0.2), (1, 2, 3), 1.2)


@pytest.mark.parametrize("kind", ["deformable", "rigid"])
def test_two_poses(kind):
    """A ball that goes straight, and one that turns, against a cloth and a rigid mesh."""
    if kind == "rigid":
        mesh, command = fcl_ccd.RigidMesh(CURRENT, TRIANGLES), reference.rigid(CURRENT, TRIANGLES)
    else:
        mesh, command = cloth(), reference.deformable(PREVIOUS, CURRENT, TRIANGLES)
    commands = [command, reference.rigid(*BALL)]
    ball = fcl_ccd.RigidMesh(*BALL)
    still = reference.poses(np.eye(4), np.eye(4))
    requests = REQUESTS + [{"filter2": {"group": 8}, "filter1": {"mask": 7}}]
    asked = [(END, requests), (TURNED, [REQUESTS[i] for i in (0, 1, 4, 8, 10)])]
    for end, requests in asked:
        for options in requests:
            pair = f"poses 1 0 {reference.poses(BEGIN, end)} {still}"
            swapped = dict(options)
            if "filter1" in options:  # it is the cloth's
                swapped["filter2"] = options["filter1"]
                swapped["filter1"] = options.get("filter2", {})
            commands.append(f"{pair} {reference.request(**swapped)}")
    answers = iter(reference.run(commands)[2:])
    contacts = 0
    for end, requests in asked:
        for options in requests:
            swapped = reference.in_python(options)
            filter1, filter2 = swapped.pop("filter1", None), swapped.pop("filter2", None)
            result = fcl_ccd.collide(
                ball, mesh, (BEGIN, end), filter1=filter2, filter2=filter1, **swapped
            )
            reference.require_same(result, next(answers))
            contacts += len(result.contacts)
    assert contacts > 100


SPLINE = (
    np.array([(0.5, 0.5, 1.6), (0.5, 0.4, 1.2), (0.6, 0.4, 0.1), (0.5, 0.5, -0.9)]),
    np.array([(0, 0, 0), (0.1, 0.3, 0.2), (0.4, 0.5, 0.3), (0.5, 0.6, 0.9)]),
)
PLACE = pose((0.9, 0.9, 0.6))
MOTIONS = [
    (f"linear {reference.poses(BEGIN, TURNED)} {reference._text([0.1, 0.2, 0.3])}",
     fcl_ccd.LinearMotion(BEGIN, TURNED, (0.1, 0.2, 0.3))),
    (f"screw {reference.poses(BEGIN, TURNED)}", fcl_ccd.ScrewMotion(BEGIN, TURNED)),
    (f"spline {reference._text(SPLINE[0])} {reference._text(SPLINE[1])}",
     fcl_ccd.SplineMotion(*SPLINE)),
]  # fmt: skip


@pytest.mark.parametrize("words, motion", MOTIONS, ids=["linear", "screw", "spline"])
def test_motions(words, motion):
    """A ball and a cloth, both of which follow a motion; and a cloth at rest."""
    still = f"translation {reference.poses(np.eye(4), np.eye(4))}"
    commands = [reference.deformable(PREVIOUS, CURRENT, TRIANGLES), reference.rigid(*BALL)]
    commands += [f"motions 0 1 {still} {words} {reference.request()}"]
    placed = f"translation {reference.poses(PLACE, PLACE)}"
    commands += [f"motions 0 1 {words} {placed} {reference.request()}"]
    answers = reference.run(commands)[2:]
    mesh, ball = cloth(), fcl_ccd.RigidMesh(*BALL)
    for lines, motions in zip(answers, [(None, motion), (motion, PLACE)]):
        result = fcl_ccd.collide(mesh, ball, *motions)
        reference.require_same(result, lines)
        assert result.is_collide


def spline_pose(weights):
    """The pose of the spline at an end, by the weights that its documentation gives."""
    translation, vector = (np.array(weights) / 6 @ points for points in SPLINE)
    return pose(translation, vector, np.linalg.norm(vector))


def test_spline_ends_as_documented():
    ball, motion = fcl_ccd.RigidMesh(*BALL), fcl_ccd.SplineMotion(*SPLINE)
    begin, end = spline_pose((1, 4, 1, 0)), spline_pose((0, 1, 4, 1))
    # Without a collision the pose is that at t = 1, with a crossing that at t = 0.
    apart = fcl_ccd.collide(ball, ball, motion, pose((9, 9, 9)))
    assert not apart
    np.testing.assert_allclose(apart.contact_tf1, end, atol=1e-12)
    np.testing.assert_array_equal(apart.contact_tf2, pose((9, 9, 9)))
    crossing = fcl_ccd.collide(ball, ball, motion, begin @ pose((0.1, 0.1, 0.1)))
    assert crossing.initially_crossing and crossing.time_of_contact == 0
    np.testing.assert_allclose(crossing.contact_tf1, begin, atol=1e-12)


def test_self_candidates():
    """In one array, in blocks, and ended by the sink."""
    lines = reference.run(
        [reference.deformable(PREVIOUS, CURRENT, TRIANGLES), "self_candidates 0 0"]
    )[1]
    mesh = cloth()
    all_at_once = fcl_ccd.self_candidates(mesh)
    reference.require_same_records(all_at_once, lines)
    blocks = []
    assert fcl_ccd.self_candidates(mesh, blocks.append, block=500) is True
    assert len(blocks) > 3 and all(len(block) >= 500 for block in blocks[:-1])
    np.testing.assert_array_equal(np.concatenate(blocks), all_at_once)
    seen = []
    ended = fcl_ccd.self_candidates(mesh, lambda b: seen.append(b) or len(seen) < 2, block=500)
    assert ended is False and len(seen) == 2


def test_candidates_at_a_distance_and_of_a_mesh_that_turns():
    mesh, ball = cloth(), fcl_ccd.RigidMesh(*BALL)
    still = reference.poses(np.eye(4), np.eye(4))
    models = [reference.deformable(PREVIOUS, CURRENT, TRIANGLES), reference.rigid(*BALL)]
    _, _, near, pairs, turning = reference.run(
        models
        + ["self_candidates 0 0.01"]
        + [f"candidates 0 1 {still} {reference.poses(BEGIN, END)} 0.05"]
        + [f"candidates 0 1 {still} {reference.poses(BEGIN, TURNED)} 0"]
    )
    reference.require_same_records(fcl_ccd.self_candidates(mesh, min_distance=0.01), near)
    assert len(near) > len(fcl_ccd.self_candidates(mesh))
    found = fcl_ccd.candidates(mesh, ball, motion2=(BEGIN, END), min_distance=0.05)
    reference.require_same_records(found, pairs)
    found = fcl_ccd.candidates(mesh, ball, motion2=(BEGIN, TURNED))
    reference.require_same_records(found, turning)


@pytest.mark.parametrize("kind, num_points", [("vf", 4), ("ee", 4), ("ve", 3), ("vv", 2)])
def test_feature_tests_at_a_distance(kind, num_points):
    t0, t1 = np.random.default_rng(3).normal(size=(2, 300, num_points, 3))
    test = {"vf": "vertex_face", "ee": "edge_edge", "ve": "vertex_edge", "vv": "vertex_vertex"}
    answer = getattr(fcl_ccd, test[kind])(t0, t1, toc_err=1e-6, min_distance=0.3)
    (lines,) = reference.run([reference.features(kind, t0, t1, 1e-6, 0.3)])
    reference.require_same_records(answer, lines)
    assert 0 < answer["is_contact"].sum() < len(t0)


def points_of(candidates, kind, frame1, frame2):
    """The points of candidates: VF takes a vertex of one mesh and a face of the other."""
    of = candidates[candidates["kind"] == kind]
    num_first = 1 if kind == fcl_ccd.Kind.VERTEX_FACE else 2
    points = np.empty((len(of), 4, 3))
    for i in range(4):
        on_o1 = of["first_on_o1"] == (i < num_first)
        ids = of["vertices"][:, i]
        points[on_o1, i] = frame1[ids[on_o1]]
        points[~on_o1, i] = frame2[ids[~on_o1]]
    return of, points


def test_candidates_and_feature_tests():
    """The tests of all candidates equal C++ and give the contacts of the query."""
    mesh, ball = cloth(), fcl_ccd.RigidMesh(*BALL)
    found = fcl_ccd.candidates(mesh, ball, motion2=(BEGIN, END))
    result = fcl_ccd.collide(mesh, ball, motion2=(BEGIN, END))
    ball_t0, ball_t1 = BALL[0] + BEGIN[:3, 3], BALL[0] + END[:3, 3]
    tests = {"vf": fcl_ccd.vertex_face, "ee": fcl_ccd.edge_edge}
    keys, commands, answers = set(), [], []
    for kind, name in ((fcl_ccd.Kind.VERTEX_FACE, "vf"), (fcl_ccd.Kind.EDGE_EDGE, "ee")):
        of, t0 = points_of(found, kind, PREVIOUS, ball_t0)
        t1 = points_of(found, kind, CURRENT, ball_t1)[1]
        answer = tests[name](t0, t1, toc_err=1e-6)
        commands.append(reference.features(name, t0, t1, 1e-6))
        answers.append(answer)
        hit = of[answer["is_contact"]]
        keys |= {(int(kind), bool(c["first_on_o1"]), *c["vertices"].tolist()) for c in hit}
        assert (of["window_lo"] <= of["window_hi"]).all()
        assert (answer["toc_lo"] <= answer["toc_hi"]).all()
    for answer, lines in zip(answers, reference.run(commands)):
        reference.require_same_records(answer, lines)
    assert keys == {
        (int(c["kind"]), bool(c["first_on_o1"]), *c["vertices"][:4].tolist())
        for c in result.contacts
    }
    assert len(keys) > 20


def test_updates_are_the_same():
    """One frame, two frames, new triangles and a new mesh give the same answers."""
    expected = fcl_ccd.self_collide(cloth())
    both = fcl_ccd.DeformableMesh(grid(N)[0], TRIANGLES, num_threads=2)
    assert not both.is_deforming
    both.update(PREVIOUS, CURRENT)
    grown = fcl_ccd.DeformableMesh(*grid(5))
    grown.update_topology(TRIANGLES, PREVIOUS, CURRENT, origins=np.full(len(TRIANGLES), -1))
    for mesh in (both, grown):
        result = fcl_ccd.self_collide(mesh)
        for name in fcl_ccd.contact_dtype.names:
            np.testing.assert_array_equal(result.contacts[name], expected.contacts[name])
        assert mesh.is_deforming
        np.testing.assert_array_equal(mesh.previous, PREVIOUS)
        np.testing.assert_array_equal(mesh.current, CURRENT)
        np.testing.assert_array_equal(mesh.triangles, TRIANGLES)


def test_inputs_of_any_numeric_type_and_layout():
    expected = fcl_ccd.self_collide(cloth()).contacts["toc_lo"]
    wide = np.zeros((len(PREVIOUS), 5))
    wide[:, 1:4] = CURRENT
    for triangles in (TRIANGLES.astype(np.uint16), TRIANGLES.tolist()):
        mesh = fcl_ccd.DeformableMesh(np.asfortranarray(PREVIOUS), triangles)
        mesh.update(wide[:, 1:4])
        np.testing.assert_array_equal(fcl_ccd.self_collide(mesh).contacts["toc_lo"], expected)
    mesh = fcl_ccd.DeformableMesh(PREVIOUS.astype(np.float32), TRIANGLES)
    np.testing.assert_array_equal(mesh.current, PREVIOUS.astype(np.float32))
    mesh = fcl_ccd.DeformableMesh(PREVIOUS.astype(object), TRIANGLES.astype(object))
    np.testing.assert_array_equal(mesh.current, PREVIOUS)


def test_inputs_stay_unchanged():
    frames = PREVIOUS.copy(), CURRENT.copy(), TRIANGLES.copy()
    for array in frames:
        array.flags.writeable = False
    mesh = fcl_ccd.DeformableMesh(frames[0], frames[2])
    mesh.update(frames[0], frames[1])
    fcl_ccd.self_collide(mesh)
    np.testing.assert_array_equal(frames[1], CURRENT)
