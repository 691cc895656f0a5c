"""Replays sessions of the original box and client: our robot sends what the original client sent."""

import itertools

import pytest

from helpers.golden import PASSWORD, SESSIONS, load
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.comm.frame import decode_private, decode_public
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.session import Session

BOX = "10.99.0.1"
PUBLIC_PORT = 6666


def _recording(name):
    """(time, host of the sender, port, message) of a recorded session, in order."""
    key = Key(PASSWORD)
    for record in load(name):
        datagram = bytes.fromhex(record["hex"])
        public = record["dport"] == PUBLIC_PORT
        message = decode_public(datagram) if public else decode_private(datagram, key)
        yield record["t_rel"], record["src"], record["dport"], message


def _time(time):
    return time.sec, time.nsec


class Replay:
    """Our session in the place of the original client, whose owner's decisions it repeats."""

    def __init__(self, name):
        self.records = list(_recording(name))
        self.now = self.records[0][0]
        self.session = Session("TestingTeam", "TestingRobot", self.now)
        self.session.progress.messages_saved = 1
        self.states = [RobotState.STOP]  # ours, each change
        self.goals, self.channels, self.reports = [], [], []
        self.effects = []  # all
        self.sent = None  # our last RobotState
        self._times = {}  # time of an original RobotState -> time of ours at that moment

    def run(self, on_original):
        """Replay all; `on_original(replay, message)` at each of the original client's states."""
        for when, host, port, message in self.records:
            self._pass_time(when)
            if host == BOX:
                self._from_box(port, message)
            elif isinstance(message, pb.RobotState):
                on_original(self, message)
                self.poll()
                self._times[_time(message.time)] = self.sent.time
        self._pass_time(self.now + 2)
        return self

    def _from_box(self, port, message):
        if port == PUBLIC_PORT:
            self.session.public_message(self.now, message, (BOX, port))
        elif self.channels and self.channels[-1] == (BOX, port):
            acknowledged = self._times.get(_time(message.acknowledgement))
            if acknowledged is not None:
                message.acknowledgement.CopyFrom(acknowledged)
            self.session.private_message(self.now, message, (BOX, port))
        self.poll()

    def _pass_time(self, until):
        while self.session.deadline() < until:
            self.now = max(self.now, self.session.deadline())
            self.poll()
        self.now = until

    def poll(self):
        for effect in self.session.poll(self.now, 1.8e9 + self.now):
            self.effects.append(effect)
            if isinstance(effect, fx.StateIs):
                self.states.append(effect.state)
            elif isinstance(effect, fx.Execute):
                self.goals.append(effect.goal)
            elif isinstance(effect, fx.OpenChannel):
                self.channels.append((effect.host, effect.port))
            elif isinstance(effect, fx.CloseChannel):
                self.channels.append(None)
            elif isinstance(effect, fx.ProblemIs):
                self.reports.append(effect)
            elif isinstance(effect, fx.SendState):
                self.sent = effect.message


def _complete_as_the_original_did(replay, original):
    """The owner's part: end preparation and goal when the original client's owner did."""
    state = replay.session.progress.state
    if (state, original.robot_state) == (RobotState.PREPARING, pb.RobotState.WAITING_GOAL):
        replay.session.end_prepare()
    elif (state, original.robot_state) == (RobotState.EXECUTING, pb.RobotState.RESULT_TX):
        replay.session.end_execute(original.generic_result or None)


@pytest.mark.parametrize("name", SESSIONS)
def test_the_same_states_at_the_same_events(name):
    compared = []

    def compare(replay, original):
        _complete_as_the_original_did(replay, original)
        assert replay.session.progress.state == original.robot_state, f"at {replay.now:.3f} s"
        replay.poll()
        assert replay.sent.generic_result == original.generic_result
        compared.append(original.robot_state)

    replay = Replay(name).run(compare)
    original_changes = [
        RobotState(state) for before, state in zip([RobotState.STOP, *compared], compared) if before != state
    ]
    assert replay.states == [RobotState.STOP, *original_changes]
    assert len(original_changes) >= 5
    assert replay.reports == []
    # One channel, where the original client had it, dropped when the box did not list it any more.
    port = next(port for _, host, port, _ in replay.records if host != BOX and port != PUBLIC_PORT)
    assert replay.channels == [(BOX, port), None]


def _news(values):
    """Values without repetitions one after the other: a topic only publishes changes."""
    return [value for value, _ in itertools.groupby(values)]


def _from_original_box(name):
    """Return (public, fields) of the original box's messages, as decoded in the recording."""
    for record in load(name):
        if record["src"] == BOX:
            yield record["dport"] == PUBLIC_PORT, record["decoded"]["fields"]


def _wire_time(time):
    return int(time["sec"]), int(time["nsec"])


