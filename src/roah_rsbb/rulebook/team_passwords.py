"""The passwords of teams, as files have them."""

import secrets
import string
from typing import Dict, List

from roah_rsbb.model.reason import Refused, say
from roah_rsbb.rulebook.config import PasswordsFile
from roah_rsbb.rulebook.errors import Report, known
from roah_rsbb.rulebook.schedule_text import yaml_text

# Without letters that look alike on paper.
_LETTERS = "".join(c for c in string.ascii_letters if c not in "lIoO")
_FURTHER = _LETTERS + "23456789"
_PASSWORD_LENGTH = 16
NO_NAME = say("'{team}' cannot be added to {path}: it is no name of a team, or the file does not end with a line "
              "'team: password'")
NOT_READ = say("{path} cannot be read: {error}")


def new_password() -> str:
    """Generate a random password that needs no quotes in YAML, shells and launch files."""
    return secrets.choice(_LETTERS) + "".join(secrets.choice(_FURTHER) for _ in range(_PASSWORD_LENGTH - 1))


def lines_of(passwords: Dict[str, str]) -> List[str]:
    """The line of each team."""
    return [f"{yaml_text(team)}: {yaml_text(password)}" for team, password in passwords.items()]


def with_team(path: str, team: str) -> str:
    """Return the text of a passwords file with a line for a team, which has a new password unless it has one. Raises
    `Refused`."""
    try:
        with open(path, encoding="utf-8") as file:
            text = file.read()
    except (OSError, UnicodeDecodeError) as error:
        raise Refused([NOT_READ(path=path, error=error)]) from None
    if team in PasswordsFile(path, Report()).by_team:
        return text
    text = text if text.endswith("\n") else f"{text}\n"
    added = f"{text}{lines_of({team: new_password()})[0]}\n"
    report = Report()
    with known({path: added}):
        if team not in PasswordsFile(path, report).by_team or report.errors:
            raise Refused([NO_NAME(path=path, team=team)])
    return added
