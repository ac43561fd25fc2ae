"""Models by name: how a colour becomes a skin, and a skin a colour.

`measured2026` reads the most probable measured skin from a baked table and decodes by the colour
table of its tissue; `aliaga2022-exact` does the same with the tissue of the paper and no prior of
measured skin. `aliaga2022` is the paper's pair of networks, trained by `cutis train`; `lookup` and
`lookup-55k` are its look-up tensors of 256 000 and 55 296 skins, `kubelka-munk` the two-parameter
baseline. `default` is another name of the model that is used when none is named.
"""

import contextlib
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo.colour_table import colour_table
from cutis.albedo.rare import rare_ratio
from cutis.errors import CutisError
from cutis.inverse.device import check_device, torch_network
from cutis.inverse.lookup import SHAPES, lookup_tensor
from cutis.inverse.network import Autoencoder, Perceptron, load_weights
from cutis.inverse.prior import SkinPrior, load_prior
from cutis.optics import ALIAGA2022, MEASURED2026, PARAMETERS, Tissue, axes

EXACT, MEASURED = "aliaga2022-exact", "measured2026"
DEFAULT = MEASURED
"""What `default` stands for; headers and reports say the name, never `default`."""
MODELS = tuple(dict.fromkeys((DEFAULT, EXACT, "aliaga2022", *SHAPES, "kubelka-munk")))
"""Names that `load_model` knows, besides `default`; it also takes the path of a weights file."""
Conversion = Callable[[NDArray[np.float32]], NDArray[np.float32]]
BAND = 1 << 18
"""Texels converted at a time."""
WEIGHTS = resources.files("cutis.data").joinpath("weights")


@dataclass(frozen=True)
class Model:
    """An inverse and its forward model.

    `to_skins` maps (n, 3) calibrated linear sRGB to (n, 5) parameters in their units and within
    their ranges, `to_rgb` maps those to (n, 3) linear sRGB. `tissue` is the one whose albedo space
    gives the spectra of its skins. `to_trust`, where there is one, maps the same colours to (n, 6):
    the standard deviation of each parameter in its unit and the confidence, in [0, 1], that the
    colour is one of skin. `prior_sigma` is what the standard deviations were before a colour was
    seen, in network coordinates.
    """

    name: str
    to_skins: Conversion
    to_rgb: Conversion
    tissue: Tissue = ALIAGA2022
    to_trust: Conversion | None = None
    prior_sigma: tuple[float, ...] | None = None

    def encode(self, rgb: ArrayLike) -> NDArray[np.float32]:
        """(..., 3) calibrated linear sRGB → (..., 5) parameters in their units."""
        return _in_bands(self.to_skins, rgb, 5)

    def decode(self, parameters: ArrayLike) -> NDArray[np.float32]:
        """(..., 5) parameters in their units → (..., 3) linear sRGB under D65.

        Of (..., 8), the last three are rare chromophores (`optics.RARE`): their colour is the
        model's, times what they change in the exact albedo space of its tissue.
        """
        skins = np.asarray(parameters, dtype=np.float32)
        colours = _in_bands(self.to_rgb, skins[..., : len(PARAMETERS)], 3)
        if skins.shape[-1] > len(PARAMETERS):
            colours *= _in_bands(lambda some: rare_ratio(self.tissue, some), skins, 3)
        return colours

    def trust(self, rgb: ArrayLike) -> NDArray[np.float32] | None:
        """(..., 3) calibrated linear sRGB → (..., 6): σ of the five parameters, and confidence.

        σ is in the parameter's unit: what a fit to the whole spectrum of a skin finds lies within
        ± 1.645 σ for nine of ten skins. None where the model does not know.
        """
        return None if self.to_trust is None else _in_bands(self.to_trust, rgb, 6)


def _in_bands(
    function: Callable[[NDArray[np.float32]], NDArray[np.float32]], values: ArrayLike, size: int
) -> NDArray[np.float32]:
    array = np.asarray(values, dtype=np.float32)
    flat = array.reshape(-1, array.shape[-1])
    out = np.empty((len(flat), size), dtype=np.float32)
    for start in range(0, len(flat), BAND):
        out[start : start + BAND] = function(flat[start : start + BAND])
    return out.reshape(*array.shape[:-1], size)


_DEVICE: ContextVar[str] = ContextVar("device", default="cpu")


