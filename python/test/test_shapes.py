# SPDX-License-Identifier: BSD-3-Clause
"""Shapes: answers equal those in C++ to the bit, and known ones; wrong inputs."""

import numpy as np
import pytest
import reference
from scenes import crumpled, grid, pose, sphere

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(12)
BALL = sphere(8, 10, 0.3)
CORNERS = np.array([(0, 0, 0.3), (0.3, 0, -0.2), (-0.2, 0.2, -0.2), (-0.2, -0.3, -0.1)])
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
SHAPES = [
    ("Box", 0.3, 0.4, 0.5),
    ("Sphere", 0.3),
    ("Capsule", 0.2, 0.4),
    ("Ellipsoid", 0.3, 0.2, 0.4),
    ("Cone", 0.3, 0.4),
    ("Cylinder", 0.3, 0.4),
    ("Convex", CORNERS, FACES),
    ("Plane", (0.1, 0.2, 1), -0.1),
    ("Halfspace", (0.1, 0.2, 1), -0.1),
    ("TriangleP", *CORNERS[:3]),
]
NAMES = [shape[0] for shape in SHAPES]
BEGIN, END = pose((0.5, 0.5, 2)), pose((0.5, 0.45, -1.2))
TURNED = pose((0.3, 0.5, -0.2), (1, 2, 3), 1.2)
KINDS = {fcl_ccd.Kind.VERTEX_SHAPE, fcl_ccd.Kind.EDGE_SHAPE, fcl_ccd.Kind.FACE_SHAPE}


@pytest.mark.parametrize("given", SHAPES, ids=NAMES)
def test_with_meshes(given):
    """A shape that goes straight, turns and follows a screw, and meshes of both kinds."""
    command, shape = reference.shape(*given)
    models = [reference.deformable(PREVIOUS, CURRENT, TRIANGLES), reference.rigid(*BALL), command]
    cloth, ball = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES), fcl_ccd.RigidMesh(*BALL)
    cloth.update(CURRENT)
    still = reference.poses(np.eye(4), np.eye(4))
    requests = [{}, {"query": "first"}, {"min_distance": 0.01}, {"t_max": 0.4}]
    asked, commands = [], []
    for end in (END, TURNED):
        for options in requests:
            request = reference.request(**options)
            commands.append(f"poses 2 0 {reference.poses(BEGIN, end)} {still} {request}")
            asked.append(((shape, cloth, (BEGIN, end)), options))
            commands.append(f"poses 1 2 {still} {reference.poses(BEGIN, end)} {request}")
            asked.append(((ball, shape, None, (BEGIN, end)), options))
    screw = f"screw {reference.poses(BEGIN, TURNED)}"
    at_rest = f"translation {reference.poses(np.eye(4), np.eye(4))}"
    commands.append(f"motions 0 2 {at_rest} {screw} {reference.request()}")
    asked.append(((cloth, shape, None, fcl_ccd.ScrewMotion(BEGIN, TURNED)), {}))
    kinds = set()
    for (arguments, options), lines in zip(asked, reference.run(models + commands)[3:]):
        result = fcl_ccd.collide(*arguments, **options)
        reference.require_same(result, lines)
        kinds |= set(result.contacts["kind"].tolist())
        side = "b1" if arguments[0] is shape else "b2"
        assert (result.contacts[side] == -1).all()
        assert (result.contacts["first_on_o1"] == (side == "b2")).all()
    assert kinds and kinds <= KINDS


def test_with_each_other():
    commands, shapes = zip(*(reference.shape(*given) for given in SHAPES))
    asked, still = [], reference.poses(np.eye(4), np.eye(4))
    begin, end = pose((0.1, 0.1, 2)), pose((0.1, 0, -1.2))
    for i in range(len(shapes)):
        for k in range(i, len(shapes)):
            path = reference.poses(begin, end)
            asked.append(f"poses {i} {k} {path} {still} {reference.request()}")
    answers = iter(reference.run([*commands, *asked])[len(shapes) :])
    collisions = 0
    for i, shape1 in enumerate(shapes):
        for shape2 in shapes[i:]:
            result = fcl_ccd.collide(shape1, shape2, (begin, end))
            reference.require_same(result, next(answers))
            assert set(result.contacts["kind"].tolist()) <= {fcl_ccd.Kind.SHAPES}
            collisions += result.is_collide
    assert collisions > 40


def test_known_times():
    """A sphere falls by 2 onto a floor and onto a square, from a height of 1 above them."""
    ball, down = fcl_ccd.Sphere(0.5), (pose((0.5, 0.5, 1.5)), pose((0.5, 0.5, -0.5)))
    vertices, triangles = grid(4)
    for floor in (
        fcl_ccd.Halfspace((0, 0, 2), 0),
        fcl_ccd.Plane((0, 0, -1), 0),
        fcl_ccd.Box(4, 4, 0),
        fcl_ccd.RigidMesh(vertices, triangles),
        fcl_ccd.DeformableMesh(vertices, triangles),
    ):
        result = fcl_ccd.collide(ball, floor, down)
        assert 0.5 - 1e-4 <= result.time_of_contact <= 0.5
        contact = result.contacts[0]
        np.testing.assert_allclose(contact["pos"], (0.5, 0.5, 0), atol=1e-3)
        np.testing.assert_allclose(contact["normal"], (0, 0, -1), atol=1e-3)
        thick = fcl_ccd.collide(ball, floor, down, min_distance=0.2)
        assert 0.4 - 1e-4 <= thick.time_of_contact <= 0.4
    inside = fcl_ccd.collide(fcl_ccd.Box(3, 3, 3), ball)
    assert inside.is_collide and inside.time_of_contact == 0


