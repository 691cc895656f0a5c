"""The files of a competition's folder: their texts, and writing all of them or none."""

import contextlib
import os
from typing import Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Set
from xml.sax.saxutils import quoteattr

from roah_rsbb.bmbox.framework.rule_files import own_file
from roah_rsbb.bmbox.host.ground_truth_of_frames import FILE_NAME as GROUND_TRUTH
from roah_rsbb.core.connections import PORTS
from roah_rsbb.ground import durable
from roah_rsbb.ground.durable import KEPT
from roah_rsbb.rulebook.benchmarks import Benchmark, Durable
from roah_rsbb.rulebook.config import settings_in
from roah_rsbb.rulebook.decisions import DECISIONS, decided_in
from roah_rsbb.rulebook.errors import Report, known
from roah_rsbb.rulebook.event_ids import new_id
from roah_rsbb.rulebook.registry import BELL, DEVICES, TABLET, BenchmarkKind
from roah_rsbb.rulebook.schedule_text import yaml_text
from roah_rsbb.rulebook.team_passwords import lines_of, new_password
from roah_rsbb.tools.competition.plan import Plan, PlannedRun, PlannedZone, VenueClock
from roah_rsbb.tools.competition.rulebooks import BENCHMARKS, STANDINGS, Rulebook, benchmarks_text, standings_text

_PASSWORDS = """\
# Passwords of the teams, randomly generated for this competition. Keep this file secret (chmod 600) and out of any
# repository. Give each team only its own password. The team's robot must use the same name and password.
"""
_LAUNCH = """\
<launch>
  <!-- The RSBB of this competition: the core and a referee's client, with the files in this folder.

       roslaunch competition.launch{host}

       All other arguments of roah_rsbb.launch are accepted, too. -->
"""


def passwords_text(passwords: Dict[str, str]) -> str:
    """The passwords file; `passwords` by team."""
    return "\n".join([_PASSWORDS, *lines_of(passwords), ""])


def schedule_text(
    shipped: str, zones: Iterable[PlannedZone], clock: VenueClock, durable: Durable = Durable.ONE
) -> str:
    """The schedule file with the comments of the default one. All times are those of the venue."""
    lines = [line for line in shipped.splitlines() if line.startswith("#")]
    lines += ["#", "# All times are those of the venue, with their offset from UTC.", ""]
    lines += [f"- time_zone: {yaml_text(clock.name)}"]
    lines += [f"- durable: {durable.value}"] if durable is not Durable.ONE else []
    zones = list(zones)
    ids = {run.id for zone in zones for run in zone.runs}
    for zone in zones:
        lines += ["", f"- zone: {yaml_text(zone.name)}", "  schedule:", *_runs(zone.runs, clock, ids)]
    return "\n".join([*lines, ""])


def _runs(runs: Sequence[PlannedRun], clock: VenueClock, ids: Set[str]) -> List[str]:
    """The lines of a zone's runs. `ids`: those that are taken, to which it adds."""
    widest = max(len(yaml_text(run.team)) for run in runs)
    return [
        f"    - {{ benchmark: {run.code + ',':7} team: {yaml_text(run.team) + ',':{widest + 1}} round: {run.round}, "
        f"run: {run.run}, scheduled_time: {clock.written(run.begins)}, id: {_id(run, ids)} }}"
        f"  # {clock.local(run.begins):%A}"
        for run in runs
    ]


def _id(run: PlannedRun, ids: Set[str]) -> str:
    own = run.id or new_id(ids)
    ids.add(own)
    return own


def needs_modules(benchmarks: Sequence[Benchmark]) -> bool:
    """Whether a benchmarking module drives one of the benchmarks."""
    return any(benchmark.kind is BenchmarkKind.FUNCTIONALITY for benchmark in benchmarks)


def needs_tablet(benchmarks: Sequence[Benchmark]) -> bool:
    """Whether one of the benchmarks uses the tablet."""
    return _uses({TABLET}, benchmarks)


def _uses(words: Set[str], benchmarks: Sequence[Benchmark]) -> bool:
    return any(benchmark.profile.uses.intersection(words) for benchmark in benchmarks)


def needs_devices(benchmarks: Iterable[Benchmark]) -> bool:
    """Whether one of these benchmarks uses the home devices or the bell."""
    return _uses({DEVICES, BELL}, benchmarks)


