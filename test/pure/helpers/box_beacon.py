"""The beacon of a box, with all fields that robots require."""

from typing import Any, Tuple

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

NEVER = pb.Time(sec=0, nsec=0)


def box_beacon(*listed: Tuple[str, str, int], **fields: Any) -> pb.RoahRsbbBeacon:
    """A beacon that lists robots (team, robot, port); all devices are off, and nothing has happened.

    `fields` are others than these; None: the beacon has no such field.
    """
    beacon = pb.RoahRsbbBeacon(**{
        "devices_bell": NEVER, "devices_switch_1": False, "devices_switch_2": False, "devices_switch_3": False,
        "devices_dimmer": 0, "devices_blinds": 0, "devices_door_win_detect": False, "tablet_display_map": False,
        "tablet_call_time": NEVER, "tablet_position_time": NEVER, "tablet_position_x": 0.0, "tablet_position_y": 0.0,
        **fields,
    })
    for team, name, port in listed:
        beacon.benchmarking_teams.add(team_name=team, robot_name=name, rsbb_port=port)
    return beacon
