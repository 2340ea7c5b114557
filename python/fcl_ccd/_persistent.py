# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Hashable, List, Tuple

import numpy as np

from . import _arguments
from ._manager import ManagerResult
from ._results import Kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._manager import Pair


@dataclass(eq=False)
class PersistentPair(_arguments.Built):
    """Two objects in contact, for as long as they are.

    o1, o2 : the names of the objects, as in Pair
    id : int
        The number of the pair, which it keeps while it lasts. No other pair of its
        PersistentPairs has or had it.
    num_steps : int, in how many answers in a row it is; the last one is included
    previous : (k,) int64
        For each contact of the pair: its place among the contacts of the answer before, or
        -1 if it is new.
    data : what you like to keep with the pair; None at first
    """

    o1: Hashable
    o2: Hashable
    id: int
    num_steps: int
    previous: NDArray[np.int64]
    data: Any

    @property
    def is_new(self) -> bool:
        """Whether the pair was not in the answer before."""
        return self.num_steps == 1


class PersistentPairs(_arguments.Built):
    """What has changed from one answer of a CollisionManager to the next.

        tracked = fcl_ccd.PersistentPairs()
        while running:
            result = manager.collide()                  # query="all"
            tracked.update(result)
            for pair, answer in zip(tracked.pairs, result.pairs):
                if pair.is_new: ...
            for pair in tracked.removed: ...

    pairs : list of PersistentPair; pairs[i] is result.pairs[i]
    removed : list of PersistentPair
        Those of the answer before that are not in the last one.

    Two contacts of a pair are the same if they have the same features: kind, side and
    vertices of two meshes; triangle and cell beside a shape or an octree; and parts of
    compounds. An object is known by its name.
    """

    pairs: List[PersistentPair]
    removed: List[PersistentPair]
    _keys: Dict[int, NDArray[np.int64]]
    _next_id: int

    def __init__(self) -> None:
        self.clear()
        self._next_id = 0

    def update(self, result: ManagerResult) -> None:
        """Compare an answer of the manager with the one before.

        Answers should be of one question: with query="first" or "any", pairs that are not
        reported count as parted.
        """
        if not isinstance(result, ManagerResult):
            raise _arguments.wrong_type("result", result, "a ManagerResult")
        before: Dict[Tuple[Hashable, Hashable], PersistentPair] = {
            (pair.o1, pair.o2): pair for pair in self.pairs
        }
        pairs: List[PersistentPair] = []
        keys: Dict[int, NDArray[np.int64]] = {}
        next_id = self._next_id
        names = [(found.o1, found.o2) for found in result.pairs]
        if len(set(names)) < len(names):
            raise ValueError(
                "a pair of names is twice in the result. Give objects that are not registered "
                "a name, and the answer of one query"
            )
        for found in result.pairs:
            now = _keys_of(found)
            old = before.pop((found.o1, found.o2), None)
            if old is None:
                previous = np.full(len(now), -1)
                pair = PersistentPair(found.o1, found.o2, next_id, 1, previous, None)
                next_id += 1
            else:
                previous = _places(self._keys[old.id], now)
                pair = PersistentPair(
                    old.o1, old.o2, old.id, old.num_steps + 1, previous, old.data
                )
            pairs.append(pair)
            keys[pair.id] = now
        self.pairs, self.removed = pairs, list(before.values())
        self._keys, self._next_id = keys, next_id

    def clear(self) -> None:
        """Forget all pairs."""
        self.pairs, self.removed, self._keys = [], [], {}

    def __repr__(self) -> str:
        num_new = sum(pair.is_new for pair in self.pairs)
        return (
            f"PersistentPairs({num_new} new pairs, {len(self.pairs) - num_new} kept, "
            f"{len(self.removed)} removed)"
        )


_SIDE, _FIRST = 3, 4


def _keys_of(pair: Pair) -> NDArray[np.int64]:
    """The features of each contact, as numbers that are the same in all steps."""
    contacts = pair.result.contacts
    kind, side = contacts["kind"].astype(np.int64), contacts["first_on_o1"]
    ids = contacts["vertices"].astype(np.int64)
    is_self = pair._is_self
    keys = np.empty((len(contacts), 9), np.int64)
    keys[:, 0] = np.minimum(kind, Kind.VERTEX_SHAPE)
    keys[:, 1], keys[:, 2] = contacts["part1"], contacts["part2"]
    keys[:, _SIDE] = False if is_self else side
    for which, groups in (
        (Kind.VERTEX_FACE, (slice(1, 4),)),
        (Kind.VERTEX_EDGE, (slice(1, 3),)),
        (Kind.CROSSING, (slice(0, 2), slice(2, 5))),
        (Kind.EDGE_EDGE, (slice(0, 2), slice(2, 4))),
    ):
        rows = kind == which
        for group in groups:
            ids[rows, group] = np.sort(ids[rows, group], axis=1)
    if is_self:  # no edge of a pair is the first one
        a, b = ids[:, 0:2], ids[:, 2:4]
        is_later = (a[:, 0] > b[:, 0]) | ((a[:, 0] == b[:, 0]) & (a[:, 1] > b[:, 1]))
        rows = (kind == Kind.EDGE_EDGE) & is_later
        ids[rows, 0:4] = ids[rows][:, [2, 3, 0, 1]]
    # A shape or a cell has no vertices, and the nearest feature of a triangle changes.
    shapes = kind >= Kind.VERTEX_SHAPE
    ids[shapes] = -1
    ids[shapes, 0], ids[shapes, 1] = contacts["b1"][shapes], contacts["b2"][shapes]
    keys[:, _FIRST:] = ids
    return keys


def _places(before: NDArray[np.int64], now: NDArray[np.int64]) -> NDArray[np.int64]:
    """For each key of now, its place in before, or -1."""
    previous = np.full(len(now), -1)
    if len(before) and len(now):
        _, of_now, of_before = np.intersect1d(_rows(now), _rows(before), return_indices=True)
        previous[of_now] = of_before
    return previous


def _rows(keys: NDArray[np.int64]) -> NDArray[np.void]:
    return np.ascontiguousarray(keys).view(f"V{keys.itemsize * keys.shape[1]}").ravel()
