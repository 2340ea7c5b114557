# SPDX-License-Identifier: BSD-3-Clause
"""CollisionManager: its pairs are those of collide() for each pair, to the bit."""

import gc
import itertools
import threading
import weakref

import numpy as np
import pytest
from scenes import crumpled, grid, pose, sphere

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(8)
BALL = fcl_ccd.RigidMesh(*sphere(6, 7, 0.5))
DOWN = pose((0, 0, 2)), pose((0, 0, -2))


def random_pose(random):
    return pose(random.uniform(-2, 2, 3), random.normal(size=3), random.uniform(0, 2))


def random_motion(random, may_turn):
    begin, end = random_pose(random), random_pose(random)
    kind = random.integers(5)
    if kind == 0:
        return begin
    if kind == 1:
        return fcl_ccd.ScrewMotion(begin, end)
    if kind == 2:
        return fcl_ccd.LinearMotion(begin, end, random.normal(size=3))
    if kind == 3:
        return fcl_ccd.SplineMotion(random.normal(size=(4, 3)), random.normal(size=(4, 3)))
    if not may_turn:
        end[:3, :3] = begin[:3, :3]
    return begin, end


def scene(seed, count=30):
    """Names, geometries and motions: meshes that many objects share, shapes, a cloth."""
    random = np.random.default_rng(seed)
    cloth = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    cloth.update(CURRENT)
    geometries = [BALL, fcl_ccd.Box(0.5, 0.6, 0.7), fcl_ccd.Sphere(0.3), cloth]
    geometries.append(fcl_ccd.Halfspace((0, 0, 1), -2))
    objects = {}
    for i in range(count):
        o = geometries[min(random.integers(0, 30) % 8, 3)] if i > 0 else geometries[4]
        objects[f"object {i}"] = o, random_motion(random, o is not cloth)
    return objects


def managed(objects, **options):
    manager = fcl_ccd.CollisionManager()
    for name, (o, motion) in objects.items():
        manager.register(name, o, motion, **options)
    return manager


def answers_of(pairs, **options):
    """The answers of collide() for pairs of (name, geometry, motion) that are in contact."""
    found = {}
    for (name1, o1, motion1), (name2, o2, motion2) in pairs:
        result = fcl_ccd.collide(o1, o2, motion1, motion2, **options)
        if result:
            found[name1, name2] = result
    return found


def require_same_answers(result, expected):
    assert bool(result) == result.is_collide == bool(expected)
    assert {(pair.o1, pair.o2) for pair in result.pairs} == set(expected)
    times = [pair.result.time_of_contact for pair in result.pairs]
    assert times == sorted(times) and result.time_of_contact == min(times, default=1)
    for pair in result.pairs:
        wanted = expected[pair.o1, pair.o2]
        assert pair.result.time_of_contact == wanted.time_of_contact
        for name in fcl_ccd.contact_dtype.names:
            np.testing.assert_array_equal(pair.result.contacts[name], wanted.contacts[name])
        np.testing.assert_array_equal(pair.result.contact_tf1, wanted.contact_tf1)
        np.testing.assert_array_equal(pair.result.contact_tf2, wanted.contact_tf2)
    assert len(result.pairs) <= result.num_tested <= result.num_box_pairs


def listed(objects):
    return [(name, *o) for name, o in objects.items()]


@pytest.mark.parametrize("seed", [1, 2])
def test_all_pairs(seed):
    objects = scene(seed)
    manager = managed(objects)
    for options in ({}, {"t_max": 0.3, "num_threads": 2}):
        expected = answers_of(itertools.combinations(listed(objects), 2), **options)
        # The order of the two is that of registration.
        require_same_answers(manager.collide(**options), expected)
        assert len(expected) > 20
    assert len(manager) == len(list(manager)) == 30 and "object 3" in manager


def test_first_and_any():
    objects = scene(3)
    del objects["object 0"]  # the floor: many objects begin in it
    manager = managed(objects)
    everything = manager.collide()
    first, any_pair = manager.collide(query="first"), manager.collide(query="any")
    assert len(first.pairs) == len(any_pair.pairs) == 1
    assert abs(first.time_of_contact - everything.time_of_contact) <= 1e-4
    pair = any_pair.pairs[0]
    assert (pair.o1, pair.o2) in {(p.o1, p.o2) for p in everything.pairs}
    assert first.num_tested <= everything.num_tested


