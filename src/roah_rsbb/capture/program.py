"""`rosrun roah_rsbb capture` and `roah-rsbb capture`: shows the datagrams on the network."""

import argparse
import contextlib
import json
import math
import os
import select
import shlex
import signal
import sys
import time
from collections import Counter
from typing import Any, Callable, Dict, Iterator, List, Optional, Set, TextIO

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message

from roah_rsbb.capture import decoding
from roah_rsbb.capture.decoding import (
    BOX,
    LAST_SECOND,
    TABLET,
    Datagram,
    DatagramKind,
    Decoder,
    HeardDatagram,
    NewestEntries,
)
from roah_rsbb.capture.listening import DatagramListener, PlainListener, RawListener
from roah_rsbb.comm import sockets
from roah_rsbb.comm.ciphers import PASSWORD_VARIABLE, own_password
from roah_rsbb.comm.complaints import likely_cause
from roah_rsbb.comm.frame import PRIVATE_TYPES, PUBLIC_TYPES
from roah_rsbb.ground.arguments import Parser, add_password, called, number, public_port
from roah_rsbb.ground.installed import warn_if_replaced
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.rulebook.config import PasswordsFile
from roah_rsbb.rulebook.errors import ConfigErrors, Report
from roah_rsbb.wording.texts import escaped

# -- what is shown ------------------------------------------------------------------------------------

def fields_of(message: Message) -> Dict[str, Any]:
    """The fields that a message contains: numbers, bools, texts, names of enum values, lists, and messages as dicts."""
    return {field.name: _field_value(field, value) for field, value in message.ListFields()}


def _field_value(field: FieldDescriptor, value: Any) -> Any:
    if hasattr(value, "extend"):  # repeated; its class depends on the version of protobuf
        return [_field_value(field, item) for item in value]
    if field.message_type is not None:
        return fields_of(value)
    if field.enum_type is not None:
        return field.enum_type.values_by_number[value].name
    return value


# -- filter -----------------------------------------------------------------------------------------

_TIMES = ("time", "acknowledgement")  # fields that differ in every message


class DatagramFilter:
    """Passes the datagrams that meet all conditions."""

    def __init__(self, team: Optional[str] = None, message: Optional[str] = None, errors_only: bool = False,
                 changes_only: bool = False) -> None:
        """`team`: only it, and beacons that list it. `message`: only this type. `changes_only`: no repetitions."""
        self._team = team
        self._message = message
        self._errors_only = errors_only
        self._changes_only = changes_only
        self._last = NewestEntries()  # contents by sender, port and type

    def passes(self, entry: HeardDatagram) -> bool:
        """Whether to show a datagram. Call it once for each one, in order."""
        if self._errors_only and entry.kind is not DatagramKind.ERROR:
            return False
        if self._message is not None and not self._is_message(entry):
            return False
        if self._team is not None and not self._is_team(entry):
            return False
        return not self._changes_only or self._changed(entry)

    def _is_message(self, entry: HeardDatagram) -> bool:
        return entry.kind is DatagramKind.MESSAGE and entry.message.DESCRIPTOR.name == self._message

    def _is_team(self, entry: HeardDatagram) -> bool:
        if isinstance(entry.message, pb.RoahRsbbBeacon):
            return any(robot.team_name == self._team for robot in entry.message.benchmarking_teams)
        return entry.team == self._team

    def _changed(self, entry: HeardDatagram) -> bool:
        """Whether a datagram differs from the latest one of the same sender and type, ignoring times."""
        if entry.kind is not DatagramKind.MESSAGE:
            kind, content = entry.kind.value, entry.text.encode("utf-8", "replace")
        else:
            message = type(entry.message)()
            message.CopyFrom(entry.message)
            for field in _TIMES:
                if field in message.DESCRIPTOR.fields_by_name:
                    message.ClearField(field)
            kind, content = message.DESCRIPTOR.name, message.SerializePartialToString()
        key = (entry.datagram.src, entry.datagram.dport, kind)
        if self._last.get(key) == content:
            return False
        self._last[key] = content
        return True


# -- lines ------------------------------------------------------------------------------------------

_DIM, _RED, _GREEN, _YELLOW, _MAGENTA, _CYAN = "2", "31", "32", "33", "35", "36"
_NS = 1_000_000_000
_WIDEST_COLUMN = 40
_HIGHLIGHTED = {"benchmark_state", "robot_state"}


