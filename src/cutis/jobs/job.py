"""A job: one piece of work as a value, that any front end makes, runs and may stop.

A job is a frozen dataclass. Its fields are parsed: paths, models, lights, colour spaces, gains; no
text that somebody has still to understand. `run(progress)` does the work and gives its result;
`digest()` stands for all that the result depends on, contents of files included. `progress` is told
how far the work is, and stops it by raising: what was already written is whole, and nothing else is
left.
"""

import dataclasses
import hashlib
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Protocol, TypeVar

from cutis.colour import Light
from cutis.colour.spaces import Space
from cutis.inverse import Model
from cutis.inverse.model import content_digest
from cutis.looks import Look
from cutis.maps.estimating import Progress, nobody
from cutis.maps.source import digest as file_digest

Result_co = TypeVar("Result_co", covariant=True)


class Job(Protocol[Result_co]):
    """Work as a value; see above."""

    def run(self, progress: Progress = nobody) -> Result_co:
        """Does the work."""

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""


class Cancelled(Exception):
    """The work was stopped by whoever asked for it."""


class Cancel:
    """A switch: called with a progress it gives one that raises `Cancelled` once it was thrown.

    It may be thrown from another thread.
    """

    def __init__(self) -> None:
        self._thrown = threading.Event()

    def cancel(self) -> None:
        """Stops the work at its next step."""
        self._thrown.set()

    def __call__(self, progress: Progress = nobody) -> Progress:
        """A progress that passes on what it is told until the switch is thrown."""

        def watched(done: int, total: int, doing: str) -> None:
            if self._thrown.is_set():
                raise Cancelled
            progress(done, total, doing)

        return watched


@dataclasses.dataclass(frozen=True)
class Told:
    """A field of a job for a digest: what was asked for, as text, and the content behind it."""

    asked: str
    content: str = ""


def told(job: Any) -> dict[str, Told]:
    """Every field that the result of a job depends on, by name.

    Fields whose metadata say `result=False` are left out: where results go, how many processes.
    """
    return {
        field.name: tell(getattr(job, field.name))
        for field in dataclasses.fields(job)
        if field.metadata.get("result", True)
    }


def tell(value: Any) -> Told:
    """One value: files, models, lights and configurations by name and content, others as text."""
    if isinstance(value, Path):
        return Told(value.name, file_digest(value) if value.is_file() else "")
    if isinstance(value, Model):
        return Told(value.name, value.digest)
    if isinstance(value, Look):
        return Told(value.name or "a look", value.digest)
    if isinstance(value, Light):
        return Told(value.name, value.digest)
    if isinstance(value, Mapping):
        parts = {str(key): tell(found) for key, found in value.items()}
        return _together(parts)
    if isinstance(value, list | tuple):
        return _together({str(number): tell(found) for number, found in enumerate(value)})
    if dataclasses.is_dataclass(value) and not hasattr(value, "to_linear_srgb"):
        return _together(told(value))
    if hasattr(value, "to_linear_srgb"):
        return _of_space(value)
    return Told("none" if value is None else str(value))


def digest_of(job: Any) -> str:
    """SHA-256 of `told`, the class of the job and the version of its code."""
    parts = {name: [one.asked, one.content] for name, one in told(job).items()}
    return content_digest(type(job).__name__, parts, code_digest())


def part(progress: Progress, number: int, count: int) -> Progress:
    """The progress of the `number`-th of `count` pieces of work, as one of the whole."""

    def of_all(done: int, total: int, doing: str) -> None:
        share = number + done / max(total, 1)
        progress(int(1000 * share), 1000 * count, doing)

    return of_all


_CODE: list[str] = []


def code_digest() -> str:
    """SHA-256 of the package's code: results of another version of it are not these."""
    if not _CODE:
        total = hashlib.sha256()
        for path in _sources():
            total.update(path.read_bytes())
        _CODE.append(total.hexdigest())
    return _CODE[0]


def _sources() -> Iterator[Path]:
    """The modules that results depend on: not those that print them."""
    package = Path(__file__).parents[1]
    for path in sorted(package.rglob("*.py")):
        if path.relative_to(package).parts[0] not in ("apps", "studio", "data"):
            yield path


def _of_space(space: Space) -> Told:
    config = getattr(space, "config", None)
    content = ""
    if config and "://" not in config and Path(config).is_file():
        content = file_digest(Path(config))
    return Told(space.name if not config else f"{space.name} of {config}", content)


def _together(parts: Mapping[str, Told]) -> Told:
    asked = ", ".join(f"{name} {one.asked}" for name, one in parts.items())
    content = content_digest([[name, one.content] for name, one in parts.items()])
    return Told(asked, content if any(one.content for one in parts.values()) else "")
