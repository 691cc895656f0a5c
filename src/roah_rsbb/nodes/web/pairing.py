"""The services of the gateway: codes for devices and the list of paired devices (docs/web.md, "Pairing"), and the codes
of teams (docs/web.md, "Pages of teams")."""

from typing import Any, Callable, List, TypeVar

import rospy

from roah_rsbb.msg import PairedDevice
from roah_rsbb.ros import texts
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.times import ros_time
from roah_rsbb.srv import (
    PairDevice,
    PairDeviceResponse,
    PairedDevices,
    PairedDevicesResponse,
    RevokeDevice,
    RevokeDeviceResponse,
    TeamCodes,
    TeamCodesResponse,
)
from roah_rsbb.web.pairing import CODE_VALID_S, ORGANISER, ROLES, Grant
from roah_rsbb.web.server import WebServer
from roah_rsbb.wording.device import CODES_NOT_SAVED
from roah_rsbb.wording.suggestions import did_you_mean

T = TypeVar("T")


class PairingServices:
    """Offers /web/…. Everything is done in the loop's thread."""

    def __init__(self, ros: RosLoop, server: WebServer, zones: Callable[[], List[str]], url: Callable[[], str]) -> None:
        """`zones`: those of the competition, empty if they are not known; `url`: of the pages, for devices."""
        self._ros = ros
        self._server = server
        self._zones = zones
        self._url = url
        rospy.Service("/web/pair", PairDevice, self._pair)
        rospy.Service("/web/sessions", PairedDevices, lambda request: self._call(self._list))
        rospy.Service("/web/revoke", RevokeDevice, self._revoke)
        rospy.Service("/web/team_codes", TeamCodes, self._team_codes)

    def _pair(self, request: Any) -> PairDeviceResponse:
        problem = texts.too_long(request)
        if problem:
            raise rospy.ServiceException(problem)
        return self._call(lambda: self._make_code(Grant(request.role, request.zone)))

    def _problem(self, role: str, zone: str) -> str:
        """Say why no code can be made; empty: one can."""
        zones = self._zones()
        if role not in ROLES:
            return f"no role '{role}'{did_you_mean(role, ROLES)}: choose one of {', '.join(ROLES)}"
        if role == ORGANISER:
            return f"an organiser may act in all zones: leave out zone '{zone}'" if zone else ""
        if not zone:
            return f"a {role} needs a zone"
        if zones and zone not in zones:
            return f"no zone '{zone}'{did_you_mean(zone, zones)}"
        return ""

    def _make_code(self, grant: Grant) -> PairDeviceResponse:
        problem = self._problem(*grant)
        if problem:
            raise rospy.ServiceException(problem)
        url = self._url()
        if not url:
            raise rospy.ServiceException("the web pages are not served yet: the log of this node names the remedy")
        code = self._server.codes.make(self._server.now(), grant)
        return PairDeviceResponse(code, f"{url}pair#{code}", rospy.Duration.from_sec(CODE_VALID_S))

    def _list(self) -> PairedDevicesResponse:
        connected = self._server.connected()
        return PairedDevicesResponse([
            PairedDevice(
                id=one.id, role=one.grant.role, zone=one.grant.zone, person=one.person, device=one.device,
                paired=ros_time(one.paired_utc), seen=ros_time(one.seen_utc), connected=one.id in connected)
            for one in self._server.sessions.listed(self._server.utc())
        ])

    def _revoke(self, request: Any) -> RevokeDeviceResponse:
        ended = self._call(lambda: self._server.revoke(request.id))
        for one in ended:
            rospy.loginfo("Pairing ended: %s", one.who)
        return RevokeDeviceResponse(len(ended))

    def _team_codes(self, request: Any) -> TeamCodesResponse:
        codes = self._server.team_codes

        def listed() -> TeamCodesResponse:
            if request.renew:
                codes.renew()
            teams = self._server.store.teams()
            return TeamCodesResponse(self._server.team_pages, teams, [codes.code(team) for team in teams])

        try:
            answer = self._ros.call(listed)
        except OSError as error:
            raise rospy.ServiceException(CODES_NOT_SAVED.format(error=error)) from None
        if request.renew:
            rospy.loginfo("All teams have new codes")
        return answer

    def _call(self, function: Callable[[], T]) -> T:
        try:
            return self._ros.call(function)
        except OSError as error:
            raise rospy.ServiceException(
                f"ended, but not saved ({error}): it would be valid again after a restart. Free or repair the disk of "
                "log_dir, and try again") from None
