"""The dummy robot with one fault at a time: a table of faults, and what the check must find."""

import asyncio
import struct
from typing import Any, Callable, NamedTuple, Tuple

from helpers.checked_robot import BROADCAST, USUAL, usual_robot
from roah_rsbb.check.report import Cause, Verdict
from roah_rsbb.comm import frame
from roah_rsbb.comm.sender import StateSender
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot import client, link, machine, runner, session
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.dummy import DummyOptions, DummyRobot
from roah_rsbb.robot.goals import BadGoal
from roah_rsbb.rulebook.registry import PROFILES


class Fault(NamedTuple):
    """One fault, and how the check finds it."""

    name: str
    make: Callable[[Any, Any], Any]  # (monkeypatch, loop) -> robot
    scenarios: Tuple[str, ...]
    cause: Cause
    verdict: Verdict = Verdict.FAILED
    also: Tuple[Cause, ...] = ()  # consequences that are also found
    given: Tuple[Tuple[str, Any], ...] = ()  # options of the check


def settings(**fields):
    """A robot with wrong settings."""
    return lambda _, loop: usual_robot(loop, **fields)


def options(**fields):
    """A dummy robot that behaves otherwise."""
    values = {"prepare_duration": 1.0, "execute_duration": 2.0, "seed": 1, **fields}
    return lambda _, loop: usual_robot(loop, DummyOptions(**values))


def clock(wrong):
    """A robot with a wrong clock; `wrong(true time)`."""
    return lambda _, loop: usual_robot(loop, clock=lambda: wrong(loop.utc()))


def patched(owner, name, make, usual=USUAL):
    """A robot with another method; `make(original, loop)` returns it."""
    def robot(monkeypatch, loop):
        monkeypatch.setattr(owner, name, make(getattr(owner, name), loop))
        return usual_robot(loop, usual)
    return robot


def deaf(when, usual=USUAL):
    """A robot that ignores states of the box; `when(progress, received, loop)`."""
    def make(original, loop):
        def hear(progress, message, goal_needed=True):
            if when(progress, BoxState(message.benchmark_state), loop):
                return []
            return original(progress, message, goal_needed)
        return hear
    return patched(machine.RobotProgress, "hear", make, usual)


def deaf_to(received, *states, usual=USUAL):
    """A robot that ignores a state of the box in some of its own states."""
    return deaf(lambda progress, came, _: came is received and progress.state in states, usual)


def _late_stop(progress, received, loop):
    if received is not BoxState.STOP or progress.state is RobotState.STOP:
        progress.stop_came = None
        return False
    progress.stop_came = getattr(progress, "stop_came", None) or loop.time()
    return loop.time() < progress.stop_came + 2.0


def _no_restart(progress, received, _):
    if received is BoxState.STOP and progress.state is RobotState.EXECUTING:
        progress.broken = True
    return getattr(progress, "broken", False) and received is BoxState.PREPARE


def does(make):
    """A robot whose effects are carried out otherwise; `make(do, loop)` returns (runner, effect) -> None."""
    return patched(runner.SessionRunner, "_do", make)


def _no_beacon(do, _loop):
    return lambda this, effect: None if isinstance(effect, fx.SendBeacon) else do(this, effect)


def _plain(do, _loop):
    def plain(this, effect):
        if isinstance(effect, fx.SendState):
            channel = this._private
            channel._peer.send(frame.encode(effect.message), channel.remote)
        else:
            do(this, effect)
    return plain


def _version_1(message):
    content = message.SerializeToString()
    return struct.pack(">HHI", message.COMP_ID, message.MSG_TYPE, len(content)) + content


def _old_frames_in_public(do, _loop):
    def send(this, effect):
        if isinstance(effect, fx.SendBeacon):
            this._public._peer.send(_version_1(effect.message), BROADCAST)
        else:
            do(this, effect)
    return send


