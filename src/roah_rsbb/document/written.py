"""Values as JSON, and back, by the types of their fields.

`notation` is compiled once for each type. NamedTuples and frozen dataclasses become objects; fields with their default
are left out. A field declared as `Said` or `Reason` keeps template and values; a reason in a field declared as `str` is
written in English. JSON that was made is never changed, and shares what is declared as `Any` with the value.

`model/saved.py` does the same for the journal, by other rules: enumerations by name, times moved, no reasons. Both have
`defaults` in common.
"""

import collections.abc
import enum
import functools
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple, Type, TypeVar, get_type_hints

from roah_rsbb.model.fields import Field, field_of
from roah_rsbb.model.reason import Reason, Said, decode, encode
from roah_rsbb.model.saved import REQUIRED, defaults, not_none

T = TypeVar("T")
_NAMES = {dict: "an object", list: "a list", bool: "true or false", int: "a whole number", float: "a number",
          str: "a text"}


class BadDocument(ValueError):
    """JSON does not fit its type. The text says where, what was found and what was expected."""

    def __init__(self, what: str) -> None:
        super().__init__(what)
        self.where: Tuple[str, ...] = ()  # the names of fields, keys and indexes that lead there

    def __str__(self) -> str:
        return ": ".join([*([".".join(self.where)] if self.where else []), str(self.args[0])])


class Notation(NamedTuple):
    """How values of a type are written, and read from JSON (raises `BadDocument`)."""

    write: Callable[[Any], Any]
    read: Callable[[Any], Any]
    plain: Optional[type] = None  # values of exactly this type are JSON themselves: most of a document


def write(value: Any) -> Dict[str, Any]:
    """Return a NamedTuple or frozen dataclass as JSON."""
    written: Dict[str, Any] = notation(value.__class__).write(value)
    return written


def read(cls: Callable[..., T], data: Any) -> T:
    """Return the value of a type in JSON. Unknown fields, of a newer box, are ignored; missing ones have their default.
    Raises `BadDocument`."""
    value: T = notation(cls).read(data)
    return value


@functools.lru_cache(maxsize=None)
def notation(hint: Any) -> Notation:
    """Return how values of a type are written. Raises TypeError: a document cannot hold it."""
    if hint in (bool, int, float, str):
        return Notation(hint, functools.partial(_read_plain, hint), hint)
    if hint is Any:
        return Notation(lambda value: value, lambda data: data)
    if hint in (Reason, Said):
        return Notation(encode, _read_reason)
    if isinstance(hint, type) and issubclass(hint, Field):
        return Notation(lambda field: field.form(), functools.partial(_read_field, hint))
    if isinstance(hint, type) and issubclass(hint, enum.Enum):
        return Notation(lambda value: value.value, functools.partial(_made, hint))
    params = getattr(hint, "__dataclass_params__", None)
    if hasattr(hint, "_fields") or (params is not None and params.frozen):
        return _of_fields(hint)
    if not_none(hint) is not hint:
        inner = notation(not_none(hint))
        return Notation(lambda value: None if value is None else inner.write(value),
                        lambda data: None if data is None else inner.read(data), inner.plain)
    origin = getattr(hint, "__origin__", None)
    args: Tuple[Any, ...] = getattr(hint, "__args__", ())
    if origin is tuple:
        return _of_items(args[0]) if args[1:] == (Ellipsis,) else _of_places([arg for arg in args if arg != ()])
    if origin in (dict, collections.abc.Mapping) and args[0] is str:
        return _of_entries(args[1])
    raise TypeError(f"a document cannot hold {hint}")


def entries_of(hint: Any) -> Optional[Notation]:
    """Return how each entry of a Dict[str, X] is written; None: the type is another one."""
    is_dict = getattr(hint, "__origin__", None) in (dict, collections.abc.Mapping)
    return notation(hint.__args__[1]) if is_dict else None


def _expected(data: Any, kind: type) -> Any:
    """Return JSON of this type."""
    if data.__class__ is not kind:
        raise BadDocument(f"found {data!r:.80}, expected {_NAMES[kind]}")
    return data


def _read_plain(kind: type, data: Any) -> Any:
    return float(data) if kind is float and data.__class__ is int else _expected(data, kind)


def _read_reason(data: Any) -> Reason:
    return decode(data if data.__class__ is list else _expected(data, str))


def _read_field(kind: Type[Field], data: Any) -> Field:
    field: Field = _made(field_of, _expected(data, dict))
    if not isinstance(field, kind):
        raise BadDocument(f"found a field of the kind {field.kind}, expected {kind.kind}")
    return field


def _made(make: Callable[..., Any], data: Any) -> Any:
    """Return what is made of JSON."""
    try:
        return make(data)
    except (TypeError, ValueError, KeyError, AttributeError) as error:
        raise BadDocument(f"found {data!r:.80}: {error}") from None


def _at(where: object, read_part: Callable[[Any], Any], data: Any) -> Any:
    """Return a part that is read; what is wrong there names the place."""
    try:
        return read_part(data)
    except BadDocument as error:
        error.where = (str(where), *error.where)
        raise


def _of_items(hint: Any) -> Notation:
    inner = notation(hint)

    def read_items(data: Any) -> Any:
        return tuple(_at(index, inner.read, item) for index, item in enumerate(_expected(data, list)))

    return Notation(lambda value: [inner.write(item) for item in value], read_items)


def _of_places(hints: List[Any]) -> Notation:
    parts = [notation(hint) for hint in hints]

    def read_places(data: Any) -> Any:
        if len(_expected(data, list)) != len(parts):
            raise BadDocument(f"found {len(data)} values, expected {len(parts)}")
        return tuple(_at(index, part.read, item) for index, (part, item) in enumerate(zip(parts, data)))

    return Notation(lambda value: [part.write(item) for part, item in zip(parts, value)], read_places)


def _of_entries(hint: Any) -> Notation:
    inner = notation(hint)
    return Notation(lambda value: {key: inner.write(item) for key, item in value.items()},
                    lambda data: {key: _at(key, inner.read, item) for key, item in _expected(data, dict).items()})


def _of_fields(cls: Any) -> Notation:
    parts: List[Tuple[str, Any, Optional[type], Callable[[Any], Any]]] = []
    by_name: Dict[str, Notation] = {}
    required = frozenset(name for name, default in defaults(cls) if default is REQUIRED)

    def compile_fields() -> None:  # at the first use, because a type may contain itself
        hints = get_type_hints(cls)
        by_name.update((name, notation(hints[name])) for name, _ in defaults(cls))
        parts.extend((name, default, by_name[name].plain, by_name[name].write) for name, default in defaults(cls))

    def write_fields(value: Any) -> Any:
        if not parts:
            compile_fields()
        data = {}
        for name, default, plain, write_part in parts:
            found = getattr(value, name)
            if found.__class__ is plain:
                if found != default:
                    data[name] = found
            elif found.__class__ is not default.__class__ or found != default:
                data[name] = write_part(found)
        return data

    def read_fields(data: Any) -> Any:
        if not parts:
            compile_fields()
        values = {}
        for name, found in _expected(data, dict).items():
            part = by_name.get(name)
            if part is not None:
                values[name] = found if found.__class__ is part.plain else _at(name, part.read, found)
        if not required <= values.keys():
            raise BadDocument(f"{', '.join(sorted(required - values.keys()))} missing")
        try:
            return cls(**values)
        except (TypeError, ValueError) as error:
            raise BadDocument(str(error)) from None

    return Notation(write_fields, read_fields)
