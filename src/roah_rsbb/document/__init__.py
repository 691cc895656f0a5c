"""What the box is, as one JSON document: written by the core once, followed by readers by its differences.

A document is a value (NamedTuple) whose fields are its sections. `written` makes JSON of values and reads it back.
"""
