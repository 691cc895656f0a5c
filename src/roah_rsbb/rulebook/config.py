"""The configuration of the box: three YAML files, read and checked at the start and at each reload.

Comments at the top of each file in ``config/`` describe its format. All errors of all files are reported at once, and
the configuration is not used. A name whose definition has an error is not reported again where another file uses it.
"""

import re
import shlex
from dataclasses import replace
from decimal import Decimal
from typing import Any, Dict, FrozenSet, Iterable, List, Optional, Set, Tuple

from roah_rsbb.ground import linux
from roah_rsbb.model.records import NOT_RUN
from roah_rsbb.model.rules import NO_SHEET, Measure, Sheet
from roah_rsbb.model.scoring import Agreement, JudgesRule, ScoringItem, rows
from roah_rsbb.rulebook.benchmarks import (
    ALL_TEAMS,
    NO_LIMIT,
    Benchmark,
    Config,
    CountingAttempt,
    Durable,
    EventRules,
    PhaseRule,
    Restarts,
    ScheduledEvent,
    ZonePlan,
)
from roah_rsbb.rulebook.decisions import decisions_in, resolved
from roah_rsbb.rulebook.errors import ConfigError, ConfigErrors, Place, Report, line_list, quote
from roah_rsbb.rulebook.event_ids import VALID, adopted, known_by
from roah_rsbb.rulebook.registry import CODE, PROFILES, USES, BenchmarkKind, Profile, new_profile
from roah_rsbb.rulebook.scoring_section import as_sheet
from roah_rsbb.rulebook.sheet_file import MAX_JUDGES, read_sheet
from roah_rsbb.rulebook.yaml_fields import (
    all_of,
    choice,
    describe,
    fields,
    integer,
    number,
    one_of,
    sequence,
    text,
    utc_time,
)
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, Sequence, Unusable, read_yaml
from roah_rsbb.wording.texts import nearest, twins
from roah_rsbb.wording.times import zone_of

__all__ = ["ConfigError", "ConfigErrors", "load"]


def load(benchmarks_file: str, schedule_file: str, passwords_file: str) -> Tuple[Config, List[str]]:
    """Read all three files; return the configuration, and warnings for the log.

    Raises `ConfigErrors` with the errors of all files. No content of a file makes it raise anything else.
    """
    report = Report()
    benchmarks = BenchmarksFile(benchmarks_file, report)
    passwords = PasswordsFile(passwords_file, report)
    schedule = ScheduleFile(schedule_file, report, benchmarks, passwords)
    report.raise_errors()
    settings = schedule.settings
    return Config(benchmarks.by_code, passwords.by_team, schedule.zones, durable=settings.durable,
                  durable_at=settings.durable_at, time_zone=settings.time_zone,
                  decisions=decisions_in(benchmarks.decided)), report.warnings


def load_benchmarks(benchmarks_file: str) -> Dict[str, Benchmark]:
    """Read the benchmarks by their codes; raises `ConfigErrors`."""
    report = Report()
    benchmarks = BenchmarksFile(benchmarks_file, report)
    report.raise_errors()
    return benchmarks.by_code


def load_schedule(benchmarks_file: str, schedule_file: str) -> Tuple[Dict[str, Benchmark], Tuple[ZonePlan, ...]]:
    """Read the benchmarks and the schedule, without the passwords; raises `ConfigErrors`."""
    report = Report()
    benchmarks = BenchmarksFile(benchmarks_file, report)
    schedule = ScheduleFile(schedule_file, report, benchmarks, passwords=None)
    report.raise_errors()
    return benchmarks.by_code, schedule.zones


# -- the benchmarks file ----------------------------------------------------------------------------

# A run of more than a day is a typing error.
MAX_TIMEOUT_S = 86400
NO_LIMIT_TEXT = "no limit"
MAX_ATTEMPTS = 100

