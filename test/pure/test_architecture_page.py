"""docs/architecture.md names folders, files, classes and functions that exist, and all folders of the package."""

import ast
import functools
import pathlib
import re
import subprocess
from typing import Dict, List, Set

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "roah_rsbb"
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
PROSE = re.sub(r"^ *```.*?^ *```$", "", PAGE, flags=re.MULTILINE | re.DOTALL)
# The table of imports is read by test_house.py.
WALKS = re.sub(r"^## Imports$.*?^## ", "## ", PROSE, flags=re.MULTILINE | re.DOTALL)
SPANS = sorted(set(re.findall(r"`([^`\n]+)`", WALKS)))
FILES = [span for span in SPANS if re.fullmatch(r"[\w/]+\.(?:py|md)", span)]
METHODS = [span for span in SPANS if re.fullmatch(r"[A-Z]\w+\.\w+", span)]
CLASSES = [span for span in SPANS if re.fullmatch(r"(?:[A-Z][a-z]+)+", span)]
FUNCTIONS = [span for span in SPANS
             if re.fullmatch(r"[a-z]\w+\.[a-z]\w+", span) and span not in FILES and span != "runs.outcome"]


class _Names:
    """The classes of the package by name, and the functions of each module by its last name."""

    def __init__(self) -> None:
        self.classes: Dict[str, List[ast.ClassDef]] = {}
        self.functions: Dict[str, Set[str]] = {}
        for path in PACKAGE.rglob("*.py"):
            functions = self.functions.setdefault(path.stem, set())
            for node in ast.parse(path.read_text(encoding="utf-8")).body:
                if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                    functions.add(node.name)
                elif isinstance(node, ast.ClassDef):
                    self.classes.setdefault(node.name, []).append(node)

    def has(self, name: str, method: str) -> bool:
        """Whether the class or one of its bases has the method."""
        nodes = self.classes.get(name, ())
        return any(getattr(part, "name", "") == method for node in nodes for part in node.body) or any(
            self.has(base.id, method) for node in nodes for base in node.bases if isinstance(base, ast.Name))


@functools.lru_cache(maxsize=None)
def names() -> _Names:
    return _Names()


def tree_paths() -> List[str]:
    """The paths in the tree of the page."""
    block = next(b for b in re.findall(r"^```text\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL) if "protocol.py" in b)
    paths, parent = [], ""
    for line in block.splitlines():
        name = line.split()[0]
        paths.append(parent + name if line.startswith("  ") else name)
        parent = parent if line.startswith("  ") else name
    return paths


def test_the_tree_names_all_folders_and_files_of_the_package():
    there = {f"{path.relative_to(PACKAGE)}/" for path in PACKAGE.rglob("*/") if list(path.glob("*.py"))}
    there |= {path.name for path in PACKAGE.glob("*.py")} - {"__init__.py"}
    assert set(tree_paths()) == there


def tracked(*options: str) -> List[str]:
    """The files that git tracks."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a checkout")
    command = ["git", "-C", str(ROOT), "ls-files", *options]
    listed = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if listed.returncode != 0:
        pytest.skip("git does not read this checkout")
    return listed.stdout.splitlines()


def test_the_top_folder_has_only_what_the_page_names():
    block = re.search(r"^The top folder:\n+```text\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL).group(1)
    named = {name for line in block.splitlines() for name in line.split("  ")[0].split()}
    assert named == {re.sub("/.*", "/", path) for path in tracked()}


def test_no_file_was_committed_by_mistake():
    """`.gitignore` lists what no build and no person needs."""
    assert tracked("--cached", "--ignored", "--exclude-from=.gitignore") == []


@pytest.mark.parametrize("name", FILES)
def test_a_file_exists(name):
    assert any((folder / name).is_file() for folder in (ROOT, PACKAGE, ROOT / "docs"))


@pytest.mark.parametrize("name", METHODS)
def test_a_method_exists(name):
    assert names().has(*name.split("."))


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_exists(name):
    assert name in names().classes


def test_a_name_is_that_of_one_class():
    """All others are in the table of the page, with the reason."""
    allowed = set(re.findall(r"^\| `([A-Z]\w+)` \| [a-z].* \|$", PAGE, re.MULTILINE))
    assert {name for name, nodes in names().classes.items() if len(nodes) > 1 and name[0] != "_"} == allowed
    assert len(allowed) <= 5


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_exists(name):
    module, function = name.split(".")
    assert function in names().functions.get(module, set())


def table_of(heading: str) -> List[List[str]]:
    """The rows of the table of a section, without their back quotes."""
    section = PAGE.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows = [re.split(r" *\| *", line.strip("| ").replace("`", "")) for line in section.splitlines() if line[:1] == "|"]
    return rows[2:]


def test_the_table_of_the_box_has_all_objects_of_its_constructor():
    tree = ast.parse((PACKAGE / "core" / "box.py").read_text(encoding="utf-8"))
    modules = {name.name: node.module.split(".", 1)[1] for node in tree.body if isinstance(node, ast.ImportFrom)
               for name in node.names if node.module.startswith(("roah_rsbb.core", "roah_rsbb.scoring"))}
    constructor = next(node for node in ast.walk(tree)
                       if isinstance(node, ast.FunctionDef) and node.name == "__init__")
    made = [node.func.id for node in ast.walk(constructor)
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)]
    # What a device or robot reports is a message, not a part.
    parts = {name: modules[name] for name in made if modules.get(name, "core.messages") != "core.messages"}
    assert {row[0]: row[1] for row in table_of("The box")} == {
        name: f"{module.replace('.', '/')}.py" for name, module in parts.items()}


def test_the_table_of_topics_has_all_that_the_core_publishes():
    text = "".join(path.read_text(encoding="utf-8") for path in sorted((PACKAGE / "ros" / "core").glob("*.py")))
    topics = re.findall(r'(?:rospy\.Publisher|LatchedTopic)\("(/\w[\w/]*)"', text)
    assert len(topics) == 7
    assert sorted(row[0] for row in table_of("What the core publishes")) == sorted(topics)


def test_files_to_check_are_found():
    assert len(FILES) > 40 and len(METHODS) > 30 and len(CLASSES) > 15 and len(FUNCTIONS) > 5


# -- budgets ------------------------------------------------------------------------------------------


def budgets() -> Dict[str, int]:
    """How many lines each folder may have, by the page."""
    table = re.search(r"^### Budgets$(.*?)^## ", PAGE, re.MULTILINE | re.DOTALL).group(1)
    rows = re.findall(r"^\| `(\S+)` \| ([\d,]+) \|$", table, re.MULTILINE)
    return {name: int(number.replace(",", "")) for name, number in rows}


def _lines(path: pathlib.Path) -> int:
    return sum(len(one.read_text(encoding="utf-8").splitlines()) for one in path.rglob("*.py"))


FOLDERS = sorted(path.name for path in PACKAGE.iterdir() if path.is_dir() and path.name != "__pycache__")


def test_each_folder_has_a_budget():
    assert set(budgets()) == {*FOLDERS, "src", "test"}


@pytest.mark.parametrize("folder", [*FOLDERS, "src", "test"])
def test_a_folder_keeps_its_budget(folder):
    """A failure? Delete something, or raise the number in the same change and say why in the commit."""
    path = ROOT / folder if folder in ("src", "test") else PACKAGE / folder
    assert _lines(path) <= budgets()[folder]
