"""The three task benchmarks, whole, over real sockets."""

import re
import time

import rospy
from support.box_case import LISTENER, TABLET, BoxCase
from support.box_client import Refusal
from support.robots import RSBB_PORT, listed, wire
from support.waiting import wait_until

from roah_rsbb.msg import DevicesState
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState

DOOR = ("Achievements", "Detects the door whose state has changed")
FURNITURE = ("Achievements", "Detects a piece of moved furniture")
BUMPS = ("Penalized Behaviors", "Bumps into the furniture")

STOP, PREPARE, WAITING_RESULT = BoxState.STOP, BoxState.PREPARE, BoxState.WAITING_RESULT


class TestGettingToKnowMyHome(BoxCase):
    """HGTKMH, from the robot's first beacon to the next event."""

    def test_a_whole_run(self) -> None:
        self.listener = self.participant(LISTENER)
        self.began = time.time()
        self.robot = self.robot("Alpha", prepares=False)
        self.before()
        self.connected()
        self.running()
        self.scored()
        self.completed()
        self.left()

    def before(self) -> None:
        box = self.box
        zone = box.zone("Home")
        self.assertEqual((zone.code, zone.name, zone.desc), ("HGTKMH", "Task Benchmark 1", "Getting to know my home"))
        self.assertEqual((zone.team, zone.round, zone.run), ("Alpha", 2, 3))
        self.assertEqual((zone.timeout.to_sec(), zone.timer.to_sec()), (600, 600))
        self.assertEqual(time.strftime("%F %T", time.gmtime(zone.schedule.to_sec())), "2015-12-31 09:00:00")
        box.wait_text("Home", "Robot ready to accept connection: Robot of team Alpha")
        # Until its first beacon, the box knows the robot of this team in the test before.
        wait_until(lambda: self.began <= box.robot("Alpha").beacon.to_sec() <= time.time(), "it was heard just now")
        self.assertEqual(box.robot("Alpha").robot, "Robot")
        wait_until(lambda: abs(box.robot("Alpha").skew.to_sec()) < 0.1, "its clock is right")
        wait_until(lambda: not self.public_line().running, "the public display shows no run")

    def connected(self) -> None:
        box = self.box
        self.port = box.connect("Home", again=True)
        self.assertIn(self.port, range(RSBB_PORT + 1, RSBB_PORT + 100))
        self.listener.wait_beacon(lambda b: ("Alpha", "Robot", self.port) in listed(b), "the beacon lists the robot")
        zone = box.wait_zone("Home", lambda z: z.start_enabled and "All OK for start" in z.state and z, "start is on")
        self.assertEqual(
            (zone.connect_enabled, zone.disconnect_enabled, zone.stop_enabled, zone.prev_enabled, zone.next_enabled),
            (False, True, False, False, False),
        )
        wait_until(lambda: self.public_line().running, "the public display shows the run")
        self.assertEqual(self.robot.did, [])
        self.assertEqual(box.zone_details("Home").box_state, "STOP")

    def running(self) -> None:
        box = self.box
        box.start("Home")
        self.robot.wait_did("prepare HGTKMH")
        box.wait_details("Home", lambda d: (d.phase, d.box_state, d.robot_state) == ("running", "PREPARE", "PREPARING"),
                         "the robot prepares")
        box.wait_text("Home", "Robot preparing")
        self.assertNotIn("execute HGTKMH", self.robot.did)
        self.robot.let("prepare")
        self.robot.wait_did("execute HGTKMH")
        box.wait_details("Home", lambda d: (d.box_state, d.robot_state) == ("WAITING_RESULT", "EXECUTING"),
                         "the robot executes")
        box.wait_zone("Home", lambda z: 500 < z.timer.to_sec() < 600, "the time runs")
        self.robot.save(7)
        box.wait_text("Home", "Messages saved: 7")
        box.wait_details("Home", lambda d: d.messages_saved == 7, "the details have it, too")

    def scored(self) -> None:
        box = self.box
        box.wait_zone("Home", lambda z: {value for *_, value in box.scores("Home")} == {0}, "the sheet is empty")
        box.set_score("Home", *DOOR, 1)
        box.set_score("Home", *FURNITURE, 3)
        box.set_score("Home", *FURNITURE, 2)
        box.wait_scored("Home", (*DOOR, 0, 1), (*FURNITURE, 1, 2), (*BUMPS, 1, 0))
        for item, value, why in (
            (DOOR, 2, "0 or 1"), (BUMPS, -1, "0 or more"), (("Achievements", "Sings"), 1, "no scoring item 'Sings'"),
            (("Archievements", DOOR[1]), 1, "did you mean 'Achievements'?"),
        ):
            with self.subTest(item), self.assertRaisesRegex(Refusal, re.escape(why)):
                box.set_score("Home", *item, value)

    def completed(self) -> None:
        box = self.box
        self.robot.let("execute")
        box.wait_text("Home", "Benchmark completed by the robot")
        box.wait_details("Home", lambda d: (d.phase, d.end_reason, d.box_state) == ("ended", "completed", "STOP"),
                         "the run is completed")
        self.robot.wait_state(RobotState.STOP)
        box.wait_zone("Home", lambda z: 100 < z.timer.to_sec() <= 120, "the time after the stop runs")
        box.set_score("Home", *BUMPS, 1)  # the referee counts afterwards, too
        box.wait_scored("Home", (*BUMPS, 1, 1))

    def left(self) -> None:
        box = self.box
        log = self.leave("Home")
        self.check_log(log)
        self.listener.wait_beacon(lambda b: not listed(b), "the beacon lists the robot no more")
        box.wait_zone("Home", lambda z: z.code == "HWV", "the next event follows by itself")
        wait_until(lambda: not any(line.run == 3 for line in box.public.schedule), "the public sees no past event")
        box.wait_zone("Home", lambda z: z.connect_enabled, "the robot may continue with the next event")
        box.command("previous", "Home")
        box.wait_zone("Home", lambda z: z.code == "HGTKMH", "previous goes back")
        self.assertEqual(box.refusal("previous", "Home"), "This is the zone's first event")
        box.command("next", "Home")
        box.wait_zone("Home", lambda z: z.code == "HWV" and not z.next_enabled, "next goes forth")

    def check_log(self, log) -> None:
        uuid = self.box.uuid
        self.assertRegex(log.path.name, rf"^online_log_[\d_-]+_Alpha_round2_run3_{uuid}\.bag$")
        self.assertEqual(log.path.parent.as_posix(), rospy.get_param("/roah_rsbb_core/log_dir"))
        uint8, string = "std_msgs/UInt8", "std_msgs/String"
        self.assertEqual(log.types, {
            "/rsbb_log/rsbb_state": uint8, "/rsbb_log/rsbb_state_str": string, "/rsbb_log/rsbb_state_desc": string,
            "/rsbb_log/refbox_state": uint8, "/rsbb_log/refbox_state_payload": string,
            "/rsbb_log/client_state": uint8, "/rsbb_log/client_state_payload": string,
            "/rsbb_log/score": "roah_rsbb/Score", "/rsbb_log/end": "std_msgs/Empty",
        })
        states = [STOP, PREPARE, WAITING_RESULT, STOP]
        self.assertEqual(log.values("/rsbb_log/rsbb_state"), states)
        self.assertEqual(log.values("/rsbb_log/refbox_state"), states)
        self.assertEqual(log.values("/rsbb_log/rsbb_state_str"), [state.name for state in states])
        self.assertEqual(log.values("/rsbb_log/rsbb_state_desc")[-1], "Benchmark completed by the robot")
        self.assertIn("benchmark: HGTKMH\nstate: PREPARE", log.values("/rsbb_log/refbox_state_payload")[1])
        self.assertEqual(log.changes("/rsbb_log/client_state"), [*RobotState, RobotState.STOP])
        self.assertIn("messages_saved: 7", log.values("/rsbb_log/client_state_payload")[-1])
        self.assertEqual(
            [((score.group, score.desc), score.value) for score in log.messages("/rsbb_log/score")],
            [(DOOR, 1), (FURNITURE, 3), (FURNITURE, 2), (BUMPS, 1)],
        )
        self.assertEqual(log.entries[-1][0], "/rsbb_log/end")

    def public_line(self):
        """The public display's line of this run."""
        return next(line for line in self.box.public.schedule if (line.team, line.run) == ("Alpha", 3))


