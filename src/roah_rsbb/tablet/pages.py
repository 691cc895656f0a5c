"""The messages between pages in browsers and the tablet, as JSON. No I/O.

A page sends `{"do": "here"}` every two seconds, `{"do": "call"}`, or `{"do": "place", "u": 0.25, "v": 0.5}` (a point of
the map's image, see `maps`). It receives the complete state every second and after every change.
"""

import json
from typing import Any, Dict, Optional

from roah_rsbb.tablet.maps import Map
from roah_rsbb.tablet.state import ShownTablet

HERE, CALL, PLACE = "here", "call", "place"

# The box acknowledges a touch within milliseconds; after this time pages show that it did not.
UNANSWERED_S = 3.0
# Taps on the call button that follow each other within this time are one call.
SAME_CALL_S = 2.0


class Refusal(Exception):
    """The request of a page is refused. The text is for its user."""


class Pages:
    """The pages of one tablet."""

    def __init__(self, state: ShownTablet, plan: Optional[Map]) -> None:
        """`plan`: the map; None if there is none."""
        self._state = state
        self._map = plan
        self._touched_mono = float("-inf")
        self._tapped_mono = float("-inf")

    def do(self, now_mono: float, time_ns: int, text: object) -> bool:
        """Carry out the request of a page; returns whether something was touched. Raises `Refusal`."""
        asked = _parse(text)
        what = asked.get("do")
        if what == HERE:
            return False
        if what not in (CALL, PLACE):
            raise Refusal("Reload this page: its version differs")
        if not self._state.hears_box(now_mono):
            raise Refusal("The box is silent: nothing was sent")
        if what == CALL:
            is_same = now_mono - self._tapped_mono < SAME_CALL_S
            self._tapped_mono = now_mono
            if is_same:
                return False
            self._state.call(time_ns)
        else:
            self._place(time_ns, asked)
        self._touched_mono = now_mono
        return True

    def _place(self, time_ns: int, asked: Dict[str, Any]) -> None:
        u, v = asked.get("u"), asked.get("v")
        if self._map is None:
            raise Refusal("The map is missing")
        if not (_is_fraction(u) and _is_fraction(v)):
            raise Refusal("This position is not on the map")
        if self._map.is_wall(u, v):
            raise Refusal("This position is on a wall: touch a free place")
        self._state.place(time_ns, *self._map.to_metres(u, v))

    def text(self, now_mono: float) -> str:
        """The state that every page shows."""
        state = self._state
        return json.dumps({
            "box": state.hears_box(now_mono),
            "view": "map" if state.display_map else "call",
            "call": {"time": _milliseconds(state.call_time), "acknowledged": state.call_is_acknowledged},
            "place": {
                "time": _milliseconds(state.position_time), "acknowledged": state.position_is_acknowledged,
                **self._shown(),
            },
            "unanswered": now_mono - self._touched_mono > UNANSWERED_S,
            "map": self._plan(),
        })

    def _shown(self) -> Dict[str, float]:
        u, v = (0.0, 0.0) if self._map is None else self._map.to_image(self._state.x, self._state.y)
        return {"x": self._state.x, "y": self._state.y, "u": u, "v": v}

    def _plan(self) -> Optional[Dict[str, object]]:
        plan = self._map
        if plan is None:
            return None
        return {
            "image": f"map.png?{plan.version}", "width": plan.width, "height": plan.height, "negate": plan.negate
        }


def refusal_text(refusal: Refusal) -> str:
    """The answer to a refused request."""
    return json.dumps({"refused": str(refusal)})


def _parse(text: object) -> Dict[str, Any]:
    try:
        asked = json.loads(text) if isinstance(text, str) else None
    except (ValueError, RecursionError):
        asked = None
    return asked if isinstance(asked, dict) else {}


def _is_fraction(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and 0.0 <= value <= 1.0


def _milliseconds(time) -> int:
    """A time for a browser's Date; 0 means never."""
    return time[0] * 1000 + time[1] // 1_000_000
