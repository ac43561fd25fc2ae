"""Rewrites the tables of docs/transport.md: run `python -m studies.transport_convergence`."""

import numpy as np
from rich.progress import track

from cutis.albedo.spectral_table import axis_ranges
from cutis.optics import ALIAGA2022, WAVELENGTHS
from cutis.transport import (
    Layer,
    adding_doubling,
    fresnel_reflectance,
    kubelka_munk,
    stack_balance,
    two_layer_albedo,
)
from studies.pages import rewrite

COUNTS = (8, 12, 16, 24, 32, 48)
REFERENCE = 96
PROBLEMS = [(2, 1.0), (2, 1.4), (3, 1.0), (3, 1.4)]

PUBLISHED = [
    # case, source, published, layers (cm⁻¹, cm), refractive index, which share
    (
        "slab, g = 0.75, μa = 10, μs = 90 cm⁻¹, d = 0.02 cm, R",
        "van de Hulst 1980",
        "0.09739",
        [Layer(10, 90, 0.75, 0.02)],
        1.0,
        "reflected",
    ),
    (
        "the same, T (unscattered light included)",
        "van de Hulst 1980",
        "0.66096",
        [Layer(10, 90, 0.75, 0.02)],
        1.0,
        "transmitted",
    ),
    (
        "half space, n = 1.5, g = 0, μa = 10, μs = 90 cm⁻¹, R with specular",
        "Giovanelli 1955",
        "0.2600",
        [Layer(10, 90, 0.0)],
        1.5,
        "total",
    ),
    (
        "the same",
        "Prahl et al. 1989, Monte Carlo",
        "0.26079 ± 0.00079",
        [Layer(10, 90, 0.0)],
        1.5,
        "total",
    ),
    (
        "three layers, n = 1.37, R without specular",
        "MCML sample, 10⁶ photons",
        "0.23754 ± 0.0004",
        [Layer(1, 100, 0.9, 0.1), Layer(1, 10, 0, 0.1), Layer(2, 10, 0.7, 0.2)],
        1.37,
        "reflected",
    ),
    (
        "the same, T",
        "MCML sample, 10⁶ photons",
        "0.09649 ± 0.0004",
        [Layer(1, 100, 0.9, 0.1), Layer(1, 10, 0, 0.1), Layer(2, 10, 0.7, 0.2)],
        1.37,
        "transmitted",
    ),
]


def albedos(dimension: int, refractive_index: float, count: int) -> np.ndarray:
    """Low, middle and high absorption and thickness at nine wavelengths."""
    low, high = axis_ranges(ALIAGA2022)
    chosen = range(0, len(WAVELENGTHS), 5)
    scattering, g = ALIAGA2022.scattering(WAVELENGTHS), ALIAGA2022.anisotropy(WAVELENGTHS)
    result = []
    for i in chosen:
        epidermis, dermis, log_thickness = np.linspace(low[i], high[i], 3).T
        result.append(
            two_layer_albedo(
                epidermis**4,
                dermis**4,
                np.exp(log_thickness),
                scattering[i],
                g[i],
                dimension=dimension,
                refractive_index=refractive_index,
                count=count,
            )
        )
    return np.array(result)


def convergence() -> str:
    worst: dict[tuple[int, int], float] = {}
    for column, problem in enumerate(track(PROBLEMS, "convergence")):
        exact = albedos(*problem, REFERENCE)
        for count in COUNTS:
            worst[count, column] = float(np.abs(albedos(*problem, count) - exact).max())
    lines = [
        "| N | 2-D, matched | 2-D, Fresnel | 3-D, matched | 3-D, Fresnel |",
        "|---|---|---|---|---|",
    ]
    for count in COUNTS:
        cells = [f"{worst[count, column]:.0e}" for column in range(len(PROBLEMS))]
        lines.append(f"| {count} | {' | '.join(cells)} |")
    return "\n".join(lines)


def comparison() -> str:
    lines = [
        "| case (3-D, normal incidence) | source | published | ordinates | doubling |",
        "|---|---|---|---|---|",
    ]
    for case, source, published, layers, index, share in PUBLISHED:
        specular = float(fresnel_reflectance(1.0, index))
        options = {"refractive_index": index, "incidence": 1.0, "count": 64}
        balance = stack_balance(layers, **options)
        fast = balance.transmitted if share == "transmitted" else balance.reflected
        plain = adding_doubling(layers, **options)[share == "transmitted"]
        both = [(specular if share == "total" else 0.0) + (1 - specular) * x for x in (fast, plain)]
        lines.append(f"| {case} | {source} | {published} | {both[0]:.6f} | {both[1]:.6f} |")
    return "\n".join(lines)


def two_flux() -> str:
    lines = [
        "| μa / μs′ | exact | " + " | ".join(kubelka_munk.CONVERSIONS) + " |",
        "|---|---|---|---|---|",
    ]
    for ratio in (0.001, 0.01, 0.05, 0.1, 0.3, 1.0, 3.0):
        pairs = [kubelka_munk.coefficients(20 * ratio, 20.0, n) for n in kubelka_munk.CONVERSIONS]
        exact = stack_balance([Layer(20 * ratio, 100.0, 0.8)], dimension=3).reflected
        cells = [f"{float(kubelka_munk.half_space(*pair)):.4f}" for pair in pairs]
        lines.append(f"| {ratio} | {exact:.4f} | {' | '.join(cells)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    rewrite("transport.md", convergence=convergence(), published=comparison(), kubelka=two_flux())