def launch_text(
    benchmarks: Sequence[Benchmark], rsbb_host: Optional[str], smartif_host: Optional[str], has_standings: bool = False
) -> str:
    """The launch file, which starts what these benchmarks need. `has_standings`: the folder has rules for them."""
    beside = "$(dirname)"
    yes = {True: "true", False: "false"}
    arguments = [
        ("rsbb_host", rsbb_host or "10.255.255.255",
         "Broadcast address of the network with the robots, as 'ip address' shows it (brd)"),
        ("benchmarks_file", f"{beside}/benchmarks.yaml", "YAML file with the benchmarks"),
        ("schedule_file", f"{beside}/schedule.yaml", "YAML file with the schedule of the competition"),
        ("passwords_file", f"{beside}/passwords.yaml", "YAML file with the teams' passwords"),
        ("log_dir", f"{beside}/{LOG}", "Directory for the logs of the runs"),
        ("standings_file", f"{beside}/standings.yaml", "YAML file with the ranking of the standings"),
        ("modules", yes[needs_modules(benchmarks)], "Run the benchmarking modules of functionality benchmarks"),
        ("modules_dir", f"{beside}/modules",
         "Directory with the parameters of the benchmarking modules and ground_truth.yaml"),
        ("tablet", yes[needs_tablet(benchmarks)], "Serve the tablet's page"),
        # Nobody wants connections to a foreign controller: without its address, they are off.
        ("devices", yes[needs_devices(benchmarks) and smartif_host is not None],
         "Control the home devices and the doorbell"),
        ("smartif_host", smartif_host or "192.168.1.56", "IP address of the SmartIF devices controller"),
    ]
    left_out = {"modules_dir"} if not needs_modules(benchmarks) else set()
    left_out |= {"standings_file"} if not has_standings else set()
    arguments = [argument for argument in arguments if argument[0] not in left_out]
    text = _LAUNCH.format(host="" if rsbb_host else " rsbb_host:=192.168.1.255")
    for name, default, doc in arguments:
        text += f"  <arg name={quoteattr(name)} default={quoteattr(default)}\n       doc={quoteattr(doc)}/>\n"
    return text + (
        '\n  <include file="$(find roah_rsbb)/launch/roah_rsbb.launch" pass_all_args="true"/>\n</launch>\n'
    )


# -- writing ----------------------------------------------------------------------------------------

SCHEDULE, PASSWORDS = "schedule.yaml", "passwords.yaml"
LOG = "log"  # the log_dir
LAUNCH = "competition.launch"
FIREWALL = "firewall.nft"
RSBB_PORT = 6666  # roah_rsbb.launch's
MODULES = "modules"


class CannotWriteFiles(Exception):
    """Nothing was changed. The text says why, and names the remedy."""


class Hosts(NamedTuple):
    """Addresses for the launch file; None if still unknown."""

    rsbb: Optional[str]
    smartif: Optional[str]
    interface: Optional[str] = None  # of this computer, to the robots


def new_files(
    book: Rulebook, plan: Plan, clock: VenueClock, hosts: Hosts, chosen: Mapping[str, str]
) -> Dict[str, str]:
    """Return name and text of each file of a new competition. `chosen`: readings of the organiser, by decisions."""
    codes = [code for code in book.benchmarks if code in plan.codes]
    benchmarks = [book.benchmarks[code] for code in codes]
    passwords = {team: new_password() for team in plan.teams}
    standings = standings_text(book.path(STANDINGS), _text(book, STANDINGS), codes)
    text = benchmarks_text(book.path(BENCHMARKS), _text(book, BENCHMARKS), codes)
    rules = {STANDINGS: standings} if standings else {}
    files = {
        BENCHMARKS: text,
        PASSWORDS: passwords_text(passwords),
        SCHEDULE: schedule_text(_text(book, SCHEDULE), plan.zones, clock),
        **rules,
        **_decisions(book, {BENCHMARKS: text, **rules}, chosen),
        LAUNCH: launch_text(benchmarks, hosts.rsbb, hosts.smartif, bool(standings)),
        FIREWALL: firewall_text(FIREWALL, hosts.interface, RSBB_PORT, needs_tablet(benchmarks)),
    }
    return {**files, **{name: _text(book, name) for name in _module_files(book, plan, benchmarks)}}


def _decisions(book: Rulebook, rules: Dict[str, str], chosen: Mapping[str, str]) -> Dict[str, str]:
    """The decisions of the organiser and of a rulebook that has some, reduced to those in these files."""
    path = book.path(DECISIONS)
    with known(rules):
        names = {each.decision.name for name in rules for each in decided_in(Report(), name)}
    others = sorted(names.difference(chosen))
    text = standings_text(path, _text(book, DECISIONS), others) if os.path.lexists(path) else ""
    text += "".join(f"{yaml_text(name)}: {yaml_text(reading)}\n" for name, reading in chosen.items() if name in names)
    return {DECISIONS: text} if text else {}


def _module_files(book: Rulebook, plan: Plan, benchmarks: Sequence[Benchmark]) -> List[str]:
    """The files of benchmarking modules: rules, parameters and ground truth, also those of one zone, if they exist."""
    if not needs_modules(benchmarks):
        return []
    codes = [benchmark.code for benchmark in benchmarks if benchmark.kind is BenchmarkKind.FUNCTIONALITY]
    of_all = [os.path.join(MODULES, f"{code}.{kind}") for code in codes for kind in ("py", "yaml")]
    replaceable = (*(f"{code}.yaml" for code in codes), GROUND_TRUTH)
    of_zones = [own_file(MODULES, zone.name, name) for zone in plan.zones for name in replaceable]
    paths = (*of_all, os.path.join(MODULES, GROUND_TRUTH), *of_zones)
    return [path for path in paths if path and os.path.lexists(book.path(path))]


