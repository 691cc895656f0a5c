"""What the decoder and the filter learn from datagrams, and that forged ones do not make them grow."""

import pytest

from helpers.box_beacon import NEVER, box_beacon
from helpers.small_box import PASSWORD
from roah_rsbb.capture.decoding import BOX, PRIVATE_PORTS, TABLET, Datagram, DatagramKind, Decoder, Speaker
from roah_rsbb.capture.program import DatagramFilter
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.frame import FrameFault, encode
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

PORT = 6666
KEPT = 1000  # of what is learned, the newest


def datagram(message, src="10.0.0.2", port=PORT, password=None):
    """A message as it is sent: encrypted, if there is a password."""
    if isinstance(message, bytes):
        data = message
    elif password is None:
        data = encode(message)
    else:
        data = encode(message, Cipher.AES_128_CBC, Key(password))
    return Datagram(1700000000.0, src, port, "10.0.0.255", port, data)


def robot_beacon(name="Robot", team="Team", sec=0):
    return pb.RobotBeacon(team_name=team, robot_name=name, time=pb.Time(sec=sec, nsec=0))


def state(sec=0, robot_state=0):
    return pb.RobotState(time=pb.Time(sec=sec, nsec=0), messages_saved=0, robot_state=robot_state)


def host(number):
    return f"10.1.{number // 256}.{number % 256}"


def test_a_speaker_is_known_again_by_its_address_and_channel():
    decoder = Decoder(PORT, {}, PASSWORD)
    never = pb.TabletBeacon(last_call=NEVER, last_pos=NEVER, x=0, y=0)
    for message, src, speaker in (
        (robot_beacon(), "10.0.0.2", Speaker("Robot", "Team")), (box_beacon(), "10.0.0.1", BOX),
        (never, "10.0.0.3", TABLET),
    ):
        assert decoder.decode(datagram(message, src)).speaker == speaker
        assert decoder.decode(datagram(b"?", src)).speaker == speaker
        assert decoder.decode(datagram(b"?", src, PORT + 1)).speaker == speaker
    assert decoder.decode(datagram(b"?", "10.0.0.9")).speaker is None
    # On a private channel, what was said there counts first.
    decoder.decode(datagram(state(), "10.0.0.1", PORT + 1, PASSWORD))
    assert decoder.decode(datagram(b"?", "10.0.0.1", PORT + 1)).speaker == Speaker("robot")
    assert decoder.decode(datagram(b"?", "10.0.0.1")).speaker == BOX


def test_speakers_are_forgotten_when_others_are_heard_without_end():
    decoder = Decoder(PORT, {})
    for number in range(KEPT):
        decoder.decode(datagram(robot_beacon(str(number)), host(number)))
    decoder.decode(datagram(robot_beacon("0"), host(0)))  # heard again just now
    decoder.decode(datagram(robot_beacon("new"), "10.0.0.9"))
    known = [decoder.decode(datagram(b"?", host(number))).speaker for number in range(KEPT)]
    assert known[0] == Speaker("0", "Team") and known[1] is None and known[2] == Speaker("2", "Team")


def test_ports_are_forgotten_when_others_are_listed_without_end():
    decoder = Decoder(PORT, {})
    for number in range(KEPT):
        decoder.decode(datagram(box_beacon(("Team", "Robot", 20000 + number))))
    assert decoder.concerns(datagram(b"", port=20000)) and len(decoder.listed) == 1
    decoder.decode(datagram(box_beacon(("Team", "Robot", 30000))))
    assert [decoder.concerns(datagram(b"", port=port)) for port in (20000, 20001, 30000)] == [False, True, True]


def test_a_port_stays_known_after_its_run():
    decoder = Decoder(PORT, {"Team": PASSWORD})
    decoder.decode(datagram(box_beacon(("Team", "Robot", 20000))))
    decoder.decode(datagram(box_beacon()))
    assert decoder.listed == {}
    late = decoder.decode(datagram(state(), port=20000, password=PASSWORD))
    assert late.speaker == Speaker("Robot", "Team") and late.kind is DatagramKind.MESSAGE


def test_impossible_ports_are_not_private_channels():
    decoder = Decoder(PORT, {})
    decoder.decode(datagram(box_beacon(("Team", "Robot", 0), ("Team", "Robot", 65536), ("Team", "Robot", 65535))))
    assert set(decoder.listed) == {65535}


@pytest.mark.parametrize("sport, dport, concerns", [
    (PORT, PORT, True), (5, PORT, True),
    (PORT + 1, PORT + 1, True), (PORT + PRIVATE_PORTS, PORT + PRIVATE_PORTS, True),
    (PORT + PRIVATE_PORTS + 1, PORT + PRIVATE_PORTS + 1, False), (PORT - 1, PORT - 1, False),
    (5, PORT + 1, False),  # another program's, on such a port by coincidence
    (20000, 20000, False),
])
def test_contents_of_a_channel(sport, dport, concerns):
    decoder = Decoder(PORT, {})
    assert decoder.concerns(datagram(b"")._replace(sport=sport, dport=dport)) is concerns


