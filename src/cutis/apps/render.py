"""`cutis render`: maps or albedo in, path-traced pictures out."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


def render(
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
    melanin: options.MelaninChange = None,
    blood: options.BloodChange = None,
    thickness: options.ThicknessChange = None,
    eumelanin: options.EumelaninChange = None,
    oxygenation: options.OxygenationChange = None,
    preset: options.Presets = None,
    amount: options.Amount = 1.0,
    mask: options.Mask = None,
    source: Annotated[
        Path | None, typer.Option(help="The capture, if it is not where the maps say.")
    ] = None,
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
            help="An edit from frame to frame: melanin 0.5..3 (factors), blood +0..0.05, "
            "oxygenation =0.1..0.9.",
        ),
    ] = None,
    frames: Annotated[int, typer.Option(help="Pictures of an edit sweep.")] = 12,
    again: Annotated[
        bool, typer.Option("--again", help="Also pictures of a sequence that are there already.")
    ] = False,
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
    from dataclasses import replace

    from cutis.apps.console import out, steps
    from cutis.errors import CutisError
    from cutis.jobs.render import RADII, Order, check_fit, export_to, render_pictures
    from cutis.render.blender import find_blender
    from cutis.render.blender_install import install as install_blender
    from cutis.render.frames import Frame
    from cutis.render.frames import edit_sweep as sweep_of
    from cutis.render.frames import turntable as turntable_of
    from cutis.render.heads import credits_of, heads
    from cutis.render.scene import MESHES, Scene
    from cutis.textures import TextureFile, format_of

    if install:
        with steps(1, quiet) as progress:
            python = install_blender(say=lambda text: progress.at(0, 1, text))
        if not quiet:
            out.print(f"Blender is installed: {python}")
        return
    head = {each.name: each for each in heads()}.get(mesh)
    if skin is None:
        if head is None:
            raise CutisError(
                "give maps (NAME.skin.exr) or an albedo texture to render, or a bundled head: "
                "--mesh makehuman"
            )
        skin = head.albedo
    if output is None:
        output = Path(f"{skin.name.removesuffix('.skin.exr').partition('.')[0]}.render.png")
    format_of(output)
    if radius not in RADII:
        raise CutisError(f"--radius must be {' or '.join(RADII)}, not {radius!r}")
    if turntable is not None and edit_sweep is not None:
        raise CutisError("--turntable and --edit-sweep are two sequences; render one at a time")
    sequence: tuple[Frame, ...] = ()
    if turntable is not None:
        sequence = tuple(turntable_of(turntable))
    elif edit_sweep is not None:
        sequence = tuple(sweep_of(*edit_sweep, frames))
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
    flags = {
        "melanin": melanin,
        "blood": blood,
        "thickness": thickness,
        "eumelanin": eumelanin,
        "oxygenation": oxygenation,
    }
    order = Order(
        skin, output, scene,
        edits=tuple(options.edits(preset, flags)),
        amount=amount, paint=mask, source=source, model_only=model_only, colorspace=colorspace,
        ocio=ocio, radius=radius, frames=sequence, again=again,
    )  # fmt: skip
    with order.opened() as opened:
        order = replace(order, credits=credits_of(scene.mesh, *opened.origins()))
    if head is not None:
        with TextureFile(head.albedo) as texture:
            check_fit(order, texture.shape[1] / texture.shape[0], head.name)
    if export is not None:
        with steps(1, quiet) as progress:
            files = export_to(order, export, blender, progress.at)
        if not quiet:
            for line in order.credits:
                out.print(f"credit: {line}")
            out.print(f"wrote {', '.join(file.name for file in files)} into {export}")
        return
    found = find_blender(blender)
    with steps(1, quiet) as progress:
        result = render_pictures(order, found, progress.at)
    if quiet:
        return
    for line in order.credits:
        out.print(f"credit: {line}")
    if result.there:
        out.print(f"{len(result.there)} pictures were there already")
    if result.animation is not None:
        out.print(f"wrote {len(result.written)} pictures and {result.animation}")
    else:
        out.print(f"wrote {result.written[0]}")
