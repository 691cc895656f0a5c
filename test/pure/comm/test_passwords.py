"""Passwords without a YAML library: what is read says the same to YAML, and what is refused is told by line."""

import contextlib
import time

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from helpers.config_files import SHIPPED
from helpers.examples import examples
from roah_rsbb.comm.passwords import BadPasswords, own_password, parse_passwords, read_passwords
from roah_rsbb.rulebook.config import PasswordsFile
from roah_rsbb.rulebook.errors import Report


def test_the_shipped_file_says_the_same_here_and_to_the_box():
    path = str(SHIPPED / "passwords.yaml")
    passwords = read_passwords(path)
    assert passwords["TestingTeam"] == "PASSWORD" and len(passwords) > 3
    assert passwords == PasswordsFile(path, Report()).by_team


@pytest.mark.parametrize("line, password", [
    ("T: abc", "abc"),
    ("T : abc  # theirs", "abc"),
    ("'T': 'a''b: # c'", "a'b: # c"),
    (r'"T": "a\"b\\c: # d" # e', r'a"b\c: # d'),
    ("T: \"123\"", "123"),
    ("T: 't9Kd2wQx'   ", "t9Kd2wQx"),
    ("T: a#b:c", "a#b:c"),
    ("T: correct horse battery", "correct horse battery"),
    ("T: Käse ohne Löcher", "Käse ohne Löcher"),
    ("T: 12ab", "12ab"),
    ("T: 1,5x", "1,5x"),
])
def test_a_password(line, password):
    assert parse_passwords(line, "f") == yaml.safe_load(line) == {"T": password}


@pytest.mark.parametrize("before", ["", "---\n", "# teams\n\n---\n", "\n  # a\tb\n--- \n"])
@pytest.mark.parametrize("end", ["\n", "", "\n\n# end"])
def test_comments_and_a_documents_beginning_are_no_teams(before, end):
    assert parse_passwords(before + "# a: b\nT: abc\n\nU: def" + end, "f") == {"T": "abc", "U": "def"}


@pytest.mark.parametrize("line, found", [
    ("T: 123", "takes for a number"),
    ("T: 1_000", "takes for a number"),
    ("T: 0x1F", "takes for a number"),
    ("T: 1:30", "takes for a number"),
    ("T: .5e3", "a character that has a meaning"),
    ("T: 2015-12-31", "a date"),
    ("T: yes", "a yes or no"),
    ("T: Null", "a yes or no"),
    ("T: y", "a yes or no"),
    ("1: abc", "the team's name that YAML takes"),
    ("T:", "nothing as the password"),
    ("T: # later", "nothing as the password"),
    ("T: ''", "the password empty"),
    ("T: ' a'", "a blank at an end"),
    ("T:abc", "no colon with a blank after the team's name"),
    ("T", "no colon with a blank after the team's name"),
    ("  T: abc", "an indented line"),
    ("T:\tabc", "a tab"),
    ("\tT: abc", "a tab"),
    ("T: a\u2028b", "invisible"),
    ("# a\u0085b: abc", "invisible"),
    ("  # a\u2028b: abc", "invisible"),
    ("# a\x07", "invisible"),
    ("T: a: b", "something after the password"),
    ("T: 'a' b", "something after the password"),
    ("T: 'a'#b", "something after the password"),
    ("T: 'abc", "a character that has a meaning"),
    (r'T: "a\n"', "a character that has a meaning"),
    ("T: @abc", "a character that has a meaning"),
    ("T: [abc]", "a character that has a meaning"),
    ("- T: abc", "the team's name beginning with a character"),
    ("U: abc", "a second line for the same team"),
])
def test_what_is_refused_is_told_with_its_line_and_without_the_password(line, found):
    with pytest.raises(BadPasswords) as refused:
        parse_passwords("# teams\nU: secret\n" + line + "\n", "dir/f.yaml")
    text = str(refused.value)
    assert text.startswith("dir/f.yaml:3: found ") and found in text and "; expected " in text
    assert "abc" not in text and "123" not in text and "\n" not in text