class TestCateringForGrannyAnnie(BoxCase):
    """HCFGAC: devices and tablet."""

    def test_a_whole_run(self) -> None:
        self.listener = self.participant(LISTENER)
        self.robot = self.robot("Delta")
        self.devices_are_sent_to_all()
        self.tablet_is_sent_to_all()
        self.box.connect("Room")
        self.box.start("Room")
        self.robot.wait_did("execute HCFGAC")
        self.robot_commands()
        self.robot.let("execute")
        self.box.wait_text("Room", "Benchmark completed by the robot")
        log = self.leave("Room")
        self.assertEqual(log.values("/command"), ["close the blinds"])
        for topic, values in (("devices/switch_1", [1, 0]), ("devices/dimmer", [70]), ("devices/blinds", [100]),
                              ("tablet/display_map", [1])):
            self.assertEqual(log.values(f"/rsbb_log/{topic}"), values, topic)
            self.assertEqual(log.types[f"/rsbb_log/{topic}"], "std_msgs/UInt8")

    def devices_are_sent_to_all(self) -> None:
        publisher = rospy.Publisher("/devices/state", DevicesState, queue_size=1, latch=True)
        self.addCleanup(publisher.unregister)
        for bell, on in ((rospy.Time(1451556000, 123456789), True), (rospy.Time(1451556001, 1), False)):
            publisher.publish(DevicesState(bell, on, False, not on, 35, 80, on))
            self.listener.wait_beacon(
                lambda b, bell=bell, on=on: (
                    (b.devices_bell.sec, b.devices_bell.nsec) == (bell.secs, bell.nsecs)
                    and (b.devices_switch_1, b.devices_switch_2, b.devices_switch_3) == (on, False, not on)
                    and (b.devices_dimmer, b.devices_blinds, b.devices_door_win_detect) == (35, 80, on)
                ), "the beacon carries the devices' state",
            )
        wait_until(lambda: self.robot.devices and self.robot.devices.switch_3, "the robot sees the devices")

    def tablet_is_sent_to_all(self) -> None:
        tablet = self.participant(TABLET)
        now = time.time()
        called, placed = wire(now - 9), wire(now - 3)
        tablet.send(pb.TabletBeacon(last_call=called, last_pos=placed, x=1.25, y=-2.5))
        self.listener.wait_beacon(
            lambda b: (b.tablet_call_time, b.tablet_position_time) == (called, placed)
            and (b.tablet_position_x, b.tablet_position_y) == (1.25, -2.5), "the beacon carries the tablet's state",
        )
        wait_until(lambda: self.box.gui.tablet_position_x == 1.25, "the referee sees the tablet")
        gui = self.box.gui
        self.assertEqual(gui.tablet_position_y, -2.5)
        self.assertAlmostEqual(gui.tablet_call_time.to_sec(), called.sec + called.nsec / 1e9, places=3)
        self.assertAlmostEqual(gui.tablet_position_time.to_sec(), placed.sec + placed.nsec / 1e9, places=3)
        self.assertTrue(now <= gui.tablet_last_beacon.to_sec() <= time.time(), gui.tablet_last_beacon)
        wait_until(lambda: self.robot.tablet and self.robot.tablet.position_x == 1.25, "the robot sees the tablet")

    def robot_commands(self) -> None:
        robot = self.robot
        robot.request("final_command", "close the blinds")
        robot.request("set_device", "switch_1", True)
        robot.request("set_device", "dimmer", 70)
        robot.request("set_device", "blinds", 100)
        self.box.wait_zone("Room", lambda z: "Robot sets blinds to 100" in z.log, "the referee sees the commands")
        robot.request("set_device", "switch_1", False)
        self.box.wait_zone("Room", lambda z: "Robot sets switch_1 to 0" in z.log, "the referee sees the command")
        self.assertFalse(self.listener.beacon.tablet_display_map)
        robot.request("display_map", True)
        self.listener.wait_beacon(lambda b: b.tablet_display_map, "the beacon requests the tablet's map")
        wait_until(lambda: self.box.gui.tablet_display_map, "the referee sees that the tablet shows the map")
