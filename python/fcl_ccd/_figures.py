# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of contacts by matplotlib, which the rest of the package does not need."""

from __future__ import annotations

import importlib
import math
import os
from typing import TYPE_CHECKING, Any, List, Optional, Union

import numpy as np

from . import _pages
from ._pictures import Picture, clipped

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Of each object: its colour, and that of its parts in contact.
_COLOURS = ((0.68, 0.80, 0.93), (0.10, 0.35, 0.75)), ((0.97, 0.83, 0.62), (0.90, 0.45, 0.0))
_OTHER_CONTACT, _CONTACT = (0.45, 0.0, 0.15), (0.85, 0.0, 0.0)
_EDGE = np.array((0.3, 0.3, 0.3, 0.5))
_MOST_EDGED = 10000  # polygons: the edges of more of them leave no place for faces
_SIZE = 7, 6  # inches


def has_matplotlib() -> bool:
    try:
        importlib.import_module("matplotlib")
    except ModuleNotFoundError as error:
        if error.name != "matplotlib":
            raise
        return False
    return True


def show(picture: Picture, file: Optional[Union[str, os.PathLike[str]]]) -> None:
    """Opens a window, shows the picture in a notebook, or writes a file."""
    if file is not None:
        figure = _part_of_matplotlib("figure").Figure(figsize=_SIZE)
        _draw(figure, picture)
        figure.savefig(file, dpi=150)
        return
    pyplot = _part_of_matplotlib("pyplot")
    # The same list as matplotlib's own warning, which a program would print and go on.
    if pyplot.get_backend().lower() in ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template"):
        raise RuntimeError(
            f"show() needs a window, and matplotlib has none here (its backend is "
            f"{pyplot.get_backend()}). Give a file, for example show(file='contact.png')"
        )
    _draw(pyplot.figure(figsize=_SIZE), picture)
    pyplot.show()


def _part_of_matplotlib(name: str) -> Any:
    if not has_matplotlib():
        page = ". Or write a page that a browser opens: show(file='contact.html')"
        raise ImportError(
            "show() needs matplotlib. Install it: on Debian the package python3-matplotlib, "
            f"elsewhere by `pip install matplotlib`{page if _pages.has_viewer() else ''}",
            name="matplotlib",
        )
    return importlib.import_module(f"matplotlib.{name}")


def _draw(figure: Any, picture: Picture) -> None:
    art3d = importlib.import_module("mpl_toolkits.mplot3d.art3d")
    axes = figure.add_subplot(projection="3d", proj_type="ortho", computed_zorder=False)
    center, half = picture.view
    handles: List[Any] = []
    polygons: List[NDArray[np.float64]] = []
    colours: List[NDArray[np.float64]] = []
    edges: List[NDArray[np.float64]] = []
    for (name, others, parts), pair in zip(picture.objects, _COLOURS):
        for pieces, colour, opacity in ((others, pair[0], 0.6), (parts, pair[1], 0.9)):
            shown = clipped(pieces.polygons, picture.view)
            polygons += shown
            faces = _shaded(shown, (*colour, opacity))
            colours += faces
            hides_faces = len(shown) > _MOST_EDGED
            edges += faces if pieces.are_round or hides_faces else [_EDGE] * len(shown)
            segments = clipped(pieces.segments, picture.view)
            if segments:
                lines = art3d.Line3DCollection(segments, colors=[colour], linewidths=2)
                axes.add_collection3d(lines)
            near = (np.abs(pieces.points - center) <= half).all(axis=1)
            if near.any():
                axes.scatter(*pieces.points[near].T, color=[colour], s=12, depthshade=False)
        handles.append(_part_of_matplotlib("patches").Patch(color=pair[0], label=name))
    if polygons:  # All in one collection: matplotlib sorts the polygons of each one by depth.
        axes.add_collection3d(
            art3d.Poly3DCollection(polygons, facecolors=colours, edgecolors=edges, linewidths=0.3)
        )
    _draw_contacts(art3d, axes, picture)
    axes.legend(handles=[*handles, *axes.get_legend_handles_labels()[0]], loc="upper right")
    for set_limits, middle in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), center):
        set_limits(middle - half, middle + half)
    axes.set(xlabel="x", ylabel="y", zlabel="z", title=picture.title, box_aspect=(1, 1, 1))
    axes.locator_params(nbins=5)
    axes.view_init(elev=20, azim=_azimuth(picture))


def _draw_contacts(art3d: Any, axes: Any, picture: Picture) -> None:
    center, half = picture.view
    inside = (np.abs(picture.places - center) <= half).all(axis=1)
    styles = (_OTHER_CONTACT, 8.0, "other contacts"), (_CONTACT, 24.0, "contact, normal")
    for (colour, size, label), of in zip(styles, (~picture.is_main, picture.is_main)):
        places, normals = picture.places[inside & of], picture.normals[inside & of]
        if len(places) == 0:
            continue
        length, size = (0.35 * half, size) if len(places) < 10 else (0.1 * half, size / 3)
        axes.scatter(*places.T, color=[colour], s=size, depthshade=False, zorder=10, label=label)
        lines = np.stack([places, places + length * normals], axis=1)
        axes.add_collection3d(
            art3d.Line3DCollection(lines, colors=[colour], linewidths=1, zorder=10)
        )


def _shaded(polygons: List[NDArray[np.float64]], colour: Any) -> List[NDArray[np.float64]]:
    """A colour for each polygon, darker if it is seen from its edge by the light."""
    if not polygons:
        return []
    corners = np.array([polygon[:3] for polygon in polygons])
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(across, axis=1)
    facing = np.abs(across @ (0.35, -0.5, 0.79)) / np.where(length > 0, length, 1)
    shade = np.stack([0.6 + 0.4 * facing] * 3 + [np.ones(len(polygons))], axis=1)
    return list(shade * colour)


def _azimuth(picture: Picture) -> float:
    """A direction from which the surfaces in contact are seen from the side, in degrees."""
    normals = picture.normals[picture.is_main]
    if len(normals) == 0 or math.hypot(*normals[0][:2]) < 0.3:
        return -60.0
    return math.degrees(math.atan2(normals[0][1], normals[0][0])) - 70