def test_all_errors_are_told_at_once():
    with pytest.raises(BadPasswords) as refused:
        parse_passwords("A: 1\nB: b\nC\n", "f")
    assert [text.split(" ")[0] for text in str(refused.value).splitlines()] == ["f:1:", "f:3:"]


@pytest.mark.parametrize("text", ["", "\n", "# nobody\n", "---\n"])
def test_a_file_without_teams_is_refused(text):
    with pytest.raises(BadPasswords, match="no teams"):
        parse_passwords(text, "f")


WORDS = [
    "true", "No", "on", "y", "~", "null", ".inf", "-.Inf", "+.INF", ".nan", "1e3", "1.5e+3", "1.", ".5", "+1", "0b1",
    "0o7", "0x1F", "0x_", "1_2_3", "12:30:45", "190:20:30", "2001-01-01", "2001-1-1T1:1:1Z", "2001-01-01 10:00:00 +1",
    "<<", "=", "...", "... a", "---", "--- a", "a:: b", "a ::b", "a :b", "a: ", "a #b", "a# b", "?a", "? a", ":a",
]
TRICKY = st.text(st.sampled_from("ab1.-+:_ #'\"\\,[]{}&*!|>%@`~=<?/yTnN\t\n\u00e9\u0085"), max_size=8)


def _read_or_refused(text):
    """Whatever is read says the same to YAML."""
    try:
        passwords = parse_passwords(text, "f")
    except BadPasswords:
        return
    assert yaml.safe_load(text) == passwords


@pytest.mark.parametrize("line", ["{}: a\n", "{} : a\n", "T: {}\n", "T: a {}\n", "T: {} # c\n", "T: 'a'{}\n"])
def test_a_word_that_yaml_could_take_for_something_else(line):
    for word in WORDS:
        _read_or_refused(line.format(word))


@examples(300)
@given(st.lists(st.tuples(TRICKY, st.sampled_from([": ", ":", " : "]), TRICKY), min_size=1, max_size=2))
def test_whatever_is_read_says_the_same_to_yaml(lines):
    _read_or_refused("".join(team + colon + password + "\n" for team, colon, password in lines))


@pytest.mark.parametrize("line", [
    "a" + " " * 100000 + "x", "T: " + "1" * 100000 + "x", "T: " + "1_" * 50000 + "x", "T: " + "1:1" * 30000 + "x",
    "T: " + "a " * 50000 + ":", "T: 0x" + "_" * 100000 + "x", "T: '" + "''" * 50000, "#\n" * 50000 + "x",
], ids=lambda line: line[:8].encode("unicode_escape").decode())
def test_no_line_takes_long(line):
    begin = time.process_time()
    with contextlib.suppress(BadPasswords):
        parse_passwords(line, "f")
    assert time.process_time() - begin < 1.0  # going back and forth, any of them takes more than ten seconds


def test_a_file_that_cannot_be_read(tmp_path):
    with pytest.raises(BadPasswords, match="No such file"):
        read_passwords(str(tmp_path / "none"))
    (tmp_path / "latin").write_bytes("T: Käse".encode("latin-1"))
    with pytest.raises(BadPasswords, match="UTF-8"):
        read_passwords(str(tmp_path / "latin"))


def test_a_file_that_another_system_wrote(tmp_path):
    (tmp_path / "f").write_bytes("\ufeffT: a\r\nU: b\r\n".encode())
    assert read_passwords(str(tmp_path / "f")) == {"T": "a", "U": "b"}


def test_ones_own_password(tmp_path, monkeypatch):
    monkeypatch.delenv("ROAH_RSBB_KEY", raising=False)
    assert own_password(None, None) is None
    monkeypatch.setenv("ROAH_RSBB_KEY", "e")
    assert own_password(None, None) == "e"
    (tmp_path / "f").write_text("p q\nx\n", encoding="utf-8")
    assert own_password(None, str(tmp_path / "f")) == "p q"
    assert own_password("o", None) == "o"
    with pytest.raises(ValueError, match="No such file"):
        own_password(None, str(tmp_path / "none"))