def write_new(directory: str, files: Dict[str, str]) -> None:
    """Write the files; raises `CannotWriteFiles` if one of them exists or cannot be written."""
    there = [name for name in files if os.path.lexists(os.path.join(directory, name))]
    if there:
        raise CannotWriteFiles(f"{', '.join(there)} in {directory} already exist: choose another folder, or use "
                               "--schedule-only to replace only the schedule, or --check")
    made: List[str] = []
    with writing(directory):
        try:
            for name, text in files.items():
                path = os.path.join(directory, name)
                os.makedirs(os.path.dirname(path), exist_ok=True)
                _write(path, text, private=name == PASSWORDS)
                made.append(path)
        except OSError:
            for path in made:
                os.unlink(path)
            raise


def write_schedule(directory: str, book: Rulebook, zones: Sequence[PlannedZone], clock: VenueClock) -> str:
    """Replace the schedule; returns the path of the old one, "" if there was none, or the same one.

    The ones before are kept, too, with numbers: what was made by hand before several imports is not lost.
    """
    path = os.path.join(directory, SCHEDULE)
    text = schedule_text(_text(book, SCHEDULE), zones, clock, settings_in(path).durable)
    if not os.path.exists(path):
        with writing(directory):
            _write(path, text, private=False)
        return ""
    return replace(directory, SCHEDULE, text)


def replace(directory: str, name: str, text: str, versions: int = KEPT) -> str:
    """Write a file of a competition, and keep so many before; returns the path of the newest of these, or "" if it is
    the same one. Raises `CannotWriteFiles`."""
    path = os.path.join(directory, name)
    with writing(directory):
        is_new = durable.replace_keeping(path, text.encode("utf-8"), versions)
    return f"{path}~" if is_new else ""


def _text(book: Rulebook, name: str) -> str:
    path = book.path(name)
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "it is not UTF-8"
        raise CannotWriteFiles(f"{path} cannot be read: {why}. Repair the rulebook, or install the package again") \
            from None


def _write(path: str, text: str, private: bool) -> None:
    """Write a new file. A private one never has wider permissions."""
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600 if private else 0o666)
    with open(handle, "w", encoding="utf-8") as file:
        file.write(text)


@contextlib.contextmanager
def writing(directory: str) -> Iterator[None]:
    """Turn errors of the disk into `CannotWriteFiles`."""
    try:
        yield
    except OSError as error:
        where = error.filename or directory
        raise CannotWriteFiles(
            f"{where} cannot be written: {error.strerror}. Choose another folder, or make it writable for this user"
        ) from None


TABLE = "roah_rsbb"
TABLET_PORT = 8080
# The name in the file if the interface is not known. The organiser writes the right one.
UNKNOWN_INTERFACE = "eth0"

_TEXT = """\
#!/usr/sbin/nft -f
# Firewall of this competition's box: what the robots' network may reach on this computer.
#
#   sudo nft -f {name}             load it (again after each start of the computer)
#   sudo nft list table inet {table}    show it, and how much was dropped
#   sudo nft delete table inet {table}  remove it
#
# ROS has no password: anyone who reaches its ports can stop, score and end the box. Only the box's own ports are open
# to the robots' network, and nothing is forwarded to or from that network. Other interfaces are not affected.

# The interface to the robots, as 'ip -4 address' names it.{check}
define robots = "{interface}"

table inet {table}
delete table inet {table}
table inet {table} {{
  chain input {{
    type filter hook input priority 0; policy accept;
    iifname != $robots accept
    ct state established,related accept
    udp dport {first}-{last} accept comment "the box: public channel, and a port for each run"
{tablet}    udp dport 123 accept comment "NTP, if this computer is the time server"
    udp sport 67 udp dport 68 accept comment "DHCP"
    meta l4proto {{ icmp, ipv6-icmp }} accept
    # If referees' computers are in the robots' network: only these addresses reach ROS.
    # ip saddr {{ 192.168.1.20, 192.168.1.21 }} accept
    counter drop
  }}
  chain forward {{
    type filter hook forward priority 0; policy accept;
    iifname $robots counter drop
    oifname $robots counter drop
  }}
}}
"""
_TABLET = '    tcp dport {port} accept comment "the page of the tablet"\n'


def firewall_text(name: str, interface: Optional[str], rsbb_port: int, tablet: bool) -> str:
    """Return the file `name` for nft. `interface`: the one to the robots; None: not known. `tablet`: serve its page."""
    return _TEXT.format(
        name=name, table=TABLE, interface=interface or UNKNOWN_INTERFACE, first=rsbb_port, last=rsbb_port + PORTS - 1,
        check="" if interface else " CHECK THIS NAME.", tablet=_TABLET.format(port=TABLET_PORT) if tablet else "",
    )


def loaded_for(listing: str) -> List[str]:
    """Return the interfaces that a loaded table protects. `listing`: the output of `nft list table`."""
    chain = listing.partition("chain input")[2].partition("}")[0]
    words = chain.replace('"', "").split()
    return [words[i + 2] for i, word in enumerate(words[:-2]) if word == "iifname" and words[i + 1] == "!="]
