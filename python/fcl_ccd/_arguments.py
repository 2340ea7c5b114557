# SPDX-License-Identifier: BSD-3-Clause
"""Conversion and checks of arguments. What is contiguous and of the right type is not copied.

A TypeError names the function that the user called, the argument, and what it takes.
"""

from __future__ import annotations

import math
import operator
import sys
from numbers import Real
from typing import TYPE_CHECKING, Any, Iterable, List, Optional, Protocol, Sequence, Tuple, Union

import numpy as np

if TYPE_CHECKING:
    from types import FrameType

    from numpy.typing import ArrayLike, NDArray

_WANTED = {"f": "numbers", "i": "integers"}


class _MeshOfFaces(Protocol):
    """A mesh as a trimesh.Trimesh."""

    @property
    def vertices(self) -> Any: ...

    @property
    def faces(self) -> Any: ...


class _MeshOfTriangles(Protocol):
    """A mesh as Open3D's TriangleMesh."""

    @property
    def vertices(self) -> Any: ...

    @property
    def triangles(self) -> Any: ...


# A mesh of another package.
TriangleMesh = Union[_MeshOfFaces, _MeshOfTriangles]


class Built:
    """A class whose attributes exist only after __init__(). Using them earlier is a TypeError."""

    if not TYPE_CHECKING:  # For mypy any attribute would exist.

        def __getattr__(self, name: str) -> Any:
            """Called for an attribute that was not found."""
            own = [c for c in type(self).__mro__ if c.__module__.partition(".")[0] == __package__]
            if any(name in getattr(c, "__annotations__", {}) for c in own):
                raise TypeError(
                    f"the __init__() of this {type(self).__name__} was not called, or has not ended"
                )
            return super().__getattribute__(name)


def _called() -> str:
    """The function of this package that the user called, for a message: "collide(): "."""
    frame: Optional[FrameType] = sys._getframe(1)
    called = ""
    while frame is not None and frame.f_globals.get("__package__") == __package__:
        name = frame.f_code.co_name
        owner = frame.f_locals.get("self")
        if owner is not None:
            of = type(owner).__name__
            name = of if name == "__init__" else f"{of}.{name}"
        called, frame = name, frame.f_back
    return f"{called}(): " if called.isidentifier() or "." in called else ""


def type_error(text: str) -> TypeError:
    return TypeError(_called() + text)


def wrong_type(name: str, value: object, wanted: str) -> TypeError:
    return type_error(f"{name} is of type {type(value).__name__}. Give {wanted}")


def _array(values: ArrayLike, name: str, kind: str, shape: Sequence[Optional[int]]) -> NDArray[Any]:
    """An array of float64 (kind "f") or int64 ("i") in C order. None in shape: any length."""
    try:
        array = np.asarray(values)
    except ValueError as error:  # for example lists of different lengths
        raise ValueError(f"{name} is no array of {_WANTED[kind]}: {error}") from error
    if array.dtype.kind == "O":
        array = _plain_numbers(array, name, kind)
    if array.dtype.kind not in ("iuf" if kind == "f" else "iu") and array.size > 0:
        raise _wrong_elements(values, array, name, kind)
    if array.ndim != len(shape) or any(
        wanted not in (None, given) for wanted, given in zip(shape, array.shape)
    ):
        wanted_shape = ", ".join("n" if n is None else str(n) for n in shape)
        raise ValueError(
            f"{name} has the shape {array.shape}. Give an array of shape ({wanted_shape})"
        )
    if array.dtype == np.uint64 and kind == "i" and array.size > 0:
        largest = int(array.max())
        if largest > _MOST:
            raise _too_large(largest, name)
    return np.ascontiguousarray(array, dtype=np.float64 if kind == "f" else np.int64)


_MOST = 2**63 - 1


def _too_large(number: int, name: str) -> ValueError:
    return ValueError(f"{name} has the number {number}. The largest number possible is 2^63 - 1")


def _plain_numbers(array: NDArray[Any], name: str, kind: str) -> NDArray[Any]:
    """The same in numpy's numbers where all elements are Python's, else as it is."""
    elements = array.ravel().tolist()
    if not all(type(element) in ((int, float) if kind == "f" else (int,)) for element in elements):
        return array
    if kind == "f":
        try:
            return array.astype(np.float64)
        except OverflowError as error:
            raise ValueError(f"{name} has a number that is too large for a double") from error
    largest = max(elements, key=abs, default=0)
    if abs(largest) > _MOST:
        raise _too_large(largest, name)
    return array.astype(np.int64)


def _wrong_elements(values: object, array: NDArray[Any], name: str, kind: str) -> Exception:
    if array.ndim == 0:
        return wrong_type(name, values, f"an array of {_WANTED[kind]}")
    if array.dtype.kind != "O":
        return type_error(f"{name} has elements of type {array.dtype}. Give {_WANTED[kind]}")
    elements = array.ravel().tolist()
    other = next((e for e in elements if type(e) not in (int, float)), elements[0])
    return type_error(
        f"{name} is an array of objects, with an element of type {type(other).__name__}. "
        f"Give an array of {_WANTED[kind]}"
    )


def _faces_of(values: Any) -> Any:
    """The triangles of a mesh of another package; None: it is no such mesh."""
    if isinstance(values, (np.ndarray, list, tuple)) or not hasattr(values, "vertices"):
        return None
    found = getattr(values, "faces", None)  # trimesh: its triangles are positions
    return getattr(values, "triangles", None) if found is None else found  # Open3D