def _old_frames_in_private(do, _loop):
    def send(this, effect):
        if isinstance(effect, fx.SendState):
            channel = this._private
            channel._peer.send(_version_1(effect.message), channel.remote)
        else:
            do(this, effect)
    return send


def _long_result(message, _result):
    message.generic_result = f"{{class: {'cups' * 300}, instance: a, x: 0.1, y: 0.2, theta: 1.0}}"


def _sends_anything(do, _loop):
    def open_private(this, effect):
        do(this, effect)
        if isinstance(effect, fx.OpenChannel):
            this._private._peer._max_datagram = 8192
    return open_private


def _too_large(monkeypatch, loop):
    monkeypatch.setattr(link, "write_result", _long_result)
    return does(_sends_anything)(monkeypatch, loop)


class _Hasty(StateSender):
    """Sends 500 messages a second."""

    def _advance(self, now_mono):
        self._next_mono = now_mono + 0.002


class _SaysOnce(StateSender):
    """Sends each state once."""

    def _advance(self, now_mono):
        super()._advance(now_mono)
        self._next_mono = float("inf")


class _Unhurried(StateSender):
    """Sends each state a second after it changed."""

    def changed(self, now_mono):
        super().changed(now_mono)
        self._next_mono = now_mono + 1.0


def _follows_every_box(sender):
    def robot(monkeypatch, loop):
        monkeypatch.setattr(link, "StateSender", sender)
        monkeypatch.setattr(session.Session, "_follows", lambda this, mono, host, *_: True)
        return usual_robot(loop, DummyOptions(1.0, 6.0, seed=1))
    return robot


def _last_goal(monkeypatch, loop):
    monkeypatch.setattr(machine.RobotProgress, "leave", lambda progress, why: [])
    return deaf_to(BoxState.STOP, RobotState.EXECUTING, usual=DummyOptions(1.0, 20.0, seed=1))(monkeypatch, loop)


def _ready_again(_original, _loop):
    def end_execute(progress, _result):
        return progress._enter(machine.Transition(RobotState.WAITING_GOAL, machine.Act.KEEP), "")
    return end_execute


HANDLING_S = 0.2  # of a slow robot, for each beacon


def _slow(monkeypatch, loop):
    """Handles all messages in one row, and beacons slowly."""
    free = [0.0]

    def queued(original, seconds):
        def take(this, message, sender):
            free[0] = max(free[0], loop.time()) + seconds
            loop.call_at(free[0], original, this, message, sender)
        return take

    for name, seconds in (("_public_message", HANDLING_S), ("_private_message", 0.0)):
        original = getattr(runner.SessionRunner, name)
        monkeypatch.setattr(runner.SessionRunner, name, queued(original, seconds))
    return usual_robot(loop, DummyOptions(1.0, 8.0, seed=1))


def _blocked(do, loop):
    until = [0.0]

    def block(this, effect):
        if isinstance(effect, fx.Execute):
            until[0] = loop.time() + 4.0
        is_blocked = 0.3 < until[0] - loop.time() < 3.8
        if not (isinstance(effect, fx.SendState) and is_blocked):
            do(this, effect)
    return block


def _too_early(_original, _loop):
    def end_prepare(progress):
        return progress._enter(machine.Transition(RobotState.EXECUTING, machine.Act.EXECUTE_NO_GOAL), "")
    return end_prepare


def _result_left(original, loop):
    def end_execute(progress, result):
        def leave():
            if progress.state is RobotState.RESULT_TX:
                progress.state = RobotState.STOP
        loop.call_later(3.0, leave)
        return original(progress, result)
    return end_execute


def _whole_seconds(_original, _loop):
    def following(times, now_utc):
        times._count += 1
        return (int(now_utc), 0), times._count
    return following


def _obedient(_original, _loop):
    def take(this, now_mono, message):
        this.sender.reply(now_mono)
        return True
    return take


