"""The check's results for people and programs: a table in the terminal, JSON, JUnit, and an HTML page."""

import collections
import enum
import json
import pathlib
from dataclasses import dataclass, field
from typing import Any, Dict, List, NamedTuple, Optional, Sequence
from xml.etree import ElementTree

from roah_rsbb.results import page
from roah_rsbb.wording import times
from roah_rsbb.wording.texts import escaped, visible

# -- verdicts, causes and findings --------------------------------------------------------------------

# A failure always has a cause from the table `Cause`, with the likely mistake in the robot's code and a page that
# helps. What the protocol allows is never a failure. It is a quirk if original robots do it and a referee may notice.


class Verdict(enum.Enum):
    """The result of a scenario or of a finding, the mildest first."""

    PASSED = "passed"
    QUIRK = "quirk"  # allowed, and worth knowing
    SKIPPED = "skipped"
    UNJUDGED = "not judged"  # the checker's machine was too busy
    FAILED = "failed"


PROTOCOL, WITHOUT_ROS, TEAM = "docs/protocol.md", "docs/robot_without_ros.md", "docs/team.md"


class _Advice(NamedTuple):
    likely: str  # the likely cause, in the robot's code or configuration
    page: str
    timed: bool = False  # the checker's machine may cause the same symptom when it is busy


