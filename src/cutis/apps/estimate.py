"""`cutis estimate`: a capture in, maps, model albedo, previews and report out."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cutis.apps import options

if TYPE_CHECKING:
    from cutis.maps import SkinMaps
    from cutis.textures import Texture


def estimate(
    face: Annotated[Path, typer.Argument(help="Albedo texture: PNG, JPEG, TIFF or EXR.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the results.")] = Path(
        "."
    ),
    mask: options.Mask = None,
    white: options.White = "none",
    exposure: options.Exposure = "none",
    illuminant: options.Illuminant = "D65",
    model: options.ModelName = "default",
    method: options.Method = None,
    encoding: options.Encoding = "auto",
    half: Annotated[bool, typer.Option(help="Store the maps as half instead of float.")] = False,
    quiet: options.Quiet = False,
) -> None:
    """Estimate skin maps of an albedo texture.

    Writes NAME.skin.exr (the maps), NAME.model.exr (what the model alone gives), NAME.report.json
    and previews NAME.<map>.png.

    Example: cutis estimate face.png --mask mask.png --white auto -o out/
    """
    from cutis.apps.console import out, steps
    from cutis.errors import CutisError

    if method is not None:
        if model != "default":
            raise CutisError("give either --model or --method, not both")
        model = options.method_name(method)
    with steps(6, quiet) as progress:
        skin, _, results = run(
            face, output, mask, white, exposure, model, encoding, half, progress.step, illuminant
        )
    if not quiet:
        say(results, skin)
        out.print(f"wrote {output / face.stem}.skin.exr and what belongs to it")


def run(
    face: Path,
    output: Path,
    mask: Path | None,
    white: str,
    exposure: str,
    model: str,
    encoding: str,
    half: bool,
    step: Any,
    illuminant: str = "D65",
) -> tuple["SkinMaps", "Texture", dict[str, Any]]:
    """The work of the command; `step(name)` is called as each of six steps begins."""
    import cutis.maps as maps
    from cutis.apps.previews import write_previews
    from cutis.colour import light_conversion
    from cutis.textures import read_mask, read_texture, replacing, write_channels

    light_conversion(illuminant)  # fails now rather than after reading
    white_value, exposure_value = options.white_gains(white), options.exposure_gain(exposure)
    step("reading")
    texture = read_texture(face, options.encoding_name(encoding))
    cover = None if mask is None else read_mask(mask, texture.shape)
    options.make_folder(output)
    stem = output / face.stem

    step("estimating")
    skin = maps.estimate(
        texture, cover, white=white_value, exposure=exposure_value, model=model,
        illuminant=illuminant,
    )  # fmt: skip

    step("writing maps")
    skin.save(f"{stem}.skin.exr", "half" if half else "float")
    step("writing the model's albedo")
    albedo = skin.model_albedo
    colour = {name: albedo[..., i] for i, name in enumerate("RGB")}
    write_channels(f"{stem}.model.exr", colour, "half" if half else "float",
                   {"colorspace": "lin_rec709"})  # fmt: skip
    step("measuring")
    results = maps.report(skin)
    step("drawing previews")
    write_previews(skin, stem)
    with replacing(Path(f"{stem}.report.json")) as path:
        path.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    return skin, texture, results


def say(results: dict[str, Any], skin: "SkinMaps") -> None:
    """Prints what was found."""
    from cutis.apps.console import out, print_statistics

    gains = ", ".join(f"{g:.3f}" for g in results["calibration"]["gains"])
    light = results["calibration"]["illuminant"]
    out.print(
        f"gains {gains} ({results['calibration']['origin']}), model {results['model']}"
        + (f", captured under {light}" if light != "D65" else "")
    )
    print_statistics(
        (name, row["unit"], row["p5"], row["median"], row["p95"])
        for name, row in results["maps"].items()
    )
    for key, what in (("below_0", "negative"), ("above_1", "above one")):
        if results[key]:
            out.print(f"{results[key]:,} texels have a colour {what}, which is no albedo")
    colour = results.get("colour")
    if colour is None:
        out.print("no texel inside the mask has the colour of skin; check mask and encoding")
        return
    share = results["skin_texels"] / results["masked_texels"]
    out.print(
        f"model against capture on {results['skin_texels']:,} skin texels (L* > 35, C*ab > 12; "
        f"{100 * share:.1f} % of the mask): ΔE00 mean "
        f"{colour['delta_e_mean']:.3f}, 95 % {colour['delta_e_p95']:.3f}, "
        f"out of gamut {100 * colour['out_of_gamut']:.1f} %, ITA {colour['ita_median']:.0f}°"
    )
    out.print(
        "On skin colours RGB fixes melanin and blood well, thickness less, and says little of "
        "eumelanin and oxygenation."
    )
    if share < 0.2:
        out.print("That is a small part of the mask: darker texels are not in these numbers.")
    if colour["out_of_gamut"] > 0.05 and skin.calibration.origin != "auto":
        out.print("Many texels are out of gamut: try --white auto, or a tighter --mask.")
