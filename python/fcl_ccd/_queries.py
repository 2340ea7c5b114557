# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Callable, List, Literal, Optional, Tuple, Union, overload

import numpy as np

from . import _arguments, _core
from ._copies import Copied
from ._meshes import RigidMesh
from ._motions import AT_ORIGIN, MotionLike, path_of
from ._results import Result, result_of

if TYPE_CHECKING:
    from typing import Any

    from numpy.typing import ArrayLike, NDArray

    from ._core import Geometry

    from ._arguments import TriangleMesh

    Mesh = Union[_core.DeformableMesh, _core.RigidMesh, TriangleMesh]
    Sink = Callable[[NDArray[np.void]], Optional[bool]]

candidate_dtype: np.dtype[np.void] = _core.candidate_dtype
feature_test_dtype: np.dtype[np.void] = _core.feature_test_dtype


_ALL_BITS = 0xFFFFFFFF


class Filter(Copied, _core.Filter):
    """Which objects and triangles can be in contact.

    Two triangles can be in contact if the group of each one has a bit in common with the
    mask of the other one. A pair of features is tested if any two triangles that hold the
    features can be in contact.

    group, mask : int, 32 bits
        Of the whole mesh.
    triangle_groups, triangle_masks : (m,) arrays of integers, optional
        One for each triangle. They replace those of the mesh.

    Attributes (read-only): group, mask.
    """

    def __init__(
        self,
        group: int = 1,
        mask: int = _ALL_BITS,
        *,
        triangle_groups: Optional[ArrayLike] = None,
        triangle_masks: Optional[ArrayLike] = None,
    ) -> None:
        super().__init__(
            _arguments.integer(group, "group", _ALL_BITS),
            _arguments.integer(mask, "mask", _ALL_BITS),
            _arguments.bit_masks(triangle_groups, "triangle_groups"),
            _arguments.bit_masks(triangle_masks, "triangle_masks"),
        )

    def _built_from(self) -> Tuple[Any, ...]:
        return self.group, self.mask, self._triangle_groups, self._triangle_masks


_NUM_GROUPS = 32


class Groups(_arguments.Built):
    """Which groups of objects can be in contact, as a table of pairs of groups.

    A group is a number from 0 to 31. All can be in contact at first. The table makes the filters
    of objects: after a change of it make them anew.

        groups = fcl_ccd.Groups()
        groups.set(1, 1, False)                         # objects of group 1 ignore each other
        manager.set_filter("ball", groups.filter_of(1))
    """

    _masks: List[int]

    def __init__(self) -> None:
        self._masks = [_ALL_BITS] * _NUM_GROUPS

    def set(self, group1: int, group2: int, can_meet: bool) -> None:
        """Set whether objects of two groups, or of one, can be in contact."""
        can_meet = _arguments.flag(can_meet, "can_meet")
        one, two = _group(group1, "group1"), _group(group2, "group2")
        for mine, other in ((one, two), (two, one)):
            bit = 1 << other
            self._masks[mine] = self._masks[mine] | bit if can_meet else self._masks[mine] & ~bit

    def can_meet(self, group1: int, group2: int) -> bool:
        """Whether objects of two groups, or of one, can be in contact."""
        return bool(self._masks[_group(group1, "group1")] >> _group(group2, "group2") & 1)

    def filter_of(self, group: int) -> Filter:
        """The Filter of an object of a group."""
        number = _group(group, "group")
        return Filter(1 << number, self._masks[number])


def _group(group: int, name: str) -> int:
    return _arguments.integer(group, name, _NUM_GROUPS - 1)


_ACCEPTS_ALL = Filter()


def request_of(
    query: Literal["all", "first", "any"],
    toc_err: float,
    t_max: float,
    num_max_contacts: Optional[int],
    enable_contact: bool,
    enable_crossings: bool,
    filter1: Optional[Filter],
    filter2: Optional[Filter],
    accepts_triangles: Optional[Callable[[int, int], bool]],
    num_threads: int,
    min_distance: float,
    ignore_initially_closer: bool,
    min_approach_speed: float = 0.0,
) -> _core.Request:
    if not isinstance(query, str):
        raise _arguments.wrong_type("query", query, "'all', 'first' or 'any'")
    if num_max_contacts is not None:
        num_max_contacts = _arguments.integer(num_max_contacts, "num_max_contacts", 2**63 - 1)
    return _core.Request(
        query,
        _arguments.real(toc_err, "toc_err"),
        num_max_contacts,
        _arguments.flag(enable_contact, "enable_contact"),
        _arguments.real(t_max, "t_max"),
        _arguments.flag(enable_crossings, "enable_crossings"),
        filter_of(filter1, "filter1"),
        filter_of(filter2, "filter2"),
        _arguments.function_or_none(accepts_triangles, "accepts_triangles"),
        _arguments.integer(num_threads, "num_threads"),
        _arguments.real(min_distance, "min_distance"),
        _arguments.flag(ignore_initially_closer, "ignore_initially_closer"),
        _arguments.real(min_approach_speed, "min_approach_speed"),
    )


