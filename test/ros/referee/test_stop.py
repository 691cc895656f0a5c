"""STOP in the terminal: the real program with a fake core, on a terminal of 40 columns, while something else hangs."""

import contextlib
import fcntl
import itertools
import json
import os
import pty
import signal
import struct
import termios
import threading
import unittest

import rosgraph
from support.fakes.core import Asked, FakeCore
from support.forking import start
from support.programs import own, run
from support.referee_program import Referee, called, referee
from support.waiting import LIMIT_S, happened, wait_until

from roah_rsbb.client.places import file_of, read_place, write_place

COLUMNS = 40
NO_MASTER = "http://127.0.0.1:9"
GERMAN = {"LANG": "de_DE.UTF-8", "LC_ALL": "de_DE.UTF-8", "LANGUAGE": "de"}
NOT_DELIVERED = "STOP Home A: NOT DELIVERED. Stop the robot by hand. Trying again …"
NO_ANSWER = "STOP Home A: NO ANSWER FROM THE ROBOT. Stop it by hand. Trying again …"
STOPPED = "STOP Home A: the robot has stopped"


class Terminal:
    """A referee on a terminal without colours, as wide as a phone in a shirt pocket."""

    def __init__(self, *words: str, **environment: str) -> None:
        self._master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 20, COLUMNS, 0, 0))
        os.environ.pop("COLUMNS", None)
        self._process = start((own("referee"), *words), (slave, slave, slave), TERM="dumb", **environment)
        os.close(slave)
        self.shown = b""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        with contextlib.suppress(OSError):  # the terminal's other end is closed
            while True:
                self.shown += os.read(self._master, 4096)
                happened()
        self._process.wait()
        happened()

    @property
    def lines(self) -> list:
        """What it shows, by lines of the terminal."""
        return self.shown.decode(errors="replace").replace("\r\n", "\n").split("\n")

    @property
    def text(self) -> str:
        """What it shows, as if no line were broken."""
        return " ".join(" ".join(self.lines).split())

    def type(self, line: str) -> None:
        """Type a line."""
        os.write(self._master, f"{line}\n".encode())

    def wait_shown(self, text: str, times: int = 1) -> None:
        """Wait until a text is shown."""
        wait_until(lambda: self.text.count(text) >= times,
                   lambda: f"{text!r} is shown {times} times; it shows\n" + "\n".join(self.lines))

    def signal(self, number: int) -> None:
        """Send it a signal."""
        self._process.send_signal(number)

    def wait_ended(self) -> int:
        """Wait for its end; returns the exit status."""
        status = self._process.wait(LIMIT_S)
        self._reader.join(LIMIT_S)
        return status

    def close(self) -> None:
        """End it by force, if it runs."""
        self._process.kill()
        self._reader.join(LIMIT_S)
        os.close(self._master)


class StopCase(unittest.TestCase):
    """Every test has its own fake core with running robots in Home A and Home B."""

    def setUp(self) -> None:
        self.core = FakeCore()
        self.addCleanup(lambda: self.core.close())
        self.addCleanup(lambda: self.core.answer_gate.set())
        self.zone = self.core.zones["Home A"]

    def running(self, *names: str) -> None:
        """Start runs."""
        for name in names or ("Home A",):
            self.core.zones[name].command("connect", "start")
        self.core.look()

    def terminal(self, *words: str, **environment: str) -> Terminal:
        """A terminal that is closed with the test."""
        found = Terminal(*words, **environment)
        self.addCleanup(found.close)
        return found

    def phases(self) -> list:
        """Of both zones."""
        return [zone.phase for zone in self.core.zones.values()]

    def assert_fits(self, terminal: Terminal) -> None:
        """No line about STOP is longer than the terminal is wide, and there is no colour."""
        self.assertNotIn(b"\x1b", terminal.shown)
        lines = terminal.lines
        begins = [number for number, line in enumerate(lines) if line.startswith("STOP ")]
        self.assertTrue(begins)
        for number in begins:
            more = itertools.takewhile(lambda line: line.startswith("  "), lines[number + 1:])
            self.assertTrue(all(len(line) <= COLUMNS for line in (lines[number], *more)), lines)


