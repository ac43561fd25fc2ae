"""The one error that people see."""

import unicodedata


class CutisError(ValueError):
    """Its message is one line for the user: what is wrong and what to do next.

    Line breaks become spaces and what does not print becomes its code (`\\x1b`), because messages
    quote names and texts from files, which may hold anything. A command ends with `code`.
    """

    code = 1

    def __init__(self, message: str) -> None:
        """`message` as it is to be shown."""
        super().__init__(printable(message))


def printable(text: str) -> str:
    """The text on one line, with codes (`\\x1b`) for what does not print."""
    return "".join(_shown(c) for c in " ".join(text.splitlines()))


def _shown(character: str) -> str:
    """The character itself unless it is one that directs a terminal, or half of a pair."""
    kind = unicodedata.category(character)
    return character.encode("unicode_escape").decode() if kind in ("Cc", "Cf", "Cs") else character
