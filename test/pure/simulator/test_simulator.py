"""The whole box in simulated time, with random troubles (test/simulator/README.md)."""

import pathlib
import shutil
import subprocess
import sys

import pytest

from helpers.examples import ALL
from simulation.faults import FAULTS, SEEDS, plant, planted
from simulation.shorten import failure_of, shortened
from simulation.world import ORGANISED, simulate

ROOT = pathlib.Path(__file__).parents[3]
SOURCE = ROOT / "src" / "roah_rsbb"
# Always the same ones: `make simulate` draws others.
FIXED = [*range(1, 101 if ALL else 21), *range(ORGANISED, ORGANISED + (50 if ALL else 5))]
# Seeds that once failed, each with what it found.
KEPT = ROOT / "test" / "simulator" / "kept_seeds.txt"
# Faults that few seeds find.
QUICK = ("an answer names the ticket of the record before", "points of penalties are left out")


def kept_seeds():
    return [int(line.split()[0]) for line in KEPT.read_text("utf-8").splitlines() if line and line[0] != "#"]


def check(seed):
    failure = failure_of(seed)
    assert failure is None, str(shortened(failure))


@pytest.mark.random
@pytest.mark.parametrize("seed", kept_seeds())
def test_seeds_that_once_failed(seed):
    check(seed)


@pytest.mark.random
def test_some_seeds():
    """A few seconds."""
    for seed in FIXED:
        check(seed)


@pytest.mark.parametrize("seed", [1])
def test_a_seed_is_always_the_same(seed):
    first, second = simulate(seed), simulate(seed)
    assert first.trace.lines == second.trace.lines
    assert first.trace.digest == second.trace.digest
    assert first.journal == second.journal


def test_all_planted_faults_fit_the_source():
    for fault in FAULTS:
        planted(fault, SOURCE)


@pytest.mark.random
@pytest.mark.parametrize("fault", [each for each in FAULTS if ALL or each.name in QUICK], ids=lambda each: each.name)
def test_a_planted_fault_is_found(tmp_path, fault):
    copy = shutil.copytree(str(SOURCE), str(tmp_path / "roah_rsbb"), ignore=shutil.ignore_patterns("__pycache__"))
    plant(fault, copy)
    found = subprocess.run(
        [sys.executable, str(ROOT / "test" / "simulator" / "simulate.py"), "--source", copy,
         "--first", str(fault.first), "--count", str(SEEDS)], stdout=subprocess.PIPE, text=True)
    assert found.returncode == 1, found.stdout
    assert f"seeds from {fault.first} on" in found.stdout, "it failed in another way"
