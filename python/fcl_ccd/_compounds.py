# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterable, List, Optional, Tuple, Union

import numpy as np

from . import _arguments, _core
from ._copies import Copied
from ._queries import geometry_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ._arguments import TriangleMesh
    from ._core import Geometry


class Compound(Copied, _arguments.Built, _core.Compound):
    """One body of several geometries: a link of a robot, a vehicle of boxes.

    parts : list of (geometry, offset)
        A geometry is a RigidMesh, a shape, an OcTree, a DeformableMesh whose frames are
        equal, or a mesh of another package. Its offset is a (4, 4) array, its pose in the
        frame of the body; None: the identity. A rotation that is none by up to 2^-6 is
        replaced by the nearest one.

        link = fcl_ccd.Compound([(fcl_ccd.Box(0.2, 0.1, 0.6), None), (ball, offset)])

    Queries take it as any geometry, with one motion for all parts. Contacts have the numbers
    of the parts in their fields part1 and part2. Parts are not tested with each other.

    Attributes (read-only): num_parts; parts, a tuple of (geometry, offset).

    Raises ValueError for no parts, a Compound or a mesh that deforms as a part, and an offset
    that is no rotation and translation; TypeError for another type. It never changes, and any
    number of threads may query it. If a DeformableMesh in it was updated, queries raise
    RuntimeError.
    """

    _parts: Tuple[Tuple[Geometry, NDArray[np.float64]], ...]

    def __init__(
        self, parts: Iterable[Tuple[Union[Geometry, TriangleMesh], Optional[ArrayLike]]]
    ) -> None:
        read: List[Tuple[Geometry, NDArray[np.float64]]] = []
        wanted = "a list of (geometry, offset)"
        for i, part in enumerate(_arguments.iterable(parts, "parts", wanted)):
            name = f"part {i}"
            if not isinstance(part, (tuple, list)) or len(part) != 2:
                raise _arguments.wrong_type(name, part, "a pair (geometry, offset)")
            geometry, offset = part
            pose = np.eye(4) if offset is None else offset
            read.append(
                (
                    geometry_of(geometry, name),
                    np.array(_arguments.pose(pose, f"the offset of {name}")),
                )
            )
        if not read:
            raise ValueError("parts is empty. Give a list of (geometry, offset)")
        super().__init__([geometry for geometry, _ in read], [offset for _, offset in read])
        self._parts = tuple(read)

    @property
    def parts(self) -> Tuple[Tuple[Geometry, NDArray[np.float64]], ...]:
        return tuple((geometry, offset.copy()) for geometry, offset in self._parts)

    def _built_from(self) -> Tuple[Any, ...]:
        return [geometry for geometry, _ in self._parts], [offset for _, offset in self._parts]

    def __repr__(self) -> str:
        if "_parts" not in self.__dict__:
            return "Compound(not built)"
        return f"Compound({', '.join(type(geometry).__name__ for geometry, _ in self._parts)})"