_BENCHMARK = {
    "name": "Task Benchmark 1",
    "desc": "Getting to know my home",
    "code": "HGTKMH",
    "timeout": "600",
}
_BENCHMARK_OPTIONAL = {
    "total_timeout": "600", "scoring": "[...]", "kind": "task", "uses": "[notifications]", "offline_data": "optional",
    "beacon": "optional",
    "setup_time": "120", "attempts": "2", "attempt_counts": "best", "restarts": "clock runs", "pause": "allowed",
    "phases": "[...]", "no_show": "zero",
    "timed_out_goal": "completed", "about": "The robot explores the home.",
    "judges": "2", "objection_time": "900", "protest_time": "1800",
    "sheet": "[...]", "incidents": "{restart: {times: 1}}",
    "late_marks": "count",
}
# Spectators read it on a screen, so it must be short.
_MAX_ABOUT_BYTES = 300
_LANGUAGE = re.compile("[a-z]{2,3}(_[A-Z]{2})?")
_DEFAULT_LANGUAGE = "en"
_JUDGES, _JUDGES_OPTIONAL = {"count": "2"}, {"rule": "majority"}
_AGREEMENTS = {each.value: each for each in Agreement}
# One judge alone needs no rule.
MIN_JUDGES = 2
_PHASE, _PHASE_OPTIONAL = {"name": "Serve the drinks"}, {"limit": "120"}
_KINDS = {kind.value: kind for kind in BenchmarkKind}
_TIMED_OUT_GOAL = {"completed": True, "failed": False}
_REQUIRED = {"required": True, "optional": False}
# What robots must do, or need not.
_DEMANDS = {"offline_data": "whether robots must save offline data",
            "beacon": "whether a run needs a robot that is heard"}
_RULES = {
    "attempt_counts": "which of several attempts at an event counts",
    "restarts": "whether a stopped run may be started again",
    "pause": "whether the referee may pause the clock",
    "no_show": "how an event counts whose team did not appear",
}
_LATE_MARKS = {"count": True, "do not count": False}
# The key `no_show` is of files before 2026-12, whose incidents did not come with the end of a run.
_NO_SHOW = {"no score": (), "zero": tuple(reason.name.lower() for reason in NOT_RUN)}
_PAUSE = {"allowed": True, "not allowed": False}
_PHASES_SHAPE = "phases '- {name: ..., limit: 120}'"
_BENCHMARKS_SHAPE = "benchmarks, '- name: ...' and so on"


