"""An earlier run is published again: as it was, marked as a replay, without commands, and never beside a core."""

import contextlib
import itertools
import pathlib
import socket
import tempfile
import threading
import unittest
from typing import List
from unittest import mock
from urllib.parse import urlsplit
from xmlrpc.server import SimpleXMLRPCServer

import rosgraph
from support.box_client import Refusal
from support.own_core import OwnCoreCase
from support.programs import Program, own, run
from support.waiting import wait_until

from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.model.document import REPLAY as PREFIX
from roah_rsbb.model.document import Document
from roah_rsbb.ros.places import REPLAY, live_core

REASON = ("This is a replay of HGTKMH, team Alpha, round 1, run 1: nothing here is live, and commands have no effect")


class TestLiveCore(unittest.TestCase):
    def test_a_core_that_hangs_counts_only_if_that_is_wanted(self) -> None:
        with socket.create_server(("127.0.0.1", 0)) as hanging, \
                mock.patch("rosgraph.Master") as master:
            master().getSystemState.return_value = [[("/core/to_gui", ["/hanging"])], [], []]
            master().lookupNode.return_value = f"http://127.0.0.1:{hanging.getsockname()[1]}"
            self.assertEqual([live_core(REPLAY, 0.1, if_silent) for if_silent in (True, False)], ["/hanging", None])


class TestReplay(OwnCoreCase):
    def test_panels_see_the_run_again(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        log_dir = pathlib.Path(folder.name)
        journal = str(log_dir / JOURNAL)
        self.start_core(log_dir)
        robot = self.robot("Alpha")
        self.box.connect("Home")
        identity = self.box.zone_details("Home").identity
        # A replay on a busy machine may not publish a phase that is over at once. It begins with the first who listens
        # to its topics: a client of its door, which looks for it every two seconds, may come later.
        self.let_pass(4.0)
        self.box.start("Home")
        robot.wait_did("execute HGTKMH")
        self.let_pass()
        self.box.command("stop", "Home")
        self.let_pass()
        self.box.command("disconnect", "Home")

        refused = run(own("replay"), journal, "1")
        self.assertEqual((refused.returncode, refused.stdout), (1, ""))
        self.assertRegex(refused.stderr, "replay: the core /roah_rsbb_core.* is running: .*End the core first")

        port = urlsplit(rosgraph.Master("/test").lookupNode(refused.stderr.split()[3])).port
        self.core.kill()  # the master still lists it
        self._occupy(port)
        self.box.public = None
        documents: List[Document] = []
        self.box.on_document = documents.append
        replay = self._leaving(Program(own("replay"), journal, identity))
        replay.wait_printed("The run is over. Its last moment stays")
        wait_until(lambda: documents and documents[-1].box.is_replay and documents[-1].zones["Home"].phase == "idle",
                   "the end of the run is heard")
        wait_until(lambda: self.box.public and self.box.public.clock.startswith(PREFIX), "the public display is marked")
        replayed = [document for document in documents if document.box.is_replay]
        doing = [run.doing for document in replayed for run in document.runs_shown()]
        self.assertEqual((doing[0], doing[-1]), ("waiting", "ended"))
        self.assertIn("executing", doing)
        self.assertEqual(replayed[-1].public_runs, {}, "nothing is explained after the run")
        zones = [document.zones["Home"] for document in replayed]
        phases = [phase for phase, _ in itertools.groupby(zone.phase for zone in zones)]
        self.assertEqual(phases, ["connected", "running", "ended", "idle"])
        for zone in zones:
            self.assertEqual((zone.zone, zone.off("stop"), zone.off("connect")),
                             ("Home", (REASON,), (REASON,)))
        *_, ended = (zone for zone in zones if zone.phase == "ended")
        self.assertEqual((ended.identity, ended.end_reason, ended.robot.robot_state), (identity, "stopped", "STOP"))
        self.assertEqual(replayed[0].box.warnings, (REASON,))
        wait_until(lambda: self.box.gui.status == REASON, "the status says it, too")
        ended_at = self.box.gui.clock
        wait_until(lambda: self.box.gui.clock > ended_at, "panels see that the replay still runs")
        with self.assertRaisesRegex(Refusal, REASON):
            self.box.command("stop", "Home")

        # A core that starts beside it ends it.
        self.start_core(log_dir)
        self.assertEqual(replay.wait_ended(), 1)
        self.assertIn("is running: a replay beside it would mix", replay.text)

    def _occupy(self, port: int) -> None:
        """Another program gets the port of the core."""
        with contextlib.suppress(OSError):  # another program has got it already
            server = SimpleXMLRPCServer(("", port), logRequests=False)
            self.addCleanup(server.server_close)
            threading.Thread(target=server.serve_forever, daemon=True).start()
            self.addCleanup(server.shutdown)

    def let_pass(self, seconds: float = 1.0) -> None:
        """Let time pass by the core's clock."""
        end = self.box.gui.clock.to_sec() + seconds
        wait_until(lambda: self.box.gui.clock.to_sec() > end, "time passes")
