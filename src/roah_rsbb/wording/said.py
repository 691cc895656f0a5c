"""Sentences of the box in the language of the reader.

Messages carry the sentences in English, and beside them those that are made of values, as templates and values
(`model.shown.said`). Whoever takes a message calls `learn` with these. A sentence is then translated as what it was
made of.
"""

from typing import Any, Dict

from roah_rsbb.model import shown
from roah_rsbb.model.reason import Reason
from roah_rsbb.wording import language
from roah_rsbb.wording.language import tr

# Of the newest sentences. A box with forty zones has about 400 at a time.
MAX_KNOWN = 4000
_known: Dict[str, Reason] = {}


def learn(said: str) -> None:
    """Take the sentences that came with a message, as JSON. What cannot be read is shown in English."""
    for reason in shown.said_in(said):
        _known.pop(str(reason), None)
        _known[str(reason)] = reason
    while len(_known) > MAX_KNOWN:
        del _known[next(iter(_known))]


def learn_details(details: Any) -> None:
    """Take the sentences that came with a CoreDetails."""
    learn(details.said)
    for zone in details.zones:
        learn(zone.said)


def tr_said(text: str) -> str:
    """Return a sentence of the box in the language of this process. It never raises."""
    if language.is_english():
        return text
    return tr_reason(text if isinstance(text, Reason) else _known.get(text) or text)


def tr_reason(text: str) -> str:
    """Return a reason in the language of this process; a text that is none is translated as it is."""
    if not isinstance(text, Reason):
        return tr(text)
    return tr(text.template, **{
        name: tr_reason(value) if isinstance(value, Reason) else value for name, value in text.values.items()})
