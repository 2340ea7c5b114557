from typing import Any, Callable, Dict, Optional, Sequence

import numpy as np
from numpy.typing import NDArray

version: str
contact_dtype: np.dtype[np.void]
candidate_dtype: np.dtype[np.void]
feature_test_dtype: np.dtype[np.void]

class Mesh: ...

class DeformableMesh(Mesh):
    def __init__(
        self, vertices: NDArray[np.float64], triangles: NDArray[np.int64], num_threads: int
    ) -> None: ...
    def _update(
        self, previous: Optional[NDArray[np.float64]], current: NDArray[np.float64]
    ) -> None: ...
    def _update_topology(
        self,
        triangles: NDArray[np.int64],
        previous: NDArray[np.float64],
        current: NDArray[np.float64],
        origins: Sequence[int],
    ) -> None: ...
    @property
    def num_vertices(self) -> int: ...
    @property
    def num_triangles(self) -> int: ...
    @property
    def num_restructurings(self) -> int: ...
    @property
    def is_deforming(self) -> bool: ...
    @property
    def previous(self) -> NDArray[np.float64]: ...
    @property
    def current(self) -> NDArray[np.float64]: ...
    @property
    def triangles(self) -> NDArray[np.int64]: ...

class RigidMesh(Mesh):
    def __init__(self, vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> None: ...
    @property
    def num_vertices(self) -> int: ...
    @property
    def num_triangles(self) -> int: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def triangles(self) -> NDArray[np.int64]: ...

class Motion:
    @staticmethod
    def straight(begin: NDArray[np.float64], end: NDArray[np.float64], name: str) -> Motion: ...
    @staticmethod
    def turn(
        begin: NDArray[np.float64],
        end: NDArray[np.float64],
        reference: NDArray[np.float64],
        name: str,
    ) -> Motion: ...
    @staticmethod
    def screw(begin: NDArray[np.float64], end: NDArray[np.float64], name: str) -> Motion: ...
    @staticmethod
    def spline(translation: NDArray[np.float64], rotation: NDArray[np.float64]) -> Motion: ...

class Filter:
    def __init__(
        self,
        group: int,
        mask: int,
        triangle_groups: Sequence[int],
        triangle_masks: Sequence[int],
    ) -> None: ...

class Request:
    def __init__(
        self,
        query: str,
        toc_err: float,
        num_max_contacts: Optional[int],
        enable_contact: bool,
        t_max: float,
        enable_crossings: bool,
        filter1: Filter,
        filter2: Filter,
        accepts_triangles: Optional[Callable[[int, int], bool]],
        num_threads: int,
        min_distance: float,
        ignore_initially_closer: bool,
    ) -> None: ...

def self_collide(o: Mesh, request: Request) -> Dict[str, Any]: ...
def collide(
    o1: Mesh, motion1: Motion, o2: Mesh, motion2: Motion, request: Request
) -> Dict[str, Any]: ...
def self_candidates(
    o: Mesh,
    sink: Callable[[NDArray[np.void]], Optional[bool]],
    block_size: int,
    min_distance: float,
) -> bool: ...
def candidates(
    o1: Mesh,
    motion1: Motion,
    o2: Mesh,
    motion2: Motion,
    sink: Callable[[NDArray[np.void]], Optional[bool]],
    block_size: int,
    min_distance: float,
) -> bool: ...
def vertex_face(
    t0: NDArray[np.float64], t1: NDArray[np.float64], toc_err: float, min_distance: float
) -> NDArray[np.void]: ...
def edge_edge(
    t0: NDArray[np.float64], t1: NDArray[np.float64], toc_err: float, min_distance: float
) -> NDArray[np.void]: ...
def vertex_edge(
    t0: NDArray[np.float64], t1: NDArray[np.float64], toc_err: float, min_distance: float
) -> NDArray[np.void]: ...
def vertex_vertex(
    t0: NDArray[np.float64], t1: NDArray[np.float64], toc_err: float, min_distance: float
) -> NDArray[np.void]: ...
