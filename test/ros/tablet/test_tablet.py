"""The tablet at the box, without a browser."""

import socket
import time
from typing import Callable

from support import tablet_nodes
from support.box_case import LISTENER, TABLET, BoxCase
from support.programs import Program, own
from support.robots import BROADCAST, RSBB_PORT, wire
from support.waiting import wait_until

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

OTHER_TABLET = "127.0.0.5"
# A regular beacon each second, and no more than twenty others.
MOST_BEACONS_A_SECOND = 21
NEVER = pb.Time(sec=0, nsec=0)
ABSURD = (
    pb.TabletBeacon(last_call=pb.Time(sec=-1, nsec=-1), last_pos=NEVER, x=0.0, y=0.0),
    pb.TabletBeacon(last_call=NEVER, last_pos=pb.Time(sec=2**63 - 1, nsec=2**63 - 1), x=0.0, y=0.0),
    pb.TabletBeacon(last_call=NEVER, last_pos=pb.Time(sec=5, nsec=0), x=float("nan"), y=float("-inf")),
)


class TestTablet(BoxCase):
    """Its beacons at the box, the referee's and the robot's."""

    def test_the_dummy_tablet_reaches_the_robot(self) -> None:
        robot = self.robot("Delta")
        wait_until(lambda: robot.tablet, "the robot hears the box")
        tablet = self._leaving(Program(
            own("dummy_tablet"), "--host", BROADCAST, "--port", str(RSBB_PORT), "--bind", TABLET,
            "--call", "--position=1.5,-2.25",
        ))
        tablet.wait_printed("the box has published the call")
        tablet.wait_printed("the box has published the position")
        wait_until(lambda: robot.tablet.position_y == -2.25, "the robot hears the position")
        self.assertEqual(robot.tablet.position_x, 1.5)
        self.assertLess(abs(time.time() - robot.tablet.call_time[0]), 60)
        wait_until(lambda: self.box.gui.tablet_position_y == -2.25, "the referee sees the position")
        self.box.connect("Room")
        self.box.start("Room")
        robot.wait_did("execute HCFGAC")
        robot.request("display_map", True)
        tablet.wait_printed("the box requests the view: map")
        robot.request("display_map", False)
        tablet.wait_printed("the box requests the view: call button", 2)
        tablet.close()
        wait_until(lambda: "The tablet has been silent" in self.box.gui.status, lambda: str(self.box.gui))

    def test_a_flood_makes_no_storm_and_its_last_word_gets_through(self) -> None:
        listener, tablet = self.participant(LISTENER), self.participant(TABLET)
        listener.wait_beacon(lambda b: True, "the box sends beacons")
        self.wait_no_tablet()
        began, before = time.monotonic(), self.count_beacons(listener)
        first = time.time()
        for number in range(2000):
            tablet.send(pb.TabletBeacon(last_call=wire(first + number / 1e3), last_pos=NEVER, x=0.0, y=0.0))
        last = wire(first + 1999 / 1e3)
        # A tablet says its last word again each second; of so many at once some are lost or not accepted.
        wait_until(lambda: tablet.send(pb.TabletBeacon(last_call=last, last_pos=NEVER, x=0.0, y=0.0))
                   or listener.beacon.tablet_call_time == last, "the beacon carries the last call")
        beacons, seconds = self.count_beacons(listener) - before, time.monotonic() - began
        self.assertLessEqual(beacons, MOST_BEACONS_A_SECOND * (seconds + 1))

    def test_absurd_values_reach_only_the_referee(self) -> None:
        listener, tablet = self.participant(LISTENER), self.participant(TABLET)
        self.wait_no_tablet()
        called = wire(time.time())
        for beacon in ABSURD:
            tablet.send(beacon)
        self.box_says(f"The tablet at {TABLET} sends")
        tablet.send(pb.TabletBeacon(last_call=called, last_pos=NEVER, x=0.0, y=0.0))
        listener.wait_beacon(lambda b: b.tablet_call_time == called, "the beacon carries what is sane")
        self.assertFalse([m for m, _ in listener.heard if isinstance(m, pb.RoahRsbbBeacon) and (
            m.tablet_call_time.sec < 0 or m.tablet_position_time.sec > 2**32)])

    def test_two_tablets_are_reported(self) -> None:
        listener, first = self.participant(LISTENER), self.participant(TABLET)
        second = self.participant(OTHER_TABLET)
        self.wait_no_tablet()
        called = wire(time.time())
        first.send(pb.TabletBeacon(last_call=called, last_pos=NEVER, x=0.0, y=0.0))
        listener.wait_beacon(lambda b: b.tablet_call_time == called, "the first one counts")
        later = wire(time.time() + 5)
        # In turns: the second one counts as soon as the first is silent for a few seconds.
        self.box_says(f"Two tablets are on: {TABLET} counts, {OTHER_TABLET} is ignored", lambda: [
            tablet.send(pb.TabletBeacon(last_call=call, last_pos=NEVER, x=0.0, y=0.0))
            for tablet, call in ((first, called), (second, later))
        ])
        self.assertEqual(listener.beacon.tablet_call_time, called)

    def box_says(self, text: str, meanwhile: Callable[[], object] = lambda: None) -> None:
        wait_until(lambda: (meanwhile(), text in self.box.gui.status)[1],
                   lambda: f"'{text}' is shown, not {self.box.gui.status}")
        wait_until(lambda: any(text in w for w in self.box.warnings), "the same is in the details")

    def wait_no_tablet(self) -> None:
        """Wait until the box has forgotten the tablet of the test before."""
        wait_until(
            lambda: not self.box.gui.tablet_last_beacon.to_sec() or "The tablet has been silent" in self.box.gui.status,
            "no tablet is there",
        )

    @staticmethod
    def count_beacons(listener) -> int:
        return sum(isinstance(message, pb.RoahRsbbBeacon) for message, _ in list(listener.heard))


