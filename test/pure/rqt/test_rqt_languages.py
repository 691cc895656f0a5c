"""Texts in other languages: every text is marked for the translators, and every language has all of them."""

import os
import subprocess
import sys

import pytest

from helpers import catalogues, texts_in_code
from helpers.texts_in_code import find, placeholders
from roah_rsbb.core.link import link
from roah_rsbb.wording import language

LANGUAGES = sorted(path.stem for path in catalogues.FOLDER.glob("*.ts"))

# What programs print or log, and errors of files. No window shows it.
NOT_IN_WINDOWS = {
    "rqt/panels/__init__.py", "rqt/programs.py", "rqt/qt.py", "rqt/process.py",
    "wording/language.py", "wording/texts.py",
}
# Literals that look like texts: names of classes, keys and time zones, and what rospy and the core say.
NOT_TEXTS = {
    "Esc", "Shift+Esc", "UTC", "{} UTC", "OK", "PANEL", "{}Panel",
    "Devices", "{} – RoAH RSBB", "WARNING", "ERROR", "ALL", "all robots",
    "Fusion", "unable to connect to service", "unable to contact master",
    "transport error",
}


@pytest.mark.parametrize(
    "path", texts_in_code.files(), ids=lambda path: path.relative_to(texts_in_code.PACKAGE).as_posix())
def test_all_texts_are_translated(path):
    """A failure? Write the text as `tr("Text with a {value}", value=…)`, or as `tr_later("…")` in a constant."""
    found = texts_in_code.find_in(path)
    assert found.wrong == [], "write places for values, such as tr('zone {zone}', zone=zone)"
    place = path.relative_to(texts_in_code.PACKAGE).as_posix()
    if place not in NOT_IN_WINDOWS:
        assert [text for text in found.forgotten if text.text not in NOT_TEXTS] == []


@pytest.mark.long
def test_the_lists_of_exceptions_are_up_to_date():
    forgotten = {text.text for path in texts_in_code.files() for text in texts_in_code.find_in(path).forgotten}
    files = {path.relative_to(texts_in_code.PACKAGE).as_posix() for path in texts_in_code.files()}
    assert NOT_TEXTS - forgotten == set()
    assert NOT_IN_WINDOWS - files == set()


@pytest.mark.parametrize("code, texts", [
    ('label.setText("none")', ["none"]),
    ('QLabel("Team")', ["Team"]),
    ('QLineEdit(placeholderText="Search (Ctrl+F)")', ["Search (Ctrl+F)"]),
    ('self.say(f"Stop {zone} …")', ["Stop {} …"]),
    ('box.show_text("ON" if on else "off", tone)', ["ON", "off"]),
    ('COLUMNS = ("Time", "Clock skew")', ["Time", "Clock skew"]),
    ('WORDS = {"idle": "NOT CONNECTED", "running": "RUNNING"}', ["NOT CONNECTED", "RUNNING"]),
    ('text = f"{count} of {all}"', ["{} of {}"]),
    ('text = f"{count}{\' more\' if count else \'\'}"', [" more"]),
    ('def f():\n    return "just now"', ["just now"]),
    ('ask(self, "Disconnect?", tr("Yes"))', ["Disconnect?"]),
    # What no window shows, and what is translated.
    ('"""A module."""\n"not a docstring, but two words"', ["not a docstring, but two words"]),
    ('class C:\n    """What it is."""\n    KEY = "current_zone"', []),
    ('label.setText(tr("Nothing is running in {zone}", zone=zone))', []),
    ('COLUMNS = (tr_later("Time"), tr_later("Clock skew"))', []),
    ('rospy.logwarn("A panel failed: %s", text)', []),
    ('panel = panels["ScoringPanel"]; call("/core/score"); state == "running"', []),
    ('label.setText(f"{mark} {value}")', []),
    ('widget.setStyleSheet(f"color: {tone.text};")', []),
])
def test_the_finder_of_forgotten_texts(code, texts):
    assert [text.text for text in find(code, "file.py").forgotten] == texts