# What the node's documentation calls the robot's states on its topic.
PUBLISHED_AS = {
    RobotState.STOP: "STOP", RobotState.PREPARING: "PREPARE", RobotState.WAITING_GOAL: "PREPARE",
    RobotState.EXECUTING: "EXECUTE", RobotState.RESULT_TX: "EXECUTE",
}
# The states of each session's robot, in the words of that topic. It begins with STOP.
ONE_GOAL = ["STOP", "PREPARE", "EXECUTE", "STOP"]
PUBLISHED = {
    "HCFGAC_2015": ONE_GOAL, "HGTKMH_2015": ONE_GOAL, "HGTKMH_2020": ONE_GOAL,
    "HNF_2020": ["STOP", *["PREPARE", "EXECUTE"] * 5, "STOP"],
    "STB_2020": ["STOP", *["PREPARE", "EXECUTE"] * 2, "STOP"],
    # Timed out while executing, started again, and stopped while preparing.
    "TIMEOUT_2015": [*ONE_GOAL, "PREPARE", "STOP"],
}
STOPS = {"TIMEOUT_2015": 2}


@pytest.mark.parametrize("name", SESSIONS)
def test_the_robots_programs_hear_what_the_box_said(name):
    """What topics publish: the benchmark and its end, each state and goal once, and no unnecessary stop."""
    effects = Replay(name).run(_complete_as_the_original_did).effects
    code = next(sent["benchmark_type"] for public, sent in _from_original_box(name) if not public)
    run = [effect for effect in effects if isinstance(effect, (fx.BenchmarkIs, fx.StateIs))]
    assert run[0] == fx.BenchmarkIs(code)
    assert run[-1] == fx.BenchmarkIs(None)
    assert all(isinstance(effect, fx.StateIs) for effect in run[1:-1])
    assert _news(["STOP", *(PUBLISHED_AS[effect.state] for effect in run[1:-1])]) == PUBLISHED[name]
    executed = [effect.goal and effect.goal.text for effect in effects if isinstance(effect, fx.Execute)]
    sent = [state.get("generic_goal") for public, state in _from_original_box(name) if not public]
    assert executed == ([goal for goal in _news(sent) if goal] or [None])
    assert sum(isinstance(effect, fx.Stop) for effect in effects) == STOPS.get(name, 1)


@pytest.mark.parametrize("name", SESSIONS)
def test_the_home_is_published_when_it_changes(name):
    effects = Replay(name).run(_complete_as_the_original_did).effects
    beacons = [sent for public, sent in _from_original_box(name) if public]
    assert [effect for effect in effects if isinstance(effect, fx.Devices)] == _news(
        fx.Devices(
            _wire_time(sent["devices_bell"]), *(sent[f"devices_switch_{number}"] for number in (1, 2, 3)),
            sent["devices_dimmer"], sent["devices_blinds"], sent.get("devices_door_win_detect", False),
        ) for sent in beacons
    )
    assert [effect for effect in effects if isinstance(effect, fx.TabletIs)] == _news(
        fx.TabletIs(
            sent["tablet_display_map"], _wire_time(sent["tablet_call_time"]),
            _wire_time(sent["tablet_position_time"]), sent["tablet_position_x"], sent["tablet_position_y"],
        ) for sent in beacons
    )
    # The bell of HCFGAC_2015 rang before the robot was there; nobody touched a tablet.
    events = (fx.BellRang, fx.TabletCalled, fx.PositionSelected)
    assert not [effect for effect in effects if isinstance(effect, events)]


def test_the_waypoints_of_2020():
    replay = Replay("HNF_2020").run(_complete_as_the_original_did)
    assert [goal.pose for goal in replay.goals] == [
        (-2.125, -1.607, 1.558), (2.321, -3.407, 2.376), (1.734, 3.14, -0.023), (-3.108, 4.881, -1.526),
        (4.308, 3.194, 2.207),
    ]


def test_the_goals_of_the_test_benchmark():
    replay = Replay("STB_2020").run(_complete_as_the_original_did)
    assert [goal.text for goal in replay.goals] == [
        "details: 4\ngoal: GOAL 1\n", "details: 4\ngoal: GOAL 2\n"
    ]


def test_commands_and_online_data_of_2015():
    """The commands come at the same times as in the recording. From then on, both clients send the same."""
    fields = ("devices_switch_1", "devices_dimmer", "devices_blinds", "tablet_display_map")
    commanded = dict.fromkeys(fields)
    strings = {"ours": [[]], "original": [[]]}  # contents of final_command, each change

    def follow(replay, original):
        _complete_as_the_original_did(replay, original)
        for field in fields:
            value = getattr(original, field)
            if value != commanded[field]:
                if field == "tablet_display_map":
                    replay.session.display_map(value)
                else:
                    replay.session.set_device(field[len("devices_"):], value)
            commanded[field] = value
        if original.final_command and strings["original"] == [[]]:
            replay.session.add_string("final_command", original.final_command[0])
        replay.poll()
        assert {field: getattr(replay.sent, field) for field in fields} == commanded
        for whose, message in (("ours", replay.sent), ("original", original)):
            if strings[whose][-1] != list(message.final_command):
                strings[whose].append(list(message.final_command))

    Replay("HCFGAC_2015").run(follow)
    assert list(commanded.values()) == [True, 70, 100, True]
    assert strings["ours"] == strings["original"] == [[], ["open the blinds"], []]
