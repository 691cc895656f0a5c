"""The program: options, questions, exit statuses; it never waits where nobody can answer."""

import datetime
import os
import re

import pytest

from helpers.journals import Writer
from helpers.results_of import task_record
from helpers.time_zones import local_time
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import Durable
from roah_rsbb.tools.competition import program
from roah_rsbb.tools.preflight_checks import check_configuration

OPTIONS = ["--teams", "BrassButlers,CopperKettle", "--benchmarks", "HWV,HNF", "--days", "2026-11-28,2026-11-29",
           "--time-zone", "UTC"]
SHEET = "zone,benchmark,team,date,time\nHome,HWV,BrassButlers,2026-11-28,09:00\nHome,HSUF,,2026-11-28,10:00\n"


SUNDAY = datetime.datetime(2026, 11, 29, tzinfo=datetime.timezone.utc).timestamp()


def load(directory):
    return config.load(*(str(directory / f"{name}.yaml") for name in ("benchmarks", "schedule", "passwords")))


def test_options_alone(run, tmp_path):
    status, out, err = run("erl", *OPTIONS)
    assert (status, err) == (0, "")
    assert "No errors: 2 teams, 2 zones, 2 benchmarks, 8 runs" in out
    assert f"roslaunch {tmp_path}/erl/competition.launch rsbb_host:=192.168.1.255" in out
    loaded, warnings = load(tmp_path / "erl")
    assert warnings == []
    assert [zone.name for zone in loaded.zones] == ["Task Benchmarks", "Functionality Benchmarks"]
    first = loaded.zones[0].events[0]
    assert first.scheduled == datetime.datetime(2026, 11, 28, 9, tzinfo=datetime.timezone.utc).timestamp()


@pytest.mark.parametrize("host, setting", [([], " rsbb_host:=192.168.1.255"), (["--rsbb-host", "10.0.0.255"], "")])
def test_the_next_steps_without_ros(run, tmp_path, monkeypatch, host, setting):
    monkeypatch.setattr("sys.argv", ["roah-rsbb"])
    _, out, _ = run("erl", *OPTIONS, *host)
    assert out.splitlines()[-2:] == [
        f"Check the set-up: roah-rsbb preflight {tmp_path}/erl{setting}",
        f"Start the box: roah-rsbb run {tmp_path}/erl{setting}"]


def test_all_options(run, tmp_path):
    status, out, _ = run("erl", *OPTIONS[:4], "--days", "2026-11-28", "--zones", "A: HNF, B", "--begin", "10:00",
                         "--end", "10:40", "--every", "20", "--time-zone", "+01:00", "--rsbb-host", "10.0.0.255",
                         "--smartif-host", "10.0.0.9")
    assert status == 0
    assert out.endswith("roslaunch " + str(tmp_path) + "/erl/competition.launch\n")
    zones = load(tmp_path / "erl")[0].zones
    assert [(zone.name, {event.benchmark.code for event in zone.events}) for zone in zones] == [
        ("A", {"HNF"}), ("B", {"HWV"})]
    assert [event.scheduled % 86400 / 60 for event in zones[0].events] == [9 * 60, 9 * 60 + 20]
    launch = (tmp_path / "erl" / "competition.launch").read_text("utf-8")
    assert 'default="10.0.0.255"' in launch
    assert 'default="10.0.0.9"' in launch


@pytest.mark.parametrize("options, typed, status, expected", [
    (("--teams", "A"), None, 2,
     "not given: --benchmarks, --days; for example: --benchmarks HGTKMH,HWV,HNF --days 2026-11-28"),
    (("--teams", "A"), None, 2, "--sheet"),
    ((), "", 1, "nothing was written"), ((), "BrassButlers\n", 1, "nothing was written"),
    ((*OPTIONS, "--end", "09:20"), None, 1,
     "--days: found runs on 2026-11-28 until 09:30; expected that they end by 09:20"),
])
def test_nothing_is_written_of_what_is_incomplete(run, tmp_path, options, typed, status, expected):
    done, _, err = run("erl", *options, typed=typed)
    assert done == status
    assert expected in err
    assert os.listdir(str(tmp_path)) == []


def test_no_standard_input_at_all(run, monkeypatch, tmp_path):
    monkeypatch.setattr("sys.stdin", None)
    with pytest.raises(SystemExit) as ended:
        program.main(["erl"])
    assert ended.value.code == 2


