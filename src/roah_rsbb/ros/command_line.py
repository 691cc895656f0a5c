"""The command line of programs whose settings are ROS parameters: `--help`, and nothing else."""

import os
import sys

import rospy

from roah_rsbb.arguments import Parser

_SETTINGS = """\
Settings are ROS parameters, of the node or given as _name:=value. The launch files set those that competitions need;
'roslaunch --ros-args roah_rsbb FILE.launch' explains them.
"""
_PANEL = """\
It shows the zone of the client in whose namespace it is: __ns:=/some_client. Without that it is a client of its own.
"""


def explain(doc: str, settings: str = _SETTINGS) -> None:
    """Print what a program is and end, if that is asked for; end with status 2 for any other argument.

    `doc` is the docstring of the program's module. What ROS takes for itself (name:=value) is no argument here.
    """
    parser = Parser(os.path.basename(sys.argv[0]), doc.strip(), settings)
    parser.parse_args(rospy.myargv()[1:])


def explain_panel(doc: str) -> None:
    """The same for a panel that is alone in its window."""
    explain(doc, _PANEL)
