# SPDX-License-Identifier: BSD-3-Clause
"""Arguments of another type: the message names the function, the argument, and what it takes."""

import inspect

import numpy as np
import pytest
from scenes import grid

import fcl_ccd

VERTICES, TRIANGLES = grid(4)
MESH, BALL, EYE = fcl_ccd.DeformableMesh(VERTICES, TRIANGLES), fcl_ccd.Sphere(1), np.eye(4)
OCTREE = fcl_ccd.OcTree(VERTICES, 0.1)
MANAGER = fcl_ccd.CollisionManager()
MANAGER.register("ball", BALL)
T0 = {points: np.zeros((1, points, 3)) for points in (2, 3, 4)}
CONTROL = np.zeros((4, 3))
CHAIN = fcl_ccd.JointChain()
CHAIN.add_revolute()
LINKS = fcl_ccd.ChainMotion(CHAIN, [0], [1])
ROBOT = fcl_ccd.CollisionRobot(CHAIN)

# Calls that are right. Methods are found in their class.
CALLS = {
    "BoundedMotion": (
        lambda t: EYE,
        lambda t: 0 * EYE,
        lambda center, radius, t0, t1: 0,
        lambda t0, t1: 0,
    ),
    "Box": (1, 2, 3),
    "Capsule": (1, 2),
    "ChainMotion": (CHAIN, [0], [1]),
    "ChainMotion.link": (LINKS, 0),
    "CollisionManager": (),
    "CollisionManager.collide": (MANAGER, BALL, EYE),
    "CollisionManager.distance": (MANAGER, BALL, EYE),
    "CollisionManager.register": (fcl_ccd.CollisionManager(), "mesh", MESH),
    "CollisionManager.set_filter": (MANAGER, "ball", None),
    "CollisionManager.set_min_approach_speed": (MANAGER, "ball", 0),
    "CollisionManager.set_pair_distance": (MANAGER, "ball", "ball", 0),
    "CollisionManager.set_self_collision": (MANAGER, "ball", False),
    "CollisionManager.set_thickness": (MANAGER, "ball", 0),
    "CollisionManager.step": (MANAGER, {"ball": EYE}),
    "CollisionManager.unregister": (fcl_ccd.CollisionManager(), "ball"),
    "CollisionManager.update": (MANAGER,),
    "CollisionRobot": (CHAIN,),
    "CollisionRobot.allow": (ROBOT, 0, -1),
    "CollisionRobot.allow_neighbours": (ROBOT,),
    "CollisionRobot.attach": (fcl_ccd.CollisionRobot(CHAIN), 0, BALL),
    "CollisionRobot.check_edge": (ROBOT, [0], [1]),
    "CollisionRobot.check_motion": (ROBOT, LINKS),
    "CollisionRobot.detach": (fcl_ccd.CollisionRobot(CHAIN), 0),
    "CollisionRobot.name_of": (ROBOT, 0),
    "CollisionRobot.set_filter": (ROBOT, 0),
    "CollisionRobot.update": (ROBOT,),
    "Compound": ([(BALL, EYE)],),
    "Cone": (1, 2),
    "Convex": (VERTICES, TRIANGLES),
    "Cylinder": (1, 2),
    "DeformableMesh": (VERTICES, TRIANGLES),
    "DeformableMesh.update": (MESH, VERTICES, VERTICES),
    "DeformableMesh.update_topology": (MESH, TRIANGLES, VERTICES, VERTICES),
    "Ellipsoid": (1, 2, 3),
    "Filter": (),
    "Groups": (),
    "Groups.can_meet": (fcl_ccd.Groups(), 0, 1),
    "Groups.filter_of": (fcl_ccd.Groups(), 0),
    "Groups.set": (fcl_ccd.Groups(), 0, 1, False),
    "Halfspace": ((0, 0, 1), 1),
    "JointChain": (),
    "JointChain.add_fixed": (fcl_ccd.JointChain(),),
    "JointChain.add_prismatic": (fcl_ccd.JointChain(),),
    "JointChain.add_revolute": (fcl_ccd.JointChain(),),
    "LinearMotion": (EYE, EYE),
    "LinkMotion": (LINKS, 0),
    "OcTree": (VERTICES, 0.1),
    "OcTree.cells": (OCTREE, [0]),
    "PersistentPairs": (),
    "PersistentPairs.clear": (fcl_ccd.PersistentPairs(),),
    "PersistentPairs.update": (fcl_ccd.PersistentPairs(), MANAGER.collide()),
    "Plane": ((0, 0, 1), 1),
    "RigidMesh": (VERTICES, TRIANGLES),
    "ScrewMotion": (EYE, EYE),
    "Sphere": (1,),
    "SplineMotion": (CONTROL, CONTROL),
    "TwistMotion": (EYE, (0, 0, 1), (0, 0, 1)),
    "TriangleP": (*VERTICES[:3],),
    "WaypointMotion": ([EYE, EYE], (0, 1)),
    "candidates": (MESH, MESH),
    "collide": (MESH, BALL),
    "distance": (MESH, BALL),
    "edge_edge": (T0[4], T0[4]),
    "self_candidates": (MESH,),
    "self_collide": (MESH,),
    "urdf_origin": (),
    "vertex_edge": (T0[3], T0[3]),
    "vertex_face": (T0[4], T0[4]),
    "vertex_vertex": (T0[2], T0[2]),
    "to_dataframe": (fcl_ccd.collide(MESH, MESH).contacts,),
    "weld_vertices": ([VERTICES],),
}
REQUIRED = {"vertex_edge": {"min_distance": 1.0}, "vertex_vertex": {"min_distance": 1.0}}
MADE_BY_QUERIES = (
    "DistanceResult",
    "EdgeResult",
    "Kind",
    "ManagerResult",
    "Motion",
    "NearestPair",
    "Pair",
    "PersistentPair",
    "Result",
    "RobotPair",
)
FRAMES = fcl_ccd.DeformableMesh.update  # has no names of arguments


