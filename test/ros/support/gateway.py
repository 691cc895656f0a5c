"""The web pages of the tests' boxes, and which core serves them."""

import json
import urllib.request
from typing import Any, Dict, List

from roah_rsbb.wording.device import NO_WEB
from support.box_client import BoxClient, Refusal
from support.door_client import NoAnswer
from support.robots import RSBB_PORT
from support.waiting import wait_until

URL = f"http://127.0.0.1:{RSBB_PORT + 95}"
CORE = "/roah_rsbb_core"


def answer(name: str) -> Dict[str, Any]:
    """A document of data."""
    with urllib.request.urlopen(f"{URL}/api/v1/{name}", timeout=30) as opened:
        return json.load(opened)


def ask(box: BoxClient, name: str, **arguments: object) -> Any:
    """Make a call of the gateway, as soon as a box answers, and return its answer; raises `Refusal`."""
    def answered() -> List[Any]:
        try:
            return [box.ask(name, **arguments)]
        except NoAnswer:  # the core was just killed
            return []
        except Refusal as refused:
            if NO_WEB not in str(refused):
                raise
            return []

    return wait_until(answered, "a gateway answers")[0]


def session() -> str:
    """Which gateway it is, by its random name; empty: none that answers and hears the core."""
    try:
        state = answer("state")
    except OSError:
        return ""
    return state["session"] if state["heard"] else ""


def wait_served() -> str:
    """Wait until a gateway answers and hears the core; returns its random name."""
    return wait_until(session, "the gateway hears the core")
