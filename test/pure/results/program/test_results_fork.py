"""What is only in the journal of a box from which a standby took over is named, and never merged."""


from helpers.competition import run_record
from helpers.journals import Writer
from roah_rsbb.journal.contents import superseded_value
from roah_rsbb.journal.records import Kind
from roah_rsbb.results.program import main as program


def warnings_of(writer, capsys, monkeypatch):
    monkeypatch.setattr("sys.argv", ["results", "--journal", writer.path, "list"])
    try:
        program.main()
    except SystemExit as end:
        assert not end.code
    return capsys.readouterr().err


def test_the_runs_that_only_the_old_box_has(tmp_path, capsys, monkeypatch):
    writer = Writer(tmp_path)
    writer.run(run_record())
    writer.run(run_record(identity="second"), robots=((6668, "r1"),))
    writer.entry("/notification", "in both")
    assert "took over" not in warnings_of(writer, capsys, monkeypatch)
    both = writer.journal.number_of(writer.journal.committed)
    writer.entry("/notification", "only here", identity="second")
    writer.entry(Kind.EPOCH, superseded_value(2, both, "10.0.0.3"), port=None)
    writer.close()
    warning = warnings_of(writer, capsys, monkeypatch)
    assert "the box at 10.0.0.3 took over" in warning and f"after record {both}: run 2 (1 entries)" in warning
