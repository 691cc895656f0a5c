"""All modules of the folder. An invalid file does not affect the others."""

import os
import sys

import pytest

from helpers.config_files import line_of
from roah_rsbb import bmbox
from roah_rsbb.bmbox.framework import rule_files
from roah_rsbb.bmbox.framework.rehearsal import Rehearsal
from roah_rsbb.bmbox.framework.rule_files import WatchedFile, load_rules, own_files
from roah_rsbb.bmbox.host.host import Driven
from roah_rsbb.rulebook.errors import ConfigErrors, Report
from roah_rsbb.rulebook.registry import PROFILES, BenchmarkKind
from roah_rsbb.rulebook.yaml_lines import Place

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


# -- rules in a competition's folder: loaded by their name, with file and line of what is wrong -------

GOOD = """\
import dataclasses
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import Text
from roah_rsbb.bmbox.framework.score import Value


@dataclasses.dataclass
class Mug:
    colour: str


class Fetch(Module):
    CODE = "FetchMug"
    PARAMETERS = {"colour": Text("red")}
    SCORES = {"fetched": Value("Mugs fetched")}

    async def execute(self):
        mug = Mug(self.parameters.colour)
        outcome = await self.goal({"fetch": mug.colour})
        found = self.record(outcome, {"colour": str})
        self.score["fetched"] = int(found.colour == mug.colour)
"""


@pytest.fixture
def write(tmp_path):
    """Write the file of a code, and return its path."""
    def write(text, name="FetchMug.py"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return str(path)
    return write


def test_rules_of_a_competition_do_all_that_shipped_ones_do(write):
    kind = load_rules(write(GOOD))
    r = Rehearsal(kind, {"colour": "blue"}, goal_timeout=60.0)
    assert (r.asked.goal, r.asked.timeout) == ("{fetch: blue}", 60.0)
    r.result('{"colour": "blue"}', 4.0)
    assert (r.finished, r.score["fetched"]) == (True, 1)


def test_an_exception_in_rules_names_file_and_line(write):
    path = write(GOOD)
    r = Rehearsal(load_rules(path), {"colour": "blue"})
    r.result("no map")
    assert r.failed == f"{path}:{line_of(GOOD, 'self.score[')}: AttributeError: 'NoneType' " \
                       "object has no attribute 'colour'"


# What is replaced, by what, a part of the line with the error (None: the whole file), and parts of the message.
MISTAKES = [
    ("    async def execute", "    async def execute(", "async def execute((", ["invalid Python ("]),
    ("import dataclasses\n", "import no_such_library\n", "no_such", ["ModuleNotFoundError: No module named 'no_such"]),
    ("class Mug:", "class Mug(1 / 0):", "class Mug", ["ZeroDivisionError: division by zero", "rules that can be"]),
    ("import dataclasses\n", "import dataclasses\nraise SystemExit(3)\n", "SystemExit", ["SystemExit: 3"]),
    ('CODE = "FetchMug"', 'CODE = "Fetch"', "class Fetch", ["Fetch with CODE = 'Fetch'", "with CODE = 'FetchMug'"]),
    ('    CODE = "FetchMug"\n', "", None, ["no class with a CODE", "a class derived from Module with CODE"]),
    ("class Fetch(Module)", "class Fetch", None, ["no class with a CODE"]),
    ("class Fetch(Module):", 'class Again(Module):\n    CODE = "FetchMug"\n\n\nclass Fetch(Module):', "class Fetch",
     ["a second class with CODE = 'FetchMug'"]),
    ("    async def", "    def", "await self.goal", ["invalid Python ('await' outside async function)"]),
    ("async def execute", "async def run", "class Fetch", ["no rules in Fetch", "a method 'async def execute(self)'"]),
    ('{"colour": Text("red")}', '{"colour": "red"}', "class Fetch", ["'colour': 'red'", "in PARAMETERS", "Seconds()"]),
    ('{"colour": Text("red")}', '["colour"]', "class Fetch", ["['colour']' as PARAMETERS", "a dict"]),
    ('{"fetched": Value("Mugs fetched")}', '{1: Value("x")}', "class Fetch", ["1: Value", "in SCORES"]),
]


@pytest.mark.parametrize("old, new, part, parts", MISTAKES, ids=[new[:20] for _, new, _, _ in MISTAKES])
def test_one_mistake_is_one_error_with_its_line(write, old, new, part, parts):
    assert old in GOOD
    text = GOOD.replace(old, new, 1)
    path = write(text)
    with pytest.raises(ConfigErrors) as caught:
        load_rules(path)
    (error,) = caught.value.errors
    assert (error.file, error.line) == (path, 0 if part is None else line_of(text, part))
    assert [part for part in parts if part not in str(error)] == [], str(error)


def test_a_file_that_is_missing_or_no_text(write, tmp_path):
    with pytest.raises(ConfigErrors, match="FetchMug.py: found no file"):
        load_rules(str(tmp_path / "FetchMug.py"))
    (tmp_path / "FetchMug.py").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigErrors, match="UTF-16"):
        load_rules(str(tmp_path / "FetchMug.py"))


