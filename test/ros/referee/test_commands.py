"""The terminal referee with a fake core: real messages, real services.

It is called in the test's process, and is a process of its own where that matters: how it starts and ends, its exit
status, its signals, its files and what it leaves at the master.
"""

import contextlib
import json
import os
import signal
import socket
import subprocess
import tempfile
import unittest
import unittest.mock
from typing import Any, Iterator

import rosgraph
import rospy
from support.fakes.core import EVENTS, TOKEN, Asked, FakeCore
from support.forking import start
from support.programs import own
from support.referee_program import Referee, called, referee
from support.waiting import LIMIT_S, wait_until

from roah_rsbb.client import places as place
from roah_rsbb.client.places import write_place
from roah_rsbb.referee import link
from roah_rsbb.scoring.sheet import Mark

# The time limit for what never answers.
SOON_S = 0.5
DOOR = ("Achievements", "The robot detects the door with changed state")


class WithCore(unittest.TestCase):
    """Every test has its own fake core with the zones Home A and Home B."""

    def setUp(self) -> None:
        self.core = FakeCore()
        self.zone = self.core.zones["Home A"]

    def tearDown(self) -> None:
        self.core.close()

    def called(self, *words: str, **options: Any) -> "subprocess.CompletedProcess[str]":
        """Call the referee in this process, when the core knows what the test changed in it."""
        self.core.look()
        return called(*words, **options)

    def done(self, *words: str) -> str:
        """Call a command that is done; what it prints."""
        done = self.called(*words)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def shown(self, *words: str) -> Any:
        """Call a command; its JSON."""
        return json.loads(self.called(*words, "--json").stdout)

    def refused(self, text: str, *words: str, status: int = 1) -> None:
        """Call a command that is refused, or wrong, for this reason."""
        done = self.called(*words)
        self.assertEqual((done.returncode, done.stderr.count(text)), (status, 1), done.stderr)

    def start(self, *words: str, typed: str = "") -> Referee:
        """A referee that is ended with the test."""
        started = Referee(*words, typed=typed)
        self.addCleanup(started.close)
        return started


