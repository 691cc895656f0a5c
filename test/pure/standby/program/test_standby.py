"""The takeover: it is refused while the box is heard, and starts the box with everything that was copied."""

import contextlib
import io
import json
import os
import pathlib
import re
import subprocess
import sys

import pytest

from helpers.copied import Copied, contents
from helpers.journals import Writer
from roah_rsbb.ground import durable, linux
from roah_rsbb.journal import epochs, log
from roah_rsbb.journal.contents import open_journal, superseded_value
from roah_rsbb.journal.copy_folder import CopyFolder
from roah_rsbb.journal.log_dir import JOURNAL, InForce, Texts, write_in_force
from roah_rsbb.journal.records import Kind
from roah_rsbb.standby import pairing
from roah_rsbb.standby.beside_copy import PackedModules
from roah_rsbb.standby.channel import MODULES
from roah_rsbb.standby.pair import hashed, rejoin_key
from roah_rsbb.standby.pairing import (
    PairedBox,
    PairedStandby,
    is_standby,
    read_box,
    read_standby,
    write_box,
    write_standby,
)
from roah_rsbb.standby.program import keeping, takeover
from roah_rsbb.standby.program import main as standby
from roah_rsbb.standby.program.ears import Automatic, NoAddress
from roah_rsbb.standby.program.keeping import CopyKeeper
from roah_rsbb.standby.program.takeover import StandbyFolder
from roah_rsbb.tools.preflight_checks import Remark, Severity


@pytest.fixture
def copied(tmp_path):
    """A complete copy."""
    made = Copied(tmp_path)
    write_in_force(str(made.log_dir), InForce("launch", 3, {
        2: Texts(("b", "s", "p"), ("old", "old", None)),
        3: Texts(("/x/b.yaml", "/x/s.yaml", "/x/p.yaml", "", "/x/decisions.yaml"),
                 ("benchmarks", "schedule", None, None, "decisions"))}))
    made.writer.entry("/notification", "now")
    assert made.step()
    made.follower.close()
    (made.stick / "network.json").write_text(json.dumps({"rsbb_host": "10.1.255.255", "rsbb_port": 7000}))
    made.standby = StandbyFolder(str(made.stick))
    umask = os.umask(0o022)
    os.umask(umask)
    yield made
    os.umask(umask)
    made.close()


def entered(folder, *words):
    """Enter a command; returns its exit status. Raises `Refused` with what it prints instead."""
    errors = io.StringIO()
    with contextlib.redirect_stderr(errors), pytest.raises(SystemExit) as end:
        standby.main([*words, "--log-dir", str(folder)])
    if end.value.code:
        raise standby.Denied(errors.getvalue())
    return end.value.code


def keep(monkeypatch, noted):
    """Note what is given instead of keeping a copy."""
    class Fake:
        def __init__(self, *given):
            noted(*given)

        def run(self):
            return 0

    monkeypatch.setattr(standby, "CopyKeeper", Fake)


def arguments(command):
    assert command[:3] == ["roslaunch", "roah_rsbb", "roah_rsbb.launch"]
    return dict(argument.split(":=") for argument in command[3:])


def test_the_box_starts_with_everything_that_was_copied(copied):
    stick = str(copied.stick)
    found = arguments(StandbyFolder(stick, ["gui:=none", "rsbb_host:=10.9.255.255"]).launch_command())
    assert found == {
        "log_dir": stick, "resume": "always", "take_over": "true", "rsbb_host": "10.9.255.255",
        "rsbb_port": "7000", "gui": "none",
        "benchmarks_file": f"{stick}/configuration/benchmarks.yaml",
        "schedule_file": f"{stick}/configuration/schedule.yaml",
        "passwords_file": f"{stick}/passwords.yaml", "standings_file": "none"}
    assert (copied.stick / "configuration" / "schedule.yaml").read_text() == "schedule"
    assert (copied.stick / "configuration" / "decisions.yaml").read_text() == "decisions"
    assert (copied.stick / "configuration" / "benchmarks.yaml").read_text() == "benchmarks"


