"""Walks of docs/architecture.md that change the sources: carried out on a copy of them."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import textwrap
from typing import Iterator, NamedTuple

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
BLOCK = re.compile(
    r"^ *<!-- in (?P<file>\S+), (?P<how>before|instead of): (?P<anchor>.*?) -->\n *```text\n(?P<code>.*?)^ *```$",
    re.MULTILINE | re.DOTALL)
# The generated modules of the messages, where the package is built.
BUILT = ROOT / "build" / "devel" / "lib" / "python3" / "dist-packages" / "roah_rsbb"
LINK = f"""
import json
import roah_rsbb
roah_rsbb.__path__.append({str(BUILT)!r})
"""


class Step(NamedTuple):
    """A change of a file."""

    file: str
    how: str
    anchor: str
    code: str


def steps(title: str) -> Iterator[Step]:
    """The changes of the walk with this title, in their order."""
    walk = re.search(rf"^## {title}$.*?^## ", PAGE, re.MULTILINE | re.DOTALL).group(0)
    for found in BLOCK.finditer(walk):
        code = "\n".join(line[3:] for line in found["code"].splitlines())  # without the indentation of the list
        yield Step(found["file"], found["how"], found["anchor"].replace("\\n", "\n"), code)


def applied(text: str, step: Step) -> str:
    """The text of a file after a step."""
    assert text.count(step.anchor) == 1, f"{step.file} contains this {text.count(step.anchor)} times: {step.anchor}"
    return text.replace(step.anchor, step.code if step.how == "instead of" else f"{step.code}\n{step.anchor}")


def changed_copy(folder: pathlib.Path, title: str) -> pathlib.Path:
    """A copy of the sources after a walk."""
    shutil.copytree(ROOT / "src" / "roah_rsbb", folder / "roah_rsbb", ignore=shutil.ignore_patterns("__pycache__"))
    for step in steps(title):
        path = folder / "roah_rsbb" / step.file
        path.write_text(applied(path.read_text("utf-8"), step), "utf-8")
    return folder


def run(tree: pathlib.Path, program: str) -> object:
    """What a program prints as JSON with the copy."""
    others = (path for path in sys.path if path and "src" not in path.split("/"))
    paths = [str(tree), str(ROOT / "test" / "pure"), *others]
    done = subprocess.run([sys.executable, "-c", LINK + textwrap.dedent(program)], stdout=subprocess.PIPE, text=True,
                          check=True, env={**os.environ, "PYTHONPATH": os.pathsep.join(paths),
                                           "QT_QPA_PLATFORM": "offscreen"})
    return json.loads(done.stdout)
