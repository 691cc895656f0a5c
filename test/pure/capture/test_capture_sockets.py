"""What is heard without root's rights, on real loopback sockets."""

import select
import socket

from helpers.small_box import BOX, BROADCAST, ROBOT, free_ports
from roah_rsbb.comm.capture.decoding import Decoder, Kind, Speaker
from roah_rsbb.comm.capture.listening import PlainListener
from roah_rsbb.comm.frame import encode
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

TIMEOUT_S = 10


def test_broadcasts_are_heard_and_unicast_stays_with_whom_it_was_sent_to():
    port, notices = free_ports(), []
    decoder = Decoder(port, {})
    listener = PlainListener(decoder, BROADCAST, notices.append)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as robot, \
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as box:
        try:
            robot.bind((ROBOT, port))  # a robot can still open its port
            robot.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
            box.bind((BOX, port))
            robot.sendto(b"unicast", (BOX, port))
            beacon = pb.RobotBeacon(team_name="Team", robot_name="Robot", time=pb.Time(sec=1, nsec=2))
            robot.sendto(encode(beacon), (BROADCAST, port))
            robot.sendto(encode(beacon)[:5], (BROADCAST, port))
            entries = []
            while len(entries) < 2:
                ready = select.select(listener.sockets, [], [], TIMEOUT_S)[0]
                assert ready, "nothing came"
                entries += [decoder.decode(one) for endpoint in ready for one in listener.read(endpoint)]
            box.settimeout(TIMEOUT_S)
            assert box.recv(100) == b"unicast"
        finally:
            listener.close()
    assert [entry.kind for entry in entries] == [Kind.MESSAGE, Kind.ERROR]
    assert entries[0].message == beacon and entries[0].datagram[1:5] == (ROBOT, port, BROADCAST, port)
    assert entries[1].speaker == Speaker("Robot", "Team")  # known by its address
    assert not notices