class TestCommands(WithCore):
    def test_status_by_rosrun(self) -> None:
        done = subprocess.run(["rosrun", "roah_rsbb", "referee", "status"], capture_output=True, text=True,
                              timeout=LIMIT_S)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for text in ("RSBB at 127.255.255.255:6666", "TestingTeam  mbot   ▮▮▮ good  +0.012 s", "Home A: NOT CONNECTED",
                     "Home B: NOT CONNECTED"):
            self.assertIn(text, done.stdout)
        self.assertNotIn("\x1b", done.stdout)

    def test_status_as_json(self) -> None:
        self.core.box_warnings = ["Another box"]
        self.core.look()
        box = json.loads(referee("status", "--json").stdout)
        self.assertEqual([zone["zone"] for zone in box["zones"]], ["Home A", "Home B"])
        self.assertEqual(box["warnings"], ["Another box"])
        self.assertEqual(self.shown("status", "home b")["zone"], "Home B")

    def test_each_command_reaches_its_zone(self) -> None:
        for command, phase in (("connect", "CONNECTED"), ("start", "RUNNING"), ("stop", "the robot has stopped"),
                               ("disconnect", "NOT CONNECTED")):
            self.assertIn(phase, self.done(command, "home a"))
        self.assertIn("the run is not signed off: sign it off first", referee("next", "home a").stderr)
        for command, phase in (("next", "HWV"), ("previous", "HGTKMH")):
            self.assertIn(phase, self.done(command, "home a", "--yes"))
        calls = [call for call in self.core.calls if call != ("stop_run", "home a")]  # tried before the zones are known
        self.assertEqual(calls, [(command, "Home A") for command in
                                 ("connect", "start", "stop_run", "disconnect", "next", "previous")])

    def test_a_run_whose_robot_does_not_stop_is_left_only_on_purpose(self) -> None:
        zone = self.core.zones["Home A"]
        for leave in (("disconnect", "home a"), ("choose", "home a", "2", "--unsigned"),
                      ("withdrawn", "home a", "TestingTeam")):
            with self.subTest(leave=leave):
                zone.command("connect", "start")
                self.core.deaf = True
                zone.command("stop")
                self.refused("mbot of team TestingTeam did not answer STOP. After the disconnect the box does not "
                             "repeat it: stop by hand first. Then give --yes", *leave)
                self.assertEqual(zone.phase, "ended")
                self.done(*leave, "--yes")
                self.assertEqual(zone.phase, "idle")
                self.core.deaf = False
                self.core.box.zones["Home A"].move(-zone.index)

    def test_a_run_in_progress_is_stopped_before_it_is_left(self) -> None:
        zone = self.core.zones["Home A"]
        zone.command("connect", "start")
        before = len(self.core.calls)
        self.done("disconnect", "home a")
        self.assertEqual([call[0] for call in self.core.calls[before:]], ["stop_run", "disconnect"])
        zone.command("connect", "start")
        self.core.deaf = True
        self.refused("did not answer STOP", "disconnect", "home a")
        self.assertEqual(zone.phase, "ended")
        self.done("disconnect", "home a", "--yes")
        self.core.deaf = False

    def test_a_run_without_a_robot_and_a_team_that_does_not_appear(self) -> None:
        for command, shown in (("open-sheet", "Without a robot"), ("start", "RUNNING"),
                               ("stop", "the clock is stopped"), ("withdrawn", "NOT CONNECTED"),
                               ("no-show", "NOT CONNECTED")):
            teams = [self.core.box.zones["Home A"].event.team] if command in ("withdrawn", "no-show") else []
            self.assertIn(shown, self.done(command, "home a", *teams))
        ends = [record.end_reason for record in self.core.box.finished.records()]
        self.assertEqual(ends, ["no_show", "withdrawn"])
        self.assertIn("no-show, no score", self.called("runs", "home a").stdout)
        self.refused("not of team Nobody: choose the event", "withdrawn", "home a", "Nobody")
        self.assertEqual(self.called("withdrawn", "home a").returncode, 2)
        refused = referee("pause", "home a")
        self.assertEqual((refused.returncode, refused.stderr), (
            1, "referee: pause was refused:\n  The rules of this benchmark do not allow a pause\n"))

    def test_one_of_several_robots_connects(self) -> None:
        second = self.shown("status", "Home A")["robots_to_choose"][1]
        connected = self.shown("connect", "Home A", "--robot", second)["state"]
        self.assertEqual((connected["robot"], connected["robots_to_choose"]), (second, []))
        self.assertIn("No robot 'nobody' of team", referee("connect", "Home B", "--robot", "nobody").stderr)

    def test_the_schedule_and_the_choice_of_an_event(self) -> None:
        lines = self.called("schedule", "home a", "--utc").stdout.splitlines()
        self.assertEqual(len(lines), 1 + len(EVENTS) + 2)
        self.assertIn("Home A  1*   2015-11-01 08:00  ~08:12  +12 min  HGTKMH, team TestingTeam", lines[1])
        events = self.shown("schedule", "--team", "AnotherTeam")["events"]
        self.assertEqual([(event["zone"], event["number"], event["late_s"]) for event in events],
                         [("Home A", 2, 720.0), ("Home B", 2, 720.0)])
        self.assertEqual(self.called("schedule", "--show", "unsigned").stdout.splitlines()[-1], "no events")
        self.assertIn("HCFGAC", self.done("choose", "home a", "3"))
        self.done("choose", "Home A", "1", "--unsigned")
        self.assertEqual(self.core.calls, [
            ("choose_event", "Home A", "HCFGAC", False), ("choose_event", "Home A", "HGTKMH", True)])
        self.refused("there are 1 to 3", "choose", "Home A", "4", status=2)

    def test_a_refusal_has_every_reason(self) -> None:
        self.zone.extra_off["connect"] = ["one thing; and what to do", "another thing"]
        done = referee("connect", "Home A")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr, "referee: connect was refused:\n  one thing; and what to do\n  another thing\n")
        made = self.shown("connect", "Home A")
        self.assertEqual((made["ok"], made["exit"], made["reasons"]),
                         (False, 1, ["one thing; and what to do", "another thing"]))

    def test_scores_are_shown_set_and_counted(self) -> None:
        self.assertEqual(self.called("score", "Home A").returncode, 1)  # no run, no sheet
        self.zone.command("connect")
        self.assertIn("1     no  " + DOOR[1], self.called("score", "Home A").stdout)
        self.assertEqual(self.called("score", "Home A", "door", "yes").stdout, f"{DOOR[0]}: {DOOR[1]}: yes\n")
        for value in ("1", "2", "3"):
            made = self.shown("score", "Home A", "2", "+1")
            self.assertEqual((made["ok"], made["number"], made["value"]), (True, 2, int(value)))
        self.assertEqual([call[-1] for call in self.core.calls], [1, "+1", "+1", "+1"])
        self.refused("its value must be 0 or more, not -1", "score", "Home A", "2", "-4")
        self.assertEqual(self.called("score", "Home A", "door").returncode, 2)

    def test_scores_with_words_and_their_history(self) -> None:
        self.zone.command("connect")
        done = self.done("score", "Home A", "door", "yes", "--note", "through the window", "--by", "Anna")
        self.assertEqual(done, f"{DOOR[0]}: {DOOR[1]}: yes\n")
        self.assertEqual(self.core.words, [(self.zone.identity, "through the window", "Anna")])
        self.assertEqual(self.called("score", "Home A", "door", "n/a").stdout, f"{DOOR[0]}: {DOOR[1]}: not attempted\n")
        self.assertIn("not attempted  " + DOOR[1], self.called("score", "Home A").stdout)
        sheet = self.shown("sheet", "Home A")["sheet"]
        self.assertEqual([(e["value"], e["not_attempted"], e["note"]) for e in sheet["history"]],
                         [(1, False, "through the window"), (0, True, "")])
        done = self.done("withdraw", "Home A", "2", "--note", "it did try")
        self.assertIn("; withdrawn by no name at", done)
        self.assertIn("1    yes  " + DOOR[1], done)
        self.refused("entry 2 was withdrawn already", "withdraw", "Home A", "2")

    def test_a_run_that_is_over_is_corrected_and_signed_off(self) -> None:
        sign_off = ("sign-off", "Home A", "--run", "last", "--by", "Cleo")
        self.refused("'--run last'", "withdraw", "Home A", "1")
        self.assertEqual(self.called("sign-off", "Home A", "--run", "last").returncode, 2)
        self.refused("no run", *sign_off, status=2)
        self.zone.command("connect")
        self.zone.command("start")
        identity = self.zone.identity
        self.zone.command("stop")
        self.refused("disconnect it first", *sign_off, "--yes")
        self.assertIn("Benchmark stopped by the referee", self.called("reason", "Home A", "fire alarm").stdout)
        self.zone.command("disconnect")
        self.assertIn("not signed off", self.called("runs", "Home A").stdout)
        self.assertIn("Home B:\n    no run is connected or over", self.called("runs").stdout)
        self.assertIn("no  " + DOOR[1], self.called("score", "Home A", "--run", "last").stdout)
        self.assertIn(": yes", self.called("score", "Home A", "door", "yes", "--run", identity[:11]).stdout)
        (run,) = self.shown("runs")["runs"]
        self.assertEqual((run["identity"], run["corrected"], run["signed_utc_s"]), (identity, True, None))
        self.refused("give --yes", *sign_off, status=2)
        done = self.done(*sign_off, "--yes")
        self.assertIn("corrected, signed off by Cleo at", done)
        self.assertIn("fire alarm", done)
        self.refused("signed off by Cleo", "score", "Home A", "door", "no", "--run", "last")

    def test_a_manual_operation_is_done_and_answered(self) -> None:
        self.refused("no manual operation is requested now", "done", "Home A")
        self.zone.asked = Asked(4, "No pose of the robot", ("try again", "skip"))
        self.assertIn("TO DO by the referee: No pose of the robot (try again / skip)", self.called("status").stdout)
        self.assertEqual(self.called("done", "Home A", "fly").returncode, 2)
        self.assertEqual(self.called("done", "Home A", "--operation", "3").returncode, 1)
        self.assertEqual(self.core.calls, [])
        self.assertNotIn("TO DO", self.done("done", "Home A", "sk", "--operation", "4"))
        self.assertEqual(self.core.calls, [("operation", "Home A", 4, "skip")])

    def test_colour_on_a_terminal_only_and_not_where_it_is_unwanted(self) -> None:
        for has_colour, words, environment in (
            (True, ["status"], {"NO_COLOR": ""}), (False, ["status"], {"NO_COLOR": "1"}),
            (False, ["status"], {"TERM": "dumb"}), (False, ["status", "--json"], {}),
        ):
            shown = self.called(*words, on_terminal=True, **{"TERM": "xterm", **environment}).stdout
            self.assertIn("TestingTeam", shown)
            self.assertEqual("\x1b[" in shown, has_colour, environment)

    def test_nothing_is_left_at_the_master(self) -> None:
        self.assertEqual(referee("status").returncode, 0)
        state = rosgraph.Master("/test").getSystemState()
        self.assertNotRegex(str(state), r"/referee_\d")  # a program is /referee_<pid>_<time>


