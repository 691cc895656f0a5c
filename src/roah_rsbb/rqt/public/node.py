"""The node `roah_rsbb_public`: the public display, full screen."""

import sys
import time

import rospy
from python_qt_binding.QtCore import QTimer

from roah_rsbb.msg import PublicDetails
from roah_rsbb.ros.command_line import explain
from roah_rsbb.ros.feed import Feed
from roah_rsbb.rqt.app import application, display
from roah_rsbb.rqt.model.model import RENEW_S
from roah_rsbb.rqt.public.display import TOPIC, PublicDisplay
from roah_rsbb.rqt.public.screen import ScreenChoice

LOOK_MS = 100
MAX_SCREEN = 255


class _Looker:
    """Lets the display look, and subscribes anew while the core is silent."""

    def __init__(self, feed: Feed, shown: PublicDisplay, screen: ScreenChoice) -> None:
        self._feed = feed
        self._shown = shown
        self._screen = screen
        self._renewed = time.monotonic()

    def look(self) -> None:
        self._screen.look()
        self._shown.look()
        now = time.monotonic()
        if not self._shown.is_old:
            self._renewed = now
        elif now - self._renewed > RENEW_S:
            self._renewed = now
            self._feed.renew()


def _chosen_screen() -> int:
    chosen = rospy.get_param("~screen", 0)
    if isinstance(chosen, int) and not isinstance(chosen, bool) and 0 <= chosen <= MAX_SCREEN:
        return chosen
    rospy.logwarn("parameter %s: found %r, expected a whole number from 0 to %d. Screen 0 is used",
                  rospy.resolve_name("~screen"), chosen, MAX_SCREEN)
    return 0


def main() -> None:
    """Show the display until it is closed (Alt-F4) or ROS ends."""
    explain(__doc__)
    if not display.has_display():
        sys.exit(display.NO_DISPLAY)
    application.init_node("roah_rsbb_public")
    app = application.make_application(sys.argv[:1])
    feed = Feed({TOPIC: PublicDetails})
    feed.start()
    shown = PublicDisplay(feed)
    screen = ScreenChoice(shown, _chosen_screen())
    looker = _Looker(feed, shown, screen)
    looker.look()
    timer = QTimer()
    timer.timeout.connect(looker.look)
    timer.start(LOOK_MS)
    code = application.run(app)
    timer.stop()
    screen.close()
    feed.stop()
    rospy.signal_shutdown("public display closed")
    sys.exit(code)
