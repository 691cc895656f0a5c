"""A client written from docs/protocol.md and the .proto file alone, as a team in another language would.

It shares no code with roah_rsbb except the generated messages. If it lacked something, the page would lack it.
"""

import hashlib
import os
import select
import socket
import struct
import time

from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives.ciphers import Cipher, algorithms, modes

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

STOP, PREPARING, WAITING_GOAL, EXECUTING, RESULT_TX = range(5)
BOX_STOP, PREPARE, GOAL_TX, WAITING_RESULT = range(4)

# "Robot's next state": (box, own) -> next. Any other pair keeps the state. Errors: go to STOP and report it.
NEXT = {
    (BOX_STOP, PREPARING): STOP, (BOX_STOP, WAITING_GOAL): STOP, (BOX_STOP, EXECUTING): STOP,
    (BOX_STOP, RESULT_TX): STOP,
    (PREPARE, STOP): PREPARING, (PREPARE, RESULT_TX): PREPARING,
    (GOAL_TX, STOP): STOP, (GOAL_TX, PREPARING): STOP, (GOAL_TX, WAITING_GOAL): EXECUTING,
    (WAITING_RESULT, STOP): STOP, (WAITING_RESULT, PREPARING): STOP, (WAITING_RESULT, WAITING_GOAL): EXECUTING,
}


class PageClient:
    """A robot whose work takes no time, with a string for each goal. `run` is its loop, for a separate thread."""

    def __init__(self, team, robot, password, own_host, broadcast_host, port):
        self.team, self.robot = team, robot
        self.goals = []
        self._own_host, self._broadcast = own_host, (broadcast_host, port)
        digest = password.encode()
        for _ in range(8):
            digest = hashlib.sha256(digest).digest()
        self._key = digest[:16]
        self._speak, self._hear = self._bound(own_host, port), self._bound(broadcast_host, port)
        self._private = self._box = None
        self._beacon_due = 0.0
        self._ended = False

    def end(self):
        self._ended = True

    def run(self):
        while not self._ended:
            ears = [self._hear] + ([self._private] if self._private else [])
            for ear in select.select(ears, [], [], 0.01)[0]:
                datagram, (host, _) = ear.recvfrom(65535)
                if ear is self._private:
                    self._on_private(datagram)
                else:
                    self._on_public(datagram, host)
            self._send_due()
        for one in (self._speak, self._hear, self._private):
            if one:
                one.close()

    def _bound(self, host, port):
        one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        one.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        one.bind((host, port))
        return one

    # -- public channel -----------------------------------------------------------------------------

    def _on_public(self, datagram, host):
        if datagram[:2] != b"\x02\x00" or datagram[8:12] != struct.pack(">HH", 6666, 10):
            return
        beacon = pb.RoahRsbbBeacon.FromString(datagram[12:])
        ports = [one.rsbb_port for one in beacon.benchmarking_teams
                 if (one.team_name, one.robot_name) == (self.team, self.robot)]
        port = ports[0] if ports else None
        if self._box == (host, port) or (self._box is None and port is None):
            return
        if self._private:
            self._private.close()
        self._box = self._private = None
        if port is not None:
            self._box, self._private = (host, port), self._bound(self._own_host, port)
            self._state, self._time, self._acknowledged = STOP, (0, 0), (0, 0)
            self._string, self._string_since = "", None
            self._result = None
            self._changed()

    # -- private channel ----------------------------------------------------------------------------

    def _on_private(self, datagram):
        if datagram[:2] != b"\x02\x02":
            return
        decryptor = Cipher(algorithms.AES(self._key), modes.CBC(datagram[8:24]), backend=default_backend()).decryptor()
        padded = decryptor.update(datagram[24:]) + decryptor.finalize()
        plain = padded[:-padded[-1]]
        if plain[:4] != struct.pack(">HH", 6666, 20):
            return
        message = pb.BenchmarkState.FromString(plain[4:])
        acknowledged = (message.acknowledgement.sec, message.acknowledgement.nsec)
        if acknowledged < self._acknowledged:
            return
        self._acknowledged = acknowledged
        if self._string and self._string_since is not None and acknowledged >= self._string_since:
            self._string = ""
        received = message.benchmark_state
        following = NEXT.get((received, self._state), self._state)
        if (received, self._state) == (PREPARE, EXECUTING) and message.benchmark_type == "HNF":
            following = PREPARING
        if following == EXECUTING and self._state == WAITING_GOAL:
            self.goals.append(message.generic_goal if received == GOAL_TX else None)
            self._string, self._string_since = f"goal {len(self.goals)}", None
        if following != self._state or (received in (GOAL_TX, WAITING_RESULT) and following == STOP):
            self._state = following
            self._changed()

    def _work(self):
        """Preparing takes no time. Executing lasts until the box has logged the string."""
        if self._state == PREPARING:
            self._state = WAITING_GOAL
            self._changed()
        elif self._state == EXECUTING and not self._string:
            self._state, self._result = RESULT_TX, f"result of {self.goals[-1]}"
            self._changed()

    # -- sending ------------------------------------------------------------------------------------

    def _changed(self):
        self._burst, self._state_due = 10, 0.0

    def _send_due(self):
        now = time.monotonic()
        if self._private is None:
            if now >= self._beacon_due:
                self._beacon_due = now + 1.0
                message = pb.RobotBeacon(team_name=self.team, robot_name=self.robot, time=self._clock())
                self._speak.sendto(self._frame(30, message, encrypted=False), self._broadcast)
        elif now >= self._state_due:
            self._state_due = now + (0.05 if self._burst else 1.0)
            self._burst = max(0, self._burst - 1)
            self._private.sendto(self._frame(40, self._robot_state(), encrypted=True), self._box)
            self._work()

    def _clock(self):
        return pb.Time(**dict(zip(("sec", "nsec"), divmod(time.time_ns(), 10**9))))

    def _robot_state(self):
        now = self._clock()
        self._time = max((now.sec, now.nsec), (self._time[0], self._time[1] + 1))
        message = pb.RobotState(
            time=pb.Time(sec=self._time[0], nsec=self._time[1]), messages_saved=1, robot_state=self._state
        )
        if self._string:
            message.notifications.append(self._string)
            self._string_since = self._string_since or self._time
        if self._state == RESULT_TX:
            message.generic_result = self._result
        return message

    def _frame(self, message_type, message, encrypted):
        payload = struct.pack(">HH", 6666, message_type) + message.SerializeToString()
        if encrypted:
            padding = 16 - len(payload) % 16
            iv = os.urandom(16)
            encryptor = Cipher(algorithms.AES(self._key), modes.CBC(iv), backend=default_backend()).encryptor()
            payload = iv + encryptor.update(payload + bytes([padding]) * padding) + encryptor.finalize()
        return struct.pack(">BBHI", 2, 2 if encrypted else 0, 0, len(payload)) + payload