def test_the_box_has_the_rules_and_parameters_that_were_copied(copied):
    (copied.stick / "of_the_box").mkdir()
    (copied.stick / "of_the_box" / "HNF.yaml").write_text("goals: 1")
    PackedModules(str(copied.stick / "of_the_box"), str(copied.stick / MODULES)).look()
    stick = str(copied.stick)
    assert arguments(StandbyFolder(stick, []).launch_command())["modules_dir"] == f"{stick}/configuration/modules"
    assert (copied.stick / "configuration" / "modules" / "HNF.yaml").read_text() == "goals: 1"
    given = arguments(StandbyFolder(stick, ["modules_dir:=here"]).launch_command())
    assert given["modules_dir"] == "here"


def test_damaged_modules_do_not_prevent_a_takeover(copied):
    (copied.stick / MODULES).write_bytes(b"PK damaged")
    assert "modules_dir" not in arguments(copied.standby.launch_command())


def test_commands_find_the_copy_where_it_was_kept_last(tmp_path, monkeypatch):
    """A computer that was the box keeps the copy elsewhere: its old folder must not be taken for the copy."""
    monkeypatch.setenv("HOME", str(tmp_path))
    usual = tmp_path / ".ros" / "roah_rsbb_standby"

    def folder(*words):
        return standby._folder_of(standby._options(words))
    assert folder("takeover") == folder("rejoin", "old") == str(usual)
    write_box(str(usual), PairedBox("10.0.0.1", 8083, "ff", "key"))
    writer = Writer(usual)
    writer.entry("/notification", "now")
    writer.journal.close()
    second = folder("rejoin", str(usual))
    assert second == f"{usual}_2", "the box was in the usual one"
    keeping.note_folder(second)
    assert folder("takeover") == str(usual), "it does not exist"
    os.makedirs(second)
    assert {folder(command) for command in ("takeover", "status", "follow")} == {second}
    assert folder("takeover", "--log-dir", str(usual)) == str(usual)


def test_there_is_no_copy(tmp_path):
    with pytest.raises(standby.Denied, match="there is no copy"):
        StandbyFolder(str(tmp_path)).launch_command()


@pytest.mark.parametrize("answers, beacons, reasons", [
    (False, False, 0), (True, False, 1), (False, True, 1), (True, True, 2)])
def test_each_way_in_which_the_box_is_heard_is_a_reason(copied, monkeypatch, answers, beacons, reasons):
    asked = []

    def other_box(*given):
        asked.append(given)
        return Remark(Severity.FAILED, "another RSBB transmits", "") if beacons else Remark(Severity.OK, "none", "")

    write_box(str(copied.stick), PairedBox("10.1.0.2", 8083, "ff", "key"))
    monkeypatch.setattr(takeover, "is_alive", lambda box, timeout: answers)
    monkeypatch.setattr(takeover, "check_other_box", other_box)
    assert len(StandbyFolder(str(copied.stick), ["bind_host:=10.1.0.3"]).why_not(4.0)) == reasons
    assert asked == [("10.1.255.255", 7000, "10.1.0.3", 4.0)]


@pytest.mark.parametrize("anyway", [False, True])
def test_a_takeover_needs_an_option_while_the_box_is_heard(copied, monkeypatch, anyway):
    started, ended = [], []
    monkeypatch.setattr(StandbyFolder, "end_follower", lambda _: ended.append(1))
    monkeypatch.setattr(StandbyFolder, "why_not", lambda *_: ["The box answers."])
    monkeypatch.setattr(os, "execvp", lambda name, command: started.append(command))
    if anyway:
        entered(copied.stick, "takeover", "--anyway")
        assert len(started) == len(ended) == 1, "the program that keeps the copy must not be the box, too"
    else:
        with pytest.raises(standby.Denied, match="The box answers.*\n.*--anyway"):
            entered(copied.stick, "takeover")
        assert not started


@pytest.mark.parametrize("host, is_said", [("203.0.113.2", True), ("127.0.0.1", False)])
def test_a_takeover_says_which_robots_are_not_heard(copied, capsys, host, is_said):
    """Not if this computer has the old box's address."""
    copied.standby.become_box(PairedBox(host, 8083, "ff", "key"))
    said = capsys.readouterr().out
    assert (f"the box's address {host} instead of the broadcast address are not heard" in said) == is_said
    assert (f"takeover --take-address --log-dir {copied.stick}" in said) == is_said


