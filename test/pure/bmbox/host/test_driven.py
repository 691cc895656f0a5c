"""Parameters of modules, which may differ between zones."""

import pytest

from helpers.config_files import SHIPPED
from roah_rsbb.bmbox.framework.rule_files import file_in, own_file, zone_folders
from roah_rsbb.bmbox.hnf import HNF
from roah_rsbb.bmbox.host.host import Driven
from roah_rsbb.rulebook.errors import ConfigErrors

COMMON = (SHIPPED / "modules" / "HNF.yaml").read_text("utf-8")
NORTH = "starting_pose: [1.0, 1.0, 0.0]\nwaypoints: [[7.0, 8.0, 0.0]]\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "HNF.yaml").write_text(COMMON, "utf-8")
    (tmp_path / "North").mkdir()
    return tmp_path


def waypoints(driven, zone):
    return [tuple(pose) for pose in driven.parameters(zone).waypoints]


def test_a_zone_has_its_own_parameters_or_those_of_all(folder):
    (folder / "North" / "HNF.yaml").write_text(NORTH, "utf-8")
    driven = Driven("HNF", str(folder), HNF, None)
    assert waypoints(driven, "North") == [(7.0, 8.0, 0.0)]
    assert waypoints(driven, "South") == waypoints(driven, "") == [(1.0, 0.5, 0.0), (2.0, 1.5, 1.57), (0.5, 2.0, 3.14)]


def test_files_of_a_zone_come_change_and_go_while_it_is_used(folder):
    driven = Driven("HNF", str(folder), HNF, None)
    assert len(waypoints(driven, "North")) == 3
    own = folder / "North" / "HNF.yaml"
    own.write_text(NORTH, "utf-8")
    assert waypoints(driven, "North") == [(7.0, 8.0, 0.0)]
    own.write_text(NORTH.replace("7.0, 8.0", "7.0, 9.25"), "utf-8")
    assert waypoints(driven, "North") == [(7.0, 9.25, 0.0)]
    own.unlink()
    assert len(waypoints(driven, "North")) == 3


def test_an_error_concerns_only_the_zones_that_use_the_file(folder):
    own = folder / "North" / "HNF.yaml"
    own.write_text(NORTH.replace("7.0", "far"), "utf-8")
    driven = Driven("HNF", str(folder), HNF, None)
    assert driven.problems("North")[0].startswith(f"{own}:2: found the text 'far'")
    assert driven.problems("South") == driven.problems() == []
    own.write_text(NORTH, "utf-8")
    (folder / "HNF.yaml").write_text("nonsense", "utf-8")
    driven.reload()
    assert driven.problems("North") == []
    assert driven.problems("South") != []
    with pytest.raises(ConfigErrors):
        driven.parameters("South")


def test_other_rules_read_the_parameters_of_all_zones_again(folder):
    rules = folder / "HNF.py"
    text = (
        "from roah_rsbb.bmbox.framework.module import Module\n"
        "from roah_rsbb.bmbox.framework.parameters import Whole\n\n\n"
        "class Own(Module):\n"
        '    CODE = "HNF"\n'
        '    PARAMETERS = {"laps": Whole("1", 1, 9)}\n\n'
        "    async def execute(self):\n        pass\n"
    )
    rules.write_text(text, "utf-8")
    (folder / "HNF.yaml").write_text("laps: 2\n", "utf-8")
    (folder / "North" / "HNF.yaml").write_text("laps: 3\n", "utf-8")
    driven = Driven("HNF", str(folder), None, str(rules))
    assert (driven.parameters("").laps, driven.parameters("North").laps) == (2, 3)
    rules.write_text(text.replace('"laps"', '"rounds"'), "utf-8")
    driven.reload()
    assert "unknown key 'laps'" in "".join(driven.problems("North"))
    assert "unknown key 'laps'" in "".join(driven.problems(""))


def test_folders_of_zones(folder):
    for name in (".git", "__pycache__", "Arena 2"):
        (folder / name).mkdir()
    assert zone_folders(str(folder)) == ["Arena 2", "North"]
    assert zone_folders(str(folder / "nowhere")) == []


@pytest.mark.parametrize("zone", ["", ".", "..", "../North", "a/b", "a\0b", "_private"])
def test_a_zone_whose_name_is_no_folder_uses_the_common_file(folder, zone):
    assert own_file(str(folder), zone, "HNF.yaml") == ""
    assert file_in(str(folder), zone, "HNF.yaml") == str(folder / "HNF.yaml")
