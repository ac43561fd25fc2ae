"""Maps whose header another program dropped: what is taken then, and how people name what is right.

Compositing programs keep channels and lose attributes. Without a model, the tissue of an edit is
a guess, and without a calibration so are the gains between capture and maps.
"""

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration, calibrate
from cutis.optics import Tissue
from cutis.textures.problem import problem
from cutis.textures.regular import read_regular

MAPS, REPORT = ".skin.exr", ".report.json"
_LONGEST = 64 << 20  # bytes of a report


def lost_note(path: Path, untold: Sequence[str], model: str) -> str:
    """What to say of maps whose header lacks `untold` ("model", "calibration"): what is taken."""
    taken = {"model": model, "calibration": "gains of 1"}
    said = (
        f"{path.name} says no {' and no '.join(untold)}, as after another program saved it: "
        f"{' and '.join(taken[name] for name in untold)} taken"
    )
    report = path.with_name(path.name.removesuffix(MAPS) + REPORT)
    flags = " ".join(
        {"model": "--model NAME", "calibration": "--calibration R,G,B"}[name] for name in untold
    )
    if path.name.endswith(MAPS) and report.is_file():
        try:
            content = _report(report)
            flags = flags.replace("NAME", str(content["model"])).replace("R,G,B", report.name)
        except CutisError:
            pass
    return f"{said}; to name what is right: cutis edit {flags}"


def given_calibration(text: str, tissue: Tissue) -> Calibration:
    """The calibration that a flag gives: three gains, or that of NAME.report.json.

    Raises CutisError, one line, for anything else.
    """
    if not text.endswith(".json"):
        return calibrate(np.ones((1, 3)), tissue, _gains(text))
    stored = _report(Path(text))["calibration"]
    try:
        gains, light = [float(gain) for gain in stored["gains"]], str(stored["illuminant"])
    except (ValueError, KeyError, TypeError, OverflowError) as error:
        raise problem(text, "has no calibration; give three gains") from error
    return calibrate(np.ones((1, 3)), tissue, gains, light=light)


def _gains(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise CutisError(
            f"--calibration takes three gains like 0.9,1,1.1 or a NAME.report.json, not {text!r}"
        ) from None


def _report(path: str | os.PathLike[str]) -> dict[str, Any]:
    """A report, as far as its model and calibration are of the right kind."""
    try:
        found = json.loads(read_regular(path, _LONGEST))
    except (ValueError, RecursionError) as error:
        if isinstance(error, CutisError):
            raise
        raise problem(path, "is no report; give three gains") from error
    right = isinstance(found, dict) and isinstance(found.get("calibration"), dict)
    if not right or not isinstance(found.get("model"), str):
        raise problem(path, "has no calibration; give three gains")
    return dict(found)
