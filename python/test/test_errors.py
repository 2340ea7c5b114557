# SPDX-License-Identifier: BSD-3-Clause
"""Wrong inputs of each kind: the exception, and what its text says."""

import re
from pathlib import Path

import numpy as np
import pytest
from scenes import grid, pose

import fcl_ccd
from fcl_ccd import _core

VERTICES, TRIANGLES = grid(4)
NAN, INF = float("nan"), float("inf")


def changed(array, index, value):
    out = np.array(array, dtype=float if isinstance(value, float) else None)
    out[index] = value
    return out


@pytest.mark.parametrize("kind", [fcl_ccd.DeformableMesh, fcl_ccd.RigidMesh])
@pytest.mark.parametrize(
    "vertices, triangles, error, text",
    [
        (VERTICES[:, :2], TRIANGLES, ValueError, r"vertices has the shape \(16, 2\)"),
        (VERTICES.ravel(), TRIANGLES, ValueError, r"shape \(48,\). Give an array of shape \(n, 3\)"),
        (VERTICES, TRIANGLES.ravel(), ValueError, "triangles has the shape"),
        (VERTICES.astype(complex), TRIANGLES, TypeError, "vertices has elements of type complex"),
        ([["a", "b", "c"]], TRIANGLES, TypeError, "vertices has elements of type"),
        (VERTICES, TRIANGLES.astype(float), TypeError, "elements of type float64. Give integers"),
        (VERTICES, changed(TRIANGLES, (3, 1), 16), ValueError, "triangle 3 refers to vertex 16"),
        (VERTICES, changed(TRIANGLES, (3, 1), -1), ValueError, "triangle 3 refers to vertex -1"),
        (VERTICES, np.array([[0, 1, 2**63 + 1]], np.uint64), ValueError, "number 9223372036854775809"),
        (VERTICES, [[0, 1, 2**64]], ValueError, "triangles has the number 18446744073709551616"),
        (VERTICES, [[0, 1, None]], TypeError, "triangles is an array of objects, .* NoneType. Give"),
        (VERTICES, TRIANGLES.astype(float).astype(object), TypeError, "objects, with .* type float"),
        ([[10**400, 0, 0]], TRIANGLES, ValueError, "vertices has a number that is too large"),
        (VERTICES, "abc", TypeError, r"Mesh\(\): triangles is of type str. Give an array of integers"),
        ([[0, 0, 0], [1, 1]], TRIANGLES, ValueError, "vertices is no array of numbers"),
        (changed(VERTICES, (5, 2), NAN), TRIANGLES, ValueError, "vertex 5 .*is not finite"),
        (changed(VERTICES, (5, 0), INF), TRIANGLES, ValueError, "vertex 5 .*is not finite"),
        (VERTICES, np.zeros((0, 3), int), ValueError, "no triangles"),
        (np.zeros((0, 3)), np.zeros((0, 3), int), ValueError, "no triangles"),
        (None, TRIANGLES, (TypeError, ValueError), "vertices"),
    ],
)
def test_meshes(kind, vertices, triangles, error, text):
    with pytest.raises(error, match=text):
        kind(vertices, triangles)


def mesh_at_rest():
    return fcl_ccd.DeformableMesh(VERTICES, TRIANGLES)


@pytest.mark.parametrize(
    "frames, error, text",
    [
        ((VERTICES[:-1],), ValueError, "15 .*16"),
        ((VERTICES, VERTICES[:-1]), ValueError, "previous has 48 numbers instead of 45"),
        ((VERTICES[:-1], VERTICES[:-1]), ValueError, "15 .*16"),
        ((changed(VERTICES, (2, 1), NAN),), ValueError, "vertex 2 of the current frame"),
        ((changed(VERTICES, (7, 1), INF), VERTICES), ValueError, "vertex 7 of the previous frame"),
        ((), TypeError, r"update\(\): one or two frames are needed; 0 are given"),
        ((VERTICES,) * 3, TypeError, "one or two frames are needed; 3 are given"),
        ((VERTICES.astype(str),), TypeError, "current has elements of type"),
    ],
)
def test_updates_change_nothing_when_refused(frames, error, text):
    mesh = mesh_at_rest()
    mesh.update(VERTICES + 1)
    with pytest.raises(error, match=text):
        mesh.update(*frames)
    np.testing.assert_array_equal(mesh.previous, VERTICES)
    np.testing.assert_array_equal(mesh.current, VERTICES + 1)
    assert not fcl_ccd.self_collide(mesh)