def test_updates():
    """Steps with new motions, objects that come and go, and a cloth with new frames."""
    objects, later = scene(4), scene(5)
    manager = managed(objects)
    cloth = next(o for o, _ in objects.values() if isinstance(o, fcl_ccd.DeformableMesh))
    names = [name for name, (o, _) in objects.items() if o is cloth]
    for step in range(3):
        manager.unregister(f"object {step + 1}")
        del objects[f"object {step + 1}"]
        motions = {
            name: later[name][1]
            for i, name in enumerate(objects)
            if i % 3 == step and objects[name][0] is not cloth
        }
        manager.update(motions)
        for name, motion in motions.items():
            objects[name] = objects[name][0], motion
        cloth.update(CURRENT + 0.1 * step)
        with pytest.raises(RuntimeError, match="the mesh of object 'object .*Call the manager's"):
            manager.collide()
        manager.update([name for name in names if name in objects] if step else None)
        expected = answers_of(itertools.combinations(listed(objects), 2))
        require_same_answers(manager.collide(), expected)
    assert list(manager) == list(objects)


def test_one_object_and_another_manager():
    objects, others = scene(6), scene(7, 10)
    manager, other = managed(objects), managed(others)
    one = [("object 5", *objects["object 5"])]
    rest = [o for o in listed(objects) if o[0] != "object 5"]
    require_same_answers(manager.collide(name="object 5"), answers_of(itertools.product(one, rest)))
    ball, motion = fcl_ccd.Sphere(0.7), DOWN
    expected = answers_of(itertools.product([(None, ball, motion)], listed(objects)))
    require_same_answers(manager.collide(ball, motion), expected)
    expected = answers_of(itertools.product(listed(objects), listed(others)))
    require_same_answers(manager.collide(other), expected)
    assert len(expected) > 10


def test_filters_and_self_collision():
    cloth = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    cloth.update(CURRENT)
    manager = fcl_ccd.CollisionManager()
    manager.register("cloth", cloth, self_collision=True)
    manager.register(7, BALL, DOWN, filter=fcl_ccd.Filter(group=2))
    names = {(pair.o1, pair.o2) for pair in manager.collide().pairs}
    assert names == {("cloth", "cloth"), ("cloth", 7)}
    own = next(pair for pair in manager.collide().pairs if pair.o2 == "cloth")
    assert len(own.result.contacts) == len(fcl_ccd.self_collide(cloth).contacts) > 0
    manager.set_self_collision("cloth", False)
    manager.set_filter("cloth", fcl_ccd.Filter(mask=1))
    assert not manager.collide()
    manager.set_filter("cloth", None)
    assert [(pair.o1, pair.o2) for pair in manager.collide().pairs] == [("cloth", 7)]
    assert not manager.collide(accepts_triangles=lambda b1, b2: False)
    with pytest.raises(KeyError):
        manager.collide(accepts_triangles=lambda b1, b2: {}[b1])


def test_formation():
    """Objects whose sweeps overlap but that are never near each other are no box pairs."""
    manager = fcl_ccd.CollisionManager()
    for i in range(10):
        manager.register(i, fcl_ccd.Sphere(0.4), (pose((i, 0, 0)), pose((i + 20, 0, 0))))
    result = manager.collide()
    assert not result and result.num_box_pairs == 0 and result.time_of_contact == 1


