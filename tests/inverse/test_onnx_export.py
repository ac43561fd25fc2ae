"""The networks as ONNX, run by ONNX Runtime."""

import numpy as np
import pytest

from cutis.albedo import halton
from cutis.inverse.onnx_export import decoder_onnx, encoder_onnx
from cutis.inverse.shipped import networks
from cutis.maps import load_model
from cutis.optics import to_coordinates

onnx = pytest.importorskip("onnx", reason="the extra onnx is not installed")
runtime = pytest.importorskip("onnxruntime", reason="the extra onnx is not installed")


@pytest.fixture(scope="module")
def skins():
    return halton(3000, 5).astype(np.float32)


def run(content: bytes, **inputs):
    session = runtime.InferenceSession(content, providers=["CPUExecutionProvider"])
    return session.run(None, inputs)[0]


def test_the_decoder_is_the_librarys(skins):
    found = run(decoder_onnx(networks("aliaga2022")), skin=skins)
    np.testing.assert_allclose(found, load_model("aliaga2022").decode(skins), atol=1e-5)


def test_the_encoder_is_the_librarys(skins):
    model = load_model("aliaga2022")
    rgb = model.decode(skins)
    found = run(encoder_onnx(networks("aliaga2022")), rgb=rgb)
    np.testing.assert_allclose(to_coordinates(found), to_coordinates(model.encode(rgb)), atol=1e-5)


def test_one_skin_and_none(skins):
    content = decoder_onnx(networks("aliaga2022"))
    assert run(content, skin=skins[:1]).shape == (1, 3)
    assert run(content, skin=skins[:0]).shape == (0, 3)


def test_the_file_says_what_goes_in():
    model = onnx.load_from_string(decoder_onnx(networks("aliaga2022")))
    assert model.graph.doc_string == "skin: melanin, blood, thickness, eumelanin, oxygenation"
    assert [i.name for i in model.graph.input] == ["skin"]
    assert [o.name for o in model.graph.output] == ["rgb"]
