# SPDX-License-Identifier: BSD-3-Clause
"""Builds the wheel. CMake compiles the module; pyproject.toml has everything else.

FCL_CCD_BUILD_DIR names a build folder of CMake that has the module already, as tests do.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

PROJECT = Path(__file__).resolve().parent.parent
OFF = ("TOOLS", "BENCHMARKS", "REPRODUCTION")


def configure(folder: Path) -> None:
    options = [f"-DFCL_CCD_BUILD_{part}=OFF" for part in OFF]
    options += ["-DBUILD_TESTING=OFF", "-DFCL_CCD_BUILD_PYTHON=ON"]
    options += ["-DCMAKE_BUILD_TYPE=Release", f"-DPython_EXECUTABLE={sys.executable}"]
    subprocess.run(["cmake", "-S", PROJECT, "-B", folder, *options], check=True)


class CMakeBuild(build_ext):
    """Compiles fcl_ccd._core, and copies it and the 3D view to where setuptools wants them."""

    def build_extension(self, ext: Extension) -> None:
        given = os.environ.get("FCL_CCD_BUILD_DIR")
        folder = Path(given or Path(self.build_temp).resolve() / "cmake")
        if not given:
            configure(folder)
        jobs = str(os.cpu_count() or 1)
        build = ["cmake", "--build", folder, "--target", "fcl_ccd_python", "-j", jobs]
        subprocess.run(build, check=True)
        to = Path(self.get_ext_fullpath(ext.name))
        to.parent.mkdir(parents=True, exist_ok=True)
        built = folder / "python" / "fcl_ccd"
        shutil.copy2(next(built.glob("_core.*.so")), to)
        for viewer in built.glob("viewer.min.js*"):
            shutil.copy2(viewer, to.parent)
        subprocess.run(["strip", "--strip-unneeded", to], check=True)


def version() -> str:
    header = PROJECT / "include" / "fcl" / "ccd_version.h"
    found = re.search(r'define FCL_CCD_VERSION "([^"]+)"', header.read_text(encoding="utf-8"))
    assert found, header
    return found.group(1)


setup(
    version=version(),
    ext_modules=[Extension("fcl_ccd._core", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
)
