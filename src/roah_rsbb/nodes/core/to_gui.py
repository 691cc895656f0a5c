"""The original's message for panels, /core/to_gui, made of the document. Its fields are fixed."""

from typing import Dict, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.msg import CoreToGui, RobotInfo, ZoneState
from roah_rsbb.nodes.core.score_convert import old_groups
from roah_rsbb.ros.times import ros_duration, ros_time, ros_wire_time


class ToGui:
    """Makes the messages of one box. A zone's message is made again only when the zone has changed."""

    def __init__(self, box: Box) -> None:
        self._box = box
        self._zones: Dict[str, Tuple[ZoneSeen, ZoneState]] = {}

    def message(self, now: Now, document: Document) -> CoreToGui:
        """Return the message of a moment; it is true until the next one is made. `document`: of the same moment; robots
        and tablet, of which it says less than the message, come from the box."""
        heard, tablet = self._box.tablet.heard, self._box.tablet.state
        before, self._zones = self._zones, {}
        for name, zone in document.zones.items():
            kept = before.get(name)
            self._zones[name] = kept if kept is not None and kept[0] is zone else (zone, _zone_state(zone))
        for zone, state in self._zones.values():
            state.timer = ros_duration(zone.clock.timer(now.mono))
        return CoreToGui(
            clock=ros_time(now.utc),
            status=document.box.status,
            addr=document.box.host,
            port=str(document.box.port),
            tablet_last_beacon=ros_time(0.0 if heard is None else heard.utc),
            tablet_display_map=tablet.display_map,
            tablet_call_time=ros_wire_time(tablet.call_time),
            tablet_position_time=ros_wire_time(tablet.position_time),
            tablet_position_x=tablet.position_x,
            tablet_position_y=tablet.position_y,
            active_robots=[
                RobotInfo(*robot.id, ros_duration(robot.skew.seconds or 0.0), ros_time(robot.last_heard.utc))
                for robot in self._box.robots.all(now)],
            zones=[state for _, state in self._zones.values()],
        )


def _zone_state(zone: ZoneSeen) -> ZoneState:
    event, switches = zone.event, zone.switches
    return ZoneState(
        zone=zone.zone,
        name=event.name,
        desc=event.desc,
        code=event.code,
        timeout=ros_duration(zone.timeout),
        team=event.team,
        round=event.round,
        run=event.run,
        schedule=ros_time(event.scheduled),
        state="\n".join(zone.lines),
        manual_operation=zone.manual_operation,
        connect_enabled=zone.is_on("connect") and not zone.action("connect").question,
        disconnect_enabled=zone.is_on("disconnect"),
        start_enabled=zone.is_on("start"),
        stop_enabled=zone.is_on("stop"),
        prev_enabled=zone.is_on("previous"),
        next_enabled=zone.is_on("next"),
        omf=switches is not None,
        omf_switches=b"" if switches is None else bytes(switches.on),
        omf_damaged=0 if switches is None else switches.damaged,
        omf_complete=switches is not None and switches.to_confirm,
        log=zone.log,
        online_data=zone.online_data,
        scoring=old_groups(zone.items),
    )
