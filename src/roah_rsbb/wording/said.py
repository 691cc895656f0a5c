"""Sentences of the box in the language of the reader."""

from roah_rsbb.model.reason import Reason
from roah_rsbb.wording import language
from roah_rsbb.wording.language import tr


def tr_said(text: str) -> str:
    """Return a sentence of the box in the language of this process. It never raises."""
    return text if language.is_english() else tr_reason(text)


def tr_reason(text: str) -> str:
    """Return a reason in the language of this process; a text that is none is translated as it is."""
    if not isinstance(text, Reason):
        return tr(text)
    return tr(text.template, **{
        name: tr_reason(value) if isinstance(value, Reason) else value for name, value in text.values.items()})
