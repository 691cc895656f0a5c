"""Run logs as MCAP files with types of ROS 2, which Foxglove and `ros2 bag` open (docs/results.md, "MCAP")."""

import contextlib
import io
import os
import struct
from typing import Any, BinaryIO, Dict, List, NamedTuple, Tuple

from roah_rsbb.ground.durable import USUAL, write_file
from roah_rsbb.model.run_log import KINDS, LogKind
from roah_rsbb.results.runs import RobotPart, RunResult, file_name


class NoMcap(Exception):
    """No file can be written. The text names the remedy."""


class _Type(NamedTuple):
    name: str
    definition: str  # as in the type's .msg file


# `Empty` has no fields. Score is in ros2/roah_rsbb_msgs.
_TYPES: Dict[LogKind, _Type] = {
    LogKind.UINT8: _Type("std_msgs/msg/UInt8", "uint8 data"),
    LogKind.STRING: _Type("std_msgs/msg/String", "string data"),
    LogKind.SCORE: _Type("roah_rsbb_msgs/msg/Score", "string group\nstring desc\nint32 value"),
    LogKind.EMPTY: _Type("std_msgs/msg/Empty", ""),
}
# What the library raises for a value that does not fit into its message.
_UNFIT = (TypeError, ValueError, struct.error)


def write_mcap(result: RunResult, folder: str) -> List[str]:
    """Write the log of each robot of a run into an existing folder. Old files are replaced when the new ones are
    complete. Returns the new files' paths. Raises `NoMcap`, OSError."""
    name = file_name(result.number, result.record)
    several = len(result.robots) > 1
    paths: List[str] = []
    for robot in result.robots:
        path = os.path.join(folder, f"{name}_port{robot.port}.mcap" if several else f"{name}.mcap")
        content = io.BytesIO()
        _write(result, robot, content)
        write_file(path, content.getvalue(), USUAL)
        paths.append(path)
    return paths


def _write(result: RunResult, robot: RobotPart, file: BinaryIO) -> None:
    writer_of, compression = library()
    writer = writer_of(file, compression=compression)
    schemas = {kind: writer.register_msgdef(of.name, of.definition) for kind, of in _TYPES.items()}
    entries = (entry for entry in result.entries if entry.port == robot.port and entry.kind in KINDS)
    for number, entry in enumerate(entries):
        kind = KINDS[entry.kind]
        with contextlib.suppress(*_UNFIT):  # such an entry is in no bag either
            writer.write_message(
                entry.kind, schemas[kind], _message(kind, entry.value), int(entry.utc * 1e9), sequence=number)
    writer.finish()


def _message(kind: LogKind, value: Any) -> Dict[str, Any]:
    if kind is LogKind.EMPTY:
        return {}
    if kind is LogKind.SCORE:
        group, desc, points = value
        return {"group": group, "desc": desc, "value": points}
    return {"data": value}


def library() -> Tuple[Any, Any]:
    """Return the class of the library that writes such files, and its compression. Raises `NoMcap`."""
    try:
        from mcap.writer import CompressionType
        from mcap_ros2.writer import Writer
    except ImportError as error:
        raise NoMcap(
            f"MCAP files need a Python package that is not here ({error}): install it with 'pip install "
            "mcap-ros2-support', or use another computer with it and a copy of the journal"
        ) from None
    return Writer, CompressionType.ZSTD
