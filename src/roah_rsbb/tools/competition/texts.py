"""The texts of a competition's files."""

import datetime
import re
import secrets
import string
from typing import Dict, Iterable, List, Optional, Sequence
from xml.sax.saxutils import quoteattr

import yaml

from roah_rsbb.rulebook.benchmarks import KINDS, Kind
from roah_rsbb.tools.competition.moments import VenueClock
from roah_rsbb.tools.competition.plan import Plan, PlannedZone, Run

# Without those that are taken for one another when a password is read from paper.
_LETTERS = "".join(c for c in string.ascii_letters if c not in "lIoO")
_FURTHER = _LETTERS + "23456789"
_PASSWORD_LENGTH = 16
# What a YAML reader takes for nothing but text, also in `{a: b}`.
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]+(?:[ -][A-Za-z0-9_]+)*")
_BENCHMARK = re.compile(r"^(?=- name:)", re.MULTILINE)
_CODE = re.compile(r"^  code: *(\w+) *$", re.MULTILINE)
# Benchmarks for which something hangs on the box: the bell and the devices, the tablet.
_WITH_DEVICES = ("HWV", "HCFGAC")
_WITH_TABLET = ("HCFGAC",)

_PASSWORDS = """\
# Passwords of the teams, made by chance for this competition. Keep this file to yourself (chmod 600), out of any
# repository, and give each team its own password only. The team's robot must use the same name and password.
"""
_LAUNCH = """\
<launch>
  <!-- The RSBB of this competition: the core and a referee's client, with the files beside this one.

       roslaunch competition.launch{host}

       Every other argument of roah_rsbb.launch can be given, too. -->
"""


def new_password() -> str:
    """A password that nobody guesses, which YAML, shells and launch files take as it is."""
    return secrets.choice(_LETTERS) + "".join(secrets.choice(_FURTHER) for _ in range(_PASSWORD_LENGTH - 1))


def yaml_text(text: str) -> str:
    """A text of one line as YAML."""
    if _PLAIN.fullmatch(text) and isinstance(yaml.safe_load(text), str):
        return text
    return "'" + text.replace("'", "''") + "'"


def passwords_text(passwords: Dict[str, str]) -> str:
    """The passwords file; `passwords` is password by team."""
    lines = [f"{yaml_text(team)}: {yaml_text(password)}" for team, password in passwords.items()]
    return "\n".join([_PASSWORDS, *lines, ""])


def benchmarks_text(shipped: str, codes: Sequence[str]) -> str:
    """The shipped benchmarks file with these benchmarks alone."""
    head, *entries = _BENCHMARK.split(shipped)
    held = [entry for entry in entries if _CODE.search(entry).group(1) in codes]
    return head + "".join(held).rstrip("\n") + "\n"


def schedule_text(shipped: str, zones: Iterable[PlannedZone], clock: VenueClock) -> str:
    """The schedule file, explained as the shipped one is; behind each run stands what the venue's wall shows."""
    lines = [line for line in shipped.splitlines() if line.startswith("#")]
    lines += ["#", "# Behind each run stands when it begins at the venue."]
    for zone in zones:
        lines += ["", f"- zone: {yaml_text(zone.name)}", "  schedule:", *_runs(zone.runs, clock)]
    return "\n".join([*lines, ""])


def _runs(runs: Sequence[Run], clock: VenueClock) -> List[str]:
    widest = max(len(yaml_text(run.team)) for run in runs)
    return [
        f"    - {{ benchmark: {run.code + ',':7} team: {yaml_text(run.team) + ',':{widest + 1}} round: {run.round}, "
        f"run: {run.run}, scheduled_time: {run.begins:%Y-%m-%d %H:%M:%S} }}  # {_on_the_wall(run.begins, clock)}"
        for run in runs
    ]


def _on_the_wall(moment: datetime.datetime, clock: VenueClock) -> str:
    wall = clock.wall(moment)
    return f"{wall:%A} {wall:%H:%M}"


def module_codes(codes: Iterable[str]) -> List[str]:
    """The benchmarks that a module drives, and which so have a file of parameters."""
    return [code for code in codes if KINDS[code] is Kind.FUNCTIONALITY]


def needs_tablet(plan: Plan) -> bool:
    """Whether a benchmark of the competition uses the tablet."""
    return any(code in plan.codes for code in _WITH_TABLET)


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
        ("modules", yes[bool(module_codes(plan.codes))], "Drive functionality benchmarks here"),
        ("modules_dir", f"{beside}/modules",
         "Directory with the parameters of the benchmarking modules and ground_truth.yaml"),
        ("tablet", yes[needs_tablet(plan)], "Serve the tablet's page, for HCFGAC"),
        ("devices", yes[any(code in plan.codes for code in _WITH_DEVICES)],
         "Drive the home devices: the door's bell in HWV, all of them in HCFGAC"),
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
