"""Monte Carlo walks through layers: the transport of the paper, with its own statistical error.

The history of a photon is in `history.py`. Random numbers are counter-based [salmon2011]: a photon
of a case has its own, so the same seed gives the same answer on any number of threads. Every mean
comes with its standard error, estimated from the squares of the photons' scores.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError
from cutis.transport.discrete_ordinates import Layer
from cutis.transport.quadrature import beam_cosine

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]

PHOTONS = 1_000_000
"""Photons of a case, as in the paper."""
BLOCK = 8192
"""Photons that are summed up together."""
CASES = 256
"""Cases walked at a time."""
BATCH = 1 << 21
"""About how many photons are walked between two reports of progress."""
MOST = 1 << 32
"""Photons that one stream has random numbers for."""


@dataclass(frozen=True)
class Walk:
    """Means over photons, and standard errors of these means.

    `reflected`, `transmitted` (n,), `absorbed` (n, L); of a single stack, without the n.
    """

    reflected: Array
    transmitted: Array
    absorbed: Array
    reflected_error: Array
    transmitted_error: Array
    absorbed_error: Array
    photons: int


def walk(
    layers: Sequence[Layer],
    *,
    photons: int = PHOTONS,
    seed: int = 0,
    stream: int = 0,
    dimension: int = 2,
    refractive_index: float = 1.0,
    incidence: float | str = "lambertian",
    device: str = "cpu",
    progress: Progress | None = None,
) -> Walk:
    """Walk through one stack of layers, the first on top; see `walk_stacks`."""
    found = walk_stacks(
        [[layer.absorption for layer in layers]],
        [[layer.scattering for layer in layers]],
        [[layer.anisotropy for layer in layers]],
        [[layer.depth for layer in layers]],
        photons=photons,
        seed=seed,
        streams=[stream],
        dimension=dimension,
        refractive_index=refractive_index,
        incidence=incidence,
        device=device,
        progress=progress,
    )
    return Walk(
        found.reflected[0],
        found.transmitted[0],
        found.absorbed[0],
        found.reflected_error[0],
        found.transmitted_error[0],
        found.absorbed_error[0],
        photons,
    )


def walk_stacks(
    absorption: ArrayLike,
    scattering: ArrayLike,
    anisotropy: ArrayLike,
    depth: ArrayLike,
    *,
    photons: int = PHOTONS,
    seed: int = 0,
    streams: ArrayLike | None = None,
    dimension: int = 2,
    refractive_index: float = 1.0,
    incidence: float | str = "lambertian",
    device: str = "cpu",
    progress: Progress | None = None,
) -> Walk:
    """Walks through n stacks of L layers; the four properties are (n, L) or broadcast to it.

    `absorption`, `scattering` in cm⁻¹, `depth` in cm, the first layer on top and only the last one
    infinite. Light starts inside, "lambertian" about the inward normal or as a beam at the cosine
    `incidence`; `refractive_index` is that of every layer with air around, 1 the matched boundary.
    Each case draws from its own stream of random numbers, `streams` (n,) whole numbers, 0 to n − 1
    unless given: a case walked alone under its stream gives what it gives among others. `device`
    is "cpu", "cuda" or "auto". `progress(done, total)` counts photons.

    Raises CutisError for layers that are not physical, among them a half space without absorption,
    in which photons stay for ever, and for a photon count below 1.
    """
    given = [np.asarray(v, dtype=np.float64) for v in (absorption, scattering, anisotropy, depth)]
    try:
        mu_a, mu_s, g, deep = np.broadcast_arrays(*given)
    except ValueError:
        shapes = ", ".join(str(v.shape) for v in given)
        raise CutisError(f"the properties of layers must fit together, not {shapes}") from None
    _check(mu_a, mu_s, g, deep, photons, seed, dimension, refractive_index)
    beam = beam_cosine(incidence) or 0.0
    stacks = _stacks(mu_a, mu_s, g, deep)
    own = _streams(streams, len(stacks))
    run = _runner(device)
    sums = np.zeros((len(stacks), stacks.shape[1] + 2))
    squares, key = np.zeros_like(sums), np.uint64(seed)
    done, total = 0, len(stacks) * photons
    for cases in _parts(len(stacks), CASES):
        count = len(own[cases])
        for part in _parts(photons, max(BATCH // (count * BLOCK), 1) * BLOCK):
            found = run(
                stacks[cases], own[cases], key, part.start, part.stop,
                dimension, float(refractive_index), beam,
            )  # fmt: skip
            for once, squared in zip(*found, strict=True):  # one order, however it was batched
                sums[cases] += once
                squares[cases] += squared
            done += count * (part.stop - part.start)
            if progress:
                progress(done, total)
    mean, error = _mean_and_error(sums, squares, photons)
    return Walk(
        mean[:, 0], mean[:, 1], mean[:, 2:], error[:, 0], error[:, 1], error[:, 2:], photons
    )


def walk_absorptions(
    epidermis_absorption: ArrayLike,
    dermis_absorption: ArrayLike,
    thickness: float,
    scattering: float,
    anisotropy: float,
    *,
    photons: int = PHOTONS,
    seed: int = 0,
    stream: int = 0,
    dimension: int = 2,
    incidence: float | str = "lambertian",
) -> tuple[Array, Array]:
    """Albedo (E, D) of epidermis over a semi-infinite dermis and its error, from one set of paths.

    As `two_layer_albedo` at one thickness (µm) and matched boundary. Photons walk once, under the
    least absorption of each layer; what each is worth under more follows from the length of its
    path in the two layers (Beer–Lambert). The errors of the E × D values are therefore alike:
    differences between skins are more precise than the skins. Raises CutisError as `walk_stacks`.
    """
    from cutis.transport.monte_carlo_kernel import absorptions_kernel

    epidermis, dermis = (
        np.atleast_1d(np.asarray(v, dtype=np.float64))
        for v in (epidermis_absorption, dermis_absorption)
    )
    if epidermis.ndim != 1 or dermis.ndim != 1 or not (epidermis.size and dermis.size):
        raise CutisError("absorptions of epidermis and of dermis must be lists of numbers")
    for values in (epidermis, dermis):  # the least is checked below
        if not np.all(np.isfinite(values)):
            raise CutisError("absorption and scattering must be finite, not negative")
    mu_a = np.array([[epidermis.min(), dermis.min()]])
    mu_s, g = np.full((1, 2), float(scattering)), np.full((1, 2), float(anisotropy))
    depth = np.array([[thickness * 1e-4, np.inf]])
    _check(mu_a, mu_s, g, depth, photons, seed, dimension, 1.0)
    beam = beam_cosine(incidence) or 0.0
    stack = _stacks(mu_a, mu_s, g, depth)[0]
    more = [(epidermis - mu_a[0, 0]), (dermis - mu_a[0, 1])]
    top, bottom = (extra / (least + scattering) for extra, least in zip(more, mu_a[0], strict=True))
    blocks = min(max((1 << 26) // (16 * top.size * bottom.size), 2), 64)  # some 64 MB of sums
    sums = np.zeros((top.size, bottom.size))
    squares = np.zeros_like(sums)
    for part in _parts(photons, blocks * BLOCK):
        count = -(-(part.stop - part.start) // BLOCK)
        partial, partial_squares = np.zeros((2, count, top.size, bottom.size))
        absorptions_kernel(
            count, stack, _streams([stream], 1)[0], np.uint64(seed), part.start, part.stop, BLOCK,
            dimension, beam, top, bottom, partial, partial_squares,
        )  # fmt: skip
        sums += partial.sum(axis=0)
        squares += partial_squares.sum(axis=0)
    return _mean_and_error(sums, squares, photons)


def _runner(device: str) -> Callable[..., tuple[Array, Array]]:
    """What walks some photons of some cases on `device`."""
    if device not in ("cpu", "cuda", "auto"):
        raise CutisError(f"device = {device!r}: it must be cpu, cuda or auto")
    if device != "cpu":
        from cutis.transport.monte_carlo_cuda import available, walk_cuda

        if available():
            return walk_cuda
        if device == "cuda":
            raise CutisError("no CUDA device was found; use device cpu")
    from cutis.transport.monte_carlo_kernel import walk_kernel

    def run(
        stacks: Array, streams: NDArray[np.uint64], key: np.uint64, first: int, stop: int,
        dimension: int, index: float, incidence: float,
    ) -> tuple[Array, Array]:  # fmt: skip
        blocks = -(-(stop - first) // BLOCK)
        sums, squares = np.zeros((2, blocks, len(stacks), stacks.shape[1] + 2))
        walk_kernel(
            blocks * len(stacks), stacks, streams, key, first, stop, BLOCK,
            dimension, index, incidence, sums, squares,
        )  # fmt: skip
        return sums, squares

    return run


def _stacks(mu_a: Array, mu_s: Array, g: Array, depth: Array) -> Array:
    """(n, L) properties → (n, L, 4) as `history.py` wants them."""
    total = mu_a + mu_s
    isotropic = np.abs(g) < 1e-6
    inverse = np.where(isotropic, 0.0, 0.5 / np.where(isotropic, 1.0, g))
    return np.ascontiguousarray(np.stack([depth * total, mu_a / total, g, inverse], axis=-1))


def _streams(streams: ArrayLike | None, count: int) -> NDArray[np.uint64]:
    if streams is None:
        return np.arange(count, dtype=np.uint64)
    own = np.asarray(streams)
    if own.shape != (count,) or own.dtype.kind not in "iu" or (own < 0).any():
        raise CutisError(f"streams must be {count} whole numbers, one per case and none negative")
    return own.astype(np.uint64)


def _parts(count: int, step: int) -> Iterator[slice]:
    for start in range(0, count, step):
        yield slice(start, min(start + step, count))


def _mean_and_error(sums: Array, squares: Array, photons: int) -> tuple[Array, Array]:
    """Mean of the photons' scores and its standard error; a single photon has no error: inf."""
    mean = sums / photons
    if photons == 1:
        return mean, np.full_like(mean, np.inf)
    variance = np.maximum(squares / photons - mean * mean, 0.0) * (photons / (photons - 1))
    return mean, np.sqrt(variance / photons)


