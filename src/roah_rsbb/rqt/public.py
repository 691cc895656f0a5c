"""The node `roah_rsbb_public`: the public display, full screen."""

import sys
import time

import rospy
from python_qt_binding.QtCore import QTimer

from roah_rsbb.client.feed import Feed
from roah_rsbb.msg import CoreToPublic
from roah_rsbb.rqt import application, display
from roah_rsbb.rqt.model import RENEW_S
from roah_rsbb.rqt.public_display import PublicDisplay

TOPIC = "/core/to_public"
LOOK_MS = 100


class _Looker:
    """Lets the display look, and subscribes anew while the core is silent."""

    def __init__(self, feed: Feed, shown: PublicDisplay) -> None:
        self._feed = feed
        self._shown = shown
        self._renewed = time.monotonic()

    def look(self) -> None:
        self._shown.look()
        now = time.monotonic()
        if not self._shown.is_old:
            self._renewed = now
        elif now - self._renewed > RENEW_S:
            self._renewed = now
            self._feed.renew()


def main() -> None:
    """Show the display until it is closed (Alt-F4) or ROS ends."""
    if not display.has_display():
        sys.exit(display.NO_DISPLAY)
    application.init_node("roah_rsbb_public")
    app = application.make_application(sys.argv[:1])
    feed = Feed({TOPIC: CoreToPublic})
    feed.start()
    shown = PublicDisplay(feed, TOPIC)
    looker = _Looker(feed, shown)
    timer = QTimer()
    timer.timeout.connect(looker.look)
    timer.start(LOOK_MS)
    shown.setGeometry(app.primaryScreen().geometry())  # for a screen without a window manager
    shown.showFullScreen()
    code = application.run(app)
    timer.stop()
    feed.stop()
    rospy.signal_shutdown("public display closed")
    sys.exit(code)
