"""Random competitions: actions of robots, tablets, referees, other boxes and clocks in any order."""

import operator

from hypothesis import strategies as st

from helpers.commands import COMMANDS, given_with, mark_with
from helpers.competition import TEAMS, competition, event
from roah_rsbb.core.actions.table import Target
from roah_rsbb.model.messages import DevicesState, RobotReport, TabletState
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.protocol import RobotState
from roah_rsbb.scoring.sheet import Mark

ZONES = ("a", "b", "c", "all")
INT64 = st.integers(-(2**63), 2**63 - 1)
NAMES = st.sampled_from([*TEAMS, "", "nobody's", "x" * 200])
TEXTS = st.lists(st.sampled_from(["", "a", "b\n", "é" * 50]), max_size=3).map(tuple)
PERCENT = st.none() | st.integers(0, 2**32 - 1)
FLAG = st.none() | st.booleans()
PORTS = st.integers(6666, 6672)
HOSTS = st.sampled_from(["10.0.0.2", "10.0.0.3"])
# Seconds for which a datagram waited until the box read it; below 0: a clock was set meanwhile.
WAITED = st.sampled_from([0.0] * 4 + [0.01, 1.0, 10.0, 1e6, -3.0])


def _reports(times):
    return st.builds(
        RobotReport, times, st.integers(0, 2), st.sampled_from(RobotState), TEXTS, TEXTS, TEXTS, TEXTS,
        FLAG, FLAG, FLAG, PERCENT, PERCENT, FLAG,
    )


@st.composite
def _scores(draw, zone):
    """A referee's change of a score sheet. The run is "now" or "last", see `apply_event`."""
    name = RunName(zone, draw(st.sampled_from(["", "now", "now", "last", "x"])))
    group = draw(st.sampled_from(["Penalized", ""]))
    mark = Mark(group, "bumps", draw(INT64), draw(st.booleans()), draw(st.sampled_from(["", "note", "x" * 600])))
    mark_id = draw(st.sampled_from("abcdef"))
    once = Mark("Penalized", "bumps", added=draw(st.sampled_from(["1", "-1", "2", ""])), id=mark_id)
    return draw(st.sampled_from([
        *[("enter", (name, "mark", mark_with(mark)))] * 3, *[("enter", (name, "mark", mark_with(once)))] * 3,
        ("enter", (name, "withdraw", {"entry": draw(st.integers(-1, 4))})),
        ("enter", (name, "take_back", {"id": mark_id})), ("enter", (name, "sign_off", {})),
        ("enter", (name, "stop_reason", {"reason": "reason", "stop": draw(st.integers(-1, 3))})),
    ]))


@st.composite
def random_events(draw):
    """Method of the box, and its arguments; None for a time means now."""
    kind = draw(st.sampled_from(["command"] * 6 + ["report"] * 6 + ["beacon"] * 3 + ["score", "other", "pass", "set"]))
    zone = draw(st.sampled_from([*ZONES, "d"]))
    if kind == "command":
        command = draw(st.sampled_from(sorted(COMMANDS)))
        return "act", (Target(zone), command, "", given_with(command, draw(st.sampled_from([*TEAMS, ""]))))
    if kind == "report":
        return "arrivals.on_robot_report", (
            draw(PORTS), draw(HOSTS), draw(_reports(st.none() | st.tuples(INT64, INT64))), draw(WAITED))
    if kind == "beacon":
        team, robot = draw(NAMES), draw(st.sampled_from(["r1", "r2"]))
        time = draw(st.none() | st.tuples(INT64, INT64))
        return "arrivals.on_robot_beacon", (draw(HOSTS), team, robot, time, draw(WAITED))
    if kind == "score":
        return draw(_scores(zone))
    if kind == "pass":
        return "pass", (draw(st.sampled_from([0.0, 0.05, 1.0, 3.0, 20.0, 1000.0])),)
    if kind == "set":
        return "set", (draw(st.sampled_from([-1e9, -1.0, 1.0, 1e9])),)
    return draw(st.sampled_from([
        ("watches.trouble", ("bad",)), ("devices.on_state", (DevicesState(dimmer=5),)),
        ("arrivals.on_complaint", ("bad",)), ("arrivals.on_unreadable", (6667, "bad")),
        ("arrivals.on_foreign_box", ("10.0.0.9",)), ("arrivals.on_channel_failed", (6667, "in use")),
        ("arrivals.on_tablet", (
            "10.0.0.3", TabletState(True, (2**63 - 1, -1), (-(2**63), 0), float("nan"), float("inf")))),
        ("arrivals.on_tablet", ("10.0.0.4", TabletState(False, (5, 0), (7, 999_999_999), 1.5, -2.5))),
        ("act", (Target(zone), "operation")), ("act", (Target(zone), "confirm_switches")),
        ("act", (Target(zone), "switch", "", {"number": 1})), ("timers.tick", ()),
    ]))


def _meant(driver, name):
    """A run with its identity: the one in the zone, or the last one that is over."""
    zone, finished = driver.box.zones.get(name.zone), driver.box.finished.records()
    if name.identity == "now" and zone is not None and zone.run is not None:
        return name._replace(identity=zone.run.identity)
    if name.identity == "last" and finished:
        return RunName(finished[0].zone, finished[0].identity)
    return name


def apply_event(driver, name, arguments):
    if name == "pass":
        driver.run(*arguments)
        return
    if name == "set":
        driver.set_clock(*arguments)
        return
    now = driver.robot().time()
    if name == "arrivals.on_robot_report":
        port, host, report, waited = arguments
        report = report._replace(time=now if report.time is None else report.time)
        arguments = (port, host, report, driver.now.utc - waited)
    elif name == "arrivals.on_robot_beacon":
        arguments = (*arguments[:3], now if arguments[3] is None else arguments[3], driver.now.utc - arguments[4])
    try:
        if name == "enter":
            run, entry, given = arguments
            driver.enter(entry, _meant(driver, run), **given)
            return
        driver.event(operator.attrgetter(name)(driver.box), *arguments)
    except Refused as refused:
        assert refused.reasons and all(refused.reasons)


def random_competition():
    """Zones of all kinds. A robot may be needed in several of them."""
    return competition(
        a=["HCFGAC", "HWV"], b=[event("HGTKMH", team="Beta", timeout=30.0), event("HNF", team="Beta")], c=["HGTKMH"],
        all=[event("HSUF", team="ALL", timeout=30.0)],
    )
