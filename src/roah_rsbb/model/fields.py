"""The fields of an action: what a person gives with it, and how a face may enter it.

A field reads a value of JSON (`read`) and a typed word (`parse`). Both raise `BadValue` with a text that names the
remedy.
"""

import dataclasses
import functools
import json
import math
import re
from dataclasses import dataclass
from typing import Any, ClassVar, Dict, Iterable, Mapping, Match, Optional, Sequence, Tuple, Type

from roah_rsbb.model.reason import Reason, Template, say

# Characters of a text, unless its field says otherwise.
MAX_TEXT = 500
# Metres. No test bed is larger.
FARTHEST_M = 1000.0
# A turn. A larger angle is one in degrees.
MOST_RAD = 2 * math.pi + 0.01

NO_TEXT = say("{field}: a text is expected")
TOO_LONG = say("{field}: the text has {number} characters, at most {most} are allowed: shorten it")
NO_NUMBER = say("{field}: a whole number from {low} to {high} is expected")
NO_DECIMAL = say("{field}: a number from {low} to {high} is expected")
TWO_NUMBERS = say("{field}: '{text}' can mean {whole} or {decimal}. Type {whole}, or {decimal} (with a comma: {comma})")
NO_POSE = say("{field}: x and y in metres, then the direction in degrees, are expected, such as 1.25 0.40 90")
NO_POSE_LIST = say("{field}: [x, y, theta] is expected: metres, and radians from -6.3 to 6.3")
NO_CHOICE = say("{field}: choose one of {choices}")
NO_TOGGLE, NO_BOOL = say("{field}: yes or no is expected"), say("{field}: true or false is expected")
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
        if not isinstance(value, str) or not is_encodable(value):
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
        values = {part.name: getattr(self, part.name) for part in dataclasses.fields(self)}
        return {"kind": self.kind, **values, "label": str(self.label)}


@dataclass(frozen=True)
class TypedText(Field):
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
            return self.read(int(typed_number(word)))
        except ValueError:
            raise BadValue(NO_NUMBER(field=self.label, low=self.low, high=self.high)) from None


@dataclass(frozen=True)
class Fixed(Number):
    """What an answer is about. A face gives back the number that the core says (`default`), and asks nobody."""

    kind: ClassVar[str] = "fixed"


@dataclass(frozen=True)
class Decimal(Field):
    """A number from `low` to `high`, with decimals; also as a text. `unit`: such as m."""

    low: float = 0.0
    high: float = 1e6
    unit: str = ""

    kind: ClassVar[str] = "decimal"
    nothing: ClassVar[Any] = None

    def read(self, value: Any) -> Any:
        """See `Field`."""
        number = _number(value, self.low, self.high) if isinstance(value, str) else value
        if type(number) not in (int, float) or not self.low <= number <= self.high:  # also refuses NaN
            raise BadValue(two_numbers(self.label, str(value), self.low, self.high) or NO_DECIMAL(
                field=self.label, low=f"{self.low:.12g}", high=f"{self.high:.12g}"))
        return float(number)


@dataclass(frozen=True)
class TypedPose(Field):
    """[x, y, theta] of a place: metres, and radians. In a text, which persons type, the direction is in degrees."""

    kind: ClassVar[str] = "pose"
    nothing: ClassVar[Any] = None

    def read(self, value: Any) -> Any:
        """See `Field`."""
        wrong = NO_POSE_LIST
        if isinstance(value, str):
            wrong = NO_POSE
            *metres, degrees = [_number(word, 0.0, 0.0) for word in value.split()] or [None]
            value = [*metres, None if degrees is None else math.radians(degrees)]
        if not isinstance(value, list) or len(value) != 3 or not all(
                type(part) in (int, float) and abs(part) <= FARTHEST_M for part in value) or abs(value[2]) > MOST_RAD:
            raise BadValue(wrong(field=self.label))
        return [float(part) for part in value]


# What keyboards of many regions and phones have instead of a point and a sign.
_AS_TYPED = str.maketrans(",−–", ".--")
# Thousands, or decimals. After a point the decimals are meant, unless a 0 at the end says nothing.
_AMBIGUOUS = re.compile(r"\s*([-−–+]?)([1-9][0-9]{0,2})(?:,|\.(?=[0-9]{2}0))([0-9]{3})\s*")


def _two(word: str, low: float, high: float) -> Optional[Match[str]]:
    found = _AMBIGUOUS.fullmatch(word)
    return found if found is not None and low <= int("".join(found.groups()).translate(_AS_TYPED)) <= high else None


def typed_number(word: str, low: float = -math.inf, high: float = math.inf) -> str:
    """Return a word with the decimal comma and the typographic minus as the numbers of programs have them. One that can
    mean two numbers has a comma, and is no number. `low`, `high`: the least and the greatest that can be meant."""
    return word.replace(".", ",") if _two(word, low, high) else word.translate(_AS_TYPED)


