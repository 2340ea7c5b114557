# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Sequence, Tuple, Union, overload

from . import _arguments, _core
from ._copies import Copied

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from ._arguments import TriangleMesh


class DeformableMesh(Copied, _core.DeformableMesh):
    """A triangle mesh that deforms between two frames, t = 0 and t = 1.

    Build it once, then give each next step with update(). Until the first update() both
    frames are equal. Queries test the motion between the two frames: each vertex moves on
    a straight line.

    Parameters
    ----------
    vertices : (n, 3) array of float64
        Positions in any unit of length, which positions of contacts have too. Other
        numbers are converted. Or a mesh of another package with vertices and faces, for
        example a trimesh.Trimesh, without triangles then.
    triangles : (m, 3) array of integers, or None
        Vertex numbers, from 0. None: only edges and points.
    edges : (e, 2) array of integers, optional
        Free edges, by vertex numbers: pieces of cables and rods, without triangles.
    points : (p,) array of integers, optional
        Free points, by vertex number: points of a cloud. They meet faces; with
        min_distance also edges and other points.
    num_threads : int
        Threads of the build and of updates. 0: all cores.

    At least one triangle, edge or point. In contacts b1 and b2 number the triangles first,
    then the edges, then the points.

    Raises ValueError for a vertex number out of range, an edge of a vertex with itself, a
    position that is not finite or an array of another shape, and TypeError for elements of
    another type.

    Attributes (read-only)
    ----------------------
    previous, current : (n, 3) float64, copies of the two frames
    triangles : (m, 3) int64, a copy
    edges, points : (e, 2) and (p,) int64, copies
    num_vertices, num_triangles, num_edges, num_points : int
    num_threads : int
    is_deforming : bool, whether the frames differ
    num_restructurings : int, how many updates have made parts of the tree anew

    Threads: queries of one mesh may run side by side. An update while a query of the mesh
    runs, or the reverse, raises RuntimeError and changes nothing.

    copy.deepcopy() and pickle make a mesh of the same two frames, with a new tree.
    """

    _is_built = False  # Compiled attributes exist only after __init__.

    def __init__(
        self,
        vertices: Union[ArrayLike, TriangleMesh],
        triangles: Optional[ArrayLike] = None,
        *,
        edges: Optional[ArrayLike] = None,
        points: Optional[ArrayLike] = None,
        num_threads: int = 1,
    ) -> None:
        super().__init__(
            _arguments.points(vertices, "vertices"),
            _arguments.triangles_or_none(_arguments.triangles_of(vertices, triangles)),
            _arguments.free_edges(edges),
            _arguments.free_points(points),
            _arguments.integer(num_threads, "num_threads"),
        )
        self._is_built = True

    @classmethod
    def from_trimesh(cls, mesh: TriangleMesh, *, num_threads: int = 1) -> DeformableMesh:
        """DeformableMesh(mesh, num_threads=num_threads), for those who look for this name.

        mesh : a trimesh.Trimesh, or another mesh with vertices and faces

        A next frame is given by update(next_mesh). Load frames by trimesh.load(file,
        process=False): else it joins and renumbers the vertices of each file.

        Raises TypeError for anything else, also for vertices alone.
        """
        return cls(_arguments.mesh(mesh, "mesh"), num_threads=num_threads)

    @overload
    def update(self, current: Union[ArrayLike, TriangleMesh], /) -> None: ...

    @overload
    def update(
        self,
        previous: Union[ArrayLike, TriangleMesh],
        current: Union[ArrayLike, TriangleMesh],
        /,
    ) -> None: ...

    def update(self, *frames: Union[ArrayLike, TriangleMesh]) -> None:
        """Give the next step: update(current) or update(previous, current).

        With one frame, what was the current frame becomes the previous one. Frames are
        (n, 3) arrays; contiguous float64 is read in place. After an error (ValueError,
        TypeError) the mesh is unchanged.
        """
        previous, current = _arguments.frames(frames)
        self._update(previous, current)

    def _built_from(self) -> Tuple[Any, ...]:
        """The arguments, then the current frame."""
        return self._parts()  # all of one step, also while another thread gives the next

    def __reduce_ex__(self, protocol: Any) -> Tuple[Any, ...]:
        rebuilt, (of, (*given, current)), state = super().__reduce_ex__(protocol)
        return rebuilt, (of, tuple(given)), (state, current)

    def __setstate__(self, given: Tuple[Any, ...]) -> None:
        state, current = given
        self.__dict__.update(state)
        if (self.current != current).any():  # The mesh was built in its previous frame.
            self._update(None, current)

    def update_topology(
        self,
        triangles: Optional[ArrayLike],
        previous: ArrayLike,
        current: ArrayLike,
        *,
        origins: Optional[ArrayLike] = None,
        edges: Optional[ArrayLike] = None,
        points: Optional[ArrayLike] = None,
    ) -> None:
        """Give the next step of a mesh that has torn, broken, grown or lost parts.

        Parameters
        ----------
        triangles : (m, 3) array of integers
            All triangles of the new mesh.
        previous, current : (n, 3) arrays
            Both frames of the new mesh.
        origins : (m,) array of integers, optional
            For each triangle the number of the old triangle that it was, or was cut from;
            -1 for a new one. A hint that saves time and never changes an answer. None:
            triangle i was triangle i.
        edges, points : arrays of integers, optional
            All free edges and points of the new mesh. With them the tree is made anew.
        """
        self._update_topology(
            _arguments.triangles_or_none(triangles),
            _arguments.points(previous, "previous"),
            _arguments.points(current, "current"),
            _arguments.origins(origins),
            _arguments.free_edges(edges),
            _arguments.free_points(points),
        )

    def __repr__(self) -> str:
        if not self._is_built:
            return "DeformableMesh(not built)"
        free = f", {self.num_edges} edges, {self.num_points} points"
        has_free = self.num_edges > 0 or self.num_points > 0
        return (
            f"DeformableMesh({self.num_vertices} vertices, {self.num_triangles} triangles"
            f"{free if has_free else ''})"
        )


