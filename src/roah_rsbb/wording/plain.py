"""Texts from the network, made safe to show."""


def plain(text: str) -> str:
    """Return the text in one line, without characters that command a terminal or hide or forge other text."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in text)
