"""The sheets in RoboCup@Home's rule book are read, made a rulebook of, and compared. The texts here are invented."""

import pytest

from roah_rsbb.rulebook import league_import as imported
from roah_rsbb.rulebook.config import BenchmarksFile
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.rulebook.league_sheets import LeagueError, RowKind, read_league_book

MACROS = r"""
\newcommand{\timelimit}{5} % \newcommand{\timelimit}{9}
\newcommand{\specialPenBonus}{true}
\newcommand{\notattendingpenalty}{500}
\newcommand{\startbuttonpenalized}{true}
\newcommand{\startbuttonpenalty}{100}
\newcommand{\outstandingPerformanceBonus}{true}
\newcommand{\outstandingPerformanceBonusPercentage}{10}
\newcommand{\dataRecordingBonus}{false}
"""
LIST = r"""
\renewcommand{\currentTest}{Water the Plants --- Evening}
\begin{scoresheet}
\input{scoresheets/Plants}
\end{scoresheet}
%\input{scoresheets/Gone}
"""
SHEET = r"""\small\begin{scorelist}[timelimit=7]
    \scoreitem{15}{Drives to the \textit{window}~sill}
    \scoreheading{Water \& light}
    \scoreitem[3]{80}{Waters a plant \\ \hspace{1em}that is \enquote{dry}} % not \scoreitem{1}{this}
        \scorepen[2]{-20}{Spills 5\% of it}
        \scoremod{40}{Without a hint}
    \scoreitem[1]{00}{Custom:\\ \\}
    \scoreitem[-1]{30}{An old penalty}
    \ifDSPL{
      \scoreitem{7}{For one league}
    }
    \penaltyitem[2]{50}{Breaks a pot \ifShortScoresheet{(see sec.~\ref{rule:pot})}}
\end{scorelist}
\ifShortScoresheet{}{
  \textbf{For the referee}
}
% \begin{scorelist}
"""


@pytest.fixture(name="league")
def fixture_league(tmp_path):
    """Writes a rule book; returns its root."""
    def write(sheet=SHEET, macros=MACROS, listed=LIST):
        root = tmp_path / "RuleBook"
        for name, text in (("scoresheets/Plants.tex", sheet), ("setup/macros_scoresheets.tex", macros),
                           ("documents/scoresheets.tex", listed)):
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            if text is not None:
                (root / name).write_text(text, encoding="utf-8")
        return str(root)
    return write


def the_sheet(root, league="OPL"):
    return read_league_book(root, league).sheets[0]


def test_each_row_is_read(league):
    sheet = the_sheet(league())
    assert (sheet.title, sheet.file, sheet.timeout_s) == ("Water the Plants – Evening", "scoresheets/Plants.tex", 420)
    assert [(row.number, row.kind, row.points, row.times, row.under, row.heading, row.text, row.line)
            for row in sheet.rows] == [
        (0, RowKind.ITEM, 15, 1, None, "", "Drives to the window sill", 2),
        (1, RowKind.ITEM, 80, 3, None, "Water & light", "Waters a plant that is “dry”", 4),
        (2, RowKind.DEDUCTION, -20, 2, 1, "Water & light", "Spills 5% of it", 5),
        (3, RowKind.MODIFIER, 40, 1, 1, "Water & light", "Without a hint", 6),
        (4, RowKind.ITEM, 0, 1, None, "Water & light", "Custom:", 7),
        (5, RowKind.ITEM, -30, 1, None, "Water & light", "An old penalty", 8),
        (6, RowKind.PENALTY, -50, 2, None, "Water & light", "Breaks a pot", 12),
        (7, RowKind.PENALTY, -500, 1, None, "Special Penalties & Bonuses", "Not attending", 0),
        (8, RowKind.PENALTY, -100, 1, None, "Special Penalties & Bonuses", "Using alternative start signal", 0),
        (9, RowKind.BONUS, 29, 1, None, "Special Penalties & Bonuses", "Outstanding performance", 0),
    ]
    assert sheet.attainable == 15 + 3 * 80 + 40


def test_rows_of_a_league_are_its_own(league):
    own = [row.text for row in the_sheet(league(), "DSPL").rows]
    assert own[6:8] == ["For one league", "Breaks a pot"]
    with pytest.raises(LeagueError, match="OPL, DSPL, SSPL"):
        the_sheet(league(), "KidSize")


@pytest.mark.parametrize("options, added", [
    ("[outstanding=false]", ["Not attending", "Using alternative start signal"]),
    ("[outstanding=False, startbutton=True]", ["Not attending"]),  # TeX compares with just "true"
    ("[specialpenbonus=False]", []),
    ("[startbutton=false,outstandingbonus=70]", ["Not attending", "Outstanding performance"]),
    ("[datarecording=true, datarecordingbonus=12]",
     ["Not attending", "Using alternative start signal", "Contributing with recorded data", "Outstanding performance"]),
])
def test_the_macros_add_rows_by_the_options_of_a_sheet(league, options, added):
    sheet = the_sheet(league(SHEET.replace("[timelimit=7]", options)))
    assert [row.text for row in sheet.rows if not row.line] == added
    bonus = [row.points for row in sheet.rows if row.text == "Outstanding performance"]
    assert bonus in ([], [70] if "=70" in options else [29])


