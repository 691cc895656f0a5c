"""Codes, also as QR codes, sessions and their file. Without sockets and without time."""

import builtins
import json
import os
import re
import stat
import threading

import pytest

from roah_rsbb.ground.kept_file import open_kept
from roah_rsbb.web import pairing
from roah_rsbb.web.pairing import CODE_VALID_S, FILE, SESSION_VALID_S, Codes, Grant, NotPaired, Sessions, TooManyGuesses

GRANT, JUDGE = Grant("referee", "Home"), Grant("judge", "Home")
ADDRESS = "192.0.2.1"
URL = "http://192.168.100.200:8081/pair#ABCD-EFGH-JKMNPQRSTUVWXYZ2"
UTC = 1_700_000_000.0


# -- codes ------------------------------------------------------------------------------------------


def taken(codes, mono, given):
    """Pair a device."""
    grant = codes.granted(mono, given, ADDRESS)
    codes.use_up(given)
    return grant


@pytest.mark.parametrize("used, later", ["typed link".split(), "link typed".split(), ["typed"] * 2, ["link"] * 2])
def test_a_code_is_for_one_device(used, later):
    codes = Codes()
    code = codes.make(0.0, GRANT)._asdict()
    assert taken(codes, 1.0, code[used]) == GRANT
    with pytest.raises(NotPaired, match="was used"):
        taken(codes, 1.0, code[later])


@pytest.mark.parametrize("typed", [str.lower, lambda code: code.replace("-", ""), lambda code: f" {code} "])
def test_a_code_may_be_typed_in_other_ways(typed):
    codes = Codes()
    assert taken(codes, 0.0, typed(codes.make(0.0, GRANT).typed)) == GRANT


def test_a_code_becomes_too_old():
    codes = Codes()
    early, late = codes.make(0.0, GRANT), codes.make(1.0, GRANT)
    with pytest.raises(NotPaired):
        taken(codes, CODE_VALID_S, early.typed)
    assert taken(codes, CODE_VALID_S, late.typed) == GRANT


def test_codes_cannot_be_mistaken_and_differ():
    codes = Codes()
    made = {codes.make(0.0, GRANT).typed for _ in range(200)}
    assert len(made) == 200
    assert not set("".join(made)) & set("01OIL")


def test_too_many_codes_push_out_the_oldest():
    codes = Codes()
    made = [codes.make(0.0, GRANT) for _ in range(pairing.MAX_CODES + 1)]
    with pytest.raises(NotPaired):
        taken(codes, 0.0, made[0].typed)
    assert taken(codes, 0.0, made[1].typed) == GRANT


def guesses(codes, mono, address):
    for done in range(100):
        with pytest.raises(NotPaired) as refused:
            codes.granted(mono, "AAAA-AAAA", address)
        if refused.type is TooManyGuesses:
            return done
    return 100


def test_guesses_of_an_address_are_limited():
    codes = Codes()
    assert guesses(codes, 0.0, ADDRESS) == pairing.GUESSES_AT_ONCE
    assert guesses(codes, 0.0, "192.0.2.2") == pairing.GUESSES_AT_ONCE, "another one is not kept out"
    assert guesses(codes, 1.0 / pairing.GUESSES_A_SECOND, ADDRESS) == 1


def test_the_link_is_not_limited_by_guesses_and_is_never_guessed():
    codes = Codes()
    code = codes.make(0.0, GRANT)
    assert guesses(codes, 0.0, ADDRESS) == pairing.GUESSES_AT_ONCE
    with pytest.raises(TooManyGuesses):
        codes.granted(0.0, code.typed, ADDRESS)
    for _ in range(100):
        with pytest.raises(NotPaired, match="wrong"):
            codes.granted(0.0, f"{code.typed}-{'A' * 16}", ADDRESS)
    assert taken(codes, 0.0, code.link) == GRANT


def test_right_codes_are_no_guesses():
    codes = Codes()
    code = codes.make(0.0, GRANT)
    for _ in range(100):
        codes.granted(0.0, code.typed, ADDRESS)
    assert guesses(codes, 0.0, ADDRESS) == pairing.GUESSES_AT_ONCE


