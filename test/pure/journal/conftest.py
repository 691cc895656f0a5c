"""A journal and its copy."""

import pytest

from helpers.copied import Copied


@pytest.fixture
def copied(tmp_path):
    made = Copied(tmp_path)
    yield made
    made.close()
