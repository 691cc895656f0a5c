"""Calls of services at the address that an earlier call found.

rospy asks the ROS master for the address of a service at each call. This takes 2 ms, and often 10 ms on a busy machine,
while a robot waits for the referee's command.
"""

from typing import Any, Dict, Optional

import rospy
from rospy.exceptions import TransportInitError


class KnownService(rospy.ServiceProxy):
    """A `rospy.ServiceProxy` that asks the master only if the service does not answer at its known address."""

    # By the service's name: the address at which it answered last. While a call waits there, it is not known: a node
    # that hangs may have been replaced by another one, and the next call must find that.
    _addresses: Dict[str, str] = {}
    _known: Optional[str] = None

    def call(self, *args: Any, **fields: Any) -> Any:
        """Call the service; raises rospy.ServiceException."""
        self._known = self._addresses.pop(self.resolved_name, None)
        try:
            answer = super().call(*args, **fields)
        except rospy.ServiceException as error:
            # Nothing was sent if there was no connection. The service's node was probably restarted.
            if self._known is None or not isinstance(error.__context__, TransportInitError):
                raise
            self._known = None
            answer = super().call(*args, **fields)
        self._addresses[self.resolved_name] = self.uri
        return answer

    def _get_service_uri(self, request: Any) -> str:
        self.uri = self._known or super()._get_service_uri(request)
        return self.uri