class BenchmarksFile:
    """The file's benchmarks by code, and the codes of all its entries.

    `codes` includes the codes of entries with errors. It is None if the file, or the code of an entry, cannot be
    read: then any code may be in it. `kinds` has the kind of each benchmark; None after an error in
    it.
    """

    def __init__(self, path: str, report: Report) -> None:
        self.path = path
        self.by_code: Dict[str, Benchmark] = {}
        self.codes: Optional[Set[str]] = None
        self.kinds: Dict[str, Optional[BenchmarkKind]] = {code: profile.kind for code, profile in PROFILES.items()}
        self._report = report
        self._places: Dict[str, Place] = {}
        what = "the benchmarks file (parameter benchmarks_file)"
        root, self.decided = resolved(report, read_yaml(path, report, what, f"a sequence of {_BENCHMARKS_SHAPE}"), path)
        entries = sequence(report, root, "the file's content", _BENCHMARKS_SHAPE)
        if entries is None:
            return
        found = [self._entry(entry) for entry in entries]
        # If a code or key is repeated, or a code is missing, the author may have meant another code.
        doubtful = None in found or len(set(found)) < len(found)
        self.codes = None if doubtful else {code for code in found if code}

    def _entry(self, node: Node) -> Optional[str]:
        """Read one benchmark. Return its code if the code itself has no error, even if other fields have."""
        report = self._report
        got = fields(report, node, "a benchmark", _BENCHMARK, _BENCHMARK_OPTIONAL)
        if got is None:
            return None
        code = self._code(got.get("code"), is_new="kind" in got)
        profile = self._profile(code, got)
        name = text(report, got.get("name"), "name")
        desc = text(report, got.get("desc"), "desc")
        timeout = _timeout(report, got, "timeout")
        total = _timeout(report, got, "total_timeout") if "total_timeout" in got else timeout
        judges = self._judges(got["judges"]) if "judges" in got else None
        sheets = judges.count if judges else 0
        has_sheet = "sheet" in got or "incidents" in got
        sheet = self._sheet(got, total, sheets) if has_sheet or "scoring" in got else NO_SHEET
        scoring = rows(sheet)
        if "scoring" in got and _is_plain(sheet, scoring):
            sheet, scoring = NO_SHEET, tuple(replace(row, id="") for row in scoring)
        if "judges" in got and not {"scoring", "sheet"} & got.keys():
            report.error(got["judges"].place, "judges in a benchmark without 'sheet'",
                         "a sheet that they fill in, or no key 'judges'")
        if "late_marks" in got and not has_sheet:
            report.error(got["late_marks"].place, "late_marks in a benchmark without 'sheet'", "a sheet, too")
        for key in ("sheet", "incidents"):
            if key in got and "scoring" in got:
                report.error(got[key].place, f"{key} and scoring in one benchmark", "either of them")
                break
        objection_time, protest_time = (_timeout(report, got, name, infinity="") if name in got else 0.0
                                        for name in ("objection_time", "protest_time"))
        rules = self._rules(got, None if profile is None else profile.kind)
        about = self._about(got["about"]) if "about" in got else ()
        if code is None:
            return None
        found = f"a second benchmark with code {quote(code)}"
        report.once(self._places, code, got["code"].place, found, "each code once")
        if timeout is not None and total is not None:
            if total < timeout < NO_LIMIT:
                report.warn(
                    got["total_timeout"].place,
                    f"total_timeout {total:g} of {code} is less than its timeout {timeout:g}: "
                    "it ends the run before the first goal's time is over",
                )
            if name is not None and desc is not None and profile is not None:
                ends = [end for incident in sheet.incidents for end in incident.at_end]
                rules = replace(rules, absent=tuple(dict.fromkeys([*rules.absent, *ends])))
                self.by_code[code] = Benchmark(
                    code, name, desc, timeout, total, scoring, profile, rules, about, judges,
                    objection_time or 0.0, sheet, protest_time or 0.0)
                self._warn_of_limits(self.by_code[code], got)
        return code if isinstance(node, Mapping) and node.whole else None

    def _sheet(self, got: Dict[str, Node], total: Optional[float], sheets: int) -> Sheet:
        """Read the sheet of a benchmark. `sheets`: of so many judges."""
        report = self._report
        limit_s = None if total is None or total == NO_LIMIT else Decimal(str(total))
        if "scoring" in got:
            sheet = read_sheet(report, as_sheet(report, got["scoring"]), None, limit_s, sheets)
            has_clock = any(item.amount is Measure.CLOCK for item in sheet.items)
            return replace(sheet, limit_s=None, clock_s=total if has_clock else None)  # no mark was late
        sheet = read_sheet(report, got.get("sheet"), got.get("incidents"), limit_s, sheets)
        late = one_of(report, got.get("late_marks"), "late_marks", _LATE_MARKS, "what marks after the time limit do")
        return replace(sheet, limit_s=None, clock_s=total) if late and limit_s is not None else sheet

    def _warn_of_limits(self, benchmark: Benchmark, got: Dict[str, Node]) -> None:
        """Warn about limits that have no effect."""
        code, timeout, total = benchmark.code, benchmark.timeout, benchmark.total_timeout
        is_unused = total > timeout or total < timeout == NO_LIMIT
        if is_unused and benchmark.kind is not BenchmarkKind.FUNCTIONALITY:
            warning = (f"timeout {_limit_text(timeout)} of {code} is not used: a benchmark without goals ends by its "
                       f"total_timeout {_limit_text(total)}")
            self._report.warn(got["timeout"].place, warning)
        limits = [phase.limit for phase in benchmark.rules.phases]
        if limits and sum(limits) > total and NO_LIMIT not in limits:
            self._report.warn(got["phases"].place, f"the phases of {code} take {sum(limits):g} s together: its "
                              f"total_timeout {total:g} ends the run earlier")

    def _rules(self, got: Dict[str, Node], kind: Optional[BenchmarkKind]) -> EventRules:
        """Read the rules about time and attempts."""
        report = self._report
        found: Dict[str, Any] = {
            "setup_time": _timeout(report, got, "setup_time", infinity=""),
            "attempts": integer(report, got.get("attempts"), "attempts", 1, MAX_ATTEMPTS),
            "phases": self._phases(got.get("phases"), kind),
        }
        for key, name, words in (
            ("attempt_counts", "counting", {each.value: each for each in CountingAttempt}),
            ("restarts", "restarts", {each.value: each for each in Restarts}),
            ("pause", "pause", _PAUSE),
            ("no_show", "absent", _NO_SHOW),
        ):
            found[name] = one_of(report, got.get(key), key, words, _RULES[key])
        return EventRules(**{name: value for name, value in found.items() if value is not None})

    def _about(self, node: Node) -> Tuple[Tuple[str, str], ...]:
        """Read the texts for spectators: one text, which is English, or one for each language."""
        report = self._report
        if not isinstance(node, Mapping):
            words = text(report, node, "about", _MAX_ABOUT_BYTES)
            return () if words is None else ((_DEFAULT_LANGUAGE, words),)
        found: List[Tuple[str, str]] = []
        for key, value in node.pairs:
            if not _LANGUAGE.fullmatch(key.text):
                report.error(key.place, f"{describe(key)} as a language of about", "a language such as en or de")
            words = text(report, value, f"about in {quote(key.text)}", _MAX_ABOUT_BYTES)
            if words is not None:
                found.append((key.text, words))
        return tuple(found)

    def _judges(self, node: Node) -> Optional[JudgesRule]:
        """Read how many judges score, and how their sheets become one; None after an error in their number."""
        report = self._report
        what = "judges of a benchmark"
        if not isinstance(node, Mapping):
            count = integer(report, node, what, MIN_JUDGES, MAX_JUDGES)
            return None if count is None else JudgesRule(count)
        got = fields(report, node, what, _JUDGES, _JUDGES_OPTIONAL) or {}
        count = integer(report, got.get("count"), f"count of {what}", MIN_JUDGES, MAX_JUDGES)
        rule = one_of(report, got.get("rule"), f"rule of {what}", _AGREEMENTS, "how their sheets become one")
        return None if count is None else JudgesRule(count, rule or Agreement.ALL_AGREE)

    def _phases(self, node: Optional[Node], kind: Optional[BenchmarkKind]) -> Tuple[PhaseRule, ...]:
        """Read the phases of a task benchmark."""
        report = self._report
        if isinstance(node, Sequence) and node.items and kind is not None and kind is not BenchmarkKind.TASK:
            report.error(node.place, f"phases in a benchmark of kind '{kind.value}'", "phases in a task only")
            return ()
        places: Dict[str, Place] = {}

        def phase(each: Node) -> Optional[PhaseRule]:
            got = fields(report, each, "a phase", _PHASE, _PHASE_OPTIONAL) or {}
            name, limit = text(report, got.get("name"), "name of a phase"), _timeout(report, got, "limit")
            if name is None:
                return None
            report.once(places, name, got["name"].place, f"a second phase {quote(name)}", "each name once")
            return PhaseRule(name, limit or NO_LIMIT)

        return all_of(report, node, "phases", _PHASES_SHAPE, phase)

    def _code(self, node: Optional[Node], is_new: bool) -> Optional[str]:
        """Read a code: one that the programs know or, with `is_new`, one that the file defines."""
        word = node.text if isinstance(node, Scalar) else ""
        if not is_new or word in PROFILES:
            expected = "a benchmark code, or the key 'kind' for a new one"
            return choice(self._report, node, "code", tuple(PROFILES), expected)
        code = text(self._report, node, "code")
        if code is None or node is None:
            return None
        if not CODE.fullmatch(code):
            found = f"{describe(node)} as code"
            return self._report.error(node.place, found, "a letter, then at most 31 letters, digits or '_'")
        if code.upper() in PROFILES:
            found = f"{describe(node)} as code"
            return self._report.error(node.place, found, f"'{code.upper()}', or a code that is not so similar to it")
        return code

    def _profile(self, code: Optional[str], got: Dict[str, Node]) -> Optional[Profile]:
        """Read what the programs must know of a benchmark; None after an error."""
        report = self._report
        known = None if code is None else PROFILES.get(code)
        kind = None if known is None else known.kind
        if "kind" in got:
            kind = one_of(report, got["kind"], "kind", _KINDS, "a kind of benchmark")
        if code is not None:
            self.kinds[code] = kind
        uses = self._uses(got["uses"]) if "uses" in got else frozenset() if known is None else known.uses
        offline_data, beacon = (one_of(report, got.get(name), name, _REQUIRED, expected) is not False
                                for name, expected in _DEMANDS.items())
        if "timed_out_goal" in got and kind is not None and kind is not BenchmarkKind.FUNCTIONALITY:
            report.error(got["timed_out_goal"].place, f"timed_out_goal in a benchmark of kind '{kind.value}'",
                         "it in a functionality benchmark only: the others have no goals")
            return None
        goal = one_of(report, got.get("timed_out_goal"), "timed_out_goal", _TIMED_OUT_GOAL,
                      "what a goal counts as when its timeout is over")
        if kind is None:
            return None
        profile = replace(known or new_profile(kind), kind=kind, uses=uses, offline_data=offline_data,
                          beacon=beacon)
        return profile if goal is None else replace(profile, runs_until_timeout=goal)

    def _uses(self, node: Node) -> FrozenSet[str]:
        """Read what robots may use. An empty sequence is valid."""
        if isinstance(node, Sequence) and not node.items:
            return frozenset()
        places: Dict[str, Place] = {}

        def use(each: Node) -> Optional[str]:
            word = choice(self._report, each, "an entry of uses", USES, "what a robot may use")
            if word is not None:
                self._report.once(places, word, each.place, f"{quote(word)} again in uses", "each once")
            return word

        return frozenset(all_of(self._report, node, "uses", f"some of {', '.join(USES)}, or []", use))


