"""Text from robots, configuration files and people, made safe to show; and short lists."""

import json
from typing import Any, Iterable


def visible(text: str) -> str:
    """Write out every character that cannot be printed, such as ``\\x1b``; line breaks stay.

    Such characters could send commands to a terminal or reverse the direction of writing.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape", "replace").decode() for c in text)


def escaped(text: str) -> str:
    """Write out every character that cannot be printed, line breaks too: the text stays in one line."""
    return visible(text).replace("\n", "\\n")


def one_line(text: str) -> str:
    """Make visible text of one line."""
    return " ".join(visible(text).split())


def value_text(value: Any) -> str:
    """Return any JSON value as text."""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def bullets(lines: Iterable[str]) -> str:
    """Return one line unchanged, several as a list."""
    lines = list(lines)
    return "\n".join(lines if len(lines) < 2 else [f"• {line}" for line in lines])
