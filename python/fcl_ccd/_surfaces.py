# SPDX-License-Identifier: BSD-3-Clause
"""Where the objects of a query are at a time of the step, as polygons to draw."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, List, NamedTuple, Sequence, Tuple

import numpy as np

from . import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._core import Geometry


# An object of a query, its path, and how many updates a mesh had had then. It is a plain
# tuple, which costs a query less than any class.
Queried = Tuple["Geometry", _core.Motion, int]


class View(NamedTuple):
    """A cube in the world frame: what a picture shows."""

    center: NDArray[np.float64]
    half: float


class Pieces(NamedTuple):
    """Polygons (n, k, 3), segments (e, 2, 3) and points (p, 3) in the world frame.

    are_round : whether the polygons stand for a round surface, so that their edges are none
    """

    polygons: NDArray[np.float64]
    segments: NDArray[np.float64] = np.empty((0, 2, 3))
    points: NDArray[np.float64] = np.empty((0, 3))
    are_round: bool = False

    def corners(self) -> NDArray[np.float64]:
        return np.concatenate([part.reshape(-1, 3) for part in self[:3]])


NOTHING = Pieces(np.empty((0, 3, 3)))


class Surface:
    """An object at a time of the step."""

    def bounds(self) -> NDArray[np.float64]:
        """Points (n, 3) whose box has the object, or none if it has no end."""
        raise NotImplementedError

    def pieces(self, view: View, numbers: NDArray[np.int64]) -> Tuple[Pieces, Pieces]:
        """What a view may show: all but the parts of these numbers, and these parts."""
        raise NotImplementedError

    def part(self, number: int) -> Pieces:
        """The part to which b1 or b2 of a contact refers. A shape has no parts."""
        return NOTHING

    def name_of(self, number: int) -> str:
        """What the part of this number is, for a title; empty if there are no parts."""
        return ""


def surface_at(queried: Queried, name: str, t: float) -> Surface:
    """The object at t, in the world frame.

    Raises RuntimeError if a mesh was updated since the query: its positions are gone.
    """
    o, path, num_updates = queried
    surface: Surface
    if isinstance(o, _core.Compound):
        raise ValueError(
            f"{name} is a Compound, which show() cannot draw. Query the part that touches by "
            "itself, and show() that Result"
        )
    if isinstance(o, _core.DeformableMesh):
        previous, triangles, edges, points, _, current = o._parts()
        # The parts are of one step. It is that of the query if there was no update until now.
        if o._num_updates != num_updates:
            raise RuntimeError(
                f"{name} was updated after the query, and show() needs the step of the query. "
                "Call show() before the next update(), or query a copy.copy() of the mesh"
            )
        vertices = _vertices_at(path, o, t, previous, current)
        surface = _MeshSurface(vertices, triangles, edges, points)
    elif isinstance(o, _core.RigidMesh):
        surface = _MeshSurface(_placed(path.pose_at(o, t), o.vertices), o.triangles)
    elif isinstance(o, _core.OcTree):
        surface = _OcTreeSurface(o, path.pose_at(o, t))
    elif isinstance(o, (_core.Plane, _core.Halfspace)):
        surface = _PlaneSurface(o, path.pose_at(o, t))
    else:
        surface = _ShapeSurface(o, path.pose_at(o, t))
    return surface


def _placed(pose: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    placed: NDArray[np.float64] = points @ pose[:3, :3].T + pose[:3, 3]
    return placed


def _vertices_at(
    path: _core.Motion,
    o: _core.DeformableMesh,
    t: float,
    previous: NDArray[np.float64],
    current: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Between two poses each vertex goes straight. Else it does so in the frame that moves."""
    if path.is_straight and (previous != current).any():
        begin = _placed(path.pose_at(o, 0), previous)
        return (1 - t) * begin + t * _placed(path.pose_at(o, 1), current)
    return _placed(path.pose_at(o, t), (1 - t) * previous + t * current)


class _MeshSurface(Surface):
    def __init__(
        self,
        vertices: NDArray[np.float64],
        triangles: NDArray[np.int64],
        edges: NDArray[np.int64] = np.empty((0, 2), np.int64),
        points: NDArray[np.int64] = np.empty(0, np.int64),
    ) -> None:
        self._vertices, self._of = vertices, (triangles, edges, points)

    def bounds(self) -> NDArray[np.float64]:
        used = np.concatenate([of.ravel() for of in self._of])
        bounds: NDArray[np.float64] = self._vertices[used]
        return bounds

    def _place(self, number: int) -> Tuple[int, int]:
        """Contacts number the triangles first, then the edges, then the points."""
        for kind, of in enumerate(self._of):
            if number < len(of):
                return kind, number
            number -= len(of)
        raise IndexError(number)

    def pieces(self, view: View, numbers: NDArray[np.int64]) -> Tuple[Pieces, Pieces]:
        # The others are (n, 3), (e, 2) and (p,) vertices.
        chosen: List[NDArray[np.float64]] = []
        others: List[NDArray[np.float64]] = []
        first = 0
        for of in self._of:
            is_chosen = np.zeros(len(of), bool)
            is_chosen[numbers[(first <= numbers) & (numbers < first + len(of))] - first] = True
            chosen.append(self._vertices[of[is_chosen]])
            others.append(self._vertices[of[~is_chosen]])
            first += len(of)
        return Pieces(others[0], others[1], others[2]), Pieces(chosen[0], chosen[1], chosen[2])

    def part(self, number: int) -> Pieces:
        return self.pieces(_EVERYWHERE, np.array([number]))[1]

    def name_of(self, number: int) -> str:
        kind, place = self._place(number)
        return f"{('triangle', 'free edge', 'free point')[kind]} {place}"


