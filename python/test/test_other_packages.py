# SPDX-License-Identifier: BSD-3-Clause
"""Meshes of other packages are taken as they are. None of the packages is needed."""

from types import SimpleNamespace

import numpy as np
import pytest
from scenes import crumpled, pose, sphere

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(7)
BALL = sphere(5, 6, 0.4)


class TrackedArray(np.ndarray):
    """As trimesh's, an array of a class of its own."""


class Trimesh:
    """What trimesh.Trimesh has. Its triangles are positions."""

    def __init__(self, vertices, faces):
        self._vertices = np.asarray(vertices, float)
        self._faces = np.asarray(faces)

    @property
    def vertices(self):
        return self._vertices.view(TrackedArray)

    @property
    def faces(self):
        return self._faces.view(TrackedArray)

    @property
    def triangles(self):
        return self._vertices[self._faces]


class Vector3dVector(list):
    """As Open3D's, a sequence of triples."""


def open3d(vertices, triangles):
    return SimpleNamespace(
        vertices=Vector3dVector(map(tuple, vertices)),
        triangles=Vector3dVector(map(tuple, triangles)),
    )


KINDS = pytest.mark.parametrize("kind", [Trimesh, open3d])


def require_same(result, expected):
    assert expected
    for name in fcl_ccd.contact_dtype.names:
        np.testing.assert_array_equal(result.contacts[name], expected.contacts[name])


@KINDS
def test_rigid_meshes(kind):
    cloth = fcl_ccd.RigidMesh(PREVIOUS, TRIANGLES)
    expected = fcl_ccd.collide(cloth, fcl_ccd.RigidMesh(*BALL))
    require_same(fcl_ccd.collide(cloth, fcl_ccd.RigidMesh(kind(*BALL))), expected)
    require_same(fcl_ccd.collide(cloth, kind(*BALL)), expected)
    require_same(fcl_ccd.collide(kind(PREVIOUS, TRIANGLES), kind(*BALL)), expected)
    manager = fcl_ccd.CollisionManager()
    manager.register("cloth", kind(PREVIOUS, TRIANGLES))
    require_same(manager.collide(kind(*BALL)).pairs[0].result, fcl_ccd.collide(kind(*BALL), cloth))
    assert len(fcl_ccd.candidates(cloth, kind(*BALL))) > 0


@KINDS
def test_meshes_that_deform(kind):
    expected = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    expected.update(CURRENT)
    for frames in ((kind(CURRENT, TRIANGLES),), (PREVIOUS, kind(CURRENT, TRIANGLES))):
        mesh = fcl_ccd.DeformableMesh(kind(PREVIOUS, TRIANGLES))
        mesh.update(*frames)
        require_same(fcl_ccd.self_collide(mesh), fcl_ccd.self_collide(expected))
    joined = fcl_ccd.weld_vertices([kind(PREVIOUS, TRIANGLES)])
    np.testing.assert_array_equal(joined, np.arange(len(PREVIOUS)))
    assert fcl_ccd.OcTree(kind(PREVIOUS, TRIANGLES), 0.1).num_cells > 0


@KINDS
def test_from_trimesh(kind):
    """The same meshes by another name."""
    expected = fcl_ccd.collide(fcl_ccd.RigidMesh(PREVIOUS, TRIANGLES), fcl_ccd.RigidMesh(*BALL))
    cloth = fcl_ccd.DeformableMesh.from_trimesh(kind(PREVIOUS, TRIANGLES), num_threads=2)
    ball = fcl_ccd.RigidMesh.from_trimesh(kind(*BALL))
    assert cloth.num_threads == 2 and type(ball) is fcl_ccd.RigidMesh
    require_same(fcl_ccd.collide(cloth, ball), expected)


@pytest.mark.parametrize("of", [fcl_ccd.DeformableMesh, fcl_ccd.RigidMesh])
def test_from_trimesh_refuses(of):
    wanted = r"\(\): mesh is of type {}. Give a mesh with vertices and faces, for example a trimesh"
    with pytest.raises(TypeError, match="from_trimesh" + wanted.format("ndarray")):
        of.from_trimesh(PREVIOUS)
    scene = SimpleNamespace(geometry={}, graph=None)  # as trimesh.Scene
    with pytest.raises(TypeError, match=wanted.format("SimpleNamespace") + r".*force='mesh'"):
        of.from_trimesh(scene)


@KINDS
def test_convex(kind):
    expected = fcl_ccd.collide(fcl_ccd.Convex(*BALL), fcl_ccd.Sphere(0.2), pose((0.5, 0, 0)))
    made = fcl_ccd.Convex(kind(*BALL))
    assert made.num_faces == len(BALL[1])
    require_same(fcl_ccd.collide(made, fcl_ccd.Sphere(0.2), pose((0.5, 0, 0))), expected)


def test_errors():
    mesh = Trimesh(*BALL)
    for make in (fcl_ccd.RigidMesh, fcl_ccd.DeformableMesh):
        with pytest.raises(TypeError, match="vertices is a mesh that has triangles, and triangles is"):
            make(mesh, BALL[1])
        with pytest.raises(ValueError, match=r"triangles has the shape \(1, 4\)"):
            make(Trimesh(BALL[0], [(0, 1, 2, 3)]))
        with pytest.raises(ValueError, match="triangle 0 refers to vertex 99"):
            make(Trimesh(BALL[0], [(0, 1, 99)]))
    with pytest.raises(TypeError, match=r"RigidMesh\(\): triangles is of type NoneType"):
        fcl_ccd.RigidMesh(BALL[0])
    with pytest.raises(ValueError, match="the mesh has no triangles. Give some, or free edges"):
        fcl_ccd.DeformableMesh(BALL[0])
    cloud = SimpleNamespace(vertices=BALL[0])  # as trimesh.PointCloud
    with pytest.raises(TypeError, match="vertices"):
        fcl_ccd.RigidMesh(cloud)