class TestNoCore(unittest.TestCase):
    """Whatever does not answer is reported. The time of a process is limited."""

    def setUp(self) -> None:
        self.file = place.file_of(rosgraph.get_master_uri())
        with contextlib.suppress(FileNotFoundError):
            os.remove(self.file)
        with contextlib.suppress(KeyError):
            rospy.delete_param(place.PARAM)

    def assert_reported(self, hint: str, done: "subprocess.CompletedProcess[str]") -> None:
        self.assertEqual(done.returncode, 3)
        self.assertIn(hint, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def test_no_master(self) -> None:
        self.assert_reported("set ROS_MASTER_URI", referee("status", ROS_MASTER_URI="http://127.0.0.1:9"))

    def test_without_a_master_uri_it_is_the_default_of_ros(self) -> None:
        with unittest.mock.patch.dict(os.environ):
            del os.environ["ROS_MASTER_URI"]
            self.assertEqual(place.DoorPlaces().master_uri.rstrip("/"), rosgraph.get_master_uri(argv=[]).rstrip("/"))

    def test_a_master_that_hangs(self) -> None:
        with self.mute() as port, unittest.mock.patch.object(place, "ANSWER_S", SOON_S):
            self.assert_reported("does not answer", called("status", ROS_MASTER_URI=f"http://127.0.0.1:{port}"))

    def test_no_core(self) -> None:
        self.assert_reported("roslaunch roah_rsbb roah_rsbb.launch", called("status"))
        self.assert_reported("no box", called("run", "Home A", "--wait", "0.5"))

    def test_a_core_that_has_ended(self) -> None:
        FakeCore().close()
        done = called("status")
        self.assert_reported("no connection to the box at ws://127.0.0.1:", done)
        self.assert_reported("roslaunch roah_rsbb roah_rsbb.launch", done)

    def test_a_core_that_hangs(self) -> None:
        with self.mute() as port, unittest.mock.patch.object(link, "CORE_S", SOON_S):
            write_place(self.file, f"ws://127.0.0.1:{port}/door", TOKEN)
            self.assert_reported("the box is silent", called("status"))

    def test_a_core_that_does_not_answer_a_command(self) -> None:
        core = FakeCore()
        self.addCleanup(core.close)
        core.answer_gate.clear()
        done = referee("connect", "Home A")  # it ends although its call still waits
        self.assertEqual(done.returncode, 3)
        self.assertIn("did not answer", done.stderr)

    @contextlib.contextmanager
    def mute(self) -> Iterator[int]:
        """A server that accepts connections, and says nothing. Yields its port."""
        with socket.socket() as listening:
            listening.bind(("127.0.0.1", 0))
            listening.listen(5)
            yield listening.getsockname()[1]


class TestWatch(WithCore):
    def test_what_happens_is_reported_in_lines_with_their_time(self) -> None:
        watch = self.start("watch", "--utc", "--zone", "Home A")
        watch.line(lambda line: "allowed now" in line, "the status")
        self.zone.command("connect")
        connected = watch.line(lambda line: "CONNECTED" in line, "connected")
        self.assertRegex(connected, r"^\d\d:\d\d:\d\dZ Home A: CONNECTED to mbot on UDP port 6667")
        self.zone.online_data += "12:00:00Z visitor: postman\n"
        watch.wait_printed("\n12:00:00Z Home A: online data: visitor: postman")
        self.zone.mark(Mark(*DOOR, 1), "Anna")
        watch.wait_printed(f"Home A: score: {DOOR[0]}: {DOOR[1]}: no → yes")
        self.core.zones["Home B"].command("connect")
        self.zone.warnings.append("Robot is silent")
        watch.wait_printed("Z Home A: WARNING: Robot is silent")
        self.core.robots.pop(0)
        watch.wait_printed("Z robot TestingTeam mbot is GONE: no longer heard")
        watch.signal(signal.SIGINT)
        self.assertEqual(watch.wait_ended(), 0)
        self.assertFalse([line for line in watch.lines if "Home B" in line])

    def test_a_reader_that_goes_away_ends_it(self) -> None:
        reading, writing = os.pipe()
        with tempfile.TemporaryFile() as errors:
            watch = start((own("referee"), "watch"), (errors.fileno(), writing, errors.fileno()))
            os.close(writing)
            os.read(reading, 1)
            os.close(reading)
            while watch.poll() is None:  # it notices when it has something to say
                self.core.robots.append(("TestingTeam", f"robot {len(self.core.robots)}", 0.0))
                with contextlib.suppress(subprocess.TimeoutExpired):
                    watch.wait(0.5)
            errors.seek(0)
            self.assertEqual((watch.returncode, errors.read()), (0, b""))


class TestRun(WithCore):
    def _running(self, *words: str) -> Referee:
        run = self.start("run", "Home A", "--json", *words)
        run.event("state", phase="running")
        return run

    def test_a_whole_run_begun_before_the_core_is_there(self) -> None:
        self.core.leave()
        run = self.start("run", "home a", "--wait", "15", "--json", "--event", "HWV", "--score", "door=yes")
        self.core = FakeCore()
        zone = self.core.zones["Home A"]
        run.event("score", item=DOOR[1], value=1)
        zone.online_data += "12:00:00Z visitor: postman\n"
        run.event("online_data")
        zone.end("completed")
        result = run.event("result")
        self.assertEqual(run.wait_ended(), 0)
        self.assertEqual((result["ok"], result["end_reason"], result["event"]["code"]), (True, "completed", "HWV"))
        self.assertEqual(result["score"][0]["value"], 1)
        self.assertEqual([call[0] for call in self.core.calls],
                         ["choose_event", "connect", "start", "score", "disconnect"])

    def test_its_text_ends_with_score_sheet_and_verdict(self) -> None:
        run = self.start("run", "Home A")
        run.wait_printed("RUNNING")
        self.zone.end("timeout")
        run.wait_printed("Score sheet: HGTKMH")
        run.wait_printed("\nHome A: the run did not complete: timeout")
        self.assertEqual(run.wait_ended(), 4)

    def wait_call(self, *call: object) -> None:
        """Wait until the core has received this call."""
        wait_until(lambda: call in self.core.calls, lambda: f"{call} is called; there were {self.core.calls}")

    def test_an_interrupt_is_a_referees_stop(self) -> None:
        for number in (signal.SIGINT, signal.SIGTERM):
            run = self._running()
            run.signal(number)
            self.assertEqual(run.event("result")["end_reason"], "stopped")
            self.assertEqual(run.wait_ended(), 130)
            self.assertEqual([call[0] for call in self.core.calls[-2:]], ["stop_run", "disconnect"])

    def test_a_terminal_that_is_closed_leaves_the_run_as_it_is(self) -> None:
        run = self._running()
        run.signal(signal.SIGHUP)
        self.assertEqual(run.wait_ended(), 129)
        self.assertEqual([call[0] for call in self.core.calls], ["connect", "start"])
