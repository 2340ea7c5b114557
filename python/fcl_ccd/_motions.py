# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, Optional, Tuple, Union

import numpy as np

from . import _arguments, _core

if TYPE_CHECKING:
    from typing import Literal, Sequence

    from numpy.typing import ArrayLike


class Motion(_arguments.Built):
    """The path of an object during a step: for example a LinearMotion."""

    _path: _core.Motion
    _made_by: Tuple[str, Tuple[Any, ...]]

    def _make(self, kind: str, *given: Any) -> None:
        """Arrays of the user are copied: copies of the motion are made from them."""
        kept = [np.array(x) if isinstance(x, np.ndarray) else x for x in given]
        self._path, self._made_by = _MAKERS[kind](*kept), (kind, tuple(kept))

    def __reduce_ex__(self, protocol: Any) -> Tuple[Any, ...]:
        kind, given = self._made_by
        attributes = {k: v for k, v in self.__dict__.items() if k not in ("_path", "_made_by")}
        return _remade, (type(self), kind, given), attributes


def _remade(of: Any, kind: str, given: Tuple[Any, ...]) -> Any:
    """A motion of the class, whose own __init__() may take other arguments."""
    motion = of.__new__(of)
    motion._make(kind, *given)
    return motion


class LinearMotion(Motion):
    """A motion that turns at constant speed about a point, which goes straight.

    begin, end : (4, 4) arrays, the poses at t = 0 and t = 1. The mesh turns the shorter
        way round, by at most 180 degrees. Both ways of a half turn are equally long up to
        rounding: give two steps of 90 degrees if the way matters.
    reference : (3,) array, the point about which it turns, in the frame of the mesh

    A mesh that deforms does so in the frame that turns.
    """

    def __init__(
        self, begin: ArrayLike, end: ArrayLike, reference: ArrayLike = (0.0, 0.0, 0.0)
    ) -> None:
        name = "a pose of LinearMotion"
        self._make(
            "turn",
            _arguments.pose(begin, "begin"),
            _arguments.pose(end, "end"),
            _arguments.numbers(reference, "reference", 3),
            name,
        )


class ScrewMotion(Motion):
    """A motion that turns about an axis and slides along it, at constant speed.

    begin, end : (4, 4) arrays, the poses at t = 0 and t = 1, which determine the axis. Of
        a half turn rounding decides the sign of the axis, as for LinearMotion.
    """

    def __init__(self, begin: ArrayLike, end: ArrayLike) -> None:
        name = "a pose of ScrewMotion"
        self._make(
            "screw", _arguments.pose(begin, "begin"), _arguments.pose(end, "end"), name
        )


