"""The folder of the benchmarking modules as one file: a standby needs the rules and parameters of the competition.

They are read once a second, and the file is written again when they have changed. It is one of the files that are
copied beside the journal.
"""

import io
import os
import pathlib
import shutil
import zipfile
from typing import Iterator, Tuple

from roah_rsbb.ground.durable import write_file

# In all. A competition's rules and parameters have some ten kB; a folder with more is another one by mistake.
MAX_BYTES = 10_000_000
# The same content makes the same file.
_MOMENT = (1980, 1, 1, 0, 0, 0)
_NOT_COPIED = (".", "__pycache__")


class TooLarge(Exception):
    """The folder has more than `MAX_BYTES`. The text says what to do."""


class PackedModules:
    """The file of a folder. Call everything in one thread."""

    def __init__(self, folder: str, path: str) -> None:
        """`path`: of the file."""
        self._folder, self._path = pathlib.Path(folder), path
        self._packed: Tuple[object, ...] = ()  # what was packed last

    def look(self) -> None:
        """Write the file if something has changed. Raises OSError or `TooLarge`."""
        found = tuple(self._files())
        if found == self._packed and os.path.exists(self._path):
            return
        if sum(size for _, size, _ in found) > MAX_BYTES:
            raise TooLarge(f"{self._folder} has more than {MAX_BYTES // 1_000_000} MB, so the benchmarking modules are "
                           "not copied to the standby: leave only their rules and parameters there")
        written = io.BytesIO()
        with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as file:
            for name, _, _ in found:
                file.writestr(zipfile.ZipInfo(name, _MOMENT), (self._folder / name).read_bytes())
        write_file(self._path, written.getvalue())
        self._packed = found

    def _files(self) -> Iterator[Tuple[str, int, int]]:
        """Yield the files in the folder and in those of zones: name, size, moment of the last change."""
        for path in sorted(self._folder.rglob("*")):
            name = path.relative_to(self._folder)
            if path.is_file() and not any(part.startswith(_NOT_COPIED) for part in name.parts):
                state = path.stat()
                yield name.as_posix(), state.st_size, state.st_mtime_ns


def unpack(path: str, folder: str) -> bool:
    """Make the folder again, in the place of an earlier one; returns whether there is such a file. Raises OSError, also
    for a file that is damaged."""
    if not os.path.exists(path):
        return False
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    try:
        with zipfile.ZipFile(path) as file:
            if sum(info.file_size for info in file.infolist()) > MAX_BYTES:
                raise OSError(f"{path} is too large")
            file.extractall(folder)  # names that lead out of the folder are kept in it
    except (zipfile.BadZipFile, EOFError, RuntimeError, NotImplementedError) as error:
        raise OSError(f"{path} is damaged ({error})") from None
    return True
