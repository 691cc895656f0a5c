"""Reads the text of files that people write. Each error says what is wrong with the file."""

import contextlib
import os
import stat
from contextvars import ContextVar
from typing import Iterator, Mapping, Optional

from roah_rsbb.rulebook.errors import Place, Report, quote
from roah_rsbb.wording.texts import nearest

# Enough for a schedule of ten thousand runs. PyYAML takes two to six seconds to read this much.
MAX_BYTES = 1_000_000

# What files contained when they were read, by path. They are not read again.
_KNOWN: ContextVar[Mapping[str, str]] = ContextVar("known")

# How files begin that are no text. UTF-32 is before UTF-16, which begins it.
_UTF_8 = "UTF-8: choose this encoding in the editor's 'save as'"
_AS_CSV = "plain text: open it in its program, and save a sheet as CSV (UTF-8)"
_OTHER_FILES = {
    b"\xff\xfe\0\0": ("UTF-32 text", _UTF_8), b"\0\0\xfe\xff": ("UTF-32 text", _UTF_8),
    b"\xff\xfe": ("UTF-16 text", _UTF_8), b"\xfe\xff": ("UTF-16 text", _UTF_8),
    b"PK\3\4": ("a file of a spreadsheet or office program (.xlsx, .ods), or an archive", _AS_CSV),
    b"\xd0\xcf\x11\xe0": ("a file of a spreadsheet or office program (.xls)", _AS_CSV),
}


class CannotRead(Exception):
    """The rest of the file cannot be read, e.g. after a syntax error. Whoever catches it reports it."""

    def __init__(self, place: Place, found: str, expected: str) -> None:
        super().__init__(found)
        self.error = (place, found, expected)


def read_text(path: str, report: Report, what: str) -> Optional[str]:
    """Read the text of a file up to `MAX_BYTES`. Return None after an error."""
    text = _KNOWN.get({}).get(path)
    try:
        return _decode(path, read_bytes(path, what) if text is None else text.encode("utf-8"))
    except CannotRead as error:
        report.error(*error.error)
        return None


@contextlib.contextmanager
def known(texts: Mapping[str, str]) -> Iterator[None]:
    """Let these paths have these texts, whatever is in their files now."""
    token = _KNOWN.set(texts)
    try:
        yield
    finally:
        _KNOWN.reset(token)


def read_bytes(path: str, what: str) -> bytes:
    """Read a file up to `MAX_BYTES`. Raises `CannotRead`."""
    whole = Place(path, 0, 0)
    if not path:
        raise CannotRead(whole, "an empty file name", what)
    try:
        # Opening a pipe or a device could block forever.
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise CannotRead(whole, "a directory or a device", f"a file: {what}")
        with open(path, "rb") as file:
            data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise CannotRead(whole, f"no file {quote(os.path.abspath(path))}", what + _neighbour(path)) from None
    except PermissionError:
        raise CannotRead(whole, "a file that the box may not read", f"{what}; see 'chmod' and 'chown'") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        raise CannotRead(whole, f"something that cannot be read ({error})", f"a readable file: {what}") from None
    if len(data) > MAX_BYTES:
        raise CannotRead(whole, f"more than {MAX_BYTES // 1000} kB", f"{what}, which is much smaller")
    return data


def _neighbour(path: str) -> str:
    """Return the end of the message about a missing file: a similar name in its directory, if there is one."""
    folder, name = os.path.split(os.path.abspath(path))
    try:
        near = nearest(name, os.listdir(folder))
    except OSError:
        return f"; there is no directory {quote(folder)} either"
    return f": did you mean {quote(near)} there?" if near else ""


def _decode(path: str, data: bytes) -> str:
    for begin, (found, expected) in _OTHER_FILES.items():
        if data.startswith(begin):
            raise CannotRead(Place(path, 1, 1), found, expected)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        place = Place(path, before.count(b"\n") + 1, error.start - before.rfind(b"\n"))
        raise CannotRead(place, "a character that is not UTF-8", _UTF_8) from None
