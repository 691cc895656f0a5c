"""The fields of an action: what a person gives with it, and how a face may enter it.

A field reads a value of JSON (`read`) and a typed word (`parse`). Both raise `BadValue` with a text that names the
remedy.
"""

from dataclasses import dataclass
from typing import Any, ClassVar, Dict, Mapping, Sequence, Tuple, Type

from roah_rsbb.model.reason import Reason, Template, say

# Characters of a text, unless its field says otherwise.
MAX_TEXT = 500

NO_TEXT = say("{field}: a text is expected")
TOO_LONG = say("{field}: the text has {number} characters, at most {most} are allowed: shorten it")
NO_NUMBER = say("{field}: a whole number from {low} to {high} is expected")
NO_CHOICE = say("{field}: choose one of {choices}")
NO_TOGGLE = say("{field}: yes or no is expected")
MISSING = say("{field} is missing")
UNKNOWN = say("The command has no field '{field}': it has {fields}")
NO_FIELDS = say("The command has no field '{field}': it has none")


class BadValue(ValueError):
    """A value does not fit its field."""

    def __init__(self, reason: Reason) -> None:
        super().__init__(str(reason))
        self.reason = reason


@dataclass(frozen=True)
class Field:
    """A text that names something, such as a robot. `name`: in calls, JSON and the journal; `label`: for the eye."""

    name: str
    label: Template
    required: bool = True

    kind: ClassVar[str] = "name"
    nothing: ClassVar[Any] = ""  # the value of a field that was left out

    def read(self, value: Any) -> Any:
        """Return a value from JSON."""
        if not isinstance(value, str) or not _is_encodable(value):
            raise BadValue(NO_TEXT(field=self.label))
        if len(value) > self.most:
            raise BadValue(TOO_LONG(field=self.label, number=len(value), most=self.most))
        return value

    def parse(self, word: str) -> Any:
        """Return the value of a typed word."""
        return self.read(word)

    @property
    def most(self) -> int:
        """How many characters it may have."""
        return MAX_TEXT

    def form(self) -> Dict[str, Any]:
        """Return it for JSON, see `field_of`."""
        return {"kind": self.kind, "name": self.name, "label": str(self.label), "required": self.required}


@dataclass(frozen=True)
class Text(Field):
    """A text that a person types. `cut`: a longer one is cut, because it must not prevent the action."""

    kind: ClassVar[str] = "text"

    characters: int = MAX_TEXT
    cut: bool = False

    def read(self, value: Any) -> Any:
        """See `Field`."""
        return super().read(value[:self.most] if self.cut and isinstance(value, str) else value)

    @property
    def most(self) -> int:
        """How many characters it may have."""
        return self.characters

    def form(self) -> Dict[str, Any]:
        """See `Field`."""
        return {**super().form(), "characters": self.characters, "cut": self.cut}


@dataclass(frozen=True)
class Number(Field):
    """A whole number from `low` to `high`. `unit`: such as s; `default`: of one that was left out."""

    low: int = 0
    high: int = 2**31 - 1
    unit: str = ""
    default: int = 0

    kind: ClassVar[str] = "number"

    @property
    def nothing(self) -> int:
        """See `Field`."""
        return self.default

    def read(self, value: Any) -> Any:
        """See `Field`."""
        if type(value) is not int or not self.low <= value <= self.high:  # true is no number
            raise BadValue(NO_NUMBER(field=self.label, low=self.low, high=self.high))
        return value

    def parse(self, word: str) -> Any:
        """See `Field`."""
        try:
            return self.read(int(word))
        except ValueError:
            raise BadValue(NO_NUMBER(field=self.label, low=self.low, high=self.high)) from None

    def form(self) -> Dict[str, Any]:
        """See `Field`."""
        return {**super().form(), "low": self.low, "high": self.high, "unit": self.unit, "default": self.default}


@dataclass(frozen=True)
class Choice(Field):
    """One of several texts."""

    choices: Tuple[str, ...] = ()

    kind: ClassVar[str] = "choice"

    def read(self, value: Any) -> Any:
        """See `Field`."""
        if value not in self.choices:
            raise BadValue(NO_CHOICE(field=self.label, choices=", ".join(self.choices)))
        return value

    def form(self) -> Dict[str, Any]:
        """See `Field`."""
        return {**super().form(), "choices": list(self.choices)}


@dataclass(frozen=True)
class Toggle(Field):
    """Yes or no."""

    kind: ClassVar[str] = "toggle"
    nothing: ClassVar[Any] = False

    def read(self, value: Any) -> Any:
        """See `Field`."""
        if type(value) is not bool:
            raise BadValue(NO_TOGGLE(field=self.label))
        return value

    def parse(self, word: str) -> Any:
        """See `Field`."""
        if word.lower() not in ("yes", "no"):
            raise BadValue(NO_TOGGLE(field=self.label))
        return word.lower() == "yes"


@dataclass(frozen=True)
class Robot(Field):
    """The name of a robot of the event's team. The core says which ones there are (`Choice` in the action's form)."""

    kind: ClassVar[str] = "robot"


@dataclass(frozen=True)
class Team(Field):
    """The team whom it hits. A face gives the one that it shows."""

    kind: ClassVar[str] = "team"


@dataclass(frozen=True)
class Event(Field):
    """The id of an event of the schedule."""

    kind: ClassVar[str] = "event"


_KINDS: Dict[str, Type[Field]] = {kind.kind: kind for kind in (Field, Text, Number, Choice, Toggle, Robot, Team, Event)}


def field_of(form: Mapping[str, Any]) -> Field:
    """Return the field that `Field.form` wrote; one of an unknown kind, of a newer box, is a text. Raises TypeError."""
    values: Dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in form.items()}
    kind = _KINDS.get(values.pop("kind", ""))
    if kind is None:
        return Text(values["name"], Template(values["label"]), values["required"])
    return kind(**{**values, "label": Template(values["label"])})


def read(fields: Sequence[Field], given: Mapping[str, Any]) -> Dict[str, Any]:
    """Return the values of all fields. Those that are not given and not required have their `nothing`. Raises
    `BadValue`."""
    known = {field.name for field in fields}
    for name in given:
        if name not in known:
            raise BadValue(UNKNOWN(field=name[:MAX_TEXT], fields=", ".join(sorted(known))) if known
                           else NO_FIELDS(field=name[:MAX_TEXT]))
    return {field.name: _read(field, given) for field in fields}


def _read(field: Field, given: Mapping[str, Any]) -> Any:
    value = given.get(field.name, field.nothing)
    if value != field.nothing or type(value) is not type(field.nothing):
        return field.read(value)
    if field.required and not (isinstance(field, (Number, Toggle)) and field.name in given):
        raise BadValue(MISSING(field=field.label))
    return field.read(value) if field.required else field.nothing


def _is_encodable(text: str) -> bool:
    """Whether a message can hold a text. JSON can have half of a character."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True
