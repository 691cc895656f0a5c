"""What panels and phones show as off is what the core refuses."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import BUMPS, DOOR
from helpers.jury import Jury, judged
from roah_rsbb.core.actions.table import Target
from roah_rsbb.model.reason import Refused
from roah_rsbb.wording.judging import JudgeLine, Judging, off

NAMES = ("Ben", "Cleo")
STATES = {
    "nobody": lambda jury: None,
    "begun": lambda jury: jury.mark("Ben", DOOR, 1),
    "one": lambda jury: _sheets(jury, 1),
    "agree": lambda jury: _sheets(jury, 1, 1),
    "differ": lambda jury: _sheets(jury, 1, 2),
    "waived": lambda jury: (_sheets(jury, 1), _act(jury, "waive", reason="Cleo is ill")),
    "over": lambda jury: (_sheets(jury, 1, 1), jury.finish()),
    "published": lambda jury: (_sheets(jury, 1, 1), jury.finish(), _act(jury, "publish")),
}
GIVEN = {
    "settle": {"group": BUMPS.group, "desc": BUMPS.desc, "value": 2, "reason": "the video"},
    "hand_back": {"judge": "Ben", "reason": "look again"}, "withdraw_sheet": {"judge": "Ben", "reason": "ill"},
    "waive": {"reason": "Cleo is ill"}, "publish": {}, "object": {"by": "Alpha", "text": "no"},
}


# Off, and no error: another head referee may have been quicker.
REPEATED = {("waived", "waive")}


def _act(jury, name, **given):
    jury.driver.event(jury.driver.box.act, Target(*jury.name), name, "Hugo", given)


def _sheets(jury, *bumps):
    for name, value in zip(NAMES, bumps):
        jury.mark(name, BUMPS, value)
        jury.submit(name)


def _shown(found):
    """As faces read it from the message of the core (`nodes/core/judging_convert.py`)."""
    waiver, published = found.record.judging.waiver, found.record.publication.published
    return Judging(
        found.record.zone, found.record.identity, 1, found.count, found.agreement, found.missing, found.is_complete,
        tuple(JudgeLine(sheet.judge, sheet.submitted_utc or None, sheet.again) for sheet in found.active),
        "" if waiver is None else waiver.reason, 0, None if published is None else published.utc)


@pytest.mark.parametrize("action", GIVEN)
@pytest.mark.parametrize("state", STATES)
def test_what_is_shown_as_off_is_refused(state, action):
    jury = Jury(BoxDriver(judged()))
    STATES[state](jury)
    why = off(_shown(jury.judging()), bool(jury.record().closed_utc))[action]
    try:
        _act(jury, action, **GIVEN[action])
    except Refused:
        assert why
    else:
        assert bool(why) == ((state, action) in REPEATED)
