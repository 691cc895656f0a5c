"""Random damage to the files always causes errors with a place in the file, and nothing else."""

import pathlib
import random
import re
import unittest.mock

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from helpers.config_files import NAMES, TEXTS, ConfigDir
from helpers.examples import examples
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.rulebook.yaml_lines import read_yaml

PASSWORDS = re.findall(r"^\w+: (\w+)$", TEXTS["passwords"], re.MULTILINE)

# What typing errors are made of, and what YAML is easily upset by.
SNIPPETS = list("\t :-'\"[]{},#&*!|>%@`?~\\\n\r\0\x85\u2028") + [
    "- ", ": ", "  ", "\t\t", "---\n", "...\n", "<<: *a", "&a ", "*a", "!!python/object:os.system ", "!!int ",
    "\\ud800", '"\\U00110000"', ".nan", "-.inf", "0x1f", "1e999", "9" * 5000, "null", "yes", "2015-99-99", "ä",
    "\U0001f916", "%YAML 3.7\n", "%TAG ! a\n", "|9\n", ">-\n", "? ", "[" * 30, "{" * 30,
]  # fmt: skip


# Everything that the shipped files are made of, in few lines.
SMALL = [
    "- name: a\n  code: B\n  x: {a: b, c: \"d e\"}\n  y: [1, 2]\n- name: \"q\\n\"\n  s: 'it''s'\n",
    '# a\nA: b\nC: d # x\nE: "f"\n',
    "- {zone: z, schedule: [{benchmark: STB, team: D, round: 1}]}\n",
    "a:\n  - b\n  -  c: d\n     e: f\n\n  - [x,\n     y: z]\n",
]


def mutate(text: str, rng: random.Random) -> str:
    """One slip in one place."""
    lines = text.splitlines(keepends=True) or [""]
    at = rng.randrange(len(lines))
    kind = rng.randrange(9)
    if kind == 0:
        del lines[at]
    elif kind == 1:
        lines.insert(rng.randrange(len(lines)), lines[at])
    elif kind == 2:
        lines[at] = lines[at].lstrip(" ")
    elif kind == 3:
        lines[at] = rng.choice([" ", "  ", "\t", "- ", "# "]) + lines[at]
    elif kind == 4:
        lines[at] = lines[at].rstrip("\n")
    elif kind == 5:
        return text[: rng.randrange(len(text) + 1)]
    else:
        line = lines[at]
        i = rng.randrange(len(line) + 1)
        if kind == 6:
            lines[at] = line[:i] + line[i + 1 :]
        elif kind == 7:
            lines[at] = line[:i] + line[i + 1 : i + 2] + line[i : i + 1] + line[i + 2 :]
        else:
            lines[at] = line[:i] + rng.choice(SNIPPETS) + line[i + rng.randrange(3) :]
    return "".join(lines)


def check(files: ConfigDir, **texts: object) -> None:
    """Load the files. The result is consistent, and every error has a place."""
    try:
        loaded, warnings = files.load(**texts)
    except config.ConfigErrors as errors:
        assert errors.errors
        for error in errors.errors:
            data = pathlib.Path(error.file).read_bytes()
            # After the last line's end there is no further line.
            lines = re.split(b"\r\n|\r|\n", re.sub(b"(\r\n|\r|\n)$", b"", data))
            assert 1 <= error.line <= len(lines), error
            assert error.column >= 1, error
            assert error.found and error.expected, error
            assert "\n" not in str(error)
        report = str(errors)
    else:
        events = [event for zone in loaded.zones for event in zone.events]
        assert all(zone.events for zone in loaded.zones)
        assert all(e.team == ALL_TEAMS or loaded.passwords[e.team] for e in events)
        assert all(loaded.benchmarks[e.benchmark.code] is e.benchmark for e in events)
        report = "\n".join(warnings)
    assert [password for password in PASSWORDS if password in report] == []


@pytest.mark.parametrize("name", NAMES)
@examples(60)
@given(rng=st.integers(0, 2**32 - 1).map(random.Random), slips=st.integers(1, 4))
def test_slips_in_a_shipped_file(files, name, rng, slips):
    text = TEXTS[name]
    for _ in range(slips):
        text = mutate(text, rng)
    check(files, **{name: text})


# What an organiser may write behind the keys of a benchmark, right and wrong.
VALUES = {
    "name": ["Task", "7", "''"], "desc": ["Fetch", "[]", "~"], "code": ["SetTable", "HNF", "hnf", "9", "a b", "A" * 40],
    "timeout": ["60", "0", "soon", "1e9", "{}", "no limit"], "total_timeout": ["600", "30", "-1", "[1]", "no limit"],
    "setup_time": ["60", "no limit", "-5"], "attempts": ["2", "0", "1.5"], "attempt_counts": ["best", "all", "first"],
    "restarts": ["clock runs", "clock stops", "not allowed", "no"], "pause": ["allowed", "yes"], "no_show": ["zero"],
    "timed_out_goal": ["completed", "failed", "no"],
    "phases": ["[]", "[{name: A}]", "[{name: A, limit: 60}, {name: A}]", "[A]", "{name: A}", "[{limit: 5}]", "~"],
    "kind": ["task", "functionality", "all robots", "all", "[task]", "", "{task: 1}"],
    "uses": ["[]", "[tablet]", "[tablet, tablet]", "[visitor, bell, devices]", "tablet", "[[]]", "[1]", "{}", "~"],
    "offline_data": ["required", "optional", "true", "[]"], "uss": ["[]"], "points": ["3"],
}


@examples(200)
@given(data=st.data())
def test_benchmarks_of_a_competition(files, data):
    entries = data.draw(st.lists(st.lists(st.sampled_from(sorted(VALUES)), min_size=1, unique=True), min_size=1,
                                 max_size=3))
    text = "".join("- " + "  ".join(
        f"{key}: {data.draw(st.sampled_from(VALUES[key]))}\n" for key in keys) for keys in entries)
    events = [f"    - {{ benchmark: {data.draw(st.sampled_from(VALUES['code']))}, team: {team}, round: 1, run: {run}, "
              "scheduled_time: 2026-11-28 09:00:00 }\n" for run, team in ((1, "BrassButlers"), (2, "ALL"))]
    check(files, benchmarks=text, schedule="- zone: Home\n  schedule:\n" + "".join(events))


@pytest.mark.skipif(not yaml.__with_libyaml__, reason="PyYAML without libyaml has one parser only")
@examples(400)
@given(text=st.sampled_from(SMALL), rng=st.integers(0, 2**32 - 1).map(random.Random), slips=st.integers(1, 3))
def test_libyaml_reads_the_same_as_pyyaml(tmp_path_factory, text, rng, slips):
    for _ in range(slips):
        text = mutate(text, rng)
    path = tmp_path_factory.getbasetemp() / "mutated.yaml"
    path.write_bytes(text.encode("utf-8"))
    assert _read(str(path), True) == _read(str(path), False)


def _read(path, with_libyaml):
    report = Report()
    with unittest.mock.patch.object(yaml, "__with_libyaml__", with_libyaml):
        return read_yaml(path, report, "a file", "a shape"), report.errors


@examples(100)
@given(data=st.one_of(st.binary(), st.lists(st.sampled_from(SNIPPETS + ["a", "name: x\n"])).map("".join)))
def test_anything(files, data):
    check(files, benchmarks=data, schedule=data, passwords=data)
