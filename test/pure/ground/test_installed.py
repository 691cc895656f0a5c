"""A package that pip installed and that PYTHONPATH replaces."""

import os
import pathlib
import subprocess
import sys

import roah_rsbb

SOURCE = pathlib.Path(roah_rsbb.__file__).resolve().parent


def printed(python, **environment):
    """What a Python says of the package that it runs."""
    return subprocess.run([str(python), "-c", "from roah_rsbb.ground.installed import replaced; print(replaced())"],
                          env={**os.environ, **environment}, stdout=subprocess.PIPE, check=True,
                          text=True).stdout.strip()


def test_a_terminal_of_ros_is_detected(tmp_path):
    venv = tmp_path / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(venv)], check=True)
    python = venv / "bin" / "python"
    packages = next((venv / "lib").glob("python3*")) / "site-packages"
    info = packages / "roah_rsbb_robot-0.1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: roah-rsbb-robot\nVersion: 0.1.0\n", encoding="utf-8")
    (packages / "roah_rsbb" / "ground").mkdir(parents=True)
    for name in ("__init__.py", "ground/__init__.py", "ground/installed.py"):
        (packages / "roah_rsbb" / name).write_text((SOURCE / name).read_text("utf-8"), encoding="utf-8")

    assert printed(python, PYTHONPATH="") == ""
    assert printed(sys.executable, PYTHONPATH=str(SOURCE.parent)) == ""
    text = printed(python, PYTHONPATH=str(SOURCE.parent))
    assert text.startswith(f"roah_rsbb runs from {SOURCE}, because PYTHONPATH names that copy. pip installed one in ")
    assert "unset PYTHONPATH" in text
