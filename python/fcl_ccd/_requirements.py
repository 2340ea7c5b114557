# SPDX-License-Identifier: BSD-3-Clause
"""Says what is missing when the package cannot be imported. It is imported first."""

import importlib
import sys
from pathlib import Path


def _require_numpy() -> None:
    try:
        import numpy  # noqa: F401
    except ModuleNotFoundError as error:
        if error.name != "numpy":
            raise
        raise ImportError(
            f"fcl_ccd needs numpy, which this Python ({sys.executable}) does not have. Install "
            "it: on Debian the package python3-numpy for /usr/bin/python3, elsewhere by `pip "
            "install numpy`",
            name="numpy",
        ) from error


def _require_compiled_part() -> None:
    try:
        importlib.import_module(f"{__package__}._core")
        return
    except ModuleNotFoundError as error:
        if error.name != f"{__package__}._core":
            raise
    folder = Path(__file__).resolve().parent
    found = sorted(path.name for path in folder.glob("_core.*so"))
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    if found:
        what = f"was built for another Python: {', '.join(found)}"
        way_out = "Use that Python, or build with -DPython_EXECUTABLE"
    else:
        what = "is missing"
        way_out = "Build it by `bash cmake/python.sh`, and import it from the build folder"
    raise ImportError(
        f"the compiled part of fcl_ccd in {folder} {what}. This is Python {version} "
        f"({sys.executable}). {way_out}"
    )


_require_numpy()
_require_compiled_part()
