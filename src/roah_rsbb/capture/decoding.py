"""Decodes datagrams into messages, or into the reason why they are not messages. No I/O and no clock.

The decoder learns while it listens: the box's beacons say which private port belongs to which robot, and each message
shows who sends from which address. Its memory is bounded, whatever the network brings.
"""

import enum
import ipaddress
import json
from collections import OrderedDict
from typing import Any, Dict, Iterator, NamedTuple, Optional, Tuple

from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.comm.frame import BadDatagram, FrameFault
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

# -- recorded datagrams -------------------------------------------------------------------------------

# The file is UTF-8 text with one JSON object per line. The first line identifies it:
#
#     {"roah_rsbb_capture": 1, "rsbb_port": 6666}
#
# with the version of the format and the public port. Each further line is a datagram, in the order of arrival:
#
#     {"time": 1700000000.123456, "src": "10.0.0.2", "sport": 6667, "dst": "10.0.0.1", "dport": 6667, "hex": "0202…"}
#
# `time` is UTC in seconds since 1970, by the listener's clock; `hex` is the complete UDP payload. Encrypted datagrams
# stay encrypted: a recording contains no passwords, and reading it requires the teams' passwords.

FORMAT = "roah_rsbb_capture"
VERSION = 1

LAST_SECOND = 2**32 - 1
"""Latest time that can be shown as a time of day."""

_MAX_PORT = 65535


class Datagram(NamedTuple):
    """One UDP datagram with its addresses."""

    time: float  # UTC seconds since 1970
    src: str  # IPv4 address
    sport: int
    dst: str  # IPv4 address, possibly a broadcast address
    dport: int
    data: bytes


class BadRecording(Exception):
    """The file is not a recording, or it is damaged. The text says where, what was found and what was expected."""


def header_line(rsbb_port: int) -> str:
    """The first line of a recording."""
    return json.dumps({FORMAT: VERSION, "rsbb_port": rsbb_port})


def datagram_line(datagram: Datagram) -> str:
    """The line of a datagram."""
    record = datagram._replace(time=round(datagram.time, 6))._asdict()
    record["hex"] = record.pop("data").hex()
    return json.dumps(record)


def read(lines: Iterator[str], name: str) -> Tuple[int, Iterator[Datagram]]:
    """Return the public port of a recording and an iterator over its datagrams. `name` appears in errors.

    Raises BadRecording immediately if it is not a recording. The iterator raises it for a damaged line.
    """
    first = _parse(next(lines, ""))
    if FORMAT not in first:
        raise BadRecording(f"{name}:1: this is not a recording of capture: the first line is not "
                           f"{header_line(6666)}")
    if first[FORMAT] != VERSION:
        raise BadRecording(f"{name}:1: the recording has format {first[FORMAT]!r}; this program reads only {VERSION}")
    port = first.get("rsbb_port")
    if not _is_port(port):
        raise BadRecording(f"{name}:1: found rsbb_port {port!r}; expected the number of a UDP port")
    return port, _datagrams(lines, name)


def _datagrams(lines: Iterator[str], name: str) -> Iterator[Datagram]:
    for number, line in enumerate(lines, 2):
        try:
            yield _datagram(_parse(line))
        except (KeyError, TypeError, ValueError, OverflowError):
            expected = datagram_line(Datagram(0.5, "10.0.0.2", 6667, "10.0.0.1", 6667, b"\x02"))
            cut = "" if line.endswith("\n") else "; the recording was cut off here"
            raise BadRecording(f"{name}:{number}: found an invalid line; expected one like {expected}{cut}") from None


def _datagram(record: Any) -> Datagram:
    """Raises KeyError, TypeError, ValueError or OverflowError."""
    time, ports = float(record["time"]), (record["sport"], record["dport"])
    if not 0 <= time <= LAST_SECOND or not all(map(_is_port, ports)):
        raise ValueError("out of range")
    src, dst = (str(ipaddress.IPv4Address(record[key])) for key in ("src", "dst"))
    return Datagram(time, src, ports[0], dst, ports[1], bytes.fromhex(record["hex"]))


def _parse(line: str) -> Any:
    """Parse the JSON object of a line; empty if there is none."""
    try:
        parsed = json.loads(line)
    except (ValueError, RecursionError):
        return {}
    return parsed if isinstance(parsed, dict) else {}


