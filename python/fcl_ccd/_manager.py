# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from dataclasses import dataclass
from typing import (
    TYPE_CHECKING,
    Any,
    Callable,
    Dict,
    Hashable,
    List,
    Literal,
    Mapping,
    Optional,
    Tuple,
    Union,
)

import numpy as np

from . import _arguments, _core
from ._dataframes import columns_of, frame_of
from ._motions import AT_ORIGIN, MotionLike, path_of
from ._queries import (
    DistanceResult,
    Filter,
    distance_request_of,
    filter_of,
    geometry_of,
    request_of,
)
from ._results import Result, result_of

if TYPE_CHECKING:
    from typing import Iterable, Iterator

    from numpy.typing import ArrayLike

    from ._arguments import TriangleMesh
    from ._core import Geometry
    from ._surfaces import Queried


@dataclass(frozen=True, eq=False)
class Pair(_arguments.Built):
    """Two objects of a manager in contact.

    o1, o2 : the names of the objects. A mesh in contact with itself is both of them. A mesh
        or shape that was given to collide() without a name is None.
    result : Result of collide() for the two, o1 first
    """

    o1: Hashable
    o2: Hashable
    result: Result

    _is_self = False  # whether both are one object; no field


@dataclass(frozen=True, eq=False, repr=False)
class ManagerResult(_arguments.Built):
    """The answer of CollisionManager.collide(). It is true if there is a collision.

    is_collide : bool
    time_of_contact : float
        Of the first of the pairs, in fractions of the step; never late (query="any": of the
        contact that was found). 1 without collision.
    pairs : list of Pair, sorted by time
        query="all": all pairs in contact. "first": the pair that is first in contact. "any":
        one pair in contact.
    num_box_pairs : int, the number of pairs of objects whose boxes meet
    num_tested : int, the number of pairs that were tested
    """

    is_collide: bool
    time_of_contact: float
    pairs: List[Pair]
    num_box_pairs: int
    num_tested: int

    def __bool__(self) -> bool:
        return self.is_collide

    def to_dataframe(self) -> Any:
        """The contacts of all pairs as one pandas.DataFrame, see fcl_ccd.to_dataframe().

        The first columns, o1 and o2, are the names of the objects.
        """
        contacts = [pair.result.contacts for pair in self.pairs]
        columns: Dict[str, Any] = {}
        for side in ("o1", "o2"):
            names = [getattr(p, side) for p, c in zip(self.pairs, contacts) for _ in range(len(c))]
            columns[side] = np.empty(len(names), dtype=object)
            columns[side][:] = names
        empty = np.empty(0, _core.contact_dtype)
        columns.update(columns_of(np.concatenate([empty, *contacts])))
        return frame_of(columns)

    def __repr__(self) -> str:
        return (
            f"ManagerResult(is_collide={self.is_collide}, time_of_contact="
            f"{self.time_of_contact}, {len(self.pairs)} pairs)"
        )


@dataclass(frozen=True, eq=False)
class NearestPair(_arguments.Built):
    """The answer of CollisionManager.distance().

    o1, o2 : the names of the two objects that come nearest; of those that touch first, if
        any touch. None: no distance was computed, as no pair counts, or all stay further apart
        than max_distance. A mesh or shape that was given to distance() without a name is None too.
    result : DistanceResult
        Of the two. No two objects are nearer than its distance_lo during the step.
    num_tested : int, the number of pairs whose distance was looked for
    """

    o1: Hashable
    o2: Hashable
    result: DistanceResult
    num_tested: int