@pytest.mark.parametrize("code", [
    'tr(f"zone {zone}")', 'tr("zone " + zone)', 'tr("zone {}".format(zone))', 'tr("on" if on else "off")',
])
def test_a_text_that_is_composed_before_it_is_translated_is_found(code):
    assert len(find(code, "file.py").wrong) == 1


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_language_has_all_texts_and_no_others(language):
    """A failure? Run tools/update_languages, and translate what is new."""
    entries = catalogues.read(catalogues.FOLDER / f"{language}.ts")[catalogues.CONTEXT]
    assert catalogues.updated(entries, texts_in_code.marked()) == entries, "run tools/update_languages"
    assert [entry.text for entry in entries if not all(entry.forms)] == [], "they are not translated"


@pytest.mark.parametrize("language", LANGUAGES)
def test_translations_have_the_places_and_edges_of_their_texts(language):
    """A text that ends with an ellipsis, a question mark or a space does so in all languages."""
    for context in catalogues.read(catalogues.FOLDER / f"{language}.ts").values():
        for entry in context:
            for form in entry.forms:
                what = f"{entry.text!r}: {form!r}"
                assert placeholders(form) == placeholders(entry.text), what
                assert (form[:1] == " ", form[-1:] == " ") == (entry.text[:1] == " ", entry.text[-1:] == " "), what
                assert [form.endswith(end) for end in "…?:"] == [entry.text.endswith(end) for end in "…?:"], what
                assert form.count("\n") == entry.text.count("\n"), what


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_file_is_as_the_tool_writes_it(language, tmp_path):
    """Otherwise the next run of tools/update_languages would change more than the new texts."""
    path = catalogues.FOLDER / f"{language}.ts"
    again = tmp_path / path.name
    catalogues.write(again, catalogues.read(path))
    assert again.read_text(encoding="utf-8") == path.read_text(encoding="utf-8")


# -- choosing ---------------------------------------------------------------------------------------


@pytest.fixture(name="of_windows")
def _of_windows():
    pytest.importorskip("rospkg")
    pytest.importorskip("PyQt5.QtCore")
    from roah_rsbb.rqt import process as of_windows

    return of_windows


@pytest.mark.parametrize("environment, expected", [
    ({}, "en"),
    ({"LANG": "C"}, "en"),
    ({"LANG": "C.UTF-8", "LANGUAGE": "de"}, "en"),
    ({"LANG": "en_US.UTF-8"}, "en"),
    ({"LANG": "de_DE.UTF-8"}, "de"),
    ({"LANG": "de"}, "de"),
    ({"LANG": "de_AT.UTF-8@euro"}, "de"),
    ({"LANG": "tlh_DE.UTF-8"}, "en"),
    ({"LANG": "de_DE.UTF-8", "LC_ALL": "C.UTF-8"}, "en"),
    ({"LANG": "de_DE.UTF-8", "LC_ALL": ""}, "de"),
    ({"LANG": "en_US.UTF-8", "LC_MESSAGES": "de_DE.UTF-8"}, "de"),
    ({"LANG": "de_DE.UTF-8", "LC_MESSAGES": "C"}, "en"),
    ({"LANG": "de_DE.UTF-8", "LANGUAGE": "en_GB:de"}, "en"),
    ({"LANG": "en_US.UTF-8", "LANGUAGE": "tlh:de_CH"}, "de"),
])
def test_the_environment_chooses_the_language(of_windows, environment, expected):
    assert of_windows.chosen_language(catalogues.FOLDER, environment) == expected


