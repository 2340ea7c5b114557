# SPDX-License-Identifier: BSD-3-Clause
"""Memory: arrays live on their own, and nothing is lost in many steps."""

import copy
import gc
import sys
import weakref

import numpy as np
from scenes import crumpled, pose, sphere

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(5)


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as file:
        return 4096 * int(file.read().split()[1])


def bounded(i, kept=None):
    return fcl_ccd.BoundedMotion(
        lambda t: (kept, pose((0.5, 0.5, 0.1 + 1e-6 * i)))[1],
        lambda t: np.zeros((4, 4)),
        lambda center, radius, t0, t1: 0,
        lambda t0, t1: 0,
    )


def one_step(mesh, ball, i):
    """Every call of the module, some of which fail."""
    mesh.update(PREVIOUS, CURRENT)
    mesh.update(CURRENT + 1e-6 * i)
    if i % 4 == 0:
        mesh.update_topology(TRIANGLES, PREVIOUS, CURRENT)
    fcl_ccd.self_collide(mesh, accepts_triangles=lambda b1, b2: b1 != b2 + 7)
    filter1 = fcl_ccd.Filter(triangle_groups=np.ones(len(TRIANGLES), int))
    fcl_ccd.collide(mesh, ball, None, pose((0.5, 0.5, 0.1)), filter1=filter1, enable_crossings=True)
    fcl_ccd.collide(mesh, fcl_ccd.Sphere(0.2 + 1e-6 * i), None, pose((0.5, 0.5, 0.1)))
    if i % 10 == 5:
        fcl_ccd.collide(ball, fcl_ccd.OcTree(PREVIOUS[:5] + 1e-6 * i, 0.1)).contacts.copy()
        fcl_ccd.collide(fcl_ccd.Sphere(0.2), ball, None, bounded(i), query="any")
        fcl_ccd.collide(fcl_ccd.Compound([(ball, None), (fcl_ccd.Box(1, 1, 1), None)]), ball)
    manager = fcl_ccd.CollisionManager()
    manager.register("mesh", mesh, self_collision=True)
    manager.register("ball", ball, pose((0.5, 0.5, 0.1)))
    manager.update({"ball": pose((0.5, 0.5, 0.2))})
    manager.collide()
    manager.unregister("mesh")
    fcl_ccd.self_candidates(mesh)
    t0, t1 = PREVIOUS[:24].reshape(6, 4, 3), CURRENT[:24].reshape(6, 4, 3)
    fcl_ccd.vertex_face(t0, t1)
    fcl_ccd.edge_edge(t0, t1)
    if i % 10 == 0:
        fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
        fcl_ccd.RigidMesh(*sphere(4, 5))
        fcl_ccd.Convex(sphere(4, 5)[0], sphere(4, 5)[1])
        for wrong in (
            lambda: manager.update({"ball": np.full((4, 4), np.inf)}),
            lambda: mesh.update(PREVIOUS[1:]),
            lambda: fcl_ccd.self_collide(mesh, toc_err=-1),
            lambda: fcl_ccd.self_collide(mesh, accepts_triangles=lambda b1, b2: 1 // 0),
            lambda: fcl_ccd.vertex_face(t0, np.full_like(t1, np.nan)),
        ):
            try:
                wrong()
            except (ValueError, ZeroDivisionError):
                continue
            raise AssertionError("a wrong call was accepted")


def test_no_leak_in_10000_steps():
    mesh, ball = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES), fcl_ccd.RigidMesh(*sphere(4, 5, 0.5))

    def references():
        return [sys.getrefcount(x) for x in (PREVIOUS, CURRENT, TRIANGLES, mesh, ball)]

    for i in range(1000):
        one_step(mesh, ball, i)
    gc.collect()
    before, references_before = resident_bytes(), references()
    for i in range(10000):
        one_step(mesh, ball, i)
    gc.collect()
    # A leak of 50 bytes a step is seen.
    assert resident_bytes() - before < 512 * 1024
    assert references() == references_before


def test_arrays_outlive_mesh_and_result():
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    mesh.update(CURRENT)
    result = fcl_ccd.self_collide(mesh)
    contacts, copied = result.contacts, result.contacts.copy()
    blocks = []
    fcl_ccd.self_candidates(mesh, blocks.append, block=1)
    kept = blocks[0].copy()
    del mesh, result
    gc.collect()
    _ = [np.random.default_rng(i).normal(size=1000) for i in range(1000)]
    for name in fcl_ccd.contact_dtype.names:
        np.testing.assert_array_equal(contacts[name], copied[name])
    np.testing.assert_array_equal(blocks[0], kept)
    assert contacts.size > 0 and kept.size > 0


class Stepped(fcl_ccd.DeformableMesh):
    """A mesh that keeps its last result, which refers to it."""


def test_results_keep_their_objects():
    """No longer than they live, also if they are part of a cycle."""
    mesh = Stepped(PREVIOUS, TRIANGLES)
    alive, result = weakref.ref(mesh), fcl_ccd.self_collide(mesh)
    del mesh
    gc.collect()
    assert alive() is not None
    mesh = result._queried[0][0]
    mesh.results = [result]
    mesh.results.append(fcl_ccd.collide(mesh, fcl_ccd.Sphere(0.2), None, bounded(0, kept=mesh)))
    manager = fcl_ccd.CollisionManager()
    manager.register("mesh", mesh, bounded(0, kept=mesh))
    mesh.results.append(manager.collide(mesh))
    del mesh, manager, result
    gc.collect()
    assert alive() is None


class OtherMesh:
    """As a trimesh.Trimesh."""

    vertices, faces = CURRENT, TRIANGLES


def test_deep_copies_of_results_keep_no_objects():
    """A way out of a loop that keeps its results, also of meshes that each call makes."""
    results = [fcl_ccd.collide(OtherMesh(), fcl_ccd.Sphere(0.5)) for _ in range(3)]
    alive = [weakref.ref(result._queried[0][0]) for result in results]
    assert all(isinstance(mesh(), fcl_ccd.RigidMesh) for mesh in alive)
    results = copy.deepcopy(results)
    gc.collect()
    assert not any(mesh() for mesh in alive) and all(results)


def test_mesh_does_not_keep_the_arrays():
    """A frame may be overwritten after the call that took it."""
    frame = CURRENT.copy()
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    mesh.update(frame)
    frame[:] = np.nan
    np.testing.assert_array_equal(mesh.current, CURRENT)
