"""Two hundred looks of every kind: saved, loaded, applied, in bands; and what a schema says."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from cutis.looks import Look
from cutis.maps import Face, bound, estimate
from cutis.maps.face import Held, edited
from cutis.optics import NAMES, RARE_NAMES
from tests.looks.any_looks import looks, write_pictures

SCHEMA = Path(__file__).parents[2] / "docs" / "look.schema.json"
BANDS = (slice(0, 7), slice(7, 8), slice(8, 21), slice(21, 24))


@pytest.fixture(scope="module")
def skin(face_rgb, face_mask):
    return estimate(face_rgb, face_mask)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("looks")
    write_pictures(found)
    return found


@pytest.fixture(scope="module")
def published():
    return jsonschema.Draft202012Validator(json.loads(SCHEMA.read_text("utf-8")))


@settings(max_examples=200, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
@given(look=looks)
def test_they_survive_and_do_the_same_everywhere(look, skin, folder, published):
    look = look.model_copy(update={"tissue": None if look.tissue is None else tissue(skin)})
    path = folder / "any.look.json"
    path.write_text(look.document, encoding="utf-8")
    loaded = Look.load(path)
    assert loaded.layers == look.layers
    assert (loaded.name, loaded.note, loaded.amount) == (look.name, look.note, look.amount)
    published.validate(json.loads(path.read_text("utf-8")))
    loaded.save(folder / "again.look.json")
    again = Look.load(folder / "again.look.json")
    assert again == loaded

    one, other = skin.apply(loaded), skin.apply(again)
    face = Face(Held(skin))
    pieces = [edited(Held(skin), rows, bound([loaded], face)) for rows in BANDS]
    for name in (*NAMES, *RARE_NAMES):
        whole = one.maps[name]
        assert np.isfinite(whole).all()
        np.testing.assert_array_equal(other.maps[name], whole)
        np.testing.assert_array_equal(np.concatenate([p.maps[name] for p in pieces]), whole, name)
        assert not whole[skin.mask == 0].any()
    for name, sigma in one.sigmas.items():
        np.testing.assert_array_equal(np.concatenate([p.sigmas[name] for p in pieces]), sigma)


def tissue(skin):
    return skin.made_by.load().tissue.name


def test_the_schema_is_that_of_the_code():
    assert json.loads(SCHEMA.read_text("utf-8")) == Look.published(), (
        "python -m studies.look_schema makes it again"
    )
    jsonschema.Draft202012Validator.check_schema(Look.published())


@pytest.mark.parametrize(
    "document",
    [
        {"layers": []},
        {"cutis_look": 2},
        {"cutis_look": 1, "colour": 3},
        {"cutis_look": 1, "layers": [{"edits": [{"map": "melanin", "by": 2}]}]},
        {"cutis_look": 1, "layers": [{"edits": [{"do": "tint", "map": "melanin"}]}]},
        {"cutis_look": 1, "layers": [{"amount": 1.5}]},
        {"cutis_look": 1, "layers": [{"mask": [{"part": "strokes", "strokes": [{}]}]}]},
    ],
)
def test_the_schema_and_the_reader_refuse_the_same(document, published, tmp_path):
    from cutis.errors import CutisError

    assert not published.is_valid(document)
    (tmp_path / "a.look.json").write_text(json.dumps(document))
    with pytest.raises(CutisError):
        Look.load(tmp_path / "a.look.json")
