"""How many random inputs a test gets; and random stories of a box."""

import os

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

# `make test-all` gives all of them, `make test` a quarter. They are the same ones every time.
ALL = os.environ.get("ROAH_TEST_ALL") == "yes"
SHARE = 1.0 if ALL else 0.25

# A busy machine is no fault of the test. Ubuntu 20.04's hypothesis has no check of fixtures.
_NOT_CHECKED = [check for check in HealthCheck if check.name in ("too_slow", "function_scoped_fixture")]

# What happens to a box (`fuzzing.core.Play`), one input for each event. Referees do most.
OPENINGS = st.integers(0, 3).map(lambda number: bytes([number]))
STORIES = st.lists(st.builds(lambda kind, choices: bytes([kind]) + choices,
                             st.sampled_from([*range(15), *[8] * 8, *[9] * 6]), st.binary(max_size=20)),
                   min_size=12, max_size=60)


def few(number: int) -> int:
    """The number of examples, or rounds, of this run; at least one."""
    return max(1, round(number * SHARE))


def examples(number: int = 100):
    """Decorates a hypothesis test that has `number` examples in `make test-all`.

    The test is marked as random: Python 3.8 leaves those to `make test-all`.
    """
    chosen = settings(
        max_examples=few(number), deadline=None, database=None, derandomize=True, print_blob=False,
        suppress_health_check=_NOT_CHECKED,
    )

    def decorate(test):
        return pytest.mark.random(chosen(test))

    return decorate
