"""Entries as text and JSON: names and times that nobody expected."""

import json

import pytest

from helpers.box_beacon import NEVER, box_beacon
from roah_rsbb.capture.decoding import Datagram, Decoder
from roah_rsbb.capture.program import TextLines, json_line
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.frame import encode
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

PORT, NOW = 6666, 1700000000.25
HUGE = 2**63 - 1


def entry_of(message, src="10.0.0.2", sport=PORT):
    """A public message as it is decoded."""
    return Decoder(PORT, {}).decode(Datagram(NOW, src, sport, "10.0.0.255", PORT, encode(message)))


def robot(team="Team", name="Robot", sec=1700000000, nsec=250_000_000):
    return pb.RobotBeacon(team_name=team, robot_name=name, time=pb.Time(sec=sec, nsec=nsec))


def test_columns_grow_with_what_comes():
    lines = TextLines()
    long = "Department of Robots/Number Twenty-Three"
    first, second, third, endless, last = (lines.line(entry_of(message, sport=sport)) for message, sport in (
        (robot(), PORT), (robot(*long.split("/")), 54321), (robot(), PORT), (robot(name="x" * 100), PORT),
        (robot(), PORT),
    ))
    before = 12 + 1 + 6 + 1 + 15 + 1  # time, channel, address
    widths = [line.index(" RobotBeacon") - before for line in (first, second, third, endless, last)]
    assert widths == [24, 40, 40, 105, 40]


def test_a_port_that_is_not_the_channels_is_shown_and_has_room():
    lines = TextLines()
    strange = lines.line(entry_of(robot(), "192.168.100.200", 54321))
    assert strange.split()[2] == "192.168.100.200:54321"
    assert lines.line(entry_of(robot())).index("Team/Robot") == strange.index("Team/Robot")


@pytest.mark.parametrize("bad", ["\x1b[31mred", "two\nlines", "\r", "\x07", "\u202etfel", "\x9b2J", "\u2028", "\x00"])
def test_a_name_cannot_command_the_terminal(bad):
    for message in (robot(bad, bad), box_beacon((bad, bad, PORT + 1))):
        entry = entry_of(message)
        assert TextLines().line(entry).isprintable()
        in_json = json_line(entry)
        assert in_json.isprintable() and all(c < "\x7f" for c in in_json)
    assert json.loads(json_line(entry_of(robot(bad, bad))))["team"] == bad
    decoder = Decoder(PORT, {})
    datagram = entry_of(box_beacon((bad, bad, PORT + 1))).datagram
    decoder.decode(datagram)
    encrypted = encode(pb.BenchmarkState(benchmark_type="HWV", benchmark_state=0), Cipher.AES_128_CBC, Key("x"))
    entry = decoder.decode(datagram._replace(sport=PORT + 1, dport=PORT + 1, data=encrypted))
    assert "no password of team " in entry.text and TextLines().line(entry).isprintable()
    decoder = Decoder(PORT, {"Other": "x"})
    decoder.decode(datagram)
    entry = decoder.decode(entry.datagram)
    assert "the password of team Other, but the channel belongs to" in entry.text
    assert TextLines().line(entry).isprintable()


@pytest.mark.parametrize("sec, nsec, shown, skew", [
    (1700000000, 250_000_000, "22:13:20.250000", 0.0),
    (0, 0, "never", -NOW),
    (0, 1, "00:00:00.000000", -NOW),
    (2**32 - 1, 0, "06:28:15.000000", 2**32 - 1 - NOW),
    (2**32, 0, "4294967296s+0ns", 2**32 - NOW),
    (-1, 0, "-1s+0ns", -1 - NOW),
    (1700000000, -1, "1700000000s+-1ns", -0.25),
    (1700000000, 10**9, "1700000000s+1000000000ns", 0.75),
    (HUGE, HUGE, f"{HUGE}s+{HUGE}ns", HUGE + HUGE / 1e9 - NOW),
    (-HUGE - 1, -HUGE - 1, f"{-HUGE - 1}s+{-HUGE - 1}ns", -HUGE - HUGE / 1e9 - NOW),
])
def test_odd_times(sec, nsec, shown, skew):
    entry = entry_of(robot(sec=sec, nsec=nsec))
    text = TextLines().line(entry)
    assert f" time={shown} skew=" in text and text.endswith("s")
    assert float(text.rsplit("skew=", 1)[1][:-1]) == pytest.approx(skew, abs=1e-3)
    assert json.loads(json_line(entry))["skew_s"] == pytest.approx(skew, abs=1e-6)


def test_a_skew_is_exact_to_the_microsecond():
    entry = entry_of(robot(nsec=250_000_590))  # a float of seconds since 1970 has steps of 240 ns
    assert json.loads(json_line(entry))["skew_s"] == 1e-06


def test_places_that_are_not_numbers_are_strict_json():
    entry = entry_of(pb.TabletBeacon(last_call=NEVER, last_pos=NEVER, x=float("nan"), y=float("-inf")))
    fields = json.loads(json_line(entry), parse_constant=pytest.fail)["fields"]
    assert (fields["x"], fields["y"]) == ("nan", "-inf")
    assert "x=nan y=-inf" in TextLines().line(entry)


def test_texts_of_a_robot_are_quoted_where_they_could_be_mistaken():
    decoder = Decoder(PORT, {}, "PASSWORD")
    state = pb.RobotState(
        time=pb.Time(sec=1, nsec=2), messages_saved=3, robot_state=pb.RobotState.EXECUTING, devices_switch_1=True,
        notifications=["hall", "a b", 'x" robot_state=STOP', "ü"],
    )
    data = encode(state, Cipher.AES_128_CBC, Key("PASSWORD"))
    entry = decoder.decode(Datagram(NOW, "10.0.0.2", PORT + 1, "10.0.0.1", PORT + 1, data))
    text = TextLines().line(entry)
    assert 'notifications=[hall, "a b", "x\\" robot_state=STOP", ü]' in text and "devices_switch_1=true" in text
    assert " robot_state=\x1b[32mEXECUTING\x1b[0m" in TextLines(color=True).line(entry)
