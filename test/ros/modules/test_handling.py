"""HOMF, whole, with dummy robot, and a referee who enters switches."""


from support.modules_case import FunctionalityCase

from roah_rsbb.srv import Zone, ZoneUInt8


class TestHandling(FunctionalityCase):
    def test_homf(self) -> None:
        """The robot first toggles the requested switches, then one too many, and damages one."""
        robot = self.dummy_robot("Zeta")
        entries = [((2, 3), 0), ((1, 2), 1)]

        def enter() -> None:
            pressed, damaged = entries.pop(0)
            for switch in pressed:
                self.box.call("omf_switches/button", ZoneUInt8, "HOMF", switch)
            self.box.call("omf_switches/damaged", ZoneUInt8, "HOMF", damaged)
            self.box.call("omf_switches/complete", Zone, "HOMF")
            self.box.wait_zone("HOMF", lambda z: not z.omf_complete, "they are confirmed")

        scores, _ = self.conduct("HOMF", enter)
        self.assertEqual([scores["", name] for name in ("right", "wrong", "damaged")], [3, 1, 1])
        self.assertEqual(self.of_each(scores, "changed"), ["2, 3", "1, 2"])
        robot.wait_printed("initial_state (True, False, False), switches (2, 3)")