def test_wrong_calls_change_nothing():
    manager = fcl_ccd.CollisionManager()
    manager.register("ball", BALL, DOWN)
    manager.register("box", fcl_ccd.Box(1, 1, 1))
    cloth = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    manager.register("cloth", cloth)
    before = manager.collide()
    far, place = pose((1.7e308,) * 3), pose((9, 9, 9))
    turn = pose(), pose(angle=1)
    for call, error, text in (
        (lambda: manager.register("ball", BALL), ValueError, "'ball' is registered"),
        (lambda: manager.register("x", PREVIOUS), TypeError, "o is of type ndarray"),
        (lambda: manager.register("x", cloth, turn), ValueError, "give a LinearMotion"),
        (lambda: manager.register("x", BALL, filter=3), TypeError, "filter is of type int"),
        (lambda: manager.register([], BALL), TypeError, "name is of type list. Give a name"),
        (lambda: manager.register("x", fcl_ccd.Sphere(1), self_collision=True), ValueError, "mesh"),
        (lambda: manager.register(None, BALL), ValueError, "name is None"),
        (lambda: manager.register("x", fcl_ccd.Sphere(1e308), far), ValueError, "not finite"),
        (lambda: manager.unregister("x"), ValueError, "'x' is not registered"),
        (lambda: manager.update({"ball": place, "x": None}), ValueError, "'x' is not registered"),
        (lambda: manager.update({"ball": np.eye(3)}), ValueError, "motion of 'ball' has the shape"),
        (lambda: manager.update({"ball": place, "cloth": turn}), ValueError, "Linear"),
        (lambda: manager.update({"ball": place, "box": far}), ValueError, "not finite"),
        (lambda: manager.set_self_collision("box", True), ValueError, "not a triangle mesh"),
        (lambda: manager.set_thickness("box", -1), ValueError, "thickness is negative"),
        (lambda: manager.set_thickness("x", 1), ValueError, "'x' is not registered"),
        (lambda: manager.set_thickness("box", "1"), TypeError, "thickness"),
        (lambda: manager.set_pair_distance("box", "ball", np.inf), ValueError, "a finite number"),
        (lambda: manager.register("x", BALL, place, thickness=-1), ValueError, "thickness is negative"),
        (lambda: manager.step({"box": np.eye(3)}), ValueError, "pose of 'box' has the shape"),
        (lambda: manager.step({"x": np.eye(4)}), ValueError, "'x' is not registered"),
        (lambda: manager.step(["box"]), TypeError, "poses is of type list"),
        (lambda: manager.set_filter("ball", 3), TypeError, "filter is of type int"),
        (lambda: manager.collide(BALL, name="ball"), ValueError, "name and other are given"),
        (lambda: manager.collide(motion=DOWN), ValueError, "motion is for a mesh"),
        (lambda: manager.collide(3), TypeError, "other is of type int"),
        (lambda: manager.collide(t_max=2), ValueError, "t_max"),
        (lambda: manager.collide(toc_err=-1), ValueError, "toc_err"),
    ):
        with pytest.raises(error, match=text):
            call()
        after = manager.collide()
        assert list(manager) == ["ball", "box", "cloth"]
        assert [(p.o1, p.o2) for p in after.pairs] == [(p.o1, p.o2) for p in before.pairs]
        assert after.time_of_contact == before.time_of_contact


def test_objects_step_from_where_they_are():
    manager = fcl_ccd.CollisionManager()
    manager.register("ball", fcl_ccd.Sphere(1), pose((4, 0, 0)))
    manager.register("box", fcl_ccd.Box(2, 2, 2))
    assert not manager.collide()
    manager.step({"ball": pose((0, 0, 0))})
    assert manager.collide().time_of_contact == pytest.approx(0.5, abs=1e-4)
    manager.step({"ball": pose((0, 4, 0)), "box": pose((0, 0, 0))})
    assert manager.collide().time_of_contact == 0
    manager.step({"ball": pose((4, 4, 0))})
    assert not manager.collide()


def test_thickness_is_added_to_the_distance():
    manager = fcl_ccd.CollisionManager()
    manager.register("ball", fcl_ccd.Sphere(1), pose((3, 0, 0)), thickness=0.6)
    manager.register("other", fcl_ccd.Sphere(1))
    assert not manager.collide()
    manager.set_thickness("other", 0.5)
    assert manager.collide() and manager.collide(min_distance=1)
    assert manager.distance().result.distance_lo == pytest.approx(1, rel=1e-2)
    manager.set_pair_distance("other", "ball", 0.9)
    assert not manager.collide() and manager.collide(min_distance=0.2)
    manager.set_pair_distance("ball", "other", None)
    assert manager.collide()
    manager.set_thickness("ball", 0)
    assert not manager.collide()


def test_approach_speed_of_an_object():
    floor = fcl_ccd.RigidMesh(*grid(4))
    manager = fcl_ccd.CollisionManager()
    manager.register("floor", floor)
    manager.register("slides", floor, (pose((0, 0, 0)), pose((0.1, 0, 0))))
    manager.register("falls", floor, (pose((0, 0, 1)), pose((0, 0, -1))))
    assert len(manager.collide().pairs) == 3
    manager.set_min_approach_speed("floor", 1e-3)
    found = {(p.o1, p.o2) for p in manager.collide().pairs}
    assert found == {("floor", "falls"), ("slides", "falls")}
    manager.set_min_approach_speed("floor", 0)
    assert len(manager.collide().pairs) == 3
    with pytest.raises(ValueError, match="speed is negative or not finite"):
        manager.set_min_approach_speed("floor", -1)


