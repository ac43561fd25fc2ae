"""The command line: `cutis COMMAND --help`."""

import os
import sys
from typing import Annotated

import typer

from cutis.apps import demo, edit, estimate, info, spectrum, train
from cutis.errors import CutisError

app = typer.Typer(
    name="cutis",
    help="Skin albedo textures to maps of what the skin is made of, and back. Not a medical device.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        from cutis import __version__

        typer.echo(f"cutis {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Options before the command."""


app.command("estimate")(estimate.estimate)
app.command("edit")(edit.edit)
app.command("spectrum")(spectrum.spectrum)
app.command("info")(info.info)
app.command("train")(train.train)
app.command("demo")(demo.demo)


def main() -> None:
    """Runs the command line; errors end in one line on stderr and a non-zero code."""
    try:
        app()
    except CutisError as error:
        _fail(str(error))
    except BrokenPipeError:  # the reader of our output has left
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise SystemExit(1) from None
    except KeyboardInterrupt:
        _fail("interrupted; files already written are whole", 130)
    except MemoryError:
        _fail("not enough memory; use a smaller texture or a machine with more")
    except OSError as error:
        _fail(f"{error.filename or 'file system'}: {error.strerror or error}")
    except Exception as error:
        if os.environ.get("CUTIS_DEBUG"):
            raise
        _fail(f"internal error, {type(error).__name__}: {error}; CUTIS_DEBUG=1 shows where", 70)


def _fail(message: str, code: int = 1) -> None:
    print(f"cutis: {' '.join(message.split())}", file=sys.stderr)
    raise SystemExit(code)
