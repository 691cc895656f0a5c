"""The node `roah_rsbb_public`: the public display, full screen."""

import os
import sys
import time
from typing import List, Optional

import rospy

from roah_rsbb.msg import PublicBoard, PublicDetails
from roah_rsbb.ros import display
from roah_rsbb.ros.command_line import explain
from roah_rsbb.ros.feed import Feed
from roah_rsbb.rqt.app import application
from roah_rsbb.rqt.model.model import RENEW_S
from roah_rsbb.rqt.public.display import BOARD_TOPIC, TOPIC, PublicDisplay
from roah_rsbb.rqt.qt import QGuiApplication, QPixmap, QScreen, QTimer, QWidget
from roah_rsbb.srv import UInt8, UInt8Response

SERVICE = "screen"


class ScreenChoice:
    """Keeps a window full screen on the chosen screen; 0 is the first one.

    A parameter and, at any time, the service `screen` choose it. The service runs in a thread of rospy; only `look`, in
    Qt's thread, touches the window.
    """

    def __init__(self, window: QWidget, chosen: int) -> None:
        self._window = window
        self._chosen = chosen
        self._logged = -1  # the missing screen that was logged
        self._count = len(QGuiApplication.screens())
        self._must_move = True
        self._service = rospy.Service(SERVICE, UInt8, self._choose)
        if self._count > 1:
            for number, screen in enumerate(QGuiApplication.screens()):
                rospy.loginfo("Screen %d (%s): rosservice call %s %d", number, _describe(screen),
                              self._service.resolved_name, number)

    def look(self) -> None:
        """Move to the chosen screen, or to the first one while it is unplugged. Call it several times a second."""
        screens = QGuiApplication.screens()
        self._count = len(screens)
        if not screens:
            return
        screen = self._screen(screens)
        handle = self._window.windowHandle()
        if self._must_move or handle is None or handle.screen() is not screen:
            self._must_move = False
            self._show_on(screen)
            rospy.loginfo("On screen %d (%s)", screens.index(screen), _describe(screen))
        elif self._window.geometry() != screen.geometry():
            self._window.setGeometry(screen.geometry())  # the resolution changed

    def _screen(self, screens: List[QScreen]) -> QScreen:
        if self._chosen < len(screens):
            self._logged = -1
            return screens[self._chosen]
        if self._logged != self._chosen:
            self._logged = self._chosen
            rospy.logwarn("%s", _missing(self._chosen, len(screens)) + ". Until then screen 0 is used")
        return screens[0]

    def _show_on(self, screen: QScreen) -> None:
        """Show the window on a screen. Hide it first: on another X screen Qt has to create it again."""
        self._window.hide()
        self._window.winId()
        self._window.windowHandle().setScreen(screen)
        self._window.setGeometry(screen.geometry())  # in case there is no window manager
        self._window.showFullScreen()

    def _choose(self, request) -> UInt8Response:
        if request.data >= self._count:
            raise rospy.ServiceException(_missing(request.data, self._count))
        self._chosen, self._must_move = request.data, True
        return UInt8Response()


def _missing(number: int, count: int) -> str:
    there_are = "there is only screen 0" if count == 1 else f"there are screens 0 to {count - 1}"
    return f"no screen {number}: {there_are}. Connect it, or call the service '{SERVICE}' with another number"


def _describe(screen: QScreen) -> str:
    size = screen.geometry()
    return f"{screen.name()}, {size.width()}x{size.height()}"


LOOK_MS = 100
MAX_SCREEN = 255


class _Looker:
    """Updates the display regularly, and subscribes again while the core is silent."""

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


def _logo() -> Optional[QPixmap]:
    """The picture in parameter `logo`; None: there is none, or it cannot be read."""
    path = os.path.expanduser(str(rospy.get_param("~logo", "")))
    if not path:
        return None
    picture = QPixmap(path)
    if not picture.isNull():
        return picture
    rospy.logwarn("parameter %s: %s cannot be read as a picture (PNG, JPEG, SVG). The display has no logo",
                  rospy.resolve_name("~logo"), path)
    return None


def main() -> None:
    """Show the display until it is closed (Alt-F4) or ROS ends."""
    explain(__doc__)
    if not display.has_display():
        sys.exit(display.NO_DISPLAY)
    application.init_node("roah_rsbb_public")
    app = application.make_application(sys.argv[:1])
    feed = Feed({TOPIC: PublicDetails, BOARD_TOPIC: PublicBoard})
    feed.start()
    shown = PublicDisplay(feed, title=str(rospy.get_param("~title", "")), logo=_logo())
    screen = ScreenChoice(shown, _chosen_screen())
    looker = _Looker(feed, shown, screen)
    looker.look()
    timer = QTimer()
    timer.timeout.connect(looker.look)
    timer.start(LOOK_MS)
    application.leave(application.run(app))
