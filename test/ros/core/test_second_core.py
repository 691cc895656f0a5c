"""A second core at the same ROS master takes nothing over while the first one runs: clients would lose their box."""

import pathlib
import signal
import tempfile

from support.own_core import PARAMS, OwnCoreCase
from support.programs import Program, own


class TestSecondCore(OwnCoreCase):
    def test_it_waits_until_the_first_one_has_ended(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        first, second = pathlib.Path(folder.name, "first"), pathlib.Path(folder.name, "second")
        self.start_core(first)
        uuid, core = self.box.uuid, self.core
        for name in ((), ("__name:=second_core",)):
            other = self._leaving(Program(own("roah_rsbb_core"), *name, *(
                f"_{key}:={value}" for key, value in {**PARAMS, "log_dir": second}.items())))
            other.wait_printed("is running at this ROS master. This one takes nothing over")
            if not name:
                other.signal(signal.SIGINT)
                other.wait_ended()
        self.robot("Alpha")
        self.box.connect("Home")
        self.box.command("disconnect", "Home")
        self.assertEqual(self.box.uuid, uuid)
        core.kill()
        other.wait_printed("the other core has ended")
        self.box.wait_other_core(uuid)
