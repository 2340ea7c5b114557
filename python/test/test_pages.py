# SPDX-License-Identifier: BSD-3-Clause
"""Result.show() as a page: what it has, where it is opened, and how a browser draws it."""

import base64
import html
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scenes import crumpled, pose, require, sphere

import fcl_ccd
from fcl_ccd import _pages, _pictures, _results, _surfaces

sys.path.append(str(Path(__file__).resolve().parents[2] / "test" / "report_page"))
BALL = sphere(6, 7, 0.3)
FALLS = pose((0.5, 0.5, 1)), pose((0.4, 0.5, -1), (1, 2, 3), 1.1)
PREVIOUS, CURRENT, TRIANGLES = crumpled(9)
ENDS = np.array([(-1, 0, 0), (1, 0, 0), (0, -1, 1), (0, 1, 1)], float)
WITHOUT_MATPLOTLIB = "import sys; sys.modules['matplotlib'] = None\n"


@pytest.fixture(name="viewer")
def is_built_with_viewer():
    if not _pages.has_viewer():
        pytest.skip("the package was built without its 3D view, which needs npm")


def crumpling():
    mesh = fcl_ccd.DeformableMesh(PREVIOUS, TRIANGLES)
    mesh.update(CURRENT)
    return mesh


def cables():
    edges = (0, 1), (2, 3)
    first, second = (fcl_ccd.DeformableMesh(ENDS, None, edges=[edge]) for edge in edges)
    return fcl_ccd.collide(first, second, None, (pose(), pose((0, 0, -1))), min_distance=0.1)


def clouds():
    first, second = (fcl_ccd.DeformableMesh(ENDS * (0, 1, 1), None, points=[i]) for i in (1, 3))
    return fcl_ccd.collide(first, second, None, (pose(), pose((0, -1, -1))), min_distance=0.1)


SCENES = {
    "meshes": lambda: fcl_ccd.collide(crumpling(), fcl_ccd.RigidMesh(*BALL), None, FALLS),
    "itself": lambda: fcl_ccd.self_collide(crumpling()),
    "box": lambda: fcl_ccd.collide(crumpling(), fcl_ccd.Box(0.3, 0.3, 0.3), None, FALLS),
    "round": lambda: fcl_ccd.collide(crumpling(), fcl_ccd.Capsule(0.3, 0.8), None, FALLS),
    "plane": lambda: fcl_ccd.collide(fcl_ccd.Halfspace((0, 0, 1), 0), fcl_ccd.RigidMesh(*BALL), None, FALLS),
    "octree": lambda: fcl_ccd.collide(crumpling(), fcl_ccd.OcTree(BALL[0], 0.1), None, FALLS),
    "cables": cables,
    "clouds": clouds,
    "far": lambda: fcl_ccd.collide(
        fcl_ccd.RigidMesh(BALL[0] + 1e9, BALL[1]), fcl_ccd.Sphere(0.1), None, (pose((1e9 - 1,) * 3), pose((1e9,) * 3))
    ),
    "apart": lambda: fcl_ccd.collide(crumpling(), fcl_ccd.RigidMesh(*BALL), None, pose((9, 9, 9))),
}


@pytest.fixture(name="scene", params=SCENES.values(), ids=SCENES.keys())
def one_scene(request):
    return request.param()


def data_of(page):
    (text,) = re.findall(r'<script type="application/json" id="picture">(.*?)</script>', page, re.DOTALL)
    return json.loads(text)


def numbers(text, dtype):
    return np.frombuffer(base64.b64decode(text), dtype)


def corners_of(group, count):
    """Of each triangle, segment or point, from the centre of the view in units of its half."""
    return numbers(group["positions"], "<f4").reshape(-1, count, 3)


def fans(polygons):
    found = [(p[0], p[i], p[i + 1]) for i in range(1, polygons.shape[1] - 1) for p in polygons]
    return np.array(found).reshape(-1, 3, 3)


@pytest.mark.parametrize("contact", [0, None], ids=["near", "whole"])
def test_places_are_those_of_the_picture(scene, contact, tmp_path, viewer):
    picture = _results._picture(scene, None, contact)
    scene.show(contact=contact, file=tmp_path / "contact.html")
    data = data_of((tmp_path / "contact.html").read_text(encoding="utf-8"))
    assert data["title"] == picture.title
    assert data["names"] == [name for name, _, _ in picture.objects]
    for name, count in (("triangles", 3), ("segments", 2), ("points", 1)):
        corners, touched = corners_of(data[name], count), numbers(data[name]["touched"], np.uint8)
        is_first = np.arange(len(touched)) < data[name]["of_first"]
        for i, (_, *both) in enumerate(picture.objects):
            for is_part, pieces in enumerate(both):
                drawn = corners[(touched == is_part) & (is_first == (i == 0))]
                expected = {"triangles": fans(pieces.polygons), "segments": pieces.segments,
                            "points": pieces.points[:, None]}[name]  # fmt: skip
                expected = (expected - picture.view.center) / picture.view.half
                np.testing.assert_allclose(drawn, expected, rtol=1e-6, atol=1e-7)
    assert len(data["contacts"]) == len(picture.places)
    for drawn, place, normal, is_main in zip(data["contacts"], *picture[3:]):
        assert drawn["position"] == place.tolist() and drawn["normal"] == normal.tolist()
        assert drawn["is_main"] == is_main


