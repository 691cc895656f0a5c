"""The parameters of a box (docs/ros_interface.md, "Parameters" explains them)."""

from typing import List, NamedTuple, Optional

from roah_rsbb.box.settings import BoxSettings, of_box
from roah_rsbb.comm.channels import Network
from roah_rsbb.comm.ciphers import Cipher, cipher_by_label
from roah_rsbb.core.copies import STANDBY
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views.public import Publicity, PublicResults
from roah_rsbb.ground.params import BadParams, Params
from roah_rsbb.journal.log_dir import Resume
from roah_rsbb.results.standings import public_standings

# How private channels send (parameter private_mode).
UNICAST, BROADCAST = "unicast", "broadcast"


class BoxParameters(NamedTuple):
    """What the parameters say."""

    settings: Settings
    network: Network
    files: List[str]  # paths: benchmarks, schedule, passwords
    standings_file: Optional[str]  # None: there is none
    log_dir: str
    resume: Resume
    publicity: Publicity
    backup_dir: str  # to which the journal is copied; empty: to none
    standby_port: int  # TCP; 0: there is no standby

    @property
    def copies(self) -> List[str]:
        """Where copies of the journal are to be: a folder, `STANDBY`."""
        return [*([self.backup_dir] if self.backup_dir else []), *([STANDBY] if self.standby_port else [])]


def read_parameters(params: Params) -> BoxParameters:
    """Read all of them. Raises `BadParams`."""
    settings = _settings(params)
    found = BoxParameters(
        settings, _network(params, settings),
        [params.path(name) for name in ("benchmarks_file", "schedule_file", "passwords_file")],
        params.path_or_none("standings_file") or None,
        params.path("log_dir", "~/.ros/roah_rsbb"),
        Resume(params.choice("resume", Resume.ALWAYS.value, [choice.value for choice in Resume])),
        Publicity(
            PublicResults(params.choice(
                "public_results", PublicResults.NONE.value, [choice.value for choice in PublicResults])),
            params.flag("public_provisional", False), params.flag("public_robot_texts", False), public_standings),
        params.path_or_none("backup_dir"), params.whole("standby_port", 0, 0, 65535),
    )
    params.done()
    return found


def parameters_of(settings: Params) -> BoxParameters:
    """Return the parameters of a box. Raises `BadParams` for wrong values, for settings that do not exist, and for what
    a box cannot do on this system."""
    params = read_parameters(settings)
    wrong = settings.unknown(list(of_box())) if isinstance(settings, BoxSettings) else []
    if wrong:
        raise BadParams("\n".join(wrong))
    return params


def _settings(params: Params) -> Settings:
    default = Settings()
    return Settings(
        rsbb_port=params.whole("rsbb_port", default.rsbb_port, 1, 65000),
        robot_timeout=params.number("robot_timeout", default.robot_timeout, lowest=1.0),
        allowed_skew=params.number("allowed_skew", default.allowed_skew, lowest=0.001),
        after_stop_duration=params.number("after_stop_duration", default.after_stop_duration),
        display_log_size=params.whole("display_log_size", default.display_log_size, 100, 1_000_000),
        check_messages_saved=params.flag("check_messages_saved", default.check_messages_saved),
        check_messages_saved_timeout=params.number(
            "check_messages_saved_timeout", default.check_messages_saved_timeout
        ),
        max_datagram=params.whole("max_datagram", default.max_datagram, 200, 65507),
        auto_next=params.flag("auto_next", default.auto_next),
        listen_duration=params.number("listen_duration", default.listen_duration, highest=60.0),
        take_over=params.flag("take_over", default.take_over),
    )


def _network(params: Params, settings: Settings) -> Network:
    labels = [cipher.label for cipher in Cipher if cipher is not Cipher.NONE]
    return Network(
        rsbb_host=params.text("rsbb_host", "10.255.255.255"),
        rsbb_port=settings.rsbb_port,
        bind_host=params.text("bind_host", "0.0.0.0"),
        cipher=cipher_by_label(params.choice("rsbb_cypher", Cipher.AES_128_CBC.label, labels)),
        broadcast=params.choice("private_mode", UNICAST, [UNICAST, BROADCAST]) == BROADCAST,
        max_datagram=settings.max_datagram,
    )
