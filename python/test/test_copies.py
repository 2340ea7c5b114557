# SPDX-License-Identifier: BSD-3-Clause
"""Copies and pickles: they give the same answers, to the bit."""

import copy
import dataclasses
import pickle
import subprocess
import sys

import numpy as np
import pytest
from scenes import crumpled, grid, pose, sphere

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(9)
BALL = sphere(6, 7, 0.3)
FALLS = pose((0.5, 0.5, 1)), pose((0.4, 0.5, -1), (1, 2, 3), 1.1)


def copies(of):
    """All the ways to copy an object."""
    made = [copy.copy(of), copy.deepcopy(of)]
    made += [pickle.loads(pickle.dumps(of, p)) for p in range(pickle.HIGHEST_PROTOCOL + 1)]
    assert all(type(x) is type(of) and x is not of for x in made)
    return made


def require_same(result, expected):
    for name in fcl_ccd.contact_dtype.names:
        np.testing.assert_array_equal(result.contacts[name], expected.contacts[name])
    assert result.time_of_contact == expected.time_of_contact
    assert result.is_collide == expected.is_collide
    np.testing.assert_array_equal(result.contact_tf2, expected.contact_tf2)


def deforming():
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES, num_threads=2)
    mesh.update(CURRENT)
    return mesh


def after_many_steps():
    mesh = deforming()
    for i in range(5):
        mesh.update(PREVIOUS + 0.1 * i, CURRENT * (1, 1, 1 - 0.1 * i))
    return mesh


def with_free_features():
    edges = np.stack([np.arange(80), np.arange(1, 81)], axis=1)
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES[:50], edges=edges, points=[5, 80, 7])
    mesh.update(CURRENT)
    return mesh


def torn():
    mesh = deforming()
    mesh.update_topology(TRIANGLES[::2], PREVIOUS, CURRENT)
    return mesh


GEOMETRIES = {
    "rigid": fcl_ccd.RigidMesh(*BALL),
    "at_rest": fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES),
    "deforming": deforming(),
    "after_many_steps": after_many_steps(),
    "with_free_features": with_free_features(),
    "torn": torn(),
    "only_points": fcl_ccd.DeformableMesh(PREVIOUS, None, points=np.arange(len(PREVIOUS))),
    "Box": fcl_ccd.Box(0.3, 1 / 3, 0.5),
    "Sphere": fcl_ccd.Sphere(1 / 3),
    "Capsule": fcl_ccd.Capsule(0.2, 0.4),
    "Ellipsoid": fcl_ccd.Ellipsoid(0.3, 0.2, 1 / 3),
    "Cone": fcl_ccd.Cone(0.3, 0.4),
    "Cylinder": fcl_ccd.Cylinder(0.3, 0.4),
    "Convex": fcl_ccd.Convex(BALL[0], BALL[1]),
    "Plane": fcl_ccd.Plane((0.1, 0.2, 0.7), -0.1),
    "Halfspace": fcl_ccd.Halfspace((0.3, 0.2, 0.7), -0.1),
    "TriangleP": fcl_ccd.TriangleP(*BALL[0][:3]),
    "OcTree": fcl_ccd.OcTree(CURRENT, 0.07),
    "Compound": fcl_ccd.Compound(
        [(fcl_ccd.Sphere(1 / 3), None), (fcl_ccd.RigidMesh(*BALL), pose((0.5, 0, 0), (1, 1, 2), 1))]
    ),
}


@pytest.mark.parametrize("of", GEOMETRIES.values(), ids=GEOMETRIES.keys())
def test_geometries(of):
    other = deforming()
    expected = [fcl_ccd.collide(other, of, None, FALLS, query=q) for q in ("all", "first")]
    for same in copies(of):
        assert repr(same) == repr(of)
        for query, answer in zip(("all", "first"), expected):
            require_same(fcl_ccd.collide(other, same, None, FALLS, query=query), answer)


def test_normals_keep_their_bits():
    """They are divided by their length once."""
    random = np.random.default_rng(5)
    for n in random.normal(size=(2000, 3)):
        for of in (fcl_ccd.Plane(n, 0.7), fcl_ccd.Halfspace(n, 0.7)):
            same = copy.copy(of)
            assert (same.n == of.n).all() and same.d == of.d


def test_parts_of_meshes():
    mesh = with_free_features()
    for same in copies(mesh):
        for name in ("previous", "current", "triangles", "edges", "points"):
            np.testing.assert_array_equal(getattr(same, name), getattr(mesh, name))
        assert same.is_deforming and same.num_threads == 1
        require_same(fcl_ccd.self_collide(same), fcl_ccd.self_collide(mesh))
        same.update(PREVIOUS)  # it has its own frames
        assert (mesh.current == CURRENT).all()
    assert copy.copy(deforming()).num_threads == 2
    assert not copy.copy(GEOMETRIES["at_rest"]).is_deforming