_EVERYWHERE = View(np.zeros(3), math.inf)


class _ShapeSurface(Surface):
    """A shape that has an end. It has no parts."""

    def __init__(self, shape: Geometry, pose: NDArray[np.float64]) -> None:
        self._shape, self._pose = shape, pose

    def bounds(self) -> NDArray[np.float64]:
        return self.pieces(_EVERYWHERE, np.empty(0, np.int64))[0].corners()

    def pieces(self, view: View, numbers: NDArray[np.int64]) -> Tuple[Pieces, Pieces]:
        polygons = _placed(self._pose, _polygons_of(self._shape, view.half))
        has_edges = isinstance(self._shape, (_core.Box, _core.Convex, _core.TriangleP))
        return Pieces(polygons, are_round=not has_edges), NOTHING


class _PlaneSurface(Surface):
    """The part of a plane, or of the border of a halfspace, that a view shows."""

    def __init__(self, plane: Any, pose: NDArray[np.float64]) -> None:
        self._n = pose[:3, :3] @ plane.n
        self._d = plane.d + self._n @ pose[:3, 3]

    def bounds(self) -> NDArray[np.float64]:
        return np.empty((0, 3))

    def pieces(self, view: View, numbers: NDArray[np.int64]) -> Tuple[Pieces, Pieces]:
        foot = view.center - (self._n @ view.center - self._d) * self._n
        across = np.cross(self._n, np.eye(3)[np.argmin(np.abs(self._n))])
        across /= np.linalg.norm(across)
        axes = np.stack([across, np.cross(self._n, across)])
        # A part of small squares can be sorted by depth. The diagonal of the cube fits in it.
        along = np.linspace(-1.8, 1.8, 19) * view.half
        a, b = np.meshgrid(along, along, indexing="ij")
        return Pieces(foot + _quads(a[..., None] * axes[0] + b[..., None] * axes[1])), NOTHING


