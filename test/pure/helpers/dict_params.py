"""Parameters from a dict."""

from roah_rsbb.ground.params import Params


class DictParams(Params):
    """The parameters of a program without ROS."""

    def __init__(self, given):
        super().__init__()
        self._given = given

    def full_name(self, name):
        return name

    def _get(self, name, default):
        return self._given.get(name, default)
