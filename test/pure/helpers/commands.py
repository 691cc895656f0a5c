"""The referee's commands in a zone, and what a face gives with them."""

from roah_rsbb.model import actions
from roah_rsbb.model.actions import ACTIONS, Row

# Those that need no choice of an event, and no benchmarking module.
COMMANDS = tuple(name for name, action in ACTIONS.items() if name != "choose_event" and action.row is not Row.MODULE)


def given_with(command, team=""):
    """What a face gives with a command of the referee who sees the event of a team."""
    names = {field.name for field in ACTIONS[command].fields}
    return {**({"team": team} if team and "team" in names else {}), **({"running": True} if "running" in names else {})}


def mark_with(mark):
    """What a face gives with a mark."""
    return {"value": mark.value, **{name: value for name, value in mark._asdict().items() if value}}


def actions_shown(off=None, hidden=(), fields=None, asked=None, questions=None):
    """The actions of a zone. `off`: by name, the reasons why each is off. `asked`: what a benchmarking module asks for,
    see `forms.shown_form`. `questions`: by name."""
    known = {name: actions.Shown(
        tuple((off or {}).get(name, ())), name not in hidden and action.row is not Row.MODULE, (fields or {}).get(name),
        question=(questions or {}).get(name, ""),
    ) for name, action in ACTIONS.items()}
    return {**known, **({"operation": asked} if asked else {})}
