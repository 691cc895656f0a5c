"""Two boxes that get the same datagrams, at the same times: with one of them, repetitions take the short way
(`roah_rsbb.radio.short_way`), with the other one none does. Nobody may see a difference.

A wild network and wild robots make the datagrams: clocks that are set, losses, copies, late ones, those that another
host sends, changes of any field and of any byte.
"""

import random

from helpers import golden
from helpers.commands import COMMANDS, given_with
from helpers.competition import TEAMS, competition, event
from roah_rsbb.comm import frame
from roah_rsbb.comm.channels import Network
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views.document import Documents
from roah_rsbb.model.as_json import to_json
from roah_rsbb.model.reason import Refused
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import RobotState
from roah_rsbb.radio.driver import NetworkDriver
from roah_rsbb.radio.radio import beacon_size
from simulation.scheduler import Computer, Process, Scheduler

BROADCAST, BOX, PORT = "10.0.0.255", "10.0.0.1", 6666
RIVAL = "10.0.0.9"
HOSTS = ("10.0.0.2", "10.0.0.3", "10.0.0.4", "10.0.0.5")
CIPHERS = [cipher for cipher in Cipher if cipher is not Cipher.NONE]
LONG_S = 36_000.0
SAID = ("notifications", "activation_event", "visitor", "final_command")
NUMBERS = ("messages_saved", "devices_dimmer", "devices_blinds")
FLAGS = ("devices_switch_1", "devices_switch_2", "devices_switch_3", "tablet_display_map")


class _Peer:
    """A peer of one box: what it receives, the test hands over."""

    def __init__(self, twin, port, on_datagram):
        self.rsbb_host, self.port, self.on_datagram, self.is_open = BROADCAST, port, on_datagram, False
        self.received_utc = None
        self._twin = twin

    def open(self):
        self.is_open, self._twin.peers[self.port] = True, self

    def close(self):
        if self.is_open:
            self.is_open = False
            del self._twin.peers[self.port]

    def send(self, datagram, host):
        self._twin.sent(self.port, host, datagram)
        return True


class Twin(NetworkDriver):
    """One of the boxes."""

    def __init__(self, config, can_wait):
        self.scheduler = Scheduler()
        self.computer = Computer(self.scheduler, "box", BOX)
        self.loop = Process(self.computer, "core").loop
        self.peers = {}  # open ones, by port
        self.seen = []  # effects and datagrams, in their order
        self._keys = [Key(password) for password in config.passwords.values()]
        settings = Settings(PORT, listen_duration=0.0, robot_timeout=20.0)
        super().__init__(
            self.loop, Box(config, settings, beacon_size), Network(BROADCAST, PORT, BOX, CIPHERS[1], False, 2000),
            dict(config.passwords), self._warn, self.computer.utc, self._peer, can_wait)
        self._documents = Documents(self.box, "uuid", BROADCAST)
        self.open()

    def _peer(self, _loop, _host, port, on_datagram, *_args, **_options):
        return _Peer(self, port, on_datagram)

    def sent(self, port, host, datagram):
        """Note what the box sends, but for the random initialisation vector."""
        if port != PORT:
            datagram = next(plain for plain in (_decrypted(datagram, key) for key in self._keys) if plain)
        self.seen.append((self.loop.time(), port, host, datagram))

    def _warn(self, text):
        self.seen.append((self.now(), text))

    def on_effect(self, effect):
        """See `NetworkDriver`."""
        if type(effect).__name__ != "SendState" or effect.how.name != "QUIET":
            self.seen.append((self.now(), effect))

    def receive(self, port, datagram, sender, late_s):
        """A datagram is read that arrived `late_s` ago."""
        peer = self.peers.get(port)
        if peer is not None:
            peer.received_utc = None if late_s is None else self.computer.utc() - late_s
            peer.on_datagram(datagram, sender)

    def command(self, zone, command, team):
        """The referee presses a button."""
        try:
            self.event(self.box.act, Target(zone), command, "", given_with(command, team))
        except Refused as refused:
            self.seen.append((self.now(), [str(reason) for reason in refused.reasons]))

    @property
    def waits(self):
        """Whether anything waits."""
        return bool(self._turns.waiting)

    def look(self):
        """Everything that anybody can see now."""
        now, zones = self.now(), self.box.zones.values()
        states = [to_json(zone.saved()) for zone in zones]
        seen, self.seen = self.seen, []
        return (now, seen, self._documents.look(now), states, self.box.zones.link_samples(now, self.radio.unreadable()),
                self.box.timers.deadline() is None)


class _Robot:
    """A robot that says anything."""

    def __init__(self, rng, contents, team, host, zone):
        self.rng, self.contents, self.host, self.zone, self.team = rng, contents, host, zone, team
        self.ahead_s, self.cipher, self.reserved = 0.0, Cipher.AES_128_CBC, bytes(2)
        self.message = pb.RobotState(messages_saved=1, robot_state=0)
        self.sent = []  # the last datagrams

    def change(self):
        """Say something else, or set a clock."""
        rng, message = self.rng, self.message
        kind = rng.randrange(14)
        if kind < 5:
            message.robot_state = rng.choice(list(RobotState))
        elif kind == 5:
            setattr(message, rng.choice(NUMBERS), rng.randrange(120))
        elif kind == 6:
            field = getattr(message, rng.choice(SAID))
            field[:] = [] if field else [rng.choice("ab"), *rng.choices("abc", k=rng.randrange(2))]
        elif kind == 7:
            setattr(message, rng.choice(FLAGS), rng.random() < 0.5)
        elif kind == 8:
            self.message = pb.RobotState.FromString(rng.choice(self.contents))
        elif kind == 9:
            self.ahead_s += rng.choice((0.02, -0.02, 0.09, -0.09, 0.2, -0.2, 5.0, -5.0, 60.0))
        elif kind < 13:
            self.ahead_s = 0.0
        else:
            self.cipher, self.reserved = rng.choice(CIPHERS), bytes(rng.randrange(256) for _ in range(2))

    def datagram(self, key, utc):
        """Its next report."""
        self.message.time.sec, self.message.time.nsec = divmod(round((utc + self.ahead_s) * 1e9), 10**9)
        datagram = frame.encode(self.message, self.cipher, key)
        datagram = datagram[:2] + self.reserved + datagram[4:]
        self.sent = [*self.sent[-7:], datagram]
        return datagram


