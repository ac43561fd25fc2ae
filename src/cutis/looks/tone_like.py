"""Tones as people ask for them, other faces among them."""

from pathlib import Path

import numpy as np

from cutis.errors import CutisError
from cutis.looks.layer import Layer
from cutis.looks.look import Look
from cutis.looks.tone import Like, Tone, sampled, tone_of
from cutis.looks.tone_fit import spread_of
from cutis.looks.tone_path import tone_path
from cutis.maps import Face, MapsFile, SkinMaps
from cutis.maps.face import Held
from cutis.textures.udim import TOKEN, udim_tiles


def tone_look(wanted: str | SkinMaps) -> Look:
    """`ita:-20`, `monk:7`, `#8d5524`, `like:OTHER.skin.exr` or maps as a look of one layer."""
    if isinstance(wanted, SkinMaps):
        tone = Tone(like=like_skin(wanted))
    elif wanted.startswith("like:"):
        tone = Tone(like=like_file(Path(wanted.removeprefix("like:"))))
    else:
        tone = tone_of(wanted)
    return Look(layers=(Layer(edits=(tone,)),))


def like_file(path: Path) -> Like:
    """What is kept of the face of a file of maps, of all its tiles if it has some."""
    if TOKEN in path.name:
        path = next(iter(udim_tiles(path).values()))
    with MapsFile(path) as file:
        return _like(Face(file), str(path))


def like_skin(skin: SkinMaps) -> Like:
    """What is kept of a face in memory."""
    return _like(Face(Held(skin)), "the other face")


def _like(face: Face, name: str) -> Like:
    sample = sampled(face, Tone(ita=0))
    try:
        found = spread_of(sample, tone_path())
    except CutisError as error:
        raise CutisError(f"{name}: {error}") from error
    c = found.covariance
    red, green, blue = (float(v) for v in np.median(sample.colours[sample.skin], axis=0))
    rr, gg, bb, rg, rb, gb = (
        float(c[at]) for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    )
    return Like(median=(red, green, blue), spread=(rr, gg, bb, rg, rb, gb))