def test_no_edges_inside_of_polygons(tmp_path, viewer):
    """A box has twelve, a round shape has none, a triangle three."""
    lines = {}
    for name in ("box", "round"):
        picture = _results._picture(SCENES[name](), None, 0)
        _pages.write(picture, tmp_path / "contact.html")
        triangles = data_of((tmp_path / "contact.html").read_text(encoding="utf-8"))["triangles"]
        sides = numbers(triangles["sides"], np.uint8)
        assert (sides[: triangles["of_first"]] == 7).all()
        corners = corners_of(triangles, 3)[triangles["of_first"] :]
        lines[name] = {
            frozenset((tuple(corner[k].tolist()), tuple(corner[(k + 1) % 3].tolist())))
            for corner, side in zip(corners, sides[triangles["of_first"] :])
            for k in range(3)
            if side >> k & 1
        }
    assert len(lines["box"]) == 12 and not lines["round"]


def test_no_name_ends_the_script(viewer):
    name = "</script><script>alert('&')</script><!--<script>"
    nothing = _surfaces.Pieces(np.zeros((1, 3, 3)))
    view = _surfaces.View(np.zeros(3), 1.0)
    none = np.empty((0, 3)), np.empty((0, 3)), np.empty(0, bool)
    page = _pages._page_of(_pictures.Picture(f"{name}\nsecond", view, [(name, nothing, nothing)], *none))
    (text,) = re.findall(r'id="picture">(.*?)</script>', page)
    assert "<" not in text and "alert(" not in page.replace(text, "").replace(html.escape(name), "")
    data = data_of(page)
    assert data["title"] == f"{name}\nsecond" and data["names"] == [name]
    assert html.unescape(re.findall("<title>(.*?)</title>", page)[0]) == name


def run(code, *names):
    """What it prints. The package is that of this test."""
    command = [sys.executable, "-c", WITHOUT_MATPLOTLIB + code, *map(str, names)]
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


QUERY = """
import numpy as np, fcl_ccd
mesh = fcl_ccd.RigidMesh(np.eye(3), [(0, 1, 2)])
result = fcl_ccd.collide(mesh, mesh)
"""


def test_without_matplotlib_a_browser_opens_the_page(tmp_path, viewer):
    code = f"""{QUERY}
import tempfile, webbrowser
tempfile.tempdir = sys.argv[1]
webbrowser.open = lambda address: print(address) or True
result.show()
result.show(contact=None)
webbrowser.open = lambda address: False
try:
    result.show()
except RuntimeError as error:
    print(error)
"""
    *opened, last = run(code, tmp_path).splitlines()
    assert "neither matplotlib nor a browser" in last and "show(file='contact.html')" in last
    assert sorted(opened) == sorted(path.as_uri() for path in tmp_path.iterdir())
    assert len(opened) == 2 and opened[0].endswith(".html")
    assert all(data_of(path.read_text(encoding="utf-8"))["names"] for path in tmp_path.iterdir())


def test_without_matplotlib_a_notebook_has_the_page(viewer):
    code = f"""{QUERY}
import types
def display(shown, raw):
    assert raw
    print(shown["text/html"])
ipython = types.SimpleNamespace(get_ipython=lambda: types.SimpleNamespace(kernel=1))
sys.modules["IPython"], sys.modules["IPython.display"] = ipython, types.SimpleNamespace(display=display)
result.show()
"""
    frame = run(code)
    (page,) = re.findall('<iframe srcdoc="([^"]*)" width="100%"', frame)
    assert data_of(html.unescape(page))["names"] == ["o: RigidMesh"]


def test_a_page_in_a_notebook_of_jupyter(tmp_path, monkeypatch, viewer):
    require("nbclient", "ipykernel")
    import nbclient
    import nbformat
    from test_notebook import kernel_of_this_python, texts

    kernel_of_this_python(tmp_path, monkeypatch)
    cell = nbformat.v4.new_code_cell(WITHOUT_MATPLOTLIB + QUERY + "result.show()")
    notebook = nbformat.v4.new_notebook(cells=[cell])
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": tmp_path}}).execute()
    (frame,) = texts(notebook.cells[0]["outputs"], "text/html")
    assert frame.startswith("<iframe srcdoc=")


