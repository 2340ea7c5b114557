# SPDX-License-Identifier: BSD-3-Clause
"""Robots: joints, and the motions of the links that they carry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterable, List, Optional, Sequence, Tuple

import numpy as np

from . import _arguments, _core
from ._motions import Motion

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_ORIGIN = (0.0, 0.0, 0.0)
_Joint = Tuple[str, "NDArray[np.float64]", "NDArray[np.float64]", int]


def urdf_origin(xyz: ArrayLike = _ORIGIN, rpy: ArrayLike = _ORIGIN) -> NDArray[np.float64]:
    """The pose that a URDF writes as <origin xyz="..." rpy="..."/>, as a (4, 4) array.

    xyz : (3,) array, the translation
    rpy : (3,) array, the turns about the fixed axes x, y and z, in this order, in radians
    """
    return _core.urdf_origin(_arguments.numbers(xyz, "xyz", 3), _arguments.numbers(rpy, "rpy", 3))


def _pose(values: Optional[ArrayLike], name: str) -> NDArray[np.float64]:
    """A copy; None: the identity."""
    return np.array(_arguments.pose(np.eye(4) if values is None else values, name))


class JointChain(_arguments.Built):
    """The joints of a robot: where they are, and what they turn or slide about.

    Each joint carries a link, whose frame is that of the joint, as in a URDF: with the value
    q, the frame of the link is the origin of the joint in the frame of the link before it,
    turned by q radians about the axis, or moved by q along it. Links may branch. A frame that
    is fixed to a link, such as the origin of a collision geometry or a tool, is a link of a
    fixed joint, and costs queries no time.

    The functions that add a joint return the number of its link: 0, 1, ... They take

    origin : (4, 4) array, the frame of the joint at the value 0, in that of the link parent;
        None: the same frame. urdf_origin() makes one.
    axis : (3,) array, in the frame of the joint, of any length but 0
    parent : the number of a link, -1: the base; None: the link that was added last

    Attributes (read-only): num_links; num_values, the number of joints that move.
    Raises ValueError for an axis that is zero, an origin that is no rotation and translation,
    a number that is not finite, or a parent that is not there.
    """

    _chain: _core.JointChain
    _joints: List[_Joint]

    def __init__(self) -> None:
        self._chain, self._joints = _core.JointChain(), []

    def add_revolute(
        self,
        origin: Optional[ArrayLike] = None,
        axis: ArrayLike = (1.0, 0.0, 0.0),
        parent: Optional[int] = None,
    ) -> int:
        """Adds a joint that turns, by any angle."""
        return self._add("revolute", origin, axis, parent)

    def add_prismatic(
        self,
        origin: Optional[ArrayLike] = None,
        axis: ArrayLike = (1.0, 0.0, 0.0),
        parent: Optional[int] = None,
    ) -> int:
        """Adds a joint that slides along its axis."""
        return self._add("prismatic", origin, axis, parent)

    def add_fixed(self, origin: Optional[ArrayLike] = None, parent: Optional[int] = None) -> int:
        """Adds a frame that is fixed to the link parent. It has no value."""
        return self._add("fixed", origin, (1.0, 0.0, 0.0), parent)

    @property
    def num_links(self) -> int:
        return self._chain.num_links()

    @property
    def num_values(self) -> int:
        return self._chain.num_values()

    def _add(
        self, kind: str, origin: Optional[ArrayLike], axis: ArrayLike, parent: Optional[int]
    ) -> int:
        before = self.num_links - 1 if parent is None else parent
        if isinstance(before, bool) or not isinstance(before, (int, np.integer)):
            raise _arguments.wrong_type("parent", parent, "the number of a link, or None")
        if not -1 <= before < self.num_links:
            raise ValueError(
                f"parent is {before}, but there is no such link yet. Give -1 for the base, or "
                "the number of a link that was added"
            )
        joint = (
            kind,
            _pose(origin, "origin"),
            np.array(_arguments.numbers(axis, "axis", 3)),
            int(before),
        )
        link = self._chain.add(*joint)
        self._joints.append(joint)
        return link

    def __repr__(self) -> str:
        return f"JointChain({self.num_links} links, {self.num_values} values)"

    def __reduce_ex__(self, protocol: Any) -> Tuple[Any, ...]:
        attributes = {k: v for k, v in self.__dict__.items() if k not in ("_chain", "_joints")}
        return _remade_chain, (type(self), tuple(self._joints)), attributes


def _remade_chain(of: Any, joints: Iterable[_Joint]) -> Any:
    chain = of.__new__(of)
    chain._chain, chain._joints = _core.JointChain(), []
    for joint in joints:
        chain._chain.add(*joint)
        chain._joints.append(joint)
    return chain


class ChainMotion(_arguments.Built):
    """The motion of a JointChain during a step: all joint values change at constant speed.

    chain : JointChain. Joints that are added later do not belong to the motion.
    begin, end : arrays with the value of each moving joint at t = 0 and t = 1, in the order in
        which they were added; in radians or units of length. Any angle: links follow the exact
        arcs, also of more than a turn.
    base : (4, 4) array, the pose of the base at all times; None: the identity

    Give each geometry of the robot the motion of its link, link(number).

    Raises ValueError for a wrong number of values, values that are not finite, and angles
    beyond 2^20 radians.
    """

    _motion: _core.ChainMotion
    _made_by: Tuple[Any, ...]

    def __init__(
        self,
        chain: JointChain,
        begin: ArrayLike,
        end: ArrayLike,
        base: Optional[ArrayLike] = None,
    ) -> None:
        _require_chain(chain)
        given = (_values(begin, "begin"), _values(end, "end"), base)
        self._make(chain._chain, "linear", tuple(chain._joints), *given)

    @classmethod
    def polynomial(
        cls,
        chain: JointChain,
        values: Sequence[ArrayLike],
        base: Optional[ArrayLike] = None,
    ) -> ChainMotion:
        """The value of joint i at t is the sum of values[i][k] t^k, with 1 to 16 coefficients."""
        _require_chain(chain)
        wanted = "a list of coefficients for each joint"
        coefficients = [
            _values(of, f"the element {i} of values")
            for i, of in enumerate(_arguments.iterable(values, "values", wanted))
        ]
        motion = cls.__new__(cls)
        motion._make(chain._chain, "polynomial", tuple(chain._joints), coefficients, base)
        return motion

    def link(self, number: int) -> LinkMotion:
        """The motion of a link, by its number in the chain."""
        return LinkMotion(self, _arguments.integer(number, "number"))

    def _make(
        self, chain: _core.JointChain, kind: str, joints: Tuple[_Joint, ...], *given: Any
    ) -> None:
        """joints: those of the chain, from which a copy of the motion is made."""
        *values, base = given
        pose = _pose(base, "base")
        if kind == "linear":
            self._motion = _core.ChainMotion.linear(chain, values[0], values[1], pose)
        else:
            self._motion = _core.ChainMotion.polynomial(chain, values[0], pose)
        self._made_by = (kind, joints, *values, pose)

    def __reduce_ex__(self, protocol: Any) -> Tuple[Any, ...]:
        attributes = {k: v for k, v in self.__dict__.items() if k not in ("_motion", "_made_by")}
        return _remade_motion, (type(self), self._made_by), attributes


def _remade_motion(of: Any, given: Tuple[Any, ...]) -> Any:
    motion = of.__new__(of)
    _, joints, *_ = given
    motion._make(_remade_chain(JointChain, joints)._chain, *given)
    return motion


def _require_chain(chain: object) -> None:
    if not isinstance(chain, JointChain):
        raise _arguments.wrong_type("chain", chain, "a JointChain")


def _values(values: ArrayLike, name: str) -> NDArray[np.float64]:
    return np.array(_arguments.list_of_numbers(values, name))


class LinkMotion(Motion):
    """The motion of a link of a ChainMotion.

    motion : ChainMotion
    link : the number of the link
    """

    def __init__(self, motion: ChainMotion, link: int) -> None:
        if not isinstance(motion, ChainMotion):
            raise _arguments.wrong_type("motion", motion, "a ChainMotion")
        self._make("link", motion, _arguments.integer(link, "link"))
