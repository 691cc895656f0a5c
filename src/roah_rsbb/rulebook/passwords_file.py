"""The passwords file: each team's password, which no message ever shows."""

import os
import shlex
import stat
from typing import Dict, Optional, Set

from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.rulebook.errors import Place, Report
from roah_rsbb.rulebook.yaml_fields import describe, text
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, Unusable, read_yaml

# Names travel in the beacon, which must fit in one datagram (docs/protocol.md, "Frame").
MAX_TEAM_BYTES = 100

_SHAPE = "a line 'team: password' for each team"


class PasswordsFile:
    """Passwords by team, and the teams that the file means to list.

    `teams` includes those of lines with errors; None: they cannot be known, the file or the name of a
    team being unreadable.
    """

    def __init__(self, path: str, report: Report) -> None:
        self.path = path
        self.by_team: Dict[str, str] = {}
        self.teams: Optional[Set[str]] = None
        self._report = report
        what = "the passwords file (parameter passwords_file)"
        root = read_yaml(path, report, what, _SHAPE, secret=True)
        self._warn_if_readable(path)
        if root is None or isinstance(root, Unusable):
            return
        if not isinstance(root, Mapping):
            report.error(root.place, f"{describe(root)} as the file's content", _SHAPE)
            return
        if not root.pairs and root.whole:
            report.error(root.place, "no teams", _SHAPE)
        readable = [self._line(key, value) for key, value in root.pairs]
        if root.whole and readable and all(readable):
            self.teams = {key.text for key, _ in root.pairs}

    def _line(self, key: Scalar, value: Node) -> bool:
        """Read one team's line; return whether it is sure which team is meant.

        The name is not shown in errors: where a colon or a blank is missing it holds the password.
        """
        if ":" in key.text:
            expected = "'team: password' with a blank after the colon"
            self._report.error(key.place, "a colon in a team's name", expected)
            return False
        team = text(self._report, key, "team's name", MAX_TEAM_BYTES)
        if team == ALL_TEAMS:
            found = f"{ALL_TEAMS} as team's name"
            self._report.error(key.place, found, f"another name: in the schedule, {ALL_TEAMS} means all robots")
        password = text(self._report, value, "password")
        if team is not None and password is not None:
            self.by_team[team] = password
        # "Team password:" has no value.
        return team not in (None, ALL_TEAMS) and not (isinstance(value, Scalar) and not value.text)

    def _warn_if_readable(self, path: str) -> None:
        try:
            mode = stat.S_IMODE(os.stat(path).st_mode)
        except (OSError, ValueError):
            return  # reported when it was read
        if mode & (stat.S_IRGRP | stat.S_IROTH):
            remedy = f"chmod 600 {shlex.quote(path)}"
            self._report.warn(
                Place(path, 0, 0),
                f"other users of this computer can read the passwords (mode {mode:04o}); remedy: {remedy}",
            )
