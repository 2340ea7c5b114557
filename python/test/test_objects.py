# SPDX-License-Identifier: BSD-3-Clause
"""Objects made without __init__(), copies, and cycles of objects."""

import copy
import gc
import inspect
import pickle
import threading
import weakref

import numpy as np
import pytest
from scenes import grid

import fcl_ccd
from fcl_ccd import _core

VERTICES, TRIANGLES = grid(4)
COMPILED = {name: of for name, of in vars(_core).items() if inspect.isclass(of)}
PUBLIC = {name: getattr(fcl_ccd, name) for name in fcl_ccd.__all__}
PUBLIC = {name: of for name, of in PUBLIC.items() if inspect.isclass(of)}
CLASSES = [*COMPILED.values(), *(of for of in PUBLIC.values() if of is not fcl_ccd.Kind)]
NOT_BUILT = r"the __init__\(\) of this \w+ was not called, or has not ended"


def names(values):
    return [f"{value.__module__}.{value.__name__}" for value in values]


def not_built(of):
    return of.__new__(of)


def test_all_classes_are_found():
    assert len(COMPILED) > 15 and len(PUBLIC) > 20
    for of in (fcl_ccd.Sphere, fcl_ccd.DeformableMesh, fcl_ccd.Filter, fcl_ccd.CollisionManager):
        assert of in CLASSES


@pytest.mark.parametrize("of", CLASSES, ids=names(CLASSES))
def test_attributes_of_objects_that_are_not_built(of):
    """Each property, field and method without arguments."""
    found = not_built(of)
    if issubclass(of, _core.Geometry):
        assert repr(found)
    fields = [name for base in of.__mro__ for name in getattr(base, "__annotations__", {})]
    properties = [name for name, value in inspect.getmembers(of, inspect.isdatadescriptor)]
    for name in [*fields, *properties]:
        if not name.startswith("__"):
            with pytest.raises(TypeError, match=NOT_BUILT):
                getattr(found, name)


MESH = fcl_ccd.DeformableMesh(VERTICES, TRIANGLES)
GEOMETRIES = [of for of in CLASSES if issubclass(of, _core.Geometry)]
MOTIONS = [of for of in CLASSES if issubclass(of, fcl_ccd.Motion)]


@pytest.mark.parametrize("of", GEOMETRIES, ids=names(GEOMETRIES))
def test_geometries_that_are_not_built(of):
    manager = fcl_ccd.CollisionManager()
    manager.register("mesh", MESH)
    calls = [
        lambda: fcl_ccd.collide(not_built(of), MESH),
        lambda: fcl_ccd.collide(MESH, not_built(of), query="first"),
        lambda: manager.register("other", not_built(of)),
        lambda: manager.collide(not_built(of)),
    ]
    if issubclass(of, _core.Mesh):
        calls += [
            lambda: fcl_ccd.self_collide(not_built(of)),
            lambda: fcl_ccd.candidates(MESH, not_built(of)),
            lambda: fcl_ccd.self_candidates(not_built(of)),
        ]
    if of is fcl_ccd.DeformableMesh:
        calls += [
            lambda: not_built(of).update(VERTICES),
            lambda: not_built(of).update_topology(TRIANGLES, VERTICES, VERTICES),
        ]
    if of is fcl_ccd.OcTree:
        calls.append(lambda: not_built(of).cells([0]))
    for call in calls:
        with pytest.raises(TypeError, match=NOT_BUILT):
            call()
    assert list(manager) == ["mesh"] and not manager.collide()


def test_other_objects_that_are_not_built():
    manager = fcl_ccd.CollisionManager()
    manager.register("mesh", MESH)
    wrong_filter, wrong_manager = not_built(fcl_ccd.Filter), not_built(fcl_ccd.CollisionManager)
    calls = [
        lambda: fcl_ccd.self_collide(MESH, filter1=wrong_filter),
        lambda: manager.set_filter("mesh", wrong_filter),
        lambda: manager.collide(wrong_manager),
        lambda: wrong_manager.register("mesh", MESH),
        lambda: wrong_manager.collide(),
        lambda: len(wrong_manager),
        lambda: bool(not_built(fcl_ccd.Result)),
        lambda: _core.self_collide(MESH, not_built(_core.Request)),
        lambda: manager._manager._set_filter(not_built(_core.ManagedObject), fcl_ccd.Filter()),
        lambda: manager._manager._update([not_built(_core.ManagedObject)], []),
        lambda: not_built(_core.Manager)._update([], []),
    ]
    for motion in MOTIONS:
        calls.append(lambda motion=motion: fcl_ccd.collide(MESH, MESH, not_built(motion)))
        calls.append(lambda motion=motion: manager.update({"mesh": not_built(motion)}))
    for call in calls:
        with pytest.raises(TypeError, match=NOT_BUILT):
            call()
    for call in (
        lambda: manager._manager._update([None], []),
        lambda: manager._manager._set_filter(None, fcl_ccd.Filter()),
        lambda: manager._manager._remove(None),
    ):
        with pytest.raises(TypeError):
            call()


