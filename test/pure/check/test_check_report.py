"""The check's reports."""

import json
import pathlib
from xml.etree import ElementTree

from roah_rsbb.check import report
from roah_rsbb.check.report import Cause, Finding, ScenarioResult, Verdict
from roah_rsbb.ground.installed import pages_folder

ROOT = pathlib.Path(__file__).resolve().parents[3]

FAILED = ScenarioResult("run", "A whole run", 5.0, 7.25, [
    Finding(Verdict.FAILED, Cause.STOP_LATE, "STOP within 1 s", "2.0 s \x1b[31m<b>", 9.5)], ["STOP: 2000 ms"])
SKIPPED = ScenarioResult("moved", "Another address", 12.0, 0.1, [
    Finding(Verdict.SKIPPED, None, "", "no second address", 12.1)])
PASSED = ScenarioResult("find", "Find the robot", 0.0, 1.0)


def check(*results, **fields):
    values = {"team": "Team", "robot": "R\x072", "level": "basic", "began_utc": 1_800_000_000.0, "seconds": 12.5,
              "interrupted": False, "planned": len(results), "results": results}
    return report.Check(**{**values, **fields})


def test_the_verdict_is_the_worst_one():
    assert check(PASSED, SKIPPED).verdict is Verdict.PASSED
    assert check(PASSED, SKIPPED, FAILED).verdict is Verdict.FAILED
    busy = ScenarioResult("run", "A whole run", 0.0, 1.0, [FAILED.findings[0]._replace(verdict=Verdict.UNJUDGED)])
    assert check(PASSED, busy).verdict is Verdict.UNJUDGED
    assert check(PASSED, planned=3, interrupted=True).sentence() == \
        "The check was interrupted: 1 passed, 2 not begun"
    assert check(PASSED, FAILED).sentence() == "The robot has faults: 1 passed, 1 failed"


def test_a_finding_has_its_cause_and_page_in_every_report():
    whole = check(PASSED, FAILED, SKIPPED)
    texts = ["STOP within 1 s", Cause.STOP_LATE.name, Cause.STOP_LATE.likely, Cause.STOP_LATE.page]
    terminal = "\n".join(report.scenario_lines(2, 3, FAILED))
    junit = ElementTree.fromstring(report.as_junit(whole).partition("\n")[2])
    failure = junit.find("testcase[@name='run']/failure")
    for text in texts:
        assert text in terminal and text in report.as_json(whole) and text in failure.text, text
        assert text in report.as_html(whole).replace("<wbr>", ""), text


def test_what_was_skipped_takes_one_line():
    (line,) = report.scenario_lines(3, 9, SKIPPED)
    assert line.split("  ")[-1] == "no second address" and "skipped" in line
    assert len(report.scenario_lines(1, 9, PASSED)) == 1


def test_texts_of_a_robot_are_harmless():
    whole = check(FAILED)
    for text in (report.as_junit(whole), report.as_html(whole), "\n".join(report.scenario_lines(1, 1, FAILED)),
                 "\n".join(report.table_lines(whole))):
        assert "\x1b" not in text and "\x07" not in text
    assert "<b>" not in report.as_html(whole) and "<b>" not in report.as_junit(whole)


def test_json_has_everything():
    found = json.loads(report.as_json(check(PASSED, FAILED)))
    assert found["format"] == 1 and found["verdict"] == "failed" and found["planned"] == 2
    assert found["scenarios"][1] == {
        "name": "run", "title": "A whole run", "verdict": "failed", "began_s": 5.0, "seconds": 7.25,
        "measured": ["STOP: 2000 ms"], "findings": [{
            "verdict": "failed", "cause": "STOP_LATE", "expected": "STOP within 1 s", "came": "2.0 s \x1b[31m<b>",
            "at_s": 9.5, "likely": Cause.STOP_LATE.likely, "page": Cause.STOP_LATE.page}]}


def test_the_table_says_where_the_pages_are():
    where = "The pages to see (docs/...) are in /home/team/pages"
    assert where in report.table_lines(check(PASSED, FAILED), pathlib.Path("/home/team/pages"))
    assert where not in report.table_lines(check(PASSED, SKIPPED), pathlib.Path("/home/team/pages"))
    assert pages_folder() == ROOT


def test_junit_shows_quirks():
    quirk = ScenarioResult("stale", "Old datagrams", 0.0, 1.0, [
        Finding(Verdict.QUIRK, Cause.STALE_OBEYED, "no change", "it obeyed", 0.5)], ["STOP: 2 ms"])
    junit = ElementTree.fromstring(report.as_junit(check(quirk)).partition("\n")[2])
    case = junit.find("testcase")
    assert [element.tag for element in case] == ["system-out"]
    assert "QUIRK STALE_OBEYED" in case[0].text and "STOP: 2 ms" in case[0].text


def test_junit_counts():
    junit = ElementTree.fromstring(report.as_junit(check(PASSED, FAILED, SKIPPED)).partition("\n")[2])
    assert {name: junit.get(name) for name in ("tests", "failures", "errors", "skipped")} == {
        "tests": "3", "failures": "1", "errors": "0", "skipped": "1"}


def test_no_two_causes_are_the_same():
    assert len(Cause.__members__) == len(list(Cause))
