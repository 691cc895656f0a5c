"""The house of docs/architecture.md: which folder may import what, and how many files a folder holds."""

import pathlib
import re
import runpy
import sys
from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Set, Tuple

import pytest

from helpers.imports import imports_of

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "roah_rsbb"
MAX_FILES = 21
# Generated from proto/, msg/ and srv/.
GENERATED = ("pb", "msg", "srv")
ROS = ("rospy", "rosgraph", "rospkg", "genpy", "rosbag", "std_msgs", "std_srvs", "geometry_msgs", "tf2_msgs", "tf2_ros")


class Allowed(NamedTuple):
    """What a folder may import besides itself and the standard library."""

    project: Tuple[str, ...] = ()  # folders or modules of the package
    others: Tuple[str, ...] = ()  # other top-level packages


def _read_table() -> Dict[str, Allowed]:
    """The table "Imports" of docs/architecture.md."""
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    part = page[page.index("\n## Imports\n"):]
    table: Dict[str, Allowed] = {"__init__": Allowed()}
    for row in re.findall(r"^\| (`.*) \|$", part[:part.index("\n## ", 1)], re.MULTILINE):
        folders, project, others = (cell.strip() for cell in row.split("|"))
        above = (*(folder for folder in table if folder != "__init__"), *GENERATED) if "all above" in project else ()
        ros = ROS if "ROS" in others else ()
        allowed = Allowed((*above, *re.findall(r"`([\w.]+)`", project)), (*ros, *re.findall(r"`(\w+)`", others)))
        table.update(dict.fromkeys(re.findall(r"`([\w.]+)`", folders), allowed))
    return table


FOLDERS = _read_table()

# Imports that still break the table: (file, what it imports). Only ever take entries out.
KNOWN: Set[Tuple[str, str]] = set()


def _files() -> List[pathlib.Path]:
    return sorted(path for path in PACKAGE.rglob("*.py"))


def _module(path: pathlib.Path) -> str:
    """The dotted name within the package."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)


MODULES: FrozenSet[str] = frozenset(_module(path) for path in _files())


def _imported(path: pathlib.Path) -> Iterator[str]:
    """All modules that a file imports anywhere in it, by full name; a module's name rather than its package's."""
    for module, name in imports_of(path):
        longer = f"{module}.{name}"
        is_module = longer.startswith("roah_rsbb.") and (longer[len("roah_rsbb."):] in MODULES or name in GENERATED)
        yield longer if is_module else module


def _is_in(module: str, folder: str) -> bool:
    return module == folder or module.startswith(f"{folder}.")


def _row(module: str) -> str:
    """The folder whose row holds for a module: the innermost one that has a row."""
    return max((folder for folder in FOLDERS if _is_in(module, folder)), key=len, default=module.split(".")[0])


def _problem(folder: str, name: str) -> str:
    """What is wrong with a folder importing this; empty: nothing."""
    if name == "roah_rsbb":
        return ""
    if not name.startswith("roah_rsbb."):
        top = name.split(".")[0]
        standard = getattr(sys, "stdlib_module_names", None)  # Python 3.10 and later
        allowed = standard is None or top in standard or top in FOLDERS[folder].others
        return "" if allowed else name
    module = name[len("roah_rsbb."):]
    row = _row(module)
    allowed = any(_is_in(module, place) and _is_in(place, row) for place in (folder, *FOLDERS[folder].project))
    return "" if allowed else module


def _problems() -> Dict[Tuple[str, str], str]:
    found = {}
    for path in _files():
        file = str(path.relative_to(PACKAGE))
        folder = _row(_module(path))
        if folder not in FOLDERS:
            found[file, ""] = f"{file}: {folder} is not in the table of docs/architecture.md"
            continue
        for name in _imported(path):
            problem = _problem(folder, name)
            if problem:
                found[file, problem] = f"{file} imports {problem}, which {folder} may not"
    return found


def test_no_folder_imports_what_it_may_not():
    problems = _problems()
    assert [text for key, text in problems.items() if key not in KNOWN] == []
    assert KNOWN - set(problems) == set(), "these are repaired: take them out of KNOWN"


def _used() -> Dict[str, Set[str]]:
    """What the files of each row import, without the package's name."""
    used: Dict[str, Set[str]] = {}
    for path in _files():
        names = {name[len("roah_rsbb."):] if name.startswith("roah_rsbb.") else name for name in _imported(path)}
        used.setdefault(_row(_module(path)), set()).update(names)
    return used


def test_the_table_allows_only_what_is_used():
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    part = page[page.index("\n## Imports\n"):]
    used, unused = _used(), []
    for row in re.findall(r"^\| (`.*) \|$", part[:part.index("\n## ", 1)], re.MULTILINE):
        folders, *allowed = (re.findall(r"`([\w.]+)`", cell) for cell in row.split("|"))
        names = set().union(*(used.get(folder, set()) for folder in folders))
        unused += [f"{folders[0]}: {place}" for place in (*allowed[0], *allowed[1])
                   if place not in folders and not any(_is_in(name, place) for name in names)]
    assert unused == []


