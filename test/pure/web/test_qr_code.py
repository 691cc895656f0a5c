"""QR codes: what a terminal shows is what the library made."""

import builtins

import pytest

from roah_rsbb.web import pairing

URL = "http://192.168.100.200:8081/pair#ABCD-EFGH-JKMNPQRSTUVWXYZ2"


def test_a_terminal_shows_each_module():
    pytest.importorskip("qrcode")
    rows, lines = pairing.modules_of(URL), pairing.lines_of(URL)
    dark = {"█": (False, False), "▀": (False, True), "▄": (True, False), " ": (True, True)}
    shown = [[dark[sign][half] for sign in line] for line in lines for half in (0, 1)]
    assert shown[:len(rows)] == rows
    assert not any(shown[0]) and not any(row[0] for row in shown), "a light border, without which nobody can read it"


def test_without_the_library_there_is_no_code(monkeypatch):
    imported = builtins.__import__

    def without(name, *rest, **more):
        if name == "qrcode":
            raise ImportError(name)
        return imported(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    assert pairing.modules_of(URL) is None and pairing.lines_of(URL) == []