def test_groups_are_a_table():
    groups = fcl_ccd.Groups()
    random = np.random.default_rng(2)
    table = np.ones((32, 32), bool)
    for a, b, can in random.integers(0, (32, 32, 2), (400, 3)):
        groups.set(a, b, bool(can))
        table[a, b] = table[b, a] = can
    filters = [groups.filter_of(g) for g in range(32)]
    for a, b in itertools.product(range(32), range(32)):
        meet = filters[a].group & filters[b].mask and filters[b].group & filters[a].mask
        assert groups.can_meet(a, b) == table[a, b] == bool(meet)
    with pytest.raises(ValueError, match="group"):
        groups.filter_of(32)


def name_of(pair, contact):
    """What makes a contact the same in the next step, without the package's keys."""
    kind, ids = fcl_ccd.Kind(contact["kind"]), [int(i) for i in contact["vertices"]]
    if kind >= fcl_ccd.Kind.VERTEX_SHAPE:
        return "shape", int(contact["b1"]), int(contact["b2"])
    if kind == fcl_ccd.Kind.EDGE_EDGE:
        edges = [tuple(sorted(ids[:2])), tuple(sorted(ids[2:4]))]
        return kind, *(sorted(edges) if pair.o1 == "cloth" == pair.o2 else edges)
    side = bool(contact["first_on_o1"])
    if kind == fcl_ccd.Kind.CROSSING:
        return kind, side, tuple(sorted(ids[:2])), tuple(sorted(ids[2:]))
    return kind, side, ids[0], tuple(sorted(ids[1:]))


def test_persistent_pairs_of_random_steps():
    random = np.random.default_rng(6)
    shapes = fcl_ccd.Sphere(0.5), fcl_ccd.Box(0.8, 0.8, 0.8), BALL
    manager = fcl_ccd.CollisionManager()
    cloth = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    manager.register("cloth", cloth, self_collision=True)
    for i in range(12):
        manager.register(i, shapes[i % 3], pose(random.uniform(-1, 1, 3)))
    tracked = fcl_ccd.PersistentPairs()
    before, ids, same, new, gone = {}, set(), 0, 0, 0
    for step in range(12):
        cloth.update(CURRENT if step % 2 == 0 else PREVIOUS)
        poses = {i: pose(random.uniform(-1, 1, 3)) for i in random.choice(12, 3, False)}
        manager.update(["cloth"])
        manager.step({int(i): p for i, p in poses.items()})
        result = manager.collide()
        tracked.update(result)
        now = {}
        assert len(tracked.pairs) == len(result.pairs)
        for pair, found in zip(tracked.pairs, result.pairs):
            key = found.o1, found.o2
            assert (pair.o1, pair.o2) == key
            old = before.get(key)
            assert pair.is_new == (old is None)
            names = [name_of(found, c) for c in found.result.contacts]
            assert len(set(names)) == len(names)
            if old is None:
                assert pair.id not in ids and pair.data is None
                ids.add(pair.id)
                pair.data = pair.id
                expected = [-1] * len(names)
            else:
                assert (pair.id, pair.num_steps) == (old[0], old[1] + 1)
                assert pair.data == pair.id
                expected = [old[2].get(name, -1) for name in names]
            assert pair.previous.tolist() == expected
            same += sum(place >= 0 for place in expected)
            new += sum(place < 0 for place in expected)
            now[key] = pair.id, pair.num_steps, {name: i for i, name in enumerate(names)}
        assert {(p.o1, p.o2) for p in tracked.removed} == set(before) - set(now)
        gone += len(tracked.removed)
        before = now
    assert same > 20 and new > 20 and gone > 5
    assert "removed" in repr(tracked)
    tracked.clear()
    tracked.update(result)
    assert all(pair.is_new for pair in tracked.pairs) and not tracked.removed


def test_persistent_pairs_of_two_managers_with_the_same_names():
    first, second = fcl_ccd.CollisionManager(), fcl_ccd.CollisionManager()
    first.register(0, BALL)
    second.register(0, BALL, (pose((0.3, 0, 0)), pose((0.3, 0.02, 0))))
    tracked = fcl_ccd.PersistentPairs()
    before = first.collide(second)
    tracked.update(before)
    second.update({0: (pose((-0.3, 0, 0)), pose((-0.3, 0.02, 0)))})
    after = first.collide(second)
    tracked.update(after)
    names = [name_of(before.pairs[0], c) for c in before.pairs[0].result.contacts]
    expected = [
        names.index(name) if name in names else -1
        for name in (name_of(after.pairs[0], c) for c in after.pairs[0].result.contacts)
    ]
    assert tracked.pairs[0].previous.tolist() == expected
    twice = fcl_ccd.CollisionManager()
    for name in range(2):
        twice.register(name, BALL)
    result = twice.collide(BALL)
    tracked.update(result)
    result.pairs.append(result.pairs[0])
    with pytest.raises(ValueError, match="twice in the result"):
        tracked.update(result)


