"""The authors' page shows the real files, and its examples run."""

import pathlib
import re

from roah_rsbb.bmbox.framework.own_rules import load_rules
from roah_rsbb.bmbox.framework.rehearsal import Rehearsal

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs" / "write_a_benchmark.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def test_the_rules_are_those_of_the_file():
    assert blocks("python")[0] == (ROOT / "src/roah_rsbb/bmbox/stb.py").read_text(encoding="utf-8")


def test_the_parameters_are_those_of_the_file():
    assert blocks("yaml") == [(ROOT / "config/modules/STB.yaml").read_text(encoding="utf-8")]


def test_the_rules_of_a_competition_run(tmp_path):
    path = tmp_path / "FetchMug.py"
    path.write_text(blocks("python")[1], encoding="utf-8")
    rehearsal = Rehearsal(load_rules(str(path)), {"colours": ["red", "blue"]})
    for colour in ("red", "green"):
        rehearsal.answer()
        rehearsal.result(f"{{colour: {colour}}}")
    assert rehearsal.finished
    assert rehearsal.score["fetched"] == 1


def test_the_rehearsal_runs():
    exec(compile(blocks("python")[2], "write_a_benchmark.md", "exec"), {})


def test_every_file_that_is_named_exists():
    for name in re.findall(r"\]\(([^)#]+)\)", PAGE):
        assert (ROOT / "docs" / name).exists(), name