def _no_memory(monkeypatch, loop):
    monkeypatch.setattr(runner.Seen, "__contains__", lambda seen, ciphertext: False)
    return patched(link.BoxLink, "take", _obedient)(monkeypatch, loop)


def _ends(this):
    this.close()


class Fragile:
    """A robot whose program ends at a condition, or changes by itself. `returns_after`: seconds until it restarts."""

    def __init__(self, loop, watch, returns_after=float("inf")):
        self._loop, self._watch = loop, watch
        self._returns_after = returns_after
        self._robot = None

    async def run(self):
        while True:
            self._robot = usual_robot(self._loop, DummyOptions(1.0, 8.0, seed=1))
            await self._run_once()

    async def _run_once(self):
        running = self._loop.create_task(self._robot.run())
        try:
            ended = None
            while ended is None or self._loop.time() < ended + self._returns_after:
                await asyncio.sleep(0.05)
                if ended is None and self._robot._runner is not None:
                    ended = self._loop.time() if self._watch(self._robot._runner, self._loop) else None
        finally:
            running.cancel()


def ends_in_goal(this, _loop):
    """End the robot's program as soon as it executes. Returns whether it ended."""
    is_over = this.session.progress.state is RobotState.EXECUTING
    if is_over:
        _ends(this)
    return is_over


def _stops_in_silence(this, loop):
    channel = this.session.link
    if channel is not None and loop.time() - channel.silence._heard_mono > 2.0:
        this.session.progress.state = RobotState.STOP


def _stops_without_box(this, loop):
    channel = this.session.link
    if channel is not None and loop.time() - channel.silence._heard_mono > 1.2:
        this.session.progress.state = RobotState.STOP


def _dies_of_garbage(monkeypatch, loop):
    robot = usual_robot(loop)
    monkeypatch.setattr(client, "_warn", lambda text: robot._runner is None or _ends(robot._runner))
    return robot


def _small_buffer(original, _loop):
    return lambda this, message, sender: None if message.ByteSize() > 500 else original(this, message, sender)


def _dies_of(what, usual=USUAL):
    """A robot whose program ends at a state of the box; `what(progress, message)`."""
    def robot(monkeypatch, loop):
        made = usual_robot(loop, usual)
        original = machine.RobotProgress.hear

        def hear(progress, message, goal_needed=True):
            if what(progress, message):
                loop.call_soon(_ends, made._runner)
                return []
            return original(progress, message, goal_needed)

        monkeypatch.setattr(machine.RobotProgress, "hear", hear)
        return made
    return robot


def _keeps_channel(original, _loop):
    def hear(this, now_mono, beacon, host):
        if this.link is None or beacon.benchmarking_teams:
            original(this, now_mono, beacon, host)
    return hear


def _first_port(original, _loop):
    known = []

    def listed(this, beacon, host):
        port = original(this, beacon, host)
        if port is not None:
            known.append(port)
        return None if port is None else known[0]
    return listed


def _crash_once(monkeypatch, loop):
    robot = None

    def crash(_status):
        robot.client._runner.session.progress.state = RobotState.STOP
        robot._options = USUAL

    robot = DummyRobot(DummyOptions(1.0, 2.0, crash_in="execute", seed=1), crash)
    return usual_robot(loop, behaviour=robot)


def _bad_goal(_message):
    raise BadGoal("this robot knows no goals")


def _same_commands(monkeypatch, loop):
    kept = {}
    original = link.BoxLink.__init__

    def begin(this, *arguments, **fields):
        original(this, *arguments, **fields)
        this._commands = kept

    monkeypatch.setattr(link.BoxLink, "__init__", begin)
    return usual_robot(loop)


def _value(owner, name, value):
    def robot(monkeypatch, loop):
        monkeypatch.setattr(owner, name, value)
        return usual_robot(loop)
    return robot