@contextlib.contextmanager
def on_device(device: str) -> Iterator[None]:
    """Networks run on `device`, cpu or cuda, inside the block."""
    check_device(device)
    before = _DEVICE.set(device)
    try:
        yield
    finally:
        _DEVICE.reset(before)


def load_model(name: str = "default", device: str | None = None) -> Model:
    """The model called `name`, or of the weights file `name`; CutisError when there is none.

    `default` stands for DEFAULT. Networks may run on another `device`, "cuda", which is that of
    `on_device` unless given; tables are read by the processor. CutisError when there is no such
    device, or the model is a table.
    """
    return _load(model_name(name), _DEVICE.get() if device is None else device)


def model_name(name: str) -> str:
    """The name itself, or what `default` stands for."""
    return DEFAULT if name == "default" else name


def stored_name(name: str) -> str:
    """The model of maps whose header says `name`: `default` is from before there was another."""
    return EXACT if name == "default" else name


def tissue_of(name: str) -> Tissue:
    """The tissue whose albedo space gives the spectra of the skins of a model."""
    return MEASURED2026 if model_name(name) == MEASURED else ALIAGA2022


@cache
def _load(name: str, device: str) -> Model:
    if device != "cpu":
        check_device(device)
        if name in (*SHAPES, EXACT, MEASURED, "kubelka-munk"):
            raise CutisError(
                f"the model {name} is a table, read by the processor; --device cuda is for "
                "aliaga2022 and files of weights"
            )
    if name in (EXACT, MEASURED):
        return _baked(name)
    if name in SHAPES:
        tensor = lookup_tensor(name)
        return Model(name, _in_units(tensor.encode), tensor.decode)
    if name == "kubelka-munk":
        from cutis.inverse.kubelka_munk import kubelka_munk_inverse

        baseline = kubelka_munk_inverse()
        return Model(name, _in_units(baseline.encode), baseline.decode)
    if name in MODELS or (name.endswith(".safetensors") and Path(name).is_file()):
        return _from_networks(name, networks(name), device)
    raise CutisError(
        f"unknown model {name!r}; choose {', '.join(MODELS)} or a .safetensors file of weights"
    )


def _baked(name: str) -> Model:
    from cutis.inverse.baked import Baked, load_baked
    from cutis.inverse.trust import look_up_trust

    def table(stem: str) -> Baked:
        with resources.as_file(WEIGHTS.joinpath(f"{stem}.npz")) as file:
            return load_baked(file)

    tissue, inverse = tissue_of(name), table(name)
    decode = colour_table(tissue).rgb
    if name == EXACT:
        return Model(name, inverse.skins, decode, tissue)
    trust = table(f"{name}-trust")
    before = tuple(float(s) for s in shipped_prior().prior_sigma)
    return Model(name, inverse.skins, decode, tissue, lambda rgb: look_up_trust(trust, rgb), before)


def shipped_prior() -> SkinPrior:
    """The prior of measured skin that `measured2026` is baked from."""
    with resources.as_file(WEIGHTS.joinpath(f"{MEASURED}-prior.npz")) as file:
        return load_prior(file)


def shipped_encoder() -> Perceptron:
    """The encoder of `aliaga2022`, on which `aliaga2022-exact` is baked."""
    return networks("aliaga2022").encoder


def networks(name: str) -> Autoencoder:
    """The networks of a model; CutisError for models that are none."""
    if name.endswith(".safetensors") and Path(name).is_file():
        return load_weights(Path(name))
    if name != "aliaga2022":
        raise CutisError(
            f"{name} is not a pair of networks; use aliaga2022 or a .safetensors file of weights"
        )
    with resources.as_file(WEIGHTS.joinpath(f"{name}.safetensors")) as path:
        return load_weights(path)


def _from_networks(name: str, pair: Autoencoder, device: str) -> Model:
    from cutis.kernels.warp_kernel import to_coordinates

    ranges = axes().astype(np.float32)
    encoder: Conversion = pair.encoder
    decoder: Conversion = pair.decoder
    if device != "cpu":
        encoder, decoder = (torch_network(n, device) for n in (pair.encoder, pair.decoder))
    return Model(name, _in_units(encoder), lambda skins: decoder(to_coordinates(skins, ranges)))


def _in_units(encode: Conversion) -> Conversion:
    """What gives network coordinates, giving parameters in their units."""
    from cutis.kernels.warp_kernel import to_units

    ranges = axes().astype(np.float32)
    return lambda colours: to_units(encode(colours), ranges)
