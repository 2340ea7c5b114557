# SPDX-License-Identifier: BSD-3-Clause
"""Conversion and checks of arguments. What is contiguous and of the right type is not copied."""

from __future__ import annotations

import math
import operator
from typing import TYPE_CHECKING, Any, Iterable, List, Optional, Sequence, Tuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_WANTED = {"f": "numbers", "i": "integers"}


class Built:
    """A class whose attributes exist only after __init__(). Using them earlier is a TypeError."""

    if not TYPE_CHECKING:  # For mypy any attribute would exist.

        def __getattr__(self, name: str) -> Any:
            """Called for an attribute that was not found."""
            if any(name in getattr(cls, "__annotations__", {}) for cls in type(self).__mro__):
                raise TypeError(
                    f"the __init__() of this {type(self).__name__} was not called, or has not ended"
                )
            return super().__getattribute__(name)


def _array(values: ArrayLike, name: str, kind: str, shape: Sequence[Optional[int]]) -> NDArray[Any]:
    """An array of float64 (kind "f") or int64 ("i") in C order. None in shape: any length."""
    array = np.asarray(values)
    if array.dtype.kind not in ("iuf" if kind == "f" else "iu") and array.size > 0:
        raise TypeError(f"{name} has elements of type {array.dtype}. Give {_WANTED[kind]}")
    if array.ndim != len(shape) or any(
        wanted not in (None, given) for wanted, given in zip(shape, array.shape)
    ):
        wanted_shape = ", ".join("n" if n is None else str(n) for n in shape)
        raise ValueError(
            f"{name} has the shape {array.shape}. Give an array of shape ({wanted_shape})"
        )
    return np.ascontiguousarray(array, dtype=np.float64 if kind == "f" else np.int64)


def points(values: ArrayLike, name: str) -> NDArray[np.float64]:
    return _array(values, name, "f", (None, 3))


def triangles(values: ArrayLike, name: str = "triangles") -> NDArray[np.int64]:
    return _array(values, name, "i", (None, 3))


def free_edges(values: Optional[ArrayLike]) -> NDArray[np.int64]:
    """Two vertices for each edge; None or empty: no edges."""
    array = np.asarray([] if values is None else values)
    if array.size == 0:
        return np.empty((0, 2), dtype=np.int64)
    return _array(array, "edges", "i", (None, 2))


def free_points(values: Optional[ArrayLike]) -> NDArray[np.int64]:
    return _array([] if values is None else values, "points", "i", (None,))


def triangles_or_none(values: Optional[ArrayLike]) -> NDArray[np.int64]:
    return np.empty((0, 3), dtype=np.int64) if values is None else triangles(values)


def integers(values: ArrayLike, name: str) -> NDArray[np.int64]:
    return _array(values, name, "i", (None,))


def feature_points(values: ArrayLike, name: str, num_points: int) -> NDArray[np.float64]:
    return _array(values, name, "f", (None, num_points, 3))


def numbers(values: ArrayLike, name: str, *shape: int) -> NDArray[np.float64]:
    array = _array(values, name, "f", shape)
    if not np.isfinite(array).all():
        raise ValueError(f"{name} has a number that is not finite")
    return array


def number(value: float, name: str) -> float:
    if not isinstance(value, (int, float, np.integer, np.floating)) or isinstance(value, bool):
        raise TypeError(f"{name} is of type {type(value).__name__}. Give a number")
    out = float(value)
    if not math.isfinite(out):
        raise ValueError(f"{name} is {out}. Give a finite number")
    return out


def size(value: float, name: str) -> float:
    """A length that is not negative."""
    out = number(value, name)
    if out < 0:
        raise ValueError(f"{name} is {out}. A size is not negative")
    return out


def bound(value: float, name: str) -> float:
    """What a function of the user gives as a bound."""
    out = number(value, name)
    if out < 0:
        raise ValueError(f"{name} is {out}. A bound is not negative")
    return out


def faces(values: Iterable[ArrayLike], name: str) -> Sequence[int]:
    """Polygons in FCL's encoding: the number of vertices, then the vertices, of each face."""
    encoded: List[int] = []
    for i, face in enumerate(values):
        ids = _array(face, f"face {i} of {name}", "i", (None,))
        if ((ids < -(2**31)) | (ids >= 2**31)).any():
            raise ValueError(f"face {i} of {name} has a number out of range")
        encoded += [len(ids), *ids.tolist()]
    return encoded


def pose(values: ArrayLike, name: str) -> NDArray[np.float64]:
    return _array(values, name, "f", (4, 4))


def integer(value: int, name: str, most: int = 2**31 - 1) -> int:
    number = operator.index(value)
    if not 0 <= number <= most:
        raise ValueError(f"{name} is {number}; it must be from 0 to {most}")
    return number


def bit_masks(values: Optional[ArrayLike], name: str) -> Sequence[int]:
    """The groups or masks of triangles; None or empty: those of the object count."""
    if values is None:
        return ()
    array = _array(values, name, "i", (None,))
    if ((array < 0) | (array >= 2**32)).any():
        raise ValueError(f"{name} has a number out of range. A group or mask has 32 bits")
    masks: Sequence[int] = array.tolist()
    return masks


def origins(values: Optional[ArrayLike]) -> Sequence[int]:
    if values is None:
        return ()
    array = _array(values, "origins", "i", (None,))
    if ((array < -1) | (array >= 2**31)).any():
        raise ValueError("origins has a number out of range. Give triangle numbers, or -1")
    numbers_of_triangles: Sequence[int] = array.tolist()
    return numbers_of_triangles


def frames(given: Tuple[ArrayLike, ...]) -> Tuple[Optional[NDArray[np.float64]], NDArray[np.float64]]:
    """The previous frame, or None, and the current frame."""
    if len(given) == 1:
        return None, points(given[0], "current")
    if len(given) == 2:
        return points(given[0], "previous"), points(given[1], "current")
    raise TypeError(f"update() takes one or two frames; {len(given)} are given")
