# SPDX-License-Identifier: BSD-3-Clause
"""What a picture of a contact shows, whoever draws it."""

from __future__ import annotations

from typing import TYPE_CHECKING, List, NamedTuple, Optional, Tuple

import numpy as np

from ._surfaces import Pieces, Surface, View

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Picture(NamedTuple):
    """All that is drawn, in the world frame.

    objects : for each object its name, what is drawn of it, and its parts in contact
    places, normals : (k, 3) each, of the contacts until the time of the picture, and of the
        chosen one also before it begins
    is_main : (k,) bool, whether the picture is of this contact. One of all is of each.
    """

    title: str
    view: View
    objects: List[Tuple[str, Pieces, Pieces]]
    places: NDArray[np.float64]
    normals: NDArray[np.float64]
    is_main: NDArray[np.bool_]


def picture_of(
    title: str,
    surfaces: Tuple[Surface, Surface],
    names: Tuple[str, ...],
    chosen: Optional[np.void],
    touching: NDArray[np.void],
    has_places: bool,
) -> Picture:
    """
    surfaces : the objects at the time of the picture; of a self-collision one surface twice
    names : of the objects, one for a self-collision
    chosen : the contact on which the picture zooms; None: it shows the whole objects
    touching : the contacts until the time of the picture
    has_places : whether contacts have a place and a normal, which are zero else
    """
    if chosen is None:
        view, is_main = _whole(surfaces, touching), np.ones(len(touching), bool)
    else:
        view = _near(surfaces, chosen, touching, has_places)
        touching = np.append(touching[touching != chosen], chosen)
        is_main = np.arange(len(touching)) == len(touching) - 1
    sides = [touching["b1"], touching["b2"]]
    if len(names) == 1:
        sides = [np.concatenate(sides)]
    objects = []
    for name, surface, numbers in zip(names, surfaces, sides):
        others, parts = surface.pieces(view, np.unique(numbers[numbers != -1]))
        objects.append((name, others, parts))
    if not has_places:
        touching, is_main = touching[:0], is_main[:0]
    return Picture(title, view, objects, touching["pos"], touching["normal"], is_main)


def _cube_of(points: NDArray[np.float64]) -> View:
    low, high = points.min(axis=0), points.max(axis=0)
    half = float((high - low).max()) / 2
    return View((low + high) / 2, 1.05 * half if half > 0 else 1.0)


def _whole(surfaces: Tuple[Surface, Surface], touching: NDArray[np.void]) -> View:
    bounds = [surface.bounds() for surface in surfaces]
    if not any(len(points) for points in bounds):  # two planes
        bounds = [touching["pos"][:1]]
    if not any(len(points) for points in bounds):
        bounds = [np.zeros((1, 3))]
    return _cube_of(np.concatenate(bounds))


def _near(
    surfaces: Tuple[Surface, Surface],
    contact: np.void,
    touching: NDArray[np.void],
    has_places: bool,
) -> View:
    """About a contact, large enough for the smaller part and the distance to the other one."""
    numbers = contact["b1"], contact["b2"]
    parts = [s.part(int(b)).corners() for s, b in zip(surfaces, numbers) if b != -1]
    sizes = [float(np.ptp(part, axis=0).max()) for part in parts]
    if not any(size > 0 for size in sizes):
        return _whole(surfaces, touching)
    smallest = parts[int(np.argmin(np.where(np.array(sizes) > 0, sizes, np.inf)))]
    center = contact["pos"] if has_places else smallest.mean(axis=0)
    outside = [
        np.maximum(part.min(axis=0) - center, center - part.max(axis=0)).max() for part in parts
    ]
    half = max(1.5 * min(size for size in sizes if size > 0), *(1.3 * x for x in outside))
    return View(np.asarray(center, float), float(half))


def clipped(polygons: NDArray[np.float64], view: View) -> List[NDArray[np.float64]]:
    """The parts of segments or convex polygons (n, k, 3) that are in the view."""
    if len(polygons) == 0:
        return []
    off = (polygons - view.center) / view.half
    is_outside = (off > 1).all(axis=1).any(axis=1) | (off < -1).all(axis=1).any(axis=1)
    is_inside = (np.abs(off) <= 1).all(axis=(1, 2))
    inside: List[NDArray[np.float64]] = list(polygons[is_inside])
    for polygon in polygons[~is_inside & ~is_outside]:
        for axis in range(3):
            for sign in (-1, 1):
                polygon = _cut(polygon, view.half - sign * (polygon[:, axis] - view.center[axis]))
        if len(polygon) > 0:
            inside.append(polygon)
    return inside


def _cut(polygon: NDArray[np.float64], height: NDArray[np.float64]) -> NDArray[np.float64]:
    """The part of a segment or polygon where the height of its corners is not negative."""
    if (height >= 0).all():
        return polygon
    is_segment = len(polygon) == 2
    corners = [polygon[0]] if is_segment and height[0] >= 0 else []
    for i in range(int(is_segment), len(polygon)):
        a, b = i - 1, i
        if (height[a] < 0) != (height[b] < 0):
            s = height[a] / (height[a] - height[b])
            corners.append(polygon[a] + s * (polygon[b] - polygon[a]))
        if height[b] >= 0:
            corners.append(polygon[b])
    return np.array(corners).reshape(-1, 3)
