"""The authors' page shows the real files, and its examples run."""

import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs" / "write_a_benchmark.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def test_the_rules_are_those_of_the_file():
    assert blocks("python")[0] == (ROOT / "src/roah_rsbb/bmbox/stb.py").read_text(encoding="utf-8")


def test_the_parameters_are_those_of_the_file():
    assert blocks("yaml") == [(ROOT / "config/modules/STB.yaml").read_text(encoding="utf-8")]


def test_the_rehearsal_runs():
    exec(compile(blocks("python")[1], "write_a_benchmark.md", "exec"), {})


def test_every_file_that_is_named_exists():
    for name in re.findall(r"\]\(([^)#]+)\)", PAGE):
        assert (ROOT / "docs" / name).exists(), name
