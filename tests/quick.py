"""Tests of what a change can reach, as many as fit into a minute: `pytest -p tests.quick --quick`.

What changed is what differs from the last commit that this branch shares with main, uncommitted and
new files included. Of the tests that it can reach (`studies.import_graph`), those fewest imports
away come first, until their times on the last run fill the budget; a test that never ran counts as
GUESS. What is left out is said last.
"""

import subprocess
from pathlib import Path
from typing import Any

import pytest

from studies.import_graph import ROOT, Graph

GUESS = 0.5
"""Seconds of a test that has not run here."""
EVERYTHING = {"tests/conftest.py", "pyproject.toml", "constraints.txt"}
"""Files that every test depends on."""
ALWAYS = {"tests/test_project.py", "tests/test_rooms.py"}
"""Tests that read all sources."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--quick", type=float, metavar="SECONDS", help="test time, over all workers")
    parser.addoption("--base", default="main", help="what the working tree is compared with")


def changed(base: str) -> list[Path]:
    """Files that differ from where this branch left `base`, below the root."""

    def git(*arguments: str) -> str:
        done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)
        return done.stdout

    fork = git("merge-base", "HEAD", base).strip() or "HEAD"
    names = git("diff", "--name-only", "-z", fork) + git("ls-files", "-zo", "--exclude-standard")
    return [Path(name) for name in names.split("\0") if name]


class Quick:
    """Leaves out what a change cannot reach, and what does not fit."""

    def __init__(self, config: pytest.Config) -> None:
        found = changed(config.getoption("base"))
        self.budget = config.getoption("quick")
        self.took: dict[str, float] = config.cache.get("cutis/seconds", {}) if config.cache else {}
        self.steps = Graph().reached(found) | {Path(name): 0 for name in ALWAYS}
        self.all = any(path.as_posix() in EVERYTHING for path in found)
        self.left: dict[str, int] = {}

    def pytest_ignore_collect(self, collection_path: Path) -> bool | None:
        inside = collection_path.is_relative_to(ROOT / "tests") and collection_path.is_file()
        if inside and not self.all and collection_path.relative_to(ROOT) not in self.steps:
            return True
        return None

    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> None:
        def order(item: pytest.Item) -> tuple[int, float]:
            steps = self.steps.get(item.path.relative_to(ROOT), 99)
            return steps, self.took.get(item.nodeid, GUESS)

        total, kept, left = 0.0, [], []
        for item in sorted(items, key=order):
            total += self.took.get(item.nodeid, GUESS)
            (kept if total <= self.budget else left).append(item)
        for item in left:
            name = item.path.relative_to(ROOT).as_posix()
            self.left[name] = self.left.get(name, 0) + 1
        config.hook.pytest_deselected(items=left)
        chosen = set(kept)
        items[:] = [item for item in items if item in chosen]

    # With workers it is they who choose, all the same, and the run's own process that speaks.
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if hasattr(session.config, "workeroutput"):
            session.config.workeroutput["left"] = self.left

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: Any) -> None:
        self.left = getattr(node, "workeroutput", {}).get("left", {})

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if self.left:
            rooms = {str(Path(name).parent) for name in self.left}
            where = " ".join(sorted(rooms if len(self.left) > 8 else self.left))
            count = sum(self.left.values())
            terminalreporter.write_line(f"{count} tests in reach did not fit; they are in {where}")


class Clock:
    """Keeps how long tests take, for the next quick run."""

    def __init__(self) -> None:
        self.took: dict[str, float] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.took[report.nodeid] = self.took.get(report.nodeid, 0.0) + report.duration

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        cache = getattr(session.config, "cache", None)  # none with -p no:cacheprovider
        if cache is not None and not hasattr(session.config, "workerinput"):
            took = {name: round(seconds, 3) for name, seconds in self.took.items()}
            cache.set("cutis/seconds", cache.get("cutis/seconds", {}) | took)


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Clock(), "cutis-clock")
    if config.getoption("quick") is not None:
        config.pluginmanager.register(Quick(config), "cutis-quick")
