"""Runs the notebooks, each in a folder of its own: `run_notebooks.py FOLDER`.

A notebook fails where one of its cells does; what it promises in words it asserts. Stored notebooks have no output, so that a
change of them can be read.
"""

import os
import pathlib
import sys
import tempfile

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

os.environ["MPLBACKEND"] = "module://matplotlib_inline.backend_inline"
failed = False
notebooks = sorted(pathlib.Path(sys.argv[1]).glob("*.ipynb"))
for path in notebooks:
    notebook = nbformat.read(path, as_version=4)
    stored = [cell for cell in notebook.cells if cell.get("outputs") or cell.get("execution_count")]
    if stored:
        print(f"{path}: has output in {len(stored)} cells; clear it before it is committed")
        failed = True
    with tempfile.TemporaryDirectory() as folder:
        try:
            NotebookClient(notebook, timeout=300, resources={"metadata": {"path": folder}}).execute()
        except CellExecutionError as error:
            print(f"{path}: {error}")
            failed = True
            continue
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    pictures = sum("image/png" in output.get("data", {}) for output in outputs)
    print(f"{path}: {len(notebook.cells)} cells, {pictures} pictures")
sys.exit(failed or not notebooks)