def _is_plain(sheet: Sheet, scoring: Iterable[ScoringItem]) -> bool:
    """Whether a sheet before 2026-12 has items only: such a one has no rules, and records are without it."""
    return all(row.is_plain for row in scoring) and all(
        item.least is item.most is None and item.amount is not Measure.CLOCK for item in sheet.items)


def _timeout(report: Report, got: Dict[str, Node], key: str, infinity: str = NO_LIMIT_TEXT) -> Optional[float]:
    return number(report, got.get(key), key, unit="seconds", above=0, most=MAX_TIMEOUT_S, infinity=infinity)


def _limit_text(seconds: float) -> str:
    return NO_LIMIT_TEXT if seconds == NO_LIMIT else f"{seconds:g}"


# -- the passwords file -----------------------------------------------------------------------------

# Names travel in the beacon, which must fit in one datagram (docs/protocol.md, "Frame").
MAX_TEAM_BYTES = 100

_PASSWORDS_SHAPE = "a line 'team: password' for each team"


class PasswordsFile:
    """Passwords by team, and the teams of all its lines.

    `teams` includes the teams of lines with errors. It is None if the file, or the name of a team, cannot be read:
    then any team may be in it.
    """

    def __init__(self, path: str, report: Report) -> None:
        self.path = path
        self.by_team: Dict[str, str] = {}
        self.teams: Optional[Set[str]] = None
        self._report = report
        what = "the passwords file (parameter passwords_file)"
        root = read_yaml(path, report, what, _PASSWORDS_SHAPE, secret=True)
        self._warn_if_readable(path)
        if root is None or isinstance(root, Unusable):
            return
        if not isinstance(root, Mapping):
            report.error(root.place, f"{describe(root)} as the file's content", _PASSWORDS_SHAPE)
            return
        if not root.pairs and root.whole:
            report.error(root.place, "no teams", _PASSWORDS_SHAPE)
        readable = [self._line(key, value) for key, value in root.pairs]
        places = {key.text: key.place for key, _ in root.pairs}
        _warn_of_twins(report, "team", {team: places[team] for team in self.by_team})
        if root.whole and readable and all(readable):
            self.teams = {key.text for key, _ in root.pairs}

    def _line(self, key: Scalar, value: Node) -> bool:
        """Read one team's line. Return whether its team is certain.

        Errors do not show the name: if a colon or a space is missing, the name contains the password.
        """
        if ":" in key.text:
            expected = "'team: password' with a space after the colon"
            self._report.error(key.place, "a colon in a team's name", expected)
            return False
        team = text(self._report, key, "team's name", MAX_TEAM_BYTES)
        if team == ALL_TEAMS:
            found = f"{ALL_TEAMS} as team's name"
            self._report.error(key.place, found, f"another name: in the schedule, {ALL_TEAMS} means all robots")
        password = text(self._report, value, "password")
        if team is not None and password is not None:
            self.by_team[team] = password
        # "Team password:" has no value.
        return team not in (None, ALL_TEAMS) and not (isinstance(value, Scalar) and not value.text)

    def _warn_if_readable(self, path: str) -> None:
        try:
            mode = linux.open_to_others(path)
        except (OSError, ValueError):
            return  # reported when it was read
        if mode:
            remedy = f"chmod 600 {shlex.quote(path)}"
            self._report.warn(
                Place(path, 0, 0),
                f"other users of this computer can read the passwords (mode {mode:04o}); remedy: {remedy}",
            )