def _is_port(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= _MAX_PORT


# -- decoding -----------------------------------------------------------------------------------------

PRIVATE_PORTS = 99
"""This many ports above the public one count as private channels, also before a beacon lists them."""

_MAX_REMEMBERED = 1000


class NewestEntries(OrderedDict):
    """Remembers what was set last, because names and addresses can be forged."""

    def __setitem__(self, key: Any, value: Any) -> None:
        super().__setitem__(key, value)
        self.move_to_end(key)
        if len(self) > _MAX_REMEMBERED:
            self.popitem(last=False)


class Speaker(NamedTuple):
    """Who sent a datagram. `team` is empty for the box and the tablet."""

    name: str  # "box", "tablet", or the robot's name
    team: str = ""

    def __str__(self) -> str:
        return f"{self.team}/{self.name}" if self.team else self.name


BOX, TABLET = Speaker("box"), Speaker("tablet")


class DatagramKind(enum.Enum):
    """The result of decoding a datagram."""

    MESSAGE = "message"
    ENCRYPTED = "encrypted"  # without a known password
    ERROR = "error"  # not a message, or its receiver cannot decrypt it


class HeardDatagram(NamedTuple):
    """One datagram with the result of decoding."""

    datagram: Datagram
    kind: DatagramKind
    private: bool  # whether it was on a private channel
    speaker: Optional[Speaker]  # None: unknown
    team: str  # of the private channel or the speaker; empty: unknown, or no team
    message: Any = None  # for MESSAGE
    text: str = ""  # for other kinds: the reason
    reason: Optional[FrameFault] = None  # for ERROR


class Decoder:
    """Decodes the datagrams of one public port and the private ports above it."""

    def __init__(self, rsbb_port: int, passwords: Dict[str, str], password: Optional[str] = None) -> None:
        """`passwords` by team; `password` for all other teams. ValueError for an invalid password."""
        self.rsbb_port = rsbb_port
        self.listed: Dict[int, Speaker] = {}
        """Private ports in the latest beacon, with their robots."""
        self._keys = {team: Key(text) for team, text in passwords.items()}
        self._other_key = None if password is None else Key(password)
        self._robots = NewestEntries()  # of all ports that were ever listed
        self._speakers = NewestEntries()  # by address and port

    def concerns(self, datagram: Datagram) -> bool:
        """Whether the ports of a datagram are those of a channel."""
        if datagram.dport == self.rsbb_port or datagram.dport in self._robots:
            return True
        above = datagram.dport - self.rsbb_port
        return datagram.sport == datagram.dport and 1 <= above <= PRIVATE_PORTS

    def decode(self, datagram: Datagram) -> HeardDatagram:
        """Decode a datagram, using what was heard before."""
        if datagram.dport == self.rsbb_port:
            return self._public(datagram)
        return self._private(datagram)

    # -- public ---------------------------------------------------------------------------------------

    def _public(self, datagram: Datagram) -> HeardDatagram:
        try:
            message = frame.decode_public(datagram.data)
        except BadDatagram as bad:
            return self._error(datagram, False, self._speaker_at(datagram), bad)
        if isinstance(message, pb.RoahRsbbBeacon):
            self._learn(message)
            speaker = BOX
        elif isinstance(message, pb.RobotBeacon):
            speaker = Speaker(message.robot_name, message.team_name)
        else:
            speaker = TABLET
        return self._message(datagram, False, speaker, message)

    def _learn(self, beacon: pb.RoahRsbbBeacon) -> None:
        self.listed = {
            robot.rsbb_port: Speaker(robot.robot_name, robot.team_name)
            for robot in beacon.benchmarking_teams if 0 < robot.rsbb_port < 65536
        }
        for port, robot in self.listed.items():
            self._robots[port] = robot

    # -- private --------------------------------------------------------------------------------------

    def _private(self, datagram: Datagram) -> HeardDatagram:
        robot = self._robots.get(datagram.dport)
        speaker = self._speaker_at(datagram)
        try:
            frame.open_private(datagram.data)
            owner, message = self._decrypt(datagram, robot)
        except BadDatagram as bad:
            return self._error(datagram, True, speaker, bad)
        if message is None:
            return self._encrypted(datagram, robot, speaker)
        from_box = isinstance(message, pb.BenchmarkState)
        speaker = BOX if from_box else robot or Speaker("robot", owner)
        if robot is not None and owner not in ("", robot.team):
            detail = f"it has the password of team {owner}, but the channel belongs to {robot}"
            return self._error(datagram, True, speaker, BadDatagram(FrameFault.UNDECRYPTABLE, detail))
        return self._message(datagram, True, speaker, message)

    def _decrypt(self, datagram: Datagram, robot: Optional[Speaker]) -> Tuple[str, Any]:
        """Return the team whose password fits ("" for the common password) and the message; None if no password fits.

        Raises BadDatagram if the content is not a message, or if a password should have fitted.
        """
        own_team = robot.team if robot else ""
        candidates = sorted(self._keys.items(), key=lambda item: item[0] != own_team)
        if self._other_key is not None and own_team not in self._keys:
            candidates.append(("", self._other_key))
        should_fit = False
        for team, key in candidates:
            try:
                return team, frame.decode_private(datagram.data, key)
            except BadDatagram as bad:
                if bad.reason is not FrameFault.UNDECRYPTABLE:
                    raise
                should_fit = should_fit or team in ("", own_team)
        if should_fit:
            raise BadDatagram(FrameFault.UNDECRYPTABLE, "the given password does not fit")
        return "", None

    # -- entries --------------------------------------------------------------------------------------

    def _message(self, datagram: Datagram, private: bool, speaker: Speaker, message: Any) -> HeardDatagram:
        self._speakers[datagram.src, datagram.dport] = speaker
        return HeardDatagram(datagram, DatagramKind.MESSAGE, private, speaker, self._team(datagram, speaker), message)

    def _error(self, datagram: Datagram, private: bool, speaker: Optional[Speaker], bad: BadDatagram) -> HeardDatagram:
        return HeardDatagram(datagram, DatagramKind.ERROR, private, speaker, self._team(datagram, speaker),
                     text=str(bad), reason=bad.reason)

    def _encrypted(self, datagram: Datagram, robot: Optional[Speaker], speaker: Optional[Speaker]) -> HeardDatagram:
        cipher = frame.open_private(datagram.data).cipher
        known = f"of team {robot.team} is known" if robot else "known here fits"
        text = f"{len(datagram.data)} bytes with {cipher.label}: no password {known}"
        return HeardDatagram(datagram, DatagramKind.ENCRYPTED, True, speaker, self._team(datagram, speaker), text=text)

    def _team(self, datagram: Datagram, speaker: Optional[Speaker]) -> str:
        robot = self._robots.get(datagram.dport) or speaker
        return robot.team if robot else ""

    def _speaker_at(self, datagram: Datagram) -> Optional[Speaker]:
        """Who sent from this address before: on this port, or else on the public one."""
        for port in (datagram.dport, self.rsbb_port):
            speaker = self._speakers.get((datagram.src, port))
            if speaker is not None:
                return speaker
        return None
