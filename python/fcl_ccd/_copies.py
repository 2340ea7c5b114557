# SPDX-License-Identifier: BSD-3-Clause
"""copy(), deepcopy() and pickle of objects that the compiled part has built."""

from __future__ import annotations

from typing import Any, Tuple

from . import _core


def _rebuilt(of: Any, given: Tuple[Any, ...]) -> Any:
    """An object of the class, whose own __init__() may take other arguments."""
    made = of.__new__(of)
    compiled = next(c for c in of.__mro__ if c.__module__ == _core.__name__)
    compiled.__init__(made, *given)
    return made


class Copied:
    """A copy is built from the same numbers, and has the same attributes of Python."""

    def _built_from(self) -> Tuple[Any, ...]:
        """The arguments of the compiled __init__()."""
        raise NotImplementedError

    def __reduce_ex__(self, protocol: Any) -> Tuple[Any, ...]:
        try:
            given = self._built_from()
        except (AttributeError, TypeError) as error:
            name = type(self).__name__
            raise TypeError(f"this {name} cannot be copied or pickled: {error}") from error
        return _rebuilt, (type(self), given), self.__dict__