def test_every_team_has_its_own_password():
    decoder = Decoder(PORT, {"One": "1", "Two": "2"})
    decoder.decode(datagram(box_beacon(("One", "Robot", 6667), ("Two", "Robot", 6668), ("Three", "Robot", 6669))))
    kinds = {
        (port, password): decoder.decode(datagram(state(), port=port, password=password))
        for port in (6667, 6669) for password in ("1", "2", "3")
    }
    assert kinds[6667, "1"].kind is DatagramKind.MESSAGE and kinds[6667, "1"].team == "One"
    assert kinds[6667, "2"].reason is kinds[6667, "3"].reason is FrameFault.UNDECRYPTABLE
    assert "it has the password of team Two" in kinds[6667, "2"].text
    assert "the given password does not fit" in kinds[6667, "3"].text
    assert kinds[6669, "3"].kind is DatagramKind.ENCRYPTED
    assert "no password of team Three is known" in kinds[6669, "3"].text


def test_a_teams_own_password_counts_on_its_channel_and_no_other():
    decoder = Decoder(PORT, {"Another": "same", "Team": "same"}, "for the others")
    decoder.decode(datagram(box_beacon(("Team", "Robot", 6667))))
    own = decoder.decode(datagram(state(), port=6667, password="same"))
    assert (own.kind, own.team) == (DatagramKind.MESSAGE, "Team")
    other = decoder.decode(datagram(state(), port=6667, password="for the others"))
    assert other.reason is FrameFault.UNDECRYPTABLE


def test_an_unlisted_port_is_known_by_the_password_that_fits():
    decoder = Decoder(PORT, {"One": "1", "Two": "2"})
    entry = decoder.decode(datagram(state(), port=6700, password="2"))
    assert (entry.kind, entry.speaker, entry.team) == (DatagramKind.MESSAGE, Speaker("robot", "Two"), "Two")


def test_decrypted_bytes_that_are_not_a_message_are_an_error_also_with_the_password_for_all():
    decoder = Decoder(PORT, {}, PASSWORD)
    message = pb.RobotState(time=NEVER, messages_saved=0)  # without a robot_state
    plain = b"\x1a\x0a\x00\x28" + message.SerializePartialToString()
    data = b"\x02\x02\x00\x00" + (16 + len(plain) // 16 * 16 + 16).to_bytes(4, "big")
    entry = decoder.decode(datagram(data + Key(PASSWORD).encrypt(Cipher.AES_128_CBC, plain), port=6667))
    assert entry.reason is FrameFault.INCOMPLETE


# -- the filter -------------------------------------------------------------------------------------

def passed(chosen, *datagrams):
    """Which of the datagrams a filter passes."""
    decoder = Decoder(PORT, {"Team": PASSWORD})
    return [chosen.passes(decoder.decode(one)) for one in datagrams]


def test_changes_of_each_sender_and_channel():
    decoder = Decoder(PORT, {}, PASSWORD)
    chosen = DatagramFilter(changes_only=True)
    steps = [
        (datagram(robot_beacon(sec=1)), True), (datagram(robot_beacon(sec=2)), False),
        (datagram(robot_beacon(sec=3), src="10.0.0.3"), True),
        (datagram(state(4), port=6667, password=PASSWORD), True),
        (datagram(state(5), port=6667, password=PASSWORD), False),
        (datagram(state(5), port=6668, password=PASSWORD), True),
        (datagram(state(6, robot_state=1), port=6667, password=PASSWORD), True),
        (datagram(b"?"), True), (datagram(b"?"), False), (datagram(b"??"), True),
        (datagram(robot_beacon(sec=4)), False), (datagram(robot_beacon("Other", sec=5)), True),
    ]
    assert [chosen.passes(decoder.decode(one)) for one, _ in steps] == [expected for _, expected in steps]


def test_the_sender_that_was_heard_longest_ago_is_forgotten_first():
    chosen = DatagramFilter(changes_only=True)
    everybody = [datagram(robot_beacon(), host(number)) for number in range(KEPT)]
    changed = datagram(robot_beacon("changed"), host(0))
    assert all(passed(chosen, *everybody, changed, datagram(robot_beacon(), "10.0.0.9")))
    assert passed(chosen, changed, everybody[2], everybody[1]) == [False, False, True]


def test_a_teams_datagrams():
    from_box = pb.BenchmarkState(benchmark_type="HWV", benchmark_state=pb.BenchmarkState.STOP)
    listed = datagram(box_beacon(("Team", "Robot", 6667), ("Other", "Robot", 6668)), "10.0.0.1")
    assert passed(
        DatagramFilter(team="Team"), datagram(box_beacon(("Other", "Robot", 6668))), listed, datagram(robot_beacon()),
        datagram(robot_beacon(team="Other")), datagram(state(), port=6667, password=PASSWORD),
        datagram(from_box, "10.0.0.1", 6667, PASSWORD), datagram(b"?", port=6667), datagram(b"?", "10.0.0.7", 6668),
    ) == [False, True, True, False, True, True, True, False]


def test_messages_of_a_type_and_errors():
    several = [datagram(robot_beacon()), datagram(box_beacon(("Team", "Robot", 6667))), datagram(b"?"),
               datagram(state(), port=6667, password="wrong"), datagram(state(), port=6700, password="unknown")]
    assert passed(DatagramFilter(message="RobotBeacon"), *several) == [True, False, False, False, False]
    assert passed(DatagramFilter(errors_only=True), *several) == [False, False, True, True, False]
