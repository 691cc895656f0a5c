"""Reads the score sheet of a benchmark and its incidents: the keys `sheet` and `incidents` (docs/rules.md).

A sheet is a tree of sections and items. Rows are known by their ids: the key `id`, or else the name. First all rows are
read, then the names that they refer to are found.
"""

from dataclasses import replace
from decimal import Decimal
from typing import Callable, Dict, Iterator, List, NamedTuple, Optional, Tuple, TypeVar

from roah_rsbb.model.records import NOT_RUN
from roah_rsbb.model.rules import Condition, Incident, Item, ItemChoice, JuryResult, Measure, Sheet, Voids
from roah_rsbb.model.scoring import MAX_DECIMALS, MAX_NUMBER, MAX_VALUE
from roah_rsbb.rulebook.errors import Place, Report, listing, quote
from roah_rsbb.rulebook.yaml_fields import (
    YES_NO,
    all_of,
    choice,
    describe,
    exact,
    fields,
    integer,
    one_of,
    sequence,
    text,
)
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, Sequence, Unusable
from roah_rsbb.wording.texts import did_you_mean, nearest

T = TypeVar("T")

MAX_JUDGES = 20
MAX_HELP_BYTES = 500
# Nobody waits longer in a run.
_MAX_SECONDS = 86400

_ROWS = "rows '- {item: ..., points: 10}' or '- section: ...'"
_OF_BOTH = {"id": "1", "min": "0", "max": "100", "items": "[...]", "needs": "Opens the door", "unless": "Gives up",
            "withholds": "[Takes the cup]", "tags": "[manipulation]", "for_team": "yes", "total": "1490",
            "help": "Once for each door"}
_SECTION = {"section": "Main goal"}
_ITEM = {"item": "Opens the door"}
_ITEM_OPTIONAL = {
    **_OF_BOTH, "amount": "count", "points": "10", "percent": "-5", "compounding": "yes", "times": "3", "each": "yes",
    "share_of_all": "yes", "from": "0", "to": "10", "seconds": "10", "choices": "{fully: 20, partly: 10}",
    "judges": "3", "jury": "mean", "decimals": "0",
}
_WORTH = ("points", "percent", "compounding", "decimals")
# The keys of each amount besides those of sections.
_KEYS = {
    Measure.YES: (*_WORTH, "times", "each"),
    Measure.COUNT: (*_WORTH, "times", "each"),
    Measure.PERCENT: (*_WORTH, "times", "each", "share_of_all"),
    Measure.NUMBER: (*_WORTH, "from", "to"),
    Measure.WHOLE: (*_WORTH, "from", "to"),
    Measure.POINTS: ("points", "decimals", "from", "to"),
    Measure.CHOICE: ("choices",),
    Measure.CLOCK: ("points", "seconds"),
    Measure.RATING: ("points", "decimals", "from", "to", "judges", "jury"),
}
_AMOUNTS = {amount.value: amount for amount in _KEYS}
_UNLIMITED = "unlimited"
_JURY = {each.value: each for each in JuryResult}
# What may hang under an item each time of which is counted alone.
_MODIFIERS = (Measure.YES, Measure.COUNT, Measure.PERCENT)
_CONDITION = {"item": "Opens the door"}
_CONDITION_OPTIONAL = {"least": "2", "is": "fully", "since": "2", "after": "yes", "each": "yes"}
_FACT = {"fact": "announced min before"}
_FACT_OPTIONAL = {"least": "60", "is": "all at once"}
_INCIDENTS = "incidents 'restart: {times: 1, voids: earlier}'"
_INCIDENT = {
    "times": "1", "below": "40", "net": "yes", "when": "audience interference", "unless": "announced",
    "voids": "earlier", "marks": "Cheating", "scored_after": "yes", "until": "restarted", "pauses": "yes",
    "of": "inactive", "after": "30", "longer_by": "longer time", "longer": "180", "requests": "1",
    "at_end": "no_show", "help": "Only before the robot was touched",
}
_ENDS = tuple(reason.name.lower() for reason in NOT_RUN)
_VOIDS = {each.value: each for each in Voids}
_MAX_DEPTH = 100  # rows that depend on each other, one after the other
_NO_SECONDS = Decimal("0.001")


# -- values that other readers have, too ------------------------------------------------------------