class TestStopCommand(StopCase):
    def test_it_shows_its_way_in_every_environment(self) -> None:
        for environment in ({}, GERMAN, {"LC_ALL": "C"}):
            self.running()
            stop = self.terminal("stop", "home a" if environment else "Home A", **environment)
            self.assertEqual(stop.wait_ended(), 0, stop.lines)
            self.assertIn(STOPPED, stop.lines)
            self.assert_fits(stop)
            self.zone.command("disconnect")
        self.assertEqual({call[0] for call in self.core.calls}, {"stop_run"}, "as the panels do")

    def test_all_stops_every_run_in_progress_and_no_other(self) -> None:
        self.running("Home A", "Home B")
        done = called("stop", "all")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for name in ("Home A", "Home B"):
            self.assertIn(f"STOP {name}: the robot has stopped\n", done.stdout)
        self.assertEqual(self.phases(), ["ended", "ended"])
        again = called("stop", "--all")
        self.assertEqual((again.returncode, again.stdout), (0, "no run is in progress\n"))
        self.zone.command("disconnect")
        self.zone.command("connect")
        self.core.look()
        self.assertEqual(called("stop", "alle").stdout, "no run is in progress\n")
        self.assertEqual(self.zone.phase, "connected", "it is not left")

    def test_closed_and_full_streams_lose_no_stop(self) -> None:
        for how in (">&-", "2>&-", "<&-", ">&- 2>&- <&-", ">/dev/full", "--json >/dev/full", ">/dev/full 2>&1",
                    "| true"):
            with self.subTest(how=how):
                self.running()
                done = run("bash", "-c", f"'{own('referee')}' stop 'Home A' {how}")
                self.assertEqual((done.returncode, self.zone.phase, done.stderr), (0, "ended", ""))
                self.zone.command("disconnect")
        done = run("bash", "-c", f"'{own('referee')}' connect 'Home A' >&- <&-")
        self.assertEqual((done.returncode, self.zone.phase), (0, "connected"))

    def test_a_core_that_hangs_gets_it_when_it_continues(self) -> None:
        self.running()
        self.core.answer_gate.clear()
        stop = self.terminal("stop", "Home A")
        stop.wait_shown(NOT_DELIVERED)
        stop.wait_shown("restart it")
        self.assertEqual(stop.text.count("NOT DELIVERED"), 1, "the reason follows it")
        self.assertEqual(self.zone.phase, "running")
        self.core.answer_gate.set()
        stop.wait_shown(STOPPED)
        self.assertEqual(stop.wait_ended(), 0)
        self.assert_fits(stop)

    def test_without_a_core_it_is_tried_until_there_is_one(self) -> None:
        self.core.leave()
        for word, shown in (("Home A", NOT_DELIVERED), ("all", "STOP all zones: NOT DELIVERED. Stop the robot")):
            stop = self.terminal("stop", word)
            stop.wait_shown(shown)
            stop.wait_shown("roslaunch")
            stop.signal(signal.SIGINT)
            self.assertEqual(stop.wait_ended(), 3)
            self.assert_fits(stop)
        stop = self.terminal("stop", "Home A")
        stop.wait_shown(NOT_DELIVERED)
        self.core = FakeCore(silent=True)
        self.zone = self.core.zones["Home A"]
        self.zone.command("connect", "start")
        self.core.silent = False
        stop.wait_shown(STOPPED)
        self.assertEqual(stop.wait_ended(), 0)

    def test_without_a_master_the_file_of_the_door_is_enough(self) -> None:
        self.running()
        found = read_place(file_of(rosgraph.get_master_uri()))
        write_place(file_of(NO_MASTER), found.url, found.token)
        self.addCleanup(os.remove, file_of(NO_MASTER))
        done = referee("stop", "Home A", ROS_MASTER_URI=NO_MASTER)
        self.assertEqual((done.returncode, self.zone.phase), (0, "ended"), done.stderr)

    def test_json_and_the_exit_status_show_how_far_it_came(self) -> None:
        self.running("Home A", "Home B")
        self.core.deaf = True
        stop = Referee("stop", "Home A", "--json")
        self.addCleanup(stop.close)
        lost = stop.event("stop", way="lost_robot")
        self.assertEqual((lost["zone"], lost["not_stopped"]), ("Home A", ["mbot of team TestingTeam"]))
        stop.signal(signal.SIGTERM)
        result = stop.event("result")
        self.assertEqual(stop.wait_ended(), 4)
        self.assertEqual((result["ok"], result["exit"], result["way"], result["state"]["phase"]),
                         (False, 4, "lost_robot", "ended"))
        self.core.deaf = False
        lines = [json.loads(line) for line in referee("stop", "all", "--json").stdout.splitlines()]
        self.assertEqual([(one["zone"], one["way"]) for one in lines[-1]["zones"]], [("Home B", "stopped")])
        self.assertEqual([line["way"] for line in lines[:-1]][-1:], ["stopped"])