class Cause(enum.Enum):
    """Every known fault of a robot."""

    # Finding the robot.
    NO_BEACON = _Advice(
        "The robot's program does not run, sends to another broadcast address or port, or a firewall blocks UDP",
        f"{PROTOCOL}#channels", True)
    OTHER_TEAM = _Advice(
        "The team's name in the robot's configuration differs from the schedule's. Upper and lower case count",
        f"{PROTOCOL}#messages")
    OTHER_ROBOT = _Advice("The robot's name in its configuration differs from --robot", f"{PROTOCOL}#messages")
    BEACON_PERIOD = _Advice(
        "The beacon does not have a timer of its own, or a blocking callback delays the timer", f"{PROTOCOL}#timing",
        True)
    BAD_NAME = _Advice("The team's or the robot's name is empty, or longer than 100 characters", f"{PROTOCOL}#messages")
    # The clock.
    CLOCK_SKEW = _Advice("The robot's clock is not synchronised: no NTP client, or another server than the box's",
                         f"{PROTOCOL}#timing", True)
    CLOCK_DRIFT = _Advice(
        "The robot's clock runs at another speed, so no NTP client corrects it, or messages have the time of a "
        "simulation", f"{PROTOCOL}#timing", True)
    TIME_NOT_RISING = _Advice(
        "`time` is set once, for example when the state changes, and not in each message, or it has whole seconds only",
        f"{PROTOCOL}#messages")
    # The private channel.
    NO_PRIVATE_CHANNEL = _Advice(
        "The robot does not read the beacon's list, compares names wrongly, cannot bind the private port, or a "
        "firewall blocks UDP above the public port", f"{PROTOCOL}#channels", True)
    WRONG_PASSWORD = _Advice("The robot's password (rsbb_key) differs from the one given to the check",
                             f"{PROTOCOL}#key")
    PLAIN_FRAMES = _Advice("The robot's password is empty, so it does not encrypt", f"{PROTOCOL}#frame")
    BAD_FRAMES = _Advice("The robot frames or encodes its messages wrongly, or was built from another .proto file",
                         f"{PROTOCOL}#frame")
    TOO_LARGE = _Advice("The robot puts too much into one message: long results, or strings that it never removes",
                        f"{PROTOCOL}#frame")
    FLOOD = _Advice("The robot sends in a loop without a pause", f"{PROTOCOL}#timing")
    SILENT = _Advice(
        "A blocking callback or a long computation stops the timer that sends the state, or the program crashed",
        f"{WITHOUT_ROS}#in-python", True)
    CHANNEL_NOT_LEFT = _Advice(
        "The robot does not compare its entry in each beacon, so it does not notice that the run is over",
        f"{PROTOCOL}#channels", True)
    PORT_NOT_FOLLOWED = _Advice(
        "The robot opens its private channel once and does not compare the port in each beacon, or its program ended",
        f"{PROTOCOL}#channels", True)
    OLD_STATE = _Advice("The robot continues the goal of its last run, and does not handle STOP",
                        f"{PROTOCOL}#robots-next-state", True)
    OLD_COMMANDS = _Advice("The robot commands devices before its program does: as in its last run, or all off. "
                           "The original clients do that", f"{PROTOCOL}#device-commands")
    # States.
    PREPARE_IGNORED = _Advice(
        "The robot does not handle PREPARE in STOP, does not know this benchmark, or waits for something else first",
        f"{PROTOCOL}#robots-next-state", True)
    NEVER_READY = _Advice("The robot never reports the end of its preparation (end_prepare). --patience allows a slow "
                          "robot more time", f"{TEAM}#the-rules-of-the-game", True)
    GOAL_IGNORED = _Advice(
        "The robot does not handle GOAL_TX or WAITING_RESULT in WAITING_GOAL, or cannot read the goal's form",
        f"{PROTOCOL}#goals-and-results", True)
    NEVER_DONE = _Advice("The robot never reports the end of its goal (end_execute). --patience allows a slow robot "
                         "more time", f"{TEAM}#the-rules-of-the-game", True)
    EXECUTES_EARLY = _Advice("The robot reports EXECUTING when it is ready, and does not wait for the goal",
                             f"{PROTOCOL}#robots-next-state")
    RESULT_LEFT = _Advice("The robot leaves RESULT_TX by a timer, instead of waiting for PREPARE or STOP",
                          f"{PROTOCOL}#robots-next-state")
    FELL_TO_STOP = _Advice(
        "The robot's program crashed and restarted, treats lost datagrams as a stop, or gives up by itself",
        f"{PROTOCOL}#robots-next-state")
    ILLEGAL_STATE = _Advice("The robot's state machine differs from the protocol's table",
                            f"{PROTOCOL}#robots-next-state")
    NEXT_GOAL_IGNORED = _Advice("The robot does not handle PREPARE in RESULT_TX, so it does only one goal",
                                f"{PROTOCOL}#robots-next-state", True)
    TIMEOUT_IGNORED = _Advice("The robot does not handle PREPARE in EXECUTING, which ends a waypoint of HNF",
                              f"{PROTOCOL}#robots-next-state", True)
    # STOP.
    STOP_IGNORED = _Advice("The robot finishes its work before it handles STOP, or does not handle STOP in this state",
                           f"{TEAM}#the-rules-of-the-game", True)
    STOP_LATE = _Advice("A blocking callback delays STOP", f"{TEAM}#the-rules-of-the-game", True)
    NO_RESTART = _Advice("The robot does not handle PREPARE after a STOP in the middle of a run",
                         f"{PROTOCOL}#robots-next-state", True)
    # Contents.
    NOTHING_SAVED = _Advice("The robot does not record offline data, or does not report messages_saved",
                            f"{TEAM}#the-rules-of-the-game")
    RESULT_MISSING = _Advice("The result is not in every RESULT_TX message from the first one on",
                             f"{PROTOCOL}#goals-and-results")
    RESULT_INCOMPLETE = _Advice("The result lacks fields of its benchmark, or is not YAML",
                                f"{PROTOCOL}#goals-and-results")
    BAD_COMMAND = _Advice("The robot sets a device to less than 0 or more than 100 per cent",
                          f"{PROTOCOL}#device-commands")
    # Networks and boxes.
    GIVES_UP = _Advice("The robot stops or leaves the run when it does not hear the box for some seconds",
                       f"{PROTOCOL}#timing")
    RESTART_NOT_FOLLOWED = _Advice(
        "The robot does not continue with a box that was restarted", f"{PROTOCOL}#channels", True)
    MOVE_NOT_FOLLOWED = _Advice(
        "The robot keeps the address of the first beacon for ever", f"{PROTOCOL}#channels", True)
    BAD_NETWORK = _Advice("The robot does not repeat its state until the box's state shows that it was received",
                          f"{PROTOCOL}#timing", True)
    STALE_OBEYED = _Advice("The robot does not compare the acknowledgements of the box's messages",
                           f"{PROTOCOL}#state-machines")
    DIES_OF_GARBAGE = _Advice("An exception for an invalid datagram ends the program or its receiving thread",
                              f"{PROTOCOL}#frame", True)
    FOREIGN_BOX = _Advice("The robot takes the beacons of every box, whatever their address", f"{PROTOCOL}#channels")
    LARGE_BEACON = _Advice("The robot reads with a buffer of less than 1024 bytes, or reads only the first entries of "
                           "the list", f"{PROTOCOL}#channels", True)
    BURST = _Advice("The robot handles each beacon or event so slowly that it falls behind", f"{PROTOCOL}#timing", True)
    UNKNOWN_CODE = _Advice("The robot's program ends at a benchmark code that it does not know",
                           f"{PROTOCOL}#goals-and-results", True)

    @property
    def likely(self) -> str:
        """The likely cause in the robot's code or configuration."""
        return self.value.likely

    @property
    def page(self) -> str:
        """The page and heading that help."""
        return self.value.page

    @property
    def timed(self) -> bool:
        """Whether the checker's machine may cause the same symptom when it is busy."""
        return self.value.timed


class Finding(NamedTuple):
    """One observation about the robot."""

    verdict: Verdict
    cause: Optional[Cause]  # None: nothing is wrong
    expected: str
    came: str
    at_s: float  # seconds since the beginning of the check


@dataclass
class ScenarioResult:
    """The findings of one scenario."""

    name: str
    title: str
    began_s: float  # since the beginning of the check
    seconds: float = 0.0
    findings: List[Finding] = field(default_factory=list)
    measured: List[str] = field(default_factory=list)  # lines such as "STOP in EXECUTING: 12 ms"

    @property
    def verdict(self) -> Verdict:
        """The worst verdict of its findings."""
        order = list(Verdict)
        return max((finding.verdict for finding in self.findings), key=order.index, default=Verdict.PASSED)


# -- reports ------------------------------------------------------------------------------------------

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
