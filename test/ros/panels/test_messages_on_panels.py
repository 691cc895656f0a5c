"""The panels' messages agree with the box's views in each tick, although most parts are cached."""

import io
import unittest
from typing import Any, Optional

from helpers.box_driver import BoxDriver
from helpers.commands import COMMANDS
from helpers.competition import competition, event
from roah_rsbb.core.views.public import PublicResults, public_view
from roah_rsbb.model import shown
from roah_rsbb.msg import CoreDetails, CoreToGui, RunClock, RunClocks, ZoneState
from roah_rsbb.nodes.core.panel_messages import PanelMessages
from roah_rsbb.nodes.core.public_convert import public_details
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, EventRules, PhaseRule

BUTTONS = dict(zip(COMMANDS, ("connect", "disconnect", "start", "stop", "prev", "next")))
LOG = "/logs/run.bag"


def received(message: Any) -> Any:
    """A message as a panel receives it; None: there is none this time."""
    if message is None:
        return None
    buff = io.BytesIO()
    message.serialize(buff)
    kind = next(kind for kind in (CoreDetails, RunClocks) if isinstance(message, kind))
    return kind().deserialize(buff.getvalue())


class TestPanelMessages(unittest.TestCase):
    def setUp(self) -> None:
        self.driver = BoxDriver(competition(tbm=[event(timeout=60.0)], other=[event(team="Beta", timeout=33.25)]))
        self.messages = PanelMessages(self.driver.box, "uuid", "127.255.255.255")
        self.log_files = {}

    def tick(self) -> CoreToGui:
        """The next message as a panel receives it. Its bytes are those that ROS itself would send."""
        buff = io.BytesIO(b"before")
        buff.seek(len("before"))
        self.messages.to_gui(self.driver.now, self.log_files).serialize(buff)
        data = buff.getvalue()[len("before"):]
        self.assertEqual(buff.getvalue()[:len("before")], b"before")
        message = CoreToGui().deserialize(data)
        again = io.BytesIO()
        message.serialize(again)
        self.assertEqual(again.getvalue(), data)
        self.assert_zones(message)
        return message

    def assert_zones(self, message: CoreToGui) -> None:
        self.assertEqual([zone.zone for zone in message.zones], list(self.driver.box.zones))
        for zone in message.zones:
            view = self.driver.view(zone.zone)
            self.assertEqual(
                (zone.team, zone.code, zone.state, zone.log, zone.online_data, zone.schedule.to_sec()),
                (view.event.team, view.event.benchmark.code, view.state, view.log, view.online_data,
                 view.event.scheduled))
            self.assertAlmostEqual(zone.timer.to_sec(), view.timer, 6)
            for command, button in BUTTONS.items():
                self.assertEqual(getattr(zone, f"{button}_enabled"), not view.reasons_off(command), button)
            self.assertEqual([group.group_name for group in zone.scoring], [group.name for group in view.scoring])
            self.assertEqual([value for group in zone.scoring for value in group.current_values],
                             [value for group in view.scoring for _, value in group.items])

    def details(self) -> Optional[CoreDetails]:
        """The next details as a panel receives them; None: no message this time."""
        return received(self.messages.details(self.driver.now))

    def test_a_run_from_beginning_to_end(self) -> None:
        self.tick()
        robot = self.driver.connected()
        self.tick()
        self.driver.command("start")
        self.tick()
        robot.executes()
        robot.says(notifications=("größer\nals eine Zeile",))
        self.tick()
        group = self.driver.view().scoring[0]
        self.driver.score(group.name, group.items[0][0].desc, 1)
        self.assertEqual(self.tick().zones[0].scoring[0].current_values[0], 1)
        timers = []
        for _ in range(700):
            self.driver.run(0.1)
            timers.append(self.tick().zones[0].timer.to_sec())
        self.assertGreater(len(set(timers)), 590)
        self.driver.command("disconnect")
        self.assertEqual(self.tick().zones[0].timer.to_sec(), 60.0)

    def test_all_active_robots(self) -> None:
        robots = [self.driver.robot("Alpha", skew=-0.25), self.driver.robot("Beta", "r2", "10.0.0.3", skew=1.5)]
        for _ in range(3):
            self.driver.run(1.0)
            for robot in robots:
                robot.beacon()
            listed = {robot.team: robot for robot in self.tick().active_robots}
            self.assertEqual(
                [(listed[r.id.team].robot, round(listed[r.id.team].skew.to_sec(), 6), listed[r.id.team].beacon.to_sec())
                 for r in self.driver.box.robots.all(self.driver.now)],
                [("r1", -0.25, self.driver.now.utc), ("r2", 1.5, self.driver.now.utc)])

    def test_details_come_on_change_and_once_a_second(self) -> None:
        self.tick()
        self.assertIsNotNone(self.details())
        came = []
        for _ in range(30):
            self.driver.run(0.1)
            self.tick()
            came.append(self.details() is not None)
        self.assertEqual(came, ([False] * 9 + [True]) * 3)
        robot = self.driver.connected()
        self.log_files[robot.port] = LOG
        self.tick()
        zone = self.details().zones[0]
        self.assertEqual((zone.phase, zone.port, zone.robot, zone.robot_state, zone.log_file, zone.skew_known),
                         ("connected", robot.port, "r1", "STOP", LOG, True))
        self.assertEqual(zone.last_message.to_sec(), self.driver.now.utc)
        self.driver.run(0.1)
        robot.says()
        self.tick()
        self.assertIsNone(self.details(), "nothing but the time of the last message is new")
        self.driver.command("start")
        self.tick()
        zone = self.details().zones[0]
        self.assertEqual((zone.phase, zone.box_state), ("running", "PREPARE"))
        self.assertEqual(zone.last_message.to_sec(), self.driver.now.utc)

    def test_clocks_come_on_change_and_once_a_second(self) -> None:
        def clocks() -> Optional[RunClocks]:
            self.driver.run(0.1)
            self.tick()
            return received(self.messages.clocks(self.driver.now))

        self.assertIsNotNone(clocks())
        self.assertEqual([clocks() is not None for _ in range(30)], ([False] * 9 + [True]) * 3)
        self.driver.connected()
        self.assertEqual(clocks().zones[0].phase, "connected")
        self.driver.command("start")
        zone = clocks().zones[0]
        self.assertEqual((zone.phase, zone.counting, zone.limit.to_sec()), ("running", True, 60.0))
        self.assertAlmostEqual(zone.elapsed.to_sec(), 0.1, 6)
        self.assertIsNone(clocks())
        self.driver.command("stop")
        zone = clocks().zones[0]
        self.assertEqual((zone.phase, zone.counting), ("ended", False))
        self.assertAlmostEqual(zone.elapsed.to_sec(), 0.2, 6)
        self.assertAlmostEqual(zone.after_stop.to_sec(), 119.9, 6)

    def test_a_log_that_is_written_elsewhere_now_is_reported(self) -> None:
        robot = self.driver.connected()
        for path in ("", LOG, "/other/run.bag"):
            self.log_files[robot.port] = path
            self.tick()
            self.assertEqual(self.details().zones[0].log_file, path)

    def test_a_warning_of_the_box_is_reported_at_once(self) -> None:
        self.tick()
        self.details()
        self.driver.event(self.driver.box.on_trouble, "the disk is full: free it")
        self.assertIn("the disk is full: free it", self.tick().status)
        self.assertEqual(self.details().warnings, ["the disk is full: free it"])
        self.assertIsNone(self.details())


