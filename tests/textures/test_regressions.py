"""Files that once went wrong: that crashed, printed, took memory, or came as what they are not.

`studies/fuzz.py` found most of them; what it finds next belongs here too. The first part
of a name is the format.
"""

from pathlib import Path

import pytest
from hostile.reader import Reader

FILES = sorted((Path(__file__).parent / "regressions").glob("*.bin"))
# What each is refused as, as a texture.
REFUSED = {
    "exr-escape-in-a-name": r"only R, G, \x1b",
    "exr-long-names": "…",
    "jpg-claims": "claims 16000 × 16000 texels",
    "jpg-progressive-claims": "claims 16000 × 16000 texels",
    "png-data-check": "cannot be unpacked",
    "png-distance": "cannot be unpacked",
    "png-filter": "unknown way",
    "png-header-invalid": "makes no sense",
    "png-header-twice": "twice",
    "png-no-data": "rows are missing",
    "png-no-palette": "palette is missing",
    "png-palette-twice": "twice",
    "png-stream-header": "cannot be unpacked",
    "png-too-little-data": "rows are missing",
    "psd-bit": "grey",
    "psd-cmyk": "CMYK",
    "psd-indexed": "palette",
    "psd-lab": "another colour model",
    "tif-packbits-claims": "claims 16000 × 16000 texels",
    "tif-planar-claims": "claims 12000 × 12000 texels",
    "tx-tile-claims": "claims tiles of 65535 × 34464 texels",
}
# What was no error at all: names that the library looks up, of another type than it thought.
READ = {
    "exr-chromaticities-are-a-number",
    "exr-colour-tag-is-no-text",
    "exr-photometric-is-text",
    "exr-profile-is-a-count",
    "exr-profile-is-a-number",
    "exr-profile-is-text",
    "png-colour-tag-is-no-text",
}
LITTLE = 400 << 20  # bytes, most of them the library's own


@pytest.fixture(scope="module")
def reader():
    reader = Reader()
    yield reader
    reader.close()


def test_every_file_is_listed():
    assert [path.stem for path in FILES] == sorted({*REFUSED, *READ})
    assert max(path.stat().st_size for path in FILES) < 10_000


@pytest.mark.parametrize("name", sorted({*REFUSED, *READ}))
def test_once_wrong(tmp_path, reader, name):
    content = next(path for path in FILES if path.stem == name).read_bytes()
    path = tmp_path / f"{name}.{name.split('-')[0]}"
    path.write_bytes(content)
    outcome = reader.read(path)
    assert outcome.findings == []
    assert outcome.good["texture"] == (name in READ)
    assert REFUSED.get(name, "") in outcome.results["texture"]
    assert outcome.memory < LITTLE
