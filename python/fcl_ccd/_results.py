# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import enum
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Mapping, Optional, Tuple, Union

import numpy as np

from . import _arguments, _core, _figures, _pages
from ._dataframes import to_dataframe
from ._pictures import Picture, picture_of
from ._surfaces import Surface, surface_at

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._surfaces import Queried

contact_dtype: np.dtype[np.void] = _core.contact_dtype


class Kind(enum.IntEnum):
    """The field "kind" of contacts and candidates."""

    VERTEX_FACE = 0
    EDGE_EDGE = 1
    CROSSING = 2
    VERTEX_EDGE = 3
    VERTEX_VERTEX = 4
    VERTEX_SHAPE = 5
    EDGE_SHAPE = 6
    FACE_SHAPE = 7
    SHAPES = 8


class _Asked:
    """Of its query, what show() needs. These are no fields: asdict() would copy the objects.

    They have no annotations, as attributes have that exist only after __init__().
    """

    _queried = None  # type: Optional[Tuple[Queried, Queried]]
    _query = "all"
    _has_places = True


@dataclass(frozen=True, eq=False, repr=False)
class Result(_Asked, _arguments.Built):
    """The answer of collide() and self_collide(). It is true if there is a collision.

    Times are fractions of the step, from 0 to 1. Positions have the unit of the vertices.

    is_collide : bool
        Whether the two touch during the step, or cross or overlap at t = 0.
    time_of_contact : float
        Never later than the first contact, and earlier by at most toc_err. 0 if the
        two touch, cross or overlap at t = 0. 1 without collision. With query="any" that of
        the contact that was found, which need not be the first.
    contacts : structured array (n,) of contact_dtype, sorted by time
        kind         int32       Kind.VERTEX_FACE or Kind.EDGE_EDGE; with min_distance also
                                 Kind.VERTEX_EDGE and Kind.VERTEX_VERTEX. Of a mesh and a
                                 shape, one for each triangle that touches, and named for
                                 the feature that is nearest: Kind.VERTEX_SHAPE,
                                 Kind.EDGE_SHAPE or Kind.FACE_SHAPE. Two shapes: Kind.SHAPES
        b1, b2       int64       triangles of o1 and o2 that have the features; free edges
                                 and points are numbered after them; -1 for a shape; of an
                                 OcTree a number for its cells()
        part1, part2  int32      the parts of o1 and o2 of which these are; -1 where the
                                 object is no Compound
        vertices     (5,) int32  VERTEX_FACE: v, f0, f1, f2. EDGE_EDGE: ea0, ea1, eb0, eb1.
                                 CROSSING: e0, e1, f0, f1, f2. VERTEX_EDGE: v, e0, e1.
                                 VERTEX_VERTEX: v of o1, v of o2. With a shape: the
                                 vertices of the feature. Unused entries are -1.
        first_on_o1  bool        whether the first feature is of o1 and the second of o2;
                                 false: the reverse. Edge ea is of o1. With a shape:
                                 whether the mesh is o1.
        within_tolerance  bool   whether only nearness is proved, not a crossing; of meshes
                                 on straight paths without min_distance it is false
        toc_lo, toc_hi  float64  bracket of the first time at which the features touch
        pos          (3,) float64  where they touch at toc_lo, in the world frame; with
                                 min_distance the middle between their nearest points
        normal       (3,) float64  unit vector from o1 to o2, in the world frame; in a
                                 self-collision from the vertex to the face, or from edge
                                 ea to edge eb. Zero if it is not defined.
        penetration_depth  float64  with a shape or an OcTree that overlaps the other
                                 object at t = 0: the least translation that parts the two
                                 is this long, along the normal. 0 for other contacts
    contacts_cut : bool
        Whether num_max_contacts dropped contacts.
    initially_crossing : bool
        Whether an edge passes through a triangle at t = 0.
    crossing : structured array of 0 or 1 elements of contact_dtype
        Such an edge and triangle, of kind Kind.CROSSING.
    crossings : structured array of contact_dtype
        All of them, if enable_crossings asks for them.
    is_triangle_soup : bool
        In a self-collision: whether no two triangles have a common vertex, so that
        neighbours are contacts. weld_vertices() joins them.
    counts : dict, how many candidates each stage of the query saw and removed
    times : dict, wall time of the parts of the query in seconds
    contact_tf1, contact_tf2 : (4, 4) float64
        Poses of o1 and o2 at which they overlap, up to toc_err after the first contact;
        without a collision, at t = 1. With min_distance they are still apart there, and
        meshes that only touch may not overlap.
    """

    is_collide: bool
    time_of_contact: float
    contacts: NDArray[np.void]
    contacts_cut: bool
    initially_crossing: bool
    crossing: NDArray[np.void]
    crossings: NDArray[np.void]
    is_triangle_soup: bool
    counts: Dict[str, int]
    times: Dict[str, float]
    contact_tf1: NDArray[np.float64]
    contact_tf2: NDArray[np.float64]

    def __bool__(self) -> bool:
        return self.is_collide

    def to_dataframe(self) -> Any:
        """The contacts as a pandas.DataFrame, see fcl_ccd.to_dataframe()."""
        return to_dataframe(self.contacts)

    def show(
        self,
        t: Optional[float] = None,
        *,
        contact: Optional[int] = 0,
        file: Optional[Union[str, os.PathLike[str]]] = None,
    ) -> None:
        """Draw both objects at a time of the step, with its contacts.

        Opens a window, or draws in the notebook, with matplotlib. Without it, and for a file
        contact.html, it makes a page with a 3D view for the notebook or the browser. The contacts
        that have begun until then are drawn, and the chosen one at every time: as a point and a
        line along its normal. Their triangles, free edges and points, and cells of an OcTree have
        a stronger colour.

        t : float, optional
            In fractions of the step. None: when the contact begins; 1 without contacts.
        contact : int or None
            The number of the chosen contact, in contacts, on which the picture zooms. None: it
            shows the whole objects, by default at the time of contact.
        file : str or path, optional
            Write the picture there instead, in the format of its suffix: .png, .svg, .pdf, or
            .html for the page, which needs no network and no other file.

        A result refers to the objects of its query, and keeps them alive, also a RigidMesh that
        the call made of a mesh of another package. Pickles and deep copies of it do not have
        them, and cannot be shown (ValueError). To keep many results without their objects,
        keep copy.deepcopy(result).

        Raises RuntimeError if a mesh was updated since the query, without a window or a browser,
        or for a page if the package was built without its 3D view; ImportError if it needs
        matplotlib, which is missing.
        """
        if t is not None:
            t = _arguments.number(t, "t")
            if not 0 <= t <= 1:
                raise ValueError(f"t is {t}. Give a fraction of the step, from 0 to 1")
        if contact is not None:
            contact = _arguments.integer(contact, "contact")
        if file is not None and not isinstance(file, (str, os.PathLike)):
            raise _arguments.wrong_type("file", file, "a path, or None")
        if file is not None and not os.path.basename(os.fsdecode(file)).strip("."):
            raise ValueError(
                f"file is {os.fsdecode(file)!r}. Give the name of a file, for example 'contact.png'"
            )
        _draw(_picture(self, t, contact), file)

    def __copy__(self) -> Result:
        made = object.__new__(type(self))
        made.__dict__.update(self.__dict__)
        return made

    def __getstate__(self) -> Dict[str, Any]:
        """For pickles and deep copies: without the objects, which would be copied too."""
        return {name: x for name, x in self.__dict__.items() if name != "_queried"}

    def __repr__(self) -> str:
        return (
            f"Result(is_collide={self.is_collide}, time_of_contact={self.time_of_contact}, "
            f"{len(self.contacts)} contacts, initially_crossing={self.initially_crossing})"
        )


