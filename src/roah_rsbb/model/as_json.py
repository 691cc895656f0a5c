"""Values as JSON, and back, by the types of their fields: what the journal saves of the core, and what faces get.

Theory of operation. `notation` is made once for each type. NamedTuples and dataclasses become objects; fields with
their default are left out. What an older version wrote can therefore still be read if new fields have defaults, and
what a newer one knows is ignored. Enumerations are written by name. A reason in a field declared as `Said` or `Reason`
keeps template and values; in one declared as `str` it is written in English. JSON that was made is never changed, and
shares what is declared as `Any` with the value.

Each object of the core whose state a restart must keep has it in one dataclass, its `state`, and works on that. Its
constructor takes either no state or a saved one. A monotonic time is meaningless after a restart of the computer.
Fields with such times are declared as `Mono`, and `from_json` moves all of them by the same amount (see `Anchor`).

Why this uses no library: each rule of the journal's format (enumerations by name, defaults omitted, times moved, exact
types) would need its own hook, and the library would have to be packaged for every system that the box runs on.
"""

import collections.abc
import dataclasses
import enum
import functools
import inspect
from decimal import Decimal, InvalidOperation
from itertools import count, islice, repeat
from typing import (
    Any,
    Callable,
    Dict,
    Iterable,
    List,
    NamedTuple,
    Optional,
    Tuple,
    Type,
    TypeVar,
    Union,
    get_type_hints,
)

from roah_rsbb.model.clock import Mono, Utc
from roah_rsbb.model.fields import Field, field_of
from roah_rsbb.model.reason import Reason, Said, decode, encode

T = TypeVar("T")
Json = Dict[str, Any]
_NAMES = {dict: "an object", list: "a list", bool: "true or false", int: "a whole number", float: "a number",
          str: "a text"}
_SCHEMAS = {bool: "boolean", int: "integer", float: "number", str: "string"}
_REASON = {
    "description": "A sentence: English, or its template and the values in its places.",
    "anyOf": [{"type": "string"}, {"type": "array", "items": [{"type": "string"}, {"type": "object"}], "minItems": 2,
                                   "maxItems": 2}],
}
# Stands for the default of a field that has none.
_REQUIRED = object()
# No clock reaches this many seconds.
_LAST_MOMENT = 1e12


class BadData(ValueError):
    """JSON does not fit its type. The text says where, what was found and what was expected."""

    def __init__(self, what: str) -> None:
        super().__init__(what)
        self.where: Tuple[str, ...] = ()  # the names of fields, keys and indexes that lead there

    def __str__(self) -> str:
        return ": ".join([*([".".join(self.where)] if self.where else []), str(self.args[0])])


class Notation(NamedTuple):
    """How values of a type are written, how they are read from JSON, with moments moved by so many seconds (raises
    `BadData`), and the JSON Schema of them, which puts definitions of types into a dict."""

    write: Callable[[Any], Any]
    read: Callable[[Any, float], Any]
    schema: Callable[[Json], Json]
    plain: Optional[type] = None  # values of exactly this type are JSON themselves: most of all values


def to_json(value: Any) -> Json:
    """Return a NamedTuple or dataclass as JSON."""
    written: Json = notation(value.__class__).write(value)
    return written


def from_json(cls: Callable[..., T], data: Any, shift: float = 0.0) -> T:
    """Return the value of a type in JSON. Moments are moved by `shift` seconds. Raises `BadData`."""
    value: T = notation(cls).read(data, shift)
    return value


def schema(root: Any) -> Json:
    """Return the JSON Schema (draft 7) of a type, with the docstrings of all types in it."""
    definitions: Json = {}
    whole = notation(root).schema(definitions)
    return {"$schema": "http://json-schema.org/draft-07/schema#", **whole, "definitions": definitions}


