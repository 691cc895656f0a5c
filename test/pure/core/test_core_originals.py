"""What the original box and earlier versions did, recorded: the box answers the original client as it did, sooner; and
competitions with configuration files of 2015 and 2019 have the same sheets and messages, byte for byte.

`test/data/README.md` says which version wrote the expected files.
"""

import itertools
import json

import pytest

from helpers.box_driver import BoxDriver
from helpers.forms import form
from helpers.golden import DATA
from helpers.module_player import ScriptedModules
from helpers.recorded_session import Replay, goals_of, waypoint
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.effects import SetDevice
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.model.records import EndReason, ItemRecord, Phase, RunRecord, ScoreEntry
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.registry import BenchmarkKind


@pytest.mark.parametrize("name, code", [
    ("HGTKMH_2015", "HGTKMH"), ("HGTKMH_2020", "HGTKMH"), ("HCFGAC_2015", "HCFGAC"),
])
def test_the_box_reaches_the_same_states_sooner(name, code):
    replay = Replay(name, code)
    assert replay.refused == []
    assert [state for _, state in replay.ours] == [state for _, state in replay.originals] == [
        BoxState.STOP, BoxState.PREPARE, BoxState.WAITING_RESULT, BoxState.STOP
    ]
    assert all(ours <= original for (ours, _), (original, _) in zip(replay.ours, replay.originals))
    assert replay.run.end_reason is EndReason.COMPLETED
    run = replay.driver.run_in()
    assert run is None or run.phase is Phase.ENDED  # one recording ends with a stop after the end
    assert replay.run.link.times_valid


@pytest.mark.parametrize("name, code, script", [
    ("HNF_2020", "HNF", [waypoint(goal) for goal in goals_of("HNF_2020")]),
    ("STB_2020", "STB", [
        (RequestKind.REFEREE, {"text": "First Manual Operation"}),
        *((RequestKind.GOAL, {"goal": goal, "timeout": 15.0}) for goal in goals_of("STB_2020")),
        (RequestKind.REFEREE, {"text": "Last Manual Operation"}),
    ]),
])
def test_a_functionality_benchmark_reaches_the_same_states_sooner(name, code, script):
    replay = Replay(name, code, timeout=600.0, script=script)
    goals = sum(kind is RequestKind.GOAL for kind, _ in script)
    assert goals >= 2
    assert replay.refused == []
    assert [state for _, state in replay.ours] == [state for _, state in replay.originals] == [
        BoxState.STOP, *[BoxState.PREPARE, BoxState.GOAL_TX, BoxState.WAITING_RESULT] * goals, BoxState.STOP
    ]
    # A manual operation is over when the referee says so; the recording has that a little late.
    assert all(ours <= original + 0.01 for (ours, _), (original, _) in zip(replay.ours, replay.originals))
    assert replay.run.end_reason is EndReason.COMPLETED
    assert [step.outcome.result for step in replay.run.steps if step.request.kind is RequestKind.GOAL] == [
        "SOME RESULT" if code == "STB" else ""
    ] * goals


def test_a_timeout():
    """The original allowed another start after it, which is refused here (docs/protocol.md, "State machines")."""
    replay = Replay("TIMEOUT_2015", "HGTKMH", timeout=5.0)
    assert replay.run.end_reason is EndReason.TIMEOUT
    originals = list(itertools.islice(replay.originals, 4))
    assert [state for _, state in replay.ours] == [state for _, state in originals]
    assert all(ours <= original for (ours, _), (original, _) in zip(replay.ours, originals))
    assert replay.refused[0] == ("start", ["The run ended by timeout: disconnect, and connect for a new run"])