class TextLines:
    """Formats datagrams as lines of text: time, channel, address, speaker, content.

    The columns for addresses and names grow with their content, up to a limit.
    """

    def __init__(self, color: bool = False) -> None:
        self._color = color
        self._widths = {"sender": len("255.255.255.255"), "speaker": len("TestingTeam/TestingRobot")}

    def line(self, entry: HeardDatagram) -> str:
        """The next line."""
        datagram = entry.datagram
        channel = str(datagram.dport) if entry.private else "public"
        sender = f"{datagram.src}:{datagram.sport}" if datagram.sport != datagram.dport else datagram.src
        speaker = escaped(str(entry.speaker)) if entry.speaker else "unknown"
        return " ".join([
            self._paint(_clock(datagram.time), _DIM), f"{channel:<6}", self._column("sender", sender),
            self._column("speaker", speaker), self._what(entry),
        ])

    def _what(self, entry: HeardDatagram) -> str:
        if entry.kind is DatagramKind.ERROR:
            return self._paint(f"ERROR {escaped(entry.text)}. {likely_cause(entry.reason)}", _RED)
        if entry.kind is DatagramKind.ENCRYPTED:
            return self._paint(f"encrypted, {escaped(entry.text)}", _YELLOW)
        code = {BOX: _CYAN, TABLET: _MAGENTA}.get(entry.speaker, _GREEN)
        shown = [self._paint(entry.message.DESCRIPTOR.name, code)]
        for key, value in fields_of(entry.message).items():
            text = _text(value)
            shown.append(f"{key}={self._paint(text, code) if key in _HIGHLIGHTED else text}")
        skew = skew_s(entry)
        if skew is not None:
            shown.append(f"skew={skew:+.3f}s")
        return " ".join(shown)

    def _column(self, name: str, text: str) -> str:
        self._widths[name] = width = max(self._widths[name], min(len(text), _WIDEST_COLUMN))
        return text.ljust(width)

    def _paint(self, text: str, code: str) -> str:
        return f"\x1b[{code}m{text}\x1b[0m" if self._color else text


def json_line(entry: HeardDatagram) -> str:
    """Format everything that is known of a datagram as a JSON object. Unknown and inapplicable keys are absent."""
    datagram = entry.datagram
    known: Dict[str, Any] = {
        "time": round(datagram.time, 6),
        "channel": "private" if entry.private else "public",
        "src": datagram.src, "sport": datagram.sport, "dst": datagram.dst, "dport": datagram.dport,
        "size": len(datagram.data),
        "kind": entry.kind.value,
    }
    if entry.speaker is not None:
        known["speaker"] = str(entry.speaker)
    if entry.team:
        known["team"] = entry.team
    if entry.kind is DatagramKind.MESSAGE:
        known["message"] = entry.message.DESCRIPTOR.name
        known["fields"] = _strict(fields_of(entry.message))
        skew = skew_s(entry)
        if skew is not None:
            known["skew_s"] = round(skew, 6)
    else:
        known["text"] = entry.text
        if entry.reason is not None:
            known["reason"] = entry.reason.value
            known["likely_cause"] = likely_cause(entry.reason)
    return json.dumps(known)


def skew_s(entry: HeardDatagram) -> Optional[float]:
    """The robot's clock minus the listener's clock in seconds, for a robot's message with a time."""
    if entry.kind is not DatagramKind.MESSAGE or "time" not in entry.message.DESCRIPTOR.fields_by_name:
        return None
    sent = entry.message.time
    # Subtract whole seconds first: a float of this size cannot hold nanoseconds.
    seconds = math.floor(entry.datagram.time)
    return sent.sec - seconds + sent.nsec / _NS - (entry.datagram.time - seconds)


def _text(value: Any) -> str:
    """Format a field's value unambiguously in one line."""
    if isinstance(value, str):
        return value if value.isidentifier() else escaped(json.dumps(value, ensure_ascii=False))
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return "[" + ", ".join(map(_text, value)) + "]"
    if not isinstance(value, dict):
        return str(value)
    if set(value) == {"sec", "nsec"}:
        return _wire_time(value["sec"], value["nsec"])
    if set(value) == {"team_name", "robot_name", "rsbb_port"}:
        return f"{_text(value['team_name'])}/{_text(value['robot_name'])}:{value['rsbb_port']}"
    return "{" + ", ".join(f"{key}={_text(inner)}" for key, inner in value.items()) + "}"


def _wire_time(sec: int, nsec: int) -> str:
    """Format a time as time of day with microseconds; an invalid time as numbers."""
    if (sec, nsec) == (0, 0):
        return "never"
    if 0 <= sec <= LAST_SECOND and 0 <= nsec < _NS:
        return time.strftime("%H:%M:%S", time.gmtime(sec)) + f".{nsec // 1000:06}"
    return f"{sec}s+{nsec}ns"