def test_no_folder_imports_a_floor_above():
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d) \| [^|]* \| (.*) \|$", page, re.MULTILINE)
    floors = {folder: int(number) for number, folders in rows for folder in re.findall(r"`(\w+)`", folders)}
    tops = {module.split(".")[0] for module in MODULES} - {"__init__"}
    assert set(floors) == tops
    assert {f"{row} imports {name}" for row, names in _used().items() for name in names
            if name.split(".")[0] in tops and floors[name.split(".")[0]] > floors.get(row.split(".")[0], 0)
            and row != "__init__"} == set()


CONTENTS = runpy.run_path(str(ROOT / "packaging" / "contents.py"))
# What else the modules of a package may import: what is installed with it, and what they do without.
OTHERS = {"robot": {"google", "cryptography", "argcomplete"},
          "comm": {"google", *ROS},
          "check": {"google", "cryptography", "argcomplete", "yaml", "dateutil"},
          "results": {"yaml", "argcomplete", "mcap", "mcap_ros2"},
          "box": {"google", "cryptography", "argcomplete", "yaml", "tornado", "qrcode",
                  "roah_rsbb.ros.modules.check_ground_truth", "roah_rsbb.ros.display"}}


def _of_package(package: str) -> List[pathlib.Path]:
    return [path for path in _files()
            if CONTENTS["package_of"](path.relative_to(PACKAGE.parent).as_posix()) == package]


def _is_for(package: str, name: str) -> bool:
    """Whether a package, or one that it needs, has this module; of others, whether it is installed with it."""
    top, *rest = name.split(".")
    if top != "roah_rsbb":
        return top in OTHERS[package] or top in getattr(sys, "stdlib_module_names", (top,))
    place = PACKAGE.joinpath(*rest)
    ending = "/__init__.py" if place.is_dir() else ".py" if place.with_suffix(".py").is_file() else "/"
    owner = CONTENTS["package_of"](name.replace(".", "/") + ending)
    return owner in (package, *CONTENTS["NEEDS"][package]) or name in OTHERS[package]


@pytest.mark.parametrize("package", OTHERS)
def test_a_package_imports_only_what_it_has_or_needs(package):
    files = _of_package(package)
    assert files
    assert [f"{path} imports {name}" for path in files for name in _imported(path) if not _is_for(package, name)] == []


def test_the_entries_of_packages_exist():
    """A file that moved would silently change its package."""
    entries = {entry for entries in CONTENTS["CONTENTS"].values() for entry in entries}
    made = {"", "etc/roah-rsbb/", "usr/share/applications/", "changelog", "copyright",
            *(f"roah_rsbb/{name}/" for name in GENERATED)}
    assert [entry for entry in entries - made if not any((top / entry).exists() for top in (ROOT, ROOT / "src"))] == []


def test_a_robot_gets_a_small_package():
    assert sum(len(path.read_text(encoding="utf-8").splitlines()) for path in _of_package("robot")) <= 5000


def _cycles() -> List[str]:
    """Modules of the package that import each other, directly or by others."""
    graph = {}
    for path in _files():
        names = {name[len("roah_rsbb."):] for name in _imported(path) if name.startswith("roah_rsbb.")}
        graph[_module(path)] = (names & MODULES) - {_module(path)}
    # Take away whoever imports nothing that is left, until nothing changes.
    left = dict(graph)
    while True:
        free = [module for module, imports in left.items() if not imports & left.keys()]
        if not free:
            break
        for module in free:
            del left[module]
    importers = {module: {m for m in left if module in left[m]} for module in left}
    while True:
        free = [module for module, who in importers.items() if not who & importers.keys()]
        if not free:
            return sorted(importers)
        for module in free:
            del importers[module]


def test_no_modules_import_each_other():
    assert _cycles() == []


def _folders() -> List[pathlib.Path]:
    return sorted({path.parent for path in _files()})


@pytest.mark.parametrize("folder", _folders(), ids=lambda path: str(path.relative_to(PACKAGE.parent)))
def test_no_folder_is_a_heap(folder):
    files = [path.name for path in folder.iterdir() if path.is_file() and path.name != "__init__.py"]
    assert len(files) < MAX_FILES, f"{folder}: {len(files)} files: make folders by subject"


def test_a_named_tuple_has_no_other_base():
    """Python 3.9 and 3.10, on which these tests rarely run, cannot import such a class."""
    wrong = re.compile(r"\(NamedTuple, |, NamedTuple\b.*\):")
    assert [str(path) for path in _files() if wrong.search(path.read_text("utf-8"))] == []
