"""Words that a referee types: names of zones, scoring items, values, events of the schedule."""

import re
import shlex
from typing import Any, Dict, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.actions import ACTIONS, Shown
from roah_rsbb.model.fields import (
    BadValue,
    Choice,
    Decimal,
    Field,
    Number,
    Toggle,
    TypedPose,
    TypedText,
    two_numbers,
    typed_number,
)
from roah_rsbb.model.results import EventSeen
from roah_rsbb.model.scoring import MAX_NUMBER, MAX_VALUE, Entered, ScoreKind, ScoringItem
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.referee.at_once import STOP, meant
from roah_rsbb.scoring.points import number_of, text_of
from roah_rsbb.scoring.sheet import Mark, ScoreSheet
from roah_rsbb.wording.texts import did_you_mean

# Actions that have a command of their own in the terminal, with other words.
PLACED = {"stop": "stop", "choose_event": "choose", "operation": "done"}

# How the terminal confirms what the core asks for.
GIVE_AGAIN = "Give --again for another attempt"
# Words instead of a value.
NOT_ATTEMPTED = ("not-attempted", "n/a")
# The words of STOP at a prompt.
STOPS = (STOP, "stopp")
# Words for the value of a yes-or-no item.
WORDS = {"yes": 1, "true": 1, "no": 0, "false": 0}


class BadWord(Exception):
    """An unknown or ambiguous word. The text lists the possible words."""


class EventWanted(NamedTuple):
    """An event as `run --event` and `--team` name it; None or empty: any."""

    code: str = ""
    round: Optional[int] = None
    run: Optional[int] = None
    team: str = ""

    def fits(self, event: EventSeen) -> bool:
        """Return whether this event is meant."""
        return self.code.lower() in ("", event.code.lower()) and self.team.lower() in ("", event.team.lower()) and all(
            wanted in (None, number) for wanted, number in ((self.round, event.round), (self.run, event.run))
        )

    def __str__(self) -> str:
        event = "/".join(str(part) for part in self[:3] if part not in (None, ""))
        return " ".join(filter(None, [event, f"of team {self.team}" if self.team else ""]))


def pick_zone(word: str, names: Sequence[str]) -> str:
    """Return the zone meant by `word`, see `pick`."""
    return pick("zone", word, names)


def pick(what: str, word: str, names: Sequence[str]) -> str:
    """Return the name meant by `word`: the name, or the beginning of one name only. Case does not matter. `what` it is
    a name of. Raises `BadWord`."""
    found = meant(word, names, str, str.startswith)
    if len(found) == 1:
        return found[0]
    there_are = f"the {what}s are " + _quoted(names)
    if not found:
        near = did_you_mean(word, names)
        raise BadWord(f"no {what} '{word}'{near}" + (f" ({there_are})" if "did you mean" in near else ""))
    raise BadWord(f"'{word}' is the beginning of {len(found)} {what}s: {_quoted(found)}")


def stop_wanted(line: str) -> Optional[str]:
    """Return which zone a line that was typed at a prompt wants to stop (empty: that of the prompt), or a word for all.
    None: the line is no STOP."""
    first, _, rest = line.strip().rstrip("!. ").partition(" ")
    return rest.strip() if first.casefold().rstrip(",:!.") in STOPS else None


def pick_item(word: str, items: Sequence[SheetItem]) -> int:
    """Return the number, from 1, of the scoring item meant by `word`: it, or a part of one description only."""
    if not items:
        raise BadWord("this benchmark has no scoring items for the referee")
    if word.isdecimal() and 1 <= int(word) <= len(items):
        return int(word)
    numbered = list(enumerate(items, 1))
    found = meant(word, numbered, lambda one: one[1].desc, str.__contains__)
    if len(found) == 1:
        return found[0][0]
    listed = "\n".join(f"  {number:2}  {item.group}: {item.desc}" for number, item in found or numbered)
    if not found:
        raise BadWord(f"no scoring item '{word}'; there are\n{listed}")
    raise BadWord(f"'{word}' is in {len(found)} scoring items: give the number, or more of the text\n{listed}")