def filter_of(given: Optional[Filter], name: str) -> _core.Filter:
    if given is None:
        return _ACCEPTS_ALL
    if not isinstance(given, Filter):
        raise _arguments.wrong_type(name, given, "a fcl_ccd.Filter, or None")
    return given


def mesh_of(o: Mesh, name: str) -> _core.Mesh:
    if isinstance(o, _core.Mesh):
        return o
    if _arguments.is_mesh(o):
        return RigidMesh(o)
    meshes = "a DeformableMesh or a RigidMesh"
    if isinstance(o, _core.Geometry):
        meshes += ", for example of its surface"
    raise _arguments.wrong_type(name, o, meshes)


def geometry_of(o: Union[Geometry, TriangleMesh], name: str) -> Geometry:
    if not isinstance(o, _core.Geometry):
        if _arguments.is_mesh(o):
            return RigidMesh(o)
        wanted = "a DeformableMesh, a RigidMesh, a shape, an OcTree or a Compound"
        raise _arguments.wrong_type(name, o, wanted)
    return o


def self_collide(
    o: Mesh,
    *,
    query: Literal["all", "first", "any"] = "all",
    toc_err: float = 1e-4,
    t_max: float = 1.0,
    min_distance: float = 0.0,
    ignore_initially_closer: bool = False,
    min_approach_speed: float = 0.0,
    num_max_contacts: Optional[int] = None,
    enable_contact: bool = True,
    enable_crossings: bool = False,
    filter1: Optional[Filter] = None,
    accepts_triangles: Optional[Callable[[int, int], bool]] = None,
    num_threads: int = 1,
) -> Result:
    """The contacts of a mesh with itself during the step. Its pose does not matter.

    The keywords are those of collide(). filter1 is used for both sides. In
    accepts_triangles(b1, b2) both are triangles of the mesh, in any order.
    """
    request = request_of(
        query,
        toc_err,
        t_max,
        num_max_contacts,
        enable_contact,
        enable_crossings,
        filter1,
        None,
        accepts_triangles,
        num_threads,
        min_distance,
        ignore_initially_closer,
        min_approach_speed,
    )
    mesh = mesh_of(o, "o")
    queried = mesh, AT_ORIGIN, mesh._num_updates
    fields = _core.self_collide(mesh, request)
    fields.update(contact_tf1=np.eye(4), contact_tf2=np.eye(4))
    return result_of(fields, query, enable_contact, (queried, queried))


