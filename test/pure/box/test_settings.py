"""The settings of a box without ROS: those of its launch files and of the command line."""

import pathlib

import pytest

from roah_rsbb.box import settings as settings_of
from roah_rsbb.box.parameters import read_parameters
from roah_rsbb.box.settings import BoxSettings
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.ground.params import BadParams
from roah_rsbb.tools.competition.files import launch_text

ROOT = pathlib.Path(__file__).resolve().parents[3]


def settings(folder="", **given):
    found = settings_of.of_folder(folder) if folder else {}
    return BoxSettings({**settings_of.defaults(), **found, **given})


def test_the_defaults_are_those_of_the_launch_file():
    params = read_parameters(settings())
    assert (params.network.rsbb_host, params.network.rsbb_port, params.settings.take_over) == (
        "10.255.255.255", 6666, False)
    assert params.files[0] == str(shipped_folder() / "benchmarks.yaml")


def test_a_folder_changes_them_and_the_command_line_changes_those(tmp_path):
    (tmp_path / settings_of.LAUNCH).write_text(launch_text([], "10.0.0.255", None), "utf-8")
    params = read_parameters(settings(tmp_path))
    assert (params.network.rsbb_host, params.log_dir) == ("10.0.0.255", str(tmp_path.resolve() / "log"))
    words = settings_of.of_words(["rsbb_host:=10.0.1.255", "allowed_skew:=0.2", "public_results:=scores"])
    params = read_parameters(settings(tmp_path, **words))
    assert (params.network.rsbb_host, params.settings.allowed_skew) == ("10.0.1.255", 0.2)
    assert params.publicity.results.value == "scores"


def test_values_are_read_as_roslaunch_reads_them():
    found = settings(web_title="2026", take_over="True", rsbb_port="7000", robot_timeout="3")
    params = read_parameters(found)
    assert (params.settings.take_over, params.settings.rsbb_port, params.settings.robot_timeout) == (True, 7000, 3.0)
    assert found.text("web_title") == "2026"


@pytest.mark.parametrize("given, said", [
    ({"rsbb_port": "many"}, "parameter rsbb_port: found 'many', expected a whole number from 1 to 65000"),
    ({"resume": "perhaps"}, "parameter resume: found 'perhaps', expected one of always, launch, never"),
])
def test_a_wrong_value_is_named(given, said):
    with pytest.raises(BadParams, match=said):
        read_parameters(settings(**given))


def test_a_setting_that_does_not_exist_is_named():
    found = settings(rsbb_hots="1", gui="none")
    read_parameters(found)
    assert found.unknown(list(settings_of.of_box())) == ["there is no setting rsbb_hots: did you mean 'rsbb_host'?"]


def test_a_folder_without_a_launch_file_says_how_it_is_made(tmp_path):
    with pytest.raises(BadParams, match="roah-rsbb new"):
        settings_of.of_folder(tmp_path)


def test_what_only_roslaunch_can_compute_is_to_be_given(tmp_path, monkeypatch):
    path = tmp_path / settings_of.LAUNCH
    monkeypatch.setenv("PLACE", "hall")
    path.write_text('<launch><arg name="web_title" default="$(env PLACE) $(optenv NO_SUCH here)"/></launch>', "utf-8")
    assert settings_of.of_folder(tmp_path) == {"web_title": "hall here"}
    path.write_text('<launch><arg name="log_dir" default="$(anon x)"/></launch>', "utf-8")
    with pytest.raises(BadParams, match="give log_dir:=value"):
        settings_of.of_folder(tmp_path)
    assert settings_of.of_competition(str(tmp_path), {"log_dir": "/logs"}).path("log_dir") == "/logs"
    path.write_text('<launch><arg name="log_dir"></launch>', "utf-8")
    with pytest.raises(BadParams, match="invalid XML"):
        settings_of.of_folder(tmp_path)