def test_a_copy_is_of_one_step():
    """No step comes in between its parts, here one that comes when triangles are read."""

    class Stepping(fcl_ccd.DeformableMesh):
        @property
        def triangles(self):
            found = super().triangles
            self.update(self.current * 2)
            return found

    mesh = Stepping(PREVIOUS, TRIANGLES)
    mesh.update(PREVIOUS * 2)
    same = copy.copy(mesh)
    np.testing.assert_array_equal(same.previous, PREVIOUS)
    np.testing.assert_array_equal(same.current, PREVIOUS * 2)
    assert mesh.triangles.tolist() == TRIANGLES.tolist()
    np.testing.assert_array_equal(mesh.current, PREVIOUS * 4)


@pytest.mark.parametrize("resolution", [1 / 3, 1.0, 1e-3])
def test_cells_of_octrees(resolution):
    """Also cells that were joined, negative ones, and those at the border of the map."""
    block = np.mgrid[-8:8, -8:8, -3:8].reshape(3, -1).T + 0.5
    far = np.array([(-32768, 32767, 0), (32767, 32767, 32767), (-32768, -32768, -32768)]) + 0.5
    of = fcl_ccd.OcTree(np.concatenate([block, far]) * resolution, resolution)
    assert of.num_cells < len(block)
    for same in copies(of):
        assert same.num_cells == of.num_cells and same.resolution == of.resolution
        np.testing.assert_array_equal(same._finest_cells(), of._finest_cells())
    assert copy.copy(fcl_ccd.OcTree(np.empty((0, 3)), 0.1)).num_cells == 0


def moves(t):
    out = np.eye(4)
    out[:3, 3] = 0.5, 0.5, 1 - 2 * t
    return out


def rate(t):
    out = np.zeros((4, 4))
    out[2, 3] = -2
    return out


def no_acceleration(center, radius, t0, t1):
    return 0


def no_speed(t0, t1):
    return 0


def robot():
    chain = fcl_ccd.JointChain()
    chain.add_prismatic(fcl_ccd.urdf_origin((0.5, 0.5, 1)), (0, 0, 1))
    chain.add_revolute(fcl_ccd.urdf_origin(rpy=(0.1, 0.2, 0.3)), (0, 0, 1))
    chain.add_fixed(parent=1)
    return chain


MOTIONS = {
    "TwistMotion": fcl_ccd.TwistMotion(FALLS[0], (0, 0, -2), (0.1, 9, 0), "straight"),
    "WaypointMotion": fcl_ccd.WaypointMotion([FALLS[0], FALLS[0], FALLS[1]], (0, 0.2, 1)),
    "LinkMotion": fcl_ccd.ChainMotion(robot(), [0, 1], [-2, 2]).link(2),
    "polynomial": fcl_ccd.ChainMotion.polynomial(robot(), [[0, 0, -2], [1]], np.eye(4)).link(1),
    "LinearMotion": fcl_ccd.LinearMotion(*FALLS, (0.1, 0.2, 0.3)),
    "ScrewMotion": fcl_ccd.ScrewMotion(*FALLS),
    "SplineMotion": fcl_ccd.SplineMotion(
        [(0.5, 0.5, z) for z in (1, 0.5, -0.5, -1)], np.eye(4)[:, :3] / 3
    ),
    "BoundedMotion": fcl_ccd.BoundedMotion(moves, rate, no_acceleration, no_speed),
}


@pytest.mark.parametrize("of", MOTIONS.values(), ids=MOTIONS.keys())
def test_motions(of):
    mesh, ball = GEOMETRIES["at_rest"], GEOMETRIES["TriangleP"]
    expected = fcl_ccd.collide(mesh, ball, None, of, query="first")
    assert expected
    for same in copies(of):
        require_same(fcl_ccd.collide(mesh, ball, None, same, query="first"), expected)


def test_chains():
    """Also those that are changed later, and classes of the user."""

    class Robot(fcl_ccd.JointChain):
        pass

    of = Robot()
    of.add_revolute(fcl_ccd.urdf_origin((1, 2, 3), (0.1, 0.2, 0.3)), (1, 2, 3))
    of.name = "robot"
    same = copy.copy(of)
    of.add_prismatic()
    assert (same.num_links, same.num_values, same.name) == (1, 1, "robot")
    assert type(same) is Robot and repr(same) == "JointChain(1 links, 1 values)"
    motion = fcl_ccd.ChainMotion(robot(), [0, 1], [-2, 2])
    mesh, ball = GEOMETRIES["at_rest"], GEOMETRIES["TriangleP"]
    expected = fcl_ccd.collide(mesh, ball, None, motion.link(1), query="first")
    for again in (copy.copy(motion), copy.deepcopy(motion), pickle.loads(pickle.dumps(motion))):
        require_same(fcl_ccd.collide(mesh, ball, None, again.link(1), query="first"), expected)