FAULTS = (
    # Finding the robot, its clock.
    Fault("no beacon", does(_no_beacon), ("find",), Cause.NO_BEACON),
    Fault("a beacon every 5 s", _value(session, "BEACON_PERIOD_S", 5.0), ("beacon",), Cause.BEACON_PERIOD),
    Fault("the team's name in lower case", settings(team="team"), ("find",), Cause.OTHER_TEAM),
    Fault("clock 0.5 s ahead", clock(lambda utc: utc + 0.5), ("clock",), Cause.CLOCK_SKEW),
    Fault("clock 3 ms each second too slow", clock(lambda utc: utc - 0.003 * (utc - 1_800_000_000.0)), ("drift",),
          Cause.CLOCK_DRIFT),
    Fault("times in whole seconds", patched(link.MessageTimes, "next", _whole_seconds), ("channel",),
          Cause.TIME_NOT_RISING),
    Fault("another robot of the team", settings(), ("find",), Cause.OTHER_ROBOT, given=(("robot", "Second"),)),
    Fault("a name of 101 characters", settings(robot="R" * 101), ("find",), Cause.BAD_NAME),
    Fault("beacons of the first version", does(_old_frames_in_public), ("find",), Cause.BAD_FRAMES),
    # The private channel.
    Fault("states of the first version", does(_old_frames_in_private), ("channel",), Cause.BAD_FRAMES),
    Fault("a result of 1200 bytes", _too_large, ("run-hopf",), Cause.TOO_LARGE),
    Fault("sends without a pause", _value(link, "StateSender", _Hasty), ("channel",), Cause.FLOOD),
    Fault("continues the goal of its last run", _last_goal, ("new-port",), Cause.OLD_STATE),
    Fault("wrong password", settings(password="another"), ("channel",), Cause.WRONG_PASSWORD),
    Fault("not encrypted", does(_plain), ("channel",), Cause.PLAIN_FRAMES),
    Fault("no private channel", _value(runner.SessionRunner, "_open_private", lambda this, where: None), ("channel",),
          Cause.NO_PRIVATE_CHANNEL),
    Fault("a callback that blocks for 3.5 s", patched(runner.SessionRunner, "_do", _blocked,
                                                      DummyOptions(1.0, 6.0, seed=1)), ("run",), Cause.SILENT),
    Fault("ends while it executes", lambda _, loop: Fragile(loop, ends_in_goal), ("run",), Cause.SILENT),
    Fault("ends at STOP", _dies_of(lambda progress, message: (
        message.benchmark_state == BoxState.STOP and progress.state is RobotState.EXECUTING), DummyOptions(1.0, 8.0)),
          ("stop-executing",), Cause.SILENT),
    Fault("keeps its channel after the run", patched(session.Session, "_hear_beacon", _keeps_channel), ("channel",),
          Cause.CHANNEL_NOT_LEFT),
    Fault("keeps its first port", patched(session.Session, "_listed_port", _first_port), ("channel", "run"),
          Cause.PORT_NOT_FOLLOWED),
    # STOP.
    Fault("ignores STOP in PREPARING", deaf_to(BoxState.STOP, RobotState.PREPARING, usual=DummyOptions(8.0, 2.0)),
          ("stop-preparing",), Cause.STOP_IGNORED),
    Fault("finishes its goal before it stops",
          deaf_to(BoxState.STOP, RobotState.EXECUTING, usual=DummyOptions(1.0, 8.0)), ("stop-executing",),
          Cause.STOP_IGNORED),
    Fault("stops 2 s late", deaf(_late_stop, DummyOptions(1.0, 8.0)), ("stop-executing",), Cause.STOP_LATE),
    Fault("cannot start again", deaf(_no_restart), ("stop-executing",), Cause.NO_RESTART),
    # States.
    Fault("ignores PREPARE", deaf_to(BoxState.PREPARE, RobotState.STOP), ("run",), Cause.PREPARE_IGNORED),
    Fault("is never ready", options(prepare_duration=300.0), ("run",), Cause.NEVER_READY),
    Fault("never completes its goal", options(never_end=True), ("run",), Cause.NEVER_DONE),
    Fault("cannot read goals", _value(machine, "read_goal", _bad_goal), ("run-hnf",), Cause.GOAL_IGNORED),
    Fault("executes without its goal", patched(machine.RobotProgress, "end_prepare", _too_early), ("run-hgmf",),
          Cause.EXECUTES_EARLY, also=(Cause.NEVER_DONE,)),
    Fault("leaves RESULT_TX by itself", patched(machine.RobotProgress, "end_execute", _result_left), ("silent-30",),
          Cause.RESULT_LEFT),
    Fault("does one goal only", deaf_to(BoxState.PREPARE, RobotState.RESULT_TX), ("run-hopf",),
          Cause.NEXT_GOAL_IGNORED),
    Fault("ignores the timeout of a waypoint", deaf_to(BoxState.PREPARE, RobotState.EXECUTING), ("next-waypoint",),
          Cause.TIMEOUT_IGNORED),
    Fault("waits for a goal when it is done", patched(machine.RobotProgress, "end_execute", _ready_again), ("run",),
          Cause.ILLEGAL_STATE, also=(Cause.NEVER_DONE,)),
    Fault("restarts while it executes", _crash_once, ("run",), Cause.FELL_TO_STOP),
    # Contents.
    Fault("saves nothing", options(save_nothing=True), ("run",), Cause.NOTHING_SAVED),
    Fault("sends no result", _value(link, "write_result", lambda message, result: None), ("run-hopf",),
          Cause.RESULT_MISSING),
    Fault("a result without its pose", _value(DummyRobot, "_result", lambda this, form: "{class: cups, instance: a}"),
          ("run-hopf",), Cause.RESULT_INCOMPLETE),
    Fault("dimmer at 170 %", patched(
        link.BoxLink, "command_device", lambda original, loop: lambda this, name, value: (
            this._commands.update({f"devices_{name}": 170}) if name == "dimmer" else original(this, name, value))),
          ("run-hcfgac",), Cause.BAD_COMMAND),
    Fault("repeats the device commands of its last run", _same_commands, ("run-hcfgac", "burst"), Cause.OLD_COMMANDS,
          Verdict.QUIRK),
    # Networks and boxes.
    Fault("stops when the box is silent", lambda _, loop: Fragile(loop, _stops_in_silence), ("silent-3",),
          Cause.GIVES_UP),
    Fault("stops when the box restarts", lambda _, loop: Fragile(loop, _stops_without_box), ("restart",),
          Cause.RESTART_NOT_FOLLOWED),
    Fault("sends each state once", _value(link, "StateSender", _SaysOnce), ("bad-network",), Cause.BAD_NETWORK),
    Fault("handles a beacon in 0.2 s", _slow, ("burst",), Cause.BURST),
    Fault("does not follow a box that moved", patched(
        session.Session, "_follows", lambda original, loop: lambda this, mono, host, *_: (
            this._box in (None, host))), ("moved",), Cause.MOVE_NOT_FOLLOWED),
    Fault("obeys old messages", _no_memory, ("stale",), Cause.STALE_OBEYED, Verdict.QUIRK),
    Fault("ends at an invalid datagram", _dies_of_garbage, ("garbage",), Cause.DIES_OF_GARBAGE),
    Fault("follows every box", _follows_every_box(StateSender), ("other-box",), Cause.FOREIGN_BOX, Verdict.QUIRK),
    Fault("follows every box and reports so late", _follows_every_box(_Unhurried), ("other-box",), Cause.FOREIGN_BOX,
          Verdict.QUIRK),
    Fault("a buffer of 512 bytes", patched(runner.SessionRunner, "_public_message", _small_buffer), ("large-beacon",),
          Cause.LARGE_BEACON),
    Fault("ends at an unknown benchmark", _dies_of(lambda _, message: message.benchmark_type not in PROFILES),
          ("unknown-code",), Cause.UNKNOWN_CODE),
)
