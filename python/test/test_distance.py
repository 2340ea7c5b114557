# SPDX-License-Identifier: BSD-3-Clause
"""Least distances in closed form."""

import pickle

import numpy as np
import pytest
from scenes import pose

import fcl_ccd


def passing():
    """A ball that passes another one: centers at the distance 2 at t = 1/4."""
    return (
        fcl_ccd.Sphere(0.25),
        fcl_ccd.Sphere(0.5),
        (pose((-1, 0, 0)), pose((3, 0, 0))),
        pose((0, 2, 0)),
    )


@pytest.mark.parametrize("errors", [{}, {"rel_err": 1e-8}, {"rel_err": 0, "abs_err": 1e-2}])
def test_balls_that_pass(errors):
    result = fcl_ccd.distance(*passing(), **errors)
    assert result.distance_lo <= 1.25 <= result.distance_hi
    wanted = max(errors.get("rel_err", 1e-3) * result.distance_hi, errors.get("abs_err", 0))
    assert result.distance_hi - result.distance_lo <= wanted + 1e-11
    assert abs(result.time - 0.25) < 0.2
    ends = result.nearest_points
    assert ends.shape == (2, 3)
    assert abs(np.linalg.norm(ends[1] - ends[0]) - result.distance_hi) < 1e-11
    assert (result.b1, result.b2) == (-1, -1)
    assert not result.is_collide and not result.is_cut_off


def test_what_is_further_apart_is_cut_off():
    result = fcl_ccd.distance(*passing(), max_distance=1)
    assert result.is_cut_off
    assert result.distance_lo == 1 <= result.distance_hi


def test_what_touches():
    ball, other, _, place = passing()
    result = fcl_ccd.distance(ball, other, (pose((0, 0, 0)), pose((0, 2, 0))), place)
    assert result.is_collide
    assert result.distance_lo == result.distance_hi == 0
    assert abs(result.time - 1.25 / 2) < 1e-4


def test_a_mesh_that_deforms_and_filters():
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (9, 9, 9), (8, 9, 9), (9, 8, 9)], float)
    mesh = fcl_ccd.DeformableMesh(vertices, [(0, 1, 2), (3, 4, 5)])
    mesh.update(vertices + [0, 0, 0.5])
    ball = fcl_ccd.Sphere(0.5)
    result = fcl_ccd.distance(mesh, ball, None, pose((0.25, 0.25, 3)))
    assert result.distance_lo <= 2 <= result.distance_hi
    assert result.b1 == 0 and result.time == 1
    other = fcl_ccd.distance(
        mesh, ball, None, pose((0.25, 0.25, 3)), accepts_triangles=lambda b1, b2: b1 == 1
    )
    assert other.b1 == 1 and other.distance_lo > 5
    none = fcl_ccd.distance(mesh, ball, filter1=fcl_ccd.Filter(mask=0))
    assert none.distance_lo == none.distance_hi == np.inf


def test_results_can_be_pickled():
    result = fcl_ccd.distance(*passing())
    again = pickle.loads(pickle.dumps(result))
    assert (again.distance_lo, again.time) == (result.distance_lo, result.time)


def test_errors():
    with pytest.raises(ValueError, match="rel_err is negative"):
        fcl_ccd.distance(*passing(), rel_err=-1)
    with pytest.raises(ValueError, match="max_distance is not above 0"):
        fcl_ccd.distance(*passing(), max_distance=0)
    plane = fcl_ccd.Plane((0, 0, 1), 0)
    with pytest.raises(ValueError, match=r"distance\(\): o1 and o2 are both a plane"):
        fcl_ccd.distance(plane, plane)