def check_photons(photons: int, seed: int) -> None:
    """Raises CutisError unless so many photons can be walked from that seed."""
    if isinstance(photons, bool) or int(photons) != photons or not 1 <= photons <= MOST:
        raise CutisError(f"photons = {photons}: a walk needs a whole number from 1 to {MOST}")
    if int(seed) != seed or not 0 <= seed < 1 << 64:
        raise CutisError(f"seed = {seed}: it must be a whole number from 0 to 2⁶⁴ − 1")


def _check(
    mu_a: Array, mu_s: Array, g: Array, depth: Array,
    photons: int, seed: int, dimension: int, refractive_index: float
) -> None:  # fmt: skip
    """Raises CutisError unless photons can walk there."""
    if mu_a.ndim != 2 or not mu_a.size:
        raise CutisError("a walk needs at least one stack of at least one layer")
    if not np.all(np.isfinite(mu_a) & np.isfinite(mu_s) & (mu_a >= 0) & (mu_s >= 0)):
        raise CutisError("absorption and scattering must be finite, not negative")
    if np.any(mu_a + mu_s <= 0):
        raise CutisError("absorption and scattering of a layer must not both be zero")
    if not np.all(np.abs(g) < 1):
        raise CutisError("anisotropy must lie inside (-1, 1)")
    endless = np.isinf(depth)
    if not np.all(depth > 0) or np.any(endless[:, :-1]):
        raise CutisError("depths of layers must be positive, infinite in the last only")
    if np.any(endless & (mu_a == 0)):
        raise CutisError(
            "a half space that absorbs nothing keeps photons for ever; give it a depth"
        )
    check_photons(photons, seed)
    if dimension not in (2, 3):
        raise CutisError(f"dimension = {dimension}: it must be 2 (flatland) or 3")
    if not (np.isfinite(refractive_index) and refractive_index >= 1):
        raise CutisError(f"refractive_index = {refractive_index}: it must be 1 or more")