def test_ways_out(tmp_path):
    """Errors name what is there: matplotlib, and a page if this package has its 3D view."""
    code = f"""{QUERY}
import pathlib
from fcl_ccd import _pages
for viewer in (_pages._VIEWER, pathlib.Path(sys.argv[1])):
    _pages._VIEWER = viewer
    for file in ("contact.png", "contact.html", None):
        try:
            result.show(file=file and sys.argv[2] + file)
            print(file)
        except (ImportError, RuntimeError) as error:
            print(type(error).__name__, error)
"""
    empty = tmp_path / "viewer.min.js"
    empty.touch()
    code = code.replace("import numpy", "import webbrowser; webbrowser.open = lambda address: True\nimport numpy")
    with_view, without = (run(code, empty, f"{tmp_path}/").splitlines()[k : k + 3] for k in (0, 3))
    if _pages.has_viewer():
        assert with_view[0].startswith("ImportError show() needs matplotlib.")
        assert "python3-matplotlib" in with_view[0] and "show(file='contact.html')" in with_view[0]
        assert with_view[1:] == ["contact.html", "None"]
    for line in (without[0], without[2]):
        assert line.startswith("ImportError show() needs matplotlib.") and "contact.html" not in line
    assert without[1].startswith("RuntimeError this fcl_ccd was built without the 3D view")
    assert "matplotlib" in without[1] and "show(file='contact.png')" in without[1]


def test_the_viewer_is_not_read_at_import():
    code = """
opened = []
sys.addaudithook(lambda event, arguments: event == "open" and opened.append(str(arguments[0])))
import fcl_ccd
print(any("fcl_ccd" in name for name in opened), any("viewer" in name for name in opened))
"""
    assert run(code).split() == ["True", "False"]


# How far the main contact is from the middle of the view, and how many pixels around it are red.
MAIN = """
const canvas = document.querySelector('#view canvas'), label = document.getElementById('label');
if (label.hidden) return null;
const box = canvas.getBoundingClientRect();
const copy = document.createElement('canvas');
[copy.width, copy.height] = [canvas.width, canvas.height];
const context = copy.getContext('2d');
context.drawImage(canvas, 0, 0);
const x = Number(label.dataset.x), y = Number(label.dataset.y), scale = canvas.width / box.width;
const rgb = context.getImageData(Math.round((x - 8) * scale), Math.round((y - 8) * scale), 16, 16).data;
let red = 0;
for (let i = 0; i < rgb.length; i += 4) red += rgb[i] > 200 && rgb[i + 1] < 100 && rgb[i + 2] < 120;
return [Math.hypot(x - box.width / 2, y - box.height / 2), red];
"""


def test_pages_in_a_browser(tmp_path, viewer):
    browser = pytest.importorskip("browser")
    missing = browser.missing_programs()
    if missing:
        pytest.skip(f"missing: {', '.join(missing)} (Debian: chromium chromium-driver)")
    with browser.Browser(tmp_path / "profile") as window:
        for name, scene in SCENES.items():
            result, page = scene(), tmp_path / f"{name}.html"
            result.show(file=page)
            window.open(page.as_uri())
            window.wait_for("document.body.dataset.ready === 'yes'")
            found = window.script(MAIN)
            assert (found is None) == (len(result.contacts) == 0)
            assert found is None or (found[0] < 2 and found[1] > 20), (name, found)
            assert window.script("return document.getElementById('title').textContent") == (
                _results._picture(result, None, 0).title
            )
            if name == "meshes":
                use(window)
            assert window.errors() == []
        names = "performance.getEntriesByType('resource').map((e) => e.name)"
        assert window.script(f"return {names}") == []


def use(window):
    """Buttons and the mouse change the view; the first view comes back."""
    image = "document.querySelector('#view canvas').toDataURL()"
    box = window.script("const b = document.getElementById('view').getBoundingClientRect();"
                        "return [b.left, b.top, b.width, b.height]")  # fmt: skip
    middle = box[0] + box[2] / 2, box[1] + box[3] / 2
    window.script(f"window.first = window.before = {image}")
    for change in (
        lambda: window.drag((middle[0] + 40, middle[1] + 60), (middle[0] + 130, middle[1] + 80)),
        lambda: window.click("#whole"),
        lambda: window.click("#cut"),
        lambda: window.click("#near"),
    ):
        change()
        window.wait_for(f"{image} !== window.before")
        window.script(f"window.before = {image}")
    window.click("#cut")
    window.wait_for(f"{image} === window.first")
