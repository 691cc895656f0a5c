"""Launch files, read as data."""

from roah_rsbb.rulebook.errors import LaunchArgument, Report, arguments, elements


def test_arguments_with_a_default(tmp_path):
    path = tmp_path / "competition.launch"
    path.write_text('<launch><arg name="smartif_host" default="10.0.0.9" doc="of the devices"/><arg name="other"/>'
                    '</launch>', "utf-8")
    report = Report()
    assert arguments(report, str(path)) == {"smartif_host": LaunchArgument("10.0.0.9", "of the devices")}
    assert report.errors == []


def test_a_missing_or_broken_file_is_an_error_with_its_line(tmp_path):
    report = Report()
    assert elements(report, str(tmp_path / "nowhere")) == []
    path = tmp_path / "competition.launch"
    path.write_text('<launch>\n  <arg name="a" default="1"/>\n  <arg name=b/>\n</launch>', "utf-8")
    assert arguments(report, str(path)) == {"a": LaunchArgument("1", "")}
    texts = list(map(str, report.errors))
    assert len(texts) == 2 and "nowhere" in texts[0]
    assert texts[1].startswith(f"{path}:3:") and "values in quotes" in texts[1]