def two_numbers(of: str, word: str, low: float = -math.inf, high: float = math.inf) -> Optional[Reason]:
    """Return why a word is no number of `of`, if it can mean two; see `typed_number`."""
    found = _two(word, low, high)
    if found is None:
        return None
    sign, before, after = found.groups()
    shorter = after.rstrip("0")
    decimal = f"{sign}{before}.{shorter}".rstrip(".")
    comma = f"{sign}0{before},{after}" if shorter == after else f"{sign}{before},{shorter or 0}"
    return TWO_NUMBERS(field=of, text=word, whole=f"{sign}{before}{after}", decimal=decimal, comma=comma)


def _number(word: str, low: float, high: float) -> Any:
    """Return the number of a typed word; None: it is no number."""
    try:
        return float(typed_number(word, low, high).replace("_", "?"))  # Python takes 1_0 for 10
    except ValueError:
        return None


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


@dataclass(frozen=True)
class Toggle(Field):
    """Yes or no."""

    kind: ClassVar[str] = "toggle"
    nothing: ClassVar[Any] = False

    def read(self, value: Any) -> Any:
        """See `Field`."""
        if type(value) is not bool:
            raise BadValue(NO_BOOL(field=self.label))
        return value

    def parse(self, word: str) -> Any:
        """See `Field`."""
        if word.lower() not in ("yes", "no"):
            raise BadValue(NO_TOGGLE(field=self.label))
        return word.lower() == "yes"


@dataclass(frozen=True)
class Confirmed(Toggle):
    """Whether the question of the action in this zone (`Shown.question`) was confirmed. A face asks it, and gives this.
    """

    kind: ClassVar[str] = "confirmed"


@dataclass(frozen=True)
class Robot(Field):
    """The name of a robot of the event's team. The core says which ones there are (`Choice` in the action's form)."""

    kind: ClassVar[str] = "robot"


@dataclass(frozen=True)
class Team(Field):
    """The team whom it hits. A face gives the one that it shows."""

    kind: ClassVar[str] = "team"


@dataclass(frozen=True)
class EventId(Field):
    """The id of an event of the schedule."""

    kind: ClassVar[str] = "event"


@dataclass(frozen=True)
class OfSchedule(Field):
    """Something of the schedule that a face lets somebody choose. `of`: zone, event (its id), team, benchmark, day."""

    of: str = ""

    kind: ClassVar[str] = "of_schedule"


# What a module may ask for.
ASKED = (Toggle, Number, Decimal, Choice, TypedText, TypedPose)
_KINDS: Dict[str, Type[Field]] = {kind.kind: kind for kind in (
    Field, Fixed, Confirmed, Robot, Team, EventId, OfSchedule, *ASKED)}


def field_of(form: Mapping[str, Any]) -> Field:
    """Return the field that `Field.form` wrote; one of an unknown kind, of a newer box, is a text. Raises TypeError."""
    values: Dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in form.items()}
    kind = _KINDS.get(values.pop("kind", ""))
    if kind is None:
        kind, values = TypedText, {name: values[name] for name in ("name", "label", "required") if name in values}
    made = kind(**{**values, "label": _label(values["label"])})
    for part in dataclasses.fields(made):
        value, wanted = getattr(made, part.name), part.type
        if wanted == Tuple[str, ...]:
            is_right = isinstance(value, tuple) and all(isinstance(one, str) for one in value)
        else:
            is_right = type(value) in ((int, float) if wanted is float else (wanted,))
        if not is_right:
            raise TypeError(f"{part.name} is {value!r}")
    return made


def _label(text: Any) -> Template:
    if not isinstance(text, str):
        raise TypeError(f"label is {text!r}")
    return Template(text)


def form_text(fields: Iterable[Field]) -> str:
    """Return fields as JSON, for `form_of`; empty: there are none."""
    found = [field.form() for field in fields]
    return json.dumps(found, ensure_ascii=False) if found else ""


@functools.lru_cache(maxsize=256)
def form_of(text: str) -> Tuple[Field, ...]:
    """Return the fields in JSON. Raises TypeError, ValueError, KeyError, AttributeError, RecursionError."""
    return tuple(map(field_of, json.loads(text or "[]")))


def entered(fields: Iterable[Field]) -> Tuple[Field, ...]:
    """Return the fields that somebody must enter. A face gives the others itself."""
    return tuple(field for field in fields if not isinstance(field, (Team, Fixed, Confirmed)))


def fixed(fields: Iterable[Field]) -> Dict[str, Any]:
    """Return the values that are given back as they are."""
    return {field.name: field.default for field in fields if isinstance(field, Fixed)}


def answered(fields: Sequence[Field], given: Mapping[str, Any]) -> Dict[str, Any]:
    """Return the values of a form of a module; see `read`. A text that is empty is left out, as earlier faces do. Of
    choices, the usual one comes first."""
    usual = {field.name: field.choices[0] for field in fields if isinstance(field, Choice) and field.choices}
    return read(fields, {**usual, **{name: value for name, value in given.items() if value != ""}})


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
    is_given = field.required or (isinstance(field, Number) and field.name in given)
    return field.read(value) if is_given else field.nothing


def is_encodable(text: str) -> bool:
    """Whether a message can hold a text. JSON can have half of a character."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True
