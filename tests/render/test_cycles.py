"""What Cycles is fed, by what its walk returns."""

import numpy as np
import pytest
from scipy.stats import norm

from cutis.albedo import albedo_space
from cutis.errors import CutisError
from cutis.optics import ALIAGA2022
from cutis.render.cycles import (
    INDEX,
    METHOD,
    base_colour,
    facing,
    radius,
    seen_albedo,
    walked_albedo,
)
from cutis.render.cycles_process import render
from cutis.render.inversion import diffuse_albedo
from cutis.render.medium import mean_free_path
from cutis.render.published_fits import wrenninge2017
from cutis.render.scene import Scene
from cutis.textures import read_texture

LEVEL = 1e-3
"""Chance that a test over all tones fails by noise alone; fixed before the first run."""


@pytest.mark.parametrize("g", [0.0, 0.5, 0.8])
def test_colours_become_the_single_scattering_albedo_of_the_walk(g):
    albedo = np.linspace(0.003, 0.9, 200)
    alpha = wrenninge2017(base_colour(albedo, g), g)  # what Cycles makes of it
    np.testing.assert_allclose(walked_albedo(alpha, g), albedo, rtol=2e-3)


def test_the_walk_is_exact_where_cycles_has_no_habits():
    alpha = np.array([0.25, 0.5, 0.9, 0.97])
    np.testing.assert_allclose(walked_albedo(alpha), diffuse_albedo(alpha), rtol=1e-4)
    # below 0.2 it is proportional, and of white 8 % walks too long
    assert walked_albedo(0.1) == pytest.approx(0.5 * float(diffuse_albedo(0.2)))
    assert float(walked_albedo(1.0)) == pytest.approx(1 - 4 / np.sqrt(3 * np.pi * 255.5), abs=1e-4)


def test_radii_undo_the_dipole():
    """12 bisections of 0.5 α′ (1 + exp(−4 A s / 3)) exp(−s) = c, s = √(3 (1 − α′))."""
    colour = np.linspace(0.01, 0.7, 50).astype(np.float32)
    scale = 1 / radius(colour, 1.0)
    s = np.sqrt(3 * (1 - (1 - scale.astype(float) ** 2 / 3)))
    inverse = 1 / INDEX
    fresnel = inverse * (-1.44 * inverse + 0.71) + 0.668 + 0.0636 * INDEX
    depth = 4 / 3 * (1 + fresnel) / (1 - fresnel)
    reduced = 1 - s**2 / 3
    back = 0.5 * reduced * (1 + np.exp(-depth * s)) * np.exp(-s)
    np.testing.assert_allclose(back, colour, atol=6e-3)
    np.testing.assert_allclose(radius(colour, 2.0), 2 * radius(colour, 1.0), rtol=1e-6)


def test_facing_takes_back_what_depends_on_the_view():
    """At g = 0, for albedos from the darkest skin on and views up to 84°, by the solver.

    What is least well taken back lies near 0.04, where Cycles begins to scale.
    """
    k, h = facing()
    assert min(h) >= 0  # what a curve of Blender can hold
    assert max(h) == 1
    cosines = np.array([0.1, 0.2, 0.4, 0.7, 1.0])
    albedos = np.concatenate([np.linspace(0.004, 0.06, 57), np.linspace(0.07, 0.88, 28)])
    alpha, seen = seen_albedo(cosines)
    colour = base_colour(albedos)
    of_colour = np.interp(np.sqrt(colour), np.linspace(0, 1, len(h)), h)
    for cosine, row, most in zip(cosines, seen, (0.015, 0.01, 0.007, 0.005, 0.005), strict=True):
        fed = colour * (1 + np.polynomial.polynomial.polyval(cosine, k) * of_colour)
        found = np.interp(wrenninge2017(fed), alpha, row)
        np.testing.assert_allclose(found, albedos, rtol=most)


def test_single_precision_stays():
    assert base_colour(np.array([0.2, 0.5], np.float32)).dtype == np.float32


def test_values_out_of_range_are_refused():
    for bad in (-0.1, 1.1, np.nan):
        with pytest.raises(CutisError, match="0 to 1"):
            base_colour([0.5, bad])
    with pytest.raises(CutisError, match="anisotropy"):
        base_colour(0.5, -0.2)
    with pytest.raises(CutisError, match="anisotropy"):
        facing(0.95)


@pytest.mark.slow
def test_patches_of_skin_return_the_albedo_asked_for(blender, tmp_path):
    """24 skins from very light to very dark, square on: within 1 %, noise apart.

    Each of them, and in each channel all of the darker and of the lighter half together, whose
    noise is a tenth of a per cent. Lengths are five times as long as in skin so that Blender 4.2
    walks too.
    """
    melanin = (0.003, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.6)
    skins = [(m, b, 100.0, 0.7, 0.75) for m in melanin for b in (0.002, 0.02, 0.08)]
    tones = albedo_space(ALIAGA2022).rgb(np.array(skins))
    pictures = []
    for number, albedo in enumerate(tones):
        colour = base_colour(albedo)
        lengths = radius(colour, mean_free_path(ALIAGA2022))
        scene = Scene(
            mesh="patch", light="furnace", specular=0.0, denoise=False, width=40, height=40,
            samples=64, seed=number, method=METHOD, subsurface_ior=INDEX, facing=facing(),
            base_colour=tuple(map(float, colour)), radius=tuple(map(float, lengths)), scale=5.0,
            device="cpu",
        )  # fmt: skip
        pictures.append((scene, tmp_path / f"{number}.exr"))
    render(pictures, blender)
    pixels = np.stack([read_texture(path).linear().reshape(-1, 3) for _, path in pictures])
    off = pixels.mean(axis=1, dtype=float) / tones - 1
    error = pixels.std(axis=1, ddof=1, dtype=float) / np.sqrt(pixels.shape[1]) / tones
    assert (error > 0).all(), "no walk: the same light in all pixels"
    for channel, order in enumerate(np.argsort(tones, axis=0).T):
        for some in np.split(order, 2):
            weight = error[some, channel] ** -2
            together, noise = weight @ off[some, channel] / weight.sum(), weight.sum() ** -0.5
            assert noise < 0.002
            assert abs(together) < 0.01 + norm.isf(LEVEL / 12) * noise, (channel, together)
    beyond = (np.abs(off) - 0.01) / error
    assert beyond.max() < norm.isf(LEVEL / (2 * tones.size)), tones[beyond.max(axis=1).argmax()]