def test_questions_are_asked_again_until_they_are_answered(run, tmp_path):
    typed = "\na:b\nBrassButlers, CopperKettle\nHWX\nHWV\n\n28.11.\n2026-11-28\n9h\n\n10.0.0\n\n"
    status, out, err = run("erl", "--time-zone", "UTC", typed=typed)
    assert (status, err) == (0, "")
    for reported in ("found nothing; expected 'BrassButlers, CopperKettle'", "found 'a:b'", "found the text 'HWX'",
                 "found '28.11.'", "found '9h'", "found '10.0.0'"):
        assert out.count(reported) == 1
    assert "  HCFGAC  Catering for Granny Annie's Comfort\n" in out
    loaded = load(tmp_path / "erl")[0]
    assert [(event.team, event.scheduled % 86400) for event in loaded.zones[0].events] == [
        ("BrassButlers", 9 * 3600), ("CopperKettle", 9.25 * 3600)]


def test_the_time_zone_is_asked_for_and_kept(run, tmp_path):
    with local_time("Asia/Tokyo"):
        typed = "A,B\nHWV\n\n2026-11-28\n09:00\nAmerica/Lima\n\n"
        assert run("erl", typed=typed)[:2:2] == (0,)
        made = load(tmp_path / "erl")[0]
        assert (made.time_zone, made.zones[0].events[0].scheduled % 86400) == ("America/Lima", 14 * 3600)
        assert run("erl", "--add-team", "Gamma")[0] == 0
        status, _, err = run("erl", "--add-team", "Delta", "--time-zone", "UTC")
        assert (status, "--time-zone: found UTC, and America/Lima as time zone of the competition; expected no other "
                "one. To change it, change time_zone in schedule.yaml" in err) == (1, True)
        assert run("two", *OPTIONS[:-2], "--zones", "A,B")[1].count("Time zone: Asia/Tokyo (this computer's") == 1
    assert load(tmp_path / "erl")[0].time_zone == "America/Lima"
    lines = (tmp_path / "erl" / "schedule.yaml").read_text("utf-8").splitlines()
    late, = (line for line in lines if "team: Gamma" in line)
    assert "scheduled_time: 2026-11-28 09:30:00 -05:00, " in late
    assert late.endswith("  # Saturday")


def test_given_options_are_not_asked_for(run):
    status, out, _ = run("erl", *OPTIONS, "--zones", "A,B", "--begin", "9:00", typed="10.0.0.255\n")
    assert status == 0
    assert out.count("press Enter") == 1


def test_all_wrong_options_are_reported_at_once(run, tmp_path):
    status, _, err = run("erl", "--teams", "a:b", "--benchmarks", "X", "--days", "x", "--begin", "x", "--every", "x",
                         "--time-zone", "x", "--rsbb-host", "x")
    assert status == 1
    assert [line.split(":")[1].strip() for line in err.splitlines()] == [
        "--teams", "--benchmarks", "--days", "--begin", "--every", "--time-zone", "--rsbb-host"]
    assert os.listdir(str(tmp_path)) == []


def test_a_sheet(run, tmp_path):
    (tmp_path / "plan.csv").write_text(SHEET, encoding="utf-8")
    status, out, err = run("erl", "--sheet", "plan.csv", typed="never read")
    assert (status, err) == (0, "")
    assert "No errors: 1 team, 1 zone, 2 benchmarks, 2 runs" in out
    assert list(load(tmp_path / "erl")[0].passwords) == ["BrassButlers"]


def test_a_sheet_whose_teams_are_known(run, tmp_path):
    (tmp_path / "plan.csv").write_text(SHEET.replace("BrassButlers", "BrasButlers"), encoding="utf-8")
    status, _, err = run("erl", "--sheet", "plan.csv", "--teams", "BrassButlers, Other")
    assert status == 1
    assert err == ("new_competition: plan.csv:2: found 'BrasButlers' as team (column C); expected one of the teams in "
                   "--teams: did you mean 'BrassButlers'?\n")
    (tmp_path / "plan.csv").write_text(SHEET, encoding="utf-8")
    status, out, _ = run("erl", "--sheet", "plan.csv", "--teams", "BrassButlers, Other")
    assert status == 0
    assert "warning: erl/passwords.yaml: no runs in the schedule for 'Other'" in out


def test_options_that_the_sheet_answers_are_refused(run, tmp_path):
    (tmp_path / "plan.csv").write_text(SHEET, encoding="utf-8")
    status, _, err = run("erl", "--sheet", "plan.csv", "--days", "2026-11-28")
    assert status == 1
    assert "--days: found this option together with --sheet; expected only one of them" in err


