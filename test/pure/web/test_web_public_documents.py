"""The documents of the gateway, and what each reader is sent. Without sockets and without time."""

import json
import pathlib

import pytest

from helpers import catalogues
from helpers.public_box import PublicBox, event, explanation, result, run, standing
from helpers.shown_box import NOW
from helpers.time_zones import local_time
from roah_rsbb.model.document import REPLAY as PREFIX
from roah_rsbb.model.reason import say
from roah_rsbb.web.numbered import Viewer
from roah_rsbb.web.public_documents import DATA, PAGE_EXPLAINED, TEXTS, Store
from roah_rsbb.wording.language import read_texts, translation

SCHEMAS = pathlib.Path(__file__).resolve().parents[3] / "resource" / "web" / "schemas"
EVENTS = (event(after_s=900.0), event("Hall", "ALL"))


@pytest.fixture(autouse=True)
def _utc():
    with local_time("UTC"):
        yield


class World(Store):
    """A store whose box changes as the test says."""

    def __init__(self):
        german = translation("de", read_texts(catalogues.FOLDER / "de.ts"))
        super().__init__(PublicBox(), {"de": german}, title="Open")
        self.session = "s1"

    def put(self, *runs, following=EVENTS, **sections):
        """The box publishes this."""
        self.box.publish(runs, following, **sections)
        return self.look()

    def pass_time(self, seconds):
        self.box.mono += seconds
        return self.look()


@pytest.fixture
def store():
    return World()


def data(store, name, language=""):
    return json.loads(store.document((name, language)).text)


def number(store, name, language=""):
    return store.document((name, language)).number


def sent(viewer):
    text = viewer.next()
    return None if text is None else json.loads(text)


# -- documents --------------------------------------------------------------------------------------


def test_the_documents_say_what_is_public(store):
    store.put(run(), results=[result(), result("Beta", 1, signed=False)], standings=[standing()])
    (shown,) = data(store, "state")["runs"]
    assert shown == {
        "zone": "Home", "benchmark": "Visitors", "team": "Alpha", "round": 2, "run": 3, "scheduled": NOW + 600.0,
        "teams": ["Alpha"], "phase": "running", "end_reason": "", "activity": "", "counting": True,
        "unlimited": False, "ends": NOW + 90.0, "counts_from": None, "left_s": None, "elapsed_s": None,
    }
    assert [(one["zone"], one["team"]) for one in data(store, "schedule")["events"]] == [
        ("Home", "Alpha"), ("Hall", "ALL")]
    assert data(store, "results")["results"][0]["groups"] == [{"name": "Achievements", "not_attempted": 0, "items": [
        {"name": "doors", "kind": "count", "value": 3}, {"name": "greeted", "kind": "bool", "value": 1}]}]
    assert [one["team"] for one in data(store, "results")["provisional"]] == ["Beta"]
    assert data(store, "standings")["standings"][0]["ranks"] == [{"rank": "1", "team": "Alpha", "numbers": ["4.5"]}]
    notes = "nobody yet", say("{team} waits")(team="Beta")
    store.keys(["page.standings"], "en")
    store.put(standings=[standing()._replace(notes=notes)])
    assert data(store, "page.standings", "en")["standings"][0]["notes"] == [
        {"note": "nobody yet", "team": ""}, {"note": "Beta waits", "team": "Beta"}]


@pytest.mark.parametrize("of_run, expected", [
    ({"counting": False}, {"left_s": 90.0}),
    ({"elapsed": 12.5}, {"counts_from": NOW - 12.5}),
    ({"elapsed": 12.5, "counting": False}, {"elapsed_s": 12.5}),
])
def test_the_times_of_a_run(store, of_run, expected):
    store.put(run(**of_run))
    (shown,) = data(store, "state")["runs"]
    names = ("ends", "counts_from", "left_s", "elapsed_s")
    assert {name: shown[name] for name in names} == {**dict.fromkeys(names), **expected}


def test_time_alone_changes_nothing(store):
    store.keys(TEXTS, "en")
    store.put(run())
    before = {key: store.document(key) for key in store.keys(DATA + TEXTS, "en")}
    for _ in range(10):
        assert not store.pass_time(0.5)
    store.box.utc_slews(0.04)
    assert not store.look()
    assert {key: store.document(key) for key in before} == before
    store.box.utc_slews(0.02)
    assert store.look() and data(store, "state")["runs"][0]["ends"] == NOW + 90.06
    assert number(store, "state") == number(store, "page.runs", "en") == 2


def test_only_what_changed_gets_a_new_number(store):
    store.put(run())
    store.put(run(counting=False))
    assert [number(store, name) for name in DATA] == [2, 1, 1, 1, 1]
    store.put(run(counting=False), results=[result()])
    assert [number(store, name) for name in DATA] == [2, 1, 2, 1, 1]
    assert not store.put(run(counting=False), results=[result()])


