"""Maps as a folder that a game's shader reads: one packed texture, the decoder, its numbers."""

import json
import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from cutis.albedo.colour_table import HALF, colour_table
from cutis.arrays import Map
from cutis.errors import CutisError
from cutis.inverse.shipped import TISSUE_OF
from cutis.inverse.table_export import table_bytes, table_glsl
from cutis.jobs.files import make_folder
from cutis.jobs.job import digest_of
from cutis.maps import MapsFile
from cutis.maps.estimating import Progress, nobody
from cutis.maps.skin_maps import SkinMaps
from cutis.maps.statistics import MapStatistics
from cutis.textures import channel_writer

ENGINES = ("game",)
"""What a folder can be made for."""
PACKED = """
// A texel of the packed texture, filtered or not, and the oxygenation of the whole face.
vec3 cutis_packed(vec4 texel, float oxygenation) {{
    vec2 squares = texel.rg * texel.rg;
    float thickness = {half:.1f} * texel.b / max(1.0 - texel.b, 1e-3);
    return cutis_albedo(squares.r * squares.r, squares.g * squares.g, thickness, texel.a,
                        oxygenation);
}}
"""
README = """\
# {name}, a skin for games

Written by cutis for shaders in GLSL 3.30, GLSL ES 3.00 or later.

- `{name}.packed.exr`: half floats, no colour, so turn sRGB off. R, G, B, A hold melanin^1/4,
  blood^1/4, thickness / (thickness + 60 um), eumelanin.
- `cutis.glsl`: `cutis_albedo` and `cutis_packed`; `cutis.table.f16`: their table. How it is loaded
  stands in the text.
- `{name}.json`: oxygenation of the whole face, and the gains of the capture: divide by them what
  the shader gives.
- Change a skin as `albedo * decoded(changed) / decoded(as it was)`: what maps do not explain stays.
- MIP levels of maps are not those of colour: prefer levels of the decoded colour where they matter.
"""


@dataclass(frozen=True)
class PackageJob:
    """Maps, and the folder that is made of them for one of ENGINES; it must not be there yet."""

    folder: Path = field(metadata={"result": False})
    engine: str
    maps: Path

    def __post_init__(self) -> None:
        if self.engine not in ENGINES:
            raise CutisError(f"--for {self.engine} is not known; known is {', '.join(ENGINES)}")
        if self.folder.exists():
            raise CutisError(f"{self.folder} is there already; give the name of a new folder")

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return digest_of(self)

    def run(self, progress: Progress = nobody) -> str:
        """Writes the folder, whole or not at all; returns what it is, in a few words."""
        with MapsFile(self.maps) as file:
            if file.header.model not in TISSUE_OF:
                raise CutisError(
                    f"{self.maps}: its maps are of {file.header.model}, whose decoder is no table; "
                    "estimate with the default"
                )
            work = self.folder.with_name(f".{self.folder.name}.part")
            shutil.rmtree(work, ignore_errors=True)
            make_folder(work)
            try:
                self._write(file, work, progress)
                work.rename(self.folder)
            except BaseException:
                shutil.rmtree(work, ignore_errors=True)
                raise
        return f"a skin for a {self.engine}, of {file.header.model}"

    def _write(self, file: MapsFile, folder: Path, progress: Progress) -> None:
        name, model = self.maps.name.partition(".")[0], file.made_by.load()
        found, height = MapStatistics(), file.shape[0]
        header: dict[str, Any] = {"colorspace": "data"}
        target = folder / f"{name}.packed.exr"
        with channel_writer(target, "RGBA", file.shape, "half", header) as put:
            for rows in file.bands():
                skin = file.rows(rows, trust=False)
                inside = skin.mask > 0
                found.add(skin.coordinates(), inside)
                put(packed(skin))
                progress(min(rows.stop, height), height, "packing")
        if not found.counts.any():
            raise file.no_mask()
        calibration = file.header.calibration
        text = table_glsl(f"The decoder of {model.name}, from cutis.", "cutis.table.f16")
        (folder / "cutis.glsl").write_text(text + PACKED.format(half=HALF), "utf-8")
        (folder / "cutis.table.f16").write_bytes(table_bytes(colour_table(model.tissue)))
        numbers = {
            "model": model.name,
            "oxygenation": round(float(found.percentiles()["oxygenation"][1]), 5),
            "gains": [round(float(gain), 6) for gain in calibration.gains],
        }
        (folder / f"{name}.json").write_text(json.dumps(numbers, indent=2) + "\n", "utf-8")
        (folder / "README.md").write_text(README.format(name=name), "utf-8")


def packed(skin: SkinMaps) -> dict[str, Map]:
    """Channels R, G, B, A of rows of maps, in coordinates that need no root to decode."""
    melanin, blood = (np.sqrt(np.sqrt(skin.map(name))) for name in ("melanin", "blood"))
    thickness = skin.map("thickness")
    return {
        "R": melanin, "G": blood, "B": thickness / (thickness + np.float32(HALF)),
        "A": skin.map("eumelanin"),
    }  # fmt: skip
