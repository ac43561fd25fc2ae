"""`cutis studio`: a live face in the browser."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cutis.apps import options
from cutis.errors import CutisError

if TYPE_CHECKING:
    from cutis.studio.opening import Opening


def studio(
    faces: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[FACE]...",
            help="Captures, maps (NAME.skin.exr) or a folder; without any, the bundled capture.",
        ),
    ] = None,
    mask: options.Mask = None,
    white: options.White = "none",
    exposure: options.Exposure = "none",
    model: options.ModelName = "default",
    colorspace: options.Colorspace = "auto",
    ocio: options.Ocio = None,
    look: Annotated[
        Path | None, typer.Option("--look", help="Begin with this look, NAME.look.json.")
    ] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="0 takes one that is free.")] = 0,
    host: Annotated[
        str, typer.Option(help="Another address than this machine's own; others can then connect.")
    ] = "127.0.0.1",
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Print the address, open no browser.")
    ] = False,
) -> None:
    """Edit a face in the browser: sliders, layers, before and after, a lit head.

    Nothing leaves this machine. What is saved is what `cutis edit --look` gives, bit for bit. Maps
    and history are kept in FACE.studio beside the face.

    Example: cutis studio face.png
    """
    from cutis.apps.console import err

    needed()
    from cutis.looks import Look
    from cutis.studio.files import Files
    from cutis.studio.opening import Opening
    from cutis.studio.server import LOOPBACK, serve

    like = Opening(
        Path(), mask, options.white_gains(white), options.exposure_gain(exposure),
        options.model_of(model), options.source_space(colorspace, ocio),
        look=None if look is None else Look.load(look),
    )  # fmt: skip
    named, folder = openings(faces or [], like)
    if host not in (LOOPBACK, "localhost", "::1"):
        err.say(
            f"warning: {host} can be reached by other machines, and what is sent is not encrypted; "
            "whoever has the address with its token sees the face"
        )
    files = Files(named, folder, like)
    serve(files, host, port, lambda address: _started(address, not no_browser))


def needed() -> None:
    """CutisError with what to install where the packages of the studio are missing."""
    from importlib.util import find_spec

    if any(find_spec(name) is None for name in ("starlette", "uvicorn", "websockets")):
        raise CutisError("the studio needs more packages: pip install 'cutis[studio]'")


def openings(faces: list[Path], like: "Opening") -> "tuple[list[Opening], Path]":
    """What was named, and the folder whose pictures may be opened too."""
    from dataclasses import replace

    named: list[Opening] = []
    folder = Path.cwd()
    for path in faces:
        if path.is_dir():
            folder = path
        elif not path.is_file():
            raise CutisError(f"{path}: no such file; check the name")
        else:
            named.append(replace(like, path=path))
    if not faces:
        named.append(bundled(like))
    return named, folder


def bundled(like: "Opening") -> "Opening":
    """The capture that comes with a clone; of a package, the albedo of a head."""
    from dataclasses import replace

    from cutis.apps.demo import CAPTURE, MASK
    from cutis.render.heads import heads

    examples = Path(__file__).parents[3] / "examples"
    if (examples / CAPTURE).is_file():
        return replace(
            like, path=examples / CAPTURE, mask=examples / MASK, white="auto", bundled=True
        )
    return replace(like, path=heads()[0].albedo, bundled=True)


def _started(address: str, browse: bool) -> None:
    import webbrowser

    print(address, flush=True)
    if browse:
        try:
            opened = webbrowser.open(address)
        except webbrowser.Error:
            opened = False
        if not opened:
            from cutis.apps.console import err

            err.say("no browser was found; open the address above in one")
