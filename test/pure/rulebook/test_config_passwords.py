"""Errors of the passwords file, and that no message ever shows a password."""

import pytest

from helpers.config_files import TEXTS, changed, line_of

LINE_TEXT = "TestingTeam: PASSWORD"
LINE = line_of(TEXTS["passwords"], LINE_TEXT)
QUOTES = "quotes around a text that begins with"

# The line that stands there instead, parts of the message, lines further down.
MISTAKES = [
    ("TestingTeam: 123456", ["a number of 6 characters as password; expected a text: put it in quotes"], 0),
    ("TestingTeam: 0x5EC2E7", ["a number of 8 characters as password", "put it in quotes"], 0),
    ("TestingTeam: yes", ["a yes-or-no value of 3 characters as password", "put it in quotes"], 0),
    ("TestingTeam: 2015-12-31", ["a date of 10 characters as password", "put it in quotes"], 0),
    ("TestingTeam:", ["nothing as password; expected a text that is not empty"], 0),
    ("TestingTeam: ''", ["an empty text as password"], 0),
    ("TestingTeam: ' S3CRET'", ["a text of 7 characters as password", "neither begins nor ends with a space"], 0),
    ("TestingTeam: [S3CRET]", ["a sequence", "as password", "needs quotes"], 0),
    ("TestingTeam: {S3CRET: x}", ["a map", "as password", "needs quotes"], 0),
    ("TestingTeam: {S3CRET", ["a '{' without its '}'"], 0),
    ("TestingTeam: *S3CRET", ["a '*', which in YAML begins an alias"], 0),
    ("TestingTeam: &S3CRET", ["a '&', which in YAML begins an anchor"], 0),
    ("TestingTeam: !S3CRET", ["a '!', which in YAML begins a tag"], 0),
    ("TestingTeam: !!python/name:os.S3CRET", ["a '!', which in YAML begins a tag"], 0),
    ("TestingTeam: @S3CRET", [QUOTES], 0),
    ("TestingTeam: %S3CRET", [QUOTES], 0),
    ("TestingTeam: |S3CRET", [QUOTES], 0),
    ("TestingTeam: S3: CRET", ["a second ': ' on the line"], 0),
    ("TestingTeam: 'S3'CRET", ["text after a closing quote"], 0),
    ("TestingTeam: 'S3CRET", ["a quote that is opened here", "closed"], 0),
    (r'TestingTeam: "S3\CRET"', ["a backslash in double quotes"], 0),
    (r'TestingTeam: "S3\ud800CRET"', ["an escape", "not a character"], 0),
    (r'TestingTeam: "S3\U00110000CRET"', ["an escape", "plain text"], 0),
    ("TestingTeam: |\n  S3CRET", ["a text of 7 characters as password", "a text of one line"], 0),
    ("TestingTeam:\tS3CRET", ["a tab"], 0),
    ("TestingTeam:S3CRET", ["the one above is not 'key: value'"], 1),
    ("TestingTeam = S3CRET", ["the one above is not 'key: value'"], 1),
    ("TestingTeam S3CRET:", ["nothing as password"], 0),
    ("TestingTeam:S3CRET: x", ["a colon in a team's name", "a space after the colon"], 0),
    ("DumpTeam: S3CRET", ["the same key again; expected each key once: it is already in line"], 2),
    ("ALL: S3CRET", ["ALL as team's name", "all robots"], 0),
    ("'': S3CRET", ["an empty text as team's name"], 0),
    ("? [S3CRET]\n: x", ["a map or a sequence as key"], 0),
    ("x" * 101 + ": S3CRET", ["101 characters as team's name", "at most 100 bytes; it has 101"], 0),
    ("ö" * 51 + ": S3CRET", ["51 characters as team's name", "at most 100 bytes; it has 102"], 0),
]


@pytest.mark.parametrize("new, parts, further", MISTAKES, ids=[new[:30] for new, _, _ in MISTAKES])
def test_one_mistake_is_one_error_without_the_password(files, new, parts, further):
    text = changed("passwords", LINE_TEXT, new)
    name, line, message = files.error(passwords=text)
    assert (name, line) == ("passwords", LINE + further)
    assert [part for part in parts if part not in message] == [], message
    for secret in ("S3", "CRET", "5EC2", "123456", "2015", "x" * 20, "ö" * 20):
        assert secret not in message
    assert files.file("passwords") not in message


@pytest.mark.parametrize(
    "text, found",
    [
        ("S3CRET", "a text of 6 characters as the file's content"),
        ("- S3CRET: S3CRET", "a sequence"),
        ("{}", "no teams"),
        ("# TestingTeam: S3CRET", "nothing but comments"),
        ("", "an empty file"),
        ("&S3CRET {TestingTeam: S3CRET}", "a '&'"),
    ],
)
def test_something_else_than_lines_of_teams(files, text, found):
    name, line, message = files.error(passwords=text)
    assert (name, line) == ("passwords", 1)
    assert found in message and "S3CRET" not in message


def test_the_error_about_a_wrong_team_names_no_other_teams(files):
    """If team and password were swapped, the list of teams would show passwords."""
    swapped = "".join(f"S3CRET{i}: {team}\n" for i, team in enumerate(("TestingTeam", "HomeAlone")))
    messages = [message for _, _, message in files.errors(passwords=swapped)]
    assert messages and not any("S3CRET" in message for message in messages)


def test_a_quoted_number_and_a_name_of_100_bytes_are_right(files):
    text = changed("passwords", LINE_TEXT, LINE_TEXT + "\n" + "ö" * 50 + ": '123456'")
    assert files.load(passwords=text)[0].passwords["ö" * 50] == "123456"


def test_a_team_without_password_is_named_in_the_schedule(files):
    name, line, message = files.error(passwords=changed("passwords", LINE_TEXT, "OtherTeam: S3CRET"))
    assert (name, line) == ("schedule", line_of(TEXTS["schedule"], "team: TestingTeam"))
    assert "team 'TestingTeam' (also in line" in message and "which is not in" in message
