"""Prints the table of decision 0023: run `python -m studies.prior_alternatives`.

How near implied spectra are, and how steady maps of the bundled capture, by the freedom that
parameters have to follow the colour. Priors are learned from one half of the subjects of the
shared data and judged on the other, both ways.
"""

import argparse
from pathlib import Path

import numpy as np
from rich.progress import track

from cutis import estimate, read, read_mask
from cutis.albedo import AlbedoSpace, albedo_space
from cutis.albedo.sampled import SampledSpace
from cutis.colour import is_skin_colour
from cutis.inverse.prior import SkinPrior
from cutis.optics import MEASURED2026, NAMES, from_coordinates
from studies.figures.measured import ArchivedSkins, read_skins
from studies.prior_training import train_prior

ROOT = Path(__file__).parents[1]
FREEDOMS = (
    (1, 1, 1, 1, 1), (1, 1, 1, 0.5, 0.7), (1, 1, 1, 0.25, 0.5), (1, 1, 1, 0.1, 0.3),
)  # fmt: skip
"""Melanin, blood, thickness, eumelanin share, oxygenation."""
PAIRS = 6000


def halves(skins: ArchivedSkins) -> np.ndarray:
    """(n,) 0 or 1, by subject."""
    names, of = np.unique(skins.subjects, return_inverse=True)
    return np.random.default_rng(1).permutation(len(names))[of] % 2


def neighbours() -> tuple[np.ndarray, np.ndarray, float]:
    """Calibrated colours of neighbouring skin texels (n, 3), and their mean difference before."""
    face = read(ROOT / "examples" / "bioskin_capture1.jpg")
    mask = read_mask(ROOT / "examples" / "bioskin_capture1_mask.jpg", face.shape)
    gains = np.array(estimate(face, mask, white="auto").calibration.gains)
    linear = face.linear()
    rng = np.random.default_rng(0)
    places = np.argwhere(mask[:-1, :-1] > 0.5)
    y, x = places[rng.choice(len(places), PAIRS, replace=False)].T
    down = rng.integers(0, 2, PAIRS)
    one, other = linear[y, x], linear[y + down, x + 1 - down]
    skin = is_skin_colour(one * gains) & is_skin_colour(other * gains)
    one, other = one[skin], other[skin]
    return one * gains, other * gains, float(np.abs(one - other).mean())


def implied(prior: SkinPrior, space: AlbedoSpace, skins: ArchivedSkins) -> np.ndarray:
    """(n,) RMS between implied and measured spectra."""
    u = prior.skins(space, skins.albedo).astype(float)
    albedo = SampledSpace(space, skins.wavelengths).reflectance(from_coordinates(u))
    spectra = skins.specular + (1 - skins.specular) * albedo
    return np.sqrt(((spectra - skins.spectra) ** 2).mean(axis=1))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    shared = ROOT.parent / "shared" / "data"
    parser.add_argument("data", type=Path, nargs="?", default=shared, help="the shared data")
    skins = read_skins(parser.parse_args().data)
    half, space = halves(skins), albedo_space(MEASURED2026)
    one, other, base = neighbours()
    print(f"| freedom | RMS median | p95 | smoothness: {' | '.join(NAMES)} |")
    print("|---|---|---|---|---|---|---|---|")
    for freedom in track(FREEDOMS, "priors"):
        rms, steady = np.empty(len(half)), np.zeros(5)
        for k in (0, 1):
            prior = train_prior(skins.some(half != k), MEASURED2026, freedom=freedom)
            rms[half == k] = implied(prior, space, skins.some(half == k))
            rise = np.abs(prior.skins(space, one) - prior.skins(space, other))
            steady += rise.mean(axis=0) / base / 2
        numbers = " | ".join(f"{value:.2f}" for value in steady)
        label = ", ".join(f"{value:g}" for value in freedom)
        print(f"| {label} | {np.median(rms):.5f} | {np.percentile(rms, 95):.5f} | {numbers} |")


if __name__ == "__main__":
    main()
