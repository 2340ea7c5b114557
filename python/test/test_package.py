# SPDX-License-Identifier: BSD-3-Clause
"""The package as a user meets it: help, examples, the wheel."""

import importlib.util
import inspect
import os
import pydoc
import re
import shutil
import subprocess
import sys
import types
from pathlib import Path

import pytest
from scenes import require

import fcl_ccd
from fcl_ccd import _pages

SOURCE = Path(__file__).resolve().parent.parent
EXAMPLES = sorted((SOURCE / "examples").glob("*.py"))


def run(*command, **options):
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options
    )
    assert done.returncode == 0, done.stdout
    return done.stdout


def test_help_has_every_name():
    text = pydoc.plain(pydoc.render_doc(fcl_ccd))
    for name in fcl_ccd.__all__:
        assert name in text
        thing = getattr(fcl_ccd, name)
        if isinstance(thing, (type, types.FunctionType)):
            assert len(inspect.getdoc(thing) or "") > 40, name
            # Arguments are in the signature, and each is described.
            if isinstance(thing, types.FunctionType):
                described = (thing.__doc__ or "") + (fcl_ccd.collide.__doc__ or "")
                described += (fcl_ccd.candidates.__doc__ or "") + (fcl_ccd.vertex_face.__doc__ or "")
                for argument in inspect.signature(thing).parameters:
                    assert argument in described or argument == "o", (name, argument)
    for field in fcl_ccd.contact_dtype.names:
        assert field in fcl_ccd.Result.__doc__


def test_help_starts_with_an_example_that_runs():
    code = inspect.getdoc(fcl_ccd).split("import fcl_ccd", 1)[1].split("Meshes:", 1)[0]
    given = """
import numpy as np
import fcl_ccd
vertices = np.array([(-1, -1, 0), (1, -1, 0), (0, 1, 0)], float)
triangles = tool_triangles = np.array([(0, 1, 2)])
tool_vertices = vertices * 0.5
next_vertices = vertices + (0, 0, 0.5)
pose_t0, pose_t1 = np.eye(4), np.eye(4)
pose_t0[2, 3], pose_t1[2, 3] = 1, -1
"""
    dedented = "\n".join(line[4:] for line in code.splitlines())
    names = {}
    exec(given + dedented, names)  # pylint: disable=exec-used
    assert names["result"].is_collide


@pytest.mark.parametrize("example", EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_examples(example, tmp_path):
    if "import matplotlib" in example.read_text(encoding="utf-8"):
        require("matplotlib")
    assert run(sys.executable, example, cwd=tmp_path)
    if example.stem == "contact_picture":
        assert (tmp_path / "contacts.png").stat().st_size > 10000


def bundled(wheel, folder):
    """The wheel with the libraries that it needs, which finds no other copy of them."""
    folder.mkdir()
    bundle = SOURCE.parent / "cmake" / "packaging" / "wheel" / "bundle.py"
    run(sys.executable, bundle, wheel, folder)
    (bundle,) = folder.glob("*.whl")
    assert "manylinux" in bundle.name
    run(sys.executable, "-m", "zipfile", "-e", bundle, folder / "files")
    (module,) = (folder / "files").glob("fcl_ccd/_core*.so")
    for name in ("libfcl", "libccd", "libtbb", "libhwy"):
        (path,) = re.findall(rf"{name}-\w+\.so\S* => (\S+)", run("ldd", module))
        assert path.startswith(str(folder))
    return bundle


def test_wheel(tmp_path):
    """Built without network, from the module that is there, and used without the project."""
    require("pip", "setuptools", "wheel")
    copy = tmp_path / "project" / "python"
    shutil.copytree(SOURCE, copy, ignore=shutil.ignore_patterns("__pycache__", "build"))
    header = tmp_path / "project" / "include" / "fcl" / "ccd_version.h"
    header.parent.mkdir(parents=True)
    shutil.copy(SOURCE.parent / "include" / "fcl" / "ccd_version.h", header)
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    offline = ["--no-index", "--no-deps"]
    run(*pip, "wheel", *offline, "--no-build-isolation", "-w", tmp_path, copy)
    (wheel,) = tmp_path.glob("*.whl")
    assert fcl_ccd.__version__ in wheel.name and "none-any" not in wheel.name
    if shutil.which("patchelf"):
        wheel = bundled(wheel, tmp_path / "bundled")
    run(*pip, "install", *offline, "--target", tmp_path / "installed", wheel)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "installed")}
    code = "import fcl_ccd, sys; sys.stdout.write(fcl_ccd.__file__)"
    found = run(sys.executable, "-c", code, env=environment, cwd=tmp_path)
    assert found.startswith(str(tmp_path / "installed"))
    run(sys.executable, SOURCE / "examples" / "planner.py", env=environment, cwd=tmp_path)
    # The parts of pages are those of this package.
    for name in ("_page.html", "_page.js", "viewer.min.js", "viewer.min.js.LICENSE"):
        built, installed = Path(fcl_ccd.__file__).parent / name, tmp_path / "installed" / "fcl_ccd" / name
        assert installed.read_bytes() == built.read_bytes(), name


def import_fails(code, folder):
    """The last line of what Python says to a program that imports a copy of the package."""
    shutil.copytree(Path(fcl_ccd.__file__).parent, folder / "fcl_ccd")
    found = subprocess.run(
        [sys.executable, "-c", code + "\nimport fcl_ccd"],
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 1
    return found.stderr.splitlines()[-1]


def test_without_numpy(tmp_path):
    text = import_fails("import sys; sys.modules['numpy'] = None", tmp_path)
    assert text.startswith("ImportError: fcl_ccd needs numpy, which this Python (/")
    assert "python3-numpy" in text and "pip install numpy" in text


@pytest.mark.parametrize("name", ["_core.cpython-37m-x86_64-linux-gnu.so", None])
def test_without_the_compiled_part(tmp_path, name):
    """Another Python than the one of the build; the folder of the source."""
    hide = f"""
from pathlib import Path
for path in Path({str(tmp_path)!r}).glob("fcl_ccd/_core.*.so"):
    path.replace(path.with_name({name!r})) if {name!r} else path.unlink()
"""
    text = import_fails(hide, tmp_path)
    assert text.startswith("ImportError: the compiled part of fcl_ccd in /")
    assert (f"was built for another Python: {name}" if name else "is missing") in text
    assert f"This is Python 3.{sys.version_info.minor} (/" in text


def test_code_of_the_page(tmp_path, monkeypatch):
    """The blocks of doc/python.md, one after the other."""
    monkeypatch.chdir(tmp_path)
    page = (SOURCE.parent / "doc" / "python.md").read_text(encoding="utf-8")
    blocks = [part.split("```", 1)[0] for part in page.split("```python\n")[1:]]
    assert len(blocks) > 5
    for call, needs in (("to_dataframe", "pandas"), (".show(", "matplotlib")):
        if importlib.util.find_spec(needs) is None and os.environ.get("CI") != "true":
            blocks = [block for block in blocks if call not in block]
    if not _pages.has_viewer():
        blocks = [block for block in blocks if 'file="contact.html"' not in block]
    names = {}
    exec("\n".join(blocks), names)  # pylint: disable=exec-used
    assert names["number"] > 0 and len(names["contacts"]) > 0
    assert 0 < len(names["touched"]) and (names["fixed"][names["touched"]] == 1).all()