def test_classes_of_the_user():
    class Early(fcl_ccd.Sphere):
        def __init__(self):
            with pytest.raises(TypeError, match=NOT_BUILT):
                fcl_ccd.collide(self, MESH)
            super().__init__(1)

    class Never(fcl_ccd.Sphere):
        def __init__(self):  # pylint: disable=super-init-not-called
            pass

    class Fails(fcl_ccd.Sphere):
        def __init__(self, kept):
            kept.append(self)
            super().__init__(-1)

    assert fcl_ccd.collide(Early(), MESH)
    with pytest.raises(TypeError, match=r"__init__\(\) must be called"):
        Never()
    kept = []
    with pytest.raises(ValueError, match="radius"):
        Fails(kept)
    with pytest.raises(TypeError, match=NOT_BUILT):
        fcl_ccd.collide(kept[0], MESH)


@pytest.mark.parametrize("of", COMPILED.values(), ids=names(COMPILED.values()))
def test_copies(of):
    found = not_built(of)
    for make in (copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match="cannot be copied or pickled"):
            make(found)
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        with pytest.raises(TypeError, match="cannot be copied or pickled"):
            pickle.dumps(found, protocol)


def test_what_cannot_be_copied():
    """test_copies.py has the rest."""
    for make in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="a CollisionManager cannot be copied or pickled"):
            make(fcl_ccd.CollisionManager())
    result = fcl_ccd.collide(MESH, MESH)
    for same in (copy.deepcopy(result), pickle.loads(pickle.dumps(result))):
        np.testing.assert_array_equal(same.contacts, result.contacts)


def test_threads_that_build_one_object():
    """One of them does. The others are told, and nothing ends the process."""
    found = not_built(fcl_ccd.RigidMesh)
    many = np.tile(TRIANGLES, (2000, 1))
    start, errors = threading.Barrier(4), []

    def build():
        start.wait()
        try:
            found.__init__(VERTICES, many)
        except TypeError as error:
            errors.append(str(error))

    threads = [threading.Thread(target=build) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(errors) <= {"another thread has called this __init__()"}
    assert found.num_triangles == len(many)
    del found
    gc.collect()


class User:
    """An object of the user with a method that a motion calls."""

    def pose(self, t):
        return np.eye(4)

    def motion(self):
        return fcl_ccd.BoundedMotion(
            self.pose, lambda t: np.zeros((4, 4)), lambda *ball: 0, lambda *span: 0
        )


def user_with_motion():
    user = User()
    user.own_motion = user.motion()
    return user


def user_with_manager():
    user = User()
    user.manager = fcl_ccd.CollisionManager()
    user.manager.register("ball", fcl_ccd.Sphere(1), user.motion())
    user.manager.update({"ball": user.motion()})
    user.manager.register(user, fcl_ccd.Sphere(1))  # also as a name
    return user


def user_with_both():
    user = user_with_motion()
    user.manager = fcl_ccd.CollisionManager()
    user.manager.register("ball", fcl_ccd.Sphere(1), user.own_motion)
    return user


class UserMesh(fcl_ccd.RigidMesh):
    pass


def mesh_with_manager():
    mesh = UserMesh(VERTICES, TRIANGLES)
    mesh.manager = fcl_ccd.CollisionManager()
    mesh.manager.register("mesh", mesh)
    return mesh


@pytest.mark.parametrize(
    "make", [user_with_motion, user_with_manager, user_with_both, mesh_with_manager]
)
def test_cycles_are_freed(make):
    kept = make()
    gc.collect()  # sees what is alive, and objects that are not built
    others = [not_built(of) for of in COMPILED.values()]
    gc.collect()
    if hasattr(kept, "manager"):
        assert kept.manager.collide() is not None
    reference = weakref.ref(kept)
    del kept, others
    gc.collect()
    assert reference() is None


def test_annotations_of_a_user_are_no_attributes_of_ours():
    class Cached(fcl_ccd.LinearMotion):
        cache: dict

    motion = Cached(np.eye(4), np.eye(4))
    assert getattr(motion, "cache", None) is None