def result_of(
    fields: Mapping[str, Any],
    query: str,
    enable_contact: bool,
    queried: Tuple[Queried, Queried],
) -> Result:
    """The answer of a query, which can be shown."""
    result = Result(**fields)
    result.__dict__.update(_query=query, _has_places=bool(enable_contact), _queried=queried)
    return result


def _draw(picture: Picture, file: Optional[Union[str, os.PathLike[str]]]) -> None:
    """A page if the file is one, and in place of a window or a picture without matplotlib."""
    if file is not None and os.path.splitext(os.fsdecode(file))[1].lower() == ".html":
        _pages.write(picture, file)
    elif file is None and _pages.has_viewer() and not _figures.has_matplotlib():
        _pages.open_page(picture)
    else:
        _figures.show(picture, file)


def _picture(result: Result, t: Optional[float], number: Optional[int]) -> Picture:
    if result._queried is None:
        raise ValueError(
            "this Result does not have the objects of its query: it is a deep copy, or was "
            "pickled, or changed by replace(). Call show() of the Result that the query gave, "
            "or query again"
        )
    # A crossing at t = 0 need not be a contact.
    events = result.contacts if len(result.contacts) > 0 else result.crossing
    chosen = None
    if number is not None and number < max(len(events), 1):
        chosen = events[number] if len(events) > 0 else None
    elif number is not None:
        raise ValueError(
            f"contact is {number}. This Result has {len(events)} contacts, numbered from 0"
        )
    if t is None:
        t = result.time_of_contact if chosen is None else float(chosen["toc_lo"])
    (o1, path1, _), (o2, path2, _) = result._queried
    is_one = o1 is o2 and path1 is path2
    names = ("o",) if is_one else ("o1", "o2")
    surfaces = tuple(surface_at(*pair, t) for pair in zip(result._queried, names))
    both = surfaces[0], surfaces[-1]
    touching = np.concatenate([result.crossing, result.contacts[result.contacts["toc_lo"] <= t]])
    labels = tuple(
        f"{name}: {type(o).__name__}" for name, (o, _, _) in zip(names, result._queried)
    )
    if chosen is None:
        title = _title_of_all(result, t)
    else:
        title = _title_of_one(result, chosen, number, both, names)
        title += "" if t == chosen["toc_lo"] else f"\ndrawn at t = {t:.4g}"
    title += "\nthey cross at t = 0" if result.initially_crossing else ""
    return picture_of(title, both, labels, chosen, touching, result._has_places)


def _title_of_all(result: Result, t: float) -> str:
    if not result.is_collide:
        return f"no contact in the step, drawn at t = {t:.4g}"
    until = np.count_nonzero(result.contacts["toc_lo"] <= t)
    return f"t = {t:.4g}: {until} of {len(result.contacts)} contacts until then"


def _title_of_one(
    result: Result,
    contact: np.void,
    number: Optional[int],
    surfaces: Tuple[Surface, Surface],
    names: Tuple[str, ...],
) -> str:
    toc, kind = contact["toc_lo"], Kind(contact["kind"]).name.lower().replace("_", "-")
    is_first = number == 0 and (toc == 0 or not result.initially_crossing)
    name = "first contact" if is_first else f"contact {number}"
    if result._query == "any":  # the first one that was found
        name = "a contact"
    parts = [s.name_of(int(contact[b])) for s, b in zip(surfaces, ("b1", "b2"))]
    if len(names) == 2:
        parts = [f"{part} of {of}" if part else of for part, of in zip(parts, names)]
    return f"{name} at t = {toc:.4g}\n{kind}, {parts[0]} and {parts[1]}"
