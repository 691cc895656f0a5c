"""What the program that copies the journal is given: the same parameters as the box (docs/ros_interface.md)."""

from typing import List, NamedTuple

from roah_rsbb.ground.params import NONE, Params

# In the environment of the program that copies: the process that started it, which may be gone already.
PARENT = "ROAH_RSBB_PARENT"


class CopySettings(NamedTuple):
    """What is copied to where."""

    log_dir: str
    backup_dir: str  # empty: to no folder
    standby_port: int  # TCP; 0: to no standby
    bind_host: str  # own address for the standby
    passwords_file: str  # a standby needs it to continue,
    rsbb_host: str  # and these
    rsbb_port: int
    modules_dir: str  # empty: it needs no benchmarking modules

    @property
    def words(self) -> List[str]:
        """As a command line has them; none: nothing is to be copied."""
        values = self._replace(backup_dir=self.backup_dir or NONE)._asdict().items()
        return [f"{name}:={value}" for name, value in values] if self.backup_dir or self.standby_port else []


def copy_settings(params: Params) -> CopySettings:
    """Read them. Raises `BadParams`."""
    found = CopySettings(
        params.path("log_dir", "~/.ros/roah_rsbb"), params.path_or_none("backup_dir"),
        params.whole("standby_port", 0, 0, 65535), params.text("bind_host", "0.0.0.0"),
        params.path("passwords_file", NONE), params.text("rsbb_host", "10.255.255.255"),
        params.whole("rsbb_port", 6666, 1, 65000), params.path("modules_dir", ""))
    params.done()
    return found