@pytest.mark.parametrize(
    "triangles, previous, current, origins, text",
    [
        (TRIANGLES + 1, VERTICES, VERTICES, None, "refers to vertex 16"),
        (TRIANGLES, VERTICES[1:], VERTICES, None, "previous has 45 numbers"),
        (TRIANGLES, VERTICES, VERTICES, [1, 2], "2 origins given for 18 triangles"),
        (TRIANGLES, VERTICES, VERTICES, np.full(18, 18), "18"),
        (TRIANGLES, VERTICES, VERTICES, np.full(18, -2), "origins has the number -2, out of range"),
        (TRIANGLES, VERTICES, changed(VERTICES, 3, NAN), None, "vertex 3 of the current frame"),
    ],
)
def test_topologies(triangles, previous, current, origins, text):
    mesh = mesh_at_rest()
    with pytest.raises(ValueError, match=text):
        mesh.update_topology(triangles, previous, current, origins=origins)
    np.testing.assert_array_equal(mesh.triangles, TRIANGLES)


@pytest.mark.parametrize(
    "options, error, text",
    [
        ({"query": "most"}, ValueError, "query is 'most'. Give 'all', 'first' or 'any'"),
        ({"query": 3}, TypeError, "query"),
        ({"toc_err": -1}, ValueError, "toc_err is negative or NaN"),
        ({"toc_err": NAN}, ValueError, "toc_err is negative or NaN"),
        ({"toc_err": "small"}, TypeError, "toc_err"),
        ({"t_max": 1.5}, ValueError, "t_max is 1.5"),
        ({"t_max": NAN}, ValueError, "t_max is nan"),
        ({"min_distance": -1}, ValueError, "min_distance"),
        ({"min_distance": NAN}, ValueError, "min_distance"),
        ({"num_max_contacts": 0}, ValueError, "num_max_contacts is 0"),
        ({"num_max_contacts": -1}, ValueError, "num_max_contacts is -1"),
        ({"num_threads": -1}, ValueError, "num_threads is -1"),
        ({"num_threads": 1.5}, TypeError, "float"),
        ({"query": "any", "enable_crossings": True}, ValueError, "enable_crossings"),
        ({"accepts_triangles": 1}, TypeError, "accepts_triangles is of type int. Give a function, or None"),
        ({"filter1": {"group": 1}}, TypeError, "filter1 is of type dict"),
        ({"filter1": fcl_ccd.Filter(triangle_groups=[1])}, ValueError, "1 .*18"),
        ({"colour": 1}, TypeError, "colour"),
    ],
)
def test_requests(options, error, text):
    mesh = mesh_at_rest()
    with pytest.raises(error, match=text):
        fcl_ccd.self_collide(mesh, **options)
    with pytest.raises(error, match=text):
        fcl_ccd.collide(mesh, fcl_ccd.RigidMesh(VERTICES, TRIANGLES), **options)


@pytest.mark.parametrize(
    "options, error, text",
    [
        ({"group": 2**32}, ValueError, "group is 4294967296"),
        ({"mask": -1}, ValueError, "mask is -1"),
        ({"triangle_groups": [[1]]}, ValueError, "triangle_groups has the shape"),
        ({"triangle_masks": [-1]}, ValueError, "triangle_masks has the number -1, out of range"),
        ({"triangle_masks": [0.5]}, TypeError, "triangle_masks has elements of type float64"),
    ],
)
def test_filters(options, error, text):
    with pytest.raises(error, match=text):
        fcl_ccd.Filter(**options)


MIRROR = np.diag([1.0, 1.0, -1.0, 1.0])


@pytest.mark.parametrize(
    "make, text",
    [
        (lambda: np.eye(3), r"motion1 has the shape \(3, 3\)"),
        (lambda: np.eye(4)[None], r"motion1 has the shape \(1, 4, 4\)"),
        (lambda: 2 * np.eye(4), "the last row of a pose"),
        (lambda: np.diag([2.0, 2.0, 2.0, 1.0]), "motion1 is not a rotation and a translation.* scale"),
        (lambda: pose(angle=1) * (1.02, 1.02, 1.02, 1), "off by 0.0404.* Normalise its rotation"),
        (lambda: MIRROR, "motion1 is not a rotation and a translation: it mirrors. Mirror the vert"),
        (lambda: (np.eye(4), pose((NAN, 0, 0))), "motion1 has a number that is not finite"),
        (lambda: fcl_ccd.LinearMotion(np.eye(4), MIRROR), "a pose of LinearMotion is not"),
        (lambda: fcl_ccd.LinearMotion(np.eye(4), np.eye(4), (0, 0)), "reference has the shape"),
        (lambda: fcl_ccd.LinearMotion(np.eye(4), np.eye(4), (0, 0, INF)), "reference has a number"),
        (lambda: fcl_ccd.LinearMotion(np.eye(4), pose(angle=1), (0, 0, 1e300)), "reference point"),
        (lambda: fcl_ccd.ScrewMotion(np.eye(4), np.eye(3)), "end has the shape"),
        (lambda: fcl_ccd.SplineMotion(np.zeros((3, 3)), np.zeros((4, 3))), "translation has the"),
        (lambda: fcl_ccd.SplineMotion(np.zeros((4, 3)), np.full((4, 3), NAN)), "rotation has a"),
        (lambda: fcl_ccd.SplineMotion(np.zeros((4, 3)), np.arange(12.0).reshape(4, 3) * 1e7), r"2\^20 radians"),
    ],
)
def test_motions(make, text):
    mesh = fcl_ccd.RigidMesh(VERTICES, TRIANGLES)
    with pytest.raises(ValueError, match=text):
        fcl_ccd.collide(mesh, mesh, make())


