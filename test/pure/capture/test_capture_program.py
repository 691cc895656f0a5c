"""The program as it listens: what it keeps, when it ends, and how it says that it cannot begin."""

import collections
import json
import os
import socket
import sys
import time
from types import SimpleNamespace

import pytest

from helpers.golden import PASSWORD, SESSIONS, load
from helpers.small_box import BROADCAST, free_ports
from roah_rsbb.capture import decoding, program
from roah_rsbb.capture.decoding import Datagram
from roah_rsbb.capture.program import main
from roah_rsbb.comm.frame import encode
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

PORT = 6666


def beacon(number=0):
    """The datagram of a robot's beacon."""
    message = pb.RobotBeacon(team_name="Team", robot_name="Robot", time=pb.Time(sec=number, nsec=0))
    return Datagram(1700000000.25 + number, "10.0.0.2", PORT, "10.0.0.255", PORT, encode(message))


class Network:
    """Stands for a listener: gives one datagram after another, and ends like Ctrl-C when there are no more."""

    what = "all that is"

    def __init__(self, datagrams, ends=True):
        self.host = None
        self.followed = 0
        self._datagrams = list(datagrams)
        self._ends = ends
        self._ear, self._mouth = socket.socketpair()
        self.sockets = [self._ear]
        if datagrams or ends:
            self._mouth.send(b"x")  # there is something to read

    def open(self, decoder, host, notice):
        self.host, self.notice = host, notice
        return self

    def read(self, _endpoint):
        if self._datagrams:
            return [self._datagrams.pop(0)]
        if self._ends:
            raise KeyboardInterrupt
        self._ear.recv(1)
        return []

    def follow(self):
        self.followed += 1

    def close(self):
        self._ear.close()
        self._mouth.close()


@pytest.fixture(autouse=True)
def _keep_signals(monkeypatch):
    monkeypatch.setattr("signal.signal", lambda *_: None)  # the tests keep their own
    monkeypatch.delenv("ROAH_RSBB_KEY", raising=False)


@pytest.fixture
def network(monkeypatch):
    """Lets the program hear these datagrams."""
    def hear(*datagrams, ends=True):
        listener = Network(datagrams, ends)
        monkeypatch.setattr(program, "PlainListener", listener.open)
        return listener
    return hear


def test_what_is_heard_is_shown_and_counted(network, capsys):
    listener = network(beacon(1), beacon(2), beacon(3)._replace(data=b"?"))
    main(["--plain", "--host", BROADCAST])
    out, err = capsys.readouterr()
    assert [line.split()[0] for line in out.splitlines()] == ["22:13:21.250", "22:13:22.250", "22:13:23.250"]
    assert err.splitlines() == [
        "capture: all that is",
        "capture: 3 datagrams: 2 messages, 0 encrypted without a known password, 1 errors",
    ]
    assert listener.host == BROADCAST and listener.followed == 3
    assert listener.sockets[0].fileno() == -1  # closed


def test_what_is_kept_can_be_read_again(network, tmp_path, capsys):
    path = tmp_path / "run.jsonl"
    network(beacon(1), beacon(2))
    # A filter chooses what is shown only.
    main(["--plain", "--port", "7000", "--write", str(path), "--message", "TabletBeacon"])
    assert capsys.readouterr().out == ""
    rsbb_port, datagrams = decoding.read(iter(path.read_text().splitlines(keepends=True)), "run.jsonl")
    assert rsbb_port == 7000 and list(datagrams) == [beacon(1), beacon(2)]


def test_every_datagram_is_kept_at_once(network, tmp_path, monkeypatch):
    path, seen = tmp_path / "run.jsonl", []
    listener = network(beacon(1), beacon(2))
    read = listener.read
    monkeypatch.setattr(listener, "read", lambda one: seen.append(len(path.read_text().splitlines())) or read(one))
    main(["--plain", "--write", str(path)])
    assert seen == [1, 2, 3]


def test_a_file_that_exists_is_not_written_over(network, tmp_path):
    path = tmp_path / "run.jsonl"
    path.write_text("precious")
    network(beacon())
    with pytest.raises(SystemExit, match="run.jsonl already exists: choose another name for --write"):
        main(["--plain", "--write", str(path)])
    assert path.read_text() == "precious"


def test_it_ends_after_its_duration(network, capsys, monkeypatch):
    # At its beginning, before the datagram, and after it.
    clock = {**vars(time), "monotonic": iter([100.0, 100.1, 100.2]).__next__}
    monkeypatch.setattr(program, "time", SimpleNamespace(**clock))
    network(beacon(), ends=False)
    main(["--plain", "--duration", "0.2"])
    assert len(capsys.readouterr().out.splitlines()) == 1


def test_a_duration_of_0_prints_nothing(network, capsys):
    network(beacon())
    main(["--plain", "--duration", "0"])
    assert capsys.readouterr().out == ""


class _Gone:
    """A standard output whose reader has gone."""

    def __init__(self, fileno):
        self.fileno = lambda: fileno

    def isatty(self):
        return False

    def write(self, _text):
        raise BrokenPipeError

    def flush(self):
        pass


