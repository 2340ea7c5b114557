# SPDX-License-Identifier: BSD-3-Clause
"""Edges of a planner: all of a robot, from one joint state to another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import (
    TYPE_CHECKING,
    Any,
    Callable,
    Dict,
    Hashable,
    Iterable,
    List,
    Literal,
    Optional,
    Sequence,
    Tuple,
    Union,
)

import numpy as np

from . import _arguments, _core
from ._chains import ChainMotion, JointChain, LinkMotion, _pose, _remade_chain, _require_chain
from ._manager import CollisionManager
from ._motions import path_of
from ._queries import geometry_of, request_of
from ._results import Result, result_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ._arguments import TriangleMesh
    from ._core import Geometry
    from ._surfaces import Queried

_ALL_GROUPS = 2**32 - 1


@dataclass(frozen=True, eq=False)
class RobotPair(_arguments.Built):
    """Two bodies in contact: a part of a robot and an obstacle, or two parts.

    part1, link1 : int, the first body: its number by attach(), and its link
    object : the name of the obstacle; None: the second body is a part of the robot too
    part2, link2 : int, that part and its link; -1 if it is an obstacle
    result : Result of collide() for the two, the first body first
    """

    part1: int
    link1: int
    object: Hashable
    part2: int
    link2: int
    result: Result


@dataclass(frozen=True, eq=False, repr=False)
class EdgeResult(_arguments.Built):
    """The answer of CollisionRobot.check_edge(). It is true if the edge is free.

    is_free : bool, proved if it is True: nothing touches at any time, up to t_max
    time_of_contact : float
        Of the first of the pairs, in fractions of the step; never late (query="any": of the
        contact that was found). 1 if it is free.
    joint_values : array, the joint values at this time
    pairs : list of RobotPair, sorted by time
        query="any": one pair in contact. "first": the pair that is first in contact. "all":
        all pairs in contact.
    num_box_pairs : int, the number of pairs whose boxes meet
    num_tested : int, the number of tests of pairs; with "first" a pair may be tested twice
    """

    is_free: bool
    time_of_contact: float
    joint_values: NDArray[np.float64]
    pairs: List[RobotPair]
    num_box_pairs: int
    num_tested: int

    def __bool__(self) -> bool:
        return self.is_free

    def __repr__(self) -> str:
        return (
            f"EdgeResult(is_free={self.is_free}, time_of_contact={self.time_of_contact}, "
            f"{len(self.pairs)} pairs)"
        )


class CollisionRobot(_arguments.Built):
    """A robot with the geometries of its links and what it holds. It checks edges of a planner.

    chain : JointChain. Joints that are added later do not belong to the robot.
    link_names : list of str, optional, for messages; one for each link of the chain
    base : (4, 4) array, the pose of the base; None: the identity

        robot = fcl_ccd.CollisionRobot(chain)
        robot.allow_neighbours()             # links that a joint connects may touch
        robot.attach(link, mesh)             # for each geometry of each link
        if robot.check_edge(begin, end, manager):
            ...                              # free, proved

    All parts are tested with all objects of the manager, and with each other. Left out are
    parts whose links do not move relative to each other, and links that may touch: allow(),
    allow_neighbours(), and touch_links of a part. A link is a number of the chain, -1 is the
    base.

    Threads: queries may run side by side, and other threads of Python run during a query. A
    change of the robot while a query of it runs, or the reverse, raises RuntimeError and
    changes nothing.
    """

    _robot: _core.Robot
    _chain: JointChain
    _base: NDArray[np.float64]
    _frames: Dict[int, Tuple[int, NDArray[np.float64]]]

    def __init__(
        self,
        chain: JointChain,
        link_names: Optional[Iterable[str]] = None,
        *,
        base: Optional[ArrayLike] = None,
    ) -> None:
        _require_chain(chain)
        names: List[str] = []
        if link_names is not None:
            names = list(_arguments.iterable(link_names, "link_names", "a list of str"))
        for name in names:
            if not isinstance(name, str):
                raise _arguments.wrong_type("link_names", link_names, "a list of str")
        self._chain = _copy_of(chain)
        self._robot = _core.Robot(self._chain._chain, names)
        self._base = _pose(base, "base")
        self._frames = {}

    @property
    def chain(self) -> JointChain:
        """A copy of the chain, from which motions for check_motion() are made."""
        return _copy_of(self._chain)

    def attach(
        self,
        link: int,
        o: Union[Geometry, TriangleMesh],
        origin: Optional[ArrayLike] = None,
        *,
        touch_links: Sequence[int] = (),
    ) -> int:
        """Attach a geometry to a link: a part of the robot, or an object that it holds.

        link : a number of a link, -1: the base
        o : DeformableMesh, RigidMesh, a shape or an OcTree. The robot keeps it alive.
        origin : (4, 4) array, the frame of o in that of the link; None: the same frame
        touch_links : list of int, links which this part may touch

        Returns the number of the part. Raises ValueError for what collide() refuses. After
        an error the robot is unchanged.
        """
        wanted = "a list of numbers of links"
        touched = [
            _link(x, "touch_links")
            for x in _arguments.iterable(touch_links, "touch_links", wanted)
        ]
        number, frame = _link(link, "link"), _pose(origin, "origin")
        part = self._robot._attach(number, geometry_of(o, "o"), frame, touched)
        self._frames[part] = (number, frame)
        return part

    def detach(self, part: int) -> None:
        """Remove a part, by the number that attach() gave. Numbers are not used again."""
        number = _arguments.integer(part, "part")
        self._robot._detach(number)
        del self._frames[number]

    def update(self) -> None:
        """Read all meshes again, after an update of one of them."""
        self._robot._update()

    def allow(self, link1: int, link2: int) -> None:
        """Parts of these two links are not tested with each other from now on.

        That holds for all that is attached to them, now and later. Attach what the robot holds to
        a fixed link of its own (JointChain.add_fixed()) if it may not touch them.
        """
        self._robot._allow(_link(link1, "link1"), _link(link2, "link2"))

    def allow_neighbours(self) -> None:
        """allow() for the link that carries a joint, and the link that it moves; for all joints.

        What is fixed to one of them is another link, and is tested with the other one.
        """
        self._robot._allow_neighbours()

    def set_filter(self, link: int, group: int = 1, mask: int = _ALL_GROUPS) -> None:
        """Set with which obstacles the parts of a link can be in contact, as in Filter."""
        self._robot._set_filter(
            _link(link, "link"),
            _arguments.integer(group, "group", _ALL_GROUPS),
            _arguments.integer(mask, "mask", _ALL_GROUPS),
        )

    def name_of(self, link: int) -> str:
        """'link 2', with its name if it has one; 'the base'."""
        return self._robot._name_of(_link(link, "link"))

    def check_edge(
        self,
        begin: ArrayLike,
        end: ArrayLike,
        obstacles: Optional[CollisionManager] = None,
        *,
        query: Literal["all", "first", "any"] = "any",
        toc_err: float = 1e-4,
        t_max: float = 1.0,
        min_distance: float = 0.0,
        ignore_initially_closer: bool = False,
        enable_contact: bool = True,
    ) -> EdgeResult:
        """Whether the robot can go from one joint state to another: all values go linearly.

        begin, end : arrays with the value of each joint that moves, in radians or units of
            length
        obstacles : CollisionManager, whose objects may move during the step; None: the robot
            is tested with itself alone
        query : "any": is it free? "first": how far is it free? "all": all pairs in contact

        The other keywords are those of collide().

        Raises RuntimeError if a mesh was updated after the robot or the manager had read it.
        """
        motion = ChainMotion(self._chain, begin, end, self._base)
        return self._check(
            motion,
            obstacles,
            query,
            toc_err,
            t_max,
            min_distance,
            ignore_initially_closer,
            enable_contact,
        )

    def check_motion(
        self,
        motion: ChainMotion,
        obstacles: Optional[CollisionManager] = None,
        *,
        query: Literal["all", "first", "any"] = "any",
        toc_err: float = 1e-4,
        t_max: float = 1.0,
        min_distance: float = 0.0,
        ignore_initially_closer: bool = False,
        enable_contact: bool = True,
    ) -> EdgeResult:
        """The same on another path, with its own base.

        motion : ChainMotion of the chain of the robot (the attribute chain), for example one of
            ChainMotion.polynomial()
        """
        if not isinstance(motion, ChainMotion):
            raise _arguments.wrong_type("motion", motion, "a ChainMotion")
        return self._check(
            motion,
            obstacles,
            query,
            toc_err,
            t_max,
            min_distance,
            ignore_initially_closer,
            enable_contact,
        )

    def _check(
        self,
        motion: ChainMotion,
        obstacles: Optional[CollisionManager],
        query: Literal["all", "first", "any"],
        toc_err: float,
        t_max: float,
        min_distance: float,
        ignore_initially_closer: bool,
        enable_contact: bool,
    ) -> EdgeResult:
        if obstacles is not None and not isinstance(obstacles, CollisionManager):
            raise _arguments.wrong_type("obstacles", obstacles, "a CollisionManager, or None")
        request = request_of(
            query,
            toc_err,
            t_max,
            None,
            enable_contact,
            False,
            None,
            None,
            None,
            1,
            min_distance,
            ignore_initially_closer,
        )
        manager = None if obstacles is None else obstacles._manager
        fields = self._robot._check(motion._motion, manager, request)
        pairs = []
        for part1, link1, name, part2, link2, answer, read1, read2 in fields.pop("pairs"):
            queried1 = self._queried(motion, part1, read1)
            queried2 = self._queried(motion, part2, read2) if part2 >= 0 else read2
            result = result_of(answer, query, enable_contact, (queried1, queried2))
            pairs.append(RobotPair(part1, link1, name, part2, link2, result))
        values = np.array(fields.pop("joint_values"))
        return EdgeResult(pairs=pairs, joint_values=values, **fields)

    def _queried(self, motion: ChainMotion, part: int, read: Tuple[Geometry, int]) -> Queried:
        """What Result.show() needs of a part: its mesh or shape, and its path."""
        kind, joints, *values, base = motion._made_by
        chain = _remade_chain(JointChain, joints)
        if part not in self._frames:
            raise RuntimeError("the robot was changed by another thread during the query")
        link, origin = self._frames[part]
        frame = chain.add_fixed(origin, link)
        own = ChainMotion.__new__(ChainMotion)
        own._make(chain._chain, kind, tuple(chain._joints), *values, base)
        return read[0], path_of(LinkMotion(own, frame), "motion"), read[1]

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise TypeError(
            "a CollisionRobot cannot be copied or pickled. Make another one, and attach the "
            "geometries there"
        )

    def __repr__(self) -> str:
        return f"CollisionRobot({self._chain.num_links} links, {len(self._frames)} parts)"


def _copy_of(chain: JointChain) -> JointChain:
    copy = JointChain()
    copy._chain, copy._joints = chain._chain.copy(), list(chain._joints)
    return copy


def _link(value: Any, name: str) -> int:
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool) and value == -1:
        return -1
    return _arguments.integer(value, name)