def _clock(utc: float) -> str:
    milliseconds = math.floor(utc * 1000)
    return time.strftime("%H:%M:%S", time.gmtime(milliseconds // 1000)) + f".{milliseconds % 1000:03}"


def _strict(value: Any) -> Any:
    """Replace numbers that JSON cannot express."""
    if isinstance(value, dict):
        return {key: _strict(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_strict(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


# -- the program --------------------------------------------------------------------------------------

PROGRAM = called("capture")
MESSAGES = tuple(kind.DESCRIPTOR.name for kind in PUBLIC_TYPES + PRIVATE_TYPES)

_DESCRIPTION = """\
Shows every datagram between box, robots and tablet: time (UTC), channel, address, speaker, and the message with its
fields, or the reason why it is not a message. The program only listens. Ctrl-C ends it.
"""

_EPILOG = f"""\
what can be heard
  As root (or with CAP_NET_RAW) on Linux: everything that reaches or leaves this machine, and what its programs send
  to each other. Otherwise: broadcasts, that is, the public channel.
  Box and robot exchange the states of a run by unicast. Capture them as root on the box's or the robot's machine.
  Switches and access points do not deliver them to a third machine. With the core's parameter
  private_mode:=broadcast, a third machine gets the box's states, but not the robot's.
  The program learns the private ports of runs from the box's beacons.

passwords
  --passwords FILE is the box's passwords file. The password of one team comes from --password-file, the environment
  variable {PASSWORD_VARIABLE}, or --password, which is visible in this machine's list of processes. Add --team;
  otherwise the password is tried on every channel.

examples
  on the box's machine:  {PROGRAM} --host 192.168.1.255 --passwords config/passwords.yaml
  on a robot:            {PROGRAM} --host 192.168.1.255 --team MyTeam --password-file key.txt
  all on one machine:    {PROGRAM} --host 127.255.255.255 --passwords config/passwords.yaml
  only errors:           {PROGRAM} --host 192.168.1.255 --passwords config/passwords.yaml --errors-only
  record, then show:     {PROGRAM} --host 192.168.1.255 --write run.jsonl
                         {PROGRAM} --read run.jsonl --passwords config/passwords.yaml --changes-only
  for other programs:    {PROGRAM} --read run.jsonl --json | jq 'select(.message == "RobotState").fields'
"""


def parse_options(arguments: Optional[List[str]]) -> argparse.Namespace:
    """Parse the arguments; ends the program with an error message if they are invalid."""
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    source = parser.add_argument_group("source")
    source.add_argument("--host", default="10.255.255.255",
                        help="the network's broadcast address, like the box's rsbb_host (default: %(default)s)")
    source.add_argument("--port", type=public_port, default=6666, help="public UDP port (default: %(default)s)")
    source.add_argument("--plain", action="store_true", help="hear broadcasts only, even as root")
    source.add_argument("--duration", type=number(0, 1e9), metavar="S", help="end after this many seconds")
    keep = source.add_mutually_exclusive_group()
    keep.add_argument("--write", metavar="FILE", help="record all datagrams in a new file (they stay encrypted)")
    keep.add_argument("--read", metavar="FILE", help="show a recording instead of listening")
    secrets = parser.add_argument_group("passwords for private channels")
    secrets.add_argument("--passwords", metavar="FILE", help="a file with a line 'team: password' for each team")
    add_password(secrets)
    show = parser.add_argument_group("selection")
    show.add_argument("--team", metavar="NAME", help="only this team's robots, and beacons that list one")
    show.add_argument("--message", choices=MESSAGES, metavar="TYPE", help="only: " + ", ".join(MESSAGES))
    show.add_argument("--errors-only", action="store_true", help="only datagrams that are not messages")
    show.add_argument("--changes-only", action="store_true", help="omit repetitions that differ only in their times")
    show.add_argument("--json", action="store_true", help="one JSON object per line")
    return parser.parse_args(arguments)


# Some notices depend on the network's content, which can be forged.
_MAX_NOTICES = 100


class _Screen:
    """Shows and counts datagrams on standard output; notices go to standard error."""

    def __init__(self, options: argparse.Namespace) -> None:
        self._filter = DatagramFilter(options.team, options.message, options.errors_only, options.changes_only)
        color = sys.stdout.isatty() and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb"
        self._line: Callable[[HeardDatagram], str] = json_line if options.json else TextLines(color).line
        self._counts: Counter = Counter()
        self._noticed: Set[str] = set()

    def show(self, entry: HeardDatagram) -> None:
        """Show a datagram if it passes the filter."""
        self._counts[entry.kind] += 1
        if self._filter.passes(entry):
            print(self._line(entry), flush=True)

    def notice(self, text: str) -> None:
        """Print a notice, once for each text."""
        if text not in self._noticed and len(self._noticed) < _MAX_NOTICES:
            self._noticed.add(text)
            print(f"{PROGRAM}: {escaped(text)}", file=sys.stderr, flush=True)

    def summary(self) -> str:
        """The counts."""
        count = self._counts
        return (f"{sum(count.values())} datagrams: {count[DatagramKind.MESSAGE]} messages, "
                f"{count[DatagramKind.ENCRYPTED]} encrypted "
                f"without a known password, {count[DatagramKind.ERROR]} errors")


def _passwords_by_team(path: str) -> Dict[str, str]:
    """Read the box's passwords file; raises ConfigErrors."""
    report = Report()
    passwords = PasswordsFile(path, report).by_team
    report.raise_errors()
    return passwords


def _decoder(options: argparse.Namespace, rsbb_port: int) -> Decoder:
    """Make the decoder with the given passwords. Raises ValueError or ConfigErrors, which name the remedy."""
    passwords = _passwords_by_team(options.passwords) if options.passwords is not None else {}
    password = own_password(options.password, options.password_file)
    if password is not None and options.team is not None:
        passwords[options.team], password = password, None
    return Decoder(rsbb_port, passwords, password)


def _listener(options: argparse.Namespace, decoder: Decoder, screen: _Screen) -> DatagramListener:
    """Open the best listener that this user may use. Raises OSError whose text names the remedy."""
    host = sockets.resolve(options.host, "--host")
    if not options.plain:
        try:
            return RawListener(decoder, host, screen.notice)
        except (PermissionError, AttributeError):  # the latter: a system other than Linux
            command = f'sudo env PYTHONPATH="$PYTHONPATH" {shlex.quote(sys.executable)} -m roah_rsbb.capture'
            screen.notice(f"to hear private channels, run as root or with CAP_NET_RAW: {command} …")
    return PlainListener(decoder, host, screen.notice)


def _heard(listener: DatagramListener, duration: Optional[float]) -> Iterator[Datagram]:
    """Yield datagrams as they arrive, for `duration` seconds or forever."""
    end_mono = None if duration is None else time.monotonic() + duration
    while True:
        left = None if end_mono is None else end_mono - time.monotonic()
        if left is not None and left <= 0:
            return
        for endpoint in select.select(listener.sockets, [], [], left)[0]:
            yield from listener.read(endpoint)
        listener.follow()


def _capture(options: argparse.Namespace, screen: _Screen, files: contextlib.ExitStack) -> None:
    decoder = _decoder(options, options.port)
    listener = _listener(options, decoder, screen)
    files.callback(listener.close)
    keep: Optional[TextIO] = None
    if options.write is not None:
        keep = files.enter_context(_open(options.write, "x"))
        print(decoding.header_line(options.port), file=keep, flush=True)
    screen.notice(listener.what)
    for datagram in _heard(listener, options.duration):
        if keep is not None:
            print(decoding.datagram_line(datagram), file=keep, flush=True)
        screen.show(decoder.decode(datagram))


def _open(path: str, mode: str) -> TextIO:
    try:
        return open(path, mode, encoding="utf-8", errors="replace")
    except FileExistsError:
        raise OSError(f"{path} already exists: choose another name for --write, or move the file") from None
    except OSError as error:
        raise OSError(f"cannot open {path}: {error.strerror}") from None


def _replay(options: argparse.Namespace, screen: _Screen, files: contextlib.ExitStack) -> None:
    file = files.enter_context(_open(options.read, "r"))
    rsbb_port, datagrams = decoding.read(file, options.read)
    decoder = _decoder(options, rsbb_port)
    for datagram in datagrams:
        screen.show(decoder.decode(datagram))


def _interrupt(*_: object) -> None:
    raise KeyboardInterrupt


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    warn_if_replaced()
    options = parse_options(arguments)
    signal.signal(signal.SIGTERM, _interrupt)
    screen = _Screen(options)
    with contextlib.ExitStack() as files:
        try:
            (_capture if options.read is None else _replay)(options, screen, files)
        except KeyboardInterrupt:
            pass
        except BrokenPipeError:  # the reader has closed the pipe
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return
        except (OSError, ValueError, ConfigErrors, decoding.BadRecording) as error:
            sys.exit(f"{PROGRAM}: {error}")
    print(f"{PROGRAM}: {screen.summary()}", file=sys.stderr)
