"""A colour space that is wrong is seen by the skin, and by the steps of the numbers."""

from collections.abc import Iterator

import numpy as np

from cutis.arrays import Floats
from cutis.checks.evidence import Evidence, read_as, thinned
from cutis.checks.finding import Finding
from cutis.checks.thresholds import Limits
from cutis.report.words import percent


def check(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Values that are read as linear but were encoded, and the reverse."""
    found = seen.gathered
    stored = found.stored
    values = thinned(found.values[found.sure])
    if len(values) < limits["texels"]:
        return
    encoded = stored.space.encoded
    numbers = readings(seen, values)
    told = "sRGB" if encoded else "linear"
    other = "linear" if encoded else "sRGB"
    if not encoded and stored.dtype.startswith("float"):
        steps = on_steps(values)
        if steps >= limits["steps"]:
            yield _wrong(
                f"{percent(steps)} of its float values lie on the 256 steps of 8-bit codes, "
                "which is how a picture looks that was stored without being made linear",
                other, numbers, {"steps": steps, "limit": limits["steps"]},
            )  # fmt: skip
            return
    wrong = too_dull(numbers, limits) if not encoded else too_deep(numbers, limits)
    if wrong:
        label, as_other = numbers[f"as_{told}"], numbers[f"as_{other}"]
        yield _wrong(
            f"read as labelled ({stored.space.name}) {percent(label)} of it have a colour of skin, "
            f"read as {other} {percent(as_other)}",
            other, numbers, {},
        )  # fmt: skip


def _wrong(why: str, other: str, numbers: dict[str, float], more: dict[str, float]) -> Finding:
    return Finding(
        "colour-space", "finding", f"the colour space is probably not what it says: {why}.",
        f"Say --colorspace {other}, or let --fix label it so.", {**numbers, **more},
    )  # fmt: skip


def readings(seen: Evidence, values: Floats) -> dict[str, float]:
    """Of values (n, 3) as linear, as sRGB: shares of skin before and after gains, gains, ratios."""
    numbers: dict[str, float] = {"as_labelled": seen.share}
    for name, encoded in (("linear", False), ("sRGB", True)):
        colours = read_as(values, encoded)
        gains = seen.gains_of(colours)
        numbers[f"as_{name}"] = seen.share_of(colours)
        numbers[f"{name}_balanced"] = seen.share_of(colours * gains)
        numbers[f"{name}_exposure"] = float(np.prod(gains) ** (1 / 3))
        numbers[f"{name}_red"] = float(np.median(colours[:, 0] / (colours[:, 1] + 1e-4)))
    return numbers


def too_dull(numbers: dict[str, float], limits: Limits) -> bool:
    """Whether what is read as linear is too bright and too grey for skin, and as sRGB is not.

    Encoding brings channels together: of light skin red over green is 1.7 to 2.1 in light and 1.3
    to 1.4 in codes.
    """
    return (
        numbers["linear_exposure"] < limits["bright"]
        and numbers["linear_red"] < limits["dull"]
        and numbers["sRGB_exposure"] > numbers["linear_exposure"] + limits["better"]
        and numbers["sRGB_balanced"] > limits["explained"]
    )


def too_deep(numbers: dict[str, float], limits: Limits) -> bool:
    """Whether what is read as sRGB is too dark and too red for skin, and as linear is not."""
    deep, linear = numbers["sRGB_balanced"], numbers["linear_balanced"]
    if linear < limits["explained"]:
        return False
    if deep < limits["none"]:
        return True
    return (
        deep > limits["some"]
        and numbers["sRGB_red"] > limits["deep"]
        and numbers["as_sRGB"] < limits["share"] * numbers["as_linear"]
        and numbers["linear_exposure"] > limits["bright"]
    )


def on_steps(values: Floats) -> float:
    """Share of texels of which all three values are n / 255, as near as their type allows."""
    inside = values[((values > 1 / 255) & (values < 1)).all(axis=1)].astype(np.float64)
    if len(inside) < 100 or len(np.unique(inside[:, 0])) < 8:
        return 0.0
    codes = inside * 255
    near = np.abs(codes - np.rint(codes)) < np.maximum(1e-3, codes * 2.0**-11 * 1.01)
    blind = codes * 2.0**-11 > 0.05  # half floats of bright values are too coarse to tell
    return float((near | blind).all(axis=1).mean()) if not blind.all() else 0.0
