"""Whatever is typed, in options or at the terminal: an exit status and a reason, never a traceback."""

import io
import os
import pathlib
import shutil
import tempfile
from unittest import mock

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.config_files import SHIPPED
from helpers.examples import examples
from roah_rsbb.rulebook import config
from roah_rsbb.tools.competition import program
from roah_rsbb.tools.competition.answers import questions
from roah_rsbb.tools.competition.rulebooks import names

OPTIONS = [question.option for question in questions({})]
GOOD = {
    "teams": "A, B, C", "benchmarks": "HWV, HNF, HSUF", "zones": "X: all, Y: HNF", "days": "2026-11-28, 2026-11-29",
    "daily": "HWV HNF HSUF, HNF", "rounds": "2", "arenas": "2", "decisions": "Posters: count",
    "begin": "09:00", "end": "23:00", "every": "15",
    "breaks": "12:00-13:00", "time-zone": "UTC", "rsbb-host": "10.0.0.255", "smartif-host": "10.0.0.9",
    "rulebook": "erl2019", "add-team": "D", "sheet": "plan.csv",
}
# An argument has no NUL. A byte that is not UTF-8 becomes a surrogate.
ODD = ["", " ", ",", ":", ",,", "a:", ": HNF", "X:HNF,X:HNF", "all", "tasks", "ALL", "\udcff", "A\udcff", "\n", "\t",
       "-", "--", "-1", "0", "256", "99999999999999999999", "1e9", "²", "٣", "24:00", "23:59", "00:00-23:59",
       "23:59-00:00", "12-13", "2026-02-30", "2100-12-31", "2000-01-01", "1999-12-31", "+14:59", "-14:00", "local",
       "nan", "null", "..", "/", "/dev/null", "plan.csv", "[", "{", "#", "'", '"', "*a", "&a", "!x", "%", "é" * 60,
       "a" * 5000, ", ".join(f"T{number}" for number in range(300))]
VALUE = st.one_of(
    st.sampled_from(ODD), st.sampled_from(sorted(GOOD.values())),
    st.text(st.characters(blacklist_characters="\0"), max_size=12),
    st.lists(st.sampled_from([*ODD, *GOOD.values()]), min_size=2, max_size=3).map(", ".join),
)


class Terminal(io.StringIO):
    """A terminal on which these lines are typed."""

    def isatty(self):
        return True


class Screen(io.TextIOWrapper):
    """A terminal for UTF-8, which a character that does not exist would break."""

    def __init__(self):
        super().__init__(io.BytesIO(), encoding="utf-8")

    def text(self):
        self.flush()
        return self.buffer.getvalue().decode("utf-8")


@pytest.fixture(scope="module")
def folder():
    """A folder with a competition, a sheet and a file."""
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as path:
        os.chdir(path)
        pathlib.Path("plan.csv").write_text("zone,benchmark,team,date,time\nX,HNF,A,2026-11-28,09:00\n")
        pathlib.Path("file").write_text("")
        with mock.patch("sys.stdout", Screen()), pytest.raises(SystemExit):
            program.main(["there", *typed_options({name: GOOD[name] for name in (
                "teams", "benchmarks", "days")})])
        yield pathlib.Path(path)
        os.chdir(before)


def typed_options(options):
    return [f"--{name}={value}" for name, value in options.items()]


def ended(arguments, typed=None):
    """Exit status and output of the program. Any other exception would fail the test."""
    screen, errors = Screen(), Screen()
    errors.reconfigure(errors="backslashreplace")  # as Python's standard error
    typed_input = io.StringIO() if typed is None else Terminal(typed)
    with mock.patch("sys.stdout", screen), mock.patch("sys.stderr", errors), mock.patch("sys.stdin", typed_input), \
            pytest.raises(SystemExit) as end:
        program.main(arguments)
    return end.value.code, screen.text(), errors.text()


@examples(60)
@given(
    changed=st.dictionaries(st.sampled_from([*OPTIONS, "rulebook", "add-team", "sheet"]), VALUE, max_size=3),
    given_=st.sets(st.sampled_from(OPTIONS)),
    flags=st.lists(st.sampled_from(["--check", "--schedule-only"]), max_size=1),
    directory=st.sampled_from(["new", "there", "file", "file/new", "new\udcff", "a" * 300, ".", "/proc/new", ""]),
)
def test_options(folder, changed, given_, flags, directory):
    options = {**{name: GOOD[name] for name in ("teams", "benchmarks", "days")},
               **{name: GOOD[name] for name in given_}, **changed}
    try:
        status, out, err = ended([directory, *flags, *typed_options(options)])
        assert status in (0, 1, 2)
        assert status == 0 or err or "error: " in out
        assert "Traceback" not in out + err
        if status == 0 and directory == "new" and not flags:
            config.load(*(f"new/{name}.yaml" for name in ("benchmarks", "schedule", "passwords")))
    finally:
        shutil.rmtree("new", ignore_errors=True)
        shutil.rmtree(os.fsencode("new\udcff"), ignore_errors=True)


@examples(20)
@given(st.lists(VALUE.filter(lambda line: "\n" not in line), max_size=12),
       st.sampled_from([None, *names(str(SHIPPED))]))
def test_answers_at_a_terminal(folder, lines, rulebook):
    lines = [line.encode("utf-8", "replace").decode() for line in lines]
    try:
        options = ["--rulebook", rulebook] if rulebook else []
        status, _, err = ended(["new", *options], "".join(f"{line}\n" for line in lines))
        assert status in (0, 1)
        assert status == 0 or err
    finally:
        shutil.rmtree("new", ignore_errors=True)


@pytest.mark.parametrize("option", ["teams", "benchmarks", "days"])
def test_an_empty_option(folder, option):
    status, _, err = ended(["new", *typed_options({**{name: GOOD[name] for name in ("teams", "benchmarks", "days")},
                                                   option: ""})])
    assert status == 1
    assert err.startswith(f"new_competition: --{option}: found nothing; expected ")


def test_a_name_that_is_not_utf_8(folder):
    status, _, err = ended(["new", *typed_options({"teams": "A\udcff", "benchmarks": "HNF", "days": "2026-11-28"})])
    assert status == 1
    assert err == "new_competition: --teams: found a character that is not UTF-8; expected text in UTF-8\n"


def test_the_package_lacks_a_file(folder, tmp_path):
    shutil.copytree(str(SHIPPED), str(tmp_path / "config"))
    (tmp_path / "config" / "schedule.yaml").unlink()
    errors = Screen()
    with mock.patch("sys.stdout", Screen()), mock.patch("sys.stderr", errors), pytest.raises(SystemExit) as end, \
            mock.patch.object(program, "shipped_folder", lambda: tmp_path / "config"):
        program.main(["new", *typed_options(
            {name: GOOD[name] for name in ("teams", "benchmarks", "days")})])
    assert end.value.code == 1
    assert f"{tmp_path}/config/schedule.yaml cannot be read: No such file or directory." in errors.text()


def test_more_zones_than_teams(folder):
    try:
        status, out, _ = ended(["new", *typed_options({
            "teams": "A", "benchmarks": "HWV", "zones": "X: HWV, Y: HWV", "days": "2026-11-28"})])
        assert status == 0
        assert "warning: --zones: zone 'Y' has no runs and is left out" in out
    finally:
        shutil.rmtree("new", ignore_errors=True)
