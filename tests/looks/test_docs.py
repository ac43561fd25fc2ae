"""The examples of docs/looks.md run."""

import json
import re
from pathlib import Path

import pytest

import cutis
from cutis.errors import CutisError
from cutis.looks import Look

PAGE = (Path(__file__).parents[2] / "docs" / "looks.md").read_text("utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def test_the_document_and_python(face_rgb, tmp_path, monkeypatch, write_face):
    monkeypatch.chdir(tmp_path)
    write_face(tmp_path)
    Path("out").mkdir()
    skin = cutis.estimate(cutis.read("face.png"))
    skin.save("out/face.skin.exr")
    (document,) = blocks("json")
    look = json.loads(document)
    look["tissue"] = skin.made_by.load().tissue.name  # the page names that of the default
    Path("spring.look.json").write_text(json.dumps(look))
    assert skin.apply(Look.load("spring.look.json")).edits
    assert len(blocks("python")) == 2
    for code in blocks("python"):
        exec(compile(code, "looks.md", "exec"), {})
    assert Look.load("rouge.look.json").as_json()["layers"][0]["mask"][0]["part"] == "strokes"


def test_the_tissue_of_the_page_is_that_of_the_default():
    (document,) = blocks("json")
    assert json.loads(document)["tissue"] == cutis.load_model().tissue.name


def test_the_message(tmp_path):
    stroke = {"points": [[0.5, 0.5]], "radius": 0}
    good = {**stroke, "radius": 0.1}
    layers = [{}, {"name": "rouge", "mask": [{"part": "strokes", "strokes": [good, stroke]}]}]
    (tmp_path / "a.look.json").write_text(json.dumps({"cutis_look": 1, "layers": layers}))
    with pytest.raises(CutisError) as caught:
        Look.load(tmp_path / "a.look.json")
    assert str(caught.value).replace(f"{tmp_path}/", "cutis: ") in PAGE