def test_changes_during_a_query_are_refused():
    manager = fcl_ccd.CollisionManager()
    manager.register("ball", BALL, DOWN)
    mesh = fcl_ccd.DeformableMesh(*grid(4))
    manager.register("mesh", mesh, pose((-0.5, -0.5, 0)))
    calls = (
        lambda: manager.update(),
        lambda: manager.unregister("ball"),
        lambda: manager.register("x", BALL),
        lambda: mesh.update(grid(4)[0]),
    )
    refused = []

    def interferes(b1, b2):
        if not refused:
            for call in calls:
                with pytest.raises(RuntimeError, match="has not ended"):
                    call()
                refused.append(call)
        return True

    assert manager.collide(accepts_triangles=interferes) and len(refused) == 4
    assert manager.collide(name="ball")


def test_threads_query_one_manager():
    manager = managed(scene(8, 12))
    expected = [(pair.o1, pair.o2) for pair in manager.collide().pairs]
    found = []

    def work():
        found.append([(pair.o1, pair.o2) for pair in manager.collide().pairs])

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected] * 4


def test_lifetimes():
    """A manager keeps its meshes alive, and no longer than it needs them. So do results."""
    mesh = fcl_ccd.RigidMesh(*sphere(4, 5))
    alive = weakref.ref(mesh)
    manager = fcl_ccd.CollisionManager()
    manager.register("mesh", mesh)
    manager.register("other", mesh, DOWN)
    del mesh
    gc.collect()
    assert alive() is not None and manager.collide()
    manager.unregister("mesh")
    assert alive() is not None
    result = manager.collide(alive())
    del manager
    gc.collect()
    assert alive() is not None and result.pairs[0].o2 == "other"
    del result
    gc.collect()
    assert alive() is None


def test_the_least_distance_is_that_of_all_pairs():
    apart = 0
    for seed in range(40):
        objects = scene(seed, 2 + seed % 5)
        manager = managed(objects)
        pairs = []
        for name1, name2 in itertools.combinations(objects, 2):
            (o1, motion1), (o2, motion2) = objects[name1], objects[name2]
            pairs.append((name1, name2, fcl_ccd.distance(o1, o2, motion1, motion2)))
        nearest = manager.distance()
        least = min(pairs, key=lambda pair: pair[2].distance_hi)[2]
        assert nearest.result.is_collide == least.is_collide
        assert nearest.result.distance_lo <= least.distance_hi
        assert nearest.result.distance_hi >= min(p[2].distance_lo for p in pairs)
        own = [p[2] for p in pairs if p[:2] == (nearest.o1, nearest.o2)][0]
        assert own.distance_lo <= nearest.result.distance_hi
        apart += not least.is_collide
    assert 5 <= apart < 35


def test_distance_of_one_object_and_of_what_is_not_registered():
    manager = fcl_ccd.CollisionManager()
    for x in range(3):
        manager.register(x, fcl_ccd.Sphere(1), pose((4 * x * x, 0, 0)))
    nearest = manager.distance(rel_err=1e-6)
    assert {nearest.o1, nearest.o2} == {0, 1} and nearest.num_tested >= 1
    assert abs(nearest.result.distance_hi - 2) < 1e-5
    assert manager.distance(name=2).o2 == 1
    ball = manager.distance(fcl_ccd.Sphere(1), (pose((30, 0, 0)), pose((19, 0, 0))))
    assert ball.o1 is None and ball.o2 == 2 and ball.result.time == 1
    assert abs(ball.result.distance_hi - 1) < 1e-2
    other = fcl_ccd.CollisionManager()
    other.register("far", fcl_ccd.Sphere(1), pose((-9, 0, 0)))
    assert manager.distance(other).o2 == "far"
    cut = manager.distance(max_distance=1)
    assert cut.result.is_cut_off and cut.result.distance_lo == 1
    nothing = fcl_ccd.CollisionManager().distance()
    assert nothing.o1 is None and nothing.result.distance_lo == np.inf
    with pytest.raises(ValueError, match="max_distance"):
        manager.distance(max_distance=0)