class TestNode(BoxCase):
    """The node, where something is missing."""

    def test_without_a_browser_no_tablet_is_announced(self) -> None:
        listener = self.participant(LISTENER)
        tablet_nodes.launched_url()
        listener.wait_beacon(lambda b: True, "the box sends beacons")
        wait_until(lambda: self.count_of(listener, pb.RoahRsbbBeacon) >= 3, "time passes")
        self.assertEqual(self.count_of(listener, pb.TabletBeacon), 0)

    @staticmethod
    def count_of(listener, kind) -> int:
        return sum(isinstance(message, kind) for message, _ in list(listener.heard))

    def test_a_port_in_use_is_reported_once_and_used_when_it_is_free(self) -> None:
        with socket.socket() as other:
            other.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            other.bind(("127.0.0.1", tablet_nodes.OWN_TABLET_PORT))
            other.listen()
            started = self._leaving(tablet_nodes.node())
            started.wait_printed("choose another tablet_port")
        started.wait_printed(f"The tablet's page: open {tablet_nodes.own_url()}")
        self.assertEqual(started.text.count("choose another tablet_port"), 1)

    def test_wrong_parameters_and_a_wrong_map_are_reported(self) -> None:
        started = self._leaving(tablet_nodes.node(map_file="/none.yaml"))
        started.wait_printed("/none.yaml: cannot be read")
        started.wait_printed("The tablet's page: open")
        started.close()
        wrong = self._leaving(tablet_nodes.node(tablet_port=70000, rsbb_port=0))
        self.assertEqual(wrong.wait_ended(), 1)
        for name in ("tablet_port", "rsbb_port"):
            self.assertIn(f"parameter /own_tablet/{name}", wrong.text)
        self.assertNotIn("Traceback", wrong.text)

    def test_where_no_broadcast_is_heard_the_page_is_served_all_the_same(self) -> None:
        started = self._leaving(tablet_nodes.node(rsbb_host="127.0.0.77"))
        started.wait_printed("127.0.0.77 is not a broadcast address of this machine")
        started.wait_printed("The tablet's page: open")
