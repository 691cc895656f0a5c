"""A tiny disk that a test can fill, make read-only or break. It always vanishes with the test."""

import os
import pathlib
import subprocess

# Makes a disk fail as if its controller were broken.
_BREAK = 'd=$(findmnt -no SOURCE "$1") && echo broken by a test > /sys/fs/ext4/${d#/dev/}/trigger_fs_error'


class CannotMount(Exception):
    """This computer or user cannot mount file systems; the text says why."""


class SmallDisk:
    """A disk mounted where only the holder's mount namespace sees it, at `mount_point`.

    `path` leads there from outside. What a command does with
    `inside` before it happens there, too.

    One that `breaks` is an ext4 in a file beside it, at least 2 MB, with blocks of 1 kB; else it is a tmpfs. Raises
    `CannotMount`.
    """

    def __init__(self, directory, kilobytes, breaks=False):
        self.mount_point, image = str(directory), f"{directory}.image"
        os.makedirs(self.mount_point, exist_ok=True)
        mount = f'mount -t tmpfs -o size={kilobytes}k tmpfs "$1"'
        if breaks:
            mount = (f'truncate -s {kilobytes}k "$2" && mkfs.ext4 -q -F -b 1024 -m 0 "$2" && '
                     'mount -o loop,errors=remount-ro "$2" "$1"')
        self._holder = subprocess.Popen(
            ["unshare", "--mount", "--propagation", "private", "sh", "-c",
             f'{mount} && echo ready && read _; umount -l "$1"', "sh", self.mount_point, image],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )
        if self._holder.stdout.readline() != "ready\n":
            raise CannotMount(self._holder.communicate()[1].strip())
        self.inside = ("nsenter", "-t", str(self._holder.pid), "-m")
        self.path = pathlib.Path(f"/proc/{self._holder.pid}/root{self.mount_point}")
        self._ballast = self.path / "ballast"

    def close(self):
        """Give the disk up."""
        self._holder.communicate("\n")

    def fill(self, leave=0):
        """Fill the disk except for this many bytes."""
        with open(str(self._ballast), "wb", buffering=0) as file:
            size = 4096
            while size:
                try:
                    file.write(bytes(size))
                except OSError:
                    size //= 2
            if leave:
                file.truncate(max(0, os.fstat(file.fileno()).st_size - leave))

    def free(self):
        """Make room again."""
        self._ballast.unlink()

    def make_read_only(self):
        """Only while no file on it is open for writing."""
        self._do('mount -o remount,ro "$1"')

    def make_writable(self):
        """The opposite."""
        self._do('mount -o remount,rw "$1"')

    def fail(self):
        """Break the disk: the system makes it read-only under everybody's hands."""
        self._do(_BREAK)

    def _do(self, script):
        subprocess.run([*self.inside, "sh", "-c", script, "sh", self.mount_point],
                       check=True, stderr=subprocess.DEVNULL)
