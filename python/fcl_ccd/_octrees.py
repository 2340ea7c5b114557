# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Tuple

import numpy as np

from . import _arguments, _core
from ._copies import Copied

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

octree_cell_dtype: np.dtype[np.void] = _core.octree_cell_dtype


class OcTree(Copied, _core.OcTree):
    """A map of occupied cells, for example from a depth camera. Each cell is a solid cube.

    points : (n, 3) array of float64
        Each cell of the grid that holds a point is occupied.
    resolution : float
        The side of a cell. The grid starts at the origin, and has 32,768 cells on each side
        of it along x, y and z.

    A contact has the number of a cell where one of a mesh has that of a triangle; cells()
    tells where it is. What is inside of a cell at t = 0 is in contact.

    Attributes (read-only): resolution; num_cells, the number of cells, where eight occupied
    cells that fill a larger cube are one.

    Raises ValueError for a point that is not finite or outside of the grid and for a
    resolution that is not positive, TypeError for another type. It never changes, and any
    number of threads may query it. The map is octomap's.
    """

    _is_built = False  # Compiled attributes exist only after __init__.

    def __init__(self, points: ArrayLike, resolution: float) -> None:
        super().__init__(
            _arguments.points(points, "points"), _arguments.number(resolution, "resolution")
        )
        self._is_built = True

    def cells(self, numbers: ArrayLike) -> NDArray[np.void]:
        """The cells of contacts, for example octree.cells(result.contacts["b2"]).

        numbers : (k,) array of integers, b1 or b2 of contacts with this octree

        Returns a structured array (k,) of octree_cell_dtype, in the frame of the octree:
            center  (3,) float64
            size    float64  the side of the cube

        Raises ValueError for a number that is of no cell.
        """
        return self._cells(_arguments.integers(numbers, "numbers"))

    def _built_from(self) -> Tuple[Any, ...]:
        # The middle of a cell is in no other one: it is half a cell from each border, and
        # rounds by less than 2^-36 of a cell.
        return (self._finest_cells() + 0.5) * self.resolution, self.resolution

    def __repr__(self) -> str:
        if not self._is_built:
            return "OcTree(not built)"
        return f"OcTree({self.num_cells} cells, resolution {self.resolution})"