@pytest.mark.parametrize("digits", [3, 4, 7])
def test_rotations_of_a_few_digits(digits):
    """As C++ takes them."""
    turned = np.round(pose((0.2, 0.3, 0.1), (1, 2, 3), np.pi / 4), digits)
    mesh = fcl_ccd.RigidMesh(VERTICES, TRIANGLES)
    assert fcl_ccd.collide(mesh, fcl_ccd.RigidMesh(VERTICES + (0, 0, 0.1), TRIANGLES), turned)
    with pytest.raises(ValueError, match=r"pose\(t\) is a rotation only up to .* or normalise it"):
        fcl_ccd.BoundedMotion(
            lambda t: turned,
            lambda t: np.zeros((4, 4)),
            lambda center, radius, t0, t1: 0,
            lambda t0, t1: 0,
        )


@pytest.mark.parametrize(
    "frames, eps, text",
    [
        ([], 0, "frame"),
        ([np.zeros((3, 2))], 0, "frame 0"),
        ([np.zeros((3, 3)), np.zeros((2, 3))], 0, "frames"),
        ([np.full((3, 3), np.nan)], 0, "not finite"),
        ([np.zeros((3, 3))], -1.0, "eps"),
    ],
)
def test_welding(frames, eps, text):
    with pytest.raises(ValueError, match=text):
        fcl_ccd.weld_vertices(frames, eps=eps)


def test_objects_that_are_no_meshes():
    mesh = mesh_at_rest()
    for call in (
        lambda: fcl_ccd.self_collide(VERTICES),
        lambda: fcl_ccd.collide(mesh, None),
        lambda: fcl_ccd.candidates(mesh, "mesh"),
        lambda: fcl_ccd.self_candidates(3),
    ):
        with pytest.raises(TypeError, match="Give a DeformableMesh"):
            call()


def test_candidates():
    mesh, turns = fcl_ccd.RigidMesh(VERTICES, TRIANGLES), (np.eye(4), pose(angle=1))
    for min_distance in (-0.1, INF):
        with pytest.raises(ValueError, match="min_distance"):
            fcl_ccd.candidates(mesh, mesh, None, turns, min_distance=min_distance)
        with pytest.raises(ValueError, match="min_distance"):
            fcl_ccd.collide(mesh, mesh, None, turns, min_distance=min_distance)
    with pytest.raises(ValueError, match="min_distance"):
        fcl_ccd.self_candidates(mesh, min_distance=INF)
    with pytest.raises(ValueError, match="block is -1"):
        fcl_ccd.candidates(mesh, mesh, block=-1)


@pytest.mark.parametrize("test", [fcl_ccd.vertex_face, fcl_ccd.edge_edge])
def test_feature_tests(test):
    t0 = np.arange(36.0).reshape(3, 4, 3)
    with pytest.raises(ValueError, match=r"t0 has the shape \(36,\). Give .* \(n, 4, 3\)"):
        test(t0.ravel(), t0)
    with pytest.raises(ValueError, match="t0 has 3 queries and t1 has 2"):
        test(t0, t0[:2])
    with pytest.raises(ValueError, match="query 2: (f0|ea1)_t1 is not finite"):
        test(t0, changed(t0, (2, 1, 0), NAN))
    with pytest.raises(ValueError, match="toc_err is negative"):
        test(t0, t0, toc_err=-1)
    with pytest.raises(TypeError, match="t1 has elements of type"):
        test(t0, t0.astype(complex))
    with pytest.raises(ValueError, match="min_distance"):
        test(t0, t0, min_distance=NAN)
    assert test(t0[:0], t0[:0]).shape == (0,)


