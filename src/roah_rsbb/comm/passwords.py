"""Reads passwords without ROS and without a YAML library: one team's password, or those of all teams.

The box's passwords file is YAML (`config/passwords.yaml`). This module reads the necessary part of YAML: a line
'team: password' for each team, comments, plain and quoted texts. It rejects everything that YAML could interpret
differently, so that a file means the same here and in the box.
"""

import os
import re
from typing import Dict, List, Optional, Tuple

PASSWORD_VARIABLE = "ROAH_RSBB_KEY"
"""The environment variable that holds a team's password."""

_LINE = "a line 'team: password', not indented"
_QUOTES = "quotes around it"
# Words separated by blanks. No word begins with '#' or ends with a colon, and the first one does not begin with a
# character that has a meaning in YAML. Each character matches in one place only, which avoids backtracking.
_FIRST, _FURTHER = r"(?:[^\s:#]|:(?=\S))", r"(?:[^\s:]|:(?=\S))"
_PLAIN = re.compile(rf"""(?![-+.?,\[\]{{}}&*!|>'"%@`~=<:]){_FIRST}{_FURTHER}*(?: +{_FIRST}{_FURTHER}*)*""")
_SINGLE = re.compile(r"'((?:[^']|'')*)'")
_DOUBLE = re.compile(r'"((?:[^"\\]|\\["\\])*)"')
# The beginning of a YAML document, after comments only.
_BEGINNING = re.compile(r"\A((?: *(?:#.*)?\n)*)--- *(?:\n|$)")
# Everything that YAML could read as a number, date, boolean or null.
_NO_TEXT = re.compile(r"[0-9][-+.:_0-9eETtZz ]*|0[bx][0-9a-fA-F_]*|(?i:y|n|yes|no|true|false|on|off|null)")


class BadPasswords(Exception):
    """The file cannot be read. The text has all errors with their lines, but no password."""


class _Wrong(Exception):
    """What is wrong with a line, and what was expected."""


def own_password(password: Optional[str], file: Optional[str]) -> Optional[str]:
    """Find a team's password: the argument, the first line of `file`, or the environment; None if there is none.

    Raises ValueError, which names the file, if it cannot be read.
    """
    if password is not None:
        return password
    if file is None:
        return os.environ.get(PASSWORD_VARIABLE)
    try:
        with open(file, encoding="utf-8") as opened:
            return opened.readline().rstrip("\r\n")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise ValueError(f"cannot read --password-file {file}: {reason}") from None


def read_passwords(path: str) -> Dict[str, str]:
    """Read the passwords by team; BadPasswords for an invalid file."""
    try:
        with open(path, encoding="utf-8-sig") as file:
            text = file.read()
    except OSError as error:
        raise BadPasswords(f"cannot read {path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise BadPasswords(f"cannot read {path}: it is not UTF-8 text: save it as UTF-8") from None
    return parse_passwords(text, path)


def parse_passwords(text: str, name: str) -> Dict[str, str]:
    """Read the passwords by team in the text of a file; `name` appears in errors."""
    passwords: Dict[str, str] = {}
    errors: List[str] = []
    for number, line in enumerate(_BEGINNING.sub(r"\1\n", text).split("\n"), 1):
        try:
            found = _team_line(line)
            if found is not None and found[0] in passwords:
                raise _Wrong("a second line for the same team; expected one line for each team")
        except _Wrong as wrong:
            errors.append(f"{name}:{number}: found {wrong}")
            continue
        if found is not None:
            passwords[found[0]] = found[1]
    if errors:
        raise BadPasswords("\n".join(errors))
    if not passwords:
        raise BadPasswords(f"{name}:1: found no teams; expected {_LINE}")
    return passwords


def _team_line(line: str) -> Optional[Tuple[str, str]]:
    """Read team and password of a line; None for an empty line or a comment."""
    comment = not line.strip(" ") or line.lstrip(" ").startswith("#")
    # Also in comments: for YAML, some of these characters end the line, and others are errors.
    if not (line.replace("\t", " ") if comment else line).isprintable():
        raise _Wrong("a tab or another invisible character; expected blanks only")
    if comment:
        return None
    if line.startswith(" "):
        raise _Wrong(f"an indented line; expected {_LINE}")
    team, rest = _text(line, "the team's name")
    colon = re.match(r" *:(?: +|$)", rest)
    if colon is None:
        raise _Wrong(f"no colon with a blank after the team's name; expected {_LINE}")
    password, rest = _text(rest[colon.end():], "the password")
    if not re.fullmatch(r" *| +#.*", rest):
        raise _Wrong(f"something after the password; expected {_QUOTES}, where it belongs to the password")
    return team, password


def _text(line: str, what: str) -> Tuple[str, str]:
    """Read the text at the beginning of `line`; returns it and the rest."""
    if not line or line.startswith("#"):
        raise _Wrong(f"nothing as {what}; expected a text")
    for pattern, escaped, meant in ((_SINGLE, "''", "'"), (_DOUBLE, r"\\(.)", r"\1")):
        found = pattern.match(line)
        if found:
            text = re.sub(escaped, meant, found.group(1))
            if not text or text != text.strip():
                raise _Wrong(f"{what} empty, or with a blank at an end; expected a text")
            return text, line[found.end():]
    found = _PLAIN.match(line)
    if found is None:
        raise _Wrong(f"{what} beginning with a character that has a meaning in YAML; expected {_QUOTES}")
    if _NO_TEXT.fullmatch(found.group()):
        raise _Wrong(f"{what} that YAML takes for a number, a date or a yes or no; expected {_QUOTES}")
    return found.group(), line[found.end():]