def test_a_new_schedule_for_an_old_competition(run, tmp_path):
    run("erl", *OPTIONS)
    before = load(tmp_path / "erl")[0]
    with open(str(tmp_path / "erl" / "schedule.yaml"), "a", encoding="utf-8") as schedule:
        schedule.write("- durable: two\n")
    passwords = (tmp_path / "erl" / "passwords.yaml").read_text("utf-8")
    (tmp_path / "plan.csv").write_text(
        "zone,benchmark,team,date,time\nHome,HWV,CopperKettle,2026-11-28,09:00\n", encoding="utf-8")
    status, out, err = run("erl", "--sheet", "plan.csv", "--schedule-only", "--time-zone", "UTC")
    assert (status, err) == (0, "")
    assert "the old one is erl/schedule.yaml~" in out
    assert "The runs of other days stay: 4 on 2026-11-29" in out
    loaded = load(tmp_path / "erl")[0]
    assert loaded.durable is Durable.TWO
    events = [(zone.name, e) for zone in loaded.zones for e in zone.events]
    assert [(name, e.benchmark.code) for name, e in events if e.scheduled < SUNDAY] == [("Home", "HWV")]
    assert {e.id for _, e in events if e.scheduled >= SUNDAY} == {
        e.id for zone in before.zones for e in zone.events if e.scheduled >= SUNDAY}
    assert (tmp_path / "erl" / "passwords.yaml").read_text("utf-8") == passwords


def test_a_sheet_of_one_day_keeps_the_other_days_and_counts_them(run, tmp_path):
    """It used to drop the other days, and to begin again at round 1, so that tomorrow's runs looked like today's."""
    lines = ["zone,benchmark,team,date,time", "Home,HWV,CopperKettle,2026-11-28,09:00",
             "Home,HWV,BrassButlers,2026-11-28,09:30"]
    (tmp_path / "plan.csv").write_text("\n".join(lines), encoding="utf-8")
    run("erl", "--sheet", "plan.csv", "--time-zone", "UTC", "--rsbb-host", "10.0.0.255")
    first = turns(load(tmp_path / "erl")[0])
    assert [(turn[1:3], day) for turn, day, _ in first] == [(("CopperKettle", 1), 28), (("BrassButlers", 1), 28)]
    (tmp_path / "plan.csv").write_text("\n".join([lines[0], lines[1].replace("28", "29")]), encoding="utf-8")
    assert run("erl", "--sheet", "plan.csv", "--schedule-only", "--time-zone", "UTC")[0] == 0
    second = turns(load(tmp_path / "erl")[0])
    assert second[:2] == first
    assert second[2][:2] == (("HWV", "CopperKettle", 2, 1), 29)
    # Moved within the day and to another zone, each run keeps its id.
    moved = "Hall,HWV,CopperKettle,2026-11-29,11:30"
    (tmp_path / "plan.csv").write_text("\n".join([lines[0], moved]), encoding="utf-8")
    assert run("erl", "--sheet", "plan.csv", "--schedule-only", "--time-zone", "UTC")[0] == 0
    assert [own for _, _, own in turns(load(tmp_path / "erl")[0])] == [own for _, _, own in second]


def test_a_new_day_renumbers_no_event_that_stays(run, tmp_path):
    rows = [HEAD, "Home,HWV,A,2026-11-29,09:00", "Home,HWV,B,2026-11-29,09:30"]
    (tmp_path / "plan.csv").write_text("\n".join(rows), encoding="utf-8")
    run("erl", "--sheet", "plan.csv", "--time-zone", "UTC", "--rsbb-host", "10.0.0.255")
    first = turns(load(tmp_path / "erl")[0])
    rows += ["Home,HWV,A,2026-11-28,09:00", "Home,HWV,B,2026-11-29,08:00"]
    (tmp_path / "plan.csv").write_text("\n".join(rows), encoding="utf-8")
    assert run("erl", "--sheet", "plan.csv", "--schedule-only")[0] == 0
    second = turns(load(tmp_path / "erl")[0])
    assert [turn for turn in second if turn in first] == first
    assert [turn[:2] for turn in second if turn not in first] == [(("HWV", "A", 2, 1), 28), (("HWV", "B", 1, 2), 29)]


