"""Reasons: sentences of the box as values, which a face shows in its own language; the refusal of a referee's command,
which has them; and what comes with a command: the run that it names, a note, a name.

`say` registers a template where it is used, once. Called with its values it gives a `Reason`, which is the English
sentence, and knows its template and its values: a face translates the template, and nobody searches a sentence for
them. A template without places is a reason itself.
"""

import typing
from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, NewType, Sequence, Type, TypeVar, Union

# A reason in JSON: the English text if it has no values, else its template and them.
Encoded = Union[str, List[Any]]
R = TypeVar("R", bound="Reason")
# A text that is a reason if it is made of values. Only what writes and reads values distinguishes it from other texts.
if typing.TYPE_CHECKING:
    Said = str
else:
    Said = NewType("Said", str)


class Reason(str):
    """A sentence in English, with the template and the values of which it is made."""

    template: str
    values: Mapping[str, Any]

    def __new__(cls: Type[R], template: str, values: Mapping[str, Any]) -> R:
        """Make a sentence. `values`: numbers, texts, and other reasons; a wrong one leaves the places of the template
        as they are, because no text may prevent a STOP."""
        try:
            text = template.format(**values) if values else template
        except Exception:
            text = template
        made = super().__new__(cls, text)
        made.template, made.values = template, values
        return made

    def __reduce__(self) -> Any:
        """A copy has the template and the values, too."""
        return Reason, (self.template, dict(self.values))


class Template(Reason):
    """A sentence with places for values; without places, it is a reason itself."""

    def __new__(cls, template: str) -> "Template":
        """Return the template of that text."""
        return super().__new__(cls, template, {})

    def __reduce__(self) -> Any:
        """A copy is the same template."""
        return Template, (str(self),)

    def __call__(self, **values: Any) -> Reason:
        """Return the sentence with these values in its places."""
        return Reason(self.template, values)


def say(template: str) -> Template:
    """Register a sentence for the translators (`tools/update_languages` finds it here), and return it."""
    return Template(template)


def reason_of(text: str) -> Reason:
    """Return a text as a reason. A text that is none, such as one of a robot, is the same in every language."""
    return text if isinstance(text, Reason) else Reason("{text}", {"text": text})


def joined(reasons: Sequence[str], between: str = "; ") -> str:
    """Return several reasons as one."""
    if len(reasons) == 1:
        return reasons[0]
    return Reason(between.join(f"{{r{number}}}" for number in range(len(reasons))),
                  {f"r{number}": reason for number, reason in enumerate(reasons)})


def encode(text: str) -> Encoded:
    """Return a reason for JSON."""
    if not isinstance(text, Reason) or not text.values:
        return str(text)
    return [text.template, {name: _encoded(value) for name, value in text.values.items()}]


def _encoded(value: Any) -> Any:
    if isinstance(value, Reason):
        return encode(value) if value.values else [value.template, {}]
    return value if isinstance(value, (bool, int, float, str)) or value is None else str(value)


def encoded(texts: Iterable[str]) -> List[Encoded]:
    """Return reasons for JSON."""
    return [encode(text) for text in texts]


def decode(found: Any) -> Reason:
    """Return the reason in JSON. Something else that a newer program may send becomes a text."""
    if isinstance(found, str):
        return Template(found)
    if _is_reason(found):
        values: Dict[str, Any] = {name: decode(value) if _is_reason(value) else value
                                  for name, value in found[1].items()}
        return Reason(found[0], values)
    return reason_of(str(found))


def _is_reason(found: Any) -> bool:
    return isinstance(found, list) and len(found) == 2 and isinstance(found[0], str) and isinstance(found[1], dict)


def decoded(found: Iterable[Any]) -> List[Reason]:
    """Return the reasons in JSON."""
    return [decode(one) for one in found]


# Characters of a note or a reason, and of a name.
MAX_NOTE = 500
MAX_WHO = 120


class Refused(Exception):
    """A referee's command was refused and changed nothing. `reasons` has every reason, each with its remedy."""

    def __init__(self, reasons: List[str]) -> None:
        super().__init__("; ".join(reasons))
        self.reasons = reasons


class RunName(NamedTuple):
    """Names a run of a zone by its identity, so that a mark for one run never goes into the next."""

    zone: str
    identity: str = ""  # empty: the run that is connected in the zone


def note_line(text: str) -> str:
    """Return a typed text as one line that can be shown anywhere."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def checked_note(text: str) -> str:
    """Return a note or reason as one line; raises `Refused` if it is too long."""
    note = note_line(text)
    if len(note) > MAX_NOTE:
        raise Refused([say("the note has {number} characters: at most {most} are kept, shorten it")(
            number=len(note), most=MAX_NOTE)])
    return note


def cut_note(text: str) -> str:
    """Return a note or reason as one line, cut to the maximum length."""
    return note_line(text[:4 * MAX_NOTE])[:MAX_NOTE]


def checked_who(who: str) -> str:
    """Return a name as one line, cut to the maximum length."""
    return note_line(who[:4 * MAX_WHO])[:MAX_WHO]