def collide(
    o1: Union[Geometry, TriangleMesh],
    o2: Union[Geometry, TriangleMesh],
    motion1: MotionLike = None,
    motion2: MotionLike = None,
    *,
    query: Literal["all", "first", "any"] = "all",
    toc_err: float = 1e-4,
    t_max: float = 1.0,
    min_distance: float = 0.0,
    ignore_initially_closer: bool = False,
    min_approach_speed: float = 0.0,
    num_max_contacts: Optional[int] = None,
    enable_contact: bool = True,
    enable_crossings: bool = False,
    filter1: Optional[Filter] = None,
    filter2: Optional[Filter] = None,
    accepts_triangles: Optional[Callable[[int, int], bool]] = None,
    num_threads: int = 1,
) -> Result:
    """The contacts of two objects during the step.

    Parameters
    ----------
    o1, o2 : DeformableMesh, RigidMesh, a shape, for example Box, an OcTree or a Compound
        Shapes are solid; Plane and TriangleP are surfaces. A mesh of another package with
        vertices and faces, for example a trimesh.Trimesh, becomes a RigidMesh in each
        call: make it once for more calls.
    motion1, motion2 : how each of them moves
        None             at rest, vertices are in the world frame
        (4, 4) array     at rest in this pose
        (begin, end)     two poses, (4, 4) each. A rigid mesh or a shape turns at constant
                         speed about the origin of its frame, which goes straight. Each
                         vertex of a mesh that deforms goes straight from begin * previous
                         to end * current.
        a Motion, for example a LinearMotion
    query : "all", "first" or "any"
        "all": all contacts. "first": the contacts that may be the first; later ones are
        skipped. "any": at most one contact; the query stops at the first proof.
    toc_err : float
        Largest width of a time bracket, in fractions of the step. 0: as narrow as doubles
        allow. It never changes whether there is a contact.
    t_max : float
        Only contacts until this time are reported, in [0, 1].
    min_distance : float
        The distance at which features are in contact, in the unit of the vertices. 0:
        features that touch.
    ignore_initially_closer : bool
        Whether pairs that are nearer than min_distance at t = 0 are in contact only when
        they come nearer than they are then. If false, they are contacts at t = 0.
    min_approach_speed : float
        Only contacts count that approach faster than this, in the unit of the vertices per
        step: bodies may slide over the edges of a floor. 0: all contacts. Only for meshes
        on straight paths.
    num_max_contacts : int, optional
        Keep at most this number of contacts, the earliest ones.
    enable_contact : bool
        Whether position and normal of contacts are computed.
    enable_crossings : bool
        Whether Result.crossings lists all edges that pass through a face at t = 0.
    filter1, filter2 : Filter, optional
        Which triangles of o1 and of o2 can be in contact.
    accepts_triangles : function(b1, b2) -> bool, optional
        Called with a triangle of o1 and one of o2 that the filters accept; -1 for a
        shape or an OcTree.
        False rejects the two. It must always give the same answer for the same triangles.
        An exception from it ends the query and reaches the caller. A call takes about a
        microsecond, and threads wait for each other: prefer filters.
    num_threads : int
        1: the caller's thread. n: at most n threads. 0: all cores. The answer does not
        depend on it. The first or any contact of a mesh that turns or of a shape takes one
        thread, and so does a query with an OcTree.

    If all vertices of two meshes go straight the answer is exact: no contact is missed and
    none is invented. If a mesh turns, or with a shape, contact means to come within some
    hundred roundings of touching. Other threads of Python run during a query.

    Raises ValueError with the words of the library for arguments that cannot be used, and
    TypeError for arguments of another type.
    """
    request = request_of(
        query,
        toc_err,
        t_max,
        num_max_contacts,
        enable_contact,
        enable_crossings,
        filter1,
        filter2,
        accepts_triangles,
        num_threads,
        min_distance,
        ignore_initially_closer,
        min_approach_speed,
    )
    geometry1, path1 = geometry_of(o1, "o1"), path_of(motion1, "motion1")
    geometry2, path2 = geometry_of(o2, "o2"), path_of(motion2, "motion2")
    # Of an update that another thread makes before the query, show() says that it was later.
    queried = (
        (geometry1, path1, geometry1._num_updates),
        (geometry2, path2, geometry2._num_updates),
    )
    fields = _core.collide(geometry1, path1, geometry2, path2, request)
    return result_of(fields, query, enable_contact, queried)


@dataclass(frozen=True, eq=False)
class DistanceResult(_arguments.Built):
    """The answer of distance(). Distances have the unit of the vertices.

    distance_lo, distance_hi : float
        The objects are never nearer than distance_lo during the step. At `time` they are
        not further apart than distance_hi. Both are 0 if they touch, and infinite if no
        pair counts.
    time : float
        When they are distance_hi apart, in fractions of the step; the first time of
        contact if they touch.
    nearest_points : (2, 3) float64
        The nearest points of o1 and o2 then, in the world frame.
    b1, b2 : int
        The triangles that have them; -1 for a shape; of an OcTree a number for its cells().
    part1, part2 : int
        The parts that have them; -1 where the object is no Compound.
    is_collide : bool
        Whether they touch during the step.
    is_cut_off : bool
        Whether the query ended since they stay further apart than max_distance, which is
        distance_lo then.
    """

    distance_lo: float
    distance_hi: float
    time: float
    nearest_points: NDArray[np.float64]
    b1: int
    b2: int
    part1: int
    part2: int
    is_collide: bool
    is_cut_off: bool