class CollisionManager(_arguments.Built):
    """Finds the contacts of many meshes and shapes that move: a broad phase and its queries.

    Each object has a name, a mesh or shape, and a motion. One mesh may be in many objects.
    The boxes of objects move too, so that two objects that fly side by side are no pair. No
    contact is missed.

        manager = fcl_ccd.CollisionManager()
        manager.register("floor", fcl_ccd.Halfspace((0, 0, 1), 0))
        manager.register("tool", tool, (pose_t0, pose_t1))
        result = manager.collide(query="first")
        if result:
            print(result.pairs[0].o1, result.pairs[0].o2, result.time_of_contact)
        manager.update({"tool": (pose_t1, pose_t2)})     # the next step

    len(manager) is the number of objects, list(manager) has their names in the order of
    registration, and `name in manager` asks for one. If the library's error of a pair tells
    the number of an object, it is the place in this list, from 0.

    Time: to register, unregister or update one object O(log n), to update a large part of
    them at once O(n log n). Objects that rest cost nothing until they are updated.

    Threads: queries may run side by side, and other threads of Python run during a query. A
    change of the manager while a query of it runs, or the reverse, raises RuntimeError and
    changes nothing.
    """

    _manager: _core.Manager
    _objects: Dict[Hashable, _core.ManagedObject]

    def __init__(self) -> None:
        self._manager = _core.Manager()
        self._objects = {}

    def register(
        self,
        name: Hashable,
        o: Union[Geometry, TriangleMesh],
        motion: MotionLike = None,
        *,
        filter: Optional[Filter] = None,
        self_collision: bool = False,
        thickness: float = 0.0,
    ) -> None:
        """Add an object.

        name : str, int, or anything else that can be a key of a dict, but not None
        o : DeformableMesh, RigidMesh, or a shape. The manager keeps it alive.
        motion : how it moves, as in collide(). Two poses whose rotations differ are for
            rigid meshes and shapes: give a LinearMotion for a mesh that deforms.
        filter : Filter, which other objects it can be in contact with
        self_collision : bool, whether collide() looks for contacts of the mesh with itself
        thickness : float, see set_thickness()

        Raises ValueError if the name is registered, and for what collide() refuses. After an
        error the manager is unchanged.
        """
        if name is None:
            raise ValueError("name is None. Give a name")
        if self._is_registered(name):
            raise ValueError(f"{name!r} is registered. After a change call update()")
        self._objects[name] = self._manager._insert(
            name,
            geometry_of(o, "o"),
            path_of(motion, "motion"),
            filter_of(filter, "filter"),
            _arguments.flag(self_collision, "self_collision"),
            _arguments.number(thickness, "thickness"),
        )

    def unregister(self, name: Hashable) -> None:
        """Remove an object. Raises ValueError if there is none of this name."""
        self._manager._remove(self._object(name))
        del self._objects[name]

    def update(
        self, objects: Optional[Union[Mapping[Hashable, MotionLike], Iterable[Hashable]]] = None
    ) -> None:
        """Give the next step: new motions, and new frames of meshes that deform.

        objects : dict of names and motions, or names, optional
            A dict: these objects get these motions. Names: these keep their motions, and
            their meshes are read again. None: all objects.

        A DeformableMesh that was updated must be named here, or the next query raises
        RuntimeError. After an error the manager is unchanged.
        """
        if objects is None:
            self._manager._update(list(self._objects.values()), [])
            return
        motions: List[_core.Motion] = []
        if isinstance(objects, Mapping):
            items = list(objects.items())
            motions = [path_of(motion, f"the motion of {name!r}") for name, motion in items]
            objects = [name for name, _ in items]
        wanted = "a dict of names and motions, or a list of names"
        names = _arguments.iterable(objects, "objects", wanted)
        given = dict.fromkeys(self._object(name) for name in names)  # each once
        self._manager._update(list(given), motions)

    def step(self, poses: Mapping[Hashable, ArrayLike]) -> None:
        """Give the next step by poses: each object goes there from where its motion ends.

        poses : dict of names and poses, such as {"tool": pose_t2}. As motion=(last, next) of
            update(): the origin goes straight, and the rotation turns at a constant rate.

        After an error the manager is unchanged.
        """
        if not isinstance(poses, Mapping):
            raise _arguments.wrong_type("poses", poses, "a dict of names and poses")
        motions = {}
        for name, pose in poses.items():
            last = self._object(name)._last_pose()
            motions[name] = (last, _arguments.pose(pose, f"the pose of {name!r}"))
        self.update(motions)

    def set_thickness(self, name: Hashable, thickness: float) -> None:
        """Set the thickness of an object, at least 0, in the unit of the coordinates.

        Two objects are in contact when they come within the sum of both thicknesses, in addition
        to collide()'s min_distance; an object with itself within twice its own. distance() is
        that of the geometries.
        """
        self._manager._set_thickness(
            self._object(name), _arguments.number(thickness, "thickness")
        )

    def set_pair_distance(
        self, name1: Hashable, name2: Hashable, distance: Optional[float]
    ) -> None:
        """Set the distance of two objects in place of the sum of their thicknesses.

        None: that of their thicknesses again. It acts between objects of this manager.
        """
        if distance is not None:
            distance = _arguments.number(distance, "distance")
        self._manager._set_pair_distance(self._object(name1), self._object(name2), distance)

    def set_min_approach_speed(self, name: Hashable, speed: float) -> None:
        """Set how fast others must approach an object to be in contact with it, at least 0.

        As collide()'s min_approach_speed, for the pairs of this object; of two objects the
        larger speed counts. It acts on pairs of meshes on straight paths. Of other pairs all
        contacts count.
        """
        self._manager._set_min_approach_speed(
            self._object(name), _arguments.number(speed, "speed")
        )

    def set_filter(self, name: Hashable, filter: Optional[Filter]) -> None:
        """Replace the filter of an object: which others it can be in contact with. None: all."""
        self._manager._set_filter(self._object(name), filter_of(filter, "filter"))

    def set_self_collision(self, name: Hashable, enabled: bool) -> None:
        """Whether collide() looks for contacts of the mesh of this object with itself."""
        self._manager._set_self_collision(self._object(name), _arguments.flag(enabled, "enabled"))

    def collide(
        self,
        other: Union[None, Geometry, TriangleMesh, CollisionManager] = None,
        motion: MotionLike = None,
        *,
        name: Optional[Hashable] = None,
        query: Literal["all", "first", "any"] = "all",
        toc_err: float = 1e-4,
        t_max: float = 1.0,
        min_distance: float = 0.0,
        ignore_initially_closer: bool = False,
        min_approach_speed: float = 0.0,
        num_max_contacts: Optional[int] = None,
        enable_contact: bool = True,
        enable_crossings: bool = False,
        accepts_triangles: Optional[Callable[[int, int], bool]] = None,
        num_threads: int = 1,
    ) -> ManagerResult:
        """The pairs of objects in contact during the step.

        Without other and name: all objects with each other, and meshes that were registered
        with self_collision with themselves.

        other : a mesh or a shape, or another CollisionManager, optional
            A mesh or shape that need not be registered, which is o1, with all objects; or
            the objects of this manager, which are o1, with those of the other one.
        motion : of other, if it is a mesh or a shape; as in collide()
        name : optional, a registered object, which is o1, with all others

        The other keywords are those of collide(). query is about pairs too, see
        ManagerResult; num_max_contacts is for each pair. num_threads is for pairs, of which
        each thread tests one at a time, and for each pair.

        Raises RuntimeError if a mesh was updated after the manager had read it.
        """
        request = request_of(
            query,
            toc_err,
            t_max,
            num_max_contacts,
            enable_contact,
            enable_crossings,
            None,
            None,
            accepts_triangles,
            num_threads,
            min_distance,
            ignore_initially_closer,
            min_approach_speed,
        )
        fields = self._ask(other, motion, name, request)
        pairs = []
        for o1, o2, answer, read1, read2 in fields.pop("pairs"):
            queried = _queried(read1, read2)
            pair = Pair(o1, o2, result_of(answer, query, enable_contact, queried))
            if read1 is read2:
                object.__setattr__(pair, "_is_self", True)
            pairs.append(pair)
        return ManagerResult(pairs=pairs, **fields)

    def distance(
        self,
        other: Union[None, Geometry, TriangleMesh, CollisionManager] = None,
        motion: MotionLike = None,
        *,
        name: Optional[Hashable] = None,
        abs_err: float = 0.0,
        rel_err: float = 1e-3,
        t_max: float = 1.0,
        max_distance: float = np.inf,
        toc_err: float = 1e-4,
        accepts_triangles: Optional[Callable[[int, int], bool]] = None,
        num_threads: int = 1,
    ) -> NearestPair:
        """The least distance of the objects from each other during the step, and when.

        Which objects: as in collide(). A mesh has no distance from itself. Pairs of two
        planes or halfspaces are left out. The other keywords are those of
        fcl_ccd.distance().

        Raises RuntimeError if a mesh was updated after the manager had read it.
        """
        request = distance_request_of(
            abs_err,
            rel_err,
            t_max,
            max_distance,
            toc_err,
            None,
            None,
            accepts_triangles,
            num_threads,
        )
        fields = self._ask(other, motion, name, request)
        return NearestPair(result=DistanceResult(**fields.pop("result")), **fields)

    def _ask(
        self,
        other: Union[None, Geometry, TriangleMesh, CollisionManager],
        motion: MotionLike,
        name: Optional[Hashable],
        request: Union[_core.Request, _core.DistanceRequest],
    ) -> Dict[str, Any]:
        if name is not None and other is not None:
            raise ValueError("name and other are given. Give one of them")
        if isinstance(other, _core.Geometry) or _arguments.is_mesh(other):
            geometry = geometry_of(other, "other")  # type: ignore[arg-type]
            return self._manager._ask_geometry(geometry, path_of(motion, "motion"), request)
        if other is not None and not isinstance(other, CollisionManager):
            wanted = "a mesh, a shape, an OcTree or a CollisionManager"
            raise _arguments.wrong_type("other", other, wanted)
        if motion is not None:
            raise ValueError("motion is for a mesh or a shape that is given as other")
        if other is not None:
            return self._manager._ask_manager(other._manager, request)
        if name is not None:
            return self._manager._ask_one(self._object(name), request)
        return self._manager._ask_all(request)

    def _is_registered(self, name: Hashable) -> bool:
        try:
            hash(name)
        except TypeError as error:
            wanted = "a name that can be a key of a dict"
            raise _arguments.wrong_type("name", name, wanted) from error
        return name in self._objects

    def _object(self, name: Hashable) -> _core.ManagedObject:
        if not self._is_registered(name):
            raise ValueError(f"{name!r} is not registered. Call register() first")
        return self._objects[name]

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise TypeError(
            "a CollisionManager cannot be copied or pickled. Make another one, and register the "
            "objects there"
        )

    def __len__(self) -> int:
        return len(self._objects)

    def __iter__(self) -> Iterator[Hashable]:
        return iter(self._objects)

    def __contains__(self, name: Hashable) -> bool:
        return name in self._objects

    def __repr__(self) -> str:
        return f"CollisionManager({len(self)} objects)"


def _queried(read1: Queried, read2: Queried) -> Tuple[Queried, Queried]:
    """What the manager had read of a pair. A mesh meets itself in its own frame."""
    if read1 is not read2:
        return read1, read2
    o, _, num_updates = read1
    return (o, AT_ORIGIN, num_updates), (o, AT_ORIGIN, num_updates)
