"""All modules of the folder. An invalid file does not affect the others."""

import sys

import pytest

from roah_rsbb import bmbox
from roah_rsbb.bmbox.framework import rule_files
from roah_rsbb.rulebook.registry import PROFILES, BenchmarkKind

MODULE = """
from roah_rsbb.bmbox.framework.module import Module

class {name}(Module):
    CODE = "{code}"
"""


FUNCTIONALITY = {code for code, profile in PROFILES.items() if profile.kind is BenchmarkKind.FUNCTIONALITY}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder whose files are modules, too."""
    monkeypatch.setattr(bmbox, "__path__", [*bmbox.__path__, str(tmp_path)])
    before = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - before:
        del sys.modules[name]


def test_each_functionality_benchmark_has_one():
    assert set(rule_files.modules()) == FUNCTIONALITY


def test_a_new_file_is_enough(folder):
    (folder / "new_one.py").write_text(MODULE.format(name="New", code="NEW"), encoding="utf-8")
    assert rule_files.modules()["NEW"].__name__ == "New"


@pytest.mark.parametrize(("text", "reason"), [
    ("def broken(:\n", "invalid syntax"), ("import nonsense_that_is_not_there\n", "nonsense_that_is_not_there"),
    ("raise RuntimeError('no rules')\n", "no rules"), (MODULE.format(name="Twin", code="STB"), "both define STB"),
])
def test_a_file_that_is_wrong_is_reported_and_left_out(folder, text, reason):
    (folder / "zz_wrong.py").write_text(text, encoding="utf-8")
    reported = []
    assert set(rule_files.modules(reported.append)) == FUNCTIONALITY
    assert len(reported) == 1
    assert reported[0].startswith("zz_wrong.py cannot be used")
    assert reason in reported[0]
    assert "Traceback" in reported[0]
    with pytest.raises((SyntaxError, ImportError, RuntimeError, ValueError)):
        rule_files.modules()