class RigidMesh(Copied, _core.RigidMesh):
    """A triangle mesh that does not deform. Queries take its motion as an argument.

    Parameters
    ----------
    vertices : (n, 3) array of float64
        Positions in the frame of the mesh. Or a mesh of another package with vertices and
        faces, for example a trimesh.Trimesh, without triangles then.
    triangles : (m, 3) array of integers
        Vertex numbers, from 0. At least one triangle.

    Errors are those of DeformableMesh. Attributes (read-only): vertices, triangles
    (copies), num_vertices, num_triangles. Any number of threads may query it.
    """

    _is_built = False  # Compiled attributes exist only after __init__.

    def __init__(
        self,
        vertices: Union[ArrayLike, TriangleMesh],
        triangles: Optional[ArrayLike] = None,
    ) -> None:
        positions = _arguments.points(vertices, "vertices")
        found = _arguments.triangles_of(vertices, triangles)
        if found is None:
            raise _arguments.wrong_type("triangles", None, "an array of integers")
        super().__init__(positions, _arguments.triangles(found))
        self._is_built = True

    @classmethod
    def from_trimesh(cls, mesh: TriangleMesh) -> RigidMesh:
        """RigidMesh(mesh), for those who look for this name.

        mesh : a trimesh.Trimesh, or another mesh with vertices and faces

        Raises TypeError for anything else.
        """
        return cls(_arguments.mesh(mesh, "mesh"))

    def _built_from(self) -> Tuple[Any, ...]:
        return self.vertices, self.triangles

    def __repr__(self) -> str:
        if not self._is_built:
            return "RigidMesh(not built)"
        return f"RigidMesh({self.num_vertices} vertices, {self.num_triangles} triangles)"


def weld_vertices(
    frames: Sequence[Union[ArrayLike, TriangleMesh]], *, eps: float = 0.0
) -> NDArray[np.int64]:
    """Find the vertices that coincide in all frames of a mesh.

    In a triangle soup (STL files, exports with split vertices) no two triangles have a
    common vertex, so that neighbours touch in every step. Build the mesh with the joined
    triangles and with all vertices; contacts have the numbers of the file then:

        joined = fcl_ccd.weld_vertices([previous, current])
        mesh = fcl_ccd.DeformableMesh(previous, joined[triangles])

    Parameters
    ----------
    frames : list of (n, 3) arrays
        At least one frame. One is enough for a mesh that only moves rigidly.
    eps : float
        Vertices are joined if no coordinate differs by more than eps, in every frame.

    Returns an (n,) array: for each vertex the number of the vertex that replaces it, or its
    own. Raises ValueError for no frame, frames of different size, a position that is not
    finite, or a negative eps.
    """
    listed = _arguments.iterable(frames, "frames", "a list of (n, 3) arrays")
    return _core.weld_vertices(
        [_arguments.points(frame, f"frame {i}") for i, frame in enumerate(listed)],
        _arguments.size(eps, "eps"),
    )
