"""The texts of the pages for paired devices: phones and tablets of referees and judges (docs/web.md, "Pairing")."""

from typing import Dict

from roah_rsbb.wording.language import tr, tr_later

# The roles of devices, by the names in the ROS interface.
ROLES = {"referee": tr_later("Referee"), "judge": tr_later("Judge"), "organiser": tr_later("Organiser")}

# Why a device is not paired.
TOO_MANY_GUESSES = tr_later("Too many wrong codes: wait a minute, then ask for a new code")
WRONG_CODE = tr_later("This code is wrong, was used, or is older than two minutes: ask for a new one")
TOO_MANY_DEVICES = tr_later("Too many devices are paired: end some pairings first")
NO_NAME = tr_later("Type your name: it is recorded with everything that you enter")
NOT_SAVED = tr_later("The pairing cannot be saved ({error}): free or repair the disk of log_dir")


def role_text(role: str, zone: str) -> str:
    """Return a role and where it counts."""
    return tr("{role} in {zone}", role=tr(ROLES[role]), zone=zone) if zone else tr("{role}, all zones",
                                                                                  role=tr(ROLES[role]))


def page_words() -> Dict[str, str]:
    """Return the fixed texts of the pages, by the names that the pages use."""
    return {
        **{f"role_{name}": tr(text) for name, text in ROLES.items()},
        "role_in_zone": tr("{role} in {zone}", role="{role}", zone="{zone}"),
        "role_everywhere": tr("{role}, all zones", role="{role}"),
        "pair_title": tr("Pair this device"),
        "pair_how": tr("A code comes from the referee's panel (Benchmark Control, ⋯, Pair a phone), or from "
                       "'rosrun roah_rsbb referee pair' in a terminal. It is valid for two minutes, for one device."),
        "code": tr("Code"),
        "your_name": tr("Your name"),
        "this_device": tr("This device"),
        "pair": tr("Pair"),
        "paired_as": tr("Paired: {role}", role="{role}"),
        "end_pairing": tr("End the pairing of this device"),
        "not_encrypted": tr("This connection is not encrypted: whoever can listen in this network can read and use it. "
                            "Use a network of the referees only."),
        "no_answer": tr("No answer from the box: check the network, and try again"),
    }
