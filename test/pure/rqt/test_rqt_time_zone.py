"""Panels show the time of the venue, on whatever computer they are."""

from types import SimpleNamespace

import pytest

from roah_rsbb.model.document import BoxSeen, Document, Public
from roah_rsbb.wording.times import Moments


def test_times_are_those_of_the_venue():
    model = pytest.importorskip("roah_rsbb.rqt.model")
    document = Document(BoxSeen("uuid", "", 0), {}, {}, {}, {}, {}, public=Public(time_zone="Asia/Tokyo"))
    shown = SimpleNamespace(afar=SimpleNamespace(number=1, document=document), _look=lambda: None)
    model.Model._take(shown)
    assert Moments().with_zone(0.0) == "09:00:00 JST"
    assert Moments(in_utc=True).with_zone(0.0) == "00:00:00 UTC"