def test_texts_are_made_only_in_languages_that_somebody_reads(store):
    store.put(run())
    assert store.document(("page.runs", "de")) == store.document(("page.runs", "en"))
    store.keys(["page.runs"], "de")
    assert data(store, "page.runs", "de")["runs"][0]["word"] == "läuft"
    assert data(store, "page.words", "de")["next"] == "Als Nächstes"
    assert number(store, "page.runs", "en") == 0
    store.keys(["page.runs"], "en")
    assert data(store, "page.runs", "en")["runs"][0]["word"] == "running"


def test_a_replay_is_marked_in_the_language_of_the_reader(store):
    store.keys(["page.runs"], "de")
    store.put(run())
    assert data(store, "page.runs", "de")["replay"] == ""
    document = store.box.document
    store.box.document = document._replace(box=document.box._replace(uuid=f"{PREFIX}box"))
    assert store.look()
    assert data(store, "page.runs", "de")["replay"] == "WIEDERGABE: nicht live"


def test_a_page_counts_by_itself(store):
    store.keys(TEXTS, "en")
    store.put(run())
    (shown,) = data(store, "page.runs", "en")["runs"]
    assert (shown["big"], shown["ends"], shown["limit"], shown["place"]) == (
        "{time}", NOW + 90.0, 600.0, "Home · round 2, run 3")
    store.put(run(counting=False))
    (shown,) = data(store, "page.runs", "en")["runs"]
    assert (shown["big"], shown["left_s"]) == ("1:30", 90.0)
    store.put(run(counting=False, elapsed=12.9))
    assert data(store, "page.runs", "en")["runs"][0]["big"] == "0:12"


def test_a_page_shows_something_before_its_script_has_come(store):
    assert "Waiting for the referee box" in store.first_frame() and "Open" in store.first_frame()
    store.put(run()._replace(event=event(team="<b>Eve")))
    assert "&lt;b&gt;Eve" in store.first_frame() and "running" in store.first_frame()


def test_the_texts_name_another_day_at_midnight(store):
    store.keys(TEXTS, "en")
    store.put(run())
    assert data(store, "page.next", "en")["lines"][0]["time"] == "08:15"
    assert data(store, "page.words", "en")["date"] == "Friday, 15 January 2027"
    store.pass_time(86400.0)
    assert data(store, "page.next", "en")["lines"][0]["time"] == "Fri 08:15"
    assert data(store, "page.words", "en")["date"] == "Saturday, 16 January 2027"


def test_times_are_those_of_the_venue(store):
    store.keys(TEXTS, "en")
    store.box.publish([run()], EVENTS)
    store.box.document = store.box.document._replace(public=store.box.document.public._replace(time_zone="Asia/Tokyo"))
    store.look()
    assert data(store, "page.next", "en")["lines"][0]["time"] == "17:15"
    assert data(store, "page.words", "en")["utc_offset_s"] == 9 * 3600


def test_a_run_is_explained_in_the_language_of_the_reader(store):
    store.keys([PAGE_EXPLAINED], "de")
    store.put(explanation(phases=("Door", "Talk"), phase_number=2))
    (one,) = json.loads(store.document((PAGE_EXPLAINED, "de")).text)["runs"]
    assert (one["zone"], one["about"]) == ("Home", "Besucher klingeln.")
    assert [step["state"] for step in one["steps"]] == ["done", "now"]
    assert len(one["said"]) == 1 and "Postman" in one["said"][0]


def test_a_zone_more_changes_the_texts_of_the_others(store):
    store.keys(TEXTS, "en")
    store.put(following=[event()])
    assert data(store, "page.next", "en")["lines"][0]["last"] == ""
    store.put(run("Hall"), following=[event()])
    assert data(store, "page.next", "en")["lines"][0]["last"] == "Home"


@pytest.mark.parametrize("wanted, expected", [
    ("", "en"), ("de", "de"), ("de-AT,en;q=0.8", "de"), ("fr-FR,de;q=0.5", "de"), ("fr", "en"), ("en-US,de", "en"),
    ("../de", "en"), ("," * 9, "en"),
])
def test_the_language(store, wanted, expected):
    assert store.language(wanted) == expected


def test_before_the_core_is_heard_a_page_has_its_words(store):
    keys = store.keys(TEXTS, "de")
    viewer = Viewer(store, keys)
    message = sent(viewer)
    assert message["documents"]["page.words"]["data"]["waiting"] == "Warte auf die Referee-Box"
    assert message["documents"]["page.runs"] == {"number": 0, "data": None}
    assert (message["clock"], message["heard"]) == (None, False)
    store.put(run())
    assert sent(viewer)["documents"]["page.runs"]["data"]["runs"]


