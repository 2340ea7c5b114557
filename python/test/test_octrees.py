# SPDX-License-Identifier: BSD-3-Clause
"""Octrees: answers equal those in C++ to the bit, and known ones; wrong inputs."""

import numpy as np
import pytest
import reference
from scenes import crumpled, pose, sphere

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(8)
# Numbers that are the same in single precision, which the reference rounds to.
POINTS = np.random.default_rng(7).uniform(0, 1, (60, 3)).astype(np.float32).astype(float)
BEGIN, END = pose((-0.5, -0.4, 2)), pose((-0.4, -0.5, -1.5), (1, 2, 3), 0.8)


def test_as_in_cpp():
    """Against a cloth, a rigid mesh, a shape and another octree, straight and turning."""
    cloth, ball = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES), fcl_ccd.RigidMesh(*sphere(5, 6, 0.4))
    cloth.update(CURRENT)
    command, box = reference.shape("Box", 0.3, 0.4, 0.5)
    octree = fcl_ccd.OcTree(POINTS, 0.125)
    map_command = f"OcTree {(0.125).hex()} {len(POINTS)} " + " ".join(
        x.hex() for x in POINTS.ravel().tolist()
    )
    commands = [
        reference.deformable(PREVIOUS, CURRENT, TRIANGLES),
        reference.rigid(*sphere(5, 6, 0.4)),
        command,
        map_command,
    ]
    objects, still, asked = [cloth, ball, box, octree], reference.poses(np.eye(4), np.eye(4)), []
    straight = BEGIN, pose((-0.4, -0.5, -1.5))
    for i, o in enumerate(objects):
        for way in (straight, (BEGIN, END)):
            for options in ({}, {"query": "first"}, {"min_distance": 0.02}):
                path = reference.poses(*way)
                commands.append(f"poses {i} 3 {still} {path} {reference.request(**options)}")
                asked.append(((o, octree, None, way), options))
    for (arguments, options), lines in zip(asked, reference.run(commands)[4:]):
        result = fcl_ccd.collide(*arguments, **options)
        assert result.is_collide
        reference.require_same(result, lines)
        cells = octree.cells(result.contacts["b2"])
        assert cells.dtype == fcl_ccd.octree_cell_dtype and (cells["size"] >= 0.125).all()


def test_known_cells():
    """A sphere falls on one of two cells; eight cells that fill a cube are one."""
    octree = fcl_ccd.OcTree([(0.1, 0.1, 0.1), (2.3, 0.1, 0.1), (0.2, 0.1, 0.1)], 0.5)
    assert octree.num_cells == 2 and octree.resolution == 0.5
    down = pose((2.25, 0.25, 2)), pose((2.25, 0.25, 0))
    result = fcl_ccd.collide(octree, fcl_ccd.Sphere(0.5), motion2=down, toc_err=1e-9)
    assert abs(result.time_of_contact - 0.5) < 1e-8  # its lowest point comes to z = 0.5
    (cell,) = octree.cells(result.contacts["b1"])
    np.testing.assert_allclose(cell["center"], (2.25, 0.25, 0.25), atol=1e-12)
    assert cell["size"] == 0.5 and (result.contacts["b2"] == -1).all()
    corners = np.stack(np.meshgrid([0.1, 0.6], [0.1, 0.6], [0.1, 0.6]), axis=-1).reshape(-1, 3)
    cube = fcl_ccd.OcTree(corners, 0.5)
    assert cube.num_cells == 1
    (contact,) = fcl_ccd.collide(cube, fcl_ccd.Sphere(0.1)).contacts
    assert cube.cells([contact["b1"]])["size"][0] == 1
    manager = fcl_ccd.CollisionManager()
    manager.register("map", octree)
    manager.register("ball", fcl_ccd.Sphere(0.5), down)
    (pair,) = manager.collide(toc_err=1e-9).pairs
    assert pair.result.time_of_contact == result.time_of_contact


def test_map_without_cells():
    empty = fcl_ccd.OcTree(np.zeros((0, 3)), 0.5)
    assert empty.num_cells == 0 and "0 cells" in repr(empty)
    assert not fcl_ccd.collide(empty, fcl_ccd.Sphere(1))
    assert not fcl_ccd.collide(fcl_ccd.RigidMesh(*sphere(4, 5)), empty)


@pytest.mark.parametrize(
    "points, resolution, error, text",
    [
        (POINTS[:, :2], 0.1, ValueError, "points has the shape"),
        (POINTS.astype(str), 0.1, TypeError, "points has elements of type"),
        ([(0, 0, 0), (0, np.nan, 0)], 0.1, ValueError, "point 1 is outside of the map"),
        ([(0, 0, np.inf)], 0.1, ValueError, "point 0 is outside of the map"),
        ([(0, 0, 3276.9)], 0.1, ValueError, "Give larger cells"),
        ([(1e300, 0, 0)], 0.1, ValueError, "point 0 is outside of the map"),
        (POINTS, 0, ValueError, "resolution is 0"),
        (POINTS, -1.0, ValueError, "resolution is -1"),
        (POINTS, np.nan, ValueError, "resolution is nan"),
        (POINTS, "small", TypeError, "resolution is of type str"),
    ],
)
def test_wrong_maps(points, resolution, error, text):
    with pytest.raises(error, match=text):
        fcl_ccd.OcTree(points, resolution)


def test_wrong_numbers():
    octree = fcl_ccd.OcTree(POINTS, 0.1)
    for numbers in ([-1], [2**62]):
        with pytest.raises(ValueError, match="not the number of a cell"):
            octree.cells(numbers)
    with pytest.raises(TypeError, match="numbers has elements of type float64"):
        octree.cells([0.5])
    with pytest.raises(TypeError, match="Give a DeformableMesh or a RigidMesh"):
        fcl_ccd.self_collide(octree)
    assert octree.cells([]).shape == (0,)
