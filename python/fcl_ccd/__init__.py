# SPDX-License-Identifier: BSD-3-Clause
"""Continuous collision detection of triangle meshes that deform or move, of shapes and maps.

A step goes from t = 0 to t = 1. A contact is a vertex and a face, or two edges, that touch
during the step; or a triangle and a shape, or two shapes. No contact is missed, and no time
is late.

    import fcl_ccd

    cloth = fcl_ccd.DeformableMesh(vertices, triangles)   # (n, 3) floats, (m, 3) integers
    tool = fcl_ccd.RigidMesh(tool_vertices, tool_triangles)

    cloth.update(next_vertices)                           # each step
    result = fcl_ccd.self_collide(cloth)                  # the cloth with itself
    result = fcl_ccd.collide(cloth, tool, motion2=(pose_t0, pose_t1))   # 4x4 arrays

    if result:
        print(result.time_of_contact)                     # in fractions of the step
        print(result.contacts["pos"])                     # (k, 3): a structured array

Meshes: DeformableMesh, RigidMesh; weld_vertices() for triangle soup. Shapes: Box, Sphere,
Capsule, Ellipsoid, Cone, Cylinder, Convex, Plane, Halfspace, TriangleP. Maps of occupied
cells: OcTree. Bodies of several of these: Compound. Motions: a pose, two poses,
LinearMotion, ScrewMotion, TwistMotion, SplineMotion, WaypointMotion, the links of a robot (JointChain, ChainMotion), and your own as
a BoundedMotion. Queries: collide(), self_collide(), which take a Filter and give a Result.
How near two objects come: distance(), which gives a DistanceResult. Many objects:
CollisionManager, and PersistentPairs for what has changed since the last step. Edges of a
planner: CollisionRobot. With min_distance features are in
contact at a distance. For your own solver: candidates(), self_candidates(); vertex_face(),
edge_edge(), vertex_edge() and vertex_vertex() on arrays.

Tables and pictures: to_dataframe() makes a pandas.DataFrame of contacts, Result.show() draws
them. Meshes, shapes, motions, filters and results can be copied and pickled.

Errors: ValueError with the words of the library, TypeError for arguments of another type,
RuntimeError for an update of a mesh while a query of it runs.
"""

from . import _requirements  # isort: skip - it says what is missing for the rest
from ._chains import ChainMotion, JointChain, LinkMotion, urdf_origin
from ._compounds import Compound
from ._core import version as __version__
from ._dataframes import to_dataframe
from ._manager import CollisionManager, ManagerResult, NearestPair, Pair
from ._meshes import DeformableMesh, RigidMesh, weld_vertices
from ._motions import (
    BoundedMotion,
    LinearMotion,
    Motion,
    ScrewMotion,
    SplineMotion,
    TwistMotion,
    WaypointMotion,
)
from ._octrees import OcTree, octree_cell_dtype
from ._persistent import PersistentPair, PersistentPairs
from ._queries import (
    DistanceResult,
    Filter,
    Groups,
    candidate_dtype,
    candidates,
    collide,
    distance,
    edge_edge,
    feature_test_dtype,
    self_candidates,
    self_collide,
    vertex_edge,
    vertex_face,
    vertex_vertex,
)
from ._results import Kind, Result, contact_dtype
from ._robots import CollisionRobot, EdgeResult, RobotPair
from ._shapes import (
    Box,
    Capsule,
    Cone,
    Convex,
    Cylinder,
    Ellipsoid,
    Halfspace,
    Plane,
    Sphere,
    TriangleP,
)

__all__ = [
    "BoundedMotion",
    "Box",
    "Capsule",
    "ChainMotion",
    "CollisionManager",
    "CollisionRobot",
    "Compound",
    "Cone",
    "Convex",
    "Cylinder",
    "DeformableMesh",
    "DistanceResult",
    "EdgeResult",
    "Ellipsoid",
    "Filter",
    "Groups",
    "Halfspace",
    "JointChain",
    "Kind",
    "LinearMotion",
    "LinkMotion",
    "ManagerResult",
    "Motion",
    "NearestPair",
    "OcTree",
    "Pair",
    "PersistentPair",
    "PersistentPairs",
    "Plane",
    "Result",
    "RigidMesh",
    "RobotPair",
    "ScrewMotion",
    "Sphere",
    "SplineMotion",
    "TriangleP",
    "TwistMotion",
    "WaypointMotion",
    "candidate_dtype",
    "candidates",
    "collide",
    "contact_dtype",
    "distance",
    "edge_edge",
    "feature_test_dtype",
    "octree_cell_dtype",
    "self_candidates",
    "self_collide",
    "to_dataframe",
    "urdf_origin",
    "vertex_edge",
    "vertex_face",
    "vertex_vertex",
    "weld_vertices",
]
