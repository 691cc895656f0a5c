"""What an organiser's page needs to edit the day: the forms of the edits, what can be chosen in them, and the edits so
far."""

from typing import Any, Dict, List

from roah_rsbb.model.actions import EDITS, UNDO
from roah_rsbb.model.document import Document
from roah_rsbb.model.reason import decoded
from roah_rsbb.web.public_documents import Data
from roah_rsbb.wording import schedule, sheets
from roah_rsbb.wording.device import action_words
from roah_rsbb.wording.language import tr, tr_said
from roah_rsbb.wording.times import Moments


def forms_page(document: Document, edits: List[Dict[str, Any]]) -> Data:
    """Return forms, choices and edits, the newest first."""
    events = document.events()
    several_days = len({schedule.day_of(event) for event in events}) > 1
    moments = Moments(False)
    names = {
        "zone": [event.zone for event in events], "team": [event.team for event in events],
        "benchmark": [event.code for event in events], "day": [schedule.day_of(event) for event in events]}
    return {
        "forms": [{"name": name, **action_words(action)} for name, action in EDITS.items() if name != UNDO],
        "undo": tr(EDITS[UNDO].label),
        "choices": {
            **{of: [[name, name] for name in sorted(set(found))] for of, found in names.items()},
            "event": [[event.id, " · ".join((
                schedule.moment_text(event.scheduled_utc_s, several_days), event.zone, f"{event.code} {event.team}",
                schedule.state_text(event)))] for event in events]},
        "edits": [{
            "number": edit["number"], "undone": bool(edit["undone"]), "can_undo": edit["can_undo"],
            "words": said(edit["words"]),
            "what": tr(EDITS[edit["action"]].label) if edit["action"] in EDITS else edit["action"],
            "about": " · ".join(filter(None, (moments.short(edit["utc"]), sheets.person(edit["who"]), edit["reason"]))),
        } for edit in edits]}


def effect_page(answer: Dict[str, Any]) -> Data:
    """Return what an edit would do, or did."""
    trouble = [answer["trouble"]] if answer["trouble"] else []
    return {"effects": said(answer["effects"]), "warnings": said(answer["warnings"]), "seen": answer["seen"],
            "done": answer["done"], "trouble": said(trouble)}


def said(found: List[Any]) -> List[str]:
    """Return reasons of JSON in the language of the reader."""
    return [tr_said(reason) for reason in decoded(found)]
