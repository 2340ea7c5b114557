# SPDX-License-Identifier: BSD-3-Clause
"""FCL's shapes. They never change, and any number of threads may query them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterable, Optional, Tuple, Union

import numpy as np

from . import _arguments, _core
from ._copies import Copied

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._arguments import TriangleMesh


class _Shape(Copied):
    """What is common to shapes for a reader. Compiled attributes exist only after __init__."""

    _description = "not built"

    def _describe(self, *values: object) -> None:
        self._description = ", ".join(map(str, values))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._description})"


class Box(_Shape, _core.Box):
    """A solid box, centred at the origin of its frame.

    x, y, z : float, the lengths of its sides, not negative

    Attribute (read-only): side, (3,) float64.
    Raises ValueError for a size that is negative or not finite, TypeError for another type.
    """

    def __init__(self, x: float, y: float, z: float) -> None:
        super().__init__(
            _arguments.size(x, "x"), _arguments.size(y, "y"), _arguments.size(z, "z")
        )
        self._describe(*self.side.tolist())

    def _built_from(self) -> Tuple[Any, ...]:
        return tuple(self.side.tolist())


class Sphere(_Shape, _core.Sphere):
    """A solid sphere about the origin of its frame.

    radius : float, not negative

    Attribute (read-only): radius. Errors are those of Box.
    """

    def __init__(self, radius: float) -> None:
        super().__init__(_arguments.size(radius, "radius"))
        self._describe(self.radius)

    def _built_from(self) -> Tuple[Any, ...]:
        return (self.radius,)


class Ellipsoid(_Shape, _core.Ellipsoid):
    """A solid ellipsoid about the origin of its frame.

    a, b, c : float, its half axes along x, y and z, not negative

    Attribute (read-only): radii, (3,) float64. Errors are those of Box.
    """

    def __init__(self, a: float, b: float, c: float) -> None:
        super().__init__(
            _arguments.size(a, "a"), _arguments.size(b, "b"), _arguments.size(c, "c")
        )
        self._describe(*self.radii.tolist())

    def _built_from(self) -> Tuple[Any, ...]:
        return tuple(self.radii.tolist())


class Capsule(_Shape, _core.Capsule):
    """All points within radius of a segment of length lz on the z axis, about the origin.

    radius, lz : float, not negative. The whole capsule is lz + 2 radius long.

    Attributes (read-only): radius, lz. Errors are those of Box.
    """

    def __init__(self, radius: float, lz: float) -> None:
        super().__init__(_arguments.size(radius, "radius"), _arguments.size(lz, "lz"))
        self._describe(self.radius, self.lz)

    def _built_from(self) -> Tuple[Any, ...]:
        return self.radius, self.lz


class Cone(_Shape, _core.Cone):
    """A solid cone about the z axis, with its base at z = -lz / 2 and its tip at lz / 2.

    radius : float, of the base, not negative
    lz : float, its height, not negative

    Attributes (read-only): radius, lz. Errors are those of Box.
    """

    def __init__(self, radius: float, lz: float) -> None:
        super().__init__(_arguments.size(radius, "radius"), _arguments.size(lz, "lz"))
        self._describe(self.radius, self.lz)

    def _built_from(self) -> Tuple[Any, ...]:
        return self.radius, self.lz


class Cylinder(_Shape, _core.Cylinder):
    """A solid cylinder about the z axis, from z = -lz / 2 to lz / 2.

    radius, lz : float, not negative

    Attributes (read-only): radius, lz. Errors are those of Box.
    """

    def __init__(self, radius: float, lz: float) -> None:
        super().__init__(_arguments.size(radius, "radius"), _arguments.size(lz, "lz"))
        self._describe(self.radius, self.lz)

    def _built_from(self) -> Tuple[Any, ...]:
        return self.radius, self.lz


class Convex(_Shape, _core.Convex):
    """A solid convex polytope.

    vertices : (n, 3) array of float64. The solid is their convex hull.
    faces : (m, 3) array of integers, or a list of polygons
        Vertex numbers of each face, from 0. FCL stores them; queries do not read them.
    Or a convex mesh of another package in their place, with vertices and faces.

    Attributes (read-only): vertices (a copy), num_faces.
    Raises ValueError for a vertex number out of range, a face of fewer than 3 vertices or a
    position that is not finite, and TypeError for elements of another type.
    """

    def __init__(
        self,
        vertices: Union[ArrayLike, TriangleMesh],
        faces: Optional[Iterable[ArrayLike]] = None,
    ) -> None:
        points = _arguments.points(vertices, "vertices")
        found: Any = _arguments.triangles_of(vertices, faces, "faces")
        super().__init__(
            _arguments.numbers(points, "vertices", len(points), 3),
            _arguments.faces(found, "faces"),
        )
        self._describe(f"{len(self.vertices)} vertices", f"{self.num_faces} faces")

    def _built_from(self) -> Tuple[Any, ...]:
        return self.vertices, self._faces


class Plane(_Shape, _core.Plane):
    """The plane of all points x with n . x = d. It is a surface, without an inside.

    n : (3,) array, the normal. n and d are divided by its length.
    d : float

    Attributes (read-only): n, (3,) float64 of length 1; d.
    Raises ValueError if n has no direction or a number is not finite.
    """

    def __init__(self, n: ArrayLike, d: float) -> None:
        # n and d are kept as given: to divide them a second time may change their last bit.
        self._given = np.array(_arguments.numbers(n, "n", 3)), _arguments.number(d, "d")
        super().__init__(*self._given)
        self._describe(self.n.tolist(), self.d)

    def _built_from(self) -> Tuple[Any, ...]:
        return self._given


class Halfspace(_Shape, _core.Halfspace):
    """All points x with n . x <= d: a floor is Halfspace((0, 0, 1), 0).

    n : (3,) array, the normal, which points out. n and d are divided by its length.
    d : float

    Attributes and errors are those of Plane.
    """

    def __init__(self, n: ArrayLike, d: float) -> None:
        # n and d are kept as given: to divide them a second time may change their last bit.
        self._given = np.array(_arguments.numbers(n, "n", 3)), _arguments.number(d, "d")
        super().__init__(*self._given)
        self._describe(self.n.tolist(), self.d)

    def _built_from(self) -> Tuple[Any, ...]:
        return self._given


class TriangleP(_Shape, _core.TriangleP):
    """A single triangle. It is a surface, without an inside.

    a, b, c : (3,) arrays, its corners

    Attributes (read-only): a, b, c, (3,) float64 each. Raises ValueError for a coordinate
    that is not finite.
    """

    def __init__(self, a: ArrayLike, b: ArrayLike, c: ArrayLike) -> None:
        super().__init__(
            _arguments.numbers(a, "a", 3),
            _arguments.numbers(b, "b", 3),
            _arguments.numbers(c, "c", 3),
        )
        self._describe(self.a.tolist(), self.b.tolist(), self.c.tolist())

    def _built_from(self) -> Tuple[Any, ...]:
        return self.a, self.b, self.c
