"""Datagrams that repeat what a robot said before take a short way, and nobody sees a difference."""

import random
import time

import pytest

from helpers.examples import ALL
from helpers.twin_boxes import TwinBoxes
from roah_rsbb.core.runs.run import Run
from roah_rsbb.radio.short_way import Turns

# Seconds of processor time.
TRY_S = 20.0 if ALL else 3.0
STEPS, CHECK_EACH = 3000, 40


def differences(seed, steps=STEPS):
    """What differs first between two boxes; None: nothing. Also the boxes."""
    boxes = TwinBoxes(seed)
    for number in range(steps):
        boxes.step()
        if number % CHECK_EACH == 0:
            found = boxes.check()
            if found is not None:
                return found, boxes
    return boxes.check(), boxes


@pytest.mark.random
def test_the_short_way_makes_no_difference(caplog):
    seeds, began = random.SystemRandom(), time.process_time()
    datagrams = waited = 0
    while time.process_time() - began < TRY_S:
        seed = seeds.randrange(2**31)
        found, boxes = differences(seed)
        assert found is None, f"seed {seed}"
        assert caplog.records == [], f"seed {seed}"
        datagrams, waited = datagrams + boxes.datagrams, waited + boxes.waited
    assert waited > 0.05 * datagrams  # one seed: 0.08 to 0.54


def _wrong(kind, name, wrong):
    return pytest.param(kind, name, wrong, id=name)


@pytest.mark.parametrize("kind, name, wrong", [
    _wrong(Run, "settled_at", property(lambda run: run._revision())),
    _wrong(Turns, "take", lambda turns: turns.waiting.clear()),
])
def test_a_promise_that_is_not_kept_makes_a_difference(monkeypatch, kind, name, wrong):
    monkeypatch.setattr(kind, name, wrong)
    assert any(differences(seed)[0] is not None for seed in range(20))
