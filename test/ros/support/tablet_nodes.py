"""Support for the tests of the tablet: the address of its page, and tablet nodes that a test starts."""

from typing import Any

import rospy

from support.programs import Program, own
from support.robots import BROADCAST, RSBB_PORT
from support.waiting import wait_until

# See README.md; the launched node has the one that box.launch.xml gives it.
OWN_TABLET_PORT = RSBB_PORT + 96


def launched_url() -> str:
    """The address of the page that the launched node serves."""
    return wait_until(
        lambda: rospy.get_param("/roah_rsbb_web/tablet_url", None), "the tablet's node says where its page is"
    )


def node(**params: Any) -> Program:
    """A tablet node beside the launched one. Its page is at OWN_TABLET_PORT."""
    values = {"web": False, "tablet": True, "rsbb_host": BROADCAST, "rsbb_port": RSBB_PORT,
              "tablet_port": OWN_TABLET_PORT, **params}
    return Program(
        own("roah_rsbb_web"), "__name:=own_tablet", *(f"_{k}:={v}" for k, v in values.items())
    )


def own_url() -> str:
    """The address of the page of `node`."""
    return f"http://127.0.0.1:{OWN_TABLET_PORT}/"
