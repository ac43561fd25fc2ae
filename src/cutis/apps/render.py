"""`cutis render`: maps or albedo in, path-traced pictures out."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cutis.apps import options
from cutis.apps.edit_flags import Changes, edit_flags

if TYPE_CHECKING:
    from cutis.render.frames import Frame


@edit_flags
def render(
    changes: Changes,
    skin: Annotated[
        Path | None,
        typer.Argument(
            help="Maps (NAME.skin.exr) or an albedo texture; a bundled head has one of its own."
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Picture: PNG or JPEG to look at, EXR for light."),
    ] = None,
    mesh: Annotated[
        str,
        typer.Option(
            help="OBJ, glTF or USD with UVs; makehuman or leeperrysmith, the bundled heads; "
            "sphere; patch."
        ),
    ] = "sphere",
    light: Annotated[str, typer.Option(help="studio, sun or interior.")] = "studio",
    amount: options.Amount = 1.0,
    mask: options.Mask = None,
    source: options.Source = None,
    model_only: Annotated[
        bool, typer.Option("--model-only", help="What the model alone gives, without the capture.")
    ] = False,
    colorspace: options.Colorspace = "auto",
    ocio: options.Ocio = None,
    size: Annotated[int, typer.Option(min=16, max=16384, help="Pixels along a side.")] = 512,
    samples: Annotated[int, typer.Option(min=1, help="Paths for each pixel.")] = 64,
    denoise: Annotated[bool, typer.Option(help="Remove noise with OpenImageDenoise.")] = True,
    seed: Annotated[int, typer.Option(min=0, help="Of the noise.")] = 0,
    turn: Annotated[float, typer.Option(help="Degrees that the head is turned.")] = 0.0,
    zoom: Annotated[
        float | None, typer.Option(help="1 shows the whole mesh; bundled heads have their own.")
    ] = None,
    radius: Annotated[
        str,
        typer.Option(
            help="Mean free paths: tissue (one for all texels) or maps (from the chromophores)."
        ),
    ] = "tissue",
    anisotropy: Annotated[
        float, typer.Option(help="g of the walk, 0 to 0.9; lengths follow by similarity.")
    ] = 0.0,
    orientation: options.Turning = options.Turn.AUTO,
    normal: Annotated[Path | None, typer.Option(help="Tangent-space normal map.")] = None,
    roughness: Annotated[
        Path | None, typer.Option(help="Grey roughness map; 0.5 is the default skin's.")
    ] = None,
    unit: Annotated[
        float | None, typer.Option(help="Millimetres per unit of the mesh; guessed without it.")
    ] = None,
    turntable: Annotated[
        int | None, typer.Option(help="Views around the head: NAME.0001.png, … and NAME.webp.")
    ] = None,
    edit_sweep: Annotated[
        tuple[str, str] | None,
        typer.Option(
            metavar="PARAMETER RANGE",
            help="An edit from frame to frame: melanin x0.5..3 (factors), blood +0..0.05, "
            "oxygenation 0.1..0.9 (values).",
        ),
    ] = None,
    frames: Annotated[int, typer.Option(help="Pictures of an edit sweep.")] = 12,
    again: options.Again = False,
    export: Annotated[
        Path | None,
        typer.Option(
            help="Folder for the material instead of a picture: textures, MaterialX and, where "
            "Blender is, a .blend."
        ),
    ] = None,
    blender: Annotated[
        Path | None,
        typer.Option(help="Blender 4.2 or later; else $BLENDER, cutis's own, or the one on PATH."),
    ] = None,
    device: Annotated[str, typer.Option(help="auto, cpu or gpu.")] = "auto",
    install: Annotated[
        bool, typer.Option("--install", help="Install Blender as a module for cutis, and end.")
    ] = False,
    quiet: options.Quiet = False,
) -> None:
    """Render skin with Cycles: subsurface random walks driven by the albedo of maps, edited or not.

    Needs Blender once: `cutis render --install`, or your own by --blender.

    Example: cutis render out/face.skin.exr --mesh head.obj --melanin x1.5 -o tanned.png
    """
    from cutis.apps.console import bar, out
    from cutis.errors import CutisError
    from cutis.jobs.render import MaterialJob, RenderJob
    from cutis.jobs.subject import Subject
    from cutis.render.heads import heads
    from cutis.render.scene import MESHES, Scene

    if install:
        _install(quiet)
        return
    head = {each.name: each for each in heads()}.get(mesh)
    if skin is None and head is None:
        raise CutisError(
            "give maps (NAME.skin.exr) or an albedo texture to render, or a bundled head: "
            "--mesh makehuman"
        )
    shown = skin if skin is not None or head is None else head.albedo
    assert shown is not None
    surface = Path(mesh) if mesh not in MESHES else mesh
    scene = Scene(
        mesh=surface if head is None else head.mesh,
        millimetres_per_unit=unit if head is None or unit is not None else head.millimetres,
        light=light, width=size, height=size, samples=samples, seed=seed, denoise=denoise,
        turn=turn, device=device, anisotropy=anisotropy, normal=normal,
        zoom=(1.0 if head is None else head.zoom) if zoom is None else zoom,
        centre=(0.5, 0.5) if head is None else head.centre,
        roughness=0.5 if roughness is None else roughness,
    )  # fmt: skip
    subject = Subject(
        shown, scene, changes.look(), amount, mask, source, model_only,
        options.source_space(colorspace, ocio), radius, head, orientation.value,
    )  # fmt: skip
    if export is not None:
        with bar(quiet) as progress:
            made = MaterialJob(subject, export, blender).run(progress)
        said = [f"wrote {', '.join(file.name for file in made.files)} into {export}"]
        credits = made.credits
    else:
        name = f"{shown.name.removesuffix('.skin.exr').partition('.')[0]}.render.png"
        sequence = _frames(turntable, edit_sweep, frames)
        job = RenderJob(subject, output or Path(name), sequence, again, blender)
        with bar(quiet) as progress:
            done = job.run(progress)
        credits, said = done.credits, list(done.notes)
        if done.there:
            said.append(f"{len(done.there)} pictures were there already")
        if done.animation is not None:
            said.append(f"wrote {len(done.written)} pictures and {done.animation}")
        else:
            said.append(f"wrote {done.written[0]}")
    for line in () if quiet else (*(f"credit: {one}" for one in credits), *said):
        out.say(line)


def _install(quiet: bool) -> None:
    from cutis.apps.console import bar, out
    from cutis.render.blender_install import install

    with bar(quiet) as progress:
        python = install(say=lambda text: progress(0, 1, text))
    if not quiet:
        out.say(f"Blender is installed: {python}")


def _frames(
    turntable: int | None, edit_sweep: tuple[str, str] | None, count: int
) -> "tuple[Frame, ...]":
    """The frames of --turntable or --edit-sweep."""
    from cutis.errors import CutisError
    from cutis.render import frames

    if turntable is not None and edit_sweep is not None:
        raise CutisError("--turntable and --edit-sweep are two sequences; render one at a time")
    if turntable is not None:
        return tuple(frames.turntable(turntable))
    return () if edit_sweep is None else tuple(frames.edit_sweep(*edit_sweep, count))