class TestRules(unittest.TestCase):
    """What panels receive of the rules about time and attempts."""

    def box_with(self, timeout: float, **rules: object) -> None:
        self.driver = BoxDriver(competition(tbm=[event(timeout=timeout, rules=EventRules(**rules))]))
        self.messages = PanelMessages(self.driver.box, "uuid", "127.255.255.255")
        self.clocks: Optional[RunClocks] = None  # the last message

    def zone(self) -> ZoneState:
        buff = io.BytesIO()
        self.messages.to_gui(self.driver.now, {}).serialize(buff)
        return CoreToGui().deserialize(buff.getvalue()).zones[0]

    def clock(self) -> RunClock:
        self.zone()
        self.clocks = received(self.messages.clocks(self.driver.now)) or self.clocks
        return self.clocks.zones[0]

    def test_a_run_without_a_limit(self) -> None:
        self.box_with(NO_LIMIT)
        self.driver.command("open_sheet")
        self.driver.command("start")
        self.driver.run(5.0)
        self.assertEqual((self.zone().timeout.to_sec(), self.zone().timer.to_sec()), (0.0, 5.0))
        self.assertEqual((self.clock().limit.to_sec(), self.clock().elapsed.to_sec()), (0.0, 5.0))
        view = public_view(self.driver.box, self.driver.now, PublicResults.NONE)
        run, = public_details(view, self.driver.now, "").runs
        self.assertEqual((run.unlimited, run.elapsed.to_sec(), run.left.to_sec(), run.ends.to_sec()), (True, 5.0, 0, 0))

    def test_setup_time_phases_and_attempts(self) -> None:
        phases = (PhaseRule("Enter", 20.0), PhaseRule("Leave"))
        self.box_with(60.0, setup_time=30.0, attempts=2, pause=True, phases=phases)
        self.driver.command("open_sheet")
        self.driver.run(4.0)
        clock = self.clock()
        self.assertEqual((clock.setup_limit.to_sec(), clock.setup_elapsed.to_sec(), clock.setup_counting, clock.phases),
                         (30.0, 4.0, True, 2))
        self.assertEqual(self.zone().timer.to_sec(), 26.0)
        details = received(self.messages.details(self.driver.now)).zones[0]
        self.assertEqual((details.by_hand, shown.of(details, "pause").shown), (True, True))
        self.assertEqual((details.attempt, details.attempts), (1, 2))
        self.assertEqual((shown.off(details, "no_show"), shown.off(details, "pause")), ((), ("No run is running",)))
        self.driver.command("start")
        self.driver.run(4.0)
        clock = self.clock()
        self.assertEqual((clock.phase_number, clock.phase_name), (1, "Enter"))
        self.assertEqual((clock.phase_limit.to_sec(), clock.phase_elapsed.to_sec()), (20.0, 4.0))
        self.driver.command("next_phase")
        self.assertEqual((self.clock().phase_name, self.clock().phase_limit.to_sec()), ("Leave", 0.0))

    def test_several_robots_of_a_team(self) -> None:
        self.box_with(60.0)
        for name in ("r2", "r1"):
            self.driver.robot(name=name).beacon()
        self.zone()
        details = received(self.messages.details(self.driver.now)).zones[0]
        self.assertEqual(set(shown.robots_to_choose(details)), {"r1", "r2"})
