"""One figure of the paper, redrawn: its pictures, its numbers, and both sides of the comparison."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Section:
    """A section of the page of reproductions.

    `paper` tells in our words what the paper shows or says, `found` what comes out here, both as
    Markdown; `table` holds the numbers, `pictures` the drawings (matplotlib figures) with their
    captions, `credits` who made the textures in them.
    """

    name: str
    title: str
    paper: str
    found: str
    table: str
    pictures: tuple[tuple[Any, str], ...]
    credits: tuple[str, ...] = ()


def table(header: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)
