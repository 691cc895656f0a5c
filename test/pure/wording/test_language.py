"""Texts never raise: every text is shown in every language with every kind of value, and gets the values that it needs.

STOP is drawn beside these texts, so an error in one of them must not reach it.
"""

import collections
import inspect
import json
import logging
import string

import pytest

from helpers import catalogues, texts_in_code
from helpers.texts_in_code import fields
from roah_rsbb.core import copies
from roah_rsbb.core.robots import RobotId
from roah_rsbb.core.runs import functionality
from roah_rsbb.journal import copy_folder
from roah_rsbb.model.reason import Reason, decode, encode
from roah_rsbb.model.records import GroupPoints, SheetPoints
from roah_rsbb.model.scoring import TIME_LEFT
from roah_rsbb.standby import remote
from roah_rsbb.wording import language, sheets, stop, times
from roah_rsbb.wording.language import in_language, read_texts, tr, translation, translations

PATHS = sorted(catalogues.FOLDER.glob("*.ts"))
CATALOGUES = {path.stem: translation(path.stem, read_texts(path)) for path in PATHS}
LANGUAGES = [None, *CATALOGUES]  # None: English


class Unprintable:
    """A value that cannot be shown."""

    def __str__(self):
        raise RuntimeError("no text")

    __repr__ = __str__


TEXT_VALUES = ["Home A", "", "{text}", "}{", "{0}", "100 %s %d %", "two\nlines", "🤖 Ä ‮", "<b>&amp;</b>", "x" * 100_000]
NUMBERS = [0, 1, 2, -1, 10**30, 0.0, 1.5, -0.25, float("nan"), float("inf")]
WRONG_VALUES = [None, [], Unprintable()]


class Lines(logging.Handler):
    """Keeps the lines of a log."""

    def __init__(self):
        super().__init__()
        self.lines = []

    def emit(self, record):
        self.lines.append(record.getMessage())


@pytest.fixture(name="logged")
def _logged(monkeypatch):
    """What is logged of texts that could not be shown. Nothing was logged before."""
    handler, log = Lines(), logging.getLogger(language.__name__)
    monkeypatch.setattr(language, "_reported", set(), raising=False)
    log.addHandler(handler)
    yield handler.lines
    log.removeHandler(handler)


def _formats(text):
    return [(name, spec) for _, name, spec, _ in string.Formatter().parse(text) if name is not None]


def _all_texts():
    of_files = (entry.text for path in PATHS for entry in catalogues.read(path)[catalogues.CONTEXT])
    return list(dict.fromkeys([*texts_in_code.marked(), *of_files]))


# -- the rules of `tr` -------------------------------------------------------------------------------


@pytest.mark.parametrize("text, values, shown", [
    ("Stop", {}, "Stop"),
    ("Stop {zone}", {"zone": "A"}, "Stop A"),
    ("{braces} without values", {}, "{braces} without values"),
    ("Manual operation: {text}", {"text": "take {it}"}, "Manual operation: take {it}"),
    ("{self} {values} {translate}", {"self": 1, "values": 2, "translate": 3}, "1 2 3"),
])
@pytest.mark.parametrize("translate", [None, lambda text, n: text])
def test_a_text_is_shown_with_its_values(logged, translate, text, values, shown):
    with in_language(translate):
        assert tr(text, **values) == shown
    assert logged == []


def _raise(text, n):
    raise RuntimeError("a damaged catalogue")


@pytest.mark.parametrize("translate", [
    _raise, lambda text, n: "Stopp {zone} {other}", lambda text, n: "Stopp {zone", lambda text, n: "Stopp {zone:d}",
    lambda text, n: "Stopp {}", lambda text, n: None, lambda text, n: 7, lambda text: text,
])
def test_a_text_that_cannot_be_translated_is_in_english_and_logged_once(logged, translate):
    with in_language(translate):
        assert [tr("Stop {zone}", zone="A") for _ in range(3)] == ["Stop A"] * 3
    message, = logged
    assert message.startswith("This text cannot be translated, so it is in English: 'Stop {zone}'")


