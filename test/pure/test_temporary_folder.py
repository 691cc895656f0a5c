"""A run of the tests leaves nothing in the temporary folder."""

import os
import pathlib
import subprocess
import sys

CONFTEST = pathlib.Path(__file__).resolve().parent.parent / "conftest.py"
CASE = """
import os, pathlib, subprocess, tempfile

def test_it(tmp_path):
    (tmp_path / "file").write_text("a test's")
    subprocess.run(["mktemp"], check=True)  # a program's
    tempfile.mkdtemp()
    assert (tmp_path / "file").exists()
    pathlib.Path(os.environ["REACHED"]).touch()
"""


def test_nothing_is_left(tmp_path):
    shared, case, reached = tmp_path / "shared", tmp_path / "test_case.py", tmp_path / "reached"
    shared.mkdir()
    case.write_text(CASE)
    subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "conftest", "--noconftest", str(case)],
        cwd=str(tmp_path), check=True, stdout=subprocess.DEVNULL,
        env={**os.environ, "TMPDIR": str(shared), "REACHED": str(reached), "PYTHONPATH": str(CONFTEST.parent)},
    )
    assert reached.exists()
    assert list(shared.iterdir()) == []