class TestStopAtAPrompt(StopCase):
    def test_typed_answers_while_the_answer_hangs(self) -> None:
        run = self.terminal("run", "Home A", "--operations", "typed", **GERMAN)
        wait_until(lambda: self.zone.phase == "running", "it runs")
        self.zone.asked = Asked(1, "Place the mug")
        run.wait_shown("press Enter when it is done")
        self.core.held = "operation"
        self.core.answer_gate.clear()
        run.type("")
        wait_until(lambda: ("operation", "Home A", 1, "") in self.core.calls, "the answer is on its way")
        run.type("stop")
        run.wait_shown(STOPPED)
        self.assertEqual(self.zone.phase, "ended")
        self.assertFalse(self.core.answer_gate.is_set(), "the other call still hangs")
        self.core.answer_gate.set()
        run.wait_shown("stopped, and left connected")
        self.assertEqual(run.wait_ended(), 4)
        self.assertEqual(self.zone.phase, "ended")
        self.assert_fits(run)

    def test_a_stop_is_no_answer(self) -> None:
        run = self.terminal("run", "Home A", "--operations", "typed")
        wait_until(lambda: self.zone.phase == "running", "it runs")
        self.core.zones["Home B"].command("connect", "start")
        self.zone.asked = Asked(1, "Whom?", ("Annie", "Tom"), True)
        run.wait_shown("type Annie / Tom, or another answer (Enter: Annie)")
        run.type("stop home b")
        run.wait_shown("STOP Home B: the robot has stopped")
        self.assertEqual(self.phases(), ["running", "ended"])
        run.type("tom")
        wait_until(lambda: ("operation", "Home A", 1, "Tom") in self.core.calls, "the answer arrives")
        run.type("stop Hone C")
        run.wait_shown("NOT STOPPED: no zone 'Hone C'")
        run.type("STOPP ALLE!")
        run.wait_shown(STOPPED)
        self.assertEqual(run.wait_ended(), 4)

    def test_the_question_of_a_sign_off(self) -> None:
        self.running()
        self.zone.command("stop", "disconnect")
        self.running("Home A", "Home B")
        sign = self.terminal("sign-off", "Home A", "--run", "last", "--by", "Cleo")
        sign.wait_shown("[y/N]")
        sign.type("stop")
        sign.wait_shown(STOPPED)
        sign.wait_shown("[y/N]", times=2)  # it is asked again
        self.assertGreater(sign.text.rindex("[y/N]"), sign.text.rindex(STOPPED))
        self.assertEqual(self.phases(), ["ended", "running"])
        self.core.held = "sign_off"
        self.core.answer_gate.clear()
        sign.type("y")
        wait_until(lambda: ("sign_off", "Home A") in self.core.calls, "the sheet is being signed")
        sign.type("stop all")
        sign.wait_shown("STOP Home B: the robot has stopped")
        self.assertEqual(self.phases(), ["ended", "ended"])
        self.core.answer_gate.set()
        sign.wait_shown("signed off by Cleo")
        self.assertEqual(sign.wait_ended(), 0)
        self.assert_fits(sign)

    def test_a_program_waits_for_the_stop_that_was_typed_in_it(self) -> None:
        self.running()
        self.zone.command("stop", "disconnect")
        self.running()
        self.core.deaf = True
        sign = self.terminal("sign-off", "Home A", "--run", "last", "--by", "Cleo")
        sign.wait_shown("[y/N]")
        sign.type("stop")
        sign.wait_shown(NO_ANSWER)
        sign.type("n")
        self.core.deaf = False
        sign.wait_shown(STOPPED)
        sign.wait_shown("not signed off")
        self.assertEqual(sign.wait_ended(), 1)

    def test_a_short_command_that_waits(self) -> None:
        self.running("Home A", "Home B")
        for word, zone in (("Stop home b", "Home B"), ("stop", "Home A")):
            with self.subTest(word=word):
                self.core.held = "pause"
                self.core.answer_gate.clear()
                pause = self.terminal("pause", "home a", **GERMAN)
                pause.wait_shown("type 'stop'")
                pause.type("start Home A")
                pause.type(word)
                pause.wait_shown(f"STOP {zone}: the robot has stopped")
                self.assertEqual(self.core.zones[zone].phase, "ended")
                self.assertFalse(self.core.answer_gate.is_set(), "the other call still hangs")
                self.core.answer_gate.set()
                self.assertIn(pause.wait_ended(), (0, 1))
                self.assert_fits(pause)

    def test_what_is_typed_during_a_fast_command_is_for_the_shell(self) -> None:
        pause = self.terminal("connect", "Home A")
        self.assertEqual(pause.wait_ended(), 0)
        self.assertNotIn("type 'stop'", pause.text)

    def test_watch(self) -> None:
        self.running("Home A", "Home B")
        watch = self.terminal("watch")
        watch.wait_shown("type 'stop ZONE'")
        watch.type("stop")
        watch.wait_shown("2 runs are in progress")
        watch.type("stop home b")
        watch.wait_shown("STOP Home B: the robot has stopped")
        watch.type("stop")
        watch.wait_shown(STOPPED)
        watch.type("stop")
        watch.wait_shown("no runs are in progress")
        watch.signal(signal.SIGINT)
        self.assertEqual(watch.wait_ended(), 0)

    def test_an_interrupt_does_not_leave_a_robot_that_does_not_stop(self) -> None:
        """The box repeats STOP as long as the run is connected."""
        run = self.terminal("run", "Home A")
        wait_until(lambda: self.zone.phase == "running", "it runs")
        self.core.deaf = True
        run.signal(signal.SIGINT)
        run.wait_shown(NO_ANSWER)
        self.assertEqual(run.wait_ended(), 130)
        self.assertEqual(self.zone.phase, "ended")
