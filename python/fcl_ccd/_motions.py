# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from typing import TYPE_CHECKING, Optional, Union

import numpy as np

from . import _arguments, _core

if TYPE_CHECKING:
    from typing import Sequence

    from numpy.typing import ArrayLike


class Motion:
    """The path of a mesh or a shape during a step: LinearMotion, ScrewMotion or SplineMotion."""

    _path: _core.Motion


class LinearMotion(Motion):
    """A motion that turns at constant speed about a point, which goes straight.

    begin, end : (4, 4) arrays, the poses at t = 0 and t = 1. The mesh turns the shorter
        way round, by at most 180 degrees.
    reference : (3,) array, the point about which it turns, in the frame of the mesh

    A mesh that deforms does so in the frame that turns.
    """

    def __init__(
        self, begin: ArrayLike, end: ArrayLike, reference: ArrayLike = (0.0, 0.0, 0.0)
    ) -> None:
        name = "a pose of LinearMotion"
        self._path = _core.Motion.turn(
            _arguments.pose(begin, name),
            _arguments.pose(end, name),
            _arguments.numbers(reference, "reference", 3),
            name,
        )


class ScrewMotion(Motion):
    """A motion that turns about an axis and slides along it, at constant speed.

    begin, end : (4, 4) arrays, the poses at t = 0 and t = 1, which determine the axis
    """

    def __init__(self, begin: ArrayLike, end: ArrayLike) -> None:
        name = "a pose of ScrewMotion"
        self._path = _core.Motion.screw(
            _arguments.pose(begin, name), _arguments.pose(end, name), name
        )


class SplineMotion(Motion):
    """A motion on cubic B-splines, as FCL's SplineMotion.

    translation : (4, 3) array, the control points of the position of the origin
    rotation : (4, 3) array, the control points of the rotation vector, in radians

    The pose at t = 0 is (c0 + 4 c1 + c2) / 6 of each, at t = 1 (c1 + 4 c2 + c3) / 6.
    """

    def __init__(self, translation: ArrayLike, rotation: ArrayLike) -> None:
        self._path = _core.Motion.spline(
            _arguments.numbers(translation, "translation", 4, 3),
            _arguments.numbers(rotation, "rotation", 4, 3),
        )


MotionLike = Optional[Union[Motion, "ArrayLike", "Sequence[ArrayLike]"]]

_AT_ORIGIN = _core.Motion.straight(np.eye(4), np.eye(4), "identity")


def path_of(motion: MotionLike, name: str) -> _core.Motion:
    """The path of None, a pose, two poses or a Motion."""
    if motion is None:
        return _AT_ORIGIN
    if isinstance(motion, Motion):
        return motion._path
    poses = np.asarray(motion)
    if poses.shape == (4, 4):
        pose = _arguments.pose(poses, name)
        return _core.Motion.straight(pose, pose, name)
    if poses.shape == (2, 4, 4):
        return _core.Motion.straight(
            _arguments.pose(poses[0], name), _arguments.pose(poses[1], name), name
        )
    raise ValueError(
        f"{name} has the shape {poses.shape}. Give a pose of shape (4, 4), a pair of poses, or a "
        "LinearMotion, ScrewMotion or SplineMotion"
    )
