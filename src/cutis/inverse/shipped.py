"""The models that come with cutis.

`measured2026b` and `measured2026` read the most probable measured skin from a baked table and
decode by the colour table of their tissue; `aliaga2022-exact` does the same with the tissue of the
paper and no prior of measured skin. `aliaga2022` is the paper's pair of networks, trained by
`cutis train`; `lookup` and `lookup-55k` are its look-up tensors of 256 000 and 55 296 skins,
`kubelka-munk` the two-parameter baseline.
"""

from collections.abc import Callable
from dataclasses import asdict
from importlib import resources
from pathlib import Path

import numpy as np

from cutis.albedo.colour_table import colour_table
from cutis.errors import CutisError
from cutis.inverse.device import torch_network
from cutis.inverse.lookup import SHAPES, lookup_tensor
from cutis.inverse.model import Conversion, Model, content_digest
from cutis.inverse.network import Autoencoder, Perceptron, load_weights
from cutis.inverse.prior import SkinPrior, load_prior
from cutis.optics import ALIAGA2022, MEASURED2026, MEASURED2026B, Tissue, axes

EXACT, MEASURED, VARYING = "aliaga2022-exact", "measured2026", "measured2026b"
NETWORKS = ("aliaga2022",)
"""Models that are pairs of networks."""
TISSUE_OF = {EXACT: ALIAGA2022, MEASURED: MEASURED2026, VARYING: MEASURED2026B}
"""The tissues of baked models."""
WEIGHTS = resources.files("cutis.data").joinpath("weights")
TABLES = resources.files("cutis.data").joinpath("albedo")


def _baked(name: str) -> Model:
    from cutis.inverse.baked import Baked, load_baked
    from cutis.inverse.steady import STEADINESS, steadied
    from cutis.inverse.trust import look_up_trust

    def table(stem: str) -> Baked:
        with resources.as_file(WEIGHTS.joinpath(f"{stem}.npz")) as file:
            return load_baked(file)

    tissue = TISSUE_OF[name]
    inverse, decode = table(name), colour_table(tissue).rgb
    if name == EXACT:
        return Model(name, inverse.skins, decode, tissue, digest=_digest(tissue, f"{name}.npz"))
    trust = table(f"{name}-trust")
    before = tuple(float(s) for s in shipped_prior(name).prior_sigma)
    files = (f"{name}.npz", f"{name}-trust.npz", f"{name}-prior.npz")
    model = Model(
        name, inverse.skins, decode, tissue,
        to_trust=lambda rgb: look_up_trust(trust, rgb),
        prior_sigma=before,
        digest=content_digest(_digest(tissue, *files), list(STEADINESS)),
    )  # fmt: skip
    return steadied(model, inverse)


def _tensor(name: str) -> Model:
    tensor = lookup_tensor(name)
    digest = _digest(ALIAGA2022, shape=SHAPES[name])
    return Model(name, _in_units(tensor.encode), tensor.decode, ALIAGA2022, digest=digest)


def _kubelka_munk(name: str) -> Model:
    from cutis.albedo.kubelka_munk import KubelkaMunkSkin
    from cutis.inverse.kubelka_munk import kubelka_munk_inverse

    baseline = kubelka_munk_inverse(KubelkaMunkSkin(ALIAGA2022))
    digest = content_digest(name, asdict(baseline.skin))
    return Model(name, _in_units(baseline.encode), baseline.decode, ALIAGA2022, digest=digest)


def _shipped_networks(name: str, device: str) -> Model:
    weights = WEIGHTS.joinpath(f"{name}.safetensors").read_bytes()
    return _from_networks(name, networks(name), device, content_digest(weights))


FACTORIES: dict[str, Callable[[str], Model]] = {
    VARYING: lambda _: _baked(VARYING),
    MEASURED: lambda _: _baked(MEASURED),
    EXACT: lambda _: _baked(EXACT),
    "aliaga2022": lambda device: _shipped_networks("aliaga2022", device),
    "lookup": lambda _: _tensor("lookup"),
    "lookup-55k": lambda _: _tensor("lookup-55k"),
    "kubelka-munk": lambda _: _kubelka_munk("kubelka-munk"),
}
"""What makes each model, for a device; to add one, add it here."""


def from_file(path: Path, device: str) -> Model:
    """The networks of a .safetensors file as a model, named by the file."""
    model = _from_networks(str(path), load_weights(path), device, content_digest(path.read_bytes()))
    return Model(
        model.name, model.to_skins, model.to_rgb, model.tissue,
        digest=model.digest, recipe=(str(path.resolve()), device),
    )  # fmt: skip


def shipped_prior(name: str = MEASURED) -> SkinPrior:
    """The prior of measured skin that a model is baked from."""
    with resources.as_file(WEIGHTS.joinpath(f"{name}-prior.npz")) as file:
        return load_prior(file)


def shipped_encoder() -> Perceptron:
    """The encoder of `aliaga2022`, on which `aliaga2022-exact` is baked."""
    return networks("aliaga2022").encoder


def networks(name: str) -> Autoencoder:
    """The networks of a model; CutisError for models that are none."""
    if name.endswith(".safetensors") and Path(name).is_file():
        return load_weights(Path(name))
    if name not in NETWORKS:
        raise CutisError(
            f"{name} is not a pair of networks; use aliaga2022 or a .safetensors file of weights"
        )
    with resources.as_file(WEIGHTS.joinpath(f"{name}.safetensors")) as path:
        return load_weights(path)


def _from_networks(name: str, pair: Autoencoder, device: str, digest: str) -> Model:
    from cutis.kernels.warp_kernel import to_coordinates

    ranges = axes().astype(np.float32)
    encoder: Conversion = pair.encoder
    decoder: Conversion = pair.decoder
    if device != "cpu":
        encoder, decoder = (torch_network(n, device) for n in (pair.encoder, pair.decoder))
    return Model(
        name, _in_units(encoder), lambda skins: decoder(to_coordinates(skins, ranges)), ALIAGA2022,
        digest=digest,
    )  # fmt: skip


def _in_units(encode: Conversion) -> Conversion:
    """What gives network coordinates, giving parameters in their units."""
    from cutis.kernels.warp_kernel import to_units

    ranges = axes().astype(np.float32)
    return lambda colours: to_units(encode(colours), ranges)


def _digest(tissue: Tissue, *weights: str, shape: tuple[int, ...] = ()) -> str:
    """Of shipped weights, and of the tables and constants of a tissue."""
    tables = [TABLES.joinpath(f"{tissue.name}{end}.npz") for end in ("", "-rgb")]
    files = [WEIGHTS.joinpath(name) for name in weights] + [f for f in tables if f.is_file()]
    return content_digest(asdict(tissue), list(shape), *(file.read_bytes() for file in files))