def public_calls():
    """The name and the function or class of each call of the package."""
    for name in fcl_ccd.__all__:
        of = getattr(fcl_ccd, name)
        if inspect.isfunction(of):
            yield name, of
        elif inspect.isclass(of) and name not in MADE_BY_QUERIES:
            yield name, of
            for method, function in inspect.getmembers(of, inspect.isfunction):
                if not method.startswith("_"):
                    yield f"{name}.{method}", function


def wrong_values(annotation):
    values = [object()]
    if "Literal" not in annotation and "Hashable" not in annotation:
        values.append("text")
    if annotation in ("float", "int", "bool") or "Literal" in annotation:
        values += [None, [1], np.zeros(2), b"1"]
    if annotation in ("float", "int"):
        values += [True, "1"]
    if annotation == "int":
        values.append(1.5)
    return values


def wrong_arguments():
    for name, function in public_calls():
        for argument, parameter in inspect.signature(function).parameters.items():
            if argument not in ("self", "name", "name1", "name2") and function is not FRAMES:
                for value in wrong_values(parameter.annotation):
                    yield pytest.param(name, function, argument, value, id=f"{name}-{argument}")


def test_all_calls_are_in_the_table():
    assert sorted(name for name, _ in public_calls()) == sorted(CALLS)
    assert len(list(wrong_arguments())) > 300


@pytest.mark.parametrize("name, function, argument, value", wrong_arguments())
def test_one_wrong_argument(name, function, argument, value):
    """The others are right."""
    bound = inspect.signature(function).bind(*CALLS[name], **REQUIRED.get(name, {}))
    bound.arguments[argument] = value
    with pytest.raises(TypeError) as error:
        function(*bound.args, **bound.kwargs)
    message = str(error.value)
    assert message.startswith(f"{name}(): "), message
    assert argument in message and " Give " in message, message
    assert "\n" not in message  # not a list of overloads


def test_frames():
    for frames in ((object(),), (VERTICES, "text"), (None, VERTICES)):
        with pytest.raises(TypeError, match=r"DeformableMesh.update\(\): (current|previous) is"):
            MESH.update(*frames)


def test_functions_of_the_user_are_not_named():
    """A TypeError from inside of a callback is the user's own."""

    def fails(b1, b2):
        raise TypeError("mine")

    with pytest.raises(TypeError, match="^mine$"):
        fcl_ccd.collide(MESH, MESH, accepts_triangles=fails)

    def nested(block):
        fcl_ccd.Sphere("1")

    with pytest.raises(TypeError, match=r"^Sphere\(\): radius is of type str. Give a number"):
        fcl_ccd.candidates(MESH, MESH, sink=nested)


@pytest.mark.parametrize("value", [1e-4 + 1j, np.complex128(1e-4), bytearray(b"1e-4"), np.array([1e-4])])
def test_what_float_would_take_is_no_number(value):
    with pytest.raises(TypeError, match=r"self_collide\(\): toc_err is of type"):
        fcl_ccd.self_collide(MESH, toc_err=value)
