"""Datagrams as they were heard, and the file that keeps them (`--write`, `--read`).

The file is text in UTF-8, one JSON object a line. The first line says what it is:

    {"roah_rsbb_capture": 1, "rsbb_port": 6666}

with the version of the format and the public port. Every further line is a datagram in the order in
which they were heard:

    {"time": 1700000000.123456, "src": "10.0.0.2", "sport": 6667, "dst": "10.0.0.1", "dport": 6667, "hex": "0202…"}

`time` is UTC, seconds since 1970, by the clock of who listened; `hex` is the whole UDP payload. What was
encrypted stays encrypted: a recording holds no password, and whoever reads it needs the teams' passwords.
"""

import ipaddress
import json
from typing import Any, Iterator, NamedTuple, Tuple

FORMAT = "roah_rsbb_capture"
VERSION = 1

LAST_SECOND = 2**32 - 1
"""Beyond it a clock says nothing that a time of day could show."""

_MAX_PORT = 65535


class Datagram(NamedTuple):
    """One UDP datagram that was heard."""

    time: float  # UTC seconds since 1970
    src: str  # IPv4 address
    sport: int
    dst: str  # IPv4 address; a broadcast address, where it is one
    dport: int
    data: bytes


class BadRecording(Exception):
    """A file that is no recording, or is damaged; str() says where, what was found and what was expected."""


def header_line(rsbb_port: int) -> str:
    """The first line of a recording."""
    return json.dumps({FORMAT: VERSION, "rsbb_port": rsbb_port})


def datagram_line(datagram: Datagram) -> str:
    """The line that keeps a datagram."""
    record = datagram._replace(time=round(datagram.time, 6))._asdict()
    record["hex"] = record.pop("data").hex()
    return json.dumps(record)


def read(lines: Iterator[str], name: str) -> Tuple[int, Iterator[Datagram]]:
    """The public port of a recording, and its datagrams one by one. `name`: the file's, for errors.

    Raises BadRecording, at once for what is no recording, and when its turn comes for a damaged line.
    """
    first = _parse(next(lines, ""))
    if FORMAT not in first:
        raise BadRecording(f"{name}:1: this is no recording of capture_comm: its first line is not {header_line(6666)}")
    if first[FORMAT] != VERSION:
        raise BadRecording(f"{name}:1: a recording of format {first[FORMAT]!r}; only {VERSION} can be read here")
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
            raise BadRecording(f"{name}:{number}: found no datagram; expected a line like {expected}{cut}") from None


def _datagram(record: Any) -> Datagram:
    """Raises KeyError, TypeError, ValueError or OverflowError."""
    time, ports = float(record["time"]), (record["sport"], record["dport"])
    if not 0 <= time <= LAST_SECOND or not all(map(_is_port, ports)):
        raise ValueError("out of range")
    src, dst = (str(ipaddress.IPv4Address(record[key])) for key in ("src", "dst"))
    return Datagram(time, src, ports[0], dst, ports[1], bytes.fromhex(record["hex"]))


def _parse(line: str) -> Any:
    """The JSON object of a line; an empty one where there is none."""
    try:
        parsed = json.loads(line)
    except (ValueError, RecursionError):
        return {}
    return parsed if isinstance(parsed, dict) else {}


def _is_port(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= _MAX_PORT
