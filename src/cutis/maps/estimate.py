"""From a capture to its skin maps."""

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration, Exposure, White, calibrate
from cutis.inverse.models import load_model, tissue_of
from cutis.maps.files import source_note
from cutis.maps.sampler import Sampler
from cutis.maps.skin_maps import SkinMaps
from cutis.optics import NAMES
from cutis.textures.texture import Texture, bands


def estimate(
    face: Texture | ArrayLike,
    mask: ArrayLike | None = None,
    *,
    white: White = None,
    exposure: Exposure = None,
    model: str = "default",
    illuminant: str = "D65",
    sigma: bool = True,
) -> SkinMaps:
    """Skin maps of a texture or of an (H, W, 3) array of linear sRGB.

    `mask` (H, W) in [0, 1] says where skin is; without one, wherever alpha is not 0. `white` and
    `exposure` are gains, "auto" or "none" (`inverse.calibration`). `illuminant` is the light of the
    capture, a name or file that `colour.illuminant` takes. `sigma` adds standard deviations and
    confidence where the model knows them. Raises CutisError for arrays of other shapes, NaN or
    infinite colours, and masks that are empty or of another size.
    """
    source = _linear(face)
    cover = _cover(face, mask, source.shape[:2])
    sampler = Sampler(cover.size)
    while not sampler.enough():
        sampler.add(0, source, cover)
    calibration = calibrate(sampler.colours(), white, exposure, illuminant, tissue_of(model))
    maps: dict[str, Any] = {name: np.zeros(cover.shape, dtype=np.float32) for name in NAMES}
    trust: dict[str, Any] = {}
    if sigma and load_model(model).to_trust is not None:
        whole = np.zeros((len(NAMES) + 1, *cover.shape), dtype=np.float32)
        trust = {"sigmas": dict(zip(NAMES, whole, strict=False)), "confidence": whole[-1]}
    for rows in bands(cover.shape):
        found = estimate_rows(source[rows], cover[rows], calibration, model, sigma)
        for name in NAMES:
            maps[name][rows] = found[name]
        if trust:
            trust["confidence"][rows] = found["confidence"]
            for name, values in found["sigmas"].items():
                trust["sigmas"][name][rows] = values
    provenance = source_note(face) if isinstance(face, Texture) else {}
    return SkinMaps(
        **maps,
        **trust,
        mask=cover,
        calibration=calibration,
        model=model,
        source=source,
        provenance=provenance,
    )


def estimate_rows(
    source: NDArray[np.float32],
    cover: NDArray[np.float32],
    calibration: Calibration,
    model: str,
    sigma: bool = True,
) -> dict[str, Any]:
    """Maps (h, W) by name of colours (h, W, 3), linear sRGB as captured, where `cover` is not 0.

    With `sigma` also `sigmas` (h, W) by name and `confidence` (h, W), where the model knows them.
    """
    inside, known = cover > 0, load_model(model)
    colours = calibration.apply(source[inside])

    def spread(values: NDArray[np.float32]) -> NDArray[np.float32]:
        whole = np.zeros((values.shape[1], *cover.shape), dtype=np.float32)
        whole[:, inside] = values.T
        return whole

    found: dict[str, Any] = dict(zip(NAMES, spread(known.encode(colours)), strict=True))
    trust = known.trust(colours) if sigma else None
    if trust is not None:
        *sigmas, confidence = spread(trust)
        found["sigmas"] = dict(zip(NAMES, sigmas, strict=True))
        found["confidence"] = confidence
    return found


def blank(
    calibration: Calibration,
    model: str = "default",
    provenance: Mapping[str, str] | None = None,
    sigmas: Collection[str] = (),
    confident: bool = False,
) -> SkinMaps:
    """Maps of no texels, with what a header says; `sigmas` names maps that have one."""
    none = np.zeros((0, 0), np.float32)
    nothing: dict[str, Any] = dict.fromkeys((*NAMES, "mask"), none)
    return SkinMaps(
        **nothing,
        calibration=calibration,
        model=model,
        provenance=provenance or {},
        sigmas=dict.fromkeys(sigmas, none),
        confidence=none if confident else None,
    )


def _linear(face: Texture | ArrayLike) -> NDArray[np.float32]:
    if isinstance(face, Texture):
        return face.linear()
    colours = np.asarray(face)
    if colours.ndim != 3 or colours.shape[2] != 3 or colours.size == 0:
        raise CutisError(f"an albedo must be (H, W, 3) linear sRGB, not {colours.shape}")
    if colours.dtype.kind not in "f":
        raise CutisError(
            f"an albedo array must be floating-point linear sRGB, not {colours.dtype}; "
            "decode it first, or give a file to cutis.read"
        )
    with np.errstate(over="ignore"):
        linear = colours.astype(np.float32)  # a copy: what happens to the array later is not seen
    if not all(np.isfinite(linear[rows]).all() for rows in bands(linear.shape[:2])):
        raise CutisError("the albedo has NaN or infinite texels; repair them first")
    return linear


def _cover(
    face: Texture | ArrayLike, mask: ArrayLike | None, shape: tuple[int, ...]
) -> NDArray[np.float32]:
    if mask is None:
        alpha = face.alpha() if isinstance(face, Texture) else None
        cover = np.ones(shape, np.float32) if alpha is None else (alpha > 0).astype(np.float32)
    else:
        cover = np.array(mask, dtype=np.float32)
    if cover.shape != shape:
        raise CutisError(f"the mask is {cover.shape}, the albedo is {tuple(shape)}")
    if not (np.isfinite(cover).all() and cover.min() >= 0 and cover.max() <= 1):
        raise CutisError("the mask must hold values from 0 to 1")
    if not (cover > 0).any():
        raise CutisError("the mask is empty: nothing is marked as skin")
    return cover
