"""Runs of the program for all tests of this folder."""

import io

import pytest

from roah_rsbb.tools.competition import program


class Terminal(io.StringIO):
    """A terminal on which these lines are typed."""

    def isatty(self):
        return True


@pytest.fixture
def run(monkeypatch, capsys, tmp_path):
    """Run the program in a directory of the test's own; return status, output and errors."""
    monkeypatch.chdir(tmp_path)

    def go(*arguments, typed=None):
        monkeypatch.setattr("sys.stdin", io.StringIO("") if typed is None else Terminal(typed))
        with pytest.raises(SystemExit) as ended:
            program.main(list(arguments))
        out, err = capsys.readouterr()
        return ended.value.code, out, err
    return go