@functools.lru_cache(maxsize=None)
def notation(hint: Any) -> Notation:
    """Return how values of a type are written. Raises TypeError: JSON cannot hold it."""
    if hint in _SCHEMAS:
        return Notation(hint, functools.partial(_read_plain, hint), lambda _: {"type": _SCHEMAS[hint]}, hint)
    if hint in (Any, object):
        return Notation(lambda value: value, lambda data, _: data, lambda _: {})
    if hint in (Mono, Utc):
        return Notation(float, lambda data, shift: _moment(data) + (shift if hint is Mono else 0.0),
                        lambda _: {"type": "number"})
    if hint is Decimal:
        return Notation(str, lambda data, _: _made(_decimal, _expected(data, str)), lambda _: {"type": "string"})
    if hint in (Reason, Said):
        return Notation(encode, lambda data, _: decode(data if data.__class__ is list else _expected(data, str)),
                        lambda _: _REASON)
    if isinstance(hint, type) and issubclass(hint, Field):
        return Notation(lambda field: field.form(), lambda data, _: _read_field(hint, data), lambda of: _defined(
            hint, of, lambda _: {"type": "object", "required": ["kind", "name", "label"]}))
    if isinstance(hint, type) and issubclass(hint, enum.Enum):
        return Notation(lambda value: value.name, lambda data, _: _made(hint.__getitem__, _expected(data, str)),
                        lambda of: _defined(hint, of, lambda _: {"enum": [member.name for member in hint]}))
    if hasattr(hint, "_fields") or dataclasses.is_dataclass(hint):
        return _of_fields(hint)
    origin = getattr(hint, "__origin__", None)
    args: Tuple[Any, ...] = getattr(hint, "__args__", ())
    if origin is Union and len(args) == 2 and type(None) in args:
        return _of_optional(notation(args[args.index(type(None)) - 1]))
    if origin is list:
        return _of_items(list, notation(args[0]))
    if origin is tuple:
        return _of_items(tuple, notation(args[0])) if args[1:] == (Ellipsis,) else _of_places(
            [notation(arg) for arg in args if arg != ()])
    if origin in (dict, collections.abc.Mapping) and args[0] is str:
        return _of_entries(notation(args[1]))
    raise TypeError(f"JSON cannot hold {hint}")


def entries_of(hint: Any) -> Optional[Notation]:
    """Return how each entry of a Dict[str, X] is written; None: the type is another one."""
    is_dict = getattr(hint, "__origin__", None) in (dict, collections.abc.Mapping)
    return notation(hint.__args__[1]) if is_dict else None


def _expected(data: Any, kind: type) -> Any:
    """Return JSON of this type."""
    if data.__class__ is not kind:
        raise BadData(f"found {data!r:.80}, expected {_NAMES[kind]}")
    return data


def _read_plain(kind: type, data: Any, _shift: float = 0.0) -> Any:
    return float(data) if kind is float and data.__class__ is int else _expected(data, kind)


def _made(make: Callable[..., Any], data: Any) -> Any:
    """Return what is made of JSON."""
    try:
        return make(data)
    except (TypeError, ValueError, KeyError, AttributeError, InvalidOperation, OverflowError) as error:
        raise BadData(f"found {data!r:.80}: {error}") from None


def _moment(data: Any) -> float:
    """Return seconds on a clock. Rejects NaN and infinity, which would make every later comparison false."""
    seconds: float = _read_plain(float, data)
    if not abs(seconds) <= _LAST_MOMENT:
        raise BadData(f"found {seconds}, expected a time")
    return seconds


def _decimal(text: str) -> Decimal:
    number = Decimal(text)
    if not number.is_finite():
        raise ValueError("it is not a number")
    return number


def _read_field(kind: Type[Field], data: Any) -> Field:
    field: Field = _made(field_of, _expected(data, dict))
    if not isinstance(field, kind):
        raise BadData(f"found a field of the kind {field.kind}, expected {kind.kind}")
    return field


def _read_parts(places: Iterable[object], parts: Iterable[Notation], data: Iterable[Any], shift: float) -> List[Any]:
    """Return parts that are read. The text of an error names the place of the part."""
    values: List[Any] = []
    try:
        for part, item in zip(parts, data):
            values.append(item if item.__class__ is part.plain else part.read(item, shift))
    except BadData as error:
        error.where = (str(next(islice(places, len(values), None))), *error.where)
        raise
    return values