@pytest.mark.parametrize("translate", [None, _raise])
@pytest.mark.parametrize("values", [{"other": 1}, {"zone": Unprintable()}])
def test_a_text_without_usable_values_keeps_its_places(logged, translate, values):
    with in_language(translate):
        assert tr("Stop {zone}", **values) == "Stop {zone}"
    assert len(logged) == 1


# -- every text --------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_the_places_of_a_text_have_the_same_formats_in_all_its_forms(path):
    for context in catalogues.read(path).values():
        for entry in context:
            assert all(sorted(_formats(one)) == sorted(_formats(entry.text)) for one in entry.forms), entry


def test_no_place_has_the_name_of_a_parameter():
    """`tr(text, **values)` would get two values for it. Positional parameters do not count."""
    parameters = {name for name, one in inspect.signature(tr).parameters.items()
                  if one.kind not in (one.POSITIONAL_ONLY, one.VAR_KEYWORD)}
    for text in _all_texts():
        assert not fields(text) & parameters, text
        assert all(name.isidentifier() for name in fields(text)), f"{text!r}: no value can be given"


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_text_shows_every_kind_of_value(logged, code):
    with in_language(CATALOGUES.get(code)):
        for text in _all_texts():
            for value in (*TEXT_VALUES, *NUMBERS):
                is_number = not isinstance(value, str)
                # A place with a format, such as {time:.0f}, is for a number; a count chooses the form.
                usable = {name: value if is_number or not (spec or name == "n") else 7 for name, spec in _formats(text)}
                if any(spec.endswith("d") for _, spec in _formats(text)) and not isinstance(value, int):
                    usable.update({name: 7 for name, spec in _formats(text) if spec.endswith("d")})
                shown = tr(text, **usable)
                for name, spec in _formats(text):
                    assert language.number(format(usable[name], spec)) in shown, (text, value)
    assert logged == []


@pytest.mark.parametrize("code", LANGUAGES)
def test_no_text_raises_with_a_wrong_value(logged, code):
    with in_language(CATALOGUES.get(code)):
        for text in _all_texts():
            for value in (*TEXT_VALUES, *WRONG_VALUES):
                for given in (fields(text), {*fields(text), "another"}, set(sorted(fields(text))[1:])):
                    assert isinstance(tr(text, **{name: value for name in given}), str)
    assert len(logged) <= len(_all_texts())


# -- the calls ---------------------------------------------------------------------------------------


def test_calls_give_the_values_that_their_texts_have_places_for():
    assert len(texts_in_code.calls()) > 600
    wrong = [(call.place, call.line, sorted(call.values), text) for call in texts_in_code.calls() for text in call.texts
             if call.values != fields(text)]
    assert wrong == []


def test_texts_that_come_from_another_place_get_their_values_too():
    """Such as the label of a command: some call gives exactly the values that the text has places for."""
    calls = texts_in_code.calls()
    direct = {text for call in calls for text in call.texts}
    given = {call.values for call in calls if not call.texts} | {frozenset()}
    others = [text for text in texts_in_code.marked() if text not in direct and text not in SENTENCES]
    assert [text for text in others if fields(text) not in given] == []


# -- sentences of the box -----------------------------------------------------------------------------


SENTENCES = list(dict.fromkeys(text.text for text in texts_in_code.said()))


def sent(reason):
    """A sentence as it comes in the document of the box."""
    return decode(json.loads(json.dumps(encode(reason))))


def test_a_template_is_registered_once():
    """Two places may say the same only if they share it."""
    times = collections.Counter(text.text for text in texts_in_code.said())
    assert [(text.text, text.place) for text in texts_in_code.said() if times[text.text] > 1] == []


def test_a_manual_operation_is_shown_in_german(logged):
    """Its place has the name of a parameter of `tr`, which raised for every German referee."""
    sentence = functionality.ASKED(text="hold the door {open}")
    with in_language(CATALOGUES["de"]):
        assert language.tr_said(sent(sentence)) == "Handeingriff: hold the door {open}"
        assert stop.way_text(stop.Way.LOST_BOX, "A").startswith("STOPP A: NICHT")
    assert logged == []