def _warn_of_twins(report: Report, what: str, places: Dict[str, Place]) -> None:
    """Warn of names that are probably one name in two spellings."""
    for name, other in twins(places):
        report.warn(places[name], f"{what} {quote(name)} is nearly the same as {what} {quote(other)}. To the box they "
                    f"are two {what}s: if they are one, give it one spelling")


# -- the schedule file ------------------------------------------------------------------------------

_ZONES_SHAPE = "zones, '- zone: ...' with 'schedule: ...'"
_ZONE = {"zone": "Task Benchmarks", "schedule": "[...]"}
ZONE_SHAPE = "a name such as Asia/Tokyo, UTC, or the offset from UTC, such as +01:00"
_SETTING = {"durable": Durable.TWO.value, "time_zone": "Asia/Tokyo"}
_EVENT = {
    "benchmark": "HGTKMH",
    "team": "TestingTeam",
    "round": "1",
    "run": "1",
    "scheduled_time": "2015-12-31 14:30:00",
}
_EVENT_OPTIONAL = {"id": "k3x9w2mq"}
# `uint8` on the ROS interface; counted from 1.
MAX_ROUND = 255

_Run = Tuple[str, str, int, int]


class ScheduleSettings:
    """What a schedule file sets beside its zones."""

    def __init__(self, report: Report) -> None:
        self.durable = Durable.ONE
        self.durable_at: Optional[Place] = None
        self.time_zone = ""  # of the venue; empty: not set
        self._report = report
        self._places: Dict[str, Place] = {}

    def take(self, node: Node) -> bool:
        """Read the entry if it is a setting and no zone; returns whether it is."""
        keys = [key.text for key, _ in node.pairs] if isinstance(node, Mapping) else []
        if not keys or nearest(keys[0], (*_ZONE, *_SETTING)) not in _SETTING:
            return False
        report = self._report
        got = fields(report, node, "a setting", {}, _SETTING) or {}
        for key in got:
            report.once(self._places, key, node.place, f"the setting '{key}' again", "each setting once")
        if "durable" in got:
            words = {each.value: each for each in Durable}
            found = one_of(report, got["durable"], "durable", words,
                           f"on how many computers an entry must be before it is confirmed, {' or '.join(words)}")
            self.durable, self.durable_at = found or Durable.ONE, node.place
        if "time_zone" in got:
            name = text(report, got["time_zone"], "time_zone")
            if name is not None and zone_of(name) is None:
                report.error(got["time_zone"].place, f"{quote(name)} as time_zone", ZONE_SHAPE)
            self.time_zone = name or ""
        return True