def test_it_ends_quietly_when_its_reader_has_gone(network, monkeypatch, capsys):
    network(*[beacon(number) for number in range(5)])
    reader, writer = os.pipe()
    os.close(reader)
    monkeypatch.setattr(sys, "stdout", _Gone(writer))
    try:
        main(["--plain"])
        os.write(writer, b"what the interpreter still has to say")  # into nothing
    finally:
        os.close(writer)
    assert capsys.readouterr().err == "capture: all that is\n"


def test_a_notice_is_given_once_and_not_without_end(network, monkeypatch, capsys):
    listener = network(beacon())
    monkeypatch.setattr(
        listener, "follow", lambda: [listener.notice(f"notice {number % 5000}") for number in range(10000)]
    )
    main(["--plain"])
    notices = [line for line in capsys.readouterr().err.splitlines() if "notice " in line]
    assert len(notices) == len(set(notices)) == program._MAX_NOTICES - 1  # and the first one, what is heard


def test_without_the_right_to_all_it_says_so_and_hears_broadcasts(network, monkeypatch, capsys):
    def refused(*_):
        raise PermissionError
    monkeypatch.setattr(program, "RawListener", refused)
    network(beacon())
    main(["--host", BROADCAST])
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 1
    assert "run as root or with CAP_NET_RAW" in err and f"{sys.executable} -m roah_rsbb.capture" in err


def test_with_the_right_to_all_it_hears_all(network, monkeypatch, capsys):
    plain, raw = network(), Network([beacon()])
    monkeypatch.setattr(program, "RawListener", raw.open)
    main(["--host", BROADCAST])
    assert len(capsys.readouterr().out.splitlines()) == 1 and plain.host is None


def test_a_terminal_gets_colours_unless_it_does_not_want_them(network, monkeypatch, capsys):
    def shown(**variables):
        for name in ("NO_COLOR", "TERM"):
            monkeypatch.delenv(name, raising=False)
        for name, value in variables.items():
            monkeypatch.setenv(name, value)
        network(beacon())
        main(["--plain"])
        return capsys.readouterr().out
    assert "\x1b" not in shown()
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    assert "\x1b" in shown()
    assert "\x1b" not in shown(NO_COLOR="1") and "\x1b" not in shown(TERM="dumb")


@pytest.mark.parametrize("arguments, reported", [
    (["--host", "127.0.0.1"], "--host 127.0.0.1 is not a broadcast address"),
    (["--host", "no such host"], "--host 'no such host' is neither an IPv4 address"),
    (["--write", "/nonexistent/run.jsonl"], "cannot open /nonexistent/run.jsonl: No such file"),
    (["--read", "/nonexistent/run.jsonl"], "cannot open /nonexistent/run.jsonl: No such file"),
    (["--passwords", "/nonexistent/passwords.yaml"], "passwords.yaml: found no file"),
    (["--password-file", "/nonexistent/key"], "cannot read the password file /nonexistent/key"),
    (["--password", ""], "the password is empty"),
    (["--team", "Team", "--password", ""], "the password is empty"),
])
def test_what_it_cannot_begin_with_is_reported_in_a_line(arguments, reported):
    given = [*([] if "--host" in arguments else ["--host", BROADCAST]), "--plain", "--duration", "0"]
    with pytest.raises(SystemExit, match=reported):
        main([*given, "--port", str(free_ports()), *arguments])