def test_a_reason_in_a_sentence_is_translated_too(logged):
    why = remote._REPORTS(why=copy_folder._FULL(folder="/far"))
    sentence = copies.LAST_ENTRIES(why=copies.ONE_COMPUTER(why=why, place="/s.yaml:3"))
    with in_language(CATALOGUES["de"]):
        assert language.tr_said(sent(sentence)) == (
            "NICHT BESTÄTIGT: Dem Standby fehlen die letzten Einträge: Der Standby meldet: Der Datenträger ist voll. "
            "Schaffen Sie Platz für /far. Um mit einem Computer fortzufahren, löschen Sie 'durable: two' in /s.yaml:3, "
            "und laden Sie neu")
    assert logged == []


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_sentence_is_shown_with_every_kind_of_value(logged, code):
    translate = CATALOGUES.get(code, lambda text, n: text)
    with in_language(CATALOGUES.get(code)):
        for sentence in SENTENCES:
            for value in (*TEXT_VALUES, *NUMBERS):
                values = {name: value for name in fields(sentence)}
                reason = Reason(sentence, values)
                shown_text = language.tr_said(sent(reason))
                if "\x00" not in str(value) and value == value:  # NaN is not the same in JSON
                    shown_values = {name: language.number(format(each)) for name, each in values.items()}
                    assert shown_text == (translate(sentence, -1).format(**shown_values) if values else
                                          translate(sentence, -1)), sentence
    assert logged == []


@pytest.mark.parametrize("text", TEXT_VALUES)
@pytest.mark.parametrize("code", LANGUAGES)
def test_what_the_box_says_besides_is_shown_unchanged(logged, code, text):
    with in_language(CATALOGUES.get(code)):
        assert language.tr_said(text) == text
    assert logged == []


@pytest.mark.parametrize("broken", [[1, 2], 7, ["a {b}", {}], ["{0}", {"b": 1}], None, ["{", {"b": 1}]])
def test_broken_sentences_prevent_nothing(logged, broken):
    with in_language(CATALOGUES["de"]):
        assert isinstance(language.tr_said(decode(broken)), str)
        assert language.tr_said("Already started") == "Schon gestartet"


def test_a_file_is_read_when_its_language_is_needed(tmp_path):
    path = tmp_path / "de.ts"
    known = translations([path])
    path.write_bytes((catalogues.FOLDER / "de.ts").read_bytes())
    with in_language(known["de"]):
        text = next(text for _, text in read_texts(path) if tr(text) != text)
    path.unlink()
    with in_language(known["de"]):
        assert tr(text) != text  # it is read once


@pytest.mark.parametrize("text, shown", [
    ("866.662", "866,662"), ("-0.5", "-0,5"), ("+0.150 s", "+0,150 s"), ("0.5 %", "0,5 %"), ("7", "7"),
    ("10.0.0.3", "10.0.0.3"), ("1.2.0", "1.2.0"), ("r1.5", "r1.5"), ("1.", "1."), ("6.30 to 7.30", "6.30 to 7.30"),
])
def test_a_decimal_number_has_the_sign_of_the_readers_language(text, shown):
    assert language.number(text) == text
    with in_language(CATALOGUES["de"]):
        assert language.number(text) == shown
        assert tr("{text} s", text=text) == f"{shown} s"


def test_a_german_reader_sees_points_in_german():
    points = sheets.points_said(SheetPoints("866.662", (GroupPoints("Table", "800"), GroupPoints(TIME_LEFT, "66.662"))))
    assert points == "866.662 points: Table 800 · Time left 66.662"
    with in_language(CATALOGUES["de"]):
        assert language.tr_said(decode(encode(points))) == "866,662 Punkte: Table 800 · Restzeit 66,662"
        assert language.tr_said(str(RobotId("Beta", "r2"))) == "r2 von Team Beta"
        assert tr("{time:.1f} s", time=1.25) == "1,2 s"
        assert (times.elapsed(598.3), times.skew(0.15)) == ("9:58,3", "+0,150 s")
        assert sheets.item_value("decimal", 0, text="2.5") == "2,5"
