"""Saved state: what survives the process, as values that JSON can represent.

Theory of operation. Each object whose state a restart must keep has it in one dataclass, its `state`, and works on
that. Its constructor takes either no state or a saved one. `freeze` converts a state to JSON values. `thaw` converts
these back, using the names and types of the fields. A state that an older version wrote can therefore still be read if
new fields have defaults.

A monotonic time is meaningless after a restart of the computer. Fields with such times are declared as `Mono`, and
`thaw` moves all of them by the same amount (see `Anchor`).

Why this uses no library: each rule of the journal's format (enumerations by name, defaults omitted, times moved, exact
types) would need its own hook, and the library would have to be packaged for every system that the box runs on.
"""

import dataclasses
import enum
import functools
import typing
from decimal import Decimal, InvalidOperation
from typing import Any, Callable, Dict, NamedTuple, NewType, Optional, Tuple, TypeVar, Union, get_type_hints

from roah_rsbb.model.clock import Now

# A monotonic time, in seconds. Only `thaw` distinguishes it from other numbers.
if typing.TYPE_CHECKING:
    Mono = float
else:
    Mono = NewType("Mono", float)

# No clock reaches this many seconds.
_LAST_MOMENT = 1e12
# Stands for the default of a field that has none.
REQUIRED = object()

T = TypeVar("T")
_Thaw = Callable[[Any, float], Any]


class BadState(Exception):
    """A saved state that this version cannot read. The text says where and why."""


class Anchor(NamedTuple):
    """One moment on both clocks, and the boot of the computer to which the monotonic time belongs."""

    mono: float
    utc: float
    boot: str

    def shift(self, now: Now, boot: str, ahead_s: Optional[float] = None) -> float:
        """Return by how many seconds to move the times that were saved at this anchor, now and in this `boot`.

        Within one boot, the monotonic clock is right. On a computer that heard the other one, its own monotonic clock
        is, which is `ahead_s`. Otherwise UTC is used; if it was set back in between, the elapsed time counts as zero.
        """
        if boot == self.boot:
            return 0.0
        if ahead_s is not None:
            return min(ahead_s, now.mono - self.mono)
        passed = max(0.0, now.utc - self.utc)
        return now.mono - passed - self.mono


def freeze(value: Any) -> Any:
    """Convert a state to JSON values. Fields with their default value are omitted."""
    if value is None or value.__class__ in (bool, int, float, str):
        return value
    if isinstance(value, str):
        return str(value)  # a reason is saved in English
    if isinstance(value, enum.Enum):
        return value.name
    if isinstance(value, Decimal):
        return str(value)
    if hasattr(value, "_fields") or dataclasses.is_dataclass(value):
        frozen = {}
        for name, default in defaults(value.__class__):
            field = getattr(value, name)
            if default is REQUIRED or field != default:
                frozen[name] = freeze(field)
        return frozen
    if isinstance(value, dict):
        return {str(key): freeze(item) for key, item in value.items()}
    return [freeze(item) for item in value]


@functools.lru_cache(maxsize=None)
def defaults(cls: Any) -> Tuple[Tuple[str, Any], ...]:
    """Return the names of a state's fields, each with its default."""
    if hasattr(cls, "_fields"):
        return tuple((name, cls._field_defaults.get(name, REQUIRED)) for name in cls._fields)
    return tuple((field.name, _default(field)) for field in dataclasses.fields(cls))


def _default(field: "dataclasses.Field[Any]") -> Any:
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return REQUIRED if field.default is dataclasses.MISSING else field.default


def thaw(cls: Callable[..., T], data: Any, shift: float = 0.0) -> T:
    """Return the state of type `cls` that `freeze` converted to `data`. Times are moved by `shift` seconds.

    Raises `BadState`.
    """
    try:
        state: T = _thaw_of(cls)(data, shift)
        return state
    except (TypeError, ValueError, KeyError, AttributeError, InvalidOperation) as error:
        raise BadState(f"{getattr(cls, '__name__', cls)}: {error}") from None