def distance(
    o1: Union[Geometry, TriangleMesh],
    o2: Union[Geometry, TriangleMesh],
    motion1: MotionLike = None,
    motion2: MotionLike = None,
    *,
    abs_err: float = 0.0,
    rel_err: float = 1e-3,
    t_max: float = 1.0,
    max_distance: float = np.inf,
    toc_err: float = 1e-4,
    filter1: Optional[Filter] = None,
    filter2: Optional[Filter] = None,
    accepts_triangles: Optional[Callable[[int, int], bool]] = None,
    num_threads: int = 1,
) -> DistanceResult:
    """The least distance of two objects during the step, and when, proved from both sides.

    Objects, motions, filters, t_max and toc_err are those of collide().

    abs_err, rel_err : float
        distance_hi - distance_lo is at most the larger one of abs_err, in the unit of the
        vertices, and of rel_err * distance_hi, as far as rounding allows.
    max_distance : float
        The query ends when it is proved that the objects stay further apart than this.

    Raises ValueError and TypeError as collide(), and ValueError for two planes or
    halfspaces. Other threads of Python run during the query.
    """
    request = distance_request_of(
        abs_err,
        rel_err,
        t_max,
        max_distance,
        toc_err,
        filter1,
        filter2,
        accepts_triangles,
        num_threads,
    )
    return DistanceResult(
        **_core.distance(
            geometry_of(o1, "o1"),
            path_of(motion1, "motion1"),
            geometry_of(o2, "o2"),
            path_of(motion2, "motion2"),
            request,
        )
    )


def distance_request_of(
    abs_err: float,
    rel_err: float,
    t_max: float,
    max_distance: float,
    toc_err: float,
    filter1: Optional[Filter],
    filter2: Optional[Filter],
    accepts_triangles: Optional[Callable[[int, int], bool]],
    num_threads: int,
) -> _core.DistanceRequest:
    contacts = request_of(
        "first",
        toc_err,
        t_max,
        None,
        True,
        False,
        filter1,
        filter2,
        accepts_triangles,
        num_threads,
        0.0,
        False,
    )
    return _core.DistanceRequest(
        contacts,
        _arguments.real(abs_err, "abs_err"),
        _arguments.real(rel_err, "rel_err"),
        _arguments.real(max_distance, "max_distance"),
    )


_BLOCK = 65536


def _hand_out(ask: Callable[[Sink, int], bool], sink: Optional[Sink], block: int) -> Any:
    block = _arguments.integer(block, "block", 2**63 - 1)
    sink = _arguments.function_or_none(sink, "sink")
    if sink is not None:
        return ask(sink, block)
    blocks: List[NDArray[np.void]] = []
    ask(blocks.append, 2**63 - 1)  # one block at most
    return blocks[0] if blocks else np.empty(0, candidate_dtype)


@overload
def self_candidates(
    o: Mesh, sink: None = None, *, block: int = _BLOCK, min_distance: float = 0.0
) -> NDArray[np.void]: ...


@overload
def self_candidates(
    o: Mesh, sink: Sink, *, block: int = _BLOCK, min_distance: float = 0.0
) -> bool: ...


def self_candidates(
    o: Mesh, sink: Optional[Sink] = None, *, block: int = _BLOCK, min_distance: float = 0.0
) -> Any:
    """The pairs of features of a mesh that may touch during the step, for your own solver.

    Sinks, blocks, distance and fields are those of candidates().
    """
    mesh = mesh_of(o, "o")
    distance = _arguments.real(min_distance, "min_distance")
    return _hand_out(
        lambda take, size: _core.self_candidates(mesh, take, size, distance), sink, block
    )


@overload
def candidates(
    o1: Mesh,
    o2: Mesh,
    motion1: MotionLike = None,
    motion2: MotionLike = None,
    sink: None = None,
    *,
    block: int = _BLOCK,
    min_distance: float = 0.0,
) -> NDArray[np.void]: ...


@overload
def candidates(
    o1: Mesh,
    o2: Mesh,
    motion1: MotionLike = None,
    motion2: MotionLike = None,
    *,
    sink: Sink,
    block: int = _BLOCK,
    min_distance: float = 0.0,
) -> bool: ...