def test_a_code_is_taken_while_a_hundred_addresses_guess():
    codes = Codes()
    code = codes.make(0.0, GRANT)
    for number in range(100):
        assert guesses(codes, 0.0, f"192.0.3.{number}") == pairing.GUESSES_AT_ONCE
    assert taken(codes, 0.0, code.typed) == GRANT


# -- sessions ---------------------------------------------------------------------------------------


class Kept:
    """What is saved."""

    def __init__(self):
        self.records = []
        self.error = None

    def save(self, records):
        if self.error:
            raise self.error
        self.records = json.loads(json.dumps(records))


def added(sessions):
    """The token of a device whose session is on the disk."""
    token = sessions.add(UTC, GRANT, "Anna", "iPhone")
    sessions.kept.newest.result()
    return token


def test_a_token_gives_its_session_and_no_other_does():
    sessions = Sessions(Kept().save)
    first = sessions.add(UTC, GRANT, "Anna", "iPhone")
    second = sessions.add(UTC, Grant("organiser", ""), "Olga", "")
    assert re.fullmatch("Anna, iPhone [0-9a-f]{8}", sessions.of(UTC, first).who)
    assert re.fullmatch("Olga, organiser, browser [0-9a-f]{8}", sessions.of(UTC, second).who)
    assert sessions.of(UTC, first + "x") is None and sessions.of(UTC, "") is None


def test_the_token_is_random_and_only_its_hash_is_kept():
    kept = Kept()
    sessions = Sessions(kept.save)
    tokens = {sessions.add(UTC, GRANT, f"Anna {n}", "iPhone") for n in range(50)}
    assert len(tokens) == 50 and all(len(token) >= 43 for token in tokens), "256 bits"
    sessions.kept.newest.result()
    saved = json.dumps(kept.records)
    assert not any(token in saved for token in tokens)


def test_sessions_continue_after_a_restart():
    kept = Kept()
    sessions = Sessions(kept.save)
    token = added(sessions)
    again = Sessions(kept.save, kept.records)
    assert again.of(UTC, token).grant == GRANT
    assert again.revoke(again.of(UTC, token).id)
    again.kept.newest.result()
    assert Sessions(kept.save, kept.records).of(UTC, token) is None


def test_a_session_ends_by_itself():
    sessions = Sessions(Kept().save)
    token = sessions.add(UTC, GRANT, "Anna", "iPhone")
    assert sessions.of(UTC + SESSION_VALID_S, token) is not None
    assert sessions.of(UTC + SESSION_VALID_S + 1.0, token) is None
    assert sessions.listed(UTC + SESSION_VALID_S + 1.0) == []


def test_all_pairings_can_be_ended_at_once():
    sessions = Sessions(Kept().save)
    tokens = [sessions.add(UTC, GRANT, f"Anna {n}", "iPhone") for n in range(3)]
    assert len(sessions.revoke("unknown")) == 0
    assert len(sessions.revoke("")) == 3
    assert [sessions.of(UTC, token) for token in tokens] == [None] * 3


def test_the_end_of_a_pairing_counts_if_it_cannot_be_saved():
    kept = Kept()
    sessions = Sessions(kept.save)
    token = added(sessions)
    kept.error = OSError("disk full")
    sessions.revoke("")
    with pytest.raises(OSError):
        sessions.kept.newest.result()
    assert sessions.of(UTC, token) is None


def test_what_was_changed_last_is_saved_last_whatever_the_disk_takes():
    is_free, kept = threading.Event(), []
    sessions = Sessions(lambda records: (is_free.wait(60.0), kept.append(len(records))))
    for person in "ABC":
        sessions.add(UTC, GRANT, person, "iPhone")
    sessions.revoke("")
    is_free.set()
    sessions.kept.newest.result()
    assert kept == [1, 2, 3, 0]


@pytest.mark.parametrize("person", ["", "  ", "\n\t\0"])
def test_a_person_needs_a_name(person):
    with pytest.raises(NotPaired, match="your name"):
        Sessions(Kept().save).add(UTC, GRANT, person, "iPhone")


