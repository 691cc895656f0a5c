"""The file with the paired devices: only its user may read it, and it is complete or unchanged after a power cut."""

import json
import os
from typing import Any, Callable, Dict, List

from roah_rsbb import durable
from roah_rsbb.web.pairing import Sessions

NAME = "web_sessions.json"


def open_sessions(folder: str, report: Callable[[str], None]) -> Sessions:
    """Return the sessions that are kept in a folder. A damaged file is moved aside, and `report` is called."""
    path = os.path.join(folder, NAME)

    def save(records: List[Dict[str, Any]]) -> None:
        os.makedirs(folder, exist_ok=True)
        durable.write_file(path, json.dumps(records, indent=1, ensure_ascii=False).encode("utf-8"))

    try:
        with open(path, encoding="utf-8") as file:
            return Sessions(save, json.load(file))
    except FileNotFoundError:
        return Sessions(save)
    except (OSError, ValueError, TypeError, KeyError, RecursionError) as error:
        report(f"cannot read the paired devices in {path} ({error}): pair them again")
        try:
            os.replace(path, f"{path}.damaged")
        except OSError as failed:
            report(f"cannot move {path} aside ({failed})")
        return Sessions(save)
