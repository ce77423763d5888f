"""The wheel, the notebook, the example of a node, and the pages' first example."""
import json
import os
import pathlib
import re
import subprocess
import sys

import pytest

import thimble

SOURCE, BIN = pathlib.Path(os.environ["THIMBLE_SOURCE"]), pathlib.Path(os.environ["THIMBLE_BIN"])


def test_the_notebook_makes_the_papers_figures(tmp_path, monkeypatch):
    monkeypatch.setenv("THIMBLE_OUT", str(tmp_path))
    monkeypatch.setenv("THIMBLE_SUBJECTS", "1")
    cells = json.loads((SOURCE / "examples/python/paper_figure.ipynb").read_text())["cells"]
    names = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    assert set(names["trials"].modality) == {"HF", "CF", "CCF", "VF"}
    if not all(pathlib.Path(figure).exists() for figure in names["figures"]):
        pytest.skip("there is no gnuplot (package gnuplot-nox)")
    assert all(b"<svg" in pathlib.Path(figure).read_bytes() for figure in names["figures"])


def test_the_first_example_of_the_page_works(capsys):
    page = (SOURCE / "docs/python.md").read_text()
    exec(re.search(r"```python\n(.*?)```", page, re.S)[1], {})
    assert "HF" in capsys.readouterr().out


def test_the_wheel_has_the_package(tmp_path):
    made = subprocess.run([SOURCE / "deploy/wheel", "--tree", BIN.parent, "--out", tmp_path], check=True, capture_output=True, text=True).stdout.strip()
    pip = subprocess.run([sys.executable, "-m", "pip", "install", "--no-deps", "--no-index", "--no-compile", "--target", tmp_path / "there", made],
                         capture_output=True, text=True)
    if "No module named pip" in pip.stderr:
        pytest.skip("there is no pip (package python3-pip)")
    assert pip.returncode == 0, pip.stderr
    code = "import thimble; print(thimble.__file__, thimble.session_names()[0]); thimble.Session('delay50')"
    said = subprocess.run([sys.executable, "-B", "-c", code], env={**os.environ, "PYTHONPATH": str(tmp_path / "there")}, cwd=tmp_path,
                          capture_output=True, text=True)
    assert said.stdout.startswith(str(tmp_path / "there")) and "calibrated-operator" in said.stdout, said.stderr


def test_lock_step_is_the_examples_file_and_reads_what_it_writes():
    assert pathlib.Path(thimble.lock_step.__file__).read_text() == (SOURCE / "examples/lock_step/lock_step.py").read_text()
    header, body = (7, -5, 3, 2, thimble.lock_step.SLAVE_SIM), (1, 0.5, 0.25, -1.0, b"word".ljust(16, b"\0"), 4, 5, thimble.lock_step.BEEP, 1, True, 2)
    datagram = thimble.lock_step.pack(thimble.lock_step.ORDER, header, body)
    assert thimble.lock_step.unpack(datagram) == (header, thimble.lock_step.ORDER, body)
