"""Files that survive a power failure: whole or unchanged, and on the disk when the function returns."""

import contextlib
import errno
import os
import shutil
import stat

# Only the owner may read the file.
PRIVATE = 0o600
# As the user's umask says.
USUAL = 0o666
SPACE_BYTES = 1 << 19
KEPT = 9  # versions of a file that was replaced
# Others may not read the files of log_dir; its group may.
_UMASK = 0o027


def close_to_others() -> None:
    """Let no new file or folder of this process be open to users outside its group."""
    os.umask(os.umask(_UMASK) | _UMASK)


def write_file(path: str, content: bytes, mode: int = PRIVATE) -> None:
    """Write a file whole or not at all. Raises OSError, also if its draft is a link; the old file then stays."""
    draft = f"{path}.new"
    if not os.path.islink(draft):
        with contextlib.suppress(FileNotFoundError):
            os.unlink(draft)  # it may have other permissions
    with open(os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(draft, path)
    sync(os.path.dirname(path) or ".")


def replace_keeping(path: str, content: bytes, versions: int = KEPT) -> bool:
    """Write a file as `write_file` does, with the permissions that it has, and keep so many versions before: beside
    it, with ~, ~2 and so on behind the name. Returns whether it was another one. Raises OSError."""
    with open(path, "rb") as file:
        before, mode = file.read(), stat.S_IMODE(os.fstat(file.fileno()).st_mode)
    if before == content:
        return False
    for number in range(versions - 1, 0, -1):
        with contextlib.suppress(FileNotFoundError):
            os.replace(f"{path}~{number if number > 1 else ''}", f"{path}~{number + 1}")
    if versions:
        write_file(f"{path}~", before, mode)
    write_file(path, content, mode)
    return True


def has_space(folder: str, size: int = 0) -> bool:
    """Whether the disk of a folder has space for so many bytes, and then for small files and the beginning of a segment
    of the journal."""
    try:
        return shutil.disk_usage(folder or ".").free >= SPACE_BYTES + size
    except OSError:
        return True


def is_full(error: Exception) -> bool:
    """Whether an error of the system says that the disk is full."""
    return getattr(error, "errno", 0) in (errno.ENOSPC, errno.EDQUOT)


def sync(path: str) -> None:
    """Sync a file, or the names in a folder, to the disk. Raises OSError."""
    fd = os.open(path, os.O_RDONLY)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)
