"""Sessions of the original box and client (test/data), replayed with our box in the place of the original one."""

import yaml

from helpers.box_driver import MONO0, BoxDriver
from helpers.competition import competition, event
from helpers.golden import PASSWORD, load
from helpers.module_player import ScriptedModules
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.comm.frame import decode_private, decode_public
from roah_rsbb.core.actions.table import Target
from roah_rsbb.model.clock import Now
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.model.reason import Refused
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, wire_seconds
from roah_rsbb.radio import wire_convert

PUBLIC_PORT = 6666
ROBOT_HOST = "10.99.0.2"
COMMANDS = ("connect", "start", "stop", "disconnect")
OPERATION = "manual_operation_complete"


def _sessions_acts(name):
    """(time, what) in order: a message and its sender's host, or a command of the referee."""
    key = Key(PASSWORD)
    acts = []
    for record in load(name):
        datagram = bytes.fromhex(record["hex"])
        public = record["dport"] == PUBLIC_PORT
        message = decode_public(datagram) if public else decode_private(datagram, key)
        acts.append((record["t_rel"], (message, record["src"])))
    acts += [(e["t_rel"], e["step"]) for e in load(f"{name}.events") if e.get("step") in (*COMMANDS, OPERATION)]
    return sorted(acts, key=lambda act: act[0])


class Replay:
    """Our box in the place of the original one."""

    def __init__(self, name, code, timeout=120.0, script=None, make=BoxDriver):
        """`make`: makes the driver of a competition's box."""
        self.driver = make(competition(teams=["TestingTeam"], tbm=[
            event(code, team="TestingTeam", timeout=timeout)
        ]))
        self.modules = None if script is None else ScriptedModules(self.driver, code, script)
        self.originals, self.ours = [], []  # (time, state) at each change
        self.refused = []
        self.port = None
        self.run = None
        acts = _sessions_acts(name)
        beacon = next(what[0] for _, what in acts if isinstance(what, tuple) and isinstance(what[0], pb.RobotBeacon))
        start = next(time for time, what in acts if isinstance(what, tuple) and what[0] is beacon)
        self._utc0 = wire_seconds(wire_convert.time_of(beacon.time)) - start
        for time, what in acts:
            self._pass_time(time)
            if isinstance(what, str):
                self._command(what)
            else:
                self._message(time, *what)

    def _pass_time(self, time):
        driver = self.driver
        if self.modules is not None:
            self.modules.proceed()
        self._note(self.ours, driver.now.mono - MONO0 - 10)
        mono = MONO0 + 10 + time
        deadline = driver.box.timers.deadline()
        if deadline is not None and driver.now.mono < deadline <= mono:
            driver.now = Now(deadline, self._utc0 + deadline - MONO0 - 10)
            driver.event(driver.box.timers.tick)
            self._note(self.ours, deadline - MONO0 - 10)
        driver.now = Now(mono, self._utc0 + time)
        driver.event(driver.box.timers.tick)

    def _note(self, states, time, state=None):
        if state is None and self.driver.run_in() is None:
            return
        state = self.driver.box_state() if state is None else state
        if not states or states[-1][1] is not state:
            states.append((time, state))

    def _command(self, command):
        try:
            if command == OPERATION:
                self.driver.event(self.driver.box.act, Target("tbm"), "operation")
            else:
                self.driver.command(command)
        except Refused as refused:
            self.refused.append((command, refused.reasons))
        self.run = self.driver.run_in() or self.run
        self.port = self.run.port

    def _message(self, time, message, host):
        driver = self.driver
        if host != ROBOT_HOST:
            if isinstance(message, pb.BenchmarkState):
                self._note(self.originals, time, BoxState(message.benchmark_state))
        elif isinstance(message, pb.RobotBeacon):
            time = wire_convert.time_of(message.time)
            driver.event(driver.box.arrivals.on_robot_beacon, host, message.team_name, message.robot_name, time)
        elif isinstance(message, pb.RobotState) and self.port is not None:
            driver.event(driver.box.arrivals.on_robot_report, self.port, host, wire_convert.report_of(message))


def goals_of(name):
    """The goals that the original sent, as it wrote them."""
    key = Key(PASSWORD)
    datagrams = [bytes.fromhex(record["hex"]) for record in load(name) if record["dport"] != PUBLIC_PORT]
    messages = [decode_private(datagram, key) for datagram in datagrams]
    return list(dict.fromkeys(m.generic_goal for m in messages if isinstance(m, pb.BenchmarkState) and m.generic_goal))


def waypoint(goal):
    """The request of a benchmarking module that sends this goal."""
    return RequestKind.GOAL, {"goal": goal, "pose": tuple(yaml.safe_load(goal)), "timeout": 120.0}
