"""What `cutis estimate` says of its results."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from cutis.apps.console import out, print_statistics
from cutis.report.trust_words import lines

if TYPE_CHECKING:
    from cutis.jobs.estimate import Estimated, EstimateJob


def say(
    sets: "Sequence[EstimateJob]", found: "Sequence[Estimated]", doubts: Sequence[str] = ()
) -> None:
    """Prints what was found: all of one capture, a line for each of many; `doubts` come first."""
    from cutis.jobs.inputs import gaps, odd_ones

    for doubt in doubts:
        out.say(doubt)

    for job in sets:
        captures = tuple(one.face for one in job.captures)
        for name in gaps(captures):
            out.say(f"{name} is missing between other tiles of its row")
        for line in odd_ones(captures, job.colorspace):
            out.say(line)
    alone = len(sets) == 1 and len(sets[0].captures) == 1
    for outcome in found:
        if outcome.changed:
            out.say(f"{outcome.face.name}: made again, {', '.join(outcome.changed)} changed")
    if not alone:
        _say_many(sets, found)
    elif found and found[0].report is not None:
        say_one(found[0].report, sets[0].white == "auto")
        stem = sets[0].stem(sets[0].captures[0])
        if found[0].there:
            out.say(f"{stem}.skin.exr was there already, made the same way; --again makes it anew")
        else:
            out.say(f"wrote {stem}.skin.exr and what belongs to it")


def _say_many(sets: "Sequence[EstimateJob]", found: "Sequence[Estimated]") -> None:
    new = [outcome for outcome in found if outcome.report is not None and not outcome.there]
    for outcome in new:
        assert outcome.report is not None
        colour = outcome.report.get("colour")
        error = "no skin colours" if colour is None else (
            f"ΔE00 {colour['delta_e_mean']:.3f}, out of gamut {100 * colour['out_of_gamut']:.1f} %"
        )  # fmt: skip
        out.say(f"{outcome.face.name}: {error}")
        for note in outcome.report.get("notes", ()):
            out.say(f"{outcome.face.name}: {note}")
    skipped = sum(outcome.there for outcome in found)
    left = f", {skipped} were there already" if skipped else ""
    total = sum(len(job.captures) for job in sets)
    out.say(f"{len(new)} of {total} estimated into {sets[0].output}{left}")


def say_one(results: dict[str, Any], white: bool = False) -> None:
    """Prints what was found in one capture; `white` says whether gains were looked for."""
    gains = ", ".join(f"{g:.3f}" for g in results["calibration"]["gains"])
    light = results["calibration"]["illuminant"]
    out.say(f"colour space: {results['colorspace']}")
    for note in results.get("notes", ()):
        out.say(note)
    out.say(
        f"gains {gains} ({results['calibration']['origin']}), model {results['model']}"
        + (f", captured under {light}" if light != "D65" else "")
    )
    print_statistics(
        (name, row["unit"], row["p5"], row["median"], row["p95"])
        for name, row in results["maps"].items()
    )
    for key, what in (("below_0", "negative"), ("above_1", "above one")):
        if results[key]:
            out.say(f"{results[key]:,} texels have a colour {what}, which is no albedo")
    colour = results.get("colour")
    if colour is None:
        out.say("no texel inside the mask has the colour of skin; check mask and colour space")
        return
    share = results["skin_texels"] / results["masked_texels"]
    out.say(
        f"model against capture on {results['skin_texels']:,} skin texels (L* > 35, C*ab > 12; "
        f"{100 * share:.1f} % of the mask): ΔE00 mean "
        f"{colour['delta_e_mean']:.3f}, 95 % {colour['delta_e_p95']:.3f}, "
        f"out of gamut {100 * colour['out_of_gamut']:.1f} %, ITA {colour['ita_median']:.0f}°"
    )
    told = list(lines(results["maps"], results.get("low_confidence")))
    for line in told:
        out.say(line)
    if not told:
        out.say(
            "On skin colours RGB fixes melanin and blood well, thickness less, and says little of "
            "eumelanin and oxygenation."
        )
    if share < 0.2:
        out.say("That is a small part of the mask: darker texels are not in these numbers.")
    if colour["out_of_gamut"] > 0.05 and not white:
        out.say("Many texels are out of gamut: try --white auto, or a tighter --mask.")
