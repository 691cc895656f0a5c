"""Goals, results and scores as texts. Run logs store them, and modules get results in one form."""

import json
from typing import NamedTuple, Tuple

from roah_rsbb.model.messages import RobotReport
from roah_rsbb.model.modules import Request
from roah_rsbb.model.records import ScoreValue

# Characters of a result. It is kept with every step and repeated to the modules. Modules refuse longer results
# (`roah_rsbb.bmbox.framework.results`), so a result that is cut here is refused there.
MAX_RESULT = 4000


class _ObjectField(NamedTuple):
    name: str  # in a RobotReport of 2015
    key: str  # in the YAML of 2019


_OBJECT_FIELDS = (
    _ObjectField("object_class", "class"), _ObjectField("object_name", "instance"),
    _ObjectField("object_pose_x", "x"), _ObjectField("object_pose_y", "y"), _ObjectField("object_pose_theta", "theta"),
)


def result_text(report: RobotReport) -> str:
    """Return a robot's result as YAML, whichever form it came in (docs/protocol.md, "Goals and results").

    It is cut at `MAX_RESULT`. Empty: the report has no result.
    """
    if report.generic_result is not None:
        return report.generic_result[:MAX_RESULT]
    given = {f.key: getattr(report, f.name) for f in _OBJECT_FIELDS if getattr(report, f.name) is not None}
    return json.dumps(given, ensure_ascii=False)[:MAX_RESULT] if given else ""


def goal_json(request: Request) -> str:
    """A goal for the run log."""
    return json.dumps({
        "number": request.number, "text": request.text, "goal": request.goal, "pose": request.pose,
        "initial_state": request.initial_state, "switches": request.switches, "timeout": request.timeout,
    }, ensure_ascii=False)


def scores_json(scores: Tuple[ScoreValue, ...]) -> str:
    """A module's score for the run log; values keep their types."""
    return json.dumps([
        {"group": s.group, "name": s.name, "value": _value(s.value), "unit": s.unit, "desc": s.desc} for s in scores
    ], ensure_ascii=False)


def _value(text: str) -> object:
    try:
        return json.loads(text)
    except ValueError:
        return text
