"""The recorded data in test/data: see its README."""

import json
from pathlib import Path
from typing import Any, Dict, List

DATA = Path(__file__).resolve().parents[2] / "data"
PASSWORD = "PASSWORD"
SESSIONS = sorted(path.stem for path in DATA.glob("*_20??.json"))


def load(name: str) -> List[Dict[str, Any]]:
    """The records of one file, named without its extension."""
    return json.loads((DATA / (name + ".json")).read_text(encoding="utf-8"))


def frame(name: str) -> Dict[str, Any]:
    """The record of that name in frames.json, its bytes under `frame`."""
    record = next(record for record in load("frames") if record["name"] == name)
    return dict(record, frame=bytes.fromhex(record["frame_hex"]))
