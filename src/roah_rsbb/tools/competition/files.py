"""The files of a competition's folder: their texts, and writing all of them or none."""

import contextlib
import datetime
import os
import re
import secrets
import string
from typing import Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence
from xml.sax.saxutils import quoteattr

import yaml

from roah_rsbb.rulebook.registry import BELL, DEVICES, PROFILES, TABLET, BenchmarkKind
from roah_rsbb.tools.competition.firewall import firewall_text
from roah_rsbb.tools.competition.plan import Plan, PlannedRun, PlannedZone, VenueClock

# Without letters that look alike on paper.
_LETTERS = "".join(c for c in string.ascii_letters if c not in "lIoO")
_FURTHER = _LETTERS + "23456789"
_PASSWORD_LENGTH = 16
# Text that needs no quotes in YAML, also in `{a: b}`.
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]+(?:[ -][A-Za-z0-9_]+)*")
_BENCHMARK = re.compile(r"^(?=- name:)", re.MULTILINE)
_CODE = re.compile(r"^  code: *(\w+) *$", re.MULTILINE)

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


def new_password() -> str:
    """Generate a random password that needs no quotes in YAML, shells and launch files."""
    return secrets.choice(_LETTERS) + "".join(secrets.choice(_FURTHER) for _ in range(_PASSWORD_LENGTH - 1))


def yaml_text(text: str) -> str:
    """Format a text of one line as YAML."""
    if _PLAIN.fullmatch(text) and isinstance(yaml.safe_load(text), str):
        return text
    return "'" + text.replace("'", "''") + "'"


def passwords_text(passwords: Dict[str, str]) -> str:
    """The passwords file; `passwords` by team."""
    lines = [f"{yaml_text(team)}: {yaml_text(password)}" for team, password in passwords.items()]
    return "\n".join([_PASSWORDS, *lines, ""])


def benchmarks_text(shipped: str, codes: Sequence[str]) -> str:
    """The default benchmarks file, reduced to these benchmarks."""
    head, *entries = _BENCHMARK.split(shipped)
    held = [entry for entry in entries if _CODE.search(entry).group(1) in codes]
    return head + "".join(held).rstrip("\n") + "\n"


def schedule_text(shipped: str, zones: Iterable[PlannedZone], clock: VenueClock) -> str:
    """The schedule file with the comments of the default one. A comment after each run gives its time at the venue."""
    lines = [line for line in shipped.splitlines() if line.startswith("#")]
    lines += ["#", "# The comment after each run gives its start in the venue's time."]
    for zone in zones:
        lines += ["", f"- zone: {yaml_text(zone.name)}", "  schedule:", *_runs(zone.runs, clock)]
    return "\n".join([*lines, ""])


def _runs(runs: Sequence[PlannedRun], clock: VenueClock) -> List[str]:
    widest = max(len(yaml_text(run.team)) for run in runs)
    return [
        f"    - {{ benchmark: {run.code + ',':7} team: {yaml_text(run.team) + ',':{widest + 1}} round: {run.round}, "
        f"run: {run.run}, scheduled_time: {run.begins:%Y-%m-%d %H:%M:%S} }}  # {_at_venue(run.begins, clock)}"
        for run in runs
    ]


def _at_venue(moment: datetime.datetime, clock: VenueClock) -> str:
    local = clock.local(moment)
    return f"{local:%A} {local:%H:%M}"


def module_codes(codes: Iterable[str]) -> List[str]:
    """The benchmarks with a benchmarking module, which have a file of parameters."""
    return [code for code in codes if PROFILES[code].kind is BenchmarkKind.FUNCTIONALITY]


def needs_tablet(plan: Plan) -> bool:
    """Whether a benchmark of the competition uses the tablet."""
    return _uses(plan, TABLET)


def _uses(plan: Plan, *words: str) -> bool:
    return any(PROFILES[code].uses.intersection(words) for code in plan.codes)


