"""Rewrites the Monte Carlo table of docs/transport.md: `python -m studies.monte_carlo_accuracy`.

Some 4 minutes on two idle cores.
"""

import numpy as np
from rich.progress import track
from scipy.stats import chi2, norm

from cutis.optics import ALIAGA2022, WAVELENGTHS, from_coordinates
from cutis.transport import two_layer_albedo
from cutis.transport.monte_carlo import walk_stacks
from studies.pages import rewrite

SKINS = 250
PHOTONS = 200_000
SEED = 41


def main() -> None:
    rows = []
    for dimension, index in track([(2, 1.0), (2, 1.4), (3, 1.0), (3, 1.4)], "walking"):
        rng = np.random.default_rng(SEED + dimension)
        skins = from_coordinates(rng.random((SKINS, 5)))
        melanin, blood, thickness, eumelanin, oxygenation = skins.T
        band, each = rng.integers(0, len(WAVELENGTHS), SKINS), np.arange(SKINS)
        lam = WAVELENGTHS[band]
        epidermis = ALIAGA2022.epidermis_absorption(melanin, eumelanin, WAVELENGTHS)[each, band]
        dermis = ALIAGA2022.dermis_absorption(blood, oxygenation, WAVELENGTHS)[each, band]
        mu_s, g = ALIAGA2022.scattering(lam), ALIAGA2022.anisotropy(lam)
        found = walk_stacks(
            np.stack([epidermis, dermis], -1),
            mu_s[:, None],
            g[:, None],
            np.stack([thickness * 1e-4, np.full(SKINS, np.inf)], -1),
            photons=PHOTONS,
            seed=SEED,
            dimension=dimension,
            refractive_index=index,
        )
        how = {"dimension": dimension, "refractive_index": index, "count": 32}
        exact = [
            two_layer_albedo(e, d, t, float(s), float(a), **how).item()
            for e, d, t, s, a in zip(epidermis, dermis, thickness, mu_s, g, strict=True)
        ]
        z = (found.reflected - exact) / found.reflected_error
        boundary = "matched" if index == 1 else "Fresnel"
        rows.append(
            f"| {dimension}-D, {boundary} | {np.median(found.reflected_error):.1e} "
            f"| {np.abs(z).max():.2f} | {norm.isf(0.01 / (2 * SKINS)):.2f} "
            f"| {z.mean() * np.sqrt(SKINS):+.2f} | {np.sum(z**2) / SKINS:.3f} "
            f"| {chi2.sf(np.sum(z**2), SKINS):.2f} |"
        )
    head = [
        f"{SKINS} random skins, each at a random wavelength, {PHOTONS} photons each:",
        "",
        "| walk | median error | largest abs(z) | bound at 1 % | mean z × √n | χ² / n | p of χ² |",
        "|---|---|---|---|---|---|---|",
    ]
    rewrite("transport.md", walks="\n".join([*head, *rows]))


if __name__ == "__main__":
    main()
