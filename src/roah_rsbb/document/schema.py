"""The JSON Schema (draft 7) of a document, from its types and their docstrings. As a program, that of the box."""

import collections.abc
import enum
import inspect
import json
from typing import Any, Dict, Tuple, get_type_hints

from roah_rsbb.model.document import Document
from roah_rsbb.model.fields import Field
from roah_rsbb.model.reason import Reason, Said
from roah_rsbb.model.saved import REQUIRED, defaults, not_none

_PLAIN = {bool: "boolean", int: "integer", float: "number", str: "string"}
_REASON = {
    "description": "A sentence: English, or its template and the values in its places.",
    "anyOf": [{"type": "string"}, {"type": "array", "items": [{"type": "string"}, {"type": "object"}], "minItems": 2,
                                   "maxItems": 2}],
}


def schema(root: Any) -> Dict[str, Any]:
    """Return the schema of a type. Fields with their default are left out, so that only those without are required."""
    definitions: Dict[str, Any] = {}
    whole = _of(root, definitions)
    return {"$schema": "http://json-schema.org/draft-07/schema#", **whole, "definitions": definitions}


def _of(hint: Any, definitions: Dict[str, Any]) -> Dict[str, Any]:
    if hint in _PLAIN:
        return {"type": _PLAIN[hint]}
    if hint is Any:
        return {}
    if hint in (Reason, Said):
        return _REASON
    if not_none(hint) is not hint:
        return {"anyOf": [_of(not_none(hint), definitions), {"type": "null"}]}
    origin = getattr(hint, "__origin__", None)
    args: Tuple[Any, ...] = getattr(hint, "__args__", ())
    if origin is tuple and args[1:] == (Ellipsis,):
        return {"type": "array", "items": _of(args[0], definitions)}
    if origin is tuple:
        items = [_of(arg, definitions) for arg in args]
        return {"type": "array", "items": items, "minItems": len(items), "maxItems": len(items)}
    if origin in (dict, collections.abc.Mapping):
        return {"type": "object", "additionalProperties": _of(args[1], definitions)}
    if hint.__name__ not in definitions:
        definitions[hint.__name__] = {}  # a type may contain itself
        definitions[hint.__name__] = _definition(hint, definitions)
    return {"$ref": f"#/definitions/{hint.__name__}"}


def _definition(cls: Any, definitions: Dict[str, Any]) -> Dict[str, Any]:
    about = {"description": inspect.getdoc(cls) or ""}
    if issubclass(cls, enum.Enum):
        return {**about, "enum": [member.value for member in cls]}
    if issubclass(cls, Field):
        return {**about, "type": "object", "required": ["kind", "name", "label"]}
    hints = get_type_hints(cls)
    return {
        **about, "type": "object", "properties": {name: _of(hints[name], definitions) for name, _ in defaults(cls)},
        "required": [name for name, default in defaults(cls) if default is REQUIRED]}


if __name__ == "__main__":
    print(json.dumps(schema(Document), indent=1))
