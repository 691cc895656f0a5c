"""The folder of the benchmarking modules as one file."""

import os
import zipfile

import pytest

from roah_rsbb.standby import beside_copy
from roah_rsbb.standby.beside_copy import PackedModules, TooLarge, unpack


@pytest.fixture
def folder(tmp_path):
    """Parameters and rules, those of a zone, and what is nobody's."""
    made = tmp_path / "modules"
    for name, text in (("HNF.yaml", "goals: 1"), ("HNF.py", "rules"), ("Hall/HNF.yaml", "goals: 2"),
                       ("__pycache__/HNF.pyc", "compiled"), (".HNF.swp", "an editor's")):
        (made / name).parent.mkdir(parents=True, exist_ok=True)
        (made / name).write_text(text)
    return made


def files_in(folder):
    return {path.relative_to(folder).as_posix(): path.read_text() for path in folder.rglob("*") if path.is_file()}


def test_the_folder_is_the_same_on_the_other_computer_and_what_was_removed_is_gone(folder, tmp_path):
    packed, path, far = PackedModules(str(folder), str(tmp_path / "zip")), str(tmp_path / "zip"), tmp_path / "far"
    packed.look()
    assert unpack(path, str(far))
    assert files_in(far) == {"HNF.yaml": "goals: 1", "HNF.py": "rules", "Hall/HNF.yaml": "goals: 2"}
    (folder / "HNF.py").unlink()
    (folder / "HNF.yaml").write_text("goals: 3")
    packed.look()
    assert unpack(path, str(far))
    assert files_in(far) == {"HNF.yaml": "goals: 3", "Hall/HNF.yaml": "goals: 2"}


def test_nothing_is_written_while_nothing_changes(folder, tmp_path):
    path = tmp_path / "zip"
    packed = PackedModules(str(folder), str(path))
    packed.look()
    state = os.stat(path)
    packed.look()
    assert os.stat(path) == state
    path.unlink()
    packed.look()
    assert path.exists(), "it is there again"


def test_a_folder_that_is_another_one_by_mistake_is_not_copied(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(beside_copy, "MAX_BYTES", 10)
    with pytest.raises(TooLarge, match="leave only their rules and parameters there"):
        PackedModules(str(folder), str(tmp_path / "zip")).look()
    assert not (tmp_path / "zip").exists()


@pytest.mark.parametrize("content", [b"", b"PK", b"no archive"])
def test_a_damaged_file_is_an_error_of_the_disk(tmp_path, content):
    (tmp_path / "zip").write_bytes(content)
    with pytest.raises(OSError, match="is damaged"):
        unpack(str(tmp_path / "zip"), str(tmp_path / "far"))


def test_nothing_is_written_outside_of_the_folder(tmp_path):
    with zipfile.ZipFile(tmp_path / "zip", "w") as file:
        file.writestr("../evil", "x")
        file.writestr("/tmp/roah_rsbb_evil", "x")
    unpack(str(tmp_path / "zip"), str(tmp_path / "far"))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["far", "zip"]
    assert not os.path.exists("/tmp/roah_rsbb_evil")


def test_without_a_file_nothing_changes(tmp_path):
    assert not unpack(str(tmp_path / "zip"), str(tmp_path / "far"))
    assert not (tmp_path / "far").exists()