def ends(
    report: Report, got: Dict[str, Node], what: str, keys: Tuple[str, str] = ("min", "max")
) -> Tuple[Optional[Decimal], Optional[Decimal]]:
    """Read two limits."""
    low, high = keys
    least, most = (exact(report, got.get(key), key, -MAX_NUMBER, MAX_NUMBER) for key in keys)
    if least is not None and most is not None and least >= most:
        report.error(got[high].place, f"{high} {most} of {what}, whose {low} is {least}", f"a {high} above the {low}")
    return least, most


def choices_of(report: Report, node: Node) -> Tuple[ItemChoice, ...]:
    """Read choices with points (a map), or without (a sequence)."""
    if isinstance(node, Mapping) and len(node.pairs) > 1:
        found = [(text(report, key, "a choice"),
                  exact(report, value, f"points of {quote(key.text)}", -MAX_NUMBER, MAX_NUMBER))
                 for key, value in node.pairs]
        return tuple(ItemChoice(name, points) for name, points in found if name is not None)
    if isinstance(node, Sequence) and len(node.items) > 1:
        return tuple(map(ItemChoice, _names(report, node, "choice")))
    if not isinstance(node, Unusable):
        report.error(node.place, f"{describe(node)} as choices" if isinstance(node, Scalar) else "too few choices",
                     "two or more, such as '{fully: 20, partly: 10}' or, without points, '[fully, partly]'")
    return ()


def judges_of(report: Report, got: Dict[str, Node], is_rating: bool, sheets: int) -> Tuple[str, ...]:
    """Read the judges of a rating. In a benchmark with judges, whose number is `sheets`, each of them rates."""
    if "judges" not in got:
        return tuple(str(i) for i in range(1, sheets + 1)) if is_rating else ()
    node = got["judges"]
    if not isinstance(node, Sequence):
        number = integer(report, node, "judges", 1, MAX_JUDGES)
        judges = tuple(str(i) for i in range(1, (number or 0) + 1))
    else:
        if not 1 <= len(node.items) <= MAX_JUDGES:
            report.error(node.place, f"{len(node.items)} judges", f"from 1 to {MAX_JUDGES}")
        judges = _names(report, node, "judge")
    if sheets and judges and len(judges) != sheets:
        report.error(node.place, f"{len(judges)} judges of a rating in a benchmark with {sheets} judges",
                     "no key 'judges' in the item: each judge rates it")
    return judges


def _names(report: Report, node: Sequence, what: str) -> Tuple[str, ...]:
    """Read names, each of which occurs once."""
    places: Dict[str, Place] = {}
    for each in node.items:
        name = text(report, each, f"a {what}")
        if name is not None:
            report.once(places, name, each.place, f"the {what} {quote(name)} again", f"each {what} once")
    return tuple(places)


def _yes(report: Report, got: Dict[str, Node], key: str) -> bool:
    return one_of(report, got.get(key), key, YES_NO, "yes or no") or False


def _some(report: Report, got: Dict[str, Node], key: str, read: Callable[[Node], Optional[T]]) -> Tuple[T, ...]:
    """Read one thing or several."""
    node = got.get(key)
    one = node if isinstance(node, Sequence) or node is None else Sequence(node.place, (node,))
    return all_of(report, one, key, "names", read)


def _decided(node: Node) -> Tuple[str, ...]:
    """Return what the competition decided about a row or an incident, each once."""
    return tuple(dict.fromkeys(node.decided)) if isinstance(node, Mapping) else ()


def _is_one(node: Node) -> bool:
    return isinstance(node, Scalar) and node.text == "1"


# -- the sheet --------------------------------------------------------------------------------------


class _Row(NamedTuple):
    """A row whose references are not known yet."""

    item: Item
    got: Dict[str, Node]
    place: Place


def read_sheet(
    report: Report, rows: Optional[Node], incidents: Optional[Node], limit_s: Optional[Decimal] = None, sheets: int = 0
) -> Sheet:
    """Read a sheet and its incidents. `limit_s`: of the run; `sheets`: judges who have a sheet of their own."""
    tree = _Rows(report, rows, sheets)
    if limit_s is None:
        for row in tree.rows.values():
            if row.item.amount is Measure.CLOCK:
                report.error(row.place, f"the time left as {quote(row.item.name)} in a run without a time limit",
                             "a timeout in seconds, or no item for the time left")
    return Sheet(tree.items(), _Incidents(report, incidents, tree).found(), limit_s)