def _moment(data: Any) -> float:
    """Return seconds on a clock. Rejects NaN and infinity, which would make every later comparison false."""
    seconds = float(data)
    if not abs(seconds) <= _LAST_MOMENT:
        raise ValueError(f"{seconds} is not a time")
    return seconds


@functools.lru_cache(maxsize=None)
def _thaw_of(hint: Any) -> _Thaw:
    """Return the function that reads values of a type."""
    if hint is Mono:
        return lambda data, shift: _moment(data) + shift
    if hint is Now:
        return lambda data, shift: Now(_moment(data["mono"]) + shift, _moment(data["utc"]))
    if hint in (bool, int, str):
        return functools.partial(_exactly, hint)
    if hint is float:
        return lambda data, _shift: float(data)
    if hint is Decimal:
        return _decimal
    if isinstance(hint, type) and issubclass(hint, enum.Enum):
        return lambda data, _shift: hint[data]
    if hasattr(hint, "_fields") or dataclasses.is_dataclass(hint):
        return _thaw_of_fields(hint)
    origin = getattr(hint, "__origin__", None)
    args: Tuple[Any, ...] = getattr(hint, "__args__", ())
    if not_none(hint) is not hint:
        inner = _thaw_of(not_none(hint))
        return lambda data, shift: None if data is None else inner(data, shift)
    if origin is tuple:
        return _tuple_of_items(args)
    if origin is list:
        inner = _thaw_of(args[0])
        return lambda data, shift: [inner(item, shift) for item in data]
    if origin is dict:
        inner = _thaw_of(args[1])
        return lambda data, shift: {key: inner(item, shift) for key, item in data.items()}
    if hint is Any or hint is object or origin is Union:
        return lambda data, _shift: data
    raise TypeError(f"a state cannot hold {hint}")


def _exactly(kind: type, data: Any, _shift: float) -> Any:
    if data.__class__ is not kind:
        raise TypeError(f"found {data!r}, expected {kind.__name__}")
    return data


def not_none(hint: Any) -> Any:
    """Return the other type of an Optional; any other type as it is."""
    args = getattr(hint, "__args__", ())
    is_optional = getattr(hint, "__origin__", None) is Union and len(args) == 2 and type(None) in args
    return next(arg for arg in args if arg is not type(None)) if is_optional else hint


def _thaw_of_fields(hint: Any) -> _Thaw:
    fields: Optional[Dict[str, _Thaw]] = None
    kinds: Dict[str, type] = {}  # of the fields whose values need no conversion: most of a large journal
    upgraded = getattr(hint, "upgraded", lambda data: data)  # what an earlier version wrote

    def read(data: Any, shift: float) -> Any:
        nonlocal fields
        if fields is None:
            hints = get_type_hints(hint)
            fields = {name: _thaw_of(hints[name]) for name, _ in defaults(hint)}
            found = {name: not_none(hints[name]) for name in fields}
            kinds.update((name, kind) for name, kind in found.items() if kind in (bool, int, str, float))
        values = {}
        for name, item in upgraded(data).items():
            if item.__class__ is kinds.get(name):
                values[name] = item
            elif name in fields:
                values[name] = fields[name](item, shift)
        return hint(**values)

    return read


def _decimal(data: Any, _shift: float) -> Decimal:
    number = Decimal(_exactly(str, data, 0.0))
    if not number.is_finite():
        raise ValueError(f"{data} is not a number")
    return number


def _tuple_of_items(args: Tuple[Any, ...]) -> _Thaw:
    if len(args) == 2 and args[1] is Ellipsis:
        inner = _thaw_of(args[0])
        return lambda data, shift: tuple(inner(item, shift) for item in data)
    each = [_thaw_of(arg) for arg in args if arg != ()]

    def read(data: Any, shift: float) -> Tuple[Any, ...]:
        if len(data) != len(each):
            raise ValueError(f"found {len(data)} values, expected {len(each)}")
        return tuple(thaw_item(item, shift) for thaw_item, item in zip(each, data))

    return read
