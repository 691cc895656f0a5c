"""Errors of a file as a whole, and errors that are omitted because they follow from others."""

import os

import pytest

from helpers.config_files import TEXTS, changed, line_of
from roah_rsbb.rulebook import config, errors
from roah_rsbb.rulebook.errors import MAX_ERRORS

SYNTAX = [
    # (old, new, what the line with the error contains, parts of the message)
    ("  code: HWV", "\tcode: HWV", "\tcode: HWV", ["found a tab;", "expected spaces"]),
    ("code: HWV", "code:\tHWV", "code:\tHWV", ["found a tab;"]),
    ("name: Task Benchmark 2", "name: Task: 2", "Task: 2", ["a second ': ' on the line", "quotes"]),
    ("name: Task Benchmark 2", "name:Task 2", "Welcoming", ["a ': ' that cannot stand here", "a space after it"]),
    ("  code: HWV", "   code: HWV", "code: HWV", ["a ': ' that cannot stand here", "indented deeper"]),
    ("  code: HWV", " code: HWV", "code: HWV", ["does not continue what stands above", "under each other"]),
    ("  code: HWV", "  code:HWV", "code:HWV", ["a line without 'key: value'", "a colon and a space"]),
    ("code: HWV", "code: - HWV", "- HWV", ["a '- ' that cannot stand here"]),
    ("code: HWV", "code: ? HWV", "? HWV", ["a '? ' in the middle of a line"]),
    ("code: HWV", "code: @HWV", "@HWV", ["begins with a character that has a meaning", "quotes"]),
    ("code: HWV", "code: ,HWV", ",HWV", ["a comma, a bracket or another sign", "quotes"]),
    ("code: HWV", "code: *HWV", "*HWV", ["an alias", "quotes"]),
    ("timeout: 600", "*timeout : 600", "*timeout", ["an alias"]),
    ("code: HWV", "code: * HWV", "* HWV", ["begins with a character that has a meaning"]),
    ("code: HWV", "code: &a HWV", "&a HWV", ["an anchor", "quotes"]),
    ("code: HWV", "code: !a HWV", "!a HWV", ["a tag", "quotes"]),
    ("code: HWV", "code: !x!a HWV", "!x!a HWV", ["begins with a character that has a meaning"]),
    ("code: HWV", "code: !!python/object/apply:os.getcwd []", "getcwd", ["a tag"]),
    ("code: HWV", "code: >HWV", ">HWV", ["begins with a character that has a meaning", "quotes"]),
    ("- name: Task Benchmark 2", "- <<: *base", "*base", ["an alias"]),
    ("- name: Task Benchmark 2", "%name\n- name: Task 2", "name: Task 2", ["a '- ' that cannot"]),
    ("name: Task Benchmark 2", "name: 'Granny's'", "Granny's", ["text after a closing quote", "Granny''s"]),
    ("name: Task Benchmark 2", "name: 'Task", "name: 'Task", ["a quote that is opened here", "a quote at the"]),
    ("name: Task Benchmark 2", 'name: "C:\\Users"', "Users", ["a backslash in double quotes", "single quotes"]),
    ("desc: Welcoming visitors", "desc: [Welcoming", "[Welcoming", ["a '[' without its ']'"]),
    ("changed object }", "changed object", "changed object", ["a '{' without its '}'"]),
    ("{ type: bool, desc", "{ type: bool desc", "bool desc", ["a '{' without its '}', or a comma missing"]),
    ("changed object }", "changed object }}", "object }}", ["a '}' without its '{'"]),
    ("changed object }", "changed object } ]", "object } ]", ["a ']' without its '['"]),
    ("{ type: bool, desc", "{ type: bool, , desc", "bool, , desc", ["a comma, a bracket or another sign"]),
    ("    - Achievements:\n", "    - *a\n    - Achievements:\n", "- *a", ["an alias"]),
    ("- name: Task Benchmark 2", "---\n- name: Task 2", "---", ["a second document"]),
    ("Granny", "Gra\x07nny", "Gra", ["a control character"]),
    ("- name: Task Benchmark 2", "<<<<<<< HEAD\n- name: Task 2", "<<<<", ["a line without 'key: value'"]),
]


