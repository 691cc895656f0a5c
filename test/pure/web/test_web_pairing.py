"""Codes, sessions and their file. Without sockets and without time."""

import json
import os
import stat

import pytest

from roah_rsbb.web import pairing
from roah_rsbb.web.kept_file import open_kept
from roah_rsbb.web.pairing import CODE_VALID_S, FILE, SESSION_VALID_S, Codes, Grant, NotPaired, Sessions, TooManyGuesses

GRANT = Grant("referee", "Home")
UTC = 1_700_000_000.0


# -- codes ------------------------------------------------------------------------------------------


def test_a_code_is_for_one_device():
    codes = Codes()
    code = codes.make(0.0, GRANT)
    assert codes.take(1.0, code) == GRANT
    with pytest.raises(NotPaired, match="was used"):
        codes.take(1.0, code)


@pytest.mark.parametrize("typed", [str.lower, lambda code: code.replace("-", ""), lambda code: f" {code} "])
def test_a_code_may_be_typed_in_other_ways(typed):
    codes = Codes()
    assert codes.take(0.0, typed(codes.make(0.0, GRANT))) == GRANT


def test_a_code_becomes_too_old():
    codes = Codes()
    early, late = codes.make(0.0, GRANT), codes.make(1.0, GRANT)
    with pytest.raises(NotPaired):
        codes.take(CODE_VALID_S, early)
    assert codes.take(CODE_VALID_S, late) == GRANT


def test_codes_cannot_be_mistaken_and_differ():
    codes = Codes()
    made = {codes.make(0.0, GRANT) for _ in range(200)}
    assert len(made) == 200
    assert not set("".join(made)) & set("01OIL")


def test_too_many_codes_push_out_the_oldest():
    codes = Codes()
    made = [codes.make(0.0, GRANT) for _ in range(pairing.MAX_CODES + 1)]
    with pytest.raises(NotPaired):
        codes.take(0.0, made[0])
    assert codes.take(0.0, made[1]) == GRANT


def guesses(codes, mono, addresses):
    done = 0
    for address in addresses:
        try:
            codes.check_guess(mono, address)
        except TooManyGuesses:
            return done
        done += 1
    return done


def test_guesses_of_an_address_are_limited():
    codes = Codes()
    assert guesses(codes, 0.0, ["192.0.2.1"] * 100) == pairing.GUESSES_AT_ONCE
    codes.check_guess(0.0, "192.0.2.2")  # another one is not kept out
    codes.check_guess(1.0 / pairing.GUESSES_A_SECOND, "192.0.2.1")


def test_right_codes_are_no_guesses():
    codes = Codes()
    for _ in range(100):
        codes.check_guess(0.0, "192.0.2.1")
        codes.was_right("192.0.2.1")
    assert guesses(codes, 0.0, ["192.0.2.1"] * 100) == pairing.GUESSES_AT_ONCE


def test_a_code_is_taken_while_a_hundred_addresses_guess():
    codes = Codes()
    code = codes.make(0.0, GRANT)
    for number in range(100):
        assert guesses(codes, 0.0, [f"192.0.2.{number}"] * 100) == pairing.GUESSES_AT_ONCE
    codes.check_guess(0.0, "192.0.2.101")
    assert codes.take(0.0, code) == GRANT


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


def test_a_token_gives_its_session_and_no_other_does():
    sessions = Sessions(Kept().save)
    first = sessions.add(UTC, GRANT, "Anna", "iPhone")
    second = sessions.add(UTC, Grant("organiser", ""), "Olga", "")
    assert sessions.of(UTC, first).who == "Anna, iPhone"
    assert sessions.of(UTC, second).who == "Olga, organiser, browser"
    assert sessions.of(UTC, first + "x") is None and sessions.of(UTC, "") is None


def test_the_token_is_random_and_only_its_hash_is_kept():
    kept = Kept()
    sessions = Sessions(kept.save)
    tokens = {sessions.add(UTC, GRANT, "Anna", "iPhone") for _ in range(50)}
    assert len(tokens) == 50 and all(len(token) >= 43 for token in tokens), "256 bits"
    saved = json.dumps(kept.records)
    assert not any(token in saved for token in tokens)


def test_sessions_continue_after_a_restart():
    kept = Kept()
    token = Sessions(kept.save).add(UTC, GRANT, "Anna", "iPhone")
    again = Sessions(kept.save, kept.records)
    assert again.of(UTC, token).grant == GRANT
    assert again.revoke(again.of(UTC, token).id)
    assert Sessions(kept.save, kept.records).of(UTC, token) is None


def test_a_session_ends_by_itself():
    sessions = Sessions(Kept().save)
    token = sessions.add(UTC, GRANT, "Anna", "iPhone")
    assert sessions.of(UTC + SESSION_VALID_S, token) is not None
    assert sessions.of(UTC + SESSION_VALID_S + 1.0, token) is None
    assert sessions.listed(UTC + SESSION_VALID_S + 1.0) == []


def test_all_pairings_can_be_ended_at_once():
    sessions = Sessions(Kept().save)
    tokens = [sessions.add(UTC, GRANT, "Anna", "iPhone") for _ in range(3)]
    assert len(sessions.revoke("unknown")) == 0
    assert len(sessions.revoke("")) == 3
    assert [sessions.of(UTC, token) for token in tokens] == [None] * 3


def test_a_pairing_that_cannot_be_saved_is_refused_and_an_end_of_one_counts():
    kept = Kept()
    sessions = Sessions(kept.save)
    token = sessions.add(UTC, GRANT, "Anna", "iPhone")
    kept.error = OSError("disk full")
    with pytest.raises(NotPaired, match="disk full"):
        sessions.add(UTC, GRANT, "Bert", "iPad")
    assert len(sessions.listed(UTC)) == 1
    with pytest.raises(OSError):
        sessions.revoke("")
    assert sessions.of(UTC, token) is None


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


# -- the file ---------------------------------------------------------------------------------------


def open_sessions(folder, report):
    return open_kept(str(folder), FILE, Sessions, [], report, "pair the devices again")


def test_the_file_is_its_user_s_alone(tmp_path):
    folder = tmp_path / "log"
    before = os.umask(0)
    try:
        token = open_sessions(folder, pytest.fail).add(UTC, GRANT, "Anna", "iPhone")
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
    token = sessions.add(UTC, GRANT, "Anna", "iPhone")
    assert open_sessions(tmp_path, pytest.fail).of(UTC, token)


def test_a_link_in_the_place_of_the_draft_is_not_followed(tmp_path):
    target = tmp_path / "passwords.yaml"
    target.write_text("secret")
    (tmp_path / f"{FILE}.new").symlink_to(target)
    with pytest.raises(NotPaired):
        open_sessions(tmp_path, pytest.fail).add(UTC, GRANT, "Anna", "iPhone")
    assert target.read_text() == "secret"
