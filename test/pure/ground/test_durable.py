"""Files are whole or unchanged, and only their owner reads the private ones."""

import os
import stat

import pytest

from roah_rsbb.ground import durable


def test_the_file_and_its_name_are_on_the_disk(tmp_path, monkeypatch):
    synced, real = [], os.fsync
    monkeypatch.setattr("os.fsync", lambda fd: (synced.append(os.readlink(f"/proc/self/fd/{fd}")), real(fd)))
    durable.write_file(str(tmp_path / "file"), b"content")
    assert synced == [str(tmp_path / "file.new"), str(tmp_path)]
    assert (tmp_path / "file").read_bytes() == b"content"


def test_a_full_disk_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "file"
    durable.write_file(str(path), b"old")

    def fail(_fd):
        raise OSError("disk full")

    monkeypatch.setattr("os.fsync", fail)
    with pytest.raises(OSError, match="disk full"):
        durable.write_file(str(path), b"new")
    assert path.read_bytes() == b"old"
    monkeypatch.undo()
    durable.write_file(str(path), b"newer")
    assert path.read_bytes() == b"newer"


def test_permissions_of_an_earlier_draft_do_not_matter(tmp_path):
    (tmp_path / "file.new").touch(0o644)
    durable.write_file(str(tmp_path / "file"), b"a secret")
    assert stat.S_IMODE((tmp_path / "file").stat().st_mode) == durable.PRIVATE


def test_a_link_in_the_place_of_the_draft_is_not_followed(tmp_path):
    other = tmp_path / "other"
    other.write_bytes(b"of somebody")
    (tmp_path / "file.new").symlink_to(other)
    with pytest.raises(FileExistsError):
        durable.write_file(str(tmp_path / "file"), b"a secret")
    assert other.read_bytes() == b"of somebody"