@pytest.mark.parametrize("old, new, marker, parts", SYNTAX, ids=[repr(new)[:30] for _, new, _, _ in SYNTAX])
def test_a_syntax_error_is_one_error_where_the_mistake_is(files, old, new, marker, parts):
    text = changed("benchmarks", old, new)
    name, line, message = files.error(benchmarks=text)
    assert name == "benchmarks"
    assert marker in text.splitlines()[line - 1], (line, message)
    assert [part for part in parts if part not in message] == [], message


def test_other_lines_with_tabs_are_named(files):
    text = TEXTS["benchmarks"].replace("  timeout: 600", "\ttimeout: 600")
    lines = [i for i, content in enumerate(text.splitlines(), 1) if content.startswith("\t")]
    _, line, message = files.error(benchmarks=text)
    assert line == lines[0]
    assert f"(and at the beginning of line {lines[1]} and {lines[2]})" in message


@pytest.mark.parametrize("end", [
    '- name: "Task\n  desc: x\n', "- [a, b,\n", "- {a: b,\n\n", "- {a:", "- [a: [b]", "- [\n"])
def test_a_quote_or_bracket_that_is_never_closed_is_found_where_it_is_opened(files, end):
    text = TEXTS["benchmarks"] + end
    _, line, message = files.error(benchmarks=text)
    assert line == line_of(text, end)
    assert "never closed" in message or "without its" in message


def test_a_syntax_error_stops_only_its_file(files):
    found = files.errors(
        benchmarks=changed("benchmarks", "code: HWV", "code: @"),
        schedule=changed("schedule", "round: 1", "round: 0"),
        passwords=changed("passwords", "PASSWORD", "1234"),
    )
    assert [(name, line > 0) for name, line, _ in found] == [
        ("benchmarks", True),
        ("passwords", True),
        ("schedule", True),
    ]


@pytest.mark.parametrize(
    "broken",
    [
        {"benchmarks": "- name: @"},
        {"benchmarks": "a: b"},
        {"benchmarks": None},
        {"benchmarks": changed("benchmarks", "code: HWV", "code: HXY")},
        {"benchmarks": changed("benchmarks", "  code: HWV\n", "")},
        {"benchmarks": changed("benchmarks", "code: HWV", "code: *HWV")},
        {"passwords": "a: @"},
        {"passwords": "- a"},
        {"passwords": None},
        {"passwords": "*a"},
        {"passwords": changed("passwords", "TestingTeam:", "TestingTeam:x:")},
        {"schedule": "@"},
    ],
)
def test_what_follows_from_an_error_in_another_file_is_left_out(files, broken):
    name, _, _ = files.error(**broken)
    assert [name] == list(broken)


def test_also_with_a_broken_benchmarks_file_codes_are_checked(files):
    found = files.errors(benchmarks="@", schedule=changed("schedule", "HWV", "HVW"))
    assert [name for name, _, _ in found] == ["benchmarks", "schedule"]


@pytest.mark.parametrize(
    "text, what",
    [
        ("", "an empty file"),
        ("\n\n", "an empty file"),
        ("\ufeff", "an empty file"),
        ("# only\n", "nothing but comments"),
    ],
)
def test_an_empty_file(files, text, what):
    found = files.errors(benchmarks=text, schedule=text, passwords=text)
    assert [(name, line) for name, line, _ in found] == [("benchmarks", 1), ("passwords", 1), ("schedule", 1)]
    for (_, _, message), shape in zip(found, ("- name: ...", "team: password", "- zone: ...")):
        assert what in message and shape in message


@pytest.mark.parametrize("text", ["a: b", "7", "[]", "~"])
def test_not_a_sequence(files, text):
    found = files.errors(benchmarks=text, schedule=text)
    assert [line for _, line, _ in found] == [1, 1]
    assert all("as the file's content; expected a sequence of" in message for _, _, message in found)


