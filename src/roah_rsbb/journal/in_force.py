"""Keeps the configuration files that are in force, beside the journal.

After a crash, the core continues with what it had read, whatever an editor has since done to the files. Runs that were
connected before a change of the configuration also need the earlier files. Passwords are never copied to this place
(docs/journal.md, "The configuration in force").
"""

import json
import os
from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.ground import durable

FILE_NAME = "configuration.json"
# What the files of a version are, in their order. A box without rules for standings has three.
NAMES = ("benchmarks", "schedule", "passwords", "standings")


class Texts(NamedTuple):
    """The files of a version: their paths, and their contents (None: not kept, or could not be read)."""

    paths: Tuple[str, ...]
    texts: Tuple[Optional[str], ...]


class InForce(NamedTuple):
    """The versions that are still needed."""

    launch: str  # the launch in which the present version was read
    present: int
    versions: Dict[int, Texts]


def read_in_force(log_dir: str) -> Optional[InForce]:
    """Read what the last core left; None: nothing that can be read."""
    try:
        with open(os.path.join(log_dir, FILE_NAME), encoding="utf-8") as file:
            found = json.load(file)
        versions = {int(number): Texts(tuple(map(str, paths)), tuple(None if t is None else str(t) for t in texts))
                    for number, (paths, texts) in found["versions"].items()}
        present = int(found["present"])
        return InForce(str(found["launch"]), present, versions) if present in versions else None
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def kept_files(log_dir: str, version: Optional[int] = None) -> Dict[str, str]:
    """Return the contents of a version (default, and if it is not kept: the present one) by `NAMES`, without passwords.
    Empty: nothing that can be read."""
    kept = read_in_force(log_dir)
    if kept is None:
        return {}
    found = kept.versions.get(kept.present if version is None else version, kept.versions[kept.present])
    return {name: text for name, text in zip(NAMES, found.texts) if text is not None}


def write_in_force(log_dir: str, what: InForce) -> None:
    """Replace the file, and wait until it is on the disk. Raises OSError, and the old file stays."""
    os.makedirs(log_dir, exist_ok=True)
    text = json.dumps({"launch": what.launch, "present": what.present, "versions": what.versions})
    durable.write_file(os.path.join(log_dir, FILE_NAME), text.encode("utf-8"), durable.USUAL)
