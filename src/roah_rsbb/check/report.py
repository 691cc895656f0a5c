"""The check's results for people and programs: a table in the terminal, JSON, JUnit, and an HTML page."""

import collections
import json
import pathlib
from typing import Any, Dict, List, NamedTuple, Optional, Sequence
from xml.etree import ElementTree

from roah_rsbb.check.findings import Finding, ScenarioResult, Verdict
from roah_rsbb.results import page
from roah_rsbb.wording import times
from roah_rsbb.wording.texts import escaped, visible

# Increased when a field changes its meaning.
FORMAT = 1
_INDENT = " " * 9


class Check(NamedTuple):
    """A check that has ended."""

    team: str
    robot: str
    level: str
    began_utc: float
    seconds: float
    interrupted: bool
    planned: int  # scenarios
    results: Sequence[ScenarioResult]

    @property
    def verdict(self) -> Verdict:
        """The verdict on the robot: the worst of failed and not judged, else passed."""
        verdicts = {result.verdict for result in self.results}
        for verdict in (Verdict.FAILED, Verdict.UNJUDGED):
            if verdict in verdicts:
                return verdict
        return Verdict.SKIPPED if self.interrupted else Verdict.PASSED

    def sentence(self) -> str:
        """The verdict as a sentence."""
        counts = collections.Counter(result.verdict for result in self.results)
        parts = [f"{counts[verdict]} {verdict.value}" for verdict in Verdict if counts[verdict]]
        if len(self.results) < self.planned:
            parts.append(f"{self.planned - len(self.results)} not begun")
        heading = {
            Verdict.FAILED: "The robot has faults", Verdict.UNJUDGED: "The check could not judge everything",
            Verdict.SKIPPED: "The check was interrupted",
        }.get(self.verdict, "The robot passed the check")
        return f"{heading}: {', '.join(parts) or 'nothing was checked'}"


def finding_lines(finding: Finding) -> List[str]:
    """Describe a finding for the terminal."""
    name = "" if finding.cause is None else f" {finding.cause.name}"
    lines = [f"{finding.verdict.value.upper()}{name} at {finding.at_s:.1f} s"]
    if finding.expected:
        lines.append(f"  expected: {finding.expected}")
    lines.append(f"  came:     {finding.came}")
    if finding.cause is not None:
        lines += [f"  likely:   {finding.cause.likely}", f"  see:      {finding.cause.page}"]
    return [escaped(line) for line in lines]


def scenario_lines(number: int, count: int, result: ScenarioResult) -> List[str]:
    """Describe a scenario for the terminal."""
    begin = f"{number:>3}/{count:<3} {result.title:<44} {result.verdict.value:<10} {result.seconds:6.1f} s"
    if all(finding.verdict is Verdict.SKIPPED for finding in result.findings):
        return [" ".join([begin, *(f" {escaped(finding.came)}" for finding in result.findings)])]
    lines = [begin]
    lines += [f"{_INDENT}{line}" for finding in result.findings for line in finding_lines(finding)]
    return lines


def table_lines(check: Check, pages: Optional[pathlib.Path] = None) -> List[str]:
    """The table at the end. `pages`: the folder with docs/."""
    lines = [f"Robot {escaped(check.robot) or '?'} of team {escaped(check.team)}, level {check.level}, "
             f"{check.seconds:.0f} s", ""]
    for result in check.results:
        measured = "; ".join(result.measured)
        lines.append(f"{result.verdict.value:<11} {result.title:<44} {measured}".rstrip())
    has_pages = any(finding.cause is not None for result in check.results for finding in result.findings)
    where = [f"The pages to see (docs/...) are in {escaped(str(pages))}"] if pages is not None and has_pages else []
    return [*lines, "", *where, check.sentence()]