def candidates(
    o1: Mesh,
    o2: Mesh,
    motion1: MotionLike = None,
    motion2: MotionLike = None,
    sink: Optional[Sink] = None,
    *,
    block: int = _BLOCK,
    min_distance: float = 0.0,
) -> Any:
    """The pairs of features of two meshes that may touch during the step.

    They are not tested yet. Every pair that touches is among them, and none comes twice.
    On straight paths vertex_face() and edge_edge() on all of them give the contacts of
    collide().

    sink : function(array) -> None or bool, optional
        Takes the candidates in blocks, as structured arrays of candidate_dtype that it may
        keep. False ends the query. Without a sink all candidates are returned as one array.
    block : int
        A block has at least this number of candidates, except the last one.
    min_distance : float
        Above 0: every pair that comes within this distance is among the candidates.

    Fields of candidate_dtype: kind, first_on_o1, vertices ((4,) int32), b1 and b2 as in
    Result.contacts; window_lo, window_hi (float64): the features do not touch before
    window_lo or after window_hi, in fractions of the step.

    Returns the array, or with a sink whether all candidates were handed out.
    """
    mesh1, mesh2 = mesh_of(o1, "o1"), mesh_of(o2, "o2")
    path1, path2 = path_of(motion1, "motion1"), path_of(motion2, "motion2")
    distance = _arguments.real(min_distance, "min_distance")
    return _hand_out(
        lambda take, size: _core.candidates(mesh1, path1, mesh2, path2, take, size, distance),
        sink,
        block,
    )


def vertex_face(
    t0: ArrayLike, t1: ArrayLike, *, toc_err: float = 1e-4, min_distance: float = 0.0
) -> NDArray[np.void]:
    """Test n vertices against n triangles, one by one.

    t0, t1 : (n, 4, 3) arrays
        The points v, f0, f1, f2 of each query at t = 0 and at t = 1. They move on straight
        lines.
    toc_err : float
        Largest width of [toc_lo, toc_hi]. 0: as narrow as doubles allow.
    min_distance : float
        The distance at which they are in contact. 0: they touch, decided exactly. Above 0:
        a pair that stays further apart than min_distance and some roundings is no contact.

    Returns a structured array (n,) of feature_test_dtype:
        is_contact      bool     whether they are in contact at some t in [0, 1]
        toc_lo, toc_hi  float64  bracket of the first such time; without contact both are 1

    Raises ValueError, with the number of the query, for a coordinate that is not finite.
    Other threads of Python run during the call.
    """
    return _feature_tests(_core.vertex_face, 4, t0, t1, toc_err, min_distance)


def edge_edge(
    t0: ArrayLike, t1: ArrayLike, *, toc_err: float = 1e-4, min_distance: float = 0.0
) -> NDArray[np.void]:
    """Test n edges against n edges, one by one.

    t0, t1 : (n, 4, 3) arrays
        The points ea0, ea1, eb0, eb1 of each query at t = 0 and at t = 1.

    Everything else is as in vertex_face().
    """
    return _feature_tests(_core.edge_edge, 4, t0, t1, toc_err, min_distance)


def vertex_edge(
    t0: ArrayLike, t1: ArrayLike, *, toc_err: float = 1e-4, min_distance: float
) -> NDArray[np.void]:
    """Test n vertices against n edges, one by one.

    t0, t1 : (n, 3, 3) arrays
        The points v, e0, e1 of each query at t = 0 and at t = 1.

    Everything else is as in vertex_face().
    """
    return _feature_tests(_core.vertex_edge, 3, t0, t1, toc_err, min_distance)


def vertex_vertex(
    t0: ArrayLike, t1: ArrayLike, *, toc_err: float = 1e-4, min_distance: float
) -> NDArray[np.void]:
    """Test n vertices against n vertices, one by one.

    t0, t1 : (n, 2, 3) arrays
        The points v, w of each query at t = 0 and at t = 1.

    Everything else is as in vertex_face().
    """
    return _feature_tests(_core.vertex_vertex, 2, t0, t1, toc_err, min_distance)


def _feature_tests(
    test: Callable[[NDArray[np.float64], NDArray[np.float64], float, float], NDArray[np.void]],
    num_points: int,
    t0: ArrayLike,
    t1: ArrayLike,
    toc_err: float,
    min_distance: float,
) -> NDArray[np.void]:
    begin = _arguments.feature_points(t0, "t0", num_points)
    end = _arguments.feature_points(t1, "t1", num_points)
    if begin.shape != end.shape:
        raise ValueError(f"t0 has {len(begin)} queries and t1 has {len(end)}")
    return test(
        begin,
        end,
        _arguments.real(toc_err, "toc_err"),
        _arguments.real(min_distance, "min_distance"),
    )
