"""The default decoder for other programs: ONNX Runtime, and GLSL in a headless browser."""

import base64

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from cutis.albedo import halton
from cutis.albedo.colour_table import AXES, ENDS, colour_table, to_axis
from cutis.colour import delta_e
from cutis.inverse.table_export import (
    NODES,
    table_bytes,
    table_glsl,
    table_onnx,
    table_textures,
)
from cutis.maps import load_model
from cutis.optics import MEASURED2026, PARAMETERS
from tests.inverse.webgl import needs_browser, said_by

WIDTH, HEIGHT = 500, 400
PAGE = """const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
const skins = new Float32Array(bytes("%(skins)s"));
const table = new Uint16Array(bytes("%(table)s"));
const [M, E, T, B, O] = %(nodes)s, W = %(width)d, H = %(height)d;
gl.attachShader(program, make(gl.FRAGMENT_SHADER, `#version 300 es
precision highp float; precision highp int;
uniform highp sampler2D skins; out vec4 colour;
%(glsl)s
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float s[5];
  for (int k = 0; k < 5; k++) s[k] = texelFetch(skins, ivec2(5 * at.x + k, at.y), 0).r;
  colour = vec4(cutis_albedo(s[0], s[1], s[2], s[3], s[4]), 1.0);
}`));
gl.linkProgram(program);
if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw gl.getProgramInfoLog(program);
gl.useProgram(program);
let unit = 0;
const bind = (kind, name, filter) => {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(kind, gl.createTexture());
  for (const p of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(kind, p, filter);
  for (const p of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R])
    gl.texParameteri(kind, p, gl.CLAMP_TO_EDGE);
  gl.uniform1i(gl.getUniformLocation(program, name), unit++);
};
bind(gl.TEXTURE_2D, "skins", gl.NEAREST);
gl.texStorage2D(gl.TEXTURE_2D, 1, gl.R32F, 5 * W, H);
gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 5 * W, H, gl.RED, gl.FLOAT, skins);
const size = 4 * M * E * T;
for (let i = 0; i < 4; i++) {
  bind(gl.TEXTURE_3D, "cutis_upper_" + i, gl.LINEAR);
  gl.texStorage3D(gl.TEXTURE_3D, 1, gl.RGBA16F, M, E, T);
  gl.texSubImage3D(gl.TEXTURE_3D, 0, 0, 0, 0, M, E, T, gl.RGBA, gl.HALF_FLOAT,
                   table.subarray(size * i, size * (i + 1)));
}
bind(gl.TEXTURE_2D_ARRAY, "cutis_lower", gl.LINEAR);
gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA16F, B, O, 12);
gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, 0, B, O, 12, gl.RGBA, gl.HALF_FLOAT,
                 table.subarray(4 * size));
const target = gl.createRenderbuffer(), frame = gl.createFramebuffer();
gl.bindRenderbuffer(gl.RENDERBUFFER, target);
gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, W, H);
gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, target);
gl.viewport(0, 0, W, H);
gl.drawArrays(gl.TRIANGLES, 0, 3);
const found = new Float32Array(4 * W * H);
gl.readPixels(0, 0, W, H, gl.RGBA, gl.FLOAT, found);
if (gl.getError()) throw "GL error";
let text = "";
const raw = new Uint8Array(found.buffer);
for (let i = 0; i < raw.length; i += 8190)
  text += btoa(String.fromCharCode(...raw.subarray(i, i + 8190)));
out.textContent = "found:" + text;
"""


@pytest.fixture(scope="module")
def skins():
    return halton(WIDTH * HEIGHT, 7).astype(np.float32)


@pytest.fixture(scope="module")
def wanted(skins):
    return load_model("measured2026").decode(skins)


@pytest.fixture(scope="module")
def table():
    return colour_table(MEASURED2026)


def test_onnx_runtime_gives_the_same(table, skins, wanted):
    pytest.importorskip("onnx", reason="the extra onnx is not installed")
    runtime = pytest.importorskip("onnxruntime", reason="the extra onnx is not installed")
    session = runtime.InferenceSession(table_onnx(table), providers=["CPUExecutionProvider"])
    np.testing.assert_allclose(session.run(None, {"skin": skins})[0], wanted, atol=5e-6)
    ends = np.float32([[p.low for p in PARAMETERS], [p.high for p in PARAMETERS]])
    far = np.concatenate([ends, 2 * ends[1:]])  # beyond the ends, what is at them
    np.testing.assert_allclose(
        session.run(None, {"skin": far})[0], table.rgb(far), atol=5e-6
    )  # fmt: skip


def test_the_textures_filtered_linearly(table, skins, wanted):
    """What a shader does, in NumPy: p99 of ΔE00 is at most 0.05."""
    upper, lower = table_textures(table)
    assert upper.nbytes + lower.nbytes == len(table_bytes(table)) == 3_240_576
    x = {}
    for axis, (known, (low, high)) in enumerate(zip(AXES, ENDS, strict=True)):
        place = to_axis(axis, skins[:, PARAMETERS.index(known)].astype(float))
        x[known.name] = (place - low) / (high - low) * (NODES[axis] - 1)
    above = [x["thickness"], x["eumelanin"], x["melanin"]]
    below = [x["oxygenation"], x["blood"]]

    def filtered(values, places):
        return map_coordinates(values.astype(float), places, order=1, mode="nearest")

    found = np.zeros_like(wanted, dtype=float)
    for term in range(16):
        u = filtered(upper[term // 4, ..., term % 4], above)
        for c in range(3):
            found[:, c] += u * filtered(lower[4 * c + term // 4, ..., term % 4], below)
    assert np.percentile(delta_e(found, wanted), 99) <= 0.05


@needs_browser
def test_a_browser_gives_the_same(table, skins, wanted, tmp_path):
    glsl = table_glsl("The decoder of measured2026, from cutis.", "decoder.table.f16")
    script = PAGE % {
        "skins": base64.b64encode(skins.astype("<f4").tobytes()).decode(),
        "table": base64.b64encode(table_bytes(table)).decode(),
        "nodes": list(NODES), "width": WIDTH, "height": HEIGHT, "glsl": glsl,
    }  # fmt: skip
    said = said_by(script, tmp_path, seconds=60)
    assert said.startswith("found:"), said[:500]
    found = np.frombuffer(base64.b64decode(said[6:]), "<f4").reshape(-1, 4)[:, :3]
    errors = delta_e(found, wanted)
    assert np.percentile(errors, 99) <= 0.05
    assert errors.max() < 0.5


def test_the_text_is_plain():
    glsl = table_glsl("The decoder of measured2026, from cutis.", "decoder.table.f16")
    assert glsl.isascii()
    assert max(map(len, glsl.splitlines())) <= 100
    assert "decoder.table.f16" in glsl
