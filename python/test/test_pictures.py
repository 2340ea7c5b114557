# SPDX-License-Identifier: BSD-3-Clause
"""Result.show(): what is drawn, where, and what is refused. No test opens a window."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from scenes import crumpled, grid, pose, require, rotation, sphere

import fcl_ccd
from fcl_ccd import _figures, _pictures, _results, _surfaces
from fcl_ccd._motions import AT_ORIGIN, path_of

PREVIOUS, CURRENT, TRIANGLES = crumpled(9)
BALL = sphere(6, 7, 0.3)
FALLS = pose((0.5, 0.5, 1)), pose((0.4, 0.5, -1), (1, 2, 3), 1.1)
TIMES = 0.0, 0.3, 1.0


def sheet(n=9):
    """At z = 0, then at z = 0.2."""
    vertices, triangles = grid(n)
    mesh = fcl_ccd.DeformableMesh(vertices, triangles)
    mesh.update(vertices + (0, 0, 0.2))
    return mesh


def crumpling():
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    mesh.update(CURRENT)
    return mesh


def picture(result, t=None, contact=0):
    return _results._picture(result, t, contact)


def surface(o, motion, t):
    return _surfaces.surface_at((o, path_of(motion, "motion"), o._num_updates), "o", t)


def moved(at, points):
    return points @ at[:3, :3].T + at[:3, 3]


def turned(t):
    """FALLS at t: the origin goes straight."""
    return pose((0.5 - 0.1 * t, 0.5, 1 - 2 * t), (1, 2, 3), 1.1 * t)


def about(reference):
    def at(t):
        out, r = turned(t), np.array(reference)
        begin, end = (moved(turned(i), r[None])[0] for i in (0, 1))
        out[:3, 3] = (1 - t) * begin + t * end - out[:3, :3] @ r
        return out

    return at


def accelerates(t):
    return pose((0, 0, 1 - t**2))


def rate_of_it(t):
    out = np.zeros((4, 4))
    out[2, 3] = -2 * t
    return out


def on_a_spline(t):
    """The translation has one component; the points are equally far from each other."""
    return pose((0, 0, 1 - 2 * t))


def screwed(t):
    """Half a turn about the z axis, one unit along it."""
    return pose((0, 0, t), (0, 0, 1), 0.5 * np.pi * t)


BOUNDED = fcl_ccd.BoundedMotion(accelerates, rate_of_it, lambda c, r, t0, t1: 2, lambda t0, t1: 0)
SPLINE = fcl_ccd.SplineMotion([(0, 0, z) for z in (3, 1, -1, -3)], np.zeros((4, 3)))
MOTIONS = {
    "none": (None, lambda t: np.eye(4)),
    "pose": (FALLS[1], lambda t: FALLS[1]),
    "two_poses": (FALLS, turned),
    "linear": (fcl_ccd.LinearMotion(*FALLS, (0.1, 0.2, 0.3)), about((0.1, 0.2, 0.3))),
    "screw": (fcl_ccd.ScrewMotion(screwed(0), screwed(1)), screwed),
    "spline": (SPLINE, on_a_spline),
    "bounded": (BOUNDED, accelerates),
}

MOVING = [name for name in MOTIONS if name not in ("none", "pose")]


@pytest.mark.parametrize("motion, at", MOTIONS.values(), ids=MOTIONS.keys())
def test_rigid_objects_follow_their_path(motion, at):
    mesh, box = fcl_ccd.RigidMesh(*BALL), fcl_ccd.Box(0.2, 0.4, 0.6)
    at_rest = fcl_ccd.DeformableMesh(*BALL)
    corners = np.array(list(itertools.product((-0.1, 0.1), (-0.2, 0.2), (-0.3, 0.3))))
    for t in TIMES:
        for o in (mesh, at_rest):
            polygons = surface(o, motion, t).pieces(None, np.empty(0, int))[0].polygons
            np.testing.assert_allclose(polygons, moved(at(t), BALL[0])[BALL[1]], atol=1e-12)
        found = surface(box, motion, t).bounds()
        expected = moved(at(t), corners)
        distances = np.abs(found[:, None] - expected[None]).max(axis=2)
        assert distances.min(axis=0).max() < 1e-12 and distances.min(axis=1).max() < 1e-12


@pytest.mark.parametrize("motion, at", MOTIONS.values(), ids=MOTIONS.keys())
def test_meshes_that_deform(motion, at):
    """Between two poses each vertex goes straight, else it does in the frame that turns."""
    mesh = crumpling()
    for t in TIMES:
        expected = moved(at(t), (1 - t) * PREVIOUS + t * CURRENT)
        if motion is FALLS:
            expected = (1 - t) * moved(at(0), PREVIOUS) + t * moved(at(1), CURRENT)
        polygons = surface(mesh, motion, t).pieces(None, np.empty(0, int))[0].polygons
        np.testing.assert_allclose(polygons, expected[TRIANGLES], atol=1e-12)


def distance_to(polygon, point):
    """To the plane of a triangle that is not degenerate."""
    normal = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
    return abs(normal @ (point - polygon[0])) / np.linalg.norm(normal)


def require_touching(result):
    """At their times the drawn parts are where the contacts are."""
    assert len(result.contacts) > 0
    for i in range(0, len(result.contacts), max(1, len(result.contacts) // 20)):
        contact = result.contacts[i]
        for queried, b in zip(result._queried, (contact["b1"], contact["b2"])):
            (polygon,) = _surfaces.surface_at(queried, "o", contact["toc_lo"]).part(b).polygons
            assert distance_to(polygon, contact["pos"]) < 1e-3
            assert (contact["pos"] > polygon.min(axis=0) - 1e-3).all()
            assert (contact["pos"] < polygon.max(axis=0) + 1e-3).all()


@pytest.mark.parametrize("motion", [MOTIONS[name][0] for name in MOVING], ids=MOVING)
def test_parts_touch_at_the_time_of_contact(motion):
    ball = fcl_ccd.RigidMesh(*BALL)
    for o1, o2 in ((crumpling(), ball), (fcl_ccd.RigidMesh(CURRENT, TRIANGLES), ball)):
        require_touching(fcl_ccd.collide(o1, o2, None, motion, toc_err=1e-9))
        require_touching(fcl_ccd.collide(ball, o1, motion, pose((0.1, 0, 0)), toc_err=1e-9))


def test_self_collisions_and_managers():
    mesh = crumpling()
    require_touching(fcl_ccd.self_collide(mesh, toc_err=1e-9))
    manager = fcl_ccd.CollisionManager()
    turns = fcl_ccd.LinearMotion(*FALLS)
    manager.register("cloth", mesh, turns, self_collision=True)
    manager.register("ball", fcl_ccd.RigidMesh(*BALL), pose((0.4, 0.5, 0.2)))
    found = manager.collide(toc_err=1e-9)
    later = manager.collide(fcl_ccd.RigidMesh(*BALL), pose((0.4, 0.5, -0.2)), toc_err=1e-9)
    manager.update({"cloth": pose((9, 9, 9))})  # results have the motions of their query
    assert {(pair.o1, pair.o2) for pair in found.pairs} == {("cloth", "cloth"), ("cloth", "ball")}
    for pair in [*found.pairs, *later.pairs]:
        require_touching(pair.result)
    bounded = fcl_ccd.CollisionManager()
    bounded.register("cloth", sheet())
    bounded.register("ball", fcl_ccd.RigidMesh(*BALL), BOUNDED)
    require_touching(bounded.collide().pairs[0].result)


def test_titles():
    ball = fcl_ccd.RigidMesh(*BALL)
    result = fcl_ccd.collide(sheet(), ball, None, FALLS)
    first = result.contacts[0]
    assert result.time_of_contact == first["toc_lo"] and first["kind"] in (0, 1)
    kind = ("vertex-face", "edge-edge")[first["kind"]]
    toc, parts = f"{first['toc_lo']:.4g}", f"triangle {first['b1']} of o1 and triangle {first['b2']} of o2"
    assert picture(result).title == f"first contact at t = {toc}\n{kind}, {parts}"
    assert picture(result, 0.1).title.endswith(f"{parts}\ndrawn at t = 0.1")
    last = len(result.contacts) - 1
    assert picture(result, contact=1).title.startswith("contact 1 at t = ")
    assert picture(result, contact=last).title.startswith(f"contact {last} at t = ")
    assert picture(result, 1, None).title == f"t = 1: {last + 1} of {last + 1} contacts until then"
    assert picture(result, 0, None).title == f"t = 0: 0 of {last + 1} contacts until then"
    apart = fcl_ccd.collide(sheet(), ball, None, pose((9, 9, 9)))
    assert picture(apart).title == picture(apart, contact=None).title
    assert picture(apart).title == "no contact in the step, drawn at t = 1"
    itself = fcl_ccd.self_collide(crumpling())
    first = itself.contacts[0]
    assert f"triangle {first['b1']} and triangle {first['b2']}\n" in picture(itself).title
    assert itself.initially_crossing and picture(itself).title.endswith("\nthey cross at t = 0")
    shapes = fcl_ccd.collide(fcl_ccd.Sphere(0.2), fcl_ccd.Box(1, 1, 1), FALLS)
    assert picture(shapes).title.endswith("\nshapes, o1 and o2")
    assert [name for name, _, _ in picture(shapes).objects] == ["o1: Sphere", "o2: Box"]


@pytest.mark.parametrize("query", ["all", "first", "any"])
def test_which_contact_the_title_names(query):
    """By its number, with wide brackets too. Of query="any" it need not be the first."""
    ball, name = fcl_ccd.RigidMesh(*BALL), "a contact" if query == "any" else "first contact"
    manager = fcl_ccd.CollisionManager()
    manager.register("sheet", sheet(), self_collision=True)
    straight = FALLS[0], pose((0.4, 0.5, -1))
    manager.register("ball", ball, straight)
    for toc_err in (1e-4, 0.1):
        options = {"query": query, "toc_err": toc_err}
        result = fcl_ccd.collide(sheet(), ball, None, straight, **options)
        pair = manager.collide(**options).pairs[0].result
        for found in (result, pair):
            assert picture(found).title.startswith(f"{name} at t = ")
    if query == "all":
        assert result.contacts["toc_lo"][0] != result.time_of_contact
        # A crossing at t = 0 is earlier than the contacts.
        crossing = fcl_ccd.self_collide(crumpling())
        assert crossing.initially_crossing and crossing.contacts["toc_lo"][0] > 0
        assert picture(crossing).title.startswith("contact 0 at t = ")


def test_crossing_without_contacts():
    """What only crosses at t = 0 is shown too."""
    triangles = [(0, 1, 2)]
    flat = fcl_ccd.RigidMesh([(-1, -1, 0), (1, -1, 0), (0, 1, 0)], triangles)
    upright = fcl_ccd.RigidMesh([(-0.1, 0, -1), (0.1, 0, -1), (0, 0, 1)], triangles)
    result = fcl_ccd.collide(flat, upright)
    assert result.initially_crossing and len(result.contacts) == 0
    drawn = picture(result)
    assert drawn.title.startswith("first contact at t = 0\ncrossing, triangle 0 of o1")
    assert [len(parts.polygons) for _, _, parts in drawn.objects] == [1, 1]


def test_parts_in_contact():
    """Those until the time of the picture, and the one that is asked for."""
    result = fcl_ccd.collide(sheet(), fcl_ccd.RigidMesh(*BALL), None, FALLS)
    contacts, times = result.contacts, result.contacts["toc_lo"]
    half = float(np.median(times))
    for t, touching in ((half, contacts[times <= half]), (1.0, contacts)):
        for (_, others, parts), b in zip(picture(result, t, None).objects, ("b1", "b2")):
            assert len(parts.polygons) == len(np.unique(touching[b]))
        assert len(picture(result, t, None).places) == len(touching)
    assert picture(result, 1.0, None).is_main.all()
    one = picture(result, 1.0, 5)
    assert (one.places[one.is_main] == contacts["pos"][5]).all() and one.is_main.sum() == 1
    assert len(one.places) == len(contacts)
    # Before it begins too, when nothing is in contact.
    early = picture(result, 0.0, len(contacts) - 1)
    assert [len(parts.polygons) for _, _, parts in early.objects] == [1, 1]
    assert (early.places == contacts["pos"][-1:]).all() and early.is_main.tolist() == [True]
    assert len(others.polygons) + len(parts.polygons) == len(BALL[1])


def test_the_view():
    """It has both parts, and is as large as they are; or has both objects."""
    result = fcl_ccd.collide(sheet(41), fcl_ccd.RigidMesh(*BALL), None, FALLS)
    center, half = picture(result).view
    np.testing.assert_array_equal(center, result.contacts[0]["pos"])
    assert 1 / 40 < half < 3 / 40
    for t in (None, 0.0):
        view = picture(result, t).view
        for _, _, parts in picture(result, t).objects:
            assert _pictures.clipped(parts.polygons, view)
    center, half = picture(result, contact=None).view
    for o in result._queried:
        off = _surfaces.surface_at(o, "o", result.time_of_contact).bounds() - center
        assert (np.abs(off) <= half).all()
    # Of two shapes, and without positions, there is a view too.
    planes = fcl_ccd.collide(fcl_ccd.Plane((0, 0, 1), 0), fcl_ccd.Halfspace((0, 1, 1), 0))
    assert picture(planes).view.half > 0 and len(picture(planes).objects[0][1].polygons) > 0
    bare = fcl_ccd.collide(sheet(41), fcl_ccd.RigidMesh(*BALL), None, FALLS, enable_contact=False)
    assert 1 / 40 < picture(bare).view.half < 3 / 40 and len(picture(bare).places) == 0


def test_the_direction_of_view():
    """The surfaces of the contact that was asked for are seen from their side."""
    corners, triangles = grid(2)
    upright = (corners - 0.5 * corners.max(axis=0)) @ rotation((0, 1, 0), np.pi / 2).T
    # The ball meets a wall with its normal along x, and later one with its normal along y.
    walls = [upright + (0.2, 0, 0), upright @ rotation((0, 0, 1), np.pi / 2).T + (0, 0.4, 0)]
    wall = fcl_ccd.RigidMesh(np.concatenate(walls), np.concatenate([triangles, triangles + 4]))
    flies = pose((0, 0, 0.1)), pose((0.45, 0.45, 0.1))
    result = fcl_ccd.collide(fcl_ccd.RigidMesh(*sphere(6, 7, 0.02)), wall, flies)
    last = len(result.contacts) - 1
    np.testing.assert_allclose(result.contacts["normal"][[0, last]], np.eye(3)[:2], atol=1e-12)
    for contact, t, azimuth in ((0, None, -70), (0, 1, -70), (last, None, 20), (None, 1, -70)):
        assert _figures._azimuth(picture(result, t, contact)) == pytest.approx(azimuth)
    floor = fcl_ccd.collide(sheet(), fcl_ccd.RigidMesh(*BALL), None, FALLS, enable_contact=False)
    assert _figures._azimuth(picture(floor)) == -60  # of a contact without a normal
    require("matplotlib")
    drawn = _figures._part_of_matplotlib("figure").Figure()
    _figures._draw(drawn, picture(result, None, last))
    assert drawn.axes[0].azim == pytest.approx(20)


@pytest.mark.parametrize("enable_contact", [True, False])
def test_places_at_the_origin(enable_contact):
    """A place of zeros is one too, unless the query was asked for none."""
    shapes = fcl_ccd.Sphere(0.2), fcl_ccd.Box(1, 1, 1)
    result = fcl_ccd.collide(*shapes, enable_contact=enable_contact)
    (contact,) = result.contacts
    assert (contact["pos"] == 0).all() and contact["normal"].any() == enable_contact
    for number in (0, None):
        assert len(picture(result, contact=number).places) == enable_contact


def test_a_large_sphere():
    """Of which the picture shows what looks like a plane."""
    small = fcl_ccd.RigidMesh([(-1e-3, -1e-3, 0), (1e-3, -1e-3, 0), (0, 1e-3, 0)], [(0, 1, 2)])
    for radius in (1e13, 1e15):
        falls = pose((0, 0, radius + 1)), pose((0, 0, radius - 1))
        result = fcl_ccd.collide(small, fcl_ccd.Sphere(radius), falls)
        assert result and len(picture(result).objects[1][1].polygons) > 0
        for off in (1e-10, 1e-20):
            assert len(_surfaces._polygons_of(fcl_ccd.Sphere(radius), off * radius)) == 512 * 256


def on_surface(shape, x):
    """How far points are from the surface of a shape, at most up to its size."""
    axis = np.hypot(x[:, 0], x[:, 1])
    if isinstance(shape, fcl_ccd.Sphere):
        return np.linalg.norm(x, axis=1) - shape.radius
    if isinstance(shape, fcl_ccd.Ellipsoid):
        return np.linalg.norm(x / shape.radii, axis=1) - 1
    if isinstance(shape, fcl_ccd.Capsule):
        beyond = np.maximum(np.abs(x[:, 2]) - shape.lz / 2, 0)
        return np.hypot(axis, beyond) - shape.radius
    if isinstance(shape, fcl_ccd.Cone):
        side = axis / shape.radius + (x[:, 2] + shape.lz / 2) / shape.lz - 1
        return np.minimum(np.abs(side), np.abs(x[:, 2] + shape.lz / 2))
    return np.minimum(np.abs(axis - shape.radius), np.abs(np.abs(x[:, 2]) - shape.lz / 2))


ROUND = [
    fcl_ccd.Sphere(0.7),
    fcl_ccd.Ellipsoid(0.3, 0.5, 0.7),
    fcl_ccd.Capsule(0.3, 0.8),
    fcl_ccd.Cone(0.3, 0.8),
    fcl_ccd.Cylinder(0.3, 0.8),
]


@pytest.mark.parametrize("shape", ROUND, ids=[type(shape).__name__ for shape in ROUND])
def test_round_shapes(shape):
    coarse, fine = (_surfaces._polygons_of(shape, half) for half in (np.inf, 0.1))
    assert len(fine) > 1.5 * len(coarse)
    for polygons in (coarse, fine):
        np.testing.assert_allclose(on_surface(shape, polygons.reshape(-1, 3)), 0, atol=1e-12)
        # It is closed: each edge that has a length is there twice.
        edges = {}
        for polygon in polygons.round(9) + 0.0:
            for a, b in zip(map(tuple, polygon), map(tuple, np.roll(polygon, -1, axis=0))):
                if a != b:
                    edges[frozenset((a, b))] = edges.get(frozenset((a, b)), 0) + 1
        assert set(edges.values()) == {2}
    # Middles of the finer polygons are as near as the picture tells.
    middles = fine.mean(axis=1)
    assert np.abs(on_surface(shape, middles)).max() < 0.1 / 50


def test_other_shapes():
    convex = fcl_ccd.Convex(BALL[0], [*BALL[1].tolist()[1:], [0, 1, 2]])
    assert (np.sort(_surfaces._polygons_of(convex, 1), axis=0).shape) == (len(BALL[1]), 3, 3)
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0, 0, 1)], float)
    pyramid = fcl_ccd.Convex(corners, [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])
    fan = _surfaces._polygons_of(pyramid, 1)
    np.testing.assert_array_equal(fan[:2], corners[[(0, 3, 2), (0, 2, 1)]])
    assert len(fan) == 6
    triangle = surface(fcl_ccd.TriangleP(*BALL[0][:3]), pose((0, 0, 1)), 0.5)
    np.testing.assert_array_equal(triangle.bounds(), BALL[0][:3] + (0, 0, 1))
    view = _surfaces.View(np.array([5.0, 6.0, 7.0]), 2.0)
    at = pose((1, 2, 3), (1, 2, 3), 0.7)
    n = at[:3, :3] @ (0, 0.6, 0.8)
    for of in (fcl_ccd.Plane, fcl_ccd.Halfspace):
        drawn = surface(of((0, 3, 4), 10), at, 0).pieces(view, np.empty(0, int))[0].polygons
        np.testing.assert_allclose((drawn - at[:3, 3]) @ n, 2, atol=1e-12)
        assert len(surface(of((0, 3, 4), 10), at, 0).bounds()) == 0
        # It fills the cube: no ray along the normal from a point of the cube misses it.
        assert np.ptp(drawn.reshape(-1, 3), axis=0).max() >= 4


def test_cells():
    """Only faces that are seen, and the cells of contacts, some of which are joined."""
    block = np.mgrid[0:3, 0:2, 0:2].reshape(3, -1).T + 0.5
    octree = fcl_ccd.OcTree(block, 1.0)
    assert octree.num_cells < len(block)
    at, everywhere = pose((1, 0, 0)), _surfaces.View(np.zeros(3), 100.0)
    cells = surface(octree, at, 0)
    others, parts = cells.pieces(everywhere, np.empty(0, int))
    assert len(others.polygons) == 2 * (3 * 2 + 3 * 2 + 2 * 2) and len(parts.polygons) == 0
    faces = {tuple(corner) for corner in others.polygons.reshape(-1, 3).tolist()}
    assert faces == {c for c in itertools.product(range(1, 5), range(3), range(3))} - {(2, 1, 1), (3, 1, 1)}
    result = fcl_ccd.collide(fcl_ccd.Sphere(0.1), octree, pose((0.2, 0.2, 0.2)))
    (number,) = result.contacts["b2"]
    others, parts = surface(octree, None, 0).pieces(everywhere, np.array([number]))
    size = octree.cells([number])["size"][0]
    assert size == 2 and len(parts.polygons) == 6 and len(others.polygons) == 3 * 4
    np.testing.assert_array_equal(np.ptp(parts.corners(), axis=0), [2, 2, 2])
    assert f"cell {number} of o2" in picture(result).title
    assert len(picture(result).objects[1][2].polygons) == 6


def test_many_cells():
    """Tens of thousands are in contact, of three sizes, on both sides of the origin."""
    n = 110
    i, j = (x.ravel() for x in np.mgrid[-n:n, -n:n])
    rough = np.stack([i, j, (7 * i + 3 * j) % 5], axis=1)
    corners = (2, (-6, 4, 16)), (4, (8, -16, 16))
    blocks = [np.mgrid[:w, :w, :w].reshape(3, -1).T + corner for w, corner in corners]
    octree = fcl_ccd.OcTree(np.concatenate([rough, *blocks]) + 0.5, 1.0)
    result = fcl_ccd.collide(fcl_ccd.Halfspace((0, 0, 1), 30), octree)
    numbers, cells = result.contacts["b2"], octree.cells(result.contacts["b2"])
    assert len(numbers) == octree.num_cells == len(rough) + 2
    assert np.unique(cells["size"]).tolist() == [1, 2, 4]
    everywhere = _surfaces.View(np.zeros(3), 1e3)
    others, parts = surface(octree, None, 0).pieces(everywhere, numbers)
    assert len(others.polygons) == 0 and len(parts.polygons) == 6 * len(numbers)
    # Of a half of them, and of the two blocks, the others are what is left.
    is_left = (cells["center"][:, 0] > 0) & (cells["size"] == 1)
    others, parts = surface(octree, None, 0).pieces(everywhere, numbers[~is_left])
    found = {tuple(middle) for middle in others.polygons.mean(axis=1).tolist()}
    there = {tuple(cell) for cell in octree._finest_cells().tolist()}
    steps = [tuple(step) for step in np.concatenate([np.eye(3), -np.eye(3)]).tolist()]
    expected = set()
    for x, y, z in cells["center"][is_left].tolist():
        for dx, dy, dz in steps:
            if (x + dx - 0.5, y + dy - 0.5, z + dz - 0.5) not in there:
                expected.add((x + dx / 2, y + dy / 2, z + dz / 2))
    assert found == expected and len(others.polygons) == len(found)
    # Near a contact there is only what is near it.
    objects = picture(result).objects
    assert 0 < len(objects[1][2].polygons) < 500


def test_free_edges_and_points():
    knots = np.stack([np.linspace(0, 1, 11), np.full(11, 0.4), np.full(11, 0.5)], axis=1)
    edges = np.stack([np.arange(8), np.arange(1, 9)], axis=1)
    cable = fcl_ccd.DeformableMesh(knots, None, edges=edges, points=[9, 10])
    cable.update(knots - (0, 0, 1))
    result = fcl_ccd.collide(cable, sheet(), min_distance=0.01)
    for i, contact in enumerate(result.contacts):
        title, b1 = picture(result, contact=i).title, contact["b1"]
        assert (f"free edge {b1} of o1" if b1 < 8 else f"free point {b1 - 8} of o1") in title
    assert (result.contacts["b1"] >= 8).any() and (result.contacts["b1"] < 8).any()
    (_, others, parts), _ = picture(result, 1.0, None).objects
    assert len(others.segments) + len(parts.segments) == 8
    assert len(others.points) + len(parts.points) == 2
    assert len(parts.segments) > 0 and len(parts.points) > 0


def area(polygons):
    """Of convex polygons."""
    total = 0.0
    for polygon in polygons:
        fans = zip(polygon[1:], polygon[2:])
        total += sum(np.linalg.norm(np.cross(a - polygon[0], b - polygon[0])) for a, b in fans) / 2
    return total


def test_clipping():
    """The parts in the eight octants of a cube have the area of those in the cube."""
    polygons = np.random.default_rng(3).normal(size=(200, 3, 3))
    whole = _surfaces.View(np.array([0.1, 0.2, 0.3]), 1.0)
    octants = [
        _surfaces.View(whole.center + 0.5 * np.array(signs), 0.5)
        for signs in itertools.product((-1, 1), repeat=3)
    ]
    for of in (polygons, polygons * 5, polygons * 0.1):
        parts = [_pictures.clipped(of, view) for view in octants]
        for view, found in zip(octants, parts):
            assert all((np.abs(p - view.center) <= view.half + 1e-12).all() for p in found)
        np.testing.assert_allclose(sum(map(area, parts)), area(_pictures.clipped(of, whole)))
    assert 0 < area(_pictures.clipped(polygons, whole)) < area(polygons)
    np.testing.assert_allclose(area(_pictures.clipped(polygons * 0.1, whole)), area(polygons * 0.1))
    square = 9 * np.array([[(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]], float)
    np.testing.assert_allclose(area(_pictures.clipped(square, whole)), 4)
    segments = square[:, :2] + (0, 9, 0)
    (segment,) = _pictures.clipped(segments, whole)
    np.testing.assert_allclose(segment, [(-0.9, 0, 0), (1.1, 0, 0)])


def near(pixels, colour):
    return np.count_nonzero(np.abs(pixels[..., :3] - colour).max(axis=2) < 0.15)


RED, BLUE, ORANGE = (0.85, 0.0, 0.0), (0.08, 0.30, 0.65), (0.75, 0.38, 0.0)


def test_files(tmp_path):
    require("matplotlib")
    image = pytest.importorskip("matplotlib.image")
    ball = fcl_ccd.RigidMesh(*BALL)
    result = fcl_ccd.collide(sheet(), ball, None, FALLS)
    apart = fcl_ccd.collide(sheet(), ball, None, pose((0.5, 0.5, 2)))
    paths = [tmp_path / name for name in ("first.png", "whole.png", "apart.png")]
    assert result.show(file=paths[0]) is None
    result.show(contact=None, file=str(paths[1]))
    apart.show(file=paths[2])
    first, whole, nothing = (image.imread(path) for path in paths)
    for colour in (RED, BLUE, ORANGE):
        assert near(nothing, colour) == 0
        assert near(first, colour) > 20
    assert near(whole, RED) > 20
    assert near(first, BLUE) > 4 * near(whole, BLUE)  # nearer to the triangle
    for suffix, start in ((".svg", b"<?xml"), (".pdf", b"%PDF")):
        result.show(file=tmp_path / f"picture{suffix}")
        assert (tmp_path / f"picture{suffix}").read_bytes().startswith(start)
    with pytest.raises(ValueError, match="'mesh' is not supported"):
        result.show(file=tmp_path / "contact.mesh")


@pytest.mark.parametrize("o", [*ROUND, fcl_ccd.Box(1, 1, 1), fcl_ccd.OcTree(BALL[0], 0.1)], ids=repr)
def test_every_kind_is_drawn(o, tmp_path):
    require("matplotlib")
    fcl_ccd.collide(crumpling(), o, None, FALLS).show(file=tmp_path / "picture.png")
    fcl_ccd.self_collide(crumpling()).show(contact=3, file=tmp_path / "picture.png")


def test_cables_are_drawn(tmp_path):
    """Of two cables there are no faces at all, of two points no edges."""
    require("matplotlib")
    image = pytest.importorskip("matplotlib.image")
    ends = np.array([(-1, 0, 0), (1, 0, 0), (0, -1, 1), (0, 1, 1)], float)
    cables = [fcl_ccd.DeformableMesh(ends, None, edges=[pair]) for pair in ((0, 1), (2, 3))]
    clouds = [fcl_ccd.DeformableMesh(ends * (0, 1, 1), None, points=[i]) for i in (1, 3)]
    for o1, o2 in (cables, clouds):
        falls = pose(), pose((0, -1 if o1 is clouds[0] else 0, -1))
        result = fcl_ccd.collide(o1, o2, None, falls, min_distance=0.1)
        assert len(result.contacts) == 1
        for contact in (0, None):
            result.show(contact=contact, file=tmp_path / "cables.png")
            pixels = image.imread(tmp_path / "cables.png")
            assert near(pixels, _figures._COLOURS[0][1]) > 3
            assert near(pixels, _figures._COLOURS[1][1]) > 3


def test_windows(monkeypatch):
    require("matplotlib")
    from matplotlib import pyplot

    result = fcl_ccd.collide(sheet(), fcl_ccd.RigidMesh(*BALL), None, FALLS)
    pyplot.switch_backend("agg")
    with pytest.raises(RuntimeError, match=r"backend is agg\). Give a file, for example show\(file="):
        result.show()
    assert pyplot.get_fignums() == []
    shown = []
    monkeypatch.setattr(pyplot, "get_backend", lambda: "a window")
    monkeypatch.setattr(pyplot, "show", lambda: shown.append(pyplot.gcf()))
    result.show()
    (figure,) = shown
    assert figure.axes[0].get_title() == picture(result).title
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert labels == ["o1: DeformableMesh", "o2: RigidMesh", "contact, normal"]
    pyplot.close("all")


def test_the_mesh_has_changed():
    mesh = sheet()
    result = fcl_ccd.collide(fcl_ccd.Sphere(0.3), mesh, FALLS)
    picture(result)
    for wrong in (mesh.current[1:], np.full_like(mesh.current, np.nan)):
        with pytest.raises(ValueError):
            mesh.update(wrong)
    picture(result)  # after an error the mesh is unchanged
    mesh.update(mesh.current)
    with pytest.raises(RuntimeError, match=r"o2 was updated after the query.*copy\.copy\(\) of the mesh"):
        result.show()
    manager = fcl_ccd.CollisionManager()
    manager.register(1, mesh)
    manager.register(2, fcl_ccd.Sphere(0.3), pose((0.5, 0.5, 0.2)))
    result = manager.collide().pairs[0].result
    picture(result)
    mesh.update_topology(TRIANGLES, PREVIOUS, CURRENT)
    with pytest.raises(RuntimeError, match="was updated after the query"):
        result.show()


@pytest.mark.parametrize(
    "wrong, error, text",
    [
        ({"t": 1.5}, ValueError, "t is 1.5. Give a fraction of the step, from 0 to 1"),
        ({"t": np.nan}, ValueError, "t is nan. Give a finite number"),
        ({"t": "1"}, TypeError, r"Result.show\(\): t is of type str. Give a number"),
        ({"contact": -1}, ValueError, "contact is -1"),
        ({"contact": 10**6}, ValueError, r"contact is 1000000. This Result has \d+ contacts, numbered"),
        ({"contact": 0.5}, TypeError, r"Result.show\(\): contact is of type float. Give an integer"),
        ({"file": 3}, TypeError, r"Result.show\(\): file is of type int. Give a path"),
        ({"file": ""}, ValueError, "file is ''. Give the name of a file, for example 'contact.png"),
        ({"file": Path("")}, ValueError, "file is '.'. Give the name of a file"),
        ({"file": "pictures/"}, ValueError, "file is 'pictures/'. Give the name of a file"),
    ],
)
def test_wrong_arguments(wrong, error, text):
    result = fcl_ccd.collide(sheet(), fcl_ccd.RigidMesh(*BALL), None, FALLS)
    with pytest.raises(error, match=text):
        result.show(**wrong)


def test_no_contact_has_no_number():
    apart = fcl_ccd.collide(sheet(), fcl_ccd.RigidMesh(*BALL), None, pose((9, 9, 9)))
    with pytest.raises(ValueError, match="contact is 1. This Result has 0 contacts"):
        apart.show(contact=1)


def test_what_a_result_refers_to():
    """To the objects themselves, in the step of the query."""
    mesh, ball = sheet(), fcl_ccd.Sphere(0.3)
    result = fcl_ccd.collide(mesh, ball, None, FALLS)
    assert result._queried[0] == (mesh, AT_ORIGIN, 1) and result._queried[1][0] is ball
    itself = fcl_ccd.self_collide(mesh)
    assert itself._queried == ((mesh, AT_ORIGIN, 1),) * 2


def test_rotation_of_the_scenes():
    """The reference of these tests: a quarter turn about z."""
    np.testing.assert_allclose(rotation((0, 0, 1), np.pi / 2) @ (1, 0, 0), (0, 1, 0), atol=1e-15)
