"""Which file of the project imports which, read from their sources.

    python -m studies.import_graph src/cutis/optics/tissue.py    # what a change of it can reach

A name taken from a package counts as taken from the module that defines it, so that a change of one
module of a room does not reach all that use another. Imports inside functions count like others,
as do names of modules in strings, since tests run code in other processes; imports for types alone
do not. Data files count as imported by the modules that name their folder or file.
"""

import ast
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDERS = {"cutis": "src/cutis", "studies": "studies", "benchmarks": "benchmarks", "tests": "tests"}
"""Top-level names and where they lie."""
NAMED = re.compile(rf"\b(?:{'|'.join(FOLDERS)})(?:\.\w+)+")
"""The dotted name of a module inside a string."""


@dataclass(frozen=True)
class Module:
    """A Python file: its dotted `name`, its place and its syntax."""

    name: str
    path: Path
    tree: ast.Module

    @property
    def package(self) -> str:
        """What relative imports are relative to."""
        return self.name if self.path.name == "__init__.py" else self.name.rpartition(".")[0]

    def wanted(self) -> Iterator[tuple[str, str | None]]:
        """(module, name taken from it) of each import; None where it is taken whole."""
        for node in _run(self.tree):
            if isinstance(node, ast.Import):
                yield from ((alias.name, None) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                base = node.module or ""
                if node.level:
                    parts = self.package.split(".")
                    base = ".".join([*parts[: len(parts) - node.level + 1], *base.split(".")])
                yield from ((base.strip("."), alias.name) for alias in node.names)
                if self.name.startswith("tests."):  # whose folders are on the path
                    yield from ((f"{self.package}.{base}", alias.name) for alias in node.names)


class Graph:
    """The Python files of the project below `root`, and their imports."""

    def __init__(self, root: Path = ROOT) -> None:
        self.root = root
        self.modules = dict(_modules(root))

    @cached_property
    def imports(self) -> dict[str, set[str]]:
        """The modules that each module imports, by name; names in strings do not count."""
        return {
            name: {found for want in module.wanted() if (found := self._definer(*want))} - {name}
            for name, module in self.modules.items()
        }

    @cached_property
    def users(self) -> dict[str, set[str]]:
        """The modules that each module is imported by or named in."""
        found: dict[str, set[str]] = {name: set() for name in self.modules}
        for name, imported in self.imports.items():
            for target in imported | self._told(self.modules[name].tree):
                found[target].add(name)
        conftest = self.modules.get("tests.conftest")
        if conftest is not None:  # its parts reach the tests that ask for them by name
            fixtures = {node.name: node for node in conftest.tree.body
                        if isinstance(node, ast.FunctionDef)}  # fmt: skip
            for names in found.values():
                names.discard("tests.conftest")
            for name, module in self.modules.items():
                if name.startswith("tests.") and name != "tests.conftest":
                    for target in self._fixed(_arguments(module.tree), fixtures):
                        found[target].add(name)
        return found

    def reached(self, changed: Iterable[Path]) -> dict[Path, int]:
        """Files that a change of files can reach, and by how many imports at least."""
        names = {module.path: name for name, module in self.modules.items()}
        front: set[str] = set()
        for path in changed:
            absolute = self.root / path
            front |= {names[absolute]} if absolute in names else self._readers(Path(path))
        steps = dict.fromkeys(front, 0)
        distance = 0
        while front:
            distance += 1
            front = {user for name in front for user in self.users[name]} - steps.keys()
            steps |= dict.fromkeys(front, distance)
        return {self.modules[name].path.relative_to(self.root): n for name, n in steps.items()}

    def _definer(self, module: str, name: str | None) -> str | None:
        """The module of the project that a name comes from, through packages that pass it on."""
        if name is not None and f"{module}.{name}" in self.modules:
            return f"{module}.{name}"
        if module not in self.modules:
            return None
        if name is None or self.modules[module].path.name != "__init__.py":
            return module
        for base, taken in self.modules[module].wanted():
            if taken == name and (found := self._definer(base, taken)):
                return found
        return module

    def _told(self, tree: ast.AST) -> set[str]:
        """Modules whose names stand in strings."""
        texts = (n.value for n in ast.walk(tree) if isinstance(n, ast.Constant))
        said = {dotted for text in texts if isinstance(text, str) for dotted in NAMED.findall(text)}
        found = set()
        for dotted in said:
            base, _, name = dotted.rpartition(".")
            found |= {self._definer(dotted, None), self._definer(base, name)} - {None}
        return {name for name in found if name}

    def _fixed(self, asked: set[str], fixtures: Mapping[str, ast.FunctionDef]) -> set[str]:
        """Modules that fixtures of these names import, and those that they ask for."""
        found: set[str] = set()
        seen: set[str] = set()
        while asked - seen:
            name = (asked - seen).pop()
            seen.add(name)
            node = fixtures.get(name) or fixtures.get(f"_{name}")
            if node is None:
                continue
            conftest = self.modules["tests.conftest"]
            part = Module(conftest.name, conftest.path, ast.Module([node], []))
            found |= {m for want in part.wanted() if (m := self._definer(*want))}
            found |= self._told(node)
            if any(isinstance(n, ast.Name) and n.id == "MAIN" for n in ast.walk(node)):
                found |= {"cutis.apps.main"} & self.modules.keys()
            asked = asked | _arguments(node)
        return found

    def _readers(self, path: Path) -> set[str]:
        """Modules that name a file that is no module, or its folder inside data/."""
        inside = "data" in path.parts
        folders = set(path.parts[path.parts.index("data") + 1 : -1] if inside else ())
        found = set()
        for name, module in self.modules.items():
            texts = (n.value for n in ast.walk(module.tree) if isinstance(n, ast.Constant))
            if any(isinstance(t, str) and (path.name in t or t in folders) for t in texts):
                found.add(name)
        return found


def circle(imports: Mapping[str, set[str]]) -> list[str]:
    """Modules that import each other round about, the first again at the end; none: empty."""
    try:
        TopologicalSorter(imports).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def _modules(root: Path) -> Iterator[tuple[str, Module]]:
    for top, folder in FOLDERS.items():
        for path in sorted((root / folder).rglob("*.py")):
            parts = [top, *path.relative_to(root / folder).with_suffix("").parts]
            name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
            yield name, Module(name, path, ast.parse(path.read_text("utf-8"), str(path)))


def _run(tree: ast.AST) -> Iterator[ast.AST]:
    """Every node but those below `if TYPE_CHECKING`."""
    yield tree
    for node in ast.iter_child_nodes(tree):
        if not (isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"):
            yield from _run(node)


def _arguments(tree: ast.AST) -> set[str]:
    """Names of arguments of functions, which is how tests ask for fixtures."""
    return {
        argument.arg
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef)
        for argument in (*node.args.args, *node.args.kwonlyargs)
    }


if __name__ == "__main__":
    for path, steps in sorted(Graph().reached(map(Path, sys.argv[1:])).items()):
        print(steps, path)
