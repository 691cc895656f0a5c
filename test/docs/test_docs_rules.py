"""The examples of docs/rules.md give what the page says."""

import json
import re
import textwrap
from fractions import Fraction

import pages
import pytest

from roah_rsbb.model.rules import Measure
from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.rulebook.errors import known
from roah_rsbb.rulebook.standing_rules import read_rules
from roah_rsbb.scoring.stages import Result, number_of, rank
from roah_rsbb.scoring.tree import Course, Happened, SheetMark, count

PAGE = "docs/rules.md"
HEAD = "- name: Test\n  desc: Test\n  code: Test\n  kind: task\n  timeout: 300\n"
PART = re.compile(r"(?P<name>.+?)(?: × (?P<number>[\d.]+))?(?: at (?P<minutes>\d+):(?P<seconds>\d\d))?"
                  r"(?:: (?P<what>.+))?")


def examples():
    """Each line of the page, with what it is about: kind, rules, line."""
    rules = None
    for block in pages.blocks(PAGE):
        if block.mark == "gives":
            for number, line in enumerate(block.text.splitlines(), 1):
                yield pytest.param(rules.mark, rules.text, line, id=f"line {block.line + number}")
        elif block.mark in ("sheet", "runs", "stages"):
            rules = block


def of_sheet(text, given):
    """The points of marks on a sheet."""
    chosen, given = re.fullmatch(r"(?:\[(.*?)\] )?(.*)", given).groups()
    keys = text if text.startswith("sheet:") else f"sheet:\n{text}"
    files = {"benchmarks.yaml": HEAD + textwrap.indent(keys, "  ")}
    if chosen:
        files["decisions.yaml"] = json.dumps(dict([chosen.split(": ")]))
    with known(files):
        sheet = load_benchmarks("benchmarks.yaml")["Test"].sheet
    rows = {item.name: item for item in sheet.items}
    incidents = {incident.name for incident in sheet.incidents}
    marks, happened = [], []
    for part in given.split(", "):
        found = PART.fullmatch(part).groupdict()
        name, what = found["name"], found["what"] or ""
        at_s = None if found["minutes"] is None else Fraction(60 * int(found["minutes"]) + int(found["seconds"]))
        if name in incidents:
            fact, _, value = what.rpartition(" ")
            happened.append(Happened(name, at_s, {fact: int(value)} if what else {}))
            continue
        share = Fraction(what.split()[0]) / 100 if rows[name].amount is Measure.PERCENT else Fraction(1)
        marks.append(SheetMark(rows[name].id, Fraction(found["number"] or 1), share, what, at_s=at_s))
    return str(count(sheet, Course(tuple(marks), tuple(happened), ended=True, elapsed_s=Fraction(60))).total)


def of_runs(text, given):
    """The number of several attempts."""
    with known({"standings.yaml": text}):
        (rules,) = read_rules("standings.yaml").values()
    return str(number_of(rules.attempts, [Result(Fraction(points)) for points in given.split(", ")]))


def of_stages(text, given):
    """The teams in their order."""
    with known({"standings.yaml": text}):
        stages = read_rules("standings.yaml").stages
    results = {}
    for part in given.split(", "):
        team, test, *points = part.split()
        results.setdefault(test, {})[team] = [Result(Fraction(each)) for each in points]
    return ", ".join(line.team for line in rank(stages, results, {})[-1].lines)


@pytest.mark.parametrize("kind, rules, line", examples())
def test_an_example(kind, rules, line):
    given, expected = line.split(" = ")
    found = {"sheet": of_sheet, "runs": of_runs, "stages": of_stages}[kind](rules, given)
    assert found == (str(Fraction(expected)) if kind != "stages" else expected)