class TwistMotion(Motion):
    """A motion with a constant velocity and a constant angular velocity, by any angle.

    pose : (4, 4) array, at t = 0
    linear : (3,) array, the velocity of the reference point at t = 0, in units of length a
        step, in the axes of the world
    angular : (3,) array, the angular velocity in radians a step, in the axes of the world. Its
        length is the angle, also more than a turn.
    path : "screw": the body follows the exponential of the twist, so that the reference point
        turns with it about the axis. "straight": the reference point goes straight, and the
        body turns about it, as rigid-body engines integrate a center of mass.
    reference : (3,) array, the point that has the velocity linear, in the frame of the body

    Raises ValueError for a pose that is no rotation and translation, numbers that are not
    finite, and angles beyond 2^20 radians.
    """

    def __init__(
        self,
        pose: ArrayLike,
        linear: ArrayLike,
        angular: ArrayLike,
        path: Literal["screw", "straight"] = "screw",
        reference: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        if not isinstance(path, str):
            raise _arguments.wrong_type("path", path, "'screw' or 'straight'")
        if path not in ("screw", "straight"):
            raise ValueError(f"path is {path!r}. Give 'screw' or 'straight'")
        self._make(
            "twist",
            _arguments.pose(pose, "pose"),
            _arguments.numbers(linear, "linear", 3),
            _arguments.numbers(angular, "angular", 3),
            _arguments.numbers(reference, "reference", 3),
            path == "screw",
        )


class WaypointMotion(Motion):
    """A motion that passes through poses at given times, with a continuous velocity.

    poses : (n, 4, 4) array, two or more
    times : (n,) array that ascends from 0 to 1, with steps of at least 2^-16

    Between two poses each coordinate of the origin follows a monotone cubic, in the axes of the
    world. The mesh turns the shorter way round, by at most 180 degrees. Between equal poses it
    rests exactly. Two poses are joined at constant speed.

    Raises ValueError for another number of times, times that are not as above, poses that are
    no rotation and translation, and numbers that are not finite.
    """

    def __init__(self, poses: ArrayLike, times: ArrayLike) -> None:
        self._make(
            "waypoints",
            _arguments.poses(poses, "poses"),
            _arguments.list_of_numbers(times, "times"),
        )


class SplineMotion(Motion):
    """A motion on cubic B-splines, as FCL's SplineMotion.

    translation : (4, 3) array, the control points of the position of the origin
    rotation : (4, 3) array, the control points of the rotation vector, in radians

    The pose at t = 0 is (c0 + 4 c1 + c2) / 6 of each, at t = 1 (c1 + 4 c2 + c3) / 6. It does
    not pass through the control points: a WaypointMotion passes through poses.
    """

    def __init__(self, translation: ArrayLike, rotation: ArrayLike) -> None:
        self._make(
            "spline",
            _arguments.numbers(translation, "translation", 4, 3),
            _arguments.numbers(rotation, "rotation", 4, 3),
        )


class BoundedMotion(Motion):
    """A motion of your own: functions that tell the pose, and bounds that make it certain.

    Between two poses anything may happen. So a query asks how fast the motion bends. It
    follows the functions as it follows the other motions: never late, no contact missed.

    pose : function(t) -> (4, 4) array
        The pose at t in [0, 1]: a point x of the object is at R(t) x + T(t). R is a
        rotation up to 2^-40, so compute it in double precision.
    rate : function(t) -> (4, 4) array
        The derivative of pose by t. Its last row is 0 0 0 0.
    acceleration_bound : function(center, radius, t0, t1) -> float
        A bound on |R''(t) x + T''(t)| during [t0, t1] of all points x within radius of
        center, three numbers in the frame of the object. If |R''| is at most A and |T''|
        at most B, it may give A (|center| + radius) + B. For a turn by the angle a(t)
        about an axis, A is the largest |a''| + a'^2.
    angular_speed_bound : function(t0, t1) -> float
        A bound on the angular speed during [t0, t1], in radians a step.

    With a bound that is too small contacts may be missed. With one that is too large
    queries are slower. pose and rate must belong together up to rounding, and each call
    with the same arguments must give the same answer.

    A query calls the functions often: a call takes some microseconds, and Python's lock.
    They may come from several threads, which wait for each other: use one thread. An
    exception from them ends the query and reaches the caller.

    Raises ValueError if a function gives another shape, no rotation, a number that is not
    finite or a negative bound, here or in a query, and TypeError for another type.
    """

    def __init__(
        self,
        pose: Callable[[float], ArrayLike],
        rate: Callable[[float], ArrayLike],
        acceleration_bound: Callable[[Tuple[float, float, float], float, float, float], float],
        angular_speed_bound: Callable[[float, float], float],
    ) -> None:
        given = {
            "pose": pose,
            "rate": rate,
            "acceleration_bound": acceleration_bound,
            "angular_speed_bound": angular_speed_bound,
        }
        for name, function in given.items():
            if not callable(function):
                raise _arguments.wrong_type(name, function, "a function")
        self._make("bounded", pose, rate, acceleration_bound, angular_speed_bound)


def _bounded(
    pose: Callable[..., ArrayLike],
    rate: Callable[..., ArrayLike],
    acceleration_bound: Callable[..., float],
    angular_speed_bound: Callable[..., float],
) -> _core.Motion:
    return _core.Motion.bounded(
        lambda t: _arguments.pose(pose(t), "pose(t)"),
        lambda t: _arguments.numbers(rate(t), "rate(t)", 4, 4),
        lambda *ball: _arguments.bound(acceleration_bound(*ball), "acceleration_bound()"),
        lambda *span: _arguments.bound(angular_speed_bound(*span), "angular_speed_bound()"),
    )


_MAKERS: Dict[str, Callable[..., _core.Motion]] = {
    "turn": _core.Motion.turn,
    "screw": _core.Motion.screw,
    "spline": _core.Motion.spline,
    "twist": _core.Motion.twist,
    "waypoints": _core.Motion.waypoints,
    "bounded": _bounded,
    "link": lambda motion, number: _core.Motion.link(motion._motion, number),
}


MotionLike = Optional[Union[Motion, "ArrayLike", "Sequence[ArrayLike]"]]

AT_ORIGIN = _core.Motion.straight(np.eye(4), np.eye(4), "identity")


def path_of(motion: MotionLike, name: str) -> _core.Motion:
    """The path of None, a pose, two poses or a Motion."""
    if motion is None:
        return AT_ORIGIN
    if isinstance(motion, Motion):
        return motion._path
    wanted = (
        "a pose of shape (4, 4), a pair of poses, or another Motion, for example a "
        "LinearMotion"
    )
    try:
        poses = np.asarray(motion)
    except ValueError as error:  # for example lists of different lengths
        raise ValueError(f"{name} is no array of numbers: {error}. Give {wanted}") from error
    if poses.shape == (4, 4):
        pose = _arguments.pose(poses, name)
        return _core.Motion.straight(pose, pose, name)
    if poses.shape == (2, 4, 4):
        return _core.Motion.straight(
            _arguments.pose(poses[0], name), _arguments.pose(poses[1], name), name
        )
    if poses.ndim == 0:
        raise _arguments.wrong_type(name, motion, wanted)
    raise ValueError(f"{name} has the shape {poses.shape}. Give {wanted}")
