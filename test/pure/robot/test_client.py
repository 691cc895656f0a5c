"""A robot client on real loopback sockets, against a small box."""

import asyncio
import gc
import socket

import pytest

from helpers.small_box import BOX, BROADCAST, NAME, PASSWORD, ROBOT, TEAM, SmallBox, running
from roah_rsbb.comm.channels import Network, PublicChannel
from roah_rsbb.comm.ciphers import Cipher
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.client import Behaviour, RobotClient
from roah_rsbb.robot.goals import HppfResult, Pose
from roah_rsbb.robot.machine import IllegalEvent


class Recorder(Behaviour):
    """Does at once what a test requests, and records its calls."""

    def __init__(self, results=(), waits=False):
        self.happened = []
        self.reports = []
        self._results = list(results)
        self._waits = waits

    async def prepare(self, benchmark):
        self.happened.append(("prepare", benchmark))

    async def execute(self, benchmark, goal):
        self.happened.append(("execute", benchmark, goal and (goal.pose or goal.text)))
        if self._waits:
            try:
                await asyncio.get_event_loop().create_future()
            except asyncio.CancelledError:
                self.happened.append(("cancelled",))
                raise
        return self._results.pop(0) if self._results else None

    def stop(self, why):
        self.happened.append(("stop",))

    def on_bell(self):
        self.happened.append(("bell",))

    def on_tablet_call(self):
        self.happened.append(("call",))

    def on_tablet_position(self, x, y):
        self.happened.append(("position", x, y))

    def on_devices(self, devices):
        self.happened.append(("dimmer", devices.dimmer))

    def on_tablet(self, tablet):
        self.happened.append(("map", tablet.display_map))

    def on_report(self, report):
        self.reports.append(report)


def client_at(box, behaviour, password=PASSWORD, **settings):
    """Run a client on the box's network, in a `with` block."""
    return running(RobotClient(
        TEAM, password, behaviour, NAME, rsbb_host=BROADCAST, rsbb_port=box.port, bind_host=ROBOT, **settings
    ))


def run_through(behaviour, code="HGTKMH", goals=({},), **settings):
    """Take a client through a whole run. Returns the box."""
    async def body():
        async with SmallBox(code, goals) as box, client_at(box, behaviour, **settings):
            await box.run_through()
            return box
    return asyncio.run(body())


@pytest.mark.parametrize("cipher", [cipher for cipher in Cipher if cipher is not Cipher.NONE])
def test_a_task_benchmark(cipher):
    behaviour = Recorder()
    box = run_through(behaviour, cipher=cipher)
    assert [what for what in behaviour.happened if what[0] not in ("dimmer", "map")] == [
        ("prepare", "HGTKMH"), ("execute", "HGTKMH", None), ("stop",)
    ]
    assert len(box.finished) == 1
    assert behaviour.reports == []


def test_goals_and_results():
    behaviour = Recorder(["one", "two"])
    box = run_through(behaviour, "STB", [{"generic_goal": "goal: 1\n"}, {"generic_goal": "goal: 2\n"}])
    assert [message.generic_result for message in box.finished] == ["one", "two"]
    assert [what[2] for what in behaviour.happened if what[0] == "execute"] == ["goal: 1\n", "goal: 2\n"]


def test_a_result_that_does_not_fit_ends_the_goal_without_one(caplog):
    box = run_through(Recorder([HppfResult("Annie", Pose(0, 0, 0))]), "HOPF")
    assert not box.finished[0].HasField("generic_result")
    assert "not a result of HOPF" in caplog.text


def test_a_waypoint_that_times_out():
    behaviour = Recorder(waits=True)

    async def body():
        goals = [{"generic_goal": "[1, 2, 3]"}, {"generic_goal": "[4, 5, 6]"}]
        async with SmallBox("HNF", goals) as box, client_at(box, behaviour):
            await box.until(lambda: box.received)
            box.start()
            await box.until(lambda: box.state is BoxState.WAITING_RESULT)
            box.next_goal()
            await box.until(lambda: box.state is BoxState.WAITING_RESULT)
            box.stop()
            await box.until(lambda: box.robot_state is RobotState.STOP)

    asyncio.run(body())
    assert [what for what in behaviour.happened if what[0] not in ("dimmer", "map")] == [
        ("prepare", "HNF"), ("execute", "HNF", (1.0, 2.0, 3.0)), ("cancelled",),
        ("prepare", "HNF"), ("execute", "HNF", (4.0, 5.0, 6.0)), ("stop",), ("cancelled",),
    ]


