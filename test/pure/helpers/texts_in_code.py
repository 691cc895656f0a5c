"""Finds the texts that windows show in the source code: those for the translators, and those that were forgotten."""

import ast
import functools
import pathlib
import re
import string
from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Set

ROOT = pathlib.Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "src" / "roah_rsbb"
# The folders whose texts windows show.
FOLDERS = ("wording", "rqt")
# What is shown in other languages: texts of windows, and reasons, wherever they are made.
SAY = "say"
MARKS = ("tr", "tr_later", SAY)
WORDS = "tr_words"  # several texts, by their names

# Calls whose texts no window shows: log lines, errors of programs, command lines, formats.
NOT_SHOWN = {
    "logdebug", "loginfo", "logwarn", "logerr", "logerror", "error", "print", "_say", "exit", "add_argument", "Parser",
    "ArgumentTypeError", "NotImplementedError", "AttributeError", "ServiceException", "signal_shutdown", "shutdown",
    "strftime", "_format", "moment", "strptime", "compile", "sub", "findall", "set_style", "setStyleSheet",
    "setObjectName", "QSettings", "value", "setValue", "QColor", "Tone", "QKeySequence", "get_param", "TwiceKey",
    "service", "command", "Thread", "_key", "TypeVar", "import_module",
}
# A word of two letters or more, and another word or a capital letter: what no identifier or key has.
_SENTENCE = re.compile(r"[^\W\d_]{2,}\W* \W*[^\W\d_]|^[^\w]*[A-Z][a-z]+[^\w]*$|[^\w] ?[A-Za-z]{2,}$|^[A-Z]{2,}$")
_WORD = re.compile(r"[^\W\d_]{2,}")
# Names of classes, topics, files, style sheets and HTML.
_NAME = re.compile(r"^([A-Z][a-z0-9]+){2,}$|^[\w.]*/[\w./{}]*$|^#[0-9a-f]{6}$|^~?[a-z_]+\.?$|^\W*$")
_MARKUP = re.compile(
    r"<(p|br|b|table|tr|td)\b|\b(background|color|border|padding)[-a-z]*: |\bsolid palette\b|\bQ[A-Z]\w+ {")


class Text(NamedTuple):
    """A text in the code."""

    text: str
    place: str  # file in the package
    line: int


class Found(NamedTuple):
    """What a file holds."""

    marked: List[Text]  # for the translators
    forgotten: List[Text]
    wrong: List[Text]  # calls of `tr` with a text that is composed in them


def files() -> List[pathlib.Path]:
    """Return all files whose texts windows show."""
    return [path for folder in FOLDERS for path in sorted((PACKAGE / folder).rglob("*.py"))]


def find(source: str, place: str) -> Found:
    """Return the texts in a file."""
    visitor = _Visitor(place)
    visitor.visit(ast.parse(source))
    return Found(visitor.marked, visitor.forgotten, visitor.wrong)


@functools.lru_cache(maxsize=None)
def find_in(path: pathlib.Path) -> Found:
    """Return the texts in a file of the package."""
    return find(path.read_text(encoding="utf-8"), path.relative_to(PACKAGE).as_posix())


def marked() -> Dict[str, str]:
    """Return all texts for the translators, in the order of the files, with the first file of each."""
    found: Dict[str, str] = {}
    for path in files():
        for text in find_in(path).marked:
            found.setdefault(text.text, text.place)
    for text in said():
        found.setdefault(text.text, text.place)
    return found


@functools.lru_cache(maxsize=None)
def said() -> List[Text]:
    """Return the templates of all reasons, in the order of the files, as often as they are registered."""
    return [text for path in sorted(PACKAGE.rglob("*.py")) for text in _said_in(path)]


def _said_in(path: pathlib.Path) -> List[Text]:
    source = path.read_text(encoding="utf-8")
    place = path.relative_to(PACKAGE).as_posix()
    return [Text(node.args[0].value, place, node.lineno) for node in ast.walk(ast.parse(source))
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == SAY and node.args
            and isinstance(node.args[0], ast.Constant)]