class _Rows:
    """The rows of a sheet by their ids."""

    def __init__(self, report: Report, node: Optional[Node], sheets: int) -> None:
        self.rows: Dict[str, _Row] = {}
        self.report = report
        self._sheets = sheets
        self._whole = True  # no row was left out
        self._places: Dict[str, Place] = {}
        self._read(node, "sheet", None)

    def items(self) -> Tuple[Item, ...]:
        """Return the items with their references."""
        for row_id, row in self.rows.items():
            self.rows[row_id] = row._replace(item=replace(
                row.item,
                needs=_some(self.report, row.got, "needs", lambda node: self._condition(node, "needs")),
                unless=_some(self.report, row.got, "unless", lambda node: self._condition(node, "unless")),
                withholds=_some(self.report, row.got, "withholds", lambda node: self.named(node, "withholds"))))
        _Circles(self.report, self.rows).report_one()
        return tuple(row.item for row in self.rows.values())

    def named(self, node: Optional[Node], what: str) -> Optional[str]:
        """Return the id of the row that a node names: by its id, or by a name that only one row has."""
        if isinstance(node, Scalar) and node.text in self.rows:
            return node.text
        name = text(self.report, node, what)
        if name is None or node is None:
            return None
        found = [row_id for row_id, row in self.rows.items() if row.item.name == name]
        if len(found) == 1:
            return found[0]
        if found:
            return self.report.error(node.place, f"{quote(name)} as {what}, which several rows are called",
                                     f"the id of one of them: {', '.join(map(quote, found))}")
        if not self._whole:
            return None  # it may be one that has an error
        known = self._words()
        return self.report.error(node.place, f"{quote(name)} as {what}", "the id or the name of a row of this sheet"
                                 + (did_you_mean(name, known) if known else ""))

    def _words(self) -> Tuple[str, ...]:
        """Return what rows can be named by."""
        return tuple(dict.fromkeys(word for row_id, row in self.rows.items() for word in (row.item.name, row_id)))

    # -- one row ------------------------------------------------------------------------------------

    def _read(self, node: Optional[Node], what: str, above: Optional[Item]) -> None:
        """Read rows that hang under an item, or under the sheet."""
        for each in sequence(self.report, node, what, _ROWS) or ():
            row = self._row(each, above)
            if row is None:
                self._whole = False
            elif "items" in row.got:
                self._read(row.got["items"], f"items of {quote(row.item.name)}", row.item)

    def _row(self, node: Node, above: Optional[Item]) -> Optional[_Row]:
        report = self.report
        keys = [key.text for key, _ in node.pairs] if isinstance(node, Mapping) else []
        is_section = "section" in keys and "item" not in keys
        if isinstance(node, Mapping) and node.whole and "section" not in keys and "item" not in keys:
            return report.error(node.place, "a row without a name", f"one of the {_ROWS}")
        got = fields(report, node, "a section", _SECTION, _OF_BOTH) if is_section else \
            fields(report, node, "an item", _ITEM, _ITEM_OPTIONAL)
        if got is None:
            return None
        name = text(report, got.get("section" if is_section else "item"), "name of a row")
        if name is None:
            return None
        row_id = self._id(got, name)
        amount = Measure.SECTION if is_section else self._amount(got)
        item = Item(row_id or name, name, "" if above is None else above.id, amount or Measure.COUNT,
                    for_team=_yes(report, got, "for_team"),
                    total=exact(report, got.get("total"), "total", -MAX_NUMBER, MAX_NUMBER),
                    tags=_some(report, got, "tags", lambda tag: text(report, tag, "a tag")),
                    help=text(report, got.get("help"), "help", MAX_HELP_BYTES) or "", decided=_decided(node))
        least, most = ends(report, got, quote(name))
        item = replace(item, least=least, most=most)
        if not is_section and amount is not None:
            item = self._with_values(item, got, node)
        row = _Row(item, got, node.place)
        self._check_under(row, above)
        if row_id is None or amount is None:
            self._whole = False
            return row
        self.rows.setdefault(row_id, row)
        return row

    def _id(self, got: Dict[str, Node], name: str) -> Optional[str]:
        """Return what a row is known by; None after an error."""
        node = got.get("id")
        if node is None:
            place = got["item" if "item" in got else "section"].place
            found, expected = f"a second row called {quote(name)}", "an 'id' that only this row has"
            self.report.once(self._places, name, place, found, expected)
            return name
        word = node.text if isinstance(node, Scalar) and node.text.isdigit() else text(self.report, node, "id")
        if word is not None:
            self.report.once(self._places, word, node.place, f"the id {quote(word)} again", "each id once")
        return word

    def _amount(self, got: Dict[str, Node]) -> Optional[Measure]:
        """Return what a mark of an item says; None after an error."""
        if "amount" in got:
            return one_of(self.report, got["amount"], "amount", _AMOUNTS, "what a mark says")
        if "choices" in got:
            return Measure.CHOICE
        if "judges" in got:
            return Measure.RATING
        return Measure.COUNT if "times" in got and not _is_one(got["times"]) else Measure.YES

    def _with_values(self, item: Item, got: Dict[str, Node], node: Node) -> Item:
        """Return an item with the values of its amount."""
        report, amount = self.report, item.amount
        self._check_keys(item, got, node)
        low, high = ends(report, got, quote(item.name), ("from", "to"))
        if amount is Measure.RATING and low is None:
            low = Decimal(0)
            if high is not None and high <= 0 and "from" not in got:
                report.error(got["to"].place, f"{describe(got['to'])} as to of a rating", "a number above 0, or a from")
        for key, end in (("from", low), ("to", high)):
            if amount is Measure.WHOLE and end is not None and end % 1:
                report.error(got[key].place, f"{key} {end} of a whole number", "one without decimals")
        points = exact(report, got.get("points"), "points", -MAX_NUMBER, MAX_NUMBER)
        seconds = exact(report, got.get("seconds"), "seconds", _NO_SECONDS, _MAX_SECONDS)
        return replace(
            item, low=low, high=high, points=Decimal(1) if amount is Measure.POINTS and points is None else points,
            percent=exact(report, got.get("percent"), "percent", -MAX_NUMBER, MAX_NUMBER),
            decimals=integer(report, got.get("decimals"), "decimals", 0, MAX_DECIMALS),
            compounding=_yes(report, got, "compounding"), each=_yes(report, got, "each"),
            share_of_all=_yes(report, got, "share_of_all"),
            times=self._times(got.get("times")) if "times" in _KEYS[amount] else None,
            seconds=Decimal(1) if seconds is None else seconds,
            choices=choices_of(report, got["choices"]) if "choices" in got else (),
            judges=judges_of(report, got, amount is Measure.RATING, self._sheets),
            jury=one_of(report, got.get("jury"), "jury", _JURY, "how ratings become one") or JuryResult.MEAN,
        )

    def _times(self, node: Optional[Node]) -> Optional[int]:
        """Return how often an item counts at most; None: unlimited."""
        if node is None:
            return 1
        if isinstance(node, Scalar) and node.text == _UNLIMITED:
            return None
        if not isinstance(node, Scalar) or not node.text.isdigit():
            choice(self.report, node, "times", (), f"a whole number, or '{_UNLIMITED}'")
            return 1
        return integer(self.report, node, "times", 1, MAX_VALUE)

    def _check_keys(self, item: Item, got: Dict[str, Node], node: Node) -> None:
        """Check that an item has the keys of its amount, and no others."""
        report, amount, keys = self.report, item.amount, _KEYS[item.amount]
        for key in got:
            if key not in (*_OF_BOTH, *keys, "item", "amount"):
                expected = f"one of {listing(map(quote, keys))}"
                if key == "points" and amount is Measure.CHOICE:
                    expected = "the points of each choice, such as 'choices: {fully: 20, partly: 10}'"
                report.error(got[key].place, f"the key {quote(key)} in an item with the amount '{amount.value}'",
                             expected)
        needed = {Measure.CHOICE: ("choices",), Measure.RATING: ("to",) if self._sheets else ("judges", "to")}
        missing = [key for key in needed.get(amount, ()) if key not in got]
        if missing and isinstance(node, Mapping) and node.whole:
            examples = listing(f"'{key}: {_ITEM_OPTIONAL[key]}'" for key in missing)
            report.error(node.place, f"an item with the amount '{amount.value}' without {listing(missing)}",
                         f"something like {examples}")
        if "points" in got and "percent" in got:
            report.error(got["percent"].place, "percent and points in one item", "one of them")
        for one, other in (("compounding", "percent"), ("share_of_all", "each")):
            if one in got and other not in got:
                report.error(got[one].place, f"{one} in an item without {other}", f"the key '{other}', too")
        if amount is Measure.YES and "times" in got and not _is_one(got["times"]):
            report.error(got["times"].place, "times in an item with the amount 'yes or no'", "the amount 'count'")

    def _check_under(self, row: _Row, above: Optional[Item]) -> None:
        """Check that a row may hang under another one."""
        if above is None:
            return
        item = row.item
        if above.each and (item.amount not in _MODIFIERS or item.each or "items" in row.got):
            found = f"{quote(item.name)} under {quote(above.name)}, each time of which is counted alone"
            self.report.error(row.place, found, "counts with points or percent under it, without items of their own")

    # -- references ---------------------------------------------------------------------------------

    def _condition(self, node: Node, key: str) -> Optional[Condition]:
        report = self.report
        if not isinstance(node, Mapping):
            named = self.named(node, key)
            return None if named is None else Condition(named)
        got = fields(report, node, key, _CONDITION, _CONDITION_OPTIONAL) or {}
        named = self.named(got.get("item"), key)
        least = exact(report, got.get("least"), f"least of {key}", _NO_SECONDS, MAX_NUMBER)
        since = integer(report, got.get("since"), f"since of {key}", 2, MAX_VALUE)
        if "since" in got and key == "unless":
            report.error(got["since"].place, "since in unless", "since in needs only")
        if "after" in got and "since" not in got:
            report.error(got["after"].place, f"after in {key} without since", "something like 'since: 2'")
        if named is None:
            return None
        return Condition(named, least, self._choice(named, got.get("is")), since or 1, _yes(report, got, "after"),
                         _yes(report, got, "each"))

    def fact(self, node: Node, key: str) -> Optional[Condition]:
        """Read a fact: what is marked in a row, or comes with the incident under a name that is like none of a row."""
        report, whole = self.report, isinstance(node, Mapping)
        got = (fields(report, node, key, _FACT, _FACT_OPTIONAL) or {}) if whole else {"fact": node}
        name = text(report, got.get("fact"), f"fact of {key}" if whole else key)
        least = exact(report, got.get("least"), f"least of {key}", -MAX_NUMBER, MAX_NUMBER)
        if name is None:
            return None
        words = self._words()
        if name in words or nearest(name, words) is not None:
            named = self.named(got["fact"], key)
            return None if named is None else Condition(named, least, self._choice(named, got.get("is")))
        return Condition(name, least, text(report, got.get("is"), f"is of {key}") or "")

    def _choice(self, row_id: str, node: Optional[Node]) -> str:
        """Return the choice of a row that a condition asks for; empty: none."""
        item = self.rows[row_id].item
        if node is not None and not item.choices:
            self.report.error(node.place, f"'is' of {quote(item.name)}, which has no choices", "an item with choices")
            return ""
        return choice(self.report, node, "is", tuple(each.name for each in item.choices), "one of its choices") or ""