def test_while_the_box_is_silent_its_last_state_stays(store):
    store.put(run())
    assert store.is_heard and store.clock() == NOW
    store.box.is_old = True
    assert not store.is_heard and not store.put(run(counting=False))
    store.box.is_old = False
    assert store.look() and data(store, "state")["runs"][0]["left_s"] == 90.0


def test_a_box_that_was_superseded_is_silent_for_the_public(store):
    store.put(run())
    document = store.box.document
    store.box.document = document._replace(box=document.box._replace(superseded_by="10.0.0.2"), public_runs={})
    assert not store.look() and not store.is_heard and data(store, "state")["runs"]


# -- readers ----------------------------------------------------------------------------------------


def test_a_reader_gets_a_snapshot_then_changes(store):
    store.put(run())
    viewer = Viewer(store, store.keys(DATA, "en"))
    first = sent(viewer)
    assert first["type"] == "snapshot" and set(first["documents"]) == set(DATA)
    assert sent(viewer) is None
    store.put(run(counting=False))
    change = sent(viewer)
    assert change["type"] == "change" and list(change["documents"]) == ["state"]
    assert change["documents"]["state"]["number"] == first["documents"]["state"]["number"] + 1


def test_a_slow_reader_gets_the_newest_state_and_notices_the_gap(store):
    store.put(run())
    viewer = Viewer(store, store.keys(["state"], "en"))
    first = sent(viewer)
    for step in range(1, 1001):
        store.put(run(counting=bool(step % 2), left=100.0 + step))
        viewer.beat()
    newest = sent(viewer)
    assert newest["documents"]["state"]["number"] == first["documents"]["state"]["number"] + 1000
    assert newest["documents"]["state"]["data"]["runs"][0]["left_s"] == 1100.0
    assert sent(viewer)["type"] == "clock"
    assert sent(viewer) is None, "nothing was queued"


def test_the_clock_repeats_the_numbers(store):
    store.put(run())
    viewer = Viewer(store, store.keys(["state", "schedule"], "en"))
    sent(viewer)
    viewer.beat()
    store.box.mono += 1.0
    assert sent(viewer) == {
        "type": "clock", "session": "s1", "clock": NOW + 1.0, "heard": True, "numbers": {"state": 1, "schedule": 1}}


# -- schemas ----------------------------------------------------------------------------------------


def _validator(name):
    jsonschema = pytest.importorskip("jsonschema")
    schemas = {path.name: json.loads(path.read_text(encoding="utf-8")) for path in SCHEMAS.glob("*.json")}
    for schema in schemas.values():
        jsonschema.Draft7Validator.check_schema(schema)
    known = {schema["$id"]: schema for schema in schemas.values()}
    resolver = jsonschema.RefResolver(schemas[name]["$id"], schemas[name], store=known)
    return jsonschema.Draft7Validator(schemas[name], resolver=resolver)


@pytest.mark.filterwarnings("ignore:jsonschema.RefResolver")
@pytest.mark.parametrize("of_run", [
    {}, {"counting": False}, {"elapsed": 5.0}, {"elapsed": 5.0, "counting": False},
    {"phase": "ended", "counting": False, "end_reason": "timeout", "activity": "phase 1 of 2"},
])
def test_what_is_sent_is_what_the_schemas_say(store, of_run):
    viewer = Viewer(store, store.keys(DATA + TEXTS, "de"))
    messages = [sent(viewer)]
    answers = [{name: json.loads(store.answer(name)) for name in DATA}]
    store.put(explanation(**of_run),
              explanation("Lab", doing="between", kind="functionality", goals=3, goals_ended=2, goals_completed=1),
              results=[result(), result("Beta", signed=False)], standings=[standing()])
    viewer.beat()
    messages += [sent(viewer), sent(viewer)]
    answers.append({name: json.loads(store.answer(name)) for name in DATA})
    assert [message["type"] for message in messages] == ["snapshot", "change", "clock"]
    for message in messages:
        _validator("events.json").validate(message)
    for answer in answers:
        for name in DATA:
            _validator(f"{name}.json").validate(answer[name])


@pytest.mark.filterwarnings("ignore:jsonschema.RefResolver")
@pytest.mark.parametrize("change", [
    lambda run: run.pop("ends"), lambda run: run.update(secret=1), lambda run: run.update(phase="unknown"),
])
def test_the_schemas_refuse_anything_else(store, change):
    store.put(run())
    answer = json.loads(store.answer("state"))
    change(answer["data"]["runs"][0])
    assert not _validator("state.json").is_valid(answer)


def test_every_document_of_data_has_a_schema():
    assert {path.stem for path in SCHEMAS.glob("*.json")} == {*DATA, "events"}
