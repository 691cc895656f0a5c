"""Builds the message with the schedule for the referees."""

from typing import List, Optional

from roah_rsbb.core.box import Box
from roah_rsbb.core.views.schedule import EventLine, ScheduleView
from roah_rsbb.core.views.sheets import sums_of_record
from roah_rsbb.model.clock import Now
from roah_rsbb.msg import Schedule, ScheduleEvent
from roah_rsbb.ros.times import ros_time


class ScheduleBoard:
    """Builds /core/schedule of a box when it has changed."""

    def __init__(self, box: Box, box_uuid: str) -> None:
        self._view = ScheduleView(box)
        self._box_uuid = box_uuid
        self._lines: Optional[List[EventLine]] = None

    def take(self, now: Now) -> Optional[Schedule]:
        """Return the message if it differs from the one at the last call."""
        lines = self._view.look(now)
        if lines == self._lines:
            return None
        self._lines = lines
        return Schedule(ros_time(now.utc), self._box_uuid, [event_message(line) for line in lines])


def event_message(line: EventLine) -> ScheduleEvent:
    """Return the message of an event."""
    event = line.event
    message = ScheduleEvent(
        zone=line.zone,
        code=event.benchmark.code,
        benchmark=event.benchmark.desc or event.benchmark.name,
        team=event.team,
        round=event.round,
        run=event.run,
        schedule=ros_time(event.scheduled),
        current=line.current,
        state=line.state.value,
        begins=ros_time(line.begins),
        id=event.id,
    )
    if line.result is not None:
        shown, why = line.result.shown
        message.identity, message.end_reason, message.score = shown.identity, shown.end_reason, sums_of_record(shown)
        message.counts = why.value
        if line.result.signed:
            message.signed, message.signed_by = ros_time(shown.sign_off.utc), shown.sign_off.who
    return message