def test_missing_files_name_the_parameter_and_a_neighbour(files):
    files.load()
    os.rename(files.file("schedule"), files.path / "schedules.yaml")
    found = files.errors(schedule=None)
    assert [(name, line) for name, line, _ in found] == [("schedule", 0)]
    message = found[0][2]
    assert "parameter schedule_file" in message and "did you mean 'schedules.yaml' there?" in message
    with pytest.raises(config.ConfigErrors) as caught:
        config.load("/nowhere/b.yaml", "", "a\0b")
    parts = ("there is no directory '/nowhere'", "something that cannot be read", "an empty file name")
    assert [part for part in parts if part not in str(caught.value)] == []


def test_files_that_cannot_be_read(files, monkeypatch):
    files.load()
    os.unlink(files.file("benchmarks"))
    os.mkdir(files.file("benchmarks"))
    os.unlink(files.file("schedule"))
    os.mkfifo(files.file("schedule"))  # opening it would wait for a writer

    def refuse(path, *_):
        raise PermissionError(13, "Permission denied", path)

    monkeypatch.setattr("builtins.open", refuse)
    with pytest.raises(config.ConfigErrors) as caught:
        config.load(*(files.file(name) for name in ("benchmarks", "schedule", "passwords")))
    messages = [str(error) for error in caught.value.errors]
    assert ["a directory or a device" in message for message in messages] == [True, False, True]
    assert "may not read" in messages[1] and "chmod" in messages[1]


@pytest.mark.long
def test_a_file_that_is_too_large(files):
    assert files.errors(benchmarks="#" * errors.MAX_BYTES)[0][2].startswith("found nothing but comments")
    name, line, message = files.error(benchmarks="#" * (errors.MAX_BYTES + 1))
    assert (name, line) == ("benchmarks", 0)
    assert "more than 1000 kB" in message


@pytest.mark.parametrize(
    "data, line, part",
    [
        (TEXTS["benchmarks"].encode("latin-1"), line_of(TEXTS["benchmarks"], "ä"), "not UTF-8"),
        (b"\xff", 1, "not UTF-8"),
        (TEXTS["benchmarks"].encode("utf-16"), 1, "UTF-16"), (TEXTS["benchmarks"].encode("utf-32"), 1, "UTF-32"),
    ],
)
def test_other_encodings(files, data, line, part):
    found = files.error(benchmarks=data)
    assert found[:2] == ("benchmarks", line)
    assert part in found[2] and "save as" in found[2]


def test_windows_line_ends_and_byte_order_mark(files):
    windows = {name: b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode() for name, text in TEXTS.items()}
    assert files.load(**windows)[0] == files.load(**TEXTS)[0]
    windows["schedule"] = windows["schedule"].replace(b"HWV", b"HVW", 1)
    assert files.error(**windows)[1] == line_of(TEXTS["schedule"], "HWV")


def test_lines_are_counted_as_editors_do(files):
    """PyYAML takes U+2028 for a line's end, an editor does not."""
    text = changed("benchmarks", "# The", "# \u2028# The").replace("HWV", "HVW")
    assert files.error(benchmarks=text)[1] == line_of(text, "code: HVW")


STAIRS = "".join("  " * i + "a:\n" for i in range(99))


@pytest.mark.parametrize("text", ["[" * 5000, "{a: " * 5000, "- " * 300 + "a", STAIRS])
def test_deep_nesting(files, text):
    _, _, message = files.error(benchmarks=text)
    assert "20 levels of nesting" in message


def test_a_billion_laughs(files):
    bomb = "a: &a [x, x]\n" + "".join(f"{b}: &{b} [*{a}, *{a}]\n" for a, b in zip("abcdefgh", "bcdefghi"))
    found = files.errors(benchmarks=bomb)
    assert {line for _, line, _ in found} == set(range(1, 10))


def test_a_report_does_not_grow_without_end(files):
    with pytest.raises(config.ConfigErrors) as caught:
        files.load(benchmarks="- 1\n" * (MAX_ERRORS + 5))
    assert len(caught.value.errors) == MAX_ERRORS
    assert str(caught.value).splitlines()[-1] == "... and perhaps more: reading ended at 1000 errors"


def test_an_error_is_one_line_whatever_is_in_the_file(files):
    text = changed("benchmarks", "code: HWV", 'code: "H\\n\\e[31m' + "x" * 500 + '"')
    _, _, message = files.error(benchmarks=text)
    assert r"'H\n\x1b[31mxxx" in message and len(message) < 300