class _OcTreeSurface(Surface):
    """The faces of occupied cells that no other cell hides, and the cells of contacts."""

    def __init__(self, octree: _core.OcTree, pose: NDArray[np.float64]) -> None:
        self._octree, self._pose = octree, pose
        self._cells = octree._finest_cells()

    def _cubes(self, centers: NDArray[np.float64], sides: Any) -> NDArray[np.float64]:
        """The six sides (n, 6, 4, 3) of each cube."""
        halves = np.reshape(sides, (-1, 1, 1, 1)) / 2
        return _placed(self._pose, centers[:, None, None, :] + halves * _CUBE)

    def _centers(self) -> NDArray[np.float64]:
        centers: NDArray[np.float64] = (self._cells + 0.5) * self._octree.resolution
        return centers

    def bounds(self) -> NDArray[np.float64]:
        return self._cubes(self._centers(), self._octree.resolution).reshape(-1, 3)

    def pieces(self, view: View, numbers: NDArray[np.int64]) -> Tuple[Pieces, Pieces]:
        centers, side = self._centers(), self._octree.resolution
        chosen = self._octree._cells(numbers)
        shown = self._is_near(centers, side, view) & ~self._is_part_of(chosen)
        cubes = self._cubes(centers[shown], side)
        others = cubes[self._is_bare(self._cells[shown])]
        chosen = chosen[self._is_near(chosen["center"], chosen["size"][:, None], view)]
        parts = self._cubes(chosen["center"], chosen["size"])
        return Pieces(others), Pieces(parts.reshape(-1, 4, 3))

    def _is_near(
        self, centers: NDArray[np.float64], sides: Any, view: View
    ) -> NDArray[np.bool_]:
        """Whether the view may have a part of each cube, however it is turned."""
        off = np.abs(_placed(self._pose, centers) - view.center)
        is_near: NDArray[np.bool_] = (off <= view.half + sides).all(axis=1)
        return is_near

    def _is_part_of(self, joined: NDArray[np.void]) -> NDArray[np.bool_]:
        """Whether each cell is in one of these, each of which may be many cells."""
        widths = np.rint(joined["size"] / self._octree.resolution).astype(np.int64)
        within = np.floor(joined["center"] / self._octree.resolution).astype(np.int64)
        found = np.zeros(len(self._cells), bool)
        for width in np.unique(widths):  # powers of two; such a cube begins at a multiple
            keys = _keys_of(within[widths == width] // width)
            found |= np.isin(_keys_of(self._cells // width), keys)
        return found

    def _is_bare(self, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Whether there is no cell beside each of the six sides of each of these: (n, 6)."""
        steps = np.repeat(_KEY_FACTORS, 2) * np.tile((-1, 1), 3)
        return np.isin(_keys_of(cells)[:, None] + steps, _keys_of(self._cells), invert=True)

    def part(self, number: int) -> Pieces:
        cell = self._octree._cells(np.array([number]))
        return Pieces(self._cubes(cell["center"], cell["size"])[0])

    def name_of(self, number: int) -> str:
        return f"cell {number}"


_KEY_FACTORS = np.array([1 << 40, 1 << 20, 1])  # the cells are at -2^15 to 2^15


def _keys_of(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """A number for each cell, which no other one has."""
    keys: NDArray[np.int64] = cells @ _KEY_FACTORS
    return keys


def _quads(grid: NDArray[np.float64]) -> NDArray[np.float64]:
    """The squares (n, 4, 3) of a grid (rows, columns, 3) of points."""
    corners = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    quads: NDArray[np.float64] = np.stack(corners, axis=2).reshape(-1, 4, 3)
    return quads


# The sides of the cube from -1 to 1: at x = -1, x = 1, y = -1 and so on.
_SQUARE = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)
_CUBE: NDArray[np.float64] = np.stack(
    [np.insert(_SQUARE, axis, sign, axis=1) for axis in range(3) for sign in (-1, 1)]
)


def _polygons_of(shape: Any, half: float) -> Any:
    """The surface of a shape in its own frame, as fine as a view of this size needs."""
    if isinstance(shape, _core.Box):
        return _CUBE * (shape.side / 2)
    if isinstance(shape, _core.TriangleP):
        return np.stack([shape.a, shape.b, shape.c])[None]
    if isinstance(shape, _core.Convex):
        return shape.vertices[_fans(shape._faces)]
    if isinstance(shape, _core.Ellipsoid):
        largest = shape.radii.max()
        scaled = half / largest if largest > 0 else math.inf
        return _revolved(_arc(1, scaled, -1), scaled) * shape.radii
    if isinstance(shape, _core.Sphere):
        return _revolved(_arc(shape.radius, half, -1), half)
    top = shape.lz / 2
    if isinstance(shape, _core.Capsule):
        arc = _arc(shape.radius, half)
        lower = arc[::-1] * (1, -1) - (0, top)
        return _revolved(np.concatenate([lower, arc + (0, top)]), half)
    radius_of_top = 0.0 if isinstance(shape, _core.Cone) else shape.radius
    outline = [(0, -top), (shape.radius, -top), (radius_of_top, top), (0, top)]
    return _revolved(np.array(outline), half)


def _fans(faces: Sequence[int]) -> NDArray[np.int64]:
    """Triangles of polygons in FCL's encoding."""
    triangles: List[Tuple[int, int, int]] = []
    i = 0
    while i < len(faces):
        face = faces[i + 1 : i + 1 + faces[i]]
        triangles += [(face[0], a, b) for a, b in zip(face[1:], face[2:])]
        i += 1 + faces[i]
    return np.array(triangles, np.int64).reshape(-1, 3)


def _num_sides(radius: float, half: float) -> int:
    """Sides of a polygon that is nearer to its circle than the picture tells, within limits."""
    off = half / 200 / radius if radius > 0 else 1
    off = min(0.5, max(1e-5, off))  # 512 sides are off by 1.9e-5; of too little 1 - off is 1
    return int(min(512, max(32, 4 * round(math.pi / math.acos(1 - off) / 4))))


def _arc(radius: float, half: float, beginning: float = 0.0) -> NDArray[np.float64]:
    """A circle about the origin up to its top: distances from the z axis, heights.

    beginning : in right angles; 0: beside the origin, -1: below it
    """
    num_sides = _num_sides(radius, half) * (1 - beginning) / 4
    angle = np.linspace(beginning, 1, round(num_sides) + 1) * math.pi / 2
    arc: NDArray[np.float64] = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return arc


def _revolved(outline: NDArray[np.float64], half: float) -> NDArray[np.float64]:
    """The surface of an outline (distance from the z axis, height) that turns about it."""
    angle = np.linspace(0, 2 * math.pi, _num_sides(outline[:, 0].max(), half) + 1)
    turned = outline[:, 0][:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    height = np.broadcast_to(outline[:, 1][:, None, None], (*turned.shape[:2], 1))
    return _quads(np.concatenate([turned, height], axis=-1))