def is_mesh(values: Any) -> bool:
    return _faces_of(values) is not None


def mesh(values: TriangleMesh, name: str) -> TriangleMesh:
    """A mesh of another package."""
    if is_mesh(values):
        return values
    wanted = "a mesh with vertices and faces, for example a trimesh.Trimesh"
    if hasattr(values, "geometry"):
        wanted += ". Of a scene: trimesh.load(file, force='mesh')"
    raise wrong_type(name, values, wanted)


def points(values: Union[ArrayLike, TriangleMesh], name: str) -> NDArray[np.float64]:
    """Positions, also those of a mesh of another package."""
    if type(values) is not np.ndarray and is_mesh(values):
        values = values.vertices  # type: ignore[union-attr]
    return _array(values, name, "f", (None, 3))  # type: ignore[arg-type]


def triangles_of(vertices: Any, triangles: Any, name: str = "triangles") -> Any:
    """The given triangles, or those of the mesh that is given in place of vertices."""
    found = _faces_of(vertices)
    if found is not None and triangles is not None:
        raise type_error(f"vertices is a mesh that has {name}, and {name} is given. Give one of them")
    return triangles if found is None else found


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


def list_of_numbers(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """Any count of finite numbers."""
    array = _array(values, name, "f", (None,))
    if not np.isfinite(array).all():
        raise ValueError(f"{name} has a number that is not finite")
    return array


def numbers(values: ArrayLike, name: str, *shape: int) -> NDArray[np.float64]:
    array = _array(values, name, "f", shape)
    if not np.isfinite(array).all():
        raise ValueError(f"{name} has a number that is not finite")
    return array


def real(value: float, name: str) -> float:
    """A number. It may be infinite or NaN, which the library judges."""
    if type(value) is float:
        return value
    if not isinstance(value, Real) or isinstance(value, bool):
        raise wrong_type(name, value, "a number")
    try:
        return float(value)
    except OverflowError as error:
        raise ValueError(f"{name} is {value}. It is too large for a double") from error


def number(value: float, name: str) -> float:
    out = real(value, name)
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


def _in_range(array: NDArray[Any], name: str, least: int, most: int, wanted: str) -> List[int]:
    outside = array[(array < least) | (array > most)]
    if outside.size > 0:
        raise ValueError(f"{name} has the number {outside[0]}, out of range. {wanted}")
    numbers_in_range: List[int] = array.tolist()
    return numbers_in_range


def iterable(values: Any, name: str, wanted: str) -> Iterable[Any]:
    if isinstance(values, (str, bytes)):
        raise wrong_type(name, values, wanted)
    try:
        found: Iterable[Any] = iter(values)
    except TypeError as error:
        raise wrong_type(name, values, wanted) from error
    return found


def faces(values: Iterable[ArrayLike], name: str) -> Sequence[int]:
    """Polygons in FCL's encoding: the number of vertices, then the vertices, of each face."""
    encoded: List[int] = []
    for i, face in enumerate(iterable(values, name, "an array of integers or a list of polygons")):
        of = f"face {i} of {name}"
        ids = _array(face, of, "i", (None,))
        wanted = "Vertices are numbered from 0"
        encoded += [len(ids), *_in_range(ids, of, -(2**31), 2**31 - 1, wanted)]
    return encoded


def pose(values: ArrayLike, name: str) -> NDArray[np.float64]:
    return _array(values, name, "f", (4, 4))


def poses(values: ArrayLike, name: str) -> NDArray[np.float64]:
    return _array(values, name, "f", (None, 4, 4))


def integer(value: int, name: str, most: int = 2**31 - 1) -> int:
    if isinstance(value, bool):
        raise wrong_type(name, value, "an integer")
    try:
        number = operator.index(value)
    except TypeError as error:
        raise wrong_type(name, value, "an integer") from error
    if not 0 <= number <= most:
        raise ValueError(f"{name} is {number}; it must be from 0 to {most}")
    return number


def flag(value: bool, name: str) -> bool:
    if value is True or value is False:
        return value
    if isinstance(value, np.bool_) or (isinstance(value, (int, np.integer)) and value in (0, 1)):
        return bool(value)
    raise wrong_type(name, value, "True or False")


def function_or_none(value: Any, name: str) -> Any:
    if value is not None and not callable(value):
        raise wrong_type(name, value, "a function, or None")
    return value


def bit_masks(values: Optional[ArrayLike], name: str) -> Sequence[int]:
    """The groups or masks of triangles; None or empty: those of the object count."""
    if values is None:
        return ()
    wanted = "A group or mask has 32 bits"
    return _in_range(_array(values, name, "i", (None,)), name, 0, 2**32 - 1, wanted)


def origins(values: Optional[ArrayLike]) -> Sequence[int]:
    if values is None:
        return ()
    wanted = "Give triangle numbers, or -1"
    return _in_range(_array(values, "origins", "i", (None,)), "origins", -1, 2**31 - 1, wanted)


def frames(
    given: Tuple[Union[ArrayLike, TriangleMesh], ...],
) -> Tuple[Optional[NDArray[np.float64]], NDArray[np.float64]]:
    """The previous frame, or None, and the current frame."""
    if len(given) == 1:
        return None, points(given[0], "current")
    if len(given) == 2:
        return points(given[0], "previous"), points(given[1], "current")
    raise type_error(f"one or two frames are needed; {len(given)} are given")
