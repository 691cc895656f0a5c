"""Which troubles are tried together."""

from typing import Dict, NamedTuple, Tuple

import troubles
from net import Trouble

from box import TEAMS


class Plan(NamedTuple):
    """One round of all benchmarks."""

    name: str
    troubles: Dict[str, Trouble]  # by benchmark; the others have a bad network only
    lossless: Tuple[str, ...] = ()  # benchmarks whose robots lose nothing; all else happens to them, too
    strangers: bool = False


def _all(trouble: Trouble) -> Dict[str, Trouble]:
    return dict.fromkeys(TEAMS, trouble)


# Who knows the password speaks for a robot that is not heard for two and a half seconds (core, link): that is so on
# a network that loses much, and is no fault. So these robots are always heard.
MIXED = Plan("everything at once", {
    "HGTKMH": troubles.reboot, "HWV": troubles.outage, "HCFGAC": troubles.new_address, "HOPF": troubles.impostors,
    "HPPF": troubles.second_robot, "HOMF": troubles.wild_clock, "STB": troubles.pulled_cable,
}, ("HOPF",), strangers=True)

SHORT = [MIXED]
LONG = [
    Plan("a bad network", {}),
    Plan("outages", _all(troubles.outage)),
    Plan("reboots", _all(troubles.reboot)),
    Plan("new addresses", _all(troubles.new_address)),
    Plan("pulled cables", _all(troubles.pulled_cable)),
    Plan("wild clocks", _all(troubles.wild_clock)),
    Plan("impostors", _all(troubles.impostors), tuple(TEAMS), strangers=True),
    Plan("second robots", _all(troubles.second_robot), strangers=True),
    MIXED,
]
