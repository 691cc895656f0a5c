"""The name that a terminal gives itself in the box's records."""

from roah_rsbb.model.document import BoxSeen, Document, Public
from roah_rsbb.referee.link import Link, caller_name
from roah_rsbb.wording.times import Moments, use_zone


def test_a_caller_has_a_name_that_ros_allows() -> None:
    assert caller_name("referee").startswith("/referee_")
    assert caller_name("référée")[1:].replace("_", "").isalnum() and caller_name("référée").isascii()


def test_times_are_those_of_the_venue(monkeypatch) -> None:
    for zone, shown in (("Asia/Tokyo", "09:00:00 JST"), ("UTC", "00:00:00 UTC")):
        document = Document(BoxSeen("uuid", "", 0), {}, {}, {}, {}, {}, public=Public(time_zone=zone))
        monkeypatch.setattr(Link, "document", document)
        monkeypatch.setattr(Link, "is_old", False)
        Link().open()
        assert Moments().with_zone(0.0) == shown
        assert Link().box is document
    use_zone("")
