"""The command line of programs whose settings are ROS parameters: `--help` is the only option."""

import os
import sys
from typing import Any, Callable, Tuple, Type

import rospy

from roah_rsbb.arguments import Parser
from roah_rsbb.ros import connections
from roah_rsbb.ros.params import BadParams

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
    """The same for a panel in a window of its own."""
    explain(doc, _PANEL)


def run_node(
    name: str, doc: str, make: Callable[[], Any], errors: Tuple[Type[Exception], ...] = (BadParams,), **options: Any
) -> None:
    """Be a node: make it, call its `run`, and end with the exit status that `run` returns.

    Its `errors` at the start become fatal log lines. `options` are those of `rospy.init_node`.
    """
    explain(doc)
    connections.init_node(name, **options)
    try:
        status = make().run()
    except errors as error:
        for line in str(error).splitlines():
            rospy.logfatal("%s", line)
        status = 1
    sys.exit(status)
