"""What the program shows of recordings: whole runs of the original box and robots, and files that are damaged."""

import collections
import json

import pytest

from helpers.golden import PASSWORD, SESSIONS, load
from roah_rsbb.capture import decoding
from roah_rsbb.capture.decoding import Datagram
from roah_rsbb.capture.program import main

PORT = 6666
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
