"""Texts from the network, made safe to show."""

import pytest

from roah_rsbb.wording.plain import plain


@pytest.mark.parametrize("text, shown", [
    ("Übung 'a' – 1", "Übung 'a' – 1"), ("", ""), ("\x1b[31mred", "\\u001b[31mred"),
    ("a\nb\r\0", "a\\u000ab\\u000d\\u0000"), ("\u202eevil", "\\u202eevil"),
])
def test_nothing_commands_a_terminal_or_hides_text(text, shown):
    assert plain(text) == shown
