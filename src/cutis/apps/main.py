"""The command line: `cutis COMMAND --help`."""

import os
import signal
import sys
import threading
from typing import Annotated, Any, NoReturn

import typer

from cutis.apps import (
    bench,
    check,
    demo,
    edit,
    estimate,
    export,
    fit,
    info,
    render,
    simulate,
    spectrum,
    studio,
    train,
)
from cutis.apps.edit_flags import InOrder
from cutis.errors import CutisError, printable

app = typer.Typer(
    name="cutis",
    help="Skin albedo textures to maps of what the skin is made of, and back. "
    "Not a medical device.\n\nExample: cutis estimate face.png --white auto -o out/",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)

INTERRUPTED = 130
"""Exit code after Ctrl-C, by the custom of shells."""


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"cutis {version('cutis')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Options before the command."""


app.command("estimate")(estimate.estimate)
app.command("check")(check.check)
app.command("edit", cls=InOrder)(edit.edit)
app.command("render", cls=InOrder)(render.render)
app.command("export", cls=InOrder)(export.export)
app.command("studio")(studio.studio)
app.command("spectrum")(spectrum.spectrum)
app.command("fit")(fit.fit)
app.command("simulate")(simulate.simulate)
app.command("info")(info.info)
app.command("train")(train.train)
app.command("bench")(bench.bench)
app.command("demo")(demo.demo)


def main() -> None:
    """Runs the command line; errors end in one line on stderr and a non-zero code."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # Δ and × do not fit every terminal
            stream.reconfigure(errors="replace")
    code: int | None = 0
    before: dict[int, Any] = {}
    try:
        if sys.stdout is None:
            raise CutisError("standard output is closed, so that nothing can be said; open it")
        before = _end_like_interrupts()
        arguments = None if sys.argv[1:] else ["--help"]
        code = app(arguments, prog_name="cutis", standalone_mode=False)
        sys.stdout.flush()
    except CutisError as error:
        _fail(str(error), error.code)
    except _Ended as error:
        _fail(f"ended by {error}; files already written are whole", 128 + error.number)
    except KeyboardInterrupt:
        code = INTERRUPTED
    except MemoryError:
        _fail("not enough memory; use a smaller texture or a machine with more")
    except BrokenPipeError:  # whoever read the output has gone
        sys.stderr.close()
        raise SystemExit(1) from None
    except OSError as error:
        _fail(f"{error.filename or 'file system'}: {error.strerror or error}")
    except Exception as error:
        # Typer brings its own copy of Click; its usage errors are known by what they can do.
        if hasattr(error, "format_message"):
            command = getattr(getattr(error, "ctx", None), "command_path", "cutis")
            _fail(f"{error.format_message().rstrip('.')}; see {command} --help", 2)
        if os.environ.get("CUTIS_DEBUG"):
            raise
        _fail(f"internal error, {type(error).__name__}: {error}; CUTIS_DEBUG=1 shows where", 70)
    finally:
        for number, how in before.items():
            signal.signal(number, how)
    if code == INTERRUPTED:
        _fail("interrupted; files already written are whole", INTERRUPTED)
    raise SystemExit(code)


class _Ended(BaseException):
    """A signal that asked the process to end, which it does as for Ctrl-C."""

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.number = number


def _end_like_interrupts() -> dict[int, Any]:
    """What a system or a closed terminal sends ends the work as Ctrl-C does: cleaned up.

    Returns what was done on these signals before.
    """
    before: dict[int, Any] = {}

    def end(number: int, _: object) -> NoReturn:
        signal.signal(number, signal.SIG_IGN)  # asked once is enough
        raise _Ended(number)

    if threading.current_thread() is threading.main_thread():
        for name in ("SIGTERM", "SIGHUP"):
            if hasattr(signal, name) and signal.getsignal(getattr(signal, name)) is signal.SIG_DFL:
                number = getattr(signal, name)
                before[number] = signal.signal(number, end)
    return before


def _fail(message: str, code: int = 1) -> NoReturn:
    print(f"cutis: {printable(message)}", file=sys.stderr)
    raise SystemExit(code)
