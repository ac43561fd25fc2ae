"""Flags that say what is done to a skin, in the order in which they were typed."""

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand

from cutis.apps import options

if TYPE_CHECKING:
    from cutis.looks import Look

ORDER = "cutis.order"


class InOrder(TyperCommand):
    """A command that knows in which order its options were typed."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parses as all commands do, and keeps the names of options and arguments as they came."""
        _, _, order = self.make_parser(ctx).parse_args(args=list(args))
        ctx.meta[ORDER] = [one.name for one in order]
        return super().parse_args(ctx, args)


@dataclass(frozen=True)
class Changes:
    """What was typed: (flag without dashes, its value) in order, and whether looks may go out."""

    typed: tuple[tuple[str, Any], ...] = ()
    allow_outside: bool = False

    def __bool__(self) -> bool:
        """Whether there is anything to do."""
        return bool(self.typed)

    def look(self) -> "Look":
        """All of it as one look."""
        from cutis.looks import Look
        from cutis.looks.presets import preset
        from cutis.looks.tone_like import tone_look
        from cutis.maps import parse_edit

        whole = Look()
        for flag, group in groupby(self.typed, lambda one: one[0] if one[0] in KINDS else ""):
            values = list(group)
            if flag == "preset":
                found = [preset(name) for _, name in values]
            elif flag == "tone":
                found = [tone_look(text) for _, text in values]
            elif flag == "look":
                found = [Look.load(path, allow_outside=self.allow_outside) for _, path in values]
            else:
                found = [Look.of([parse_edit(name, text) for name, text in values])]
            for one in found:
                whole = whole.then(one)
        return whole


KINDS = ("preset", "look", "tone")


def edit_flags(command: Callable[..., None]) -> Callable[..., None]:
    """Gives a command, in place of its argument `changes`, --preset, --look and parameter flags.

    It must be an `InOrder`.
    """
    from cutis.optics.parameters import PARAMETERS, RARE

    known = (*PARAMETERS, *RARE)
    wanted = [
        _repeated("preset", str, "A look that comes with cutis (cutis edit --help)."),
        _repeated("tone", str, "Another tone: ita:-20, monk:7, #8d5524, like:OTHER.skin.exr."),
        _repeated("look", Path, "A look to apply, NAME.look.json; may be repeated."),
        *(_repeated(p.name, str, _help(p)) for p in known),
        inspect.Parameter(
            "allow_outside", inspect.Parameter.KEYWORD_ONLY, default=False,
            annotation=Annotated[bool, typer.Option(
                "--allow-outside", help="Looks may name masks outside their folder."
            )],
        ),
        inspect.Parameter("ctx", inspect.Parameter.KEYWORD_ONLY, annotation=typer.Context),
    ]  # fmt: skip

    def collect(arguments: dict[str, Any]) -> Changes:
        outside, context = arguments.pop("allow_outside"), arguments.pop("ctx")
        given = {
            name: list(arguments.pop(name) or ()) for name in (*KINDS, *(p.name for p in known))
        }
        typed = [(name, given[name].pop(0)) for name in context.meta[ORDER] if given.get(name)]
        return Changes(tuple(typed), outside)

    return options.with_flags(command, "changes", wanted, collect)


def _repeated(name: str, kind: type, text: str) -> inspect.Parameter:
    typed: Any = Annotated[list[kind] | None, typer.Option(f"--{name}", help=text)]  # type: ignore[valid-type]
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=typed)


def _help(known: Any) -> str:
    unit = "" if known.unit == "1" else f" in {known.unit}"
    meaning = f"{known.meaning[:1].upper()}{known.meaning[1:]}{unit}"
    return f"{meaning}: a value, a factor (x1.5) or an offset (+0.1)."