def test_names_are_a_line_each():
    sessions = Sessions(Kept().save)
    session = sessions.of(UTC, sessions.add(UTC, GRANT, "Anna\n(organiser)" + "x" * 100, "\x1b[31mred"))
    assert "\n" not in session.who and "\x1b" not in session.who
    assert len(session.person) == pairing.MAX_NAME


def test_there_is_a_limit_of_devices(monkeypatch):
    monkeypatch.setattr(pairing, "MAX_SESSIONS", 2)
    sessions = Sessions(Kept().save)
    sessions.add(UTC, GRANT, "Anna", "")
    sessions.add(UTC, GRANT, "Bert", "")
    with pytest.raises(NotPaired, match="Too many devices"):
        sessions.add(UTC, GRANT, "Cora", "")
    sessions.add(UTC + SESSION_VALID_S + 1.0, GRANT, "Cora", "")  # the others have ended


@pytest.mark.parametrize("name", ["Anna", "anna", " ANNA "])
@pytest.mark.parametrize("other", [GRANT, JUDGE])
def test_a_name_is_for_one_device(name, other):
    sessions = Sessions(Kept().save)
    anna = sessions.of(UTC, sessions.add(UTC, JUDGE, "Anna", "iPhone"))
    with pytest.raises(NotPaired, match=rf"in use on another device \({anna.device_id}\).*ask an organiser to end"):
        sessions.add(UTC, other, name, "iPad")
    assert sessions.listed(UTC) == [anna]
    sessions.add(UTC, other, name, "iPhone", before=anna)  # the same device pairs again
    sessions.revoke("")
    sessions.add(UTC, other, name, "iPad")


def test_a_pairing_that_is_not_valid_any_more_holds_no_name():
    sessions = Sessions(Kept().save)
    sessions.add(UTC, JUDGE, "Anna", "iPhone")
    sessions.add(UTC, JUDGE, "Anna", "iPhone", is_encrypted=True)  # all are paired again with the first certificate
    with pytest.raises(NotPaired, match="in use"):
        sessions.add(UTC + SESSION_VALID_S, JUDGE, "Anna", "iPad", is_encrypted=True)
    sessions.add(UTC + SESSION_VALID_S + 1.0, JUDGE, "Anna", "iPad", is_encrypted=True)


# -- the file ---------------------------------------------------------------------------------------


def open_sessions(folder, report):
    return open_kept(str(folder), FILE, Sessions, [], report, "pair the devices again")


def test_the_file_is_its_user_s_alone(tmp_path):
    folder = tmp_path / "log"
    before = os.umask(0)
    try:
        token = added(open_sessions(folder, pytest.fail))
    finally:
        os.umask(before)
    assert stat.S_IMODE((folder / FILE).stat().st_mode) == 0o600
    assert token not in (folder / FILE).read_text()
    assert open_sessions(folder, pytest.fail).of(UTC, token).person == "Anna"


@pytest.mark.parametrize("text", [
    "", "{", "[1]", '[{"id": "x"}]', pytest.param("[" * 9_999, id="deep"), '"x"', '[{"token_sha256": 1}]',
])
def test_a_damaged_file_is_moved_aside(tmp_path, text):
    (tmp_path / FILE).write_text(text)
    reported = []
    sessions = open_sessions(tmp_path, reported.append)
    assert sessions.listed(UTC) == [] and FILE in reported[0]
    assert (tmp_path / f"{FILE}.damaged").read_text() == text
    token = added(sessions)
    assert open_sessions(tmp_path, pytest.fail).of(UTC, token)


def test_a_link_in_the_place_of_the_draft_is_not_followed(tmp_path):
    target = tmp_path / "passwords.yaml"
    target.write_text("secret")
    (tmp_path / f"{FILE}.new").symlink_to(target)
    with pytest.raises(OSError):
        added(open_sessions(tmp_path, pytest.fail))
    assert target.read_text() == "secret"


# -- QR codes ----------------------------------------------------------------------------------------


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
