"""YAML syntax errors in an organiser's words.

PyYAML says what its parser met ("expected <block end>, but found '<scalar>'"); an organiser needs to
know what to change. The words below never contain text of the file: it may be a password.
"""

from typing import NamedTuple, Tuple

import yaml


class Explanation(NamedTuple):
    """What is wrong, and whether it is so where the construct begins or where the parser stopped."""

    at_begin: bool
    found: str
    expected: str


_QUOTES = Explanation(
    True,
    "a text that begins with a character that has a meaning in YAML",
    "quotes around a text that begins with one of @ ` % * & ! | > [ ] { } , # or a quote",
)
_INDENTATION = (
    "the keys of one map under each other, the '-' of one sequence under each other, and a closing quote "
    "for each opening one"
)

# Part of PyYAML's message (its context, then its problem) to what we say; the first that fits counts.
_EXPLANATIONS: Tuple[Tuple[str, Explanation], ...] = (
    (
        "character '\\t'",
        Explanation(False, "a tab", "spaces: YAML does not allow tabs for indentation or between words"),
    ),
    ("that cannot start any token", _QUOTES._replace(at_begin=False)),
    (
        "could not find expected ':'",
        Explanation(
            True,
            "a line without 'key: value'",
            "a colon and a space after the key (a list item begins with '- ')",
        ),
    ),
    (
        "sequence entries are not allowed",
        Explanation(
            False,
            "a '- ' that cannot stand here",
            "each '- item' on a line of its own, under the others, below a line that ends with ':'",
        ),
    ),
    (
        "mapping keys are not allowed",
        Explanation(False, "a '? ' in the middle of a line", "quotes around a text that contains '? '"),
    ),
    (
        "mapping values are not allowed",
        Explanation(
            False,
            "a ': ' that cannot stand here: its line is indented deeper than the one above, or the one above "
            "is not 'key: value'",
            "the keys of one map under each other, each with a colon and a blank after it",
        ),
    ),
    (
        "quoted scalar found unexpected",
        Explanation(True, "a quote that is opened here and never closed", "a quote at the text's end, too"),
    ),
    (
        "double-quoted scalar",
        Explanation(
            False,
            "a backslash in double quotes before a character that makes no sense after it",
            "single quotes around a text with backslashes, or each backslash doubled",
        ),
    ),
    ("while scanning an alias", _QUOTES),
    ("while scanning an anchor", _QUOTES),
    ("while scanning a tag", _QUOTES),
    ("while parsing a tag", _QUOTES),
    ("while scanning a block scalar", _QUOTES),
    ("undefined tag handle", _QUOTES),
    (
        "directive",
        Explanation(True, "a line that begins with '%'", "no YAML directives, or quotes around the text"),
    ),
    ("YAML document", Explanation(False, "a '%YAML' line of a version other than 1", "no such line")),
    ("tag handle", Explanation(False, "a '%TAG' line", "no such line")),
    ("but found '}'", Explanation(False, "a '}' without its '{'", "as many '{' as '}'")),
    ("but found ']'", Explanation(False, "a ']' without its '['", "as many '[' as ']'")),
    (
        "<document start>",
        Explanation(False, "a line that does not belong to what stands above", _INDENTATION),
    ),
    (
        "<block end>",
        Explanation(False, "a line that does not continue what stands above", _INDENTATION),
    ),
    (
        "flow sequence",
        Explanation(
            True,
            "a '[' without its ']', or a comma missing in between",
            "'[a, b, c]', and a pair of quotes around a text that contains [ ] { } , or ': '",
        ),
    ),
    (
        "flow mapping",
        Explanation(
            True,
            "a '{' without its '}', or a comma missing in between",
            "'{key: value, key: value}', and a pair of quotes around a text that contains [ ] { } , or ': '",
        ),
    ),
    (
        "expected the node content",
        Explanation(
            False,
            "a comma, a bracket or another sign where a value should begin",
            f"a value, or {_QUOTES.expected}",
        ),
    ),
)

_UNKNOWN = Explanation(False, "something that is not YAML", "'key: value' and '- item' lines")


# The same message of PyYAML, but something stands on the line before the place where the parser stopped.
_SECOND_COLON = Explanation(
    False, "a second ': ' on the line", "one 'key: value' a line, and quotes around a text that contains ': '"
)
_AFTER_QUOTE = Explanation(
    False,
    "text after a closing quote",
    "a quote within a text doubled ('Granny''s'), or the other kind of quotes around it (\"Granny's\")",
)


def explain(error: yaml.MarkedYAMLError, before: str) -> Explanation:
    """What an organiser can do about PyYAML's `error`; `before` is the line's text up to where it stopped."""
    message = f"{error.context} {error.problem}"
    if "mapping values are not allowed" in message and ": " in before:
        return _SECOND_COLON
    if "<scalar>" in message and before.rstrip().endswith(("'", '"')):
        return _AFTER_QUOTE
    for part, explanation in _EXPLANATIONS:
        if part in message:
            return explanation
    return _UNKNOWN
