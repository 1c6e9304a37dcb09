"""The example runs from its first cell to its figure."""

import pathlib

import nbclient
import nbformat


def test_the_notebook_runs(tmp_path):
    path = pathlib.Path(__file__).parents[1] / "examples" / "fog_in_a_slab.ipynb"
    notebook = nbformat.read(path, as_version=4)
    client = nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": tmp_path}})
    client.execute()
    figure = tmp_path / "fog_in_a_slab.png"
    assert figure.read_bytes().startswith(b"\x89PNG") and figure.stat().st_size > 20_000
    assert (tmp_path / "fog_in_a_slab.pdf").read_bytes().startswith(b"%PDF")
