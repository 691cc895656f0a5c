"""The private parameters of a node."""

from typing import Dict

import rospy

from roah_rsbb.ground.params import Params


class NodeParams(Params):
    """Reads them from ROS. Create it after `rospy.init_node`."""

    def __init__(self) -> None:
        super().__init__()
        self.values: Dict[str, object] = {}
        """What was read until now, or its default."""

    def full_name(self, name: str) -> str:
        """See `Params`."""
        return str(rospy.resolve_name("~" + name))

    def _get(self, name: str, default: object) -> object:
        try:
            value = self.values[name] = rospy.get_param(self.full_name(name), default)
        except KeyError:
            return None
        return value