def value_of(text: str, item: SheetItem) -> Entered:
    """Return the value that `text` gives an item.

    It is a number, yes or no, a choice, or `JUDGE:NUMBER`; +N and -N add to an item, and =N sets it, also below 0.
    Raises `BadWord`, or `Refused` as the core itself does.
    """
    if item.type == "choice":
        return Entered(text=_choice(text, item))
    if item.type == "rating":
        return _rating(text, item)
    is_set, word = text.startswith("="), _typed(text.strip().lstrip("="), item)
    if not is_set and item.type != "bool":
        if word.startswith("-") and number_of(word) is not None and _may_be_negative(item):
            raise BadWord(f"'{text}' for '{item.desc}' can be a value or a step: give '={word}' to set the item to it, "
                          f"'+{word}' to count down by {word[1:]}")
        word = word[1:] if word.startswith("+-") else word
    is_added = not is_set and word.startswith(("+", "-"))
    if item.type == "decimal":
        number = number_of(word)
        if number is None:
            raise BadWord(two_numbers(item.desc, word) or f"'{text}' is not a value for '{item.desc}': give a number "
                          f"such as 2.5, +0.5 or {_below(item)}")
        return Entered(added=text_of(number)) if is_added else Entered(text=text_of(number))
    value = WORDS.get(word.lower()) if item.type == "bool" else None
    if value is None:
        try:
            value = int(word)
        except ValueError:
            kind = "0, 1, yes or no" if item.type == "bool" else f"a whole number such as 2, +1 or {_below(item)}"
            raise BadWord(f"'{text}' is not a value for '{item.desc}': give {kind}") from None
        if is_added and item.type != "bool":
            return Entered(added=str(value))
    if abs(value) > MAX_VALUE:
        raise BadWord(f"'{text}' is too large for '{item.desc}': the maximum is {MAX_VALUE}")
    sheet = ScoreSheet((ScoringItem(item.group, item.desc, ScoreKind[item.type.upper()]),))
    sheet.check(Mark(item.group, item.desc, value))
    return Entered(value)


def _may_be_negative(item: SheetItem) -> bool:
    return item.type != "uint" and (not item.min or item.min.startswith("-"))


def _typed(text: str, item: SheetItem) -> str:
    """Return a typed number of an item as programs have it."""
    return typed_number(text.strip(), float(item.min or -MAX_NUMBER), float(item.max or MAX_NUMBER))


def _below(item: SheetItem) -> str:
    """Return an example with a minus."""
    return "'=-1'" if _may_be_negative(item) else "-1"


def _choice(text: str, item: SheetItem) -> str:
    found = meant(text, item.choices, str, str.startswith)
    if len(found) == 1:
        return found[0]
    raise BadWord(f"'{text}' is not a choice of '{item.desc}': choose one of {_quoted(item.choices)}")


def _rating(text: str, item: SheetItem) -> Entered:
    judge, colon, number = text.rpartition(":")
    found = meant(judge.strip(), item.judges, str, str.startswith)
    if not colon or len(found) != 1:
        raise BadWord(f"'{text}' is not a rating of '{item.desc}': give the judge and a number, such as "
                      f"'{item.judges[0]}:5'; the judges are {_quoted(item.judges)}")
    return Entered(text=_typed(number, item), judge=found[0])


