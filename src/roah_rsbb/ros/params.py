"""The private parameters of a node."""

import rospy

from roah_rsbb.params import Params


class NodeParams(Params):
    """Reads them from ROS. Create it after `rospy.init_node`."""

    def full_name(self, name: str) -> str:
        """See `Params`."""
        return str(rospy.resolve_name("~" + name))

    def _get(self, name: str, default: object) -> object:
        try:
            return rospy.get_param("~" + name, default)
        except KeyError:
            return None
