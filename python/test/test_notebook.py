# SPDX-License-Identifier: BSD-3-Clause
"""The example notebook, run as Jupyter runs it."""

import base64
import json
import sys
from pathlib import Path

from scenes import require

NOTEBOOK = Path(__file__).resolve().parent.parent / "examples" / "first_contact.ipynb"


def kernel_of_this_python(folder, monkeypatch):
    """Jupyter's own may be of another Python, which has no numpy."""
    spec = folder / "kernels" / "python3" / "kernel.json"
    spec.parent.mkdir(parents=True)
    command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    spec.write_text(json.dumps({"argv": command, "display_name": "Python 3", "language": "python"}))
    monkeypatch.setenv("JUPYTER_PATH", str(folder))
    monkeypatch.setenv("IPYTHONDIR", str(folder / "ipython"))
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(folder / "runtime"))
    monkeypatch.delenv("MPLBACKEND", raising=False)


def texts(outputs, kind):
    return [output["data"][kind] for output in outputs if kind in output.get("data", {})]


def test_notebook(tmp_path, monkeypatch):
    require("nbclient", "ipykernel", "matplotlib", "pandas")
    import nbclient
    import nbformat

    kernel_of_this_python(tmp_path, monkeypatch)
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": tmp_path}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert not [output for output in outputs if output["output_type"] in ("error", "stream")], outputs
    plain = "\n".join(texts(outputs, "text/plain"))
    assert "Result(is_collide=True, time_of_contact=0." in plain
    (table,) = texts(outputs, "text/html")
    assert "toc_lo" in table and "pos_z" in table
    pictures = [base64.b64decode(text) for text in texts(outputs, "image/png")]
    assert len(pictures) == 2 and all(len(picture) > 10000 for picture in pictures)


def test_the_notebook_has_no_outputs():
    """They would be of the machine that ran it last."""
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert len(code) > 5 and all(not cell["outputs"] and not cell["execution_count"] for cell in code)