def literals(source: str) -> List[str]:
    """Return all texts in a file; places for values are written as {}."""
    found = (_string(node) for node in ast.walk(ast.parse(source)))
    return [text for text in found if text is not None]


def placeholders(text: str) -> List[str]:
    """Return the places for values in a text, such as ["{zone}"], sorted."""
    return sorted(re.findall(r"{[^{}]*}", text))


def _name(function: ast.expr) -> str:
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def _string(node: Optional[ast.AST]) -> Optional[str]:
    """The text of a literal; places for values are written as {}."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return None


def _literals(node: ast.AST) -> Iterator[ast.AST]:
    """All literals in an expression that become part of its text, such as both of `"yes" if on else "no"`."""
    if isinstance(node, (ast.Constant, ast.JoinedStr)):
        yield node
    elif isinstance(node, ast.IfExp):
        yield from _literals(node.body)
        yield from _literals(node.orelse)
    elif isinstance(node, ast.BoolOp):
        for value in node.values:
            yield from _literals(value)
    elif isinstance(node, ast.BinOp):
        yield from _literals(node.left)
        yield from _literals(node.right)


# Calls that show a text: even a single word in them is one.
SHOWN = {
    "setText", "setWindowTitle", "setToolTip", "setPlaceholderText", "setTabText", "setTitle", "setSuffix",
    "setInformativeText", "setAccessibleName", "addAction", "addMenu", "addTab", "addItem", "addRow", "addButton",
    "QLabel", "QPushButton", "QCheckBox", "QGroupBox", "QDockWidget", "CommandButton", "HoldButton", "show_text",
    "say", "warn", "tip", "ask", "allow", "show_outcome", "write", "_button", "button", "begin", "ScoreDialog",
    "Figure",
}


class _Visitor(ast.NodeVisitor):
    def __init__(self, place: str) -> None:
        self._place = place
        self._done: Set[int] = set()  # literals that were judged
        self.marked: List[Text] = []
        self.forgotten: List[Text] = []
        self.wrong: List[Text] = []

    def _add(self, texts: List[Text], text: str, node: ast.AST) -> None:
        texts.append(Text(text, self._place, node.lineno))

    def _skip(self, node: ast.AST) -> None:
        self._done.update(id(part) for part in ast.walk(node))

    def _visit_documented(self, node) -> None:
        first = node.body[0] if node.body else None
        if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
            self._skip(first)
        self.generic_visit(node)

    visit_Module = visit_ClassDef = _visit_documented

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        for part in (node.returns, *(argument.annotation for argument in node.args.args)):
            if part is not None:
                self._skip(part)
        self._visit_documented(node)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        self._skip(node.annotation)
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        name = _name(node.func)
        if name in MARKS and not (name == SAY and isinstance(node.func, ast.Attribute)):  # a panel says something
            self._mark(node)
        elif name == WORDS:
            for word in node.keywords:
                if _string(word.value) is not None:
                    self._add(self.marked, word.value.value, word.value)
                    self._done.add(id(word.value))
        elif name in NOT_SHOWN:
            self._skip(node.func)
            for part in (*node.args, *(keyword.value for keyword in node.keywords)):
                if _string(part) is not None:
                    self._done.add(id(part))
        elif name in SHOWN:
            for part in (*node.args, *(keyword.value for keyword in node.keywords)):
                for literal in _literals(part):
                    self._judge(literal, is_shown=True)
        self.generic_visit(node)

    def _mark(self, node: ast.Call) -> None:
        first = node.args[0] if node.args else None
        text = _string(first)
        if isinstance(first, ast.Constant) and text is not None:
            self._add(self.marked, text, node)
            self._done.add(id(first))
        elif any(True for _ in _literals(first)) or (isinstance(first, ast.Call) and _name(first.func) == "format"):
            self._add(self.wrong, ast.dump(first), node)
            self._skip(first)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        self._judge(node)
        for part in node.values:
            self._done.add(id(part))
            if isinstance(part, ast.FormattedValue):
                for literal in _literals(part.value):
                    self._judge(literal, is_shown=True)
                self.visit(part.value)

    def visit_Constant(self, node: ast.Constant) -> None:
        self._judge(node)

    def _judge(self, node: ast.AST, is_shown: bool = False) -> None:
        text = _string(node)
        if text is None or id(node) in self._done:
            return
        self._done.add(id(node))
        plain = text.replace("{}", "")
        if _MARKUP.search(text) or not _WORD.search(plain):
            return
        has_words = isinstance(node, ast.JoinedStr) or _SENTENCE.search(text)
        if is_shown or (has_words and not _NAME.search(plain)):
            self._add(self.forgotten, text, node)


# -- the values that texts get -------------------------------------------------------------------------


class Call(NamedTuple):
    """A call of `tr`."""

    place: str  # file in the package
    line: int
    texts: FrozenSet[str]  # those that it may show; empty: they come from another place, such as a parameter
    values: FrozenSet[str]  # the names of the values that it gives


def fields(text: str) -> FrozenSet[str]:
    """Return the names of the places in a text, without their formats."""
    return frozenset(name for _, name, _, _ in string.Formatter().parse(text) if name is not None)


@functools.lru_cache(maxsize=None)
def calls() -> List[Call]:
    """Return all calls of `tr` in the package. Constants are followed to the texts in them."""
    trees = {path.relative_to(PACKAGE).as_posix(): ast.parse(path.read_text(encoding="utf-8"))
             for path in sorted(PACKAGE.rglob("*.py"))}
    constants = {place: _constants(tree) for place, tree in trees.items()}
    found = []
    for place, tree in trees.items():
        known = dict(constants[place])
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom):
                module = (node.module or "").replace("roah_rsbb.", "").replace(".", "/")
                for alias in node.names:
                    name = alias.asname or alias.name
                    known.update({name: constants[f"{module}.py"].get(alias.name, frozenset())}
                                 if f"{module}.py" in constants else {})
                    for inner, texts in constants.get(f"{module}/{alias.name}.py", {}).items():
                        known[f"{name}.{inner}"] = texts
        found += [
            Call(place, node.lineno, _texts_of(node.args[0], known), frozenset(k.arg or "**" for k in node.keywords))
            for node in ast.walk(tree)
            if isinstance(node, ast.Call) and _name(node.func) == "tr" and node.args
        ]
        found += [
            Call(place, node.lineno, frozenset([text]), fields(text))  # a page fills the places
            for node in ast.walk(tree) if isinstance(node, ast.Call) and _name(node.func) == WORDS
            for word in node.keywords for text in _texts_of(word.value, known)
        ]
    return found


def _constants(tree: ast.Module) -> Dict[str, FrozenSet[str]]:
    """Return the marked texts in each constant of a module or class."""
    found: Dict[str, FrozenSet[str]] = {}
    for node in ast.walk(tree):
        if not isinstance(node, (ast.Assign, ast.AnnAssign)) or node.value is None:
            continue
        inner = [one for one in ast.walk(node.value) if isinstance(one, ast.Call)]
        later = [call.args[0] for call in inner if _name(call.func) in ("tr_later", SAY) and call.args]
        for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
            if isinstance(target, ast.Name) and later:
                texts = frozenset(one.value for one in later if isinstance(one, ast.Constant))
                found[target.id] = found.get(target.id, frozenset()) | texts
    return found


def _texts_of(node: ast.AST, known: Dict[str, FrozenSet[str]]) -> FrozenSet[str]:
    if isinstance(node, ast.Constant):
        return frozenset([node.value])
    if isinstance(node, (ast.IfExp, ast.BoolOp)):
        parts = (node.body, node.orelse) if isinstance(node, ast.IfExp) else node.values
        return frozenset().union(*(_texts_of(part, known) for part in parts))
    if isinstance(node, ast.Subscript):
        return _texts_of(node.value, known)
    if isinstance(node, ast.Call) and _name(node.func) == "get" and isinstance(node.func, ast.Attribute):
        return _texts_of(node.func.value, known)
    if isinstance(node, ast.Name):
        return known.get(node.id, frozenset())
    if isinstance(node, ast.Attribute):
        base = getattr(node.value, "id", "")
        return known.get(node.attr if base == "self" else f"{base}.{node.attr}", frozenset())
    return frozenset()