def test_an_error_in_the_passwords_file_is_reported_with_its_line_and_without_the_password(tmp_path, capsys):
    file = tmp_path / "passwords.yaml"
    file.write_text("Team: secret1\nTeam: secret2\n", encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        main(["--host", BROADCAST, "--plain", "--duration", "0", "--passwords", str(file)])
    assert f"{file}:2: found" in str(ended.value)
    assert "secret" not in str(ended.value) + capsys.readouterr().err


@pytest.mark.parametrize("arguments, reported", [
    (["--port", "0"], "'0' is not a UDP port"),
    (["--port", "65536"], "'65536' is not a UDP port"),
    (["--port", "²"], "'²' is not a UDP port"),
    (["--duration", "nan"], "'nan' is not a number from 0"),
    (["--write", "a", "--read", "b"], "not allowed with argument"),
    (["--password", "a", "--password-file", "b"], "not allowed with argument"),
    (["--message", "Beacon"], "did you mean 'RobotBeacon'?"),
])
def test_arguments_that_make_no_sense_are_reported_in_a_line(arguments, reported, capsys):
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    err = capsys.readouterr().err
    assert ended.value.code == 2 and err.startswith("capture: argument ") and err.count("\n") == 1
    assert reported in err


def test_the_help_says_where_states_of_a_run_can_be_heard(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    assert "private_mode:=broadcast" in capsys.readouterr().out


# -- recordings: whole runs of the original box and robots, and damaged files ----------------------------

BEGIN = 1700000000.0


def datagrams(session):
    """The datagrams of a golden recording."""
    return [
        Datagram(BEGIN + one["t_rel"], one["src"], one["sport"], one["dst"], one["dport"], bytes.fromhex(one["hex"]))
        for one in load(session)
    ]


@pytest.fixture
def shown(tmp_path, capsys, monkeypatch):
    """Replays datagrams, or the text of a file, with arguments; what is shown by lines, and what is said beside."""
    monkeypatch.setattr("signal.signal", lambda *_: None)  # the tests keep their own

    def replay(what, *arguments):
        path = tmp_path / "run.jsonl"
        if not isinstance(what, str):
            what = "".join(line + "\n" for line in [decoding.header_line(PORT), *map(decoding.datagram_line, what)])
        path.write_text(what, encoding="utf-8")
        main(["--read", str(path), *arguments])
        out, err = capsys.readouterr()
        return out.splitlines(), err
    return replay


@pytest.mark.parametrize("session", SESSIONS)
def test_every_message_of_a_recorded_run_is_shown_with_its_sender(shown, session):
    lines, said = shown(datagrams(session), "--json", "--password", PASSWORD)
    assert len(lines) == len(load(session)) and " 0 encrypted without a known password, 0 errors" in said
    for line, recorded in zip(map(json.loads, lines), load(session)):
        assert line["kind"] == "message"
        assert line["channel"] == ("public" if recorded["dport"] == PORT else "private")
        assert (line["speaker"] == "box") == (recorded["src"] == "10.99.0.1")
        assert line["time"] == pytest.approx(BEGIN + recorded["t_rel"], abs=1e-5)


@pytest.mark.parametrize("arguments, private", [
    ([], "encrypted"),
    (["--team", "OtherTeam", "--password", PASSWORD], None),
    (["--password", "WRONG"], "error"),
    (["--password", PASSWORD, "--team", "TestingTeam"], "message"),
])
def test_private_channels_with_and_without_the_right_password(shown, arguments, private):
    lines, _ = shown(datagrams("HNF_2020"), "--json", *arguments)
    kinds = collections.Counter(one["kind"] for one in map(json.loads, lines) if one["channel"] == "private")
    assert list(kinds) == ([private] if private else [])


def test_a_teams_password_is_not_tried_on_the_others_channels(shown):
    _, said = shown(datagrams("HNF_2020"), "--team", "OtherTeam", "--password", "WRONG")
    assert " 0 errors" in said and " 0 encrypted" not in said


def test_an_error_is_shown_with_its_reason_and_its_likely_cause(shown):
    lines, _ = shown(datagrams("HNF_2020"), "--errors-only", "--password", "WRONG")
    assert len(lines) > 100
    assert all("ERROR does not decrypt" in line and "password" in line for line in lines)


def test_changes_only_shows_the_course_of_a_run(shown):
    arguments = ["--json", "--password", PASSWORD, "--changes-only", "--message", "BenchmarkState"]
    lines, _ = shown(datagrams("HGTKMH_2020"), *arguments)
    states = [json.loads(line)["fields"]["benchmark_state"] for line in lines]
    assert states[:3] == ["STOP", "PREPARE", "WAITING_RESULT"] and len(states) < 10


def test_a_line_for_people(shown):
    lines, _ = shown(datagrams("HNF_2020"), "--password", PASSWORD, "--message", "RobotState")
    assert lines[0].split()[1:5] == ["6668", "10.99.0.2", "TestingTeam/TestingRobot", "RobotState"]
    assert "robot_state=STOP" in lines[0] and "skew=" in lines[0]


HEADER = decoding.header_line(PORT) + "\n"
GOOD = decoding.datagram_line(Datagram(BEGIN, "10.99.0.2", PORT, "10.99.0.255", PORT, b"\x02")) + "\n"


@pytest.mark.parametrize("text, reported", [
    ("", ":1: this is not a recording"),
    ("TestingTeam: PASSWORD\n", ":1: this is not a recording"),
    ('{"roah_rsbb_capture": 2, "rsbb_port": 6666}\n', ":1: the recording has format 2"),
    ('{"roah_rsbb_capture": 1, "rsbb_port": 65536}\n', ":1: found rsbb_port 65536"),
    ('{"roah_rsbb_capture": 1, "rsbb_port": true}\n', ":1: found rsbb_port True"),
    (HEADER + GOOD + GOOD[:-20], ":3: found an invalid line; expected one like .* cut off here"),
    (HEADER + GOOD + "\n" + GOOD, ":3: found an invalid line"),
    (HEADER + GOOD.replace('"02"', '"0g"'), ":2: found an invalid line"),
    (HEADER + GOOD.replace("10.99.0.255", "10.99.0.256"), ":2: found an invalid line"),
    (HEADER + GOOD.replace("1700000000.0", "Infinity"), ":2: found an invalid line"),
    (HEADER + GOOD.replace("1700000000.0", "9" * 400), ":2: found an invalid line"),
    (HEADER + "[" * 100000 + "\n", ":2: found an invalid line"),
])
def test_a_damaged_recording_is_reported_with_its_line(shown, text, reported):
    with pytest.raises(SystemExit, match=reported):
        shown(text)


def test_records_before_the_damage_stay(shown, capsys):
    with pytest.raises(SystemExit):
        shown(HEADER + GOOD + "x\n")
    assert "ERROR too short" in capsys.readouterr().out