def test_the_address_can_be_taken_while_the_new_box_runs(copied, monkeypatch, capsys):
    folder, taken = str(copied.stick), []
    box = PairedBox("203.0.113.2", 8083, "ff", "key")
    write_box(folder, box)
    monkeypatch.setattr(takeover, "take_address", lambda host, _: taken.append(host) or "eth7")
    StandbyFolder(folder).become_box(box)
    with contextlib.closing(CopyFolder(folder)):  # locked, as a core locks its journal
        entered(folder, "takeover", "--take-address")
    assert taken == [box.host]
    assert f"This computer has the address {box.host} now, on eth7" in capsys.readouterr().out
    with contextlib.closing(CopyFolder(folder)):
        entered(folder, "takeover")
    assert "is the box already" in capsys.readouterr().out
    assert epochs.standing_in(os.path.join(folder, JOURNAL)).epoch == 2


def test_the_old_box_becomes_a_standby_with_the_same_options(copied, monkeypatch, tmp_path):
    kept = []
    monkeypatch.setattr(standby, "rejoin", lambda *_: PairedBox("10.0.0.3", 8083, "ff", "key"))
    keep(monkeypatch, lambda *given: kept.append(given))
    (tmp_path / "ping").touch(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(standby.os, "geteuid", lambda: 0)
    entered(copied.stick, "rejoin", str(tmp_path / "old"), "--automatic", "5", "--witness", "203.0.113.1",
            "--take-address")
    assert kept[0][2:] == (Automatic(5.0, "203.0.113.1"), True)


@pytest.mark.parametrize("rejoined", [True, False])
def test_a_box_that_was_off_during_the_takeover_is_the_box_again(tmp_path, monkeypatch, capsys, rejoined):
    """Its journal has no takeover. If it has been the standby of the other box since, that is the proof; the epoch must
    be higher than that of the other box."""
    monkeypatch.setenv("HOME", str(tmp_path))
    old, copy, paired = tmp_path / "old", tmp_path / ".ros" / "roah_rsbb_standby", hashed("key")
    journals = [Writer(folder) for folder in (old, copy)]
    for journal in journals:
        journal.entry("/notification", "now")
        journal.journal.close()
    write_standby(str(old), PairedStandby("second", paired, "127.0.0.1", 1))
    write_box(str(copy), PairedBox("127.0.0.1", 1, "ff", rejoin_key(paired) if rejoined else "another"))
    for _ in range(3):
        epochs.raise_epoch(str(copy / JOURNAL), 1.0, "second")
    if not rejoined:
        with pytest.raises(standby.Denied, match="has no takeover.*--anyway"):
            entered(old, "takeover")
    entered(old, "takeover", *([] if rejoined else ["--anyway"]))
    assert f"Epoch {5 if rejoined else 3}. Start the box as before" in capsys.readouterr().out
    assert epochs.standing_in(str(old / JOURNAL)).epoch == (5 if rejoined else 3)


@pytest.mark.parametrize("wrong", [["--automatic", "1"], ["--take-address"], ["--witness", "203.0.113.1"]])
@pytest.mark.parametrize("words", [["follow", "10.0.0.2", "--code", "AAAA-AAAA"], ["rejoin", "/old"]])
def test_options_that_are_not_possible_change_nothing(copied, monkeypatch, words, wrong):
    for name in ("pair", "rejoin", "CopyKeeper"):
        monkeypatch.setattr(standby, name, lambda *_: pytest.fail("something was changed"))
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(standby.os, "geteuid", lambda: 1000)
    with pytest.raises(standby.Denied, match=wrong[0] if wrong[0] != "--witness" else "install iputils-ping"):
        entered(copied.stick, *words, *wrong)


def test_the_program_that_keeps_the_copy_is_ended(copied, tmp_path):
    program = tmp_path / "standby"
    program.write_text("import sys\nfrom roah_rsbb.journal.copy_folder import CopyFolder\n"
                       "copy = CopyFolder(sys.argv[2])\nprint('open', flush=True)\nsys.stdin.read()\n")
    source = str(pathlib.Path(standby.__file__).parents[3])
    with subprocess.Popen([sys.executable, str(program), "follow", str(copied.stick)], stdout=subprocess.PIPE,
                          stdin=subprocess.PIPE, env={**os.environ, "PYTHONPATH": source}) as process:
        assert process.stdout.readline() == b"open\n"
        copied.standby.end_follower()
        assert process.wait(60.0) < 0
    CopyFolder(str(copied.stick)).close()


def test_another_program_that_uses_the_copy_is_not_ended(copied):
    folder = CopyFolder(str(copied.stick))
    with pytest.raises(standby.Denied, match="another program uses the copy"):
        copied.standby.end_follower()
    folder.close()


def test_when_the_copy_ends(copied):
    for zone, shown in (("UTC", "11:00:01 UTC, "), ("Asia/Tokyo", "20:00:01 JST, ")):
        texts = Texts(("b", "s", "p"), (None, f"- time_zone: {zone}", None))
        write_in_force(str(copied.stick), InForce("launch", 1, {1: texts}))
        assert copied.standby.last_moment().startswith(f"The newest entry of the copy is from {shown}")
    takeover.times.use_zone("")


def test_arguments_of_the_launch_file_may_stand_anywhere(copied, monkeypatch):
    given = []
    monkeypatch.setattr(standby, "pair", lambda *of: given.append(of[3]) or PairedBox("10.1.0.2", 8083, "", ""))
    keep(monkeypatch, lambda folder, *_: given.append(folder.arguments))
    entered(copied.stick, "follow", "gui:=none", "--code", "AAAA", "10.1.0.2", "web:=false", "__name:=standby")
    assert given == ["AAAA", ["gui:=none", "web:=false"]]


# -- the code -------------------------------------------------------------------------------------------

@pytest.fixture
def box(copied):
    """The log_dir of a box that runs with a port for a standby."""
    own = copied.log_dir / "standby"
    own.mkdir()
    (own / "network.json").write_text(json.dumps({"rsbb_host": "10.1.255.255", "standby_port": 8083}))
    return copied.log_dir


def shown_code(folder, capsys):
    """What `standby code` shows: the code, and all of its text."""
    entered(folder, "code")
    text = capsys.readouterr().out
    return re.search("The code is ([A-Z2-9]{4}-[A-Z2-9]{4}), for one standby and for 10 minutes", text).group(1), text


def test_a_code_is_made_when_it_is_asked_for(box, capsys):
    assert pairing.PairingCode(str(box)).valid() == ""
    first, _ = shown_code(box, capsys)
    second, text = shown_code(box, capsys)
    assert first != second and pairing.PairingCode(str(box)).valid() == second
    assert text.endswith("rosrun roah_rsbb standby follow ADDRESS --code\n")
    assert (box / "standby" / "code.json").stat().st_mode & 0o777 == 0o600


def test_a_code_is_shown_with_all_that_the_second_computer_needs(box, capsys):
    (box / "standby" / "network.json").write_text(json.dumps({"standby_port": 9000}))
    write_standby(str(box), PairedStandby("laptop", "00", "10.0.0.3", 8083))
    _, text = shown_code(box, capsys)
    assert "rosrun roah_rsbb standby follow ADDRESS --code --port 9000\n" in text
    assert text.endswith("That computer replaces the present standby, which is laptop at 10.0.0.3\n")


def test_no_box_runs_for_which_a_code_could_be(box, copied):
    copied.writer.close()
    with pytest.raises(standby.Denied, match="no box with a standby_port runs with the log_dir"):
        entered(box, "code")
    assert not (box / "standby" / "code.json").exists()


def test_a_box_that_has_just_been_started_is_waited_for(copied, capsys, monkeypatch):
    monkeypatch.setattr(standby.time, "sleep", lambda _: (copied.log_dir / "standby").mkdir())
    assert shown_code(copied.log_dir, capsys)[0]


def test_a_box_without_a_port_for_a_standby_has_no_code(copied, monkeypatch):
    monkeypatch.setattr(standby, "STARTS_S", 0.0)
    with pytest.raises(standby.Denied, match="no box with a standby_port runs with the log_dir"):
        entered(copied.log_dir, "code")


def test_a_superseded_box_has_no_code(box, copied):
    copied.writer.entry(Kind.EPOCH, superseded_value(2, 1, "10.0.0.3"), port=None)
    with pytest.raises(standby.Denied, match="pair the standby with the box at 10.0.0.3"):
        entered(box, "code")


def test_only_the_user_of_the_box_makes_a_code(box, monkeypatch):
    """The box could not read that of another one."""
    monkeypatch.setattr(standby.os, "geteuid", lambda: os.getuid() + 1)
    with pytest.raises(standby.Denied, match="enter this command as that user"):
        entered(box, "code")


# -- the program that keeps the copy, and the box that it prepared ------------------------------------

class Keeping:
    """`standby follow`, whose end is to take over at once, or to be ended. Notes what happens."""

    def __init__(self, folder, monkeypatch, takes_over=False, is_handed_over=False):
        self.folder, self.happened = folder, []
        this = self

        class End:
            run = staticmethod(lambda: this.take_over() if takes_over else None)
            end = staticmethod(lambda: None)
            was_handed_over = is_handed_over

            def __init__(self, *given):
                this.on_hand_over = given[-1]

        class Ears:
            wait_silent = heard = start = end = staticmethod(lambda *_: None)

            def __init__(self, *given):
                this.take_over = given[4]

        class Prepared:
            start = staticmethod(lambda: None)
            is_for = staticmethod(lambda command: False)  # it was started with other arguments

            def __init__(self, *_):
                pass

            @staticmethod
            def end():
                this.note("prepared box ended")

        for name, fake in (("StandbyEnd", End), ("Ears", Ears), ("Prepared", Prepared)):
            monkeypatch.setattr(keeping, name, fake)
        monkeypatch.setattr(keeping.signal, "signal", lambda *_: None)
        monkeypatch.setattr(os, "execvp", lambda *_: self.note("box started"))
        self.box = PairedBox("127.0.0.1", 8083, "ff", "key")
        write_box(folder, self.box)
        write_standby(folder, PairedStandby("the box before", "00"))  # as if this computer had been the box

    def note(self, what):
        is_locked = linux.is_locked(os.path.join(self.folder, takeover.LOCK))
        self.happened.append((what, is_locked, is_standby(self.folder)))

    def keep(self):
        return CopyKeeper(StandbyFolder(self.folder), self.box, Automatic(5.0), False).run()


def test_a_box_that_was_prepared_in_another_way_ends_before_the_takeover(copied, monkeypatch):
    """It waits for that, and would begin, too."""
    kept = Keeping(str(copied.stick), monkeypatch, takes_over=True)
    kept.keep()
    assert kept.happened[0] == ("prepared box ended", True, True)
    assert kept.happened[-1] == ("box started", False, False)


def test_a_box_that_hands_over_is_replaced(copied, monkeypatch, capsys):
    kept = Keeping(str(copied.stick), monkeypatch, is_handed_over=True)
    kept.keep()
    assert "its computer hands over: taking over" in capsys.readouterr().out
    assert kept.happened[-1] == ("box started", False, False) and kept.on_hand_over()


def test_a_standby_without_a_configuration_is_handed_nothing(copied, monkeypatch, capsys):
    kept = Keeping(str(copied.stick), monkeypatch)
    kept.keep()
    write_in_force(str(copied.stick), InForce("launch", 4, {}))
    assert not kept.on_hand_over()
    assert "the box hands over, but: the copy in" in capsys.readouterr().out


def test_the_program_that_keeps_the_copy_has_ended_with_the_box_that_it_prepared(copied, monkeypatch):
    """The next box would use its ROS master."""
    kept = Keeping(str(copied.stick), monkeypatch, takes_over=False)
    assert kept.keep() == 0
    assert kept.happened == [("prepared box ended", True, True)]
    assert not linux.is_locked(str(copied.stick / takeover.LOCK))


def test_two_programs_that_keep_one_copy(copied):
    with copied.standby.locked():
        with pytest.raises(standby.Denied, match="another program keeps the copy"), copied.standby.locked():
            pass
        assert takeover.noted_pid(str(copied.stick / takeover.LOCK)) == os.getpid()
        with pytest.raises(standby.Denied, match=f"process {os.getpid()}"):
            copied.standby.check_unused()


def test_a_copy_that_is_kept_is_not_paired_again(copied, monkeypatch):
    monkeypatch.setattr(standby, "pair", lambda *_: pytest.fail("the pair of the other program is replaced"))
    with copied.standby.locked(), pytest.raises(standby.Denied, match="another program uses"):
        entered(copied.stick, "follow", "10.0.0.2", "--code", "AAAA-AAAA")


@pytest.mark.parametrize("words, said", [
    (["follow"], "this computer took over, and is the box"),
    (["follow", "10.0.0.2"], "this computer took over, and is the box")])
def test_the_new_box_is_not_made_a_standby_by_habit(copied, words, said):
    """Its journal would be replaced by the one of the old box."""
    folder = str(copied.stick)
    box = PairedBox("10.0.0.2", 8083, "ff", "key")
    write_box(folder, box)
    StandbyFolder(folder).become_box(box)
    with pytest.raises(standby.Denied, match=said):
        entered(folder, *words)
    assert not is_standby(folder) and read_standby(folder).is_awaited


@pytest.mark.parametrize("words, used", [
    (["10.0.0.2", "--code", "AAAA-AAAA"], "AAAA-AAAA"), (["10.0.0.2", "--code"], "typed"),
    (["--code", "--port", "9000", "10.0.0.2"], "typed"), (["10.0.0.2", "--code", ""], None)])
def test_a_code_can_be_typed(copied, monkeypatch, words, used):
    """Other users see what is in a command line. A launch file without a code gives an empty one."""
    pairs = []
    write_box(str(copied.stick), PairedBox("10.0.0.2", 8083, "ff", "key"))
    monkeypatch.setattr(standby, "pair", lambda *given: pairs.append(given[3]) or PairedBox("10.0.0.2", 8083, "", ""))
    keep(monkeypatch, lambda *_: None)
    monkeypatch.setattr("builtins.input", lambda _: "typed")
    entered(copied.stick, "follow", *words)
    assert pairs == ([used] if used else [])


def test_there_may_be_nobody_to_type_a_code(copied, monkeypatch):
    def end(_):
        raise EOFError

    monkeypatch.setattr("builtins.input", end)
    with pytest.raises(standby.Denied, match="give --code CODE"):
        entered(copied.stick, "follow", "10.0.0.2", "--code")


def test_a_superseded_box_can_be_a_standby_again(copied, monkeypatch):
    folder = str(copied.stick)
    box = PairedBox("10.0.0.2", 8083, "ff", "key")
    write_box(folder, box)
    StandbyFolder(folder).become_box(box)
    writer = Writer(copied.stick)
    writer.entry(Kind.EPOCH, superseded_value(3, 1, "10.0.0.3"), port=None)
    writer.close()
    kept = []
    keep(monkeypatch, lambda *given: kept.append(given))
    entered(folder, "follow")
    assert len(kept) == 1


def test_another_address_of_the_box_is_remembered(copied, monkeypatch):
    folder = str(copied.stick)
    write_box(folder, PairedBox("10.0.0.2", 8083, "ff", "key"))
    keep(monkeypatch, lambda *_: None)
    entered(folder, "follow", "localhost", "--port", "8084")
    assert read_box(folder) == PairedBox("127.0.0.1", 8084, "ff", "key"), "a name is looked up once"


@pytest.mark.parametrize("host", ["10.0.0.2:8083", "no such host", "a..b"])
def test_an_invalid_address(copied, host):
    write_box(str(copied.stick), PairedBox("10.0.0.2", 8083, "ff", "key"))
    with pytest.raises(standby.Denied, match="is neither an IPv4 address nor a known host"):
        entered(copied.stick, "follow", host)


@pytest.mark.parametrize("port", ["0", "99999", "-1", "x"])
def test_an_invalid_port(tmp_path, port):
    with pytest.raises(standby.Denied, match="is not a port from 1 to 65535"):
        entered(tmp_path, "follow", "10.0.0.2", f"--port={port}")


def test_a_takeover_with_a_damaged_key_of_the_pair(copied, capsys):
    """A core would take the folder for the one of a standby, and wait."""
    (copied.stick / "box.json").write_text("{")
    copied.standby.become_box(None)
    assert not is_standby(str(copied.stick))
    assert "Make sure that it is off" in capsys.readouterr().out


def test_the_copy_is_kept_if_the_address_cannot_be_taken(copied, monkeypatch):
    write_box(str(copied.stick), PairedBox("203.0.113.2", 8083, "ff", "key"))

    def refuse(*_):
        raise NoAddress("no right")

    monkeypatch.setattr(takeover, "take_address", refuse)
    monkeypatch.setattr(StandbyFolder, "why_not", lambda *_: [])
    monkeypatch.setattr(StandbyFolder, "end_follower", lambda _: pytest.fail("the copy is not kept any more"))
    with pytest.raises(standby.Denied, match="omit --take-address"):
        entered(copied.stick, "takeover", "--take-address")


def demand_two(folder):
    write_in_force(str(folder), InForce("launch", 4, {
        4: Texts(("/x/b.yaml", "/x/s.yaml", "/x/p.yaml"), ("benchmarks", "- durable: two", None))}))


def test_a_copy_is_used_while_a_part_of_it_is_written_again(copied, capsys):
    before = contents(copied.stick)
    draft = copied.stick / JOURNAL / f"{list(before)[-1]}{log.DRAFT}"
    draft.write_bytes(b"the beginning")
    copied.standby.become_box(PairedBox("127.0.0.1", 8083, "ff", "key"))
    assert "compare the results with the referees' notes" in capsys.readouterr().out
    after = contents(copied.stick)
    assert len(after) == len(before) + 1 and before.items() <= after.items(), "the takeover is a segment"
    assert not draft.exists(), "nothing may replace a segment of a box"


def test_the_torn_end_of_a_copy_is_no_damage(copied, capsys):
    """After a power failure, a standby that took over continues from what is before the first gap."""
    saved = (copied.stick / JOURNAL / list(contents(copied.stick))[-1]).stat().st_size
    copied.follower = copied.new_follower()
    for number in range(2):
        copied.writer.entry("/notification", number)
        copied.save()
    assert copied.step()
    copied.follower.close()
    path = copied.stick / JOURNAL / list(contents(copied.stick))[-1]
    content = bytearray(path.read_bytes())
    content[saved:saved + 32] = bytes(32)
    path.write_bytes(content)
    copied.standby.become_box(None)
    assert "11:00:01 UTC" in capsys.readouterr().out
    found = open_journal(str(copied.stick / JOURNAL))
    assert not found.problems and found.contents.entry == 2, "and the entry of the takeover"


def test_a_full_disk_is_no_place_for_a_takeover(copied, monkeypatch):
    monkeypatch.setattr(durable, "has_space", lambda folder: False)
    with pytest.raises(standby.Denied, match="the disk is full: free space for"):
        copied.standby.become_box(None)


def test_a_full_disk_does_not_end_the_program(copied, monkeypatch):
    """Neither its output nor its own number must be on the disk."""
    def fail(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("builtins.print", fail)
    monkeypatch.setattr(os, "write", fail)
    with copied.standby.locked():
        keeping.show("")


def test_the_status_of_a_standby(copied, monkeypatch):
    write_box(str(copied.stick), PairedBox("10.0.0.2", 8083, "00", "key"))
    monkeypatch.setattr(takeover, "is_alive", lambda box, timeout: True)
    lines = list(copied.standby.status())
    assert lines[:2] == ["This computer is the standby of the box at 10.0.0.2, which answers",
                         "The copy is not kept: start 'standby follow'"]
    assert lines[2].startswith("The newest entry of the copy is from ")
    assert lines[3] == "Epoch 1"
    assert lines[4].endswith("(durable: one)")
    demand_two(copied.stick)
    with copied.standby.locked():
        lines = list(copied.standby.status())
    assert lines[1] == "The copy is kept"
    assert lines[4].endswith("(durable: two)")


def test_the_status_of_a_box(copied):
    folder = str(copied.log_dir)
    assert next(iter(StandbyFolder(folder).status())) == "No standby is paired with this box"
    write_standby(folder, PairedStandby("laptop", "00", "10.0.0.3", 8083))
    demand_two(copied.log_dir)
    found = list(StandbyFolder(folder).status())
    assert found[0] == "The standby of this box is laptop, last connected from 10.0.0.3"
    assert found[-1] == "Scores and sign-offs are confirmed when the standby has them, too (durable: two)"
    write_standby(folder, PairedStandby("stranger", "00", "10.0.0.66", 8083, False, 1e9, "laptop at 10.0.0.3"))
    assert list(StandbyFolder(folder).status())[1] == (
        "It was paired on 2001-09-09 at 01:46:40 UTC, and replaced laptop at 10.0.0.3")
    with pytest.raises(standby.Denied, match="--log-dir"):
        list(StandbyFolder(str(copied.log_dir / "standby")).status())