def test_filters_and_callbacks():
    mesh, down = fcl_ccd.RigidMesh(*grid(4)), (pose((0.5, 0.5, 1)), pose((0.5, 0.5, -1)))
    ball, pairs = fcl_ccd.Sphere(0.3), []
    found = fcl_ccd.collide(ball, mesh, down, accepts_triangles=lambda *b: not pairs.append(b))
    assert found and {b1 for b1, _ in pairs} == {-1} and {b2 for _, b2 in pairs} <= set(range(18))
    assert not fcl_ccd.collide(ball, mesh, down, filter1=fcl_ccd.Filter(mask=2))
    kept = fcl_ccd.Filter(triangle_groups=np.arange(18) % 2 + 1)
    odd = fcl_ccd.collide(ball, mesh, down, filter1=fcl_ccd.Filter(mask=2), filter2=kept)
    assert len(odd.contacts) > 0 and (odd.contacts["b2"] % 2 == 1).all()


def test_attributes():
    assert fcl_ccd.Box(1, 2, 3).side.tolist() == [1, 2, 3]
    assert fcl_ccd.Sphere(np.float32(0.5)).radius == 0.5
    assert fcl_ccd.Ellipsoid(1, 2, 3).radii.tolist() == [1, 2, 3]
    for kind in (fcl_ccd.Capsule, fcl_ccd.Cone, fcl_ccd.Cylinder):
        assert (kind(1, 2).radius, kind(1, 2).lz) == (1, 2)
    for kind in (fcl_ccd.Plane, fcl_ccd.Halfspace):
        assert kind((0, 0, 4), 2).n.tolist() == [0, 0, 1] and kind((0, 0, 4), 2).d == 0.5
    convex = fcl_ccd.Convex(CORNERS, np.array(FACES))
    np.testing.assert_array_equal(convex.vertices, CORNERS)
    assert convex.num_faces == 4 and "4 vertices, 4 faces" in repr(convex)
    np.testing.assert_array_equal(fcl_ccd.TriangleP(*CORNERS[:3]).b, CORNERS[1])
    for name, *sizes in SHAPES:
        assert repr(getattr(fcl_ccd, name)(*sizes)).startswith(name + "(")
    with pytest.raises(AttributeError):
        fcl_ccd.Sphere(1).radius = 2


@pytest.mark.parametrize(
    "make, error, text",
    [
        (lambda: fcl_ccd.Box(1, -1, 1), ValueError, "y is -1.0. A size is not negative"),
        (lambda: fcl_ccd.Box((1, 1, 1), 1, 1), TypeError, "x is of type tuple. Give a number"),
        (lambda: fcl_ccd.Sphere(float("nan")), ValueError, "radius is nan. Give a finite number"),
        (lambda: fcl_ccd.Capsule(1, float("inf")), ValueError, "lz is inf"),
        (lambda: fcl_ccd.Ellipsoid(1, 1, -1), ValueError, "c is -1.0"),
        (lambda: fcl_ccd.Plane((0, 0, 0), 1), ValueError, "n has no direction"),
        (lambda: fcl_ccd.Halfspace((1e200, 0, 0), 1), ValueError, "n has no direction"),
        (lambda: fcl_ccd.Halfspace((1, 0), 1), ValueError, "n has the shape"),
        (lambda: fcl_ccd.Plane((0, 0, 1), "1"), TypeError, "d is of type str"),
        (lambda: fcl_ccd.TriangleP((0, 0, 0), (1, 0, 0), (0, np.nan, 0)), ValueError, "c has a"),
        (lambda: fcl_ccd.Convex(CORNERS, [(0, 1, 4)]), ValueError, "face 0 refers to vertex 4"),
        (lambda: fcl_ccd.Convex(CORNERS, [(0, 1, -1)]), ValueError, "face 0 refers to vertex -1"),
        (lambda: fcl_ccd.Convex(CORNERS, [(0, 1, 2), (0, 1)]), ValueError, "face 1 has fewer"),
        (lambda: fcl_ccd.Convex(CORNERS, [(0.5, 1, 2)]), TypeError, "face 0 of faces has elem"),
        (lambda: fcl_ccd.Convex(CORNERS * np.inf, FACES), ValueError, "vertices has a number"),
        (lambda: fcl_ccd.Convex(CORNERS[:0], []), ValueError, "no vertices"),
    ],
)
def test_wrong_shapes(make, error, text):
    with np.errstate(invalid="ignore"), pytest.raises(error, match=text):
        make()


def test_what_shapes_cannot_do():
    ball, mesh = fcl_ccd.Sphere(1), fcl_ccd.RigidMesh(*grid(3))
    with pytest.raises(TypeError, match="o is of type Sphere. Give a DeformableMesh"):
        fcl_ccd.self_collide(ball)
    with pytest.raises(TypeError, match="o2 is of type Sphere. Give a DeformableMesh"):
        fcl_ccd.candidates(mesh, ball)


@pytest.mark.parametrize("name", ["Box", "Convex", "DeformableMesh", "RigidMesh"])
def test_repr_of_what_failed_to_build(name):
    """A debugger shows such an object in the traceback of the error."""
    kind = getattr(fcl_ccd, name)
    assert repr(kind.__new__(kind)) == f"{kind.__name__}(not built)"
