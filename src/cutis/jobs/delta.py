"""What looks do to an albedo, as a few textures with weights that an engine drives.

A texture holds d = ln(edited / captured) of linear sRGB. With weights w in [0, 1] an engine shows

    albedo · exp(Σ w d),

which is the edit at w = 1 and the capture at w = 0. Between them it is near the edit of that
amount: light that goes through more of an absorber falls off by factors. deltas.json says how near.
"""

import contextlib
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from cutis.arrays import Map
from cutis.colour import delta_e
from cutis.errors import CutisError
from cutis.jobs.files import check_outputs, made_folder
from cutis.jobs.job import digest_of
from cutis.looks import Look, asked
from cutis.maps import Face, MapsFile, bound, find_source, open_source
from cutis.maps.estimating import Progress, nobody
from cutis.maps.face import Memo
from cutis.maps.skin_maps import Recolouring
from cutis.textures import channel_writer, replacing, sweep
from cutis.textures.udim import TOKEN, udim_tiles

DARKEST = 1e-4
"""Of linear colours, below which a ratio says nothing."""
FORMULA = "albedo * exp(sum of weight * delta), linear sRGB"


@dataclass(frozen=True)
class DeltaJob:
    """A texture for each of `looks` into a folder, NAME.delta.exr, half, and deltas.json.

    Of a UDIM set, `maps` and `source` hold <UDIM>, and there is one for each tile.
    """

    maps: Path
    folder: Path = field(metadata={"result": False})
    looks: tuple[Look, ...] = ()
    source: Path | None = None

    def __post_init__(self) -> None:
        if not self.looks:
            raise CutisError("nothing to export: give looks, --preset or parameter flags")
        if len(set(self._names())) < len(self.looks):
            raise CutisError("two looks have one name; give one of them another in its file")

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return digest_of(self)

    def _names(self) -> list[str]:
        titles = (look.name or "; ".join(look.words()) for look in self.looks)
        return [re.sub(r"[^\w.]+", "-", title).strip("-.")[:80] or "look" for title in titles]

    def run(self, progress: Progress = nobody) -> tuple[Path, ...]:
        """Writes the textures and their list; returns their names."""
        tiled = TOKEN in self.maps.name
        tiles = udim_tiles(self.maps) if tiled else {0: self.maps}
        memo, found, written = Memo(), [], list[Path]()
        with made_folder(self.folder):
            sweep(self.folder)
            for name, look in zip(self._names(), self.looks, strict=True):
                errors = np.zeros(0)
                ending = f".{TOKEN}.exr" if tiled else ".exr"
                for number, path in tiles.items():
                    output = self.folder / f"{name}.delta{ending}".replace(TOKEN, str(number))
                    parts = list(self._write(path, number, look, output, memo, progress))
                    errors = np.concatenate([errors, *parts])
                    written.append(output)
                found.append({
                    "name": look.name or name, "file": f"{name}.delta{ending}",
                    "half_way_delta_e": {
                        "mean": round(float(errors.mean()), 3) if len(errors) else 0.0,
                        "p95": round(float(np.quantile(errors, 0.95)), 3) if len(errors) else 0.0,
                    },
                })  # fmt: skip
            listed = self.folder / "deltas.json"
            with replacing(listed) as partial:
                text = json.dumps({"formula": FORMULA, "looks": found}, indent=1)
                partial.write_text(text + "\n", encoding="utf-8")
        return (*written, listed)

    def _write(
        self, path: Path, number: int, look: Look, output: Path, memo: Memo, progress: Progress
    ) -> Iterator[Map]:
        """Yields ΔE00 of changed texels at half of the amount, every fourth along a row."""
        with contextlib.ExitStack() as stack:
            maps = stack.enter_context(MapsFile(path))
            given = self.source and Path(str(self.source).replace(TOKEN, str(number)))
            capture = find_source(maps.provenance, path, given)
            check_outputs([output], {"the file of maps": path, "the capture": capture})
            texture = stack.enter_context(open_source(maps.provenance, capture))
            whole, half = (
                bound([asked(look, amount)], Face(maps, memo=memo)) for amount in (1, 0.5)
            )
            recolour = Recolouring(maps.made_by.load(), maps.header.calibration)
            put = stack.enter_context(channel_writer(output, ("R", "G", "B"), maps.shape, "half"))
            height, width = maps.shape
            for rows in texture.bands():
                light = texture.rows(rows).linear()
                which, edited = recolour(maps.edited(rows, whole, trust=False), light)
                before = np.maximum(light, DARKEST)
                delta = np.log(np.maximum(edited, DARKEST) / before)
                delta[~which] = 0
                put(dict(zip("RGB", np.moveaxis(delta.astype(np.float32), -1, 0), strict=True)))
                _, middle = recolour(maps.edited(rows, half, trust=False), light)
                some = np.flatnonzero(which)[::4]
                shown = light.reshape(-1, 3)[some] * np.exp(0.5 * delta.reshape(-1, 3)[some])
                yield delta_e(shown, middle.reshape(-1, 3)[some])
                progress(min(rows.stop, height) * width, height * width, output.name)
