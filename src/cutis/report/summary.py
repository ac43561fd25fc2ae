"""What `cutis estimate` prints of a report, besides its table of maps."""

from collections.abc import Iterator

from cutis.report.findings import FEW_SKIN, next_steps
from cutis.report.numbers import Report
from cutis.report.trust_words import lines
from cutis.report.words import percent


def rows(report: Report) -> Iterator[tuple[str, str, float, float, float]]:
    """The table of maps: name, unit, 5th percentile, median, 95th percentile."""
    return ((name, row.unit, row.p5, row.median, row.p95) for name, row in report.maps.items())


def before(report: Report) -> Iterator[str]:
    """Lines above the table: what was read, and how it was calibrated."""
    known = report.calibration
    yield f"colour space: {report.colorspace}"
    yield from report.notes
    for doubt in report.doubts:
        yield f"doubtful input ({doubt.kind}): {doubt.sentence} {doubt.hint}".rstrip()
    light = f", captured under {known.illuminant}" if known.illuminant != "D65" else ""
    gains = ", ".join(f"{gain:.3f}" for gain in known.gains)
    yield f"gains {gains} ({known.origin}), model {report.model}{light}"


def after(
    report: Report, face: str, maps: str, mask: str | None = None, output: str | None = None
) -> Iterator[str]:
    """Lines below the table: the colour, what the maps are worth, and what to do next.

    `face`, `maps` and `mask` are the files of the capture, `output` its folder, where known.
    """
    for count, what in ((report.below_0, "negative"), (report.above_1, "above one")):
        if count:
            yield f"{count:,} texels have a colour {what}, which is no albedo"
    colour = report.colour
    if colour is None:
        yield "no texel inside the mask has the colour of skin; check mask and colour space"
    else:
        yield (
            f"model against capture on {report.skin_texels:,} skin texels (L* > 35, C*ab > 12; "
            f"{100 * report.skin_share:.1f} % of the mask): ΔE00 mean "
            f"{colour.delta_e_mean:.3f}, 95 % {colour.delta_e_p95:.3f}, "
            f"out of gamut {100 * colour.out_of_gamut:.1f} %, ITA {colour.ita_median:.0f}°"
        )
        told = list(lines(report.maps, report.low_confidence, bool(report.doubts)))
        yield from told
        if not told and not report.doubts:
            yield (
                "On skin colours RGB fixes melanin and blood well, thickness less, and says little "
                "of eumelanin and oxygenation."
            )
        if report.skin_share < FEW_SKIN:
            yield "That is a small part of the mask: darker texels are not in these numbers."
    what, command = next(next_steps(report, face, maps, mask, output))
    yield f"Next: {what}"
    if command:
        yield f"    {command}"


def line(report: Report) -> str:
    """One capture of many, in a line."""
    colour = report.colour
    if colour is None:
        return "no skin colours"
    said = f"ΔE00 {colour.delta_e_mean:.3f}, out of gamut {percent(colour.out_of_gamut)}"
    kinds = ", ".join(doubt.kind for doubt in report.doubts)
    return f"{said}; doubtful input: {kinds}" if kinds else said