class TwinBoxes:
    """The boxes, and all that happens to both."""

    def __init__(self, seed):
        self.rng = random.Random(seed)
        config = competition(
            a=["HCFGAC", "HWV"], b=[event("HGTKMH", team="Beta", timeout=30.0), event("HNF", team="Beta")],
            c=[event("HWV", team="Alpha", timeout=LONG_S)], all=[event("HSUF", team="ALL", timeout=LONG_S)])
        self.twins = [Twin(config, can_wait) for can_wait in (True, False)]
        self.keys = {team: Key(password) for team, password in config.passwords.items()}
        contents = _recorded()
        self.robots = [_Robot(self.rng, contents, TEAMS[n % 2], host, zone)
                       for n, (host, zone) in enumerate(zip(HOSTS, ("a", "b", "c", "all")))]
        # Of the same names and passwords, at another address.
        self.rivals = [_Robot(self.rng, contents, robot.team, RIVAL, robot.zone) for robot in self.robots]
        self.late = []  # datagrams that overtake each other
        self.datagrams = self.waited = 0

    def _both(self, act):
        for twin in self.twins:
            act(twin)

    def step(self):
        """Something happens, mostly a report that repeats the one before."""
        rng, what = self.rng, self.rng.random()
        robot, rival = rng.choice(list(zip(self.robots, self.rivals)))
        if what < 0.01:
            if rng.random() < 0.5:  # the robot may say the same next
                rival.change()
                robot.message.CopyFrom(rival.message)
            self._report(rival)
        elif what < 0.02:
            self._send(robot, bytes([2, rng.randrange(6)] + [rng.randrange(256) for _ in range(rng.randrange(90))]),
                       rng.choice((robot.host, RIVAL)))
        elif what < 0.91:
            self._report(robot)
        elif what < 0.92:
            robot.change()
        elif what < 0.935:
            self._beacon(robot)
        elif what < 0.95:
            command = rng.choice(sorted(COMMANDS)) if rng.random() < 0.05 else rng.choice(["connect", "start"])
            self._both(lambda twin: twin.command(robot.zone, command, robot.team))
        elif what < 0.951:
            seconds = rng.choice((0.03, -0.03, 0.03, -0.03, 1.0, -1.0, 3600.0))
            self._both(lambda twin: twin.computer.set_clock(seconds))
        elif what < 0.965 and robot.sent:
            self._send(robot, rng.choice(robot.sent), rng.choice((robot.host, robot.host, HOSTS[0])))
        elif what < 0.968 and robot.sent:
            wrong = bytearray(rng.choice(robot.sent))
            wrong[rng.randrange(len(wrong))] ^= 1 << rng.randrange(8)
            self._send(robot, bytes(wrong), robot.host)
        elif self.late:
            self._send(*self.late.pop(rng.randrange(len(self.late))))
        self._pass(rng.choice((0.0, 0.001, 0.01, 0.05, 0.05, 0.2)) if rng.random() < 0.997 else rng.choice((1.0, 4.0)))

    def _pass(self, seconds):
        end = self.twins[0].scheduler.now + seconds
        self._both(lambda twin: twin.scheduler.run(end))

    def _report(self, robot):
        if self.rng.random() < 0.03:
            robot.ahead_s = 0.0  # somebody synchronised it
        late_s = self.rng.choice((0.0, 0.0, 0.001, 0.05, None)) if self.rng.random() < 0.98 else 0.3
        sent_utc = self.twins[0].computer.utc() - (late_s or 0.0) - 0.001
        datagram = robot.datagram(self.keys[robot.team], sent_utc)
        way = self.rng.random()
        if way < 0.94:
            self._send(robot, datagram, robot.host, late_s)
        elif way < 0.97:
            self.late.append((robot, datagram, robot.host))

    def _beacon(self, robot):
        message = pb.RobotBeacon(team_name=robot.team, robot_name=f"r{robot.zone}")
        message.time.sec, message.time.nsec = divmod(
            round((self.twins[0].computer.utc() + robot.ahead_s) * 1e9), 10**9)
        datagram = frame.encode(message)
        self._both(lambda twin: twin.receive(PORT, datagram, (robot.host, PORT), 0.001))

    def _send(self, robot, datagram, host, late_s=0.001):
        self.datagrams += 1
        ports = [run.port for run in self.twins[0].box.zones.members() if run.zone == robot.zone]
        if ports:
            port = self.rng.choice(ports)
            self._both(lambda twin: twin.receive(port, datagram, (host, port), late_s))
            self.waited += self.twins[0].waits

    def check(self):
        """Compare all that can be seen. Returns what differs; None: nothing."""
        looks = [twin.look() for twin in self.twins]
        return None if looks[0] == looks[1] else looks


def _decrypted(datagram, key):
    try:
        return frame.decrypt(datagram, key)
    except frame.BadDatagram:
        return None


def _recorded():
    """The reports of original robots."""
    key = Key(golden.PASSWORD)
    return sorted({
        frame.decode_private(bytes.fromhex(entry["hex"]), key).SerializeToString()
        for name in golden.SESSIONS for entry in golden.load(name) if entry["decoded"].get("type") == "RobotState"})