def test_counts_choose_the_form(of_windows):
    texts = {("roah_rsbb", "+{n} days"): ("+{n} Tag", "+{n} Tage"), ("QPlatformTheme", "Cancel"): ("Abbrechen",)}
    catalogue = of_windows.Catalogue("de_AT", texts)
    forms = [catalogue.translate("roah_rsbb", "+{n} days", None, n) for n in (0, 1, 2)]
    assert forms == ["+{n} Tage", "+{n} Tag", "+{n} Tage"]
    assert of_windows.Catalogue("fr", texts).translate("roah_rsbb", "+{n} days", None, 0) == "+{n} Tag"
    assert catalogue.translate("QPlatformTheme", "Cancel") == "Abbrechen"
    assert catalogue.translate("roah_rsbb", "Cancel") is None


def test_unfinished_translations_are_shown_in_english(of_windows, tmp_path):
    path = tmp_path / "fr.ts"
    entries = [catalogues.Entry("stopped", "", ("",)), catalogues.Entry("no", "", ("non",))]
    catalogues.write(path, {catalogues.CONTEXT: entries})
    assert of_windows.read_texts(path) == {("roah_rsbb", "no"): ("non",)}


# Shows a text and a button of Qt in the language of its environment; a German text must not reach what is written.
SHOWING = """
from roah_rsbb.rqt import application
from roah_rsbb.rqt.qt import QDialogButtonBox
from roah_rsbb.wording import sheets, times

app = application.make_application(["test", "-platform", "offscreen"])
buttons = QDialogButtonBox(QDialogButtonBox.Close)
print(sheets.phase("running"), "|", times.ago(4), "|", buttons.buttons()[0].text())
"""


@pytest.mark.parametrize("locale, shown", [
    ("de_DE.UTF-8", "LÄUFT | vor 4 s | Schließen"), ("C.UTF-8", "RUNNING | 4 s ago | Close"),
])
def test_a_program_with_windows_shows_it(of_windows, locale, shown):
    root = catalogues.ROOT
    done = subprocess.run(
        [sys.executable, "-c", SHOWING], stdout=subprocess.PIPE, timeout=300, check=True,
        env={**os.environ, "LC_ALL": locale, "PYTHONIOENCODING": "utf-8",
             "ROS_PACKAGE_PATH": str(root)},
    )
    assert done.stdout.decode("utf-8").strip() == shown


def test_without_windows_all_texts_are_english():
    """Terminal, pages, exports and the core, in a German environment."""
    done = subprocess.run(
        [sys.executable, "-c", "from roah_rsbb.wording import sheets; print(sheets.phase('running'))"],
        stdout=subprocess.PIPE, text=True, check=True,
        env={**os.environ, "LC_ALL": "de_DE.UTF-8"},
    )
    assert done.stdout == "RUNNING\n"
    users = {
        path.relative_to(texts_in_code.PACKAGE).as_posix()
        for path in texts_in_code.PACKAGE.rglob("*.py") if "set_translation" in path.read_text(encoding="utf-8")
    }
    assert users == {"wording/language.py", "rqt/process.py"}


# -- sentences of the core --------------------------------------------------------------------------


@pytest.fixture(name="german")
def _german():
    translations = {
        "No message from the robot for {time} s": "Seit {time} s keine Nachricht vom Roboter",
        "manual operation": "Handeingriff",
    }
    language.set_translation(lambda text, n: translations.get(text, text))
    yield
    language.set_translation(None)


@pytest.mark.parametrize("sent, shown", [
    (link.SILENT(time="4"), "Seit 4 s keine Nachricht vom Roboter"),
    ("manual operation", "Handeingriff"),
    ("No message from the robot for 5 s but old ones", "No message from the robot for 5 s but old ones"),
    ("Already connected", "Already connected"),
    ("a sentence {that} is not in the list", "a sentence {that} is not in the list"),
    ("", ""),
])
def test_sentences_of_the_box_are_translated_where_they_are_shown(german, sent, shown):
    assert language.tr_said(sent) == shown


def test_sentences_of_the_box_are_english_in_english():
    assert language.tr_said(link.SILENT(time="4")) == "No message from the robot for 4 s"