def test_stopped_by_the_referee_and_started_again():
    behaviour = Recorder(waits=True)

    async def body():
        async with SmallBox() as box, client_at(box, behaviour) as client:
            await box.until(lambda: box.received)
            for _ in range(2):
                box.start()
                await box.until(lambda: box.robot_state is RobotState.EXECUTING)
                assert (client.state, client.benchmark) == (RobotState.EXECUTING, "HGTKMH")
                box.stop()
                await box.until(lambda: behaviour.happened[-1] == ("cancelled",))
                await box.until(lambda: box.robot_state is RobotState.STOP)
            box.listed = False
            beacons = len(box.beacons)
            await box.until(lambda: len(box.beacons) > beacons)
            assert client.benchmark is None

    asyncio.run(body())
    assert [what[0] for what in behaviour.happened if what[0] in ("execute", "cancelled", "stop")] == [
        "execute", "stop", "cancelled"] * 2


def test_messages_of_the_owner_arrive():
    class Requesting(Recorder):
        async def execute(self, benchmark, goal):
            for text in ("a", "b", "a"):
                self.client.notify(text)
            self.client.activation_event("bell")
            self.client.visitor("Deli Man")
            self.client.final_command("open")
            self.client.set_device("dimmer", 40)
            self.client.display_map(True)
            self.client.messages_saved = 7
            while self.client.strings_pending:
                await asyncio.sleep(0.01)

    box = run_through(Requesting())
    assert dict(box.logged) == {
        "notifications": ["a", "b", "a"], "activation_event": ["bell"], "visitor": ["Deli Man"],
        "final_command": ["open"],
    }
    last = box.finished[0]
    assert (last.devices_dimmer, last.tablet_display_map, last.messages_saved) == (40, True, 7)


def test_what_happens_at_home():
    behaviour = Recorder()

    async def body():
        async with SmallBox() as box:
            box.beacon_fields = {"devices_dimmer": 10}
            async with client_at(box, behaviour):
                await box.until(lambda: box.received)
                now = pb.Time(sec=5, nsec=0)
                box.beacon_fields = {
                    "devices_bell": now, "tablet_call_time": now, "tablet_position_time": now,
                    "tablet_position_x": 1.5, "tablet_position_y": -2.0, "tablet_display_map": True,
                }
                await box.until(lambda: ("position", 1.5, -2.0) in behaviour.happened)

    asyncio.run(body())
    assert behaviour.happened == [
        ("dimmer", 10), ("map", False), ("dimmer", 0), ("map", True), ("bell",), ("call",), ("position", 1.5, -2.0)
    ]


def test_mistakes_of_a_behaviour_do_not_end_the_connection(caplog):
    class Broken(Recorder):
        def on_devices(self, devices):
            raise RuntimeError("devices")

        def stop(self, why):
            raise RuntimeError("stop")

        async def execute(self, benchmark, goal):
            raise RuntimeError("execute")

    async def body():
        async with SmallBox() as box, client_at(box, Broken()):
            await box.until(lambda: box.received)
            for _ in range(2):
                box.start()
                await box.until(lambda: box.robot_state is RobotState.EXECUTING)
                box.stop()
                await box.until(lambda: box.robot_state is RobotState.STOP)

    asyncio.run(body())
    assert "stays in EXECUTING until the box stops it" in caplog.text
    assert caplog.text.count("RuntimeError: stop") == 2


def test_one_phase_begins_when_the_cancelled_one_has_ended():
    order = []

    class Slow(Recorder):
        async def prepare(self, benchmark):
            order.append("begins")
            if len(order) == 1:
                try:
                    await asyncio.get_event_loop().create_future()
                except asyncio.CancelledError:
                    await asyncio.sleep(0.2)  # a robot that brakes, and then says that it is done
                    order.append("ends")
            else:
                await asyncio.sleep(0.2)
                order.append("ready")

    async def body():
        async with SmallBox() as box, client_at(box, Slow()):
            await box.until(lambda: box.received)
            box.start()
            await box.until(lambda: box.robot_state is RobotState.PREPARING)
            box.stop()
            await box.until(lambda: box.robot_state is RobotState.STOP)
            box.start()
            # Not before the second one is ready: the first one's word does not count any more.
            await box.until(lambda: box.robot_state not in (RobotState.STOP, RobotState.PREPARING))
            assert order == ["begins", "ends", "begins", "ready"]

    asyncio.run(body())