@pytest.mark.parametrize("before, after, said", [
    (r"\penaltyitem[2]{50}", r"\scorefine[2]{50}", r"Plants\.tex:12: \\scorefine is not understood"),
    (r"{-20}", r"{-2O}", r"Plants\.tex:5: '-2O' as a number"),
    (r"[3]{80}", r"[0]{80}", r"Plants\.tex:4: a row that counts 0 times"),
    (r"Spills 5\%", r"Spills \secret{5}", r"Plants\.tex:5: \\secret in the text of a row"),
    (r"\scoreheading{Water", r"Surprise \scoreheading{Water", r"Plants\.tex:3: 'Surprise"),
    (r"\scoreitem{15}", r"\scoremod{15}", r"Plants\.tex:2: \\scoremod without an item"),
    ("[timelimit=7]", "[timelimits=7]", "the option 'timelimits' is not understood"),
    (r"sill}", "sill", r"Plants\.tex:2: the { here is never closed"),
    (r"\end{scorelist}", "", "a scorelist without an end"),
    (r"\small\begin{scorelist}[timelimit=7]", "", "rows outside of a scorelist"),
])
def test_what_is_not_understood_is_an_error_with_its_place(league, before, after, said):
    assert before in SHEET
    with pytest.raises(LeagueError, match=said):
        the_sheet(league(SHEET.replace(before, after)))


def test_what_a_directory_does_not_say_is_said(league, tmp_path):
    with pytest.raises(LeagueError, match="no folder 'scoresheets'"):
        read_league_book(str(tmp_path))
    book = read_league_book(league(macros=None, listed=None))
    assert [sheet.title for sheet in book.sheets] == ["Plants"] and len(book.notes) == 2
    assert all(row.line for row in book.sheets[0].rows)
    with pytest.raises(LeagueError, match=r"scoresheets/Gone\.tex cannot be read"):
        read_league_book(league(listed=LIST.replace("%", "")))


ANSWERED = """
floor of an objective: 0
floor of a test: nothing
rows:
  Plants:
    4: {amount: points, from: 0, to: 300}
"""


def test_a_rulebook_is_made_when_all_is_answered(league, tmp_path):
    book, answers = read_league_book(league()), tmp_path / "league.yaml"
    answers.write_text(imported.questions_text(book), encoding="utf-8")
    asked = imported.questions(book, imported.read_answers(Report(), str(answers)))
    assert [line.partition(":")[0].partition(",")[0] for line in asked] == \
        ["floor of an objective", "floor of a test", "Plants 4"]
    with pytest.raises(LeagueError, match="3 answers are missing"):
        imported.rulebook_text(book, imported.Answers({}, {}))

    proposed = "incidents:" + answers.read_text(encoding="utf-8").partition("#incidents:")[2].replace("\n#", "\n")
    answers.write_text(ANSWERED + proposed, encoding="utf-8")
    report = Report()
    text = imported.rulebook_text(book, imported.read_answers(report, str(answers)))
    (tmp_path / "benchmarks.yaml").write_text(text, encoding="utf-8")
    made = BenchmarksFile(str(tmp_path / "benchmarks.yaml"), report).by_code["Plants"]
    assert [str(error) for error in report.errors] == []
    assert (made.desc, made.timeout) == ("Water the Plants – Evening", 420)
    rows = {item.id: item for item in made.sheet.items}
    assert (rows["2"].under, rows["2"].points, rows["2"].times, rows["1"].least) == ("1", -20, 2, 0)
    assert (rows["4"].amount.value, rows["4"].high, rows["9"].high) == ("points", 300, 29)
    assert rows["Test"].least is None and rows["1"].under == "heading at 1"
    assert {each.name: each for each in made.sheet.incidents}["absent"].marks == "7"


@pytest.mark.parametrize("text", ["rows: {Plants: {4: maybe}}", "rows: {Plants: {four: note}}", "floor of a test: 3",
                                  "hall: 1"])
def test_an_answer_that_is_none_is_an_error(tmp_path, text):
    (tmp_path / "league.yaml").write_text(text, encoding="utf-8")
    report = Report()
    imported.read_answers(report, str(tmp_path / "league.yaml"))
    assert len(report.errors) == 1 and "league.yaml:1" in str(report.errors[0])


OWN = """\
# A comment that stays
- name: P
  desc: water the plants – evening
  code: P
  sheet:
    - section: All
      items:
        - { item: Comes, id: 0, points: 15 } # another
        - item: Waters
          id: 1
          points: 60
          times: 3
    - { item: Ours, id: ours, points: 1 }
"""


def test_rows_get_the_words_of_the_league_and_nothing_else_changes(league):
    book = read_league_book(league())
    text, number = imported.reworded(OWN, book)
    assert number == 2
    assert text == OWN.replace("item: Comes", 'item: "Drives to the window sill"').replace(
        "item: Waters", 'item: "Waters a plant that is “dry”"')
    assert imported.reworded(OWN.replace("evening", "noon"), book) == (OWN.replace("evening", "noon"), 0)


def test_differences_are_said_in_words(league):
    before = imported.lines_of_league(read_league_book(league()))
    new = SHEET.replace("[3]{80}", "[4]{90}").replace("Breaks a pot", "Breaks a flower pot") \
        .replace(r"\scoremod{40}{Without a hint}", r"\scoreitem{300}{Sings to them}")
    after = imported.lines_of_league(read_league_book(league(new)))
    assert imported.differences(before, before) == []
    assert imported.differences(before, after) == [f"Water the Plants – Evening: {text}" for text in (
        "removed: 'Without a hint' (40 points)",
        "'Waters a plant that is “dry”': 80 points × 3, now 90 points × 4",
        "added: 'Sings to them' (300 points)",
        "reworded: 'Breaks a pot' is now 'Breaks a flower pot'",
        "'Outstanding performance': 29 points, now 67 points",
    )]
    assert imported.differences(before, {}) == ["Water the Plants – Evening: removed, with 10 rows"]
    assert imported.differences({}, before) == ["Water the Plants – Evening: added, with 10 rows"]
