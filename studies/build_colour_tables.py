"""Writes src/cutis/data/colour/*.csv: run `python -m studies.build_colour_tables`."""

from pathlib import Path

import colour
import numpy as np

from studies.generated import record

FOLDER = Path(__file__).parents[1] / "src" / "cutis" / "data" / "colour"
WAVELENGTHS = np.arange(380, 781, 5)
ILLUMINANTS = [
    *("A", "B", "C", "D50", "D55", "D60", "D65", "D75", "E", "ID50", "ID65"),
    *(f"FL{i}" for i in range(1, 13)),
    *(f"FL3.{i}" for i in range(1, 16)),
    *(f"HP{i}" for i in range(1, 6)),
    *("LED-B1", "LED-B2", "LED-B3", "LED-B4", "LED-B5", "LED-BH1", "LED-RGB1", "LED-V1", "LED-V2"),
]
TERMS = (
    f"# Taken from the package colour-science {colour.__version__} (BSD-3-Clause, see "
    "THIRD_PARTY.md) by studies/build_colour_tables.py; every 5 nm, 380-780 nm.\n"
)


D65_PRIME_WHITE = (0.3046, 0.3209)
"""Chromaticity of the LED light of Gitlina et al. 2020, all that is known of its spectrum."""
MIXTURES = {
    "D65-prime": ("LED-B5", (465.0, 22.0), (525.0, 32.0)),
    "D65-prime-RGB": ((630.0, 18.0), (525.0, 32.0), (460.0, 22.0)),
    "D65-prime-RGBW": ("LED-B3", (500.0, 28.0), (455.0, 20.0)),
}
"""Three plausible LED lights with that white: each of a table or a LED (peak, width in nm)."""


def _led(peak: float, width: float) -> np.ndarray:
    """Relative power of a single-colour LED, the model of Ohno 2005."""
    g = np.exp(-(((WAVELENGTHS - peak) / width) ** 2))
    return (g + 2 * g**5) / 3


def _mixture(parts: tuple) -> np.ndarray:
    """The mixture of three lights that has the white of D65-prime, 100 at its highest."""
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    observer = np.array([cmfs[lam] for lam in WAVELENGTHS])
    lights = np.array(
        [
            [colour.SDS_ILLUMINANTS[part][lam] for lam in WAVELENGTHS]
            if isinstance(part, str)
            else _led(*part)
            for part in parts
        ]
    )
    x, y = D65_PRIME_WHITE
    weights = np.linalg.solve((lights @ observer).T, np.array([x / y, 1.0, (1 - x - y) / y]))
    assert weights.min() > 0, (parts, weights)
    power = weights @ lights
    return 100 * power / power.max()


def _write(name: str, header: str, columns: dict[str, np.ndarray], terms: str = "") -> None:
    rows = [",".join(["lambda_nm", *columns])]
    for i, lam in enumerate(WAVELENGTHS):
        rows.append(",".join([str(lam), *(repr(float(c[i])) for c in columns.values())]))
    (FOLDER / name).write_text(header + (terms or TERMS) + "\n".join(rows) + "\n", encoding="utf-8")
    record(FOLDER / name)


def main() -> None:
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    values = np.array([cmfs[lam] for lam in WAVELENGTHS])
    _write(
        "cie1931_2deg.csv",
        "# Source: CIE 1931 2-degree standard observer, colour-matching functions. Unit: none.\n",
        {"x": values[:, 0], "y": values[:, 1], "z": values[:, 2]},
    )
    _write(
        "illuminants.csv",
        "# Source: CIE 15:2018 standard illuminants. Unit: relative spectral power.\n",
        {
            name: np.array([colour.SDS_ILLUMINANTS[name][lam] for lam in WAVELENGTHS])
            for name in ILLUMINANTS
        },
    )
    basis = colour.recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
    _write(
        "mallett2019.csv",
        "# Source: basis reflectances of sRGB primaries, Mallett and Yuksel 2019. Unit: none.\n",
        {
            name: np.array([basis[lam][i] for lam in WAVELENGTHS])
            for i, name in enumerate(("red", "green", "blue"))
        },
    )
    _write(
        "d65_prime.csv",
        "# Source: CONSTRUCTED, not measured: no spectrum of the light D65' of Gitlina et al. 2020 "
        "was\n# ever published. LED mixtures whose white is exactly x 0.3046, y 0.3209, which is "
        "known of it.\n"
        "# Unit: relative spectral power. docs/colour.md says what depends on the choice.\n",
        {name: _mixture(parts) for name, parts in MIXTURES.items()},
        "# Made by studies/build_colour_tables.py from CIE LED illuminants and the LED model of "
        "Ohno 2005.\n",
    )


if __name__ == "__main__":
    main()
