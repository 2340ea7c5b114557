# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of contacts as pages: a browser draws them in 3D, and nothing else is needed."""

from __future__ import annotations

import base64
import html
import importlib
import json
import os
import string
import sys
import tempfile
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, Union

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._pictures import Picture
    from ._surfaces import Pieces, View

_FOLDER = Path(__file__).parent
# It has three.js, and is empty where the package was built without npm.
_VIEWER = _FOLDER / "viewer.min.js"
_HEIGHT = 620  # of the page in a notebook, in pixels


def has_viewer() -> bool:
    return _VIEWER.exists() and _VIEWER.stat().st_size > 0


def write(picture: Picture, file: Union[str, os.PathLike[str]]) -> None:
    Path(os.fsdecode(file)).write_text(_page_of(picture), encoding="utf-8")


def open_page(picture: Picture) -> None:
    """In the notebook, or in a browser, for which a temporary file is written."""
    page = _page_of(picture)
    if _is_notebook():
        frame = (
            f'<iframe srcdoc="{html.escape(page)}" width="100%" height="{_HEIGHT}" '
            'style="border: 0"></iframe>'
        )
        shown = {"text/html": frame, "text/plain": picture.title}
        importlib.import_module("IPython.display").display(shown, raw=True)
        return
    with tempfile.NamedTemporaryFile(
        "w", prefix="fcl_ccd_", suffix=".html", delete=False, encoding="utf-8"
    ) as file:
        file.write(page)
    if not webbrowser.open(Path(file.name).as_uri()):
        os.unlink(file.name)
        raise RuntimeError(
            "show() found neither matplotlib nor a browser. Give a file, for example "
            "show(file='contact.html')"
        )


def _is_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    return ipython is not None and hasattr(ipython.get_ipython(), "kernel")


def _page_of(picture: Picture) -> str:
    if not has_viewer():
        raise RuntimeError(
            "this fcl_ccd was built without the 3D view of pages, which needs npm. Install "
            "matplotlib and give another file, for example show(file='contact.png')"
        )
    template, script = (
        (_FOLDER / name).read_text(encoding="utf-8") for name in ("_page.html", "_page.js")
    )
    # No text ends the script that has it.
    data = json.dumps(_data_of(picture)).replace("<", "\\u003c")
    return string.Template(template).substitute(
        title=html.escape(picture.title.splitlines()[0]),
        picture=data,
        viewer=_VIEWER.read_text(encoding="utf-8"),
        script=script,
    )


def _data_of(picture: Picture) -> Dict[str, Any]:
    """
    What _page.js draws. Positions are float32, from the centre of the view in units of its half:
    they round most where they are far from what is looked at. Contacts have their places in
    full, too.
    """
    view = picture.view
    contacts = zip(picture.places, picture.normals, picture.is_main)
    return {
        "title": picture.title,
        "names": [name for name, _, _ in picture.objects],
        "triangles": {**_group(picture, view, _triangles), "sides": _sides(picture)},
        "segments": _group(picture, view, lambda pieces: pieces.segments),
        "points": _group(picture, view, lambda pieces: pieces.points[:, None]),
        "contacts": [
            {
                "position": place.tolist(),
                "from_centre": ((place - view.center) / view.half).tolist(),
                "normal": normal.tolist(),
                "is_main": bool(is_main),
                "toc_lo": 0,  # it has begun
            }
            for place, normal, is_main in contacts
        ],
    }


def _group(picture: Picture, view: View, corners_of: Any) -> Dict[str, Any]:
    """
    All triangles, segments or points of the picture.

    positions : of their corners
    touched : of each whether it is a part in contact
    of_first : how many are of the first object
    """
    corners: List[NDArray[np.float64]] = []
    touched: List[NDArray[np.uint8]] = []
    of_object: List[int] = []
    for _, others, parts in picture.objects:
        both = corners_of(others), corners_of(parts)
        corners += [of.reshape(-1, 3) for of in both]
        touched += [np.full(len(of), i, np.uint8) for i, of in enumerate(both)]
        of_object.append(sum(map(len, both)))
    positions = (np.concatenate(corners) - view.center) / view.half
    return {
        "positions": _base64(positions.astype("<f4")),
        "touched": _base64(np.concatenate(touched)),
        "of_first": of_object[0],
    }


def _triangles(pieces: Pieces) -> NDArray[np.float64]:
    """Fans (n, 3, 3) of the polygons, all first triangles before all second ones."""
    polygons = pieces.polygons
    fans = [polygons[:, (0, i, i + 1)] for i in range(1, polygons.shape[1] - 1)]
    return np.concatenate(fans)


def _sides(picture: Picture) -> str:
    """Of each triangle as bits which sides are edges: not between triangles of a fan."""
    sides: List[NDArray[np.uint8]] = []
    for _, *both in picture.objects:
        for pieces in both:
            count, last = len(pieces.polygons), pieces.polygons.shape[1] - 2
            for i in range(1, last + 1):
                bits = 0 if pieces.are_round else (i == 1) * 1 + 2 + (i == last) * 4
                sides.append(np.full(count, bits, np.uint8))
    return _base64(np.concatenate(sides))


def _base64(numbers: NDArray[Any]) -> str:
    return base64.b64encode(numbers.tobytes()).decode("ascii")
