"""What each package contains: for wheels (setup.py), Debian packages (packaging/split_deb), and the test of imports.

Paths begin at the repository's top, those of Python modules at src/. The longest entry that begins a path decides.
"""

from typing import Dict, Tuple

CONTENTS: Dict[str, Tuple[str, ...]] = {
    # A robot without ROS.
    "robot": (
        "roah_rsbb/__init__.py", "roah_rsbb/comm/", "roah_rsbb/ground/", "roah_rsbb/pb/", "roah_rsbb/protocol.py",
        "roah_rsbb/robot/", "roah_rsbb/rulebook/__init__.py", "roah_rsbb/rulebook/registry.py",
        "roah_rsbb/tools/__init__.py", "roah_rsbb/tools/team.py", "docs/protocol.md", "docs/robot_without_ros.md",
        "docs/team.md"),
    # A robot with ROS, and all that catkin generates.
    "comm": (
        "", "roah_rsbb/ros/team/", "roah_rsbb/ros/__init__.py",
        "roah_rsbb/ros/connections.py", "roah_rsbb/ros/messages.py", "roah_rsbb/ros/node.py", "roah_rsbb/msg/",
        "roah_rsbb/srv/",
        "launch/dummy_robot.launch", "launch/robot_comm.launch"),
    "check": (
        "roah_rsbb/bmbox/", "roah_rsbb/capture/", "roah_rsbb/check/", "roah_rsbb/core/", "roah_rsbb/model/",
        "roah_rsbb/radio/", "roah_rsbb/results/__init__.py", "roah_rsbb/results/page.py", "roah_rsbb/rulebook/",
        "roah_rsbb/scoring/", "roah_rsbb/wording/", "config/benchmarks.yaml", "config/modules/", "docs/check_robot.md"),
    "results": (
        "roah_rsbb/document/", "roah_rsbb/journal/", "roah_rsbb/results/",
        "config/schedule.yaml", "config/standings.yaml", "docs/results.md", "resource/replay/", "resource/report/"),
    # A box without ROS.
    "box": (
        "roah_rsbb/box/", "roah_rsbb/devices/", "roah_rsbb/client/", "roah_rsbb/referee/",
        "roah_rsbb/standby/", "roah_rsbb/tablet/", "roah_rsbb/tools/", "roah_rsbb/web/", "README.md", "config/",
        "docs/", "launch/roah_rsbb.launch", "resource/"),
    # A box with ROS.
    "ros": (
        "roah_rsbb/", "roah_rsbb/ros/team/dummy_robots.py", "roah_rsbb/tools/demo.py",
        "roah_rsbb/tools/reconnect.py", "launch/", "plugin.xml",
        "etc/roah-rsbb/", "usr/share/applications/", "changelog", "copyright"),
}
# What a package needs besides, in the same version. A box with ROS needs all.
NEEDS: Dict[str, Tuple[str, ...]] = {
    "robot": (), "comm": ("robot",), "check": ("robot",), "results": ("robot", "check"),
    "box": ("robot", "check", "results")}


def package_of(path: str) -> str:
    """The package that contains a file."""
    return max((len(entry), name) for name, entries in CONTENTS.items() for entry in entries
               if path.startswith(entry))[1]
