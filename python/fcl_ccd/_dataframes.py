# SPDX-License-Identifier: BSD-3-Clause
"""Tables of pandas, which the rest of the package does not need."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, Dict, Mapping

import numpy as np

from . import _arguments

if TYPE_CHECKING:
    from numpy.typing import NDArray


def columns_of(records: NDArray[np.void]) -> Dict[str, NDArray[Any]]:
    """A column for each number of a record: "toc_lo", "pos_x", "vertices_0"."""
    columns: Dict[str, NDArray[Any]] = {}
    for name in records.dtype.names or ():
        values = records[name]
        if values.ndim == 1:
            columns[name] = np.ascontiguousarray(values)
            continue
        is_place = values.shape[1] == 3 and values.dtype.kind == "f"
        for i in range(values.shape[1]):
            suffix = "xyz"[i] if is_place else str(i)
            columns[f"{name}_{suffix}"] = np.ascontiguousarray(values[:, i])
    return columns


def frame_of(columns: Mapping[str, Any]) -> Any:
    try:
        pandas = importlib.import_module("pandas")
    except ModuleNotFoundError as error:
        if error.name != "pandas":
            raise
        raise ImportError(
            "to_dataframe() needs pandas. Install it: on Debian the package python3-pandas, "
            "elsewhere by `pip install pandas`",
            name="pandas",
        ) from error
    return pandas.DataFrame(columns)


def to_dataframe(records: NDArray[np.void]) -> Any:
    """A pandas.DataFrame of contacts, candidates, answers of tests, or cells of an OcTree.

    records : structured array (n,), for example a part of Result.contacts

    Returns a DataFrame with a row for each record. A field of one number is a column of its
    name. pos becomes pos_x, pos_y, pos_z, as normal and center do; vertices becomes
    vertices_0, vertices_1 and so on. Raises ImportError without pandas.
    """
    if not isinstance(records, np.ndarray) or records.dtype.names is None or records.ndim != 1:
        wanted = "a structured array (n,), for example contacts of a Result"
        raise _arguments.wrong_type("records", records, wanted)
    return frame_of(columns_of(records))
