"""Files of the gateway: only their user may read them, and each is complete or unchanged after a power cut."""

import json
import os
from typing import Any, Callable, TypeVar

from roah_rsbb import durable

T = TypeVar("T")
Save = Callable[[Any], None]


def open_kept(
    folder: str, name: str, make: Callable[[Save, Any], T], nothing: Any, report: Callable[[str], None], remedy: str,
) -> T:
    """Return `make(save, content)` for the content of a file, or for `nothing` if there is no file. `save` writes it.

    A damaged file is moved aside, and `report` is called. `remedy`: what to do in that case.
    """
    path = os.path.join(folder, name)

    def save(content: Any) -> None:
        os.makedirs(folder, exist_ok=True)
        durable.write_file(path, json.dumps(content, indent=1, ensure_ascii=False).encode("utf-8"))

    try:
        with open(path, encoding="utf-8") as file:
            return make(save, json.load(file))
    except FileNotFoundError:
        return make(save, nothing)
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        report(f"cannot read {path} ({error}): {remedy}")
        try:
            os.replace(path, f"{path}.damaged")
        except OSError as failed:
            report(f"cannot move {path} aside ({failed})")
        return make(save, nothing)