def launch_text(plan: Plan, rsbb_host: Optional[str], smartif_host: Optional[str]) -> str:
    """The launch file, which starts what these benchmarks need."""
    beside = "$(dirname)"
    yes = {True: "true", False: "false"}
    arguments = [
        ("rsbb_host", rsbb_host or "10.255.255.255",
         "Broadcast address of the network with the robots, as 'ip address' shows it (brd)"),
        ("benchmarks_file", f"{beside}/benchmarks.yaml", "YAML file with the benchmarks"),
        ("schedule_file", f"{beside}/schedule.yaml", "YAML file with the schedule of the competition"),
        ("passwords_file", f"{beside}/passwords.yaml", "YAML file with the teams' passwords"),
        ("log_dir", f"{beside}/log", "Directory for the logs of the runs"),
        ("modules", yes[bool(module_codes(plan.codes))], "Run the benchmarking modules of functionality benchmarks"),
        ("modules_dir", f"{beside}/modules",
         "Directory with the parameters of the benchmarking modules and ground_truth.yaml"),
        ("tablet", yes[needs_tablet(plan)], "Serve the tablet's page, for HCFGAC"),
        ("devices", yes[_uses(plan, DEVICES, BELL)],
         "Control the home devices: the doorbell in HWV, all of them in HCFGAC"),
        ("smartif_host", smartif_host or "192.168.1.56", "IP address of the SmartIF devices controller"),
    ]
    if not module_codes(plan.codes):
        arguments = [argument for argument in arguments if argument[0] != "modules_dir"]
    text = _LAUNCH.format(host="" if rsbb_host else " rsbb_host:=192.168.1.255")
    for name, default, doc in arguments:
        text += f"  <arg name={quoteattr(name)} default={quoteattr(default)}\n       doc={quoteattr(doc)}/>\n"
    return text + (
        '\n  <include file="$(find roah_rsbb)/launch/roah_rsbb.launch" pass_all_args="true"/>\n</launch>\n'
    )


# -- writing ----------------------------------------------------------------------------------------

BENCHMARKS, SCHEDULE, PASSWORDS = "benchmarks.yaml", "schedule.yaml", "passwords.yaml"
LAUNCH = "competition.launch"
FIREWALL = "firewall.nft"
RSBB_PORT = 6666  # roah_rsbb.launch's
MODULES = "modules"
GROUND_TRUTH = "ground_truth.yaml"
_BEFORE = SCHEDULE + "~"


class CannotWriteFiles(Exception):
    """Nothing was changed. The text says why, and names the remedy."""


class Hosts(NamedTuple):
    """Addresses for the launch file; None if still unknown."""

    rsbb: Optional[str]
    smartif: Optional[str]
    interface: Optional[str] = None  # of this computer, to the robots


def module_file(code: str) -> str:
    """The path of the parameters of a benchmark's module within the folder."""
    return os.path.join(MODULES, f"{code}.yaml")


def new_files(config_dir: str, plan: Plan, clock: VenueClock, hosts: Hosts) -> Dict[str, str]:
    """Return name and text of each file of a new competition; `config_dir` contains the default files."""
    passwords = {team: new_password() for team in plan.teams}
    files = {
        BENCHMARKS: benchmarks_text(_default_file(config_dir, BENCHMARKS), plan.codes),
        PASSWORDS: passwords_text(passwords),
        SCHEDULE: schedule_text(_default_file(config_dir, SCHEDULE), plan.zones, clock),
        LAUNCH: launch_text(plan, hosts.rsbb, hosts.smartif),
        FIREWALL: firewall_text(FIREWALL, hosts.interface, RSBB_PORT, needs_tablet(plan)),
    }
    modules = [module_file(code) for code in module_codes(plan.codes)]
    if modules:
        modules.append(os.path.join(MODULES, GROUND_TRUTH))
    return {**files, **{name: _default_file(config_dir, name) for name in modules}}


def write_new(directory: str, files: Dict[str, str]) -> None:
    """Write the files; raises `CannotWriteFiles` if one of them exists or cannot be written."""
    there = [name for name in files if os.path.lexists(os.path.join(directory, name))]
    if there:
        raise CannotWriteFiles(f"{', '.join(there)} in {directory} already exist: choose another folder, or use "
                               "--schedule-only to replace only the schedule, or --check")
    made: List[str] = []
    with _writing(directory):
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


def write_schedule(directory: str, config_dir: str, plan: Plan, clock: VenueClock) -> str:
    """Replace the schedule; returns the path of the old one, "" if there was none."""
    path, before = os.path.join(directory, SCHEDULE), os.path.join(directory, _BEFORE)
    with _writing(directory):
        text = schedule_text(_default_file(config_dir, SCHEDULE), plan.zones, clock)
        new = path + ".new"
        with contextlib.suppress(FileNotFoundError):
            os.unlink(new)
        _write(new, text, private=False)
        kept = os.path.exists(path)
        if kept:
            os.replace(path, before)
        os.replace(new, path)
    return before if kept else ""


def _default_file(config_dir: str, name: str) -> str:
    with open(os.path.join(config_dir, name), encoding="utf-8") as file:
        return file.read()


def _write(path: str, text: str, private: bool) -> None:
    """Write a new file. A private one never has wider permissions."""
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600 if private else 0o666)
    with open(handle, "w", encoding="utf-8") as file:
        file.write(text)


@contextlib.contextmanager
def _writing(directory: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        where = error.filename or directory
        raise CannotWriteFiles(
            f"{where} cannot be written: {error.strerror}. Choose another folder, or make it writable for this user"
        ) from None
