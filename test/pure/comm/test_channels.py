"""Box, robots and tablet on one machine, with real sockets on different loopback addresses."""

import os
import pathlib
import socket

import pytest
from google.protobuf.message import EncodeError

from helpers import golden
from roah_rsbb.comm import frame
from roah_rsbb.comm.channels import BITS_PER_ENTRY, Network, PrivateChannel, PublicChannel, Seen
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

BROADCAST, ANY = "127.255.255.255", "0.0.0.0"
BOX, ROBOT, RIVAL = "127.0.0.1", "127.0.0.2", "127.0.0.3"
KEY = Key(golden.PASSWORD)

TIME = pb.Time(sec=1, nsec=2)
ROBOT_BEACON = pb.RobotBeacon(team_name="Équipe", robot_name="b", time=TIME)
TABLET_BEACON = pb.TabletBeacon(last_call=TIME, last_pos=TIME, x=1.0, y=2.0)
BOX_STATE = pb.BenchmarkState(benchmark_type="HWV", benchmark_state=pb.BenchmarkState.PREPARE)
ROBOT_STATE = pb.RobotState(time=TIME, messages_saved=1, robot_state=pb.RobotState.EXECUTING)


@pytest.fixture
def public(loop, port, inbox, opened):
    """Open a public channel with inboxes `messages` and `reported` (complaints)."""
    def make(bind_host, rsbb_host=BROADCAST, apart=False, **options):
        messages, reported = inbox(), inbox()
        channel = PublicChannel(loop, Network(rsbb_host, port, bind_host, **options), messages, reported, apart)
        channel.messages, channel.reported = messages, reported
        return opened(channel)
    return make


@pytest.fixture
def private(loop, port, inbox, opened):
    """Open a private channel with inboxes `messages` and `reported` (complaints)."""
    def make(bind_host, key=KEY, remote=None, rsbb_host=BROADCAST, **options):
        messages, reported = inbox(), inbox()
        network = Network(rsbb_host, port, bind_host, **options)
        channel = PrivateChannel(loop, network, port, key, messages, reported)
        channel.messages, channel.reported, channel.remote = messages, reported, remote
        return opened(channel)
    return make


# -- public ---------------------------------------------------------------------------------------------

def test_a_broadcast_reaches_all_but_its_sender(public, port):
    box, robot, rival = public(BOX), public(ROBOT), public(RIVAL)
    assert robot.send(ROBOT_BEACON)
    assert box.messages.wait() == rival.messages.wait() == [(ROBOT_BEACON, (ROBOT, port))]
    assert box.send(TABLET_BEACON)
    assert robot.messages.wait() == [(TABLET_BEACON, (BOX, port))]
    assert rival.messages.wait(2)[1] == (TABLET_BEACON, (BOX, port))
    assert len(box.messages) == 1


def test_participants_on_all_addresses_and_on_their_own_hear_each_other(public, port):
    anywhere, also, robot = public(ANY), public(ANY), public(ROBOT)
    assert robot.send(ROBOT_BEACON)
    for channel in (anywhere, also):
        assert channel.messages.wait() == [(ROBOT_BEACON, (ROBOT, port))]
    assert anywhere.send(TABLET_BEACON)
    assert robot.messages.wait() == [(TABLET_BEACON, (BOX, port))]  # that of a sender on all addresses
    robot.send(ROBOT_BEACON)
    assert [message for message, _ in anywhere.messages.wait(2)] == [ROBOT_BEACON] * 2


@pytest.mark.parametrize("robot_first", [False, True])
def test_a_robot_may_be_given_the_boxes_own_address(public, port, robot_first):
    hosts = [(ROBOT, BOX), (BOX, BROADCAST)] if robot_first else [(BOX, BROADCAST), (ROBOT, BOX)]
    channels = {bind_host: public(bind_host, rsbb_host) for bind_host, rsbb_host in hosts}
    box, robot = channels[BOX], channels[ROBOT]
    assert robot.send(ROBOT_BEACON)
    assert box.messages.wait() == [(ROBOT_BEACON, (ROBOT, port))]
    assert box.send(TABLET_BEACON)
    assert robot.messages.wait() == [(TABLET_BEACON, (BOX, port))]
    assert not robot.reported


def test_a_bad_datagram_is_one_complaint_and_the_next_message_is_received(public, port):
    box = public(BOX)
    bad = bytes.fromhex(golden.load("bad_frames")[3]["datagram_hex"])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.bind((RIVAL, 0))
        for datagram in (bad, bad, b"", frame.encode(ROBOT_BEACON)):
            sender.sendto(datagram, (BOX, port))
        assert box.messages.wait() == [(ROBOT_BEACON, sender.getsockname())]
    assert len(box.reported) == 2
    assert f"public channel: a bad datagram from {RIVAL}:" in box.reported[0]
    assert box.complaints.totals() == {(RIVAL, "wrong size"): 2, (RIVAL, "too short"): 1}


def test_no_state_is_sent_unencrypted(public):
    with pytest.raises(ValueError, match="BenchmarkState does not belong on the public channel"):
        public(BOX).send(BOX_STATE)


def test_an_incomplete_message_is_the_callers_mistake(public):
    with pytest.raises(EncodeError):
        public(BOX).send(pb.RobotBeacon(team_name="a"))


def test_a_beacon_over_the_limit_is_not_sent(public):
    robot = public(ROBOT, max_datagram=100)
    beacon = pb.RobotBeacon(team_name="a" * 100, robot_name="b", time=TIME)
    assert frame.encoded_size(beacon) > 100
    assert robot.send(beacon) is False
    assert "raise max_datagram" in robot.reported[0]


