"""Fixtures for several tests of the rulebook."""

import pytest

from helpers.config_files import ConfigDir


@pytest.fixture
def files(tmp_path) -> ConfigDir:
    """The three configuration files, in a directory of the test's own."""
    return ConfigDir(tmp_path)
