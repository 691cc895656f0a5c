"""Online Data: the robot's reports during the run (docs/referee.md, "Online Data")."""

from roah_rsbb.msg import ZoneState
from roah_rsbb.rqt.panels.text_panel import TextPanel


class OnlineDataPanel(TextPanel):
    """Notifications, activation events, visitors and commands of the zone's robot."""

    TITLE = "Online Data"
    NOTHING = "No online data from the robot yet"

    def text_of(self, zone: ZoneState) -> str:
        return zone.online_data
