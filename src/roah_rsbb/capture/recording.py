"""The file format of recorded datagrams (`--write`, `--read`).

The file is UTF-8 text with one JSON object per line. The first line identifies it:

    {"roah_rsbb_capture": 1, "rsbb_port": 6666}

with the version of the format and the public port. Each further line is a datagram, in the order of arrival:

    {"time": 1700000000.123456, "src": "10.0.0.2", "sport": 6667, "dst": "10.0.0.1", "dport": 6667, "hex": "0202…"}

`time` is UTC in seconds since 1970, by the listener's clock; `hex` is the complete UDP payload. Encrypted datagrams
stay encrypted: a recording contains no passwords, and reading it requires the teams' passwords.
"""

import ipaddress
import json
from typing import Any, Iterator, NamedTuple, Tuple

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