SOURCE = Path(__file__).resolve().parent.parent.parent
FOLDERS = (
    *("src/" + name for name in "elementary mesh tree paths shapes bodies curved model prepare api".split()),
    "include/fcl",
)
NAMES_OF_CPP = r"::|\b[a-z]+[A-Z]\w*|\bk[A-Z]\w+|BVH|CCDM|request\.|Continuous[A-Z]|\bmodel\b"
# What the package never does: a mesh is built and updated in one call, in double, without
# FCL's tree; it has FCL's motions or a BoundedMotion; a null pointer is None.
NOT_REACHED = (
    r"[a-z]\w*\.*Model\(|[aA]ddSub|updateFclTree|FclTree|between begin|null|ccd_motion_type|In float|"
    r"none of FCL's|motion class|one of FCL's motions|base class|safe\w*Displacements|traversal can|"
    r"models of the same BV|the other manager|[vV]ertices given for|refitTopDown|distance query|without parts"
)


def texts_of_the_library():
    """The strings of each statement that makes an exception, joined."""
    statement = r"(?:throw Exception|refuse|require\w*|checked\w*)\s*\(((?:[^;\"]|\"(?:[^\"\\]|\\.)*\")*);"
    for folder in FOLDERS:
        for path in sorted((SOURCE / folder).rglob("*.[ch]*")):
            for found in re.finditer(statement, path.read_text(encoding="utf-8")):
                parts = re.sub(r'"\s*"', "", found[1])
                text = " ".join(re.findall(r'"((?:[^"\\]|\\.)*)"', parts))
                if text:
                    yield f"{path.name}: {text}"


def test_names_of_python():
    """No text that can reach a user of the package has names that only C++ has."""
    texts = list(texts_of_the_library())
    assert len(texts) > 80
    for text in texts:
        if not re.search(NOT_REACHED, text):
            name, words = text.split(": ", 1)
            assert not re.search(NAMES_OF_CPP, _core._in_python(words)), (name, words)


def test_words_of_python():
    mesh = mesh_at_rest()
    for call, text in (
        (lambda: fcl_ccd.DeformableMesh(VERTICES, None), "the mesh has no triangles. Give some, or free"),
        (lambda: fcl_ccd.self_collide(mesh, num_max_contacts=0), "^num_max_contacts is 0.*query='any'$"),
        (
            lambda: fcl_ccd.self_collide(mesh, query="any", enable_crossings=True),
            "^enable_crossings lists all crossings, which query='any' does not .* use 'first' or 'all'",
        ),
        (
            lambda: fcl_ccd.self_collide(mesh, ignore_initially_closer=True),
            "^ignore_initially_closer is about pairs that are nearer than min_distance, which is 0",
        ),
        (
            lambda: fcl_ccd.collide(mesh, fcl_ccd.Box(1, 1, 1), min_approach_speed=0.1),
            "^min_approach_speed acts on meshes on straight paths only. One of these two is a shape",
        ),
        (lambda: fcl_ccd.weld_vertices([]), r"^weld_vertices\(\): there is no frame"),
        (
            lambda: fcl_ccd.OcTree(VERTICES, 0.1).cells([-1]),
            r"^cells\(\): a number is not the number of a cell. Give b1 or b2 of a contact",
        ),
        (
            lambda: fcl_ccd.collide(
                mesh, mesh, fcl_ccd.LinearMotion(np.eye(4), pose(angle=1), (0, 0, 1e300))
            ),
            "reference point of the LinearMotion is far too large. Give a point near the object",
        ),
    ):
        with pytest.raises(ValueError, match=text):
            call()


def test_exceptions_of_callbacks_reach_the_caller():
    vertices = np.concatenate([VERTICES, VERTICES + (0.1, 0.1, 1e-3)])
    two = np.concatenate([TRIANGLES, TRIANGLES + 16])
    mesh = fcl_ccd.DeformableMesh(vertices, two)
    mesh.update(vertices - np.repeat([[0.0], [0.5]], 16, axis=0) * (0, 0, 1))
    calls = []

    def fails(b1, b2):
        calls.append((b1, b2))
        raise KeyError("my error")

    for num_threads in (1, 2):
        calls.clear()
        with pytest.raises(KeyError, match="my error"):
            fcl_ccd.self_collide(mesh, accepts_triangles=fails, num_threads=num_threads)
        assert 1 <= len(calls) <= 2
    with pytest.raises(KeyError, match="my error"):
        fcl_ccd.self_candidates(mesh, lambda block: fails(0, 0))
    with pytest.raises(TypeError):
        fcl_ccd.self_collide(mesh, accepts_triangles=lambda: True)
    assert fcl_ccd.self_collide(mesh)  # it still answers
