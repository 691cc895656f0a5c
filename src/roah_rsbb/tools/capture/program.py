"""The program: `python -m roah_rsbb.tools.capture`, `rosrun roah_rsbb capture_comm`, `roah_rsbb_capture`."""

import argparse
import contextlib
import os
import select
import shlex
import signal
import sys
import time
from collections import Counter
from typing import Callable, Iterator, List, Optional, Set, TextIO, Union

from roah_rsbb.comm import sockets
from roah_rsbb.comm.passwords import BadPasswords, own_password, read_passwords
from roah_rsbb.tools.capture import options as arguments_of
from roah_rsbb.tools.capture import records
from roah_rsbb.tools.capture.decoding import Decoder, Entry, Kind
from roah_rsbb.tools.capture.filters import Filter
from roah_rsbb.tools.capture.lines import TextLines, json_line
from roah_rsbb.tools.capture.listening import PlainListener, RawListener
from roah_rsbb.tools.capture.options import PROGRAM
from roah_rsbb.tools.capture.records import Datagram

# Some tell what the network brought, which can be forged without end.
_MAX_NOTICES = 100

Listener = Union[RawListener, PlainListener]


class _Screen:
    """Shows entries on standard output, and counts them; what is said beside goes to standard error."""

    def __init__(self, options: argparse.Namespace) -> None:
        self._filter = Filter(options.team, options.message, options.errors_only, options.changes_only)
        color = sys.stdout.isatty() and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb"
        self._line: Callable[[Entry], str] = json_line if options.json else TextLines(color).line
        self._counts: Counter = Counter()
        self._told: Set[str] = set()

    def show(self, entry: Entry) -> None:
        """Show an entry, if the filter passes it."""
        self._counts[entry.kind] += 1
        if self._filter.passes(entry):
            print(self._line(entry), flush=True)

    def notice(self, text: str) -> None:
        """Say something once, however often it happens."""
        if text not in self._told and len(self._told) < _MAX_NOTICES:
            self._told.add(text)
            print(f"{PROGRAM}: {text}", file=sys.stderr, flush=True)

    def summary(self) -> str:
        """How much there was."""
        count = self._counts
        return (f"{sum(count.values())} datagrams: {count[Kind.MESSAGE]} messages, {count[Kind.ENCRYPTED]} encrypted "
                f"without a known password, {count[Kind.ERROR]} errors")


def _decoder(options: argparse.Namespace, rsbb_port: int) -> Decoder:
    """ValueError or BadPasswords, which name the remedy."""
    passwords = read_passwords(options.passwords) if options.passwords is not None else {}
    password = own_password(options.password, options.password_file)
    if password is not None and options.team is not None:
        passwords[options.team], password = password, None
    return Decoder(rsbb_port, passwords, password)


def _listener(options: argparse.Namespace, decoder: Decoder, screen: _Screen) -> Listener:
    """OSError whose text names the remedy."""
    host = sockets.resolve(options.host, "--host")
    if not options.plain:
        try:
            return RawListener(decoder, host, screen.notice)
        except (PermissionError, AttributeError):  # the latter: a system other than Linux
            command = f'sudo env PYTHONPATH="$PYTHONPATH" {shlex.quote(sys.executable)} -m roah_rsbb.tools.capture'
            screen.notice(f"unicast of private channels needs root's rights (CAP_NET_RAW): {command} …")
    return PlainListener(decoder, host, screen.notice)


def _heard(listener: Listener, duration: Optional[float]) -> Iterator[Datagram]:
    """Datagrams as they come, for `duration` seconds or without end."""
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
        print(records.header_line(options.port), file=keep, flush=True)
    screen.notice(listener.what)
    for datagram in _heard(listener, options.duration):
        if keep is not None:
            print(records.datagram_line(datagram), file=keep, flush=True)
        screen.show(decoder.decode(datagram))


def _open(path: str, mode: str) -> TextIO:
    try:
        return open(path, mode, encoding="utf-8", errors="replace")
    except FileExistsError:
        raise OSError(f"{path} exists already: give --write another name, or move that file away") from None
    except OSError as error:
        raise OSError(f"cannot open {path}: {error.strerror}") from None


def _replay(options: argparse.Namespace, screen: _Screen, files: contextlib.ExitStack) -> None:
    file = files.enter_context(_open(options.read, "r"))
    rsbb_port, datagrams = records.read(file, options.read)
    decoder = _decoder(options, rsbb_port)
    for datagram in datagrams:
        screen.show(decoder.decode(datagram))


def _interrupt(*_: object) -> None:
    raise KeyboardInterrupt


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    options = arguments_of.parse(arguments)
    signal.signal(signal.SIGTERM, _interrupt)
    screen = _Screen(options)
    with contextlib.ExitStack() as files:
        try:
            (_capture if options.read is None else _replay)(options, screen, files)
        except KeyboardInterrupt:
            pass
        except BrokenPipeError:  # whoever read our lines has gone
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return
        except (OSError, ValueError, BadPasswords, records.BadRecording) as error:
            sys.exit(f"{PROGRAM}: {error}")
    print(f"{PROGRAM}: {screen.summary()}", file=sys.stderr)