def given_of(words: Sequence[str], fields: Sequence[Field]) -> Dict[str, Any]:
    """Return the values of a form: NAME=VALUE, or values in the order of its fields; of a choice, also its beginning.
    Raises `BadWord`."""
    given: Dict[str, Any] = {}
    other = other_answer(fields)
    for word in [" ".join(words)] if words and is_one_answer(fields) else words:
        name, equals, value = word.partition("=")
        named = [field for field in fields if equals and field.name == name]
        if equals and not named and len(fields) > 1 and other is None:
            raise BadWord(f"'{name}' is not asked for: {form_words(fields)}")
        field, = (named or [field for field in fields if field.name not in given] or [None])[:1]
        if field is None:
            raise BadWord(f"'{word}' is not asked for: {form_words(fields)}")
        if field.name in given:
            raise BadWord(f"'{field.name}' is given twice")
        text = (value if named else word).strip()
        found = meant(text, field.choices, str, str.startswith) if text and isinstance(field, Choice) else []
        if len(found) > 1:
            raise BadWord(f"'{text}' is the beginning of several choices: {_quoted(found)}")
        if text and not found and other is not None and not named:
            field = other
        try:
            given[field.name] = field.parse(found[0] if found else text) if text else ""
        except BadValue as bad:
            raise BadWord(str(bad)) from None
    return given


def given_in(line: str, fields: Sequence[Field]) -> Dict[str, Any]:
    """Return the values of a form in a line; of several, those with blanks are in quotes. Raises `BadWord`."""
    try:
        return given_of([line] if is_one_answer(fields) else shlex.split(line), fields)
    except ValueError as bad:
        raise BadWord(f"'{line}': {bad}") from None


def command_of(action: str) -> str:
    """Return the command of this terminal that does an action."""
    return PLACED.get(action) or (ACTIONS[action].words if action in ACTIONS else action)


def to_confirm(action: Shown) -> Tuple[str, ...]:
    """Return what an action asks, and how it is confirmed here; empty: it asks nothing."""
    return (f"{action.question}. {GIVE_AGAIN}",) if action.question else ()


def other_answer(fields: Sequence[Field]) -> Optional[Field]:
    """Return the text of a form of a choice and a text, for an answer that is none of the choices; None: the form has
    other fields."""
    if [type(field) for field in fields] == [Choice, TypedText] and not fields[1].required:
        return fields[1]
    return None


def is_one_answer(fields: Sequence[Field]) -> bool:
    """Whether a form asks for one answer: a line is its value, and no name is needed."""
    return len(fields) == 1 or other_answer(fields) is not None


def form_words(fields: Sequence[Field]) -> str:
    """Return what a form asks for; with several fields, also their names."""
    if len(fields) == 1:
        return expected(fields[0])
    if other_answer(fields) is not None:
        return f"{expected(fields[0])}, or another answer"
    return "; ".join(f"{field.name}: {field.label} ({expected(field)})" for field in fields) or "it needs no answer"


def expected(field: Field) -> str:
    """Return what may be typed for a field."""
    if isinstance(field, (Number, Decimal)):
        bounds = f"from {field.low}" if field.high == Number.high else f"{field.low:.12g} to {field.high:.12g}"
        return f"{bounds} {field.unit}".rstrip()
    if isinstance(field, TypedPose):
        return "x y direction, in m and degrees"
    return "yes / no" if isinstance(field, Toggle) else " / ".join(getattr(field, "choices", ("text",)))


def event_wanted(text: str) -> EventWanted:
    """Parse the name of an event; raises ValueError with its form."""
    found = re.fullmatch(r"([^/]+)(?:/(\d+))?(?:/(\d+))?", text)
    if found is None:
        raise ValueError(f"'{text}' does not have the form CODE, CODE/ROUND or CODE/ROUND/RUN")
    code, *numbers = found.groups()
    return EventWanted(code, *(number and int(number) for number in numbers))


def score_wanted(text: str) -> Tuple[str, str]:
    """Split `ITEM=VALUE`, also `ITEM==VALUE`; raises ValueError with that form if one of them is missing."""
    item, equals, value = text.rpartition("=")
    if item.endswith("="):
        item, value = item[:-1], f"={value}"
    if not equals or not item.strip() or not value.strip():
        raise ValueError(f"'{text}' does not have the form ITEM=VALUE")
    return item.strip(), value.strip()


def _quoted(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
