"""`python -m studies.figures`: the paper's figures from our own systems, and their page."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


def figures(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for page and pictures.")],
    only: Annotated[
        list[str] | None, typer.Option(help="Draw this figure alone; may be repeated.")
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            help="Folder of the larger data (albedo/, spectra/); found if beside the clone."
        ),
    ] = None,
    quiet: options.Quiet = False,
) -> None:
    """Redraw the figures of the paper: pictures, tables and a page that shows them.

    Writes reproduction.md and reproduction/*.jpg. Without the larger data only the bundled capture
    is drawn.

    Example: python -m studies.figures -o docs
    """
    from cutis.apps.console import bar, out
    from cutis.errors import CutisError
    from studies.figures import FIGURES, cast, write_page
    from studies.generated import record
    from studies.pages import DOCS

    unknown = [name for name in only or [] if name not in FIGURES]
    if unknown:
        raise CutisError(f"unknown figure {unknown[0]!r}; known are {', '.join(FIGURES)}")
    players = cast(data)
    output.mkdir(parents=True, exist_ok=True)
    chosen = [name for name in FIGURES if only is None or name in only]
    sections = []
    with bar(quiet) as progress:
        for number, name in enumerate(chosen):
            progress(number, len(chosen), name)
            sections.append(FIGURES[name](players))
    page = write_page(sections, output)
    if output.resolve() == DOCS and not only:
        record(page.resolve(), *sorted((DOCS / "reproduction").glob("*.jpg")))
    if not quiet:
        if players.data is None:
            out.print("the larger data is not at hand: drawn with the bundled capture alone")
        out.print(f"wrote {page} and {output / 'reproduction'}")


if __name__ == "__main__":
    import sys

    from cutis.errors import CutisError

    try:
        typer.run(figures)
    except CutisError as error:
        sys.exit(f"studies.figures: {error}")