def test_one_team_in_two_spellings(run, tmp_path):
    names = ["Pumas", "b-it-bots", "WrightEagle", "Pumans", "b-it bots", "Wright Eagle"]
    (tmp_path / "plan.csv").write_text("\n".join([HEAD, *(
        f"Arena,HWV,{name},2026-11-28,{9 + number}:00" for number, name in enumerate(names))]), encoding="utf-8")
    made = run("erl", "--sheet", "plan.csv", "--rsbb-host", "10.0.0.255", "--time-zone", "UTC")[1]
    checked, late = run("erl", "--check")[1], run("erl", "--add-team", "pumas")[1]
    for name, other in zip(names[3:], names):
        warning = f"team '{name}' is nearly the same as team '{other}'"
        assert [text.count(warning) for text in (made, checked, late)] == [1, 1, 1]
    assert "team 'pumas' is nearly the same as team 'Pumas'" in late
    files = {f"{name}_file": f"erl/{name}.yaml" for name in ("benchmarks", "schedule", "passwords")}
    found = check_configuration(files, "")
    assert sum("is nearly the same as" in remark.text for remark in found) == 4


HEAD = "zone,benchmark,team,date,time"
TWO_DAYS = ["Home,HWV,A,2026-11-28,09:00", "Home,HWV,B,2026-11-28,09:30", "Home,HWV,A,2026-11-29,09:00",
            "Home,HWV,B,2026-11-29,09:30"]


@pytest.fixture
def reimport(run, tmp_path):
    """Begin with `TWO_DAYS`, of which all events have results; then import other rows. Returns the exit status, what is
    printed, and the new day and time of each event, by the ones before."""
    def write(rows):
        (tmp_path / "plan.csv").write_text("\n".join([HEAD, *rows]), encoding="utf-8")

    def times():
        loaded = load(tmp_path / "erl")[0]
        return {e.id: f"{datetime.datetime.utcfromtimestamp(e.scheduled):%d %H:%M} {e.team}"
                for zone in loaded.zones for e in zone.events}

    write(TWO_DAYS)
    run("erl", "--sheet", "plan.csv", "--time-zone", "UTC", "--rsbb-host", "10.0.0.255")
    before = times()
    writer = Writer(tmp_path / "erl" / "log")
    for number, (own, when) in enumerate(before.items()):
        record = task_record(when[-1], number + 1, event=own)._replace(benchmark="HWV")
        writer.run(record, ((6667 + number, "r1"),))
    writer.close()

    def again(rows, typed=None):
        write(rows)
        status, out, err = run("erl", "--sheet", "plan.csv", "--schedule-only", typed=typed)
        now = times()
        return status, out + err, {when: now.get(own, "") for own, when in before.items()}
    return again


@pytest.mark.parametrize("rows, numbers", [
    (["Home,HWV,B,2026-11-27,16:00", *TWO_DAYS], {"27 16:00 B": "3, run: 1"}),
    (["Home,HWV,B,2026-11-27,16:00"], {"27 16:00 B": "3, run: 1"}),
    ([*TWO_DAYS, "Home,HWV,A,2026-11-28,08:00"], {"28 08:00 A": "1, run: 2"}),
])
def test_a_run_before_the_others_moves_no_result(reimport, tmp_path, rows, numbers):
    """Events with results keep their rounds, too."""
    status, said, moved = reimport(rows)
    assert (status, "results" in said, "is already in line" in said) == (0, False, False)
    assert {when: now for when, now in moved.items() if when != now} == {}
    text = (tmp_path / "erl" / "schedule.yaml").read_text("utf-8")
    found = re.findall(r"team: '(\w)', *round: (.*), scheduled_time: 2026-11-(..) (..:..)", text)
    assert {f"{day} {at} {team}": each for team, each, day, at in found} == {
        "28 09:00 A": "1, run: 1", "28 09:30 B": "1, run: 1", "29 09:00 A": "2, run: 1", "29 09:30 B": "2, run: 1",
        **numbers}


def test_an_event_with_results_that_moves_within_its_day_is_named(reimport):
    status, said, moved = reimport(["Hall,HWV,A,2026-11-28,11:00", *TWO_DAYS[1:]])
    assert (status, moved["28 09:00 A"]) == (0, "28 11:00 A")
    assert "warning: HWV of A on 2026-11-28 09:00 has results and is on 2026-11-28 11:00 now: they stay with it" in said


def test_events_that_go(reimport):
    status, said, moved = reimport(TWO_DAYS[1:])
    assert (status, moved) == (0, {**{when: when for when in moved}, "28 09:00 A": ""})
    assert "warning: HWV of A on 2026-11-28 09:00 has results and no event any more: they stay in the results" in said


