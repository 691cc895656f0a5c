"""The walk "Add a field" of docs/architecture.md, on a copy of the sources: no face is changed, and all show it."""

import pytest

from helpers.walks import changed_copy, run, steps

pytestmark = pytest.mark.long


@pytest.fixture(scope="module", name="found")
def _found(tmp_path_factory):
    """What the document and the faces show of a run, with the new field."""
    return run(changed_copy(tmp_path_factory.mktemp("tree"), "Add a field"), """
        from helpers.box_driver import BoxDriver
        from roah_rsbb.core.views.document import Documents
        from roah_rsbb.document.document import Followed, DocumentReader, Written
        from roah_rsbb.model.document import Document
        from roah_rsbb.referee.view import Style, zone_lines
        from roah_rsbb.web.device_documents import zone_page
        from roah_rsbb.wording.times import Moments
        driver = BoxDriver()
        driver.executing()
        written, follower, client = Written(Document), DocumentReader(), Followed(Document)
        written.update(Documents(driver.box, "uuid", "").look(driver.now), driver.now)
        client.take(json.loads(follower.next(written, driver.now)))
        zone = client.document.zones["tbm"]
        terminal = zone_lines(zone, driver.now, Style(False, Moments(False)))
        page = zone_page(zone, client.document, driver.now.utc)
        print(json.dumps([zone.robot.host, list(zone.state), terminal, page["state"]]))
    """)


def test_it_is_in_the_document(found):
    assert found[0] == "10.0.0.2"


def test_the_panels_the_terminal_and_the_page_show_it(found):
    """The panel shows the lines of the zone's state as they are."""
    _, panel, terminal, page = found
    for lines in (panel, terminal, page):
        assert [line for line in lines if "Address of the robot: 10.0.0.2" in line], lines


def test_it_is_a_change_of_few_files():
    assert len({step.file for step in steps("Add a field")}) <= 4
