"""One figure of the paper, redrawn: its pictures and its numbers, and the words about them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

WORDS = Path(__file__).parent / "words"


@dataclass(frozen=True)
class Section:
    """A section of the page of reproductions.

    Its words are words/`name`.md: a title, what the paper shows in our words, and what comes
    out here, with places for `numbers`. `table` holds more of them, `pictures` the drawings
    (matplotlib figures) with their captions, `credits` who made the textures in them.
    """

    name: str
    numbers: Mapping[str, Any]
    table: str
    pictures: tuple[tuple[Any, str], ...]
    credits: tuple[str, ...] = ()

    def words(self) -> tuple[str, str, str]:
        """Title, what the paper says, what was found."""
        text = (WORDS / f"{self.name}.md").read_text("utf-8")
        title, paper, found = text.strip().split("\n\n")
        return title.removeprefix("# "), paper, found.format(**self.numbers).strip()


def table(header: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)
