"""Whole small files that are no pictures: tables, cubes, lists, configurations of colour.

Some come in pairs, NAME.hdr and NAME.img: what is not damaged stays beside what is.
"""

from pathlib import Path

import numpy as np

BANDS = np.arange(400, 701, 30)
_SKINS = np.array([0.05 + 0.5 * (BANDS - 380) / 400, 0.03 + 0.3 * ((BANDS - 380) / 400) ** 2])

CONFIG = """ocio_profile_version: 2
search_path: ""
roles: {aces_interchange: reference, default: reference}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  screen:
    - !<View> {name: Raw, colorspace: reference}
colorspaces:
  - !<ColorSpace> {name: reference}
  - !<ColorSpace>
    name: cam
    to_scene_reference: !<FileTransform> {src: "%s"}
  - !<ColorSpace>
    name: power
    to_scene_reference: !<ExponentTransform> {value: [2.2, 2.2, 2.2, 1]}
  - !<ColorSpace>
    name: group
    to_scene_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {matrix: [0.9, 0.1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}
        - !<LogAffineTransform> {base: 10, log_side_slope: 0.25, direction: inverse}
"""
_LOOKUPS = {
    "a.cube": "LUT_3D_SIZE 2\n" + "\n".join(
        f"{r} {g} {b}" for b in (0, 1) for g in (0, 1) for r in (0, 1)
    ),
    "b.spi1d": "Version 1\nFrom 0.0 1.0\nLength 3\nComponents 1\n{\n0.0\n0.2\n1.0\n}\n",
    "c.spi3d": "SPILUT 1.0\n3 3\n2 2 2\n" + "\n".join(
        f"{r} {g} {b} {r} {g} {b}" for r in (0, 1) for g in (0, 1) for b in (0, 1)
    ),
    "d.clf": '<?xml version="1.0"?>\n<ProcessList id="a" compCLFversion="3.0">'
    '<Range inBitDepth="32f" outBitDepth="32f"><minInValue>0</minInValue><maxInValue>1</maxInValue>'
    "<minOutValue>0</minOutValue><maxOutValue>1</maxOutValue></Range>"
    '<LUT1D inBitDepth="32f" outBitDepth="32f"><Array dim="3 1">0 0.3 1</Array></LUT1D>'
    "</ProcessList>\n",
    "e.csp": "CSPLUTV100\n1D\n\n2\n0 1\n0 1\n2\n0 1\n0 1\n2\n0 1\n0 1\n\n2\n0 0 0\n1 1 1\n",
}  # fmt: skip


def other_seeds(folder: Path) -> list[Path]:
    """Writes all into `folder`, some of them in folders of their own; the same every time."""
    folder.mkdir(parents=True, exist_ok=True)
    return [*_tables(folder), *_envi(folder), *_arrays(folder), *_configurations(folder),
            *_documents(folder)]  # fmt: skip


