"""A message's fields as plain values, by the names of the .proto file."""

from typing import Any, Dict

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message


def fields_of(message: Message) -> Dict[str, Any]:
    """The fields that were sent: numbers, bools, texts, names of enum values, lists, dicts of inner messages."""
    return {field.name: _value(field, value) for field, value in message.ListFields()}


def _value(field: FieldDescriptor, value: Any) -> Any:
    if hasattr(value, "extend"):  # repeated: each version of protobuf has classes of its own for it
        return [_value(field, item) for item in value]
    if field.message_type is not None:
        return fields_of(value)
    if field.enum_type is not None:
        return field.enum_type.values_by_number[value].name
    return value