class _Circles:
    """Finds conditions that depend on themselves."""

    def __init__(self, report: Report, rows: Dict[str, _Row]) -> None:
        self._report = report
        self._rows = rows
        self._under: Dict[str, List[str]] = {}
        self._by: Dict[str, List[str]] = {}  # row -> the rows that withhold it
        self._depths: Dict[str, int] = {}  # row -> how many rows its conditions ask, one after the other
        for row_id, row in rows.items():
            self._under.setdefault(row.item.under, []).append(row_id)
            for other in row.item.withholds:
                self._by.setdefault(other, []).append(row_id)

    def report_one(self) -> None:
        """Report the first circle, or else the first row that depends on too many others."""
        path = self._circle()
        if path:
            node = next(each.got[key] for each in self._with_those_above(path)
                        for key in ("needs", "unless", "withholds") if key in each.got)
            names = ", ".join(quote(self._rows[each].item.name) for each in path)
            self._report.error(node.place, f"conditions that depend on each other: {names}",
                               "one of these rows without 'needs', 'unless' or 'withholds'")
        deep = next((row for row_id, row in self._rows.items() if self._depths.get(row_id, 0) > _MAX_DEPTH), None)
        if deep is not None:
            found = f"{quote(deep.item.name)}, which depends on more than {_MAX_DEPTH} rows, one after the other"
            self._report.error(deep.place, found, "conditions that name fewer rows, such as the first or the last one")

    def _with_those_above(self, path: Tuple[str, ...]) -> Iterator[_Row]:
        for row_id in path:
            while row_id in self._rows:
                yield self._rows[row_id]
                row_id = self._rows[row_id].item.under

    def _asked(self, row_id: str) -> List[str]:
        """Return the rows that decide whether this one is given."""
        item = self._rows[row_id].item
        found = self._under.get(row_id, []) if item.amount is Measure.SECTION else []
        return [*found, *self._barring(row_id)]

    def _barring(self, row_id: str) -> List[str]:
        """Return the rows that decide whether this one may count: also those of the rows above it."""
        found: List[str] = []
        for row in self._with_those_above((row_id,)):
            found += [*(each.item for each in (*row.item.needs, *row.item.unless)), *self._by.get(row.item.id, ())]
        return found

    def _circle(self) -> Tuple[str, ...]:
        """Return a path of conditions from a row to itself; empty: there is none. Finds how deep the others are."""
        for start in self._rows:
            path = {} if start in self._depths else {start: iter(self._asked(start))}
            while path:
                row_id = next(reversed(path))
                other = next(path[row_id], None)
                if other in path:
                    names = tuple(path)
                    return names[names.index(other or ""):]
                if other is None:
                    asked = (self._depths[each] for each in self._asked(row_id))
                    self._depths[row_id] = 1 + max(asked, default=0)
                    del path[row_id]
                elif other not in self._depths:
                    path[other] = iter(self._asked(other))
        return ()


