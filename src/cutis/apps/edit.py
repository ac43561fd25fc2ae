"""`cutis edit`: maps in, edited albedo out, in the format and depth of the capture."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


def _flag(meaning: str) -> typer.models.OptionInfo:
    return typer.Option(help=f"{meaning}: a value, a factor (x1.5) or an offset (+0.1).")


Change = str | None


def edit(
    maps: Annotated[Path, typer.Argument(help="Maps that estimate wrote, NAME.skin.exr.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Edited albedo to write.")],
    melanin: Annotated[Change, _flag("Melanosome volume fraction")] = None,
    blood: Annotated[Change, _flag("Blood volume fraction")] = None,
    thickness: Annotated[Change, _flag("Epidermal thickness in µm")] = None,
    eumelanin: Annotated[Change, _flag("Eumelanin share of melanin")] = None,
    oxygenation: Annotated[Change, _flag("Oxygenated share of haemoglobin")] = None,
    preset: Annotated[
        list[str] | None, typer.Option(help="A named edit, before the others; may be repeated.")
    ] = None,
    amount: Annotated[float, typer.Option(help="Share of the edit to apply, 0 to 1.")] = 1.0,
    mask: options.Mask = None,
    source: Annotated[
        Path | None, typer.Option(help="The capture, if it is not where the maps say.")
    ] = None,
    method: options.Method = None,
    save_maps: Annotated[
        Path | None, typer.Option(help="Also write the edited maps to this EXR.")
    ] = None,
    quiet: options.Quiet = False,
) -> None:
    """Edit skin maps and write the albedo with the edit in it.

    Texels that the edit does not change come back bit for bit; --mask paints where it applies.

    Example: cutis edit out/face.skin.exr --melanin x1.4 --blood x0.5 -o tanned.png
    """
    from dataclasses import replace

    import numpy as np

    from cutis.apps.console import out, steps
    from cutis.errors import CutisError
    from cutis.maps import find_source, load_maps, parse_edit, source_note
    from cutis.maps.presets import preset as named
    from cutis.textures import format_of, read_mask, read_texture, write_texture

    flags = {
        "melanin": melanin,
        "blood": blood,
        "thickness": thickness,
        "eumelanin": eumelanin,
        "oxygenation": oxygenation,
    }
    by_tensor = None if method is None else options.method_name(method)
    edits = [change for name in preset or [] for change in named(name)]
    edits += [parse_edit(name, text) for name, text in flags.items() if text is not None]
    format_of(output)  # fails now rather than after the work
    with steps(4, quiet) as progress:
        progress.step("reading")
        skin = load_maps(maps)
        if by_tensor is not None:
            skin = replace(skin, model=by_tensor)
        path = find_source(skin, maps, source)
        encoding = skin.provenance.get("source_encoding", "auto")
        for written in (output, save_maps):
            if written is not None and _same(written, path):
                raise CutisError(f"{written} is the capture itself; give another name")
        if _same(output, maps) or (save_maps is not None and _same(output, save_maps)):
            raise CutisError(f"{output} is a file of maps; give another name for the albedo")
        texture = read_texture(path, options.encoding_name(encoding))
        where = None if mask is None else read_mask(mask, skin.shape)
        progress.step("editing")
        edited = skin.apply(edits, where, amount=amount)
        progress.step("decoding")
        result = edited.retouch(texture)
        progress.step("writing")
        write_texture(result, output)
        if save_maps is not None:
            provenance = source_note(path, texture.encoding)
            replace(edited, provenance=provenance).save(save_maps)
    if quiet:
        return
    inside = int(np.count_nonzero(skin.mask))
    done = len(skin.edits)  # by earlier runs
    for text, clamped in zip(edited.edits[done:], edited.clamped[done:], strict=True):
        share = f" ({100 * clamped / inside:.0f} % of the mask)"
        note = f", {clamped:,} texels clamped to range{share}" if clamped else ""
        out.print(f"{text}{note}")
    changed = int(np.count_nonzero((result.pixels != texture.pixels).any(axis=-1)))
    out.print(f"{changed:,} texels changed; wrote {output}")


def _same(one: Path, other: Path) -> bool:
    """Whether two names are of one file, also through links."""
    return one.resolve() == other.resolve() or (
        one.exists() and other.exists() and one.samefile(other)
    )
