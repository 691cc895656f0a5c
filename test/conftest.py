"""Prepares the tests that pytest runs.

The pure tests find the package in the source tree, and its generated protobuf code. Tests, and the programs that they
start, have a temporary folder of their own, which is removed at the end.
"""

import atexit
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
GENERATED = ROOT / "build" / "pb" / f"python{sys.version_info[0]}.{sys.version_info[1]}"


def _generate() -> None:
    """Generate roah_rsbb.pb with the protoc of this machine, unless it is newer than its source."""
    package = GENERATED / "pb"
    source = ROOT / "proto" / "roah_rsbb_msgs.proto"
    module = package / "roah_rsbb_msgs_pb2.py"
    if not module.exists() or module.stat().st_mtime < source.stat().st_mtime:
        package.mkdir(parents=True, exist_ok=True)
        # Several runs may generate it at the same time, and each must find a complete file.
        with tempfile.TemporaryDirectory(dir=str(package)) as draft:
            subprocess.run(["protoc", "-I", str(source.parent), f"--python_out={draft}", str(source)], check=True)
            os.replace(os.path.join(draft, module.name), str(module))
    (package / "__init__.py").touch()


def _own_temporary_folder():
    """Make a temporary folder for this process. `--basetemp FOLDER` keeps what tests write to `tmp_path`."""
    folder, owner = tempfile.mkdtemp(prefix="tests_"), os.getpid()
    os.chmod(folder, 0o711)  # a test opens its files as another user
    # At exit, not at the end of the tests: pytest still locks a folder in it. A fork of this process removes nothing.
    atexit.register(lambda: os.getpid() == owner and shutil.rmtree(folder, ignore_errors=True))
    os.environ["TMPDIR"] = tempfile.tempdir = folder


def pytest_addoption(parser):
    parser.addoption(
        "--second-python", action="store_true",
        help="leave out what another Python tests: long tests, all but one case of each test, and of what needs only "
             "the standard library two of three files and half of the others' tests")


def pytest_configure(config):
    if config.getoption("--second-python"):
        # Not even collected: to collect all tests takes as long as to run those that are chosen.
        config.option.ignore = [*(config.option.ignore or ()), *_left_out()]
    config.addinivalue_line("markers", "random: makes many random inputs; a second Python leaves it out")
    config.addinivalue_line("markers", "long: takes long and depends on no version; a second Python leaves it out")


# Folders of test/pure whose subjects need a library: its versions differ as well as Python's.
WITH_LIBRARIES = ("comm", "journal", "robot", "rulebook", "web")
PURE = ROOT / "test" / "pure"


def _left_out():
    """Files that a second Python does not collect."""
    folders = (path for path in sorted(PURE.iterdir()) if path.is_dir() and path.name not in WITH_LIBRARIES)
    for folder in folders:
        for number, path in enumerate(sorted(folder.rglob("test_*.py"))):
            if number % 3:
                yield str(path)


def pytest_collection_modifyitems(config, items):
    if not config.getoption("--second-python"):
        return
    cases = {}
    for item in items:
        is_left_out = item.get_closest_marker("random") or item.get_closest_marker("long")
        cases.setdefault(item.nodeid.partition("[")[0], []).extend([] if is_left_out else [item])
    files = {}
    for each in filter(None, cases.values()):
        files.setdefault(pathlib.Path(each[0].fspath), []).append(each[len(each) // 2])
    chosen = set()
    for path, tests in files.items():
        has_library = path.relative_to(PURE).parts[0] in WITH_LIBRARIES
        chosen.update(tests if has_library else tests[::2])
    config.hook.pytest_deselected(items=[item for item in items if item not in chosen])
    items[:] = [item for item in items if item in chosen]


def _speak_english():
    """Windows of tests are in English on any computer (docs/referee.md, "Language")."""
    for name in ("LC_ALL", "LC_MESSAGES", "LANGUAGE"):
        os.environ.pop(name, None)
    os.environ["LANG"] = "C.UTF-8"


sys.path.insert(0, str(ROOT / "src"))
sys.path[:0] = [str(ROOT / "test" / "fuzz"), str(ROOT / "test" / "simulator")]
sys.path.insert(0, str(ROOT / "test" / "pure"))
_generate()
_own_temporary_folder()
_speak_english()

import roah_rsbb  # noqa: E402  (only now can it be found)

roah_rsbb.__path__ = [str(ROOT / "src" / "roah_rsbb"), str(GENERATED)]
