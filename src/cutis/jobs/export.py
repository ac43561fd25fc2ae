"""Edits and models for other programs: look-up tables and networks."""

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cutis.albedo.colour_table import colour_table
from cutis.colour import SRGB, Space
from cutis.errors import CutisError
from cutis.inverse import Calibration, Model
from cutis.inverse.network import Autoencoder
from cutis.inverse.onnx_export import decoder_onnx, encoder_onnx
from cutis.inverse.shader_export import decoder_glsl
from cutis.inverse.shipped import TISSUE_OF, networks
from cutis.inverse.table_export import table_bytes, table_glsl, table_onnx
from cutis.jobs.files import check_outputs
from cutis.jobs.job import digest_of
from cutis.looks import nothing
from cutis.luts import export_lut
from cutis.maps import Edits, Face, MapsFile, load_model
from cutis.maps.estimating import Progress, nobody
from cutis.textures import replacing, sweep

LUTS = (".cube", ".clf")
NETWORKS = (".onnx", ".glsl")
"""Extensions that a model's networks are written in."""


@dataclass(frozen=True)
class ExportJob:
    """An edit as NAME.cube or NAME.clf, or a model as decoder.onnx, decoder.glsl, encoder.onnx.

    `edits` are a look, or edits in order, `amount` (0–1) of them. A LUT has `size` nodes along a
    side and is for textures stored in `space`; `maps` is a file whose calibration and model it
    takes over, `model` another model. A decoder is that of the default, as ONNX or as GLSL with its
    table beside as NAME.table.f16; an encoder that of a model of networks.
    """

    output: Path = field(metadata={"result": False})
    edits: Edits = ()
    amount: float = 1.0
    size: int = 65
    space: Space = SRGB
    maps: Path | None = None
    model: Model | None = None

    def __post_init__(self) -> None:
        kind = self.output.suffix.lower()
        some = not nothing(self.edits)
        if kind in NETWORKS and (some or self.maps is not None):
            raise CutisError(f"{self.output} is for networks; edits are written as .cube or .clf")
        if kind not in (*LUTS, *NETWORKS):
            raise CutisError(
                f"{self.output}: a LUT is written as .cube or .clf, networks as .onnx or .glsl; "
                "end its name so"
            )
        if kind in LUTS and not some:
            raise CutisError(
                "nothing to export: give --look, --preset or a parameter flag such as --melanin x2"
            )

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return digest_of(self)

    def run(self, progress: Progress = nobody) -> str:
        """Writes the file; returns what it is, in a few words."""
        written = [self.output, self.data_file] if self.output.suffix.lower() == ".glsl" else [
            self.output
        ]  # fmt: skip
        check_outputs(written, {"the file of maps": self.maps})
        sweep(self.output.parent)
        progress(0, 1, f"writing {self.output.name}")
        kind = self.output.suffix.lower()
        said = self._decoder() if kind in NETWORKS else self._lut()
        progress(1, 1, f"writing {self.output.name}")
        return said

    def _lut(self) -> str:
        calibration, model = Calibration(), self.model
        with contextlib.ExitStack() as stack:
            face = None
            if self.maps is not None:
                file = stack.enter_context(MapsFile(self.maps))
                calibration, face = file.header.calibration, Face(file)
                model = model or file.made_by.load()
            title = export_lut(
                self.output, self.edits, self.space, self.size,
                model=model or load_model(), calibration=calibration, amount=self.amount,
                face=face,
            )  # fmt: skip
        return f"{title}, {self.size} nodes a side"

    def _decoder(self) -> str:
        """Writes the decoder of the default, or of another model of a table or of networks."""
        model = self.model or load_model()
        half = "encoder" if "encoder" in self.output.stem.lower() else "decoder"
        name, kind = Path(model.name).name, self.output.suffix.lower()
        if half == "encoder" and kind == ".glsl":
            raise CutisError(
                f"{self.output}: only the decoder is written as GLSL; the encoder as .onnx"
            )
        if model.name not in TISSUE_OF:
            return self._networks(networks(model.name), half, name)
        if half == "encoder":
            raise CutisError(
                f"{self.output}: the encoder of {name} is no network; write that of --model "
                "aliaga2022, or estimate maps with cutis"
            )
        table = colour_table(model.tissue)
        if kind == ".onnx":
            self._write({self.output: table_onnx(table)})
            return f"decoder of {name}"
        data = self.data_file
        text = table_glsl(f"The decoder of {name}, from cutis.", data.name)
        self._write({data: table_bytes(table), self.output: text.encode("utf-8")})
        return f"decoder of {name}, with its table in {data.name}"

    @property
    def data_file(self) -> Path:
        """Where the table lies that a shader of a table needs."""
        return self.output.with_suffix(".table.f16")

    def _networks(self, pair: Autoencoder, half: str, name: str) -> str:
        if self.output.suffix.lower() == ".onnx":
            content = encoder_onnx(pair) if half == "encoder" else decoder_onnx(pair)
        else:
            text = decoder_glsl(pair.decoder, f"The decoder of {name}, from cutis.")
            content = text.encode("utf-8")
        self._write({self.output: content})
        return f"{half} of {name}"

    def _write(self, contents: Mapping[Path, bytes]) -> None:
        with contextlib.ExitStack() as stack:
            for path, content in contents.items():
                stack.enter_context(replacing(path)).write_bytes(content)