# -- incidents --------------------------------------------------------------------------------------


class _Incidents:
    """What may happen in a run, by name."""

    def __init__(self, report: Report, node: Optional[Node], tree: _Rows) -> None:
        self._report = report
        self._tree = tree
        self._named: List[Tuple[str, str, str, Place]] = []  # incident, key, the one that it names, where
        self._found: Dict[str, Incident] = {}
        if node is None or isinstance(node, Unusable):
            return
        if not isinstance(node, Mapping) or not node.pairs:
            report.error(node.place, f"{describe(node)} as incidents", _INCIDENTS)
            return
        for key, value in node.pairs:
            self._read(key, value)
        if len(self._found) == len(node.pairs):
            self._check_names()

    def found(self) -> Tuple[Incident, ...]:
        """Return the incidents."""
        return tuple(self._found.values())

    def _read(self, key: Scalar, node: Node) -> None:
        report = self._report
        name = text(report, key, "name of an incident")
        got = fields(report, node, f"the incident {quote(key.text)}", {}, _INCIDENT)
        if name is None or got is None:
            return
        numbers = {each: exact(report, got.get(each), each, 0, MAX_NUMBER) for each in ("below", "after", "longer")}
        words = {each: self._other(got.get(each), name, each) or "" for each in ("of", "longer_by")}
        self._found[name] = Incident(
            name,
            times=integer(report, got.get("times"), "times", 1, MAX_VALUE),
            below=numbers["below"], net=_yes(report, got, "net"),
            when=_some(report, got, "when", lambda fact: self._tree.fact(fact, "when")),
            unless=_some(report, got, "unless", lambda fact: self._tree.fact(fact, "unless")),
            voids=one_of(report, got.get("voids"), "voids", _VOIDS, "which marks become void") or Voids.NOTHING,
            marks=self._tree.named(got.get("marks"), "marks") or "",
            scored_after=_yes(report, got, "scored_after"), pauses=_yes(report, got, "pauses"),
            ends=_some(report, got, "until", lambda end: self._other(end, name, "until")),
            of=words["of"], after=numbers["after"],
            longer_by=words["longer_by"], longer=numbers["longer"],
            requests=integer(report, got.get("requests"), "requests", 1, MAX_VALUE),
            at_end=_some(report, got, "at_end",
                         lambda end: choice(report, end, "at_end", _ENDS, "how a run ends that was not held")),
            help=text(report, got.get("help"), "help", MAX_HELP_BYTES) or "", decided=_decided(node),
        )
        for one, other in (("of", "after"), ("after", "of"), ("longer", "longer_by"), ("requests", "longer_by"),
                           ("longer_by", "after"), ("net", "below"), ("scored_after", "marks")):
            if one in got and other not in got:
                report.error(got[one].place, f"{one} without {other} in the incident {quote(name)}",
                             f"something like '{other}: {_INCIDENT[other]}'")

    def _other(self, node: Optional[Node], name: str, key: str) -> Optional[str]:
        """Read the name of another incident."""
        word = text(self._report, node, key)
        if word is not None and node is not None:
            self._named.append((name, key, word, node.place))
        return word

    def _check_names(self) -> None:
        """Check that the incidents are there that others name."""
        for name, key, word, place in self._named:
            if word not in self._found or (key == "of" and word == name):
                others = [each for each in self._found if each != name or key != "of"]
                expected = f"another incident of this benchmark, also one such as '{word}: {{}}'"
                self._report.error(place, f"{quote(word)} as {key}",
                                   expected + (did_you_mean(word, others) if others else ""))