def as_json(check: Check) -> str:
    """The results as JSON."""
    content = {
        "format": FORMAT, "team": check.team, "robot": check.robot, "level": check.level,
        "began": times.iso(check.began_utc, in_utc=True), "seconds": round(check.seconds, 3),
        "interrupted": check.interrupted, "planned": check.planned, "verdict": check.verdict.name.lower(),
        "scenarios": [_scenario(result) for result in check.results],
    }
    return json.dumps(content, ensure_ascii=False, indent=2) + "\n"


def _scenario(result: ScenarioResult) -> Dict[str, Any]:
    return {
        "name": result.name, "title": result.title, "verdict": result.verdict.name.lower(),
        "began_s": round(result.began_s, 3), "seconds": round(result.seconds, 3), "measured": result.measured,
        "findings": [_finding(finding) for finding in result.findings],
    }


def _finding(finding: Finding) -> Dict[str, Any]:
    cause = finding.cause
    return {
        "verdict": finding.verdict.name.lower(), "cause": None if cause is None else cause.name,
        "expected": finding.expected, "came": finding.came, "at_s": round(finding.at_s, 3),
        "likely": None if cause is None else cause.likely, "page": None if cause is None else cause.page,
    }


def as_junit(check: Check) -> str:
    """The results as JUnit XML, which CI servers show."""
    suite = ElementTree.Element("testsuite", {
        "name": "check_robot", "tests": str(len(check.results)), "time": f"{check.seconds:.3f}",
        "timestamp": times.iso(check.began_utc, in_utc=True),
        "failures": str(sum(result.verdict is Verdict.FAILED for result in check.results)),
        "errors": str(sum(result.verdict is Verdict.UNJUDGED for result in check.results)),
        "skipped": str(sum(result.verdict is Verdict.SKIPPED for result in check.results)),
    })
    elements = {Verdict.FAILED: "failure", Verdict.UNJUDGED: "error", Verdict.SKIPPED: "skipped"}
    for result in check.results:
        case = ElementTree.SubElement(suite, "testcase", {
            "classname": "check_robot", "name": result.name, "time": f"{result.seconds:.3f}"})
        lines = [line for finding in result.findings for line in finding_lines(finding)]
        if result.verdict in elements:
            worst = next(finding for finding in result.findings if finding.verdict is result.verdict)
            message = worst.came if worst.cause is None else f"{worst.cause.name}: {worst.came}"
            element = ElementTree.SubElement(case, elements[result.verdict], {"message": visible(message)})
            element.text = visible("\n".join(lines))
        output = result.measured if result.verdict in elements else [*lines, *result.measured]
        if output:
            ElementTree.SubElement(case, "system-out").text = visible("\n".join(output))
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suite, encoding="unicode") + "\n"


def as_html(check: Check) -> str:
    """The results as a page."""
    facts = [
        ("Team", check.team), ("Robot", check.robot or "not found"), ("Level", check.level),
        ("Begun", times.date_time(check.began_utc)), ("Duration", f"{check.seconds:.0f} s"),
        ("Verdict", check.sentence()),
    ]
    rows = [
        (result.title, page.tag("span", result.verdict.value, class_="mark" if result.verdict is Verdict.PASSED
                                else "mark bad"), "\n".join(result.measured))
        for result in check.results
    ]
    found = [(result, finding) for result in check.results for finding in result.findings]
    body = [
        page.tag("h1", "Conformance check of a robot"), page.facts_table(facts),
        page.tag("h2", "Scenarios"), page.table(("Scenario", "Verdict", "Measured"), rows),
    ]
    if found:
        body.append(page.tag("h2", "Findings"))
    for result, finding in found:
        name = finding.verdict.value if finding.cause is None else f"{finding.verdict.value}: {finding.cause.name}"
        lines = [("When", f"{finding.at_s:.1f} s after the beginning"), ("Expected", finding.expected),
                 ("Came", finding.came)]
        if finding.cause is not None:
            lines += [("Likely cause", finding.cause.likely), ("See", finding.cause.page)]
        body += [page.tag("h3", f"{result.title} – {name}"), page.facts_table(line for line in lines if line[1])]
    return page.page(f"Check of {check.robot or 'a robot'} of team {check.team}", *body)