def settings_in(schedule_file: str) -> ScheduleSettings:
    """What a schedule file sets, whatever else is wrong there."""
    found, report = ScheduleSettings(Report()), Report()
    root = read_yaml(schedule_file, report, "the schedule file", "")
    for node in root.items if isinstance(root, Sequence) else ():
        found.take(node)
    return found


class ScheduleFile:
    """The file's zones, checked against the benchmarks and teams of the two other files."""

    def __init__(
        self, path: str, report: Report, benchmarks: BenchmarksFile, passwords: Optional[PasswordsFile]
    ) -> None:
        """`passwords`: None if the teams are not to be checked."""
        self.zones: Tuple[ZonePlan, ...] = ()
        self.settings = ScheduleSettings(report)
        self._report = report
        self._benchmarks = benchmarks
        self._passwords = passwords
        self._zone_places: Dict[str, Place] = {}
        self._run_places: Dict[_Run, Place] = {}
        self._id_places: Dict[str, Place] = {}
        self._codes_not_described: Dict[str, List[Place]] = {}
        self._teams_without_password: Dict[str, List[Place]] = {}
        what = "the schedule file (parameter schedule_file)"
        root = read_yaml(path, report, what, f"a sequence of {_ZONES_SHAPE}")
        nodes = sequence(report, root, "the file's content", _ZONES_SHAPE) or ()
        of_zones = [node for node in nodes if not self.settings.take(node)]
        if nodes and not of_zones:
            report.error(nodes[0].place, "no zone", f"a sequence of {_ZONES_SHAPE}")
        zones = [self._zone(node) for node in of_zones]
        self._report_unknown()
        _warn_of_twins(report, "zone", self._zone_places)
        self.zones = adopted(tuple(zone for zone in zones if zone is not None), ())

    def _zone(self, node: Node) -> Optional[ZonePlan]:
        got = fields(self._report, node, "a zone", _ZONE, {})
        if got is None:
            return None
        name = text(self._report, got.get("zone"), "zone")
        if name is not None:
            found = f"a second zone {quote(name)}"
            self._report.once(self._zone_places, name, got["zone"].place, found, "each zone once")
        what = "schedule" if name is None else f"schedule of zone {quote(name)}"
        shape = "at least one event, '- {benchmark: ..., team: ..., and so on}'"
        nodes = sequence(self._report, got.get("schedule"), what, shape) or ()
        events = [event for event in map(self._event, nodes) if event is not None]
        return None if name is None else ZonePlan(name, tuple(sorted(events, key=lambda e: e.scheduled)))

    def _event(self, node: Node) -> Optional[ScheduledEvent]:
        """Read one event; None if anything is wrong with it."""
        report = self._report
        got = fields(report, node, "an event", _EVENT, _EVENT_OPTIONAL)
        if got is None:
            return None
        code = self._code(got.get("benchmark"))
        team = text(report, got.get("team"), "team")
        number = integer(report, got.get("round"), "round", 1, MAX_ROUND)
        run = integer(report, got.get("run"), "run", 1, MAX_ROUND)
        scheduled = utc_time(report, got.get("scheduled_time"), "scheduled_time")
        if code is not None and self._benchmarks.codes is not None and code not in self._benchmarks.codes:
            self._codes_not_described.setdefault(code, []).append(got["benchmark"].place)
        if team is not None:
            self._check_team(code, team, got["team"].place)
        if code is None or team is None or number is None or run is None:
            return None
        self._warn_of_twin((code, team, number, run), node.place)
        own = self._id(got["id"]) if "id" in got else ""
        benchmark = self._benchmarks.by_code.get(code)
        if benchmark is None or scheduled is None or own is None:
            return None
        event = ScheduledEvent(benchmark, team, number, run, scheduled, own)
        return event if own else replace(event, id=known_by(event, ()), id_goes=node.place)

    def _id(self, node: Node) -> Optional[str]:
        """Read the id of an event; None after an error."""
        word = text(self._report, node, "id")
        if word is None:
            return None
        if not VALID.fullmatch(word):
            return self._report.error(node.place, f"{describe(node)} as id",
                                      "a letter, then at most 39 letters, digits, '_' or '-'; or no key 'id'")
        self._report.once(self._id_places, word, node.place, f"id {quote(word)} again",
                          "each id once: delete the key 'id' in the new event, and the next reload writes another")
        return word

    def _code(self, node: Optional[Node]) -> Optional[str]:
        """Read a code. If the codes of the benchmarks file are unknown, it may be a new one."""
        if (isinstance(node, Scalar) and self._benchmarks.codes is None and CODE.fullmatch(node.text)
                and nearest(node.text, PROFILES) is None):
            return node.text
        return choice(self._report, node, "benchmark", tuple(self._benchmarks.kinds), "a benchmark code")

    def _check_team(self, code: Optional[str], team: str, place: Place) -> None:
        """Check that only a benchmark of all robots has the team ALL, and that every other team has a password."""
        kind = None if code is None else self._benchmarks.kinds.get(code)
        if team == ALL_TEAMS:
            if kind is not None and kind is not BenchmarkKind.ALL_ROBOTS:
                self._report.error(place, f"team {ALL_TEAMS} in {code}", "the name of one team")
            return
        if kind is BenchmarkKind.ALL_ROBOTS:
            found = f"team {quote(team)} in {code}"
            self._report.error(place, found, f"team {ALL_TEAMS}: all robots do it at once")
        elif self._passwords is not None and self._passwords.teams is not None and team not in self._passwords.teams:
            self._teams_without_password.setdefault(team, []).append(place)

    def _warn_of_twin(self, run: _Run, place: Place) -> None:
        first = self._run_places.setdefault(run, place)
        if first is not place:
            code, team, number, run_number = run
            self._report.warn(
                place,
                f"{code}, team {quote(team)}, round {number}, run {run_number} is already in line "
                f"{first.line}: give each run a number of its own, or their logs and results look alike",
            )

    def _report_unknown(self) -> None:
        """Report each unknown name once, with all lines that use it."""
        file = self._benchmarks.path
        for code, places in self._codes_not_described.items():
            found = f"benchmark {quote(code)}{_also(places)}, which is not in {file}"
            codes = ", ".join(sorted(self._benchmarks.codes or ()))
            self._report.error(places[0], found, f"one that is there ({codes}), or an entry for it there")
        if self._passwords is None:
            return
        file = self._passwords.path
        for team, places in self._teams_without_password.items():
            # The suggestion must not show a password: only names that are certain to be teams are candidates.
            near = nearest(team, self._passwords.by_team)
            guess = f": did you mean {quote(near)}?" if near else ", or a line 'team: password' for it"
            found = f"team {quote(team)}{_also(places)}, which is not in {file}"
            self._report.error(places[0], found, f"a team of that file{guess}")


def _also(places: List[Place]) -> str:
    """The other lines with the same mistake."""
    return f" (also in line {line_list([place.line for place in places[1:]])})" if places[1:] else ""