def test_address_and_port_are_shown(public, port):
    channel = public(BOX)
    assert (channel.addr, channel.port, channel.is_open) == (BROADCAST, port, True)
    channel.close()
    assert not channel.is_open
    assert channel.send(ROBOT_BEACON) is False


# -- private --------------------------------------------------------------------------------------------

def test_box_and_robot_by_unicast(private, port):
    box, robot, rival = private(BOX), private(ROBOT, remote=BOX), private(RIVAL, remote=BOX)
    assert box.send(BOX_STATE) is False  # nobody to send to yet
    assert robot.send(ROBOT_STATE)
    [(message, (host, _))] = box.messages.wait()
    assert (message, host) == (ROBOT_STATE, ROBOT)
    box.remote = host
    assert box.send(BOX_STATE)
    assert robot.messages.wait() == [(BOX_STATE, (BOX, port))]
    box.remote = RIVAL
    assert box.send(BOX_STATE)
    assert rival.messages.wait() == [(BOX_STATE, (BOX, port))]
    assert len(robot.messages) == 1
    assert not box.reported + robot.reported + rival.reported


def test_a_box_that_broadcasts(private, port):
    box, robot, rival = private(BOX, broadcast=True), private(ROBOT, remote=BOX), private(RIVAL, remote=BOX)
    assert box.send(BOX_STATE)
    assert robot.messages.wait() == rival.messages.wait() == [(BOX_STATE, (BOX, port))]
    assert rival.send(ROBOT_STATE)
    assert [message for message, _ in box.messages.wait()] == [ROBOT_STATE]  # and not its own


@pytest.mark.parametrize("cipher", [cipher for cipher in Cipher if cipher is not Cipher.NONE])
def test_any_cipher_is_understood(private, cipher):
    box, robot = private(BOX), private(ROBOT, remote=BOX, cipher=cipher)
    assert robot.send(ROBOT_STATE)
    assert box.messages.wait()[0][0] == ROBOT_STATE


def test_a_wrong_password_is_named(private, port):
    box, robot = private(BOX), private(ROBOT, key=Key("wrong"), remote=BOX)
    assert robot.send(ROBOT_STATE)
    [text] = box.reported.wait()
    assert text.startswith(f"private channel {port}: a bad datagram from {ROBOT}:{port}: does not decrypt")
    assert "wrong password" in text
    assert not box.messages


def test_a_second_program_on_the_same_address_is_noticed(private, port):
    private(BOX)
    for bind_host in (BOX, ANY):
        with pytest.raises(OSError, match=f"cannot open UDP {bind_host}:{port}: in use by another program"):
            private(bind_host)
    private(ROBOT)  # while one on another address is no trouble


def test_the_port_is_free_again_after_closing(private):
    private(BOX).close()
    box, robot = private(BOX), private(ROBOT, remote=BOX)
    assert robot.send(ROBOT_STATE)
    assert len(box.messages.wait()) == 1


def test_a_private_channel_is_never_plain(private):
    with pytest.raises(ValueError, match="must be encrypted"):
        private(BOX, cipher=Cipher.NONE)
    with pytest.raises(ValueError, match="RobotBeacon does not belong on the private channel"):
        private(BOX, remote=ROBOT).send(ROBOT_BEACON)


@pytest.mark.parametrize("host", ["", "robot", "10.0.0.256", "::1"])
def test_the_other_side_is_an_address(private, host):
    channel = private(BOX, remote=ROBOT)
    with pytest.raises(ValueError):
        channel.remote = host
    assert channel.remote == ROBOT


def test_a_state_over_the_limit_is_not_sent(private):
    robot = private(ROBOT, remote=BOX)
    state = pb.RobotState(generic_result="x" * 1000)
    state.MergeFrom(ROBOT_STATE)
    assert robot.send(state) is False
    assert "raise max_datagram" in robot.reported[0]


# -- ciphertexts that were taken before are known, and new ones are not -------------------------------

def test_what_was_added_is_known_and_nothing_else():
    seen = Seen(2**16)
    texts = [os.urandom(32) for _ in range(2**16 // BITS_PER_ENTRY)]
    mistaken = 0
    for text in texts:
        mistaken += seen.place(text) in seen
        seen.add(seen.place(text))
        assert seen.place(text) in seen
    assert all(seen.place(text) in seen for text in texts)
    # One in 2,000 is expected of the full filter, and fewer while it fills.
    assert mistaken <= 20
    assert sum(seen.place(os.urandom(32)) in seen for _ in range(2000)) <= 20


@pytest.mark.long
def test_a_full_filter_is_kept_while_the_next_one_fills():
    seen = Seen(2**12)
    capacity = 2**12 // BITS_PER_ENTRY
    texts = [os.urandom(32) for _ in range(3 * capacity)]
    for number, text in enumerate(texts):
        seen.add(seen.place(text))
        assert all(seen.place(last) in seen for last in texts[max(0, number - capacity + 1):number + 1])
    assert sum(seen.place(text) in seen for text in texts[:capacity]) <= capacity // 10
    assert sum(seen.place(os.urandom(32)) in seen for _ in range(2000)) <= 40


def test_a_filter_that_is_hardly_filled_takes_hardly_any_memory():
    statm = pathlib.Path("/proc/self/statm")
    before = int(statm.read_text("ascii").split()[1])
    seen = Seen(2**30)
    seen.add(seen.place(b"first"))
    pages = int(statm.read_text("ascii").split()[1]) - before
    assert pages * os.sysconf("SC_PAGE_SIZE") < seen._bits // 8 // 10
    assert seen.place(b"first") in seen