def test_a_2015_clients_devices_tablet_and_final_command():
    replay = Replay("HCFGAC_2015", "HCFGAC")
    assert replay.driver.taken(SetDevice) == [
        # It always sends all of them: so its first word on each counts, from its second message on.
        *(("tbm", device, value) for device, value in (
            ("switch_1", 1), ("switch_2", 0), ("switch_3", 0), ("dimmer", 0), ("blinds", 0), ("dimmer", 70),
            ("blinds", 100),  # when the run was over, and not left yet
        )),
    ]
    assert replay.driver.box.tablet.state.display_map is True
    assert replay.driver.logged(replay.port, "/command") == ["open the blinds"]


# Texts for people, which may be reworded.
TEXTS = (run_log.STATE_DESC,)
FILES = DATA / "old_configurations"
GOAL, REFEREE, SWITCHES = RequestKind.GOAL, RequestKind.REFEREE, RequestKind.SWITCHES
# What the benchmarking module of each benchmark asks for. The robot lets the last goal time out.
SCRIPTS = {
    "HOPF": [(REFEREE, {"text": "Place the item"}), *[(GOAL, {"text": "item", "timeout": 120.0})] * 2],
    "HOMF": [
        (GOAL, {"text": "switches", "initial_state": (True, False), "switches": (2,), "timeout": 120.0}),
        (SWITCHES, {"text": "Enter the switches"}),
    ],
    "STB": [
        (REFEREE, {"text": "First Manual Operation"}), (GOAL, {"text": "GOAL 1", "goal": "GOAL 1", "timeout": 15.0}),
        (GOAL, {"text": "GOAL 2", "goal": "GOAL 2", "timeout": 15.0}),
    ],
    "HNF": [(GOAL, {"goal": f"[{x}.5, 2.0, 0.25]", "pose": (x + 0.5, 2.0, 0.25), "timeout": 120.0}) for x in (1, 2)],
    "HPPF": [(REFEREE, {"text": "Ask Annie to enter", "form": form("yes", "no")}), (GOAL, {"timeout": 120.0})],
    "HPFF": [(GOAL, {"timeout": 300.0})],
    "HGMF": [(GOAL, {"goal": "[0.5, 0.25, 3]", "pose": (0.5, 0.25, 0.0), "timeout": 120.0})],
}
RESULTS = {
    "HOPF": {"object_class": "cups", "object_name": "red_cup", "object_pose_x": 0.5, "object_pose_y": 1.0,
             "object_pose_theta": 0.25},
    "HPPF": {"generic_result": "{person_name: Annie, x: 0.5, y: 1.0, theta: 0.0}"},
    "STB": {"generic_result": "SOME RESULT"},
}
# A robot that uses everything in every benchmark.
ACTIONS = (
    {"notifications": ("on my way",)}, {"activation_event": ("the bell",)}, {"visitor": ("Deli Man",)},
    {"final_command": ("light",)}, {"dimmer": 70}, {"switch_1": True, "dimmer": 70}, {"display_map": True},
)