def _text(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def _rows(between: str = ",", head: str = "{}", cell: str = "{:.4f}", scale: float = 1) -> str:
    lines = [between.join(["site", *(head.format(b) for b in BANDS)])]
    for name, values in zip(("arm", "cheek"), _SKINS, strict=True):
        lines.append(between.join([name, *(cell.format(scale * v) for v in values)]))
    return "\n".join(lines) + "\n"


def _columns(between: str = ",", axis: str = "wavelength_nm") -> str:
    lines = [between.join([axis, "arm", "cheek"])]
    lines += [between.join([f"{b}", *(f"{v[i]:.4f}" for v in _SKINS)]) for i, b in enumerate(BANDS)]
    return "\n".join(lines) + "\n"


def _tables(folder: Path) -> list[Path]:
    fields = "\t".join(["SAMPLE_ID", *(f"SPECTRAL_NM_{b}" for b in BANDS)])
    data = "\n".join("\t".join([f'"s{i}"', *(f"{v:.4f}" for v in s)]) for i, s in enumerate(_SKINS))
    tables = {
        "rows.csv": _rows(),
        "columns.csv": "# made\n" + _columns(),
        "semicolons.csv": "sep=;\n" + _rows(";").replace(".", ","),
        "tabs.tsv": _columns("\t", "Wavelength (nm)"),
        "percent.csv": "Instrument,CM-700d\n" + _rows(head="R%_{}", scale=100),
        "units.csv": _columns(axis="Wavelength").replace("\n", "\nnm,1,1\n", 1),
        "ocean.txt": "SpectraSuite Data File\n++++\n>>>>>Begin Processed Spectral Data<<<<<\n"
        + "\n".join(f"{b:.2f}\t{100 * v:.3f}" for b, v in zip(BANDS, _SKINS[0], strict=True))
        + "\n>>>>>End Processed Spectral Data<<<<<\n",
        "cgats.txt": f"CGATS.17\nBEGIN_DATA_FORMAT\n{fields}\nEND_DATA_FORMAT\n"
        f"BEGIN_DATA\n{data}\nEND_DATA\n",
        "skins.csv": "note,melanin,blood,thickness\narm,0.02,0.01,80\n=x,0.03,0.02,90\n",
        "list.txt": "\n".join(map(str, BANDS)),
    }  # fmt: skip
    return [_text(folder / name, text) for name, text in tables.items()]


def _envi(folder: Path) -> list[Path]:
    found = []
    cube = np.tile(_SKINS, (3, 1, 1))
    for number, (order, kind, axes) in enumerate(
        (("bsq", "<f4", (2, 0, 1)), ("bil", ">u2", (0, 2, 1)), ("bip", "<f8", (0, 1, 2)))
    ):
        scale = 10000 if "u" in kind else 1
        values = np.ascontiguousarray((cube * scale).transpose(axes)).astype(kind)
        (folder / f"cube{number}.img").write_bytes(values.tobytes())
        code = {"<f4": 4, ">u2": 12, "<f8": 5}[kind]
        found.append(folder / f"cube{number}.img")
        found.append(
            _text(folder / f"cube{number}.hdr", _header(order, code, kind[0] == ">", scale))
        )
    (folder / "lib.sli").write_bytes(_SKINS.astype("<f4").tobytes())
    library = _header("bsq", 4, False, 1).replace("lines = 3", "lines = 2")
    library = library.replace("samples = 2", f"samples = {len(BANDS)}")
    library = library.replace(f"bands = {len(BANDS)}", "bands = 1")
    library += "file type = ENVI Spectral Library\nspectra names = {arm, cheek}\n"
    return [*found, folder / "lib.sli", _text(folder / "lib.hdr", library)]


def _header(order: str, code: int, big: bool, scale: int) -> str:
    listed = ",\n ".join(map(str, BANDS))
    return (
        f"ENVI\ndescription = {{a cube}}\nsamples = 2\nlines = 3\nbands = {len(BANDS)}\n"
        f"header offset = 0\ndata type = {code}\ninterleave = {order}\nbyte order = {int(big)}\n"
        f"reflectance scale factor = {scale}\ndata ignore value = -1\n"
        f"wavelength units = Nanometers\nwavelength = {{{listed}}}\n"
        f"bbl = {{{', '.join('1' for _ in BANDS)}}}\n"
    )


def _arrays(folder: Path) -> list[Path]:
    cube = np.tile(_SKINS, (3, 1, 1)).astype(np.float32)
    arrays = {
        "plain.npy": cube,
        "fortran.npy": np.asfortranarray(cube),
        "first.npy": np.moveaxis(cube, 2, 0).astype(np.uint16),
        "flat.npy": _SKINS,
    }
    for name, values in arrays.items():
        np.save(folder / name, values)
        np.save((folder / name).with_suffix(".wavelengths.npy"), BANDS.astype(float))
    return [folder / name for name in arrays]


def _configurations(folder: Path) -> list[Path]:
    found = []
    for name, text in _LOOKUPS.items():
        inside = folder / f"show-{name[0]}"
        inside.mkdir()
        found += [_text(inside / name, text), _text(inside / "show.ocio", CONFIG % name)]
    return found


def _documents(folder: Path) -> list[Path]:
    """JSON: a report, a look, and the note of a simulation that was stopped."""
    report = """{"model": "measured2026", "size": [48, 64], "masked_texels": 3072,
"calibration": {"gains": [0.88, 1.0, 1.05], "origin": "auto", "illuminant": "D65"},
"files": ["a.skin.exr"], "made_from": {"asked": {"white": "none"}, "content": {"capture": "00"}}}"""
    look = """{"cutis_look": 1, "name": "a", "note": "", "tissue": null, "amount": 0.5, "layers":
[{"amount": 1.0, "edits": [{"map": "melanin", "areas": "all", "do": "multiply", "by": 1.4},
{"map": "melanin", "do": "set", "to": 0.001}], "mask": [{"part": "patches"}]}]}"""
    note = """{"skins": [[0.02, 0.02, 80, 0.7, 0.7]], "photons": 10, "seed": 0, "batches": 1}"""
    written = []
    for name, text in (("a.report", report), ("b.look", look), ("run", note)):
        written.append(_text(folder / f"{name}.json", text))
    return written
