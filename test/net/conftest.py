"""The network, the box on it, and the options of these tests (README.md)."""

import pathlib
import sys

import pytest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "ros"), str(HERE.parent / "pure")]

from box import WITH_ROS, WITHOUT_ROS  # noqa: E402 - from the path above

_MEASURED = []


def pytest_addoption(parser) -> None:
    """The options."""
    parser.addoption("--all", action="store_true", help="each trouble by itself, in every benchmark: many minutes")
    parser.addoption("--seed", type=int, default=1, help="of all that is left to chance (default: 1)")


def pytest_generate_tests(metafunc) -> None:
    """The long form has more rounds."""
    if "plan" in metafunc.fixturenames:
        from rounds import LONG, SHORT
        plans = LONG if metafunc.config.getoption("--all") else SHORT
        metafunc.parametrize("plan", plans, ids=[plan.name for plan in plans])


@pytest.fixture(scope="module", params=[WITH_ROS, WITHOUT_ROS])
def net(request):
    """The network with the box."""
    from namespaces import NoRight
    from net import Net
    try:
        made = Net(request.config.getoption("--seed"), request.param)
    except NoRight as reason:
        pytest.skip(f"NOT TESTED on a bad network: {reason}")
    yield made
    made.close()


@pytest.fixture(scope="session")
def measured():
    """Lines with measurements, which are shown at the end."""
    return _MEASURED


def pytest_terminal_summary(terminalreporter) -> None:
    """Show the measurements."""
    for line in _MEASURED:
        terminalreporter.write_line(line)