def _of_optional(inner: Notation) -> Notation:
    return Notation(lambda value: None if value is None else inner.write(value),
                    lambda data, shift: None if data is None else inner.read(data, shift),
                    lambda of: {"anyOf": [inner.schema(of), {"type": "null"}]}, inner.plain)


def _of_items(kind: Callable[[Iterable[Any]], Any], inner: Notation) -> Notation:
    def read_items(data: Any, shift: float) -> Any:
        return kind(_read_parts(count(), repeat(inner), _expected(data, list), shift))

    return Notation(lambda value: [inner.write(item) for item in value], read_items,
                    lambda of: {"type": "array", "items": inner.schema(of)})


def _of_places(parts: List[Notation]) -> Notation:
    def read_places(data: Any, shift: float) -> Any:
        if len(_expected(data, list)) != len(parts):
            raise BadData(f"found {len(data)} values, expected {len(parts)}")
        return tuple(_read_parts(count(), parts, data, shift))

    return Notation(lambda value: [part.write(item) for part, item in zip(parts, value)], read_places, lambda of: {
        "type": "array", "items": [part.schema(of) for part in parts], "minItems": len(parts), "maxItems": len(parts)})


def _of_entries(inner: Notation) -> Notation:
    def read_entries(data: Any, shift: float) -> Any:
        return dict(zip(data, _read_parts(data, repeat(inner), _expected(data, dict).values(), shift)))

    return Notation(lambda value: {key: inner.write(item) for key, item in value.items()}, read_entries,
                    lambda of: {"type": "object", "additionalProperties": inner.schema(of)})


def _of_fields(cls: Any) -> Notation:
    if hasattr(cls, "_fields"):
        defaults = {name: cls._field_defaults.get(name, _REQUIRED) for name in cls._fields}
    else:
        defaults = {field.name: _default(field) for field in dataclasses.fields(cls)}
    required = [name for name, default in defaults.items() if default is _REQUIRED]
    upgraded = getattr(cls, "upgraded", None)  # of what an earlier version wrote
    parts: Dict[str, Notation] = {}
    writers: List[Tuple[str, Any, Optional[type], Callable[[Any], Any]]] = []

    def compile_fields() -> None:  # at the first use, because a type may contain itself
        hints = get_type_hints(cls)
        parts.update((name, notation(hints[name])) for name in defaults)
        writers.extend((name, defaults[name], part.plain, part.write) for name, part in parts.items())

    def write_fields(value: Any) -> Any:
        if not parts:
            compile_fields()
        data = {}
        for name, default, plain, write_part in writers:
            found = getattr(value, name)
            if found is default:
                continue
            if found.__class__ is plain:
                if found != default:
                    data[name] = found
            elif found.__class__ is not default.__class__ or found != default:
                data[name] = write_part(found)
        return data

    def read_fields(data: Any, shift: float) -> Any:
        if not parts:
            compile_fields()
        values, name = {}, ""
        data = _expected(data if upgraded is None else _made(upgraded, data), dict)
        try:
            for name, found in data.items():
                part = parts.get(name)
                if part is not None:
                    values[name] = found if found.__class__ is part.plain else part.read(found, shift)
        except BadData as error:
            error.where = (name, *error.where)
            raise
        try:
            return cls(**values)
        except (TypeError, ValueError) as error:
            missing = sorted(name for name in required if name not in values)
            raise BadData(f"{', '.join(missing)} missing" if missing else str(error)) from None

    def describe(of: Json) -> Json:
        if not parts:
            compile_fields()
        return {"type": "object", "properties": {name: part.schema(of) for name, part in parts.items()},
                "required": required}

    return Notation(write_fields, read_fields, lambda of: _defined(cls, of, describe))


def _default(field: "dataclasses.Field[Any]") -> Any:
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return _REQUIRED if field.default is dataclasses.MISSING else field.default


def _defined(cls: Any, definitions: Json, describe: Callable[[Json], Json]) -> Json:
    """Return the schema of a type with a name, and put its definition to the others."""
    if cls.__name__ not in definitions:
        definitions[cls.__name__] = {}  # a type may contain itself
        definitions[cls.__name__] = {"description": inspect.getdoc(cls) or "", **describe(definitions)}
    return {"$ref": f"#/definitions/{cls.__name__}"}