@pytest.mark.parametrize("typed, now", [("7\n2\n", "28 12:00 A"), ("\n", ""), (None, None)])
def test_which_event_has_the_results_is_asked(reimport, typed, now):
    rows = ["Home,HWV,A,2026-11-28,11:00", "Home,HWV,A,2026-11-28,12:00", *TWO_DAYS[1:]]
    status, said, moved = reimport(rows, typed)
    if typed is None:
        assert (status, moved["28 09:00 A"]) == (2, "28 09:00 A")
        assert "Is it the event of 2026-11-28 11:00 or 2026-11-28 12:00 now? Keep its row" in said
    else:
        assert (status, moved["28 09:00 A"]) == (0, now)


def test_no_result_goes_to_another_day_unasked(reimport):
    rows = [*TWO_DAYS[1:], "Home,HWV,A,2026-11-29,15:00"]
    assert reimport(rows)[0] == 2
    assert reimport(rows, "\n")[2]["28 09:00 A"] == ""


def turns(loaded):
    """Benchmark, team, round and run of each event, the day of the month, and the id; by time."""
    events = sorted((e for zone in loaded.zones for e in zone.events), key=lambda e: e.scheduled)
    return [((e.benchmark.code, e.team, e.round, e.run),
             datetime.datetime.fromtimestamp(e.scheduled, datetime.timezone.utc).day, e.id) for e in events]


def test_a_new_schedule_with_what_the_competition_has_not(run, tmp_path):
    run("erl", *OPTIONS)
    before = (tmp_path / "erl" / "schedule.yaml").read_text("utf-8")
    (tmp_path / "plan.csv").write_text(
        "zone,benchmark,team,date,time\nHome,HOPF,TeaAtFive,2026-11-28,09:00\n", encoding="utf-8")
    status, _, err = run("erl", "--sheet", "plan.csv", "--schedule-only")
    assert status == 1
    assert "found 'HOPF' as benchmark (column B); expected one of the benchmarks of erl/benchmarks.yaml" in err
    assert "found 'TeaAtFive' as team (column C); expected one of the teams of erl/passwords.yaml" in err
    assert (tmp_path / "erl" / "schedule.yaml").read_text("utf-8") == before


def test_a_new_schedule_only_needs_a_sheet_and_takes_nothing_else(run, tmp_path):
    assert run("erl", "--schedule-only")[::2] == (
        2, "new_competition: not given: --sheet, which --schedule-only needs\n")
    run("erl", *OPTIONS)
    (tmp_path / "plan.csv").write_text(SHEET, encoding="utf-8")
    status, _, err = run("erl", "--schedule-only", "--sheet", "plan.csv", "--teams", "A")
    assert status == 1
    assert "--teams: found this option together with --schedule-only" in err


def test_check(run, tmp_path):
    run("erl", *OPTIONS)
    assert run("--check", "erl") == (0, "No errors: 2 teams, 2 zones, 2 benchmarks, 8 runs\n", "")
    (tmp_path / "erl" / "passwords.yaml").unlink()
    status, out, _ = run("--check", "erl")
    assert status == 1
    assert out.splitlines()[0].startswith("error: erl/passwords.yaml: found no file")
    assert out.splitlines()[-1] == "1 error: correct it before you start the box"


def test_help(run):
    status, out, _ = run("--help")
    assert status == 0
    for option in ("--check", "--sheet", "--teams", "--benchmarks", "--zones", "--days"):
        assert option in out


@pytest.mark.parametrize("program, start", [
    ("new_competition", "roslaunch {0}/competition.launch"), ("roah-rsbb", "roah-rsbb run {0}")])
def test_a_certificate(run, tmp_path, monkeypatch, program, start):
    monkeypatch.setattr("sys.argv", [program])
    (tmp_path / "erl").mkdir()
    status, out, err = run("--certificate", "erl", "--names", "rsbb.local, 192.168.1.10")
    assert (status, err) == (0, "")
    folder = tmp_path / "erl"
    assert f"with it: {start.format(folder)} web_cert:={folder}/web_cert.pem web_key:={folder}/web_key.pem" in out
    assert "and for rsbb.local, 192.168.1.10." in out and "Certificate Trust Settings" in out
    before = (folder / "phones.crt").read_bytes()
    assert run("--certificate", "erl")[0] == 0
    assert (folder / "phones.crt").read_bytes() != before, "it is made again"


def test_a_certificate_that_cannot_be_made(run, tmp_path):
    status, _, err = run("--certificate", "erl", "--names", "a b", "--teams", "x")
    assert status == 1
    assert "--names: found" in err and "'a b'" in err and "--teams: found this option" in err
    status, _, err = run("--certificate", "missing")
    assert status == 1
    assert f"{tmp_path}/missing" in err and "Choose another folder" in err