def test_sent_datagrams_can_be_lost_too():
    network = {"passes": True}

    async def body():
        async with SmallBox() as box, client_at(box, Recorder(), passes=lambda: network["passes"]):
            await box.until(lambda: box.received)
            network["passes"] = False  # in the middle of the first burst
            ticks = []
            await box.until(lambda: ticks.append(len(box.received)) or len(ticks) > 15)
            assert ticks[-1] - ticks[0] <= 1  # what was under way

    asyncio.run(body())


def test_a_wrong_password_is_reported():
    behaviour = Recorder()

    async def body():
        async with SmallBox() as box, client_at(box, behaviour, password="wrong"):
            await box.until(lambda: behaviour.reports)

    asyncio.run(body())
    assert [report.problem for report in behaviour.reports] == [fx.Problem.WRONG_PASSWORD]


def test_a_private_port_in_use_is_reported_and_tried_again():
    behaviour = Recorder()

    async def body():
        async with SmallBox() as box:
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
                other.bind((ROBOT, box.private_port))
                async with client_at(box, behaviour):
                    await box.until(lambda: behaviour.reports)
                    assert behaviour.reports[0].problem is fx.Problem.CHANNEL
                    assert f"{ROBOT}:{box.private_port}" in behaviour.reports[0].text
                    other.close()
                    await box.run_through()

    asyncio.run(body())
    assert len(behaviour.reports) == 1


def test_another_robot_of_this_name_is_reported():
    behaviour = Recorder()

    async def body():
        async with SmallBox() as box, client_at(box, behaviour):
            await box.until(lambda: box.received)
            reported = []
            loop = asyncio.get_event_loop()
            twin = PublicChannel(
                loop, Network(BROADCAST, box.port, "127.0.0.3"), lambda *_: None, reported.append
            )
            twin.open()
            try:
                twin.send(pb.RobotBeacon(team_name=TEAM, robot_name=NAME, time=pb.Time(sec=1, nsec=0)))
                await box.until(lambda: behaviour.reports)
            finally:
                twin.close()
            assert reported == []

    asyncio.run(body())
    assert [report.problem for report in behaviour.reports] == [fx.Problem.SAME_NAME]
    assert "127.0.0.3" in behaviour.reports[0].text


def test_nobody_needs_to_keep_its_task():
    """A loop does not: the robots of a whole competition were collected as garbage."""
    async def body():
        async with SmallBox() as box:
            client = RobotClient(TEAM, PASSWORD, Recorder(), NAME, BROADCAST, box.port, ROBOT)
            ended = []
            asyncio.get_event_loop().create_task(client.run()).add_done_callback(ended.append)
            await box.until(lambda: box.received)
            del client
            gc.collect()
            before = len(box.received)
            await box.until(lambda: len(box.received) > before or ended)
            assert not ended

    asyncio.run(body())


@pytest.mark.parametrize("settings, error, found", [
    ({"team": ""}, ValueError, "must not be empty"),
    ({"password": ""}, ValueError, "password is empty"),
    ({"cipher": Cipher.NONE}, ValueError, "must be encrypted"),
    ({"bind_host": "10.1.2.3"}, OSError, "is not an address of this machine"),
])
def test_a_client_that_cannot_begin_says_why(settings, error, found):
    usual = {"team": TEAM, "password": PASSWORD, "behaviour": Recorder(), "rsbb_host": BROADCAST, "bind_host": ROBOT}
    with pytest.raises(error, match=found):
        asyncio.run(RobotClient(**{**usual, **settings}).run())


def test_a_client_that_does_not_run_refuses_requests():
    client = RobotClient(TEAM, PASSWORD, Recorder(), rsbb_host=BOX)
    with pytest.raises(IllegalEvent, match="is not running"):
        client.notify("x")
    assert (client.state, client.benchmark, client.strings_pending) == (RobotState.STOP, None, 0)