def test_which_files_are_rules(write, tmp_path):
    for name in ("FetchMug.py", "_helpers.py", "HNF.yaml", "notes.txt", "not-a-code.py"):
        write("", name)
    assert own_files(str(tmp_path)) == {"FetchMug": str(tmp_path / "FetchMug.py")}
    assert own_files(str(tmp_path / "nowhere")) == {}


def _driven(tmp_path):
    return Driven("FetchMug", str(tmp_path), None, str(tmp_path / "FetchMug.py"))


def test_rules_and_parameters_are_read_again_when_they_change(write, tmp_path):
    path = write("import nothing_like_it\n")
    write("colour: red\n", "FetchMug.yaml")
    driven = _driven(tmp_path)
    assert driven.problems() == [f"{path}:1: found ModuleNotFoundError: No module named 'nothing_like_it'; expected "
                               "rules that can be loaded (docs/write_a_benchmark.md)"]
    assert driven.subjects == []
    with pytest.raises(ConfigErrors):
        driven.parameters()
    write(GOOD)
    driven.reload()
    assert (driven.problems(), driven.parameters().colour) == ([], "red")
    write(GOOD.replace('"colour": Text', '"color": Text').replace(".colour)", ".color)", 1))
    driven.reload()
    assert len(driven.problems()) == 1
    assert "FetchMug.yaml:1: found the unknown key 'colour'" in driven.problems()[0]


def test_rules_without_required_parameters_need_no_parameters_file(write, tmp_path):
    write(GOOD.replace('{"colour": Text("red")}', "{}").replace("self.parameters.colour", "'red'"))
    driven = _driven(tmp_path)
    assert driven.problems() == []
    assert vars(driven.parameters()) == {}
    assert not os.path.exists(str(tmp_path / "FetchMug.yaml"))


# -- files that are repaired while they are in use ----------------------------------------------------

class Reader:
    """Reads a file whose content must be a number."""

    def __init__(self, path):
        self.path = path
        self.times = 0

    def __call__(self):
        self.times += 1
        try:
            return int(self.path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            report = Report()
            report.error(Place(str(self.path), 1, 1), "nonsense", "a number")
            report.raise_errors()


@pytest.fixture
def path(tmp_path):
    return tmp_path / "number"


def watched(path):
    read = Reader(path)
    return WatchedFile(str(path), read), read


def test_it_is_read_only_when_it_changed(path):
    path.write_text("1", encoding="utf-8")
    file, read = watched(path)
    assert (file.content(), file.problems, read.times) == (1, [], 1)
    assert not file.reload()
    path.write_text("22", encoding="utf-8")
    assert (file.content(), read.times) == (22, 2)
    other = path.with_name("other")
    other.write_text("33", encoding="utf-8")
    os.utime(str(other), ns=(path.stat().st_atime_ns, path.stat().st_mtime_ns))
    other.replace(path)  # as editors do; the same size, the same time
    assert file.reload()
    assert file.content() == 33


def test_errors_are_reported_until_they_are_repaired(path):
    file, read = watched(path)
    assert len(file.problems) == 1
    with pytest.raises(ConfigErrors, match="nonsense"):
        file.content()
    assert read.times == 1
    path.write_text("x", encoding="utf-8")
    assert file.reload()
    assert "number:1: found nonsense; expected a number" in file.problems[0]
    path.write_text("5", encoding="utf-8")
    assert (file.content(), file.problems) == (5, [])
    path.unlink()
    with pytest.raises(ConfigErrors):
        file.content()
    assert len(file.problems) == 1
