"""The document from the core to its readers: written once, sent whole, then by its differences.

`Written` is the core's end, `Followed` the reader's; `DocumentReader` is what the core knows of a reader. A slow reader
gets one difference from what it has to the present, so no queue grows.

Messages are JSON objects: `mono` and `utc` are the box's two clocks (s) when it was sent, and `rate` how fast both pass
(1.0, or that of a replay). `number` and `whole` are the document. `number`, `since` and `changes` are the difference
from number `since`. A message with only the clocks is a sign of life. The order of a Dict means nothing.
"""

import json
from typing import Any, Dict, Generic, List, NamedTuple, Optional, Tuple, Type, TypeVar, get_type_hints

from roah_rsbb.document.difference import SAME, changed, difference
from roah_rsbb.model.as_json import BadData, Notation, entries_of, notation
from roah_rsbb.model.clock import Now

D = TypeVar("D")


class Gap(Exception):
    """A difference is from another document than what the reader has: it must ask for the whole."""


class _Section(NamedTuple):
    """How a section is written."""

    name: str
    whole: Notation
    entry: Optional[Notation]  # of a Dict


def _sections_of(root: Any) -> List[_Section]:
    hints = get_type_hints(root)
    return [_Section(name, notation(hints[name]), entries_of(hints[name])) for name in root._fields]


class Written:
    """The present document as JSON. Values that are the same objects as before are not written again."""

    def __init__(self, root: Any, rate: float = 1.0) -> None:
        """`root`: its type, a NamedTuple whose fields are the sections."""
        self.rate = rate
        self.number = 0  # rises by one with each change; 0: there is no document yet
        self.sections: Dict[str, Any] = {}  # JSON by name, which is never changed
        self._kinds = _sections_of(root)
        self._document: Any = None
        self._texts: Dict[str, Tuple[Any, str]] = {}  # of sections, each with the JSON that it is of
        self._made: Dict[int, str] = {}  # what is sent to readers, by the number that they have

    def update(self, document: Any, now: Now) -> bool:
        """Take the present document; returns whether it has changed."""
        if document is self._document:
            return False
        sections = {kind.name: self._section(kind, getattr(document, kind.name)) for kind in self._kinds}
        self._document = document
        if self.number and all(sections[name] is self.sections[name] for name in sections):
            return False
        # No box changes more than once a ms, so the numbers of one that starts again, or takes over, are higher.
        self.number = self.number + 1 if self.number else max(1, int(now.utc * 1000))
        self.sections = sections
        self._made = {}
        return True

    def body(self, since: int, sections: Dict[str, Any]) -> str:
        """Return what a reader is sent that has these sections, of number `since`; 0: it has none."""
        if since not in self._made:
            if since:
                change = difference(sections, self.sections)
                self._made[since] = f'"since":{since},"changes":{_text({} if change is SAME else change)}'
            else:
                texts = (f"{_text(name)}:{self._text_of(name)}" for name in self.sections)
                self._made[0] = f'"whole":{{{",".join(texts)}}}'
        return self._made[since]

    def message(self, now: Now, body: str = "") -> str:
        """Return a message; without a body, it is a sign of life."""
        document = f',"number":{self.number},{body}' if body else ""
        return f'{{"mono":{now.mono:.3f},"utc":{now.utc:.3f},"rate":{self.rate}{document}}}'

    def _section(self, kind: _Section, value: Any) -> Any:
        old_value, old = getattr(self._document, kind.name, None), self.sections.get(kind.name)
        if value is old_value and old is not None:
            return old
        if kind.entry is None:
            return _kept(old, kind.whole.write(value))
        old_value, before, write = old_value or {}, old or {}, kind.entry.write
        return _kept(old, {
            key: before[key] if key in before and item is old_value[key] else _kept(before.get(key), write(item))
            for key, item in value.items()
        })

    def _text_of(self, name: str) -> str:
        section = self.sections[name]
        if name not in self._texts or self._texts[name][0] is not section:
            self._texts[name] = section, _text(section)
        return self._texts[name][1]


class DocumentReader:
    """What one reader has been sent. Ask `next` for a message only when the one before is sent."""

    def __init__(self) -> None:
        self._number = 0
        self._sections: Dict[str, Any] = {}

    def forget(self) -> None:
        """The reader asks for the whole."""
        self._number = 0

    def next(self, written: Written, now: Now) -> Optional[str]:
        """Return the next message; None: the reader has the present document."""
        if self._number == written.number:
            return None
        body = written.body(self._number, self._sections)
        self._number, self._sections = written.number, written.sections
        return written.message(now, body)


class Followed(Generic[D]):
    """The document at the reader. Parts whose JSON is unchanged stay the same objects: sections, and the entries of
    those that are a Dict. A section that an older box does not have takes its default."""

    def __init__(self, root: Type[D]) -> None:
        """`root`: see `Written`."""
        self.number = 0
        self.document: Optional[D] = None  # never changed, but replaced
        self._root: Any = root
        self._kinds = _sections_of(root)
        self._sections: Dict[str, Any] = {}

    def take(self, message: Dict[str, Any]) -> bool:
        """Take a message; returns whether there is another document. Raises `Gap`, and `BadData` if it is of
        another kind of box: nothing has changed then."""
        if "whole" in message:
            sections = message["whole"]
        elif "changes" in message:
            sections = self._changed(message)
        else:
            return False
        if sections.__class__ is not dict or message.get("number").__class__ is not int:
            raise BadData("the message has no sections, or no number")
        new = {name: _kept(self._sections.get(name), data) for name, data in sections.items()}
        is_same = self.document is not None and all(
            new.get(kind.name) is self._sections.get(kind.name) for kind in self._kinds)
        document = self.document if is_same else self._read(new)
        self._sections, self.document, self.number = new, document, message["number"]
        return not is_same

    def _changed(self, message: Dict[str, Any]) -> Any:
        if self.document is None or message.get("since") != self.number:
            raise Gap
        try:
            return changed(self._sections, message["changes"])
        except ValueError:
            raise Gap from None

    def _read(self, sections: Dict[str, Any]) -> D:
        values: Dict[str, Any] = {}
        for kind in self._kinds:
            if kind.name in sections:
                try:
                    values[kind.name] = self._section(kind, sections[kind.name])
                except BadData as error:
                    error.where = (kind.name, *error.where)
                    raise
        try:
            document: D = self._root(**values)
            return document
        except TypeError as error:
            raise BadData(str(error)) from None

    def _section(self, kind: _Section, data: Any) -> Any:
        old = self._sections.get(kind.name)
        if old is data:
            return getattr(self.document, kind.name)
        if kind.entry is None or old is None or data.__class__ is not dict:
            return kind.whole.read(data, 0.0)
        values, found = getattr(self.document, kind.name), {}
        for key, item in data.items():
            is_kept = key in old and (old[key] is item or old[key] == item)
            found[key] = values[key] if is_kept else kind.whole.read({key: item}, 0.0)[key]
        return found


def _kept(old: Any, new: Any) -> Any:
    """Return JSON, as the same object as before if it is equal."""
    return old if old is not None and (old is new or old == new) else new


def _text(data: Any) -> str:
    return json.dumps(data, separators=(",", ":"))
