"""Online Data: the robot's reports during the run (docs/referee.md, "Online Data")."""

from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.rqt.panels.text_panel import TextPanel
from roah_rsbb.wording.language import tr_later


class OnlineDataPanel(TextPanel):
    """Notifications, activation events, visitors and commands of the zone's robot."""

    TITLE = tr_later("Online Data")
    TAB = tr_later("Online")
    NOTHING = tr_later("No online data from the robot yet")

    def text_of(self, zone: ZoneSeen) -> str:
        return zone.online_data