def test_motions_do_not_keep_the_arrays():
    begin, end = FALLS[0].copy(), FALLS[1].copy()
    motion = fcl_ccd.LinearMotion(begin, end)
    expected = fcl_ccd.collide(GEOMETRIES["rigid"], deforming(), motion)
    begin[:], end[:] = np.nan, np.nan
    require_same(fcl_ccd.collide(GEOMETRIES["rigid"], deforming(), copy.copy(motion)), expected)


def test_functions_that_cannot_be_pickled():
    own = fcl_ccd.BoundedMotion(lambda t: moves(t), rate, no_acceleration, no_speed)
    assert fcl_ccd.collide(deforming(), GEOMETRIES["rigid"], None, copy.deepcopy(own))
    with pytest.raises((AttributeError, pickle.PicklingError), match="lambda"):
        pickle.dumps(own)


def test_filters():
    mesh = deforming()
    groups = np.arange(len(TRIANGLES)) % 3 + 1
    of = fcl_ccd.Filter(2**32 - 1, 5, triangle_groups=groups, triangle_masks=groups[::-1])
    expected = fcl_ccd.self_collide(mesh, filter1=of)
    assert 0 < len(expected.contacts) < len(fcl_ccd.self_collide(mesh).contacts)
    for same in copies(of):
        assert (same.group, same.mask) == (2**32 - 1, 5)
        require_same(fcl_ccd.self_collide(mesh, filter1=same), expected)


class Named(fcl_ccd.RigidMesh):
    """A class of the user, whose __init__() takes other arguments."""

    def __init__(self, name):
        super().__init__(*BALL)
        self.name = name


def test_results():
    """A shallow copy refers to the same objects. The others have none, and are as small."""
    mesh = deforming()
    of = fcl_ccd.collide(mesh, fcl_ccd.Sphere(0.3), None, FALLS)
    shallow, *others = copies(of)
    require_same(shallow, of)
    assert shallow._queried is of._queried and shallow.contacts is of.contacts
    for same in others:
        require_same(same, of)
        with pytest.raises(ValueError, match="is a deep copy, or was pickled.*that the query gave"):
            same.show()
    changed = dataclasses.replace(of, contacts_cut=True)
    require_same(changed, of)
    with pytest.raises(ValueError, match="does not have the objects of its query"):
        changed.show()
    assert len(pickle.dumps(of)) < len(pickle.dumps(of.contacts)) + 3000
    manager = fcl_ccd.CollisionManager()
    manager.register("mesh", mesh, self_collision=True)
    found = manager.collide()
    shallow, *others = copies(found)
    assert shallow.pairs[0].result._queried[0][0] is mesh
    for same in others:
        require_same(same.pairs[0].result, found.pairs[0].result)
        assert same.pairs[0].result._queried is None


def test_results_as_dicts():
    """Numbers and arrays, without the objects of the query."""
    result = fcl_ccd.collide(deforming(), fcl_ccd.Sphere(0.3), None, MOTIONS["BoundedMotion"])
    fields = dataclasses.asdict(result)
    assert list(fields)[:3] == ["is_collide", "time_of_contact", "contacts"]
    assert not [name for name in fields if name.startswith("_")]
    np.testing.assert_array_equal(fields["contacts"], result.contacts)
    assert pickle.loads(pickle.dumps(fields)).keys() == fields.keys()
    manager = fcl_ccd.CollisionManager()
    manager.register("ball", fcl_ccd.Sphere(0.3))
    found = dataclasses.asdict(manager.collide(deforming()))
    assert found["pairs"][0]["o2"] == "ball" and found["pairs"][0]["result"]["is_collide"]


def test_classes_of_the_user():
    of = Named(["ball"])
    shallow, *deep = copies(of)
    assert shallow.name is of.name
    for same in deep:
        assert same.name == ["ball"] and same.name is not of.name and repr(same) == repr(of)
        require_same(fcl_ccd.collide(deforming(), same), fcl_ccd.collide(deforming(), of))


def test_one_object_in_many_places():
    mesh = deforming()
    first, (second,) = pickle.loads(pickle.dumps((mesh, [mesh])))
    assert first is second
    assert copy.deepcopy({"a": mesh, "b": mesh})["a"] is not mesh


def test_another_process(tmp_path):
    """A mesh and a query in a pool of processes, for example."""
    file = tmp_path / "scene.pickle"
    file.write_bytes(pickle.dumps((deforming(), fcl_ccd.Sphere(0.3), FALLS)))
    code = f"""
import pickle, sys, fcl_ccd
mesh, ball, falls = pickle.load(open({str(file)!r}, "rb"))
result = fcl_ccd.collide(mesh, ball, None, falls)
sys.stdout.buffer.write(pickle.dumps(result))
"""
    done = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, check=True)
    expected = fcl_ccd.collide(deforming(), fcl_ccd.Sphere(0.3), None, FALLS)
    assert expected
    require_same(pickle.loads(done.stdout), expected)
