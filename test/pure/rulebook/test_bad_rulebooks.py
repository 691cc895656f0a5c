"""Bad rulebooks: whatever is wrong, in whichever file, is reported with file and line, and nothing breaks."""

import copy
import functools
import os
import pathlib
import re

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from helpers.config_files import SHIPPED
from helpers.examples import examples
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.framework.rule_files import load_rules, modules
from roah_rsbb.bmbox.host import ground_truth_of_frames
from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.rulebook.errors import ConfigErrors, Report
from roah_rsbb.rulebook.standing_rules import read_rules
from roah_rsbb.tools.competition.rulebooks import read_rulebook

FILES = sorted(path.relative_to(SHIPPED) for path in [
    *SHIPPED.glob("rulebooks/*/*.yaml"), *SHIPPED.glob("rulebooks/*/modules/*.yaml"), *SHIPPED.glob("*s.yaml"),
    *SHIPPED.glob("modules/*.yaml")] if path.name not in ("passwords.yaml",) and path.stem != "schedule")
# Nothing in a rulebook may be one of these.
NEVER = ({"nonsense": 1}, "", [["nonsense"]])
AT_LEAST = 200
AT_MOST_OF_A_FILE = 25


@functools.lru_cache(maxsize=None)
def parameters_of(file):
    """The parameters of a benchmarking module by the file that is beside its rules."""
    rules = (SHIPPED / file).with_suffix(".py")
    return (load_rules(str(rules)) if rules.exists() else modules()[file.stem]).PARAMETERS


def errors_of(file, path):
    """All errors that are reported if `path` is used as this file of a rulebook."""
    try:
        if file.stem == "benchmarks":
            load_benchmarks(path)
        elif file.stem == "standings":
            read_rules(path)
        elif file.stem == "ground_truth":
            ground_truth_of_frames.load(path)
        elif file.stem == "rulebook":
            report = Report()
            read_rulebook(report, str(SHIPPED), os.path.dirname(path))
            report.raise_errors()
        else:
            read_parameters(path, file.stem, parameters_of(file))
    except ConfigErrors as errors:
        return errors.errors
    return []


@functools.lru_cache(maxsize=None)
def content(file):
    return yaml.safe_load((SHIPPED / file).read_text("utf-8"))


def places(node, path=()):
    """The paths of all keys and items below a node."""
    for key, child in (node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()):
        yield (*path, key)
        yield from places(child, (*path, key))


def changed(file, path, value):
    """The content of a file with another value at a path."""
    root = copy.deepcopy(content(file))
    parent = functools.reduce(lambda node, key: node[key], path[:-1], root)
    parent[path[-1]] = value
    return root


def renamed(file, path):
    """The content of a file with a key that is misspelt."""
    root = copy.deepcopy(content(file))
    parent = functools.reduce(lambda node, key: node[key], path[:-1], root)
    pairs = [(f"{key} x" if key == path[-1] else key, value) for key, value in parent.items()]
    parent.clear()
    parent.update(pairs)
    return root


def is_free_name(file, path):
    """Whether a key may be any text: the name of a group, choice, subject or team."""
    if file.stem == "ground_truth":
        return len(path) == 2
    if path[-2:-1] == ("choices",):
        return True
    return file.stem == "benchmarks" and path[-3:-2] in (("scoring",), ("groups",)) and "scoring" in path


def cases(file):
    """Functions that make wrong contents of a file, evenly spread over its parts."""
    found = []
    for number, path in enumerate(places(content(file))):
        found.append(functools.partial(changed, file, path, NEVER[number % len(NEVER)]))
        if isinstance(path[-1], str) and not is_free_name(file, path):
            found.append(functools.partial(renamed, file, path))
    step = -(-len(found) // AT_MOST_OF_A_FILE)
    return found[::step]


def is_placed(error, path, text):
    """Whether an error names the file and an existing line of it, and says what was found and expected."""
    lines = text.splitlines() or [""]
    assert (error.file, 1 <= error.line <= len(lines)) == (path, True), error
    assert error.found and error.expected, error
    assert re.fullmatch(re.escape(path) + r":\d+: found .+; expected .+", str(error)), error
    return True


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """The path for a changed file, alone in its folder."""
    folders = {file: tmp_path_factory.mktemp("bad") for file in FILES}
    return lambda file: folders[file] / file.name


@pytest.mark.long
def test_there_are_enough():
    assert sum(len(cases(file)) for file in FILES) >= AT_LEAST


@pytest.mark.parametrize("file", FILES, ids=str)
def test_every_wrong_part_is_reported_with_its_line(place, file):
    path = place(file)
    for case in cases(file):
        text = yaml.dump(case(), Dumper=yaml.CSafeDumper, sort_keys=False)
        path.write_text(text, "utf-8")
        errors = errors_of(file, str(path))
        assert errors, text
        assert all(is_placed(error, str(path), text) for error in errors)


ANYTHING = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8),
              st.sampled_from(["no limit", "all", "task", "functionality", "rating", "choice", "mean", "best",
                               "1e999"])),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=5), inner, max_size=3)),
    max_leaves=6)


@examples(200)
@given(data=st.data(), file=st.sampled_from(FILES))
def test_anything_anywhere_is_read_or_reported(place, data, file):
    path = place(file)
    root = content(file)
    for _ in range(data.draw(st.integers(1, 2))):
        where = data.draw(st.sampled_from(list(places(content(file)))))
        try:
            root = changed(file, where, data.draw(ANYTHING)) if root is content(file) else root
        except (KeyError, IndexError, TypeError):
            continue
    text = yaml.safe_dump(root, sort_keys=False, allow_unicode=data.draw(st.booleans()))
    path.write_text(text, "utf-8")
    assert all(is_placed(error, str(path), path.read_bytes().decode()) for error in errors_of(file, str(path)))


# -- rules ------------------------------------------------------------------------------------------

GOOD = (SHIPPED / "rulebooks" / "heartmet" / "modules" / "SeeActivity.py").read_text("utf-8")


SLIPS = ["", " ", "\t", "\0", "\n", "(", ")", "'", '"""', ":", "async ", "return", "1/0", "é", "\ud7ff", "#", "\\",
         "del Module\n"]


@pytest.mark.filterwarnings("ignore")  # Python's, of strange syntax
@examples(100)
@given(st.integers(0, len(GOOD)), st.integers(0, 6), st.sampled_from(SLIPS))
def test_rules_with_a_slip_are_loaded_or_reported(tmp_path_factory, at, length, slip):
    path = tmp_path_factory.getbasetemp() / "SeeActivity.py"
    path.write_text(GOOD[:at] + slip + GOOD[at + length:], "utf-8")
    try:
        assert load_rules(str(path)).CODE == "SeeActivity"
    except ConfigErrors as errors:
        for error in errors.errors:
            assert error.file == str(path)
            assert error.line <= len(pathlib.Path(path).read_text("utf-8").splitlines()) + 1
