# SPDX-License-Identifier: BSD-3-Clause
"""Threads of the library, threads of Python, and their meeting at one mesh."""

import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scenes import crumpled, pose, sphere

import fcl_ccd

PREVIOUS, CURRENT, TRIANGLES = crumpled(30)


def cloth():
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    mesh.update(CURRENT)
    return mesh


def require_equal(contacts, expected):
    for name in fcl_ccd.contact_dtype.names:
        np.testing.assert_array_equal(contacts[name], expected[name])


@pytest.mark.parametrize("num_threads", [0, 2, 3])
def test_answer_does_not_depend_on_threads(num_threads):
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES, num_threads=num_threads)
    mesh.update(CURRENT)
    for options in ({}, {"query": "first"}, {"accepts_triangles": lambda a, b: (a + b) % 2}):
        require_equal(
            fcl_ccd.self_collide(mesh, num_threads=num_threads, **options).contacts,
            fcl_ccd.self_collide(cloth(), **options).contacts,
        )


def test_queries_of_one_mesh_side_by_side():
    mesh, ball = cloth(), fcl_ccd.RigidMesh(*sphere(8, 12, 0.4))
    moves = [(pose((0.5, 0.5, 1 + 0.1 * i)), pose((0.5, 0.5, -1))) for i in range(8)]
    expected = [fcl_ccd.collide(mesh, ball, None, move).contacts for move in moves]
    with ThreadPoolExecutor(4) as pool:
        jobs = [
            pool.submit(fcl_ccd.collide, mesh, ball, None, move, num_threads=1 + i % 2)
            for i, move in enumerate(moves * 4)
        ]
        for job, contacts in zip(jobs, expected * 4):
            require_equal(job.result().contacts, contacts)


LARGE = crumpled(300)
QUERIES = np.random.default_rng(1).normal(size=(2, 600000, 4, 3))


def large_cloth():
    mesh = fcl_ccd.DeformableMesh(LARGE[0], LARGE[2])
    mesh.update(LARGE[1])
    return mesh


@pytest.mark.parametrize(
    "name, call",
    [
        ("self_collide", lambda mesh: fcl_ccd.self_collide(mesh)),
        ("collide", lambda mesh: fcl_ccd.collide(mesh, mesh, pose((0.1, 0.1, 0.1)))),
        ("self_candidates", lambda mesh: fcl_ccd.self_candidates(mesh)),
        ("vertex_face", lambda mesh: fcl_ccd.vertex_face(*QUERIES)),
        ("edge_edge", lambda mesh: fcl_ccd.edge_edge(*QUERIES)),
    ],
)
def test_other_threads_run_during_a_query(name, call):
    """A thread that reads the clock does so in the middle of the query."""
    mesh, times, done = large_cloth(), [], threading.Event()

    def read_clock():
        while not done.is_set():
            times.append(time.monotonic())
            time.sleep(0)

    thread = threading.Thread(target=read_clock)
    thread.start()
    try:
        begin = time.monotonic()
        call(mesh)
        end = time.monotonic()
    finally:
        done.set()
        thread.join()
    assert end - begin > 0.02  # long enough to tell
    middle = [t for t in times if 0.3 < (t - begin) / (end - begin) < 0.7]
    assert len(middle) > 5, name


def test_update_during_a_query_is_refused():
    mesh = cloth()
    messages = []

    def updates(b1, b2):
        if not messages:
            for change in (
                lambda: mesh.update(CURRENT),
                lambda: mesh.update_topology(TRIANGLES, PREVIOUS, CURRENT),
            ):
                with pytest.raises(RuntimeError, match="has not ended") as error:
                    change()
                messages.append(str(error.value))
            np.testing.assert_array_equal(mesh.current, CURRENT)  # reading is allowed
            assert fcl_ccd.self_collide(mesh).is_collide  # a query in a query as well
        return True

    expected = fcl_ccd.self_collide(mesh).contacts
    require_equal(fcl_ccd.self_collide(mesh, accepts_triangles=updates).contacts, expected)
    assert len(messages) == 2
    mesh.update(PREVIOUS)  # now it is free


def test_updates_and_queries_race_safely():
    """Each call of two threads ends in an answer that is right or in a RuntimeError."""
    mesh, expected = cloth(), fcl_ccd.self_collide(cloth()).contacts
    stop, errors, answers = threading.Event(), [0], [0]

    def update():
        while not stop.is_set():
            try:
                mesh.update(PREVIOUS, CURRENT)
            except RuntimeError:
                errors[0] += 1

    thread = threading.Thread(target=update)
    thread.start()
    try:
        end = time.monotonic() + 1
        while time.monotonic() < end:
            try:
                require_equal(fcl_ccd.self_collide(mesh).contacts, expected)
                answers[0] += 1
            except RuntimeError:
                errors[0] += 1
    finally:
        stop.set()
        thread.join()
    assert errors[0] > 0