class Played:
    """Conduct all runs of the schedule in sequence."""

    def __init__(self, tmp_path, year):
        passwords = tmp_path / "passwords.yaml"
        passwords.write_text("TestingTeam: PASSWORD\n")
        passwords.chmod(0o600)
        self.configuration, warnings = config.load(
            str(FILES / f"{year}_benchmarks.yaml"), str(FILES / f"{year}_schedule.yaml"), str(passwords))
        assert warnings == []
        self.driver = BoxDriver(self.configuration, Settings(listen_duration=0.0))
        self.robot = self.driver.robot("TestingTeam")
        self.states, self.logs = {}, {}
        (zone,) = self.configuration.zones
        self.zone = zone.name
        for event in zone.events:
            self._play(event)

    def _play(self, event):
        driver, robot, code = self.driver, self.robot, event.benchmark.code
        script = SCRIPTS[code] if event.benchmark.kind is BenchmarkKind.FUNCTIONALITY else None
        modules = None if script is None else ScriptedModules(driver, code, script)
        self._see(modules)
        robot.state = RobotState.STOP
        robot.beacon(3)
        self._see(modules)
        driver.command("connect", self.zone)
        run = driver.run_in(self.zone)
        robot.port = (run.members() if hasattr(run, "members") else [run])[0].port
        robot.says(RobotState.STOP)
        self._see(modules)
        driver.command("start", self.zone)
        for item in event.benchmark.scoring:
            driver.score(item.group, item.desc, 1, self.zone)
        self._see(modules)
        if modules is None:
            self._goal(None, {})
        else:
            for number, (kind, _) in enumerate(script):
                self._see(modules)
                if kind is GOAL:
                    self._goal(modules, None if 0 < number == len(script) - 1 else RESULTS.get(code, {}))
                elif kind is REFEREE:
                    driver.event(driver.box.act, Target(self.zone), "operation")
                else:
                    driver.event(driver.box.act, Target(self.zone), "switch", "", {"number": 2})
                    driver.event(driver.box.act, Target(self.zone), "confirm_switches")
        self._see(modules)
        robot.says(RobotState.STOP)
        self._see(modules)
        driver.command("disconnect", self.zone)
        self.states[code] = [message.lines() for message in self._changes(driver.states[robot.port])]
        self.logs[code] = driver.bags[robot.port]
        self._see(modules)

    def _goal(self, modules, result):
        """The robot does a goal; `result` None: it lets the goal time out."""
        for state in (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING):
            self.robot.says(state)
        for action in ACTIONS:
            self.robot.says(**action)
        self._see(modules)
        if result is None:
            for _ in range(130):
                self._beat(modules)
                self.robot.says(after=1.0)
        else:
            self.robot.says(RobotState.RESULT_TX, after=2.0, **result)

    @staticmethod
    def _changes(messages):
        return [message for number, message in enumerate(messages) if not number or message != messages[number - 1]]

    def _beat(self, modules):
        if modules is not None:
            modules.proceed()

    def _see(self, modules):
        self._beat(modules)
        self.driver.run(0.25)

    def content(self):
        """What robots, run logs and sheets get of each benchmark. Texts for the referee may be reworded."""
        records = {record.benchmark: record for record in self.driver.box.finished.records()}
        return {event.benchmark.code: {
            "timeouts": [event.benchmark.timeout, event.benchmark.total_timeout],
            "states": self.states[event.benchmark.code],
            "log": [[topic, value] for topic, value in self.logs[event.benchmark.code] if topic not in TEXTS],
            "record": _as_then(records[event.benchmark.code]),
        } for event in self.configuration.zones[0].events}


def _as_then(record):
    """A record with the fields that it had when the expected files were written. The others have their defaults."""
    now, later = record._asdict(), ("points", "form")
    assert [now.pop(field) for field in later] == [None, None]
    assert now.pop("event") and now.pop("timeline")
    now["stops"] = [stop[:-1] for stop in now["stops"]]  # without the run's clock
    for field in ("judging", "publication"):
        assert now.pop(field) == RunRecord._field_defaults[field]
    now["history"] = [entry._replace(clock_s=None) for entry in now["history"]]
    for field, kind, count in (("items", ItemRecord, 6), ("history", ScoreEntry, 15)):
        assert all(kind(*line[:count]) == line for line in now[field])
        now[field] = [line[:count] for line in now[field]]
    return now


@pytest.mark.parametrize("year", ["2015", "2019"])
def test_sheets_and_messages_stay_as_they_were(year, tmp_path):
    content = json.loads(json.dumps(Played(tmp_path, year).content()))
    expected = json.loads((FILES / f"{year}_expected.json").read_text(encoding="utf-8"))
    assert content.keys() == expected.keys()
    for code in expected:
        record = content[code]["record"]
        for field in record.keys() - expected[code]["record"].keys():  # rules that these configurations do not have
            assert not record.pop(field) or field == "marks", (code, field)  # of marks that have an identity
        assert content[code] == expected[code], code
