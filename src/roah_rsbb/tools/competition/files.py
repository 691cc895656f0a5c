"""A competition's directory: what is in it, made at once or not at all."""

import contextlib
import os
from typing import Dict, Iterator, List, NamedTuple, Optional

from roah_rsbb.tools.competition import texts
from roah_rsbb.tools.competition.firewall import firewall_text
from roah_rsbb.tools.competition.moments import VenueClock
from roah_rsbb.tools.competition.plan import Plan

BENCHMARKS, SCHEDULE, PASSWORDS = "benchmarks.yaml", "schedule.yaml", "passwords.yaml"
LAUNCH = "competition.launch"
FIREWALL = "firewall.nft"
RSBB_PORT = 6666  # roah_rsbb.launch's
MODULES = "modules"
GROUND_TRUTH = "ground_truth.yaml"
_BEFORE = SCHEDULE + "~"


class CannotWrite(Exception):
    """Nothing was changed; str() says why and what to do."""


class Hosts(NamedTuple):
    """Addresses for the launch file; None: not known yet."""

    rsbb: Optional[str]
    smartif: Optional[str]
    interface: Optional[str] = None  # of this computer, to the robots


def module_file(code: str) -> str:
    """Where in the directory the parameters of a benchmark's module are."""
    return os.path.join(MODULES, f"{code}.yaml")


def new_files(config_dir: str, plan: Plan, clock: VenueClock, hosts: Hosts) -> Dict[str, str]:
    """Name and text of each file of a new competition; `config_dir` has the shipped ones."""
    passwords = {team: texts.new_password() for team in plan.teams}
    files = {
        BENCHMARKS: texts.benchmarks_text(_shipped(config_dir, BENCHMARKS), plan.codes),
        PASSWORDS: texts.passwords_text(passwords),
        SCHEDULE: texts.schedule_text(_shipped(config_dir, SCHEDULE), plan.zones, clock),
        LAUNCH: texts.launch_text(plan, hosts.rsbb, hosts.smartif),
        FIREWALL: firewall_text(FIREWALL, hosts.interface, RSBB_PORT, texts.needs_tablet(plan)),
    }
    modules = [module_file(code) for code in texts.module_codes(plan.codes)]
    if modules:
        modules.append(os.path.join(MODULES, GROUND_TRUTH))
    return {**files, **{name: _shipped(config_dir, name) for name in modules}}


def write_new(directory: str, files: Dict[str, str]) -> None:
    """Write the files; raises `CannotWrite` if one of them is there already, or cannot be written."""
    there = [name for name in files if os.path.lexists(os.path.join(directory, name))]
    if there:
        raise CannotWrite(f"{', '.join(there)} in {directory} would be overwritten: choose another directory (or "
                          "--schedule-only, which makes only the schedule anew; or --check)")
    made: List[str] = []
    with _told(directory):
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
    """Put a new schedule in the place of the old one; returns where that is kept, "" if there was none."""
    path, before = os.path.join(directory, SCHEDULE), os.path.join(directory, _BEFORE)
    with _told(directory):
        text = texts.schedule_text(_shipped(config_dir, SCHEDULE), plan.zones, clock)
        new = path + ".new"
        with contextlib.suppress(FileNotFoundError):
            os.unlink(new)
        _write(new, text, private=False)
        kept = os.path.exists(path)
        if kept:
            os.replace(path, before)
        os.replace(new, path)
    return before if kept else ""


def _shipped(config_dir: str, name: str) -> str:
    with open(os.path.join(config_dir, name), encoding="utf-8") as file:
        return file.read()


def _write(path: str, text: str, private: bool) -> None:
    """Write a new file; a private one is so from its first byte on."""
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600 if private else 0o666)
    with open(handle, "w", encoding="utf-8") as file:
        file.write(text)


@contextlib.contextmanager
def _told(directory: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        where = error.filename or directory
        raise CannotWrite(f"{where} cannot be written: {error.strerror}; choose another directory, or give this user "
                          "the right to write there") from None
