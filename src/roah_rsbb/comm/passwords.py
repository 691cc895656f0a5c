"""A team's own password, for programs of the team."""

import os
import shlex
from typing import Callable, Optional

from roah_rsbb.ground import linux

PASSWORD_VARIABLE = "ROAH_RSBB_KEY"
"""The environment variable that holds a team's password."""


def _as_typed(text: str) -> str:
    """Decode an argument or a variable as UTF-8, which keys are made of (docs/protocol.md, "Key").

    Python decodes them by the locale, and a terminal may send UTF-8 in a locale that is ASCII or Latin-1.
    """
    try:
        return os.fsencode(text).decode("utf-8")
    except UnicodeError:
        return text


def own_password(password: Optional[str], file: Optional[str]) -> Optional[str]:
    """Find a team's password: the argument, the first line of `file`, or the environment; None if there is none.

    Raises ValueError, which names the file, if it cannot be read.
    """
    if password is None and file is None:
        password = os.environ.get(PASSWORD_VARIABLE)
    if password is not None:
        return _as_typed(password)
    if file is None:
        return None
    try:
        with open(file, encoding="utf-8") as opened:
            return opened.readline().rstrip("\r\n")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise ValueError(f"cannot read the password file {file}: {reason}") from None


def password_in(file: str, on_warning: Callable[[str], object]) -> str:
    """Read a team's password from the first line of a file, for a node (parameter rsbb_key_file).

    `on_warning` is called with what is wrong with the file's rights. Raises ValueError, which names the file.
    """
    password = own_password(None, file)
    if not password:
        raise ValueError(f"parameter rsbb_key_file: the first line of {file} is empty, expected the password")
    mode = linux.open_to_others(file)
    if mode:
        on_warning(f"Other users of this computer can read the password in {file} (mode {mode:04o}): chmod 600 "
                   f"{shlex.quote(file)}")
    return password
