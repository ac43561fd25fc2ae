"""Writes src/cutis/data/colour/*.csv: run `python tools/build_colour_tables.py`."""

from pathlib import Path

import colour
import numpy as np

FOLDER = Path(__file__).parents[1] / "src" / "cutis" / "data" / "colour"
WAVELENGTHS = np.arange(380, 781, 5)
ILLUMINANTS = [
    *("A", "C", "D50", "D55", "D65", "D75", "E"),
    *(f"FL{i}" for i in range(1, 13)),
    *("LED-B1", "LED-B2", "LED-B3", "LED-B4", "LED-B5", "LED-BH1", "LED-RGB1", "LED-V1", "LED-V2"),
]
TERMS = (
    f"# Taken from the package colour-science {colour.__version__} (BSD-3-Clause, see "
    "THIRD_PARTY.md) by tools/build_colour_tables.py; every 5 nm, 380-780 nm.\n"
)


def _write(name: str, header: str, columns: dict[str, np.ndarray]) -> None:
    rows = [",".join(["lambda_nm", *columns])]
    for i, lam in enumerate(WAVELENGTHS):
        rows.append(",".join([str(lam), *(repr(float(c[i])) for c in columns.values())]))
    (FOLDER / name).write_text(header + TERMS + "\n".join(rows) + "\n", encoding="utf-8")


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


if __name__ == "__main__":
    main()
