"""Lets the pure tests find the package from the source tree, and its generated protobuf code."""

import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
GENERATED = ROOT / "build" / "pb" / f"python{sys.version_info[0]}.{sys.version_info[1]}"


def _generate() -> None:
    """Generate roah_rsbb.pb with the protoc of this machine, unless it is newer than its source."""
    package = GENERATED / "pb"
    source = ROOT / "proto" / "roah_rsbb_msgs.proto"
    module = package / "roah_rsbb_msgs_pb2.py"
    if not module.exists() or module.stat().st_mtime < source.stat().st_mtime:
        package.mkdir(parents=True, exist_ok=True)
        subprocess.run(["protoc", "-I", str(source.parent), f"--python_out={package}", str(source)], check=True)
    (package / "__init__.py").touch()


def pytest_addoption(parser):
    parser.addoption(
        "--second-python", action="store_true",
        help="leave out what another Python tests: long tests, and all but three cases of each test")


def pytest_configure(config):
    config.addinivalue_line("markers", "random: makes many random inputs; a second Python leaves it out")
    config.addinivalue_line("markers", "long: takes long and depends on no version; a second Python leaves it out")


def pytest_collection_modifyitems(config, items):
    if not config.getoption("--second-python"):
        return
    cases = {}
    for item in items:
        is_left_out = item.get_closest_marker("random") or item.get_closest_marker("long")
        cases.setdefault(item.nodeid.partition("[")[0], []).extend([] if is_left_out else [item])
    chosen = {item for those in cases.values() for item in (*those[:1], *those[len(those) // 2:][:1], *those[-1:])}
    config.hook.pytest_deselected(items=[item for item in items if item not in chosen])
    items[:] = [item for item in items if item in chosen]


sys.path.insert(0, str(ROOT / "src"))
sys.path.insert(0, str(ROOT / "test" / "pure"))
_generate()

import roah_rsbb  # noqa: E402  (only now can it be found)

roah_rsbb.__path__ = [str(ROOT / "src" / "roah_rsbb"), str(GENERATED)]
