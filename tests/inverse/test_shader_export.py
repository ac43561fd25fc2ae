"""The decoder as GLSL: run by a headless browser's WebGL, compiled as C++, and read by NumPy."""

import json
import re
import shutil
import subprocess

import numpy as np
import pytest

from cutis.albedo import halton
from cutis.inverse.shader_export import decoder_glsl
from cutis.inverse.shipped import networks
from cutis.maps import load_model
from cutis.optics import to_coordinates
from tests.inverse.webgl import needs_browser, said_by

COMPILER = next((c for c in ("g++", "clang++", "c++") if shutil.which(c)), "")

PAGE = """const skins = %(skins)s, n = skins.length / 5;
gl.attachShader(program, make(gl.FRAGMENT_SHADER, `#version 300 es
precision highp float; precision highp int; precision highp sampler2D;
uniform sampler2D skins; out vec4 colour;
` + %(glsl)s + `
void main() {
  int i = int(gl_FragCoord.x);
  float s[5];
  for (int k = 0; k < 5; k++) s[k] = texelFetch(skins, ivec2(k, i), 0).r;
  colour = vec4(cutis_albedo(s[0], s[1], s[2], s[3], s[4]), 1.0);
}`));
gl.linkProgram(program);
if (!gl.getProgramParameter(program, gl.LINK_STATUS))
  throw "link: " + gl.getProgramInfoLog(program);
gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
gl.texStorage2D(gl.TEXTURE_2D, 1, gl.R32F, 5, n);
gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 5, n, gl.RED, gl.FLOAT, new Float32Array(skins));
for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
  gl.texParameteri(gl.TEXTURE_2D, which, gl.NEAREST);
const target = gl.createRenderbuffer(), frame = gl.createFramebuffer();
gl.bindRenderbuffer(gl.RENDERBUFFER, target);
gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, n, 1);
gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, target);
gl.viewport(0, 0, n, 1);
gl.useProgram(program);
gl.drawArrays(gl.TRIANGLES, 0, 3);
const found = new Float32Array(4 * n);
gl.readPixels(0, 0, n, 1, gl.RGBA, gl.FLOAT, found);
if (gl.getError()) throw "GL error";
out.textContent = JSON.stringify(Array.from(found));
"""

SHIM = """
#include <algorithm>
#include <cmath>
#include <cstdio>
using std::max; using std::exp; using std::pow;
struct vec3 { float x, y, z; };
struct vec4 {
    float v[4]; vec3 xyz_() const { return {v[0], v[1], v[2]}; }
    vec4() : v{0, 0, 0, 0} {}
    vec4(float a) : v{a, a, a, a} {}
    vec4(float a, float b, float c, float d) : v{a, b, c, d} {}
    float& operator[](int i) { return v[i]; }
};
static float dot(const vec4& a, const vec4& b) {
    return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2] + a.v[3] * b.v[3];
}
static float clamp(float x, float low, float high) { return std::min(std::max(x, low), high); }
static vec3 operator*(float s, vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
static vec3 operator+(float s, vec3 a) { return {s + a.x, s + a.y, s + a.z}; }
static float max(float a, double b) { return a > b ? a : float(b); }
"""
MAIN = """
int main() {
    float s[5];
    while (std::scanf("%f %f %f %f %f", s, s + 1, s + 2, s + 3, s + 4) == 5) {
        vec3 c = cutis_albedo(s[0], s[1], s[2], s[3], s[4]);
        std::printf("%.9g %.9g %.9g\\n", c.x, c.y, c.z);
    }
}
"""


@pytest.fixture(scope="module")
def glsl():
    return decoder_glsl(networks("aliaga2022").decoder, "The decoder of aliaga2022, from cutis.")


@pytest.fixture(scope="module")
def skins():
    return halton(256, 7).astype(np.float32)


@pytest.fixture(scope="module")
def wanted(skins):
    return load_model("aliaga2022").decode(skins)


@needs_browser
def test_a_browser_gives_the_same(glsl, skins, wanted, tmp_path):
    values = [float(v) for v in skins.ravel()]
    script = PAGE % {"skins": json.dumps(values), "glsl": json.dumps(glsl)}
    said = said_by(script, tmp_path, seconds=20)
    assert said.startswith("["), said[:500]
    found = np.array(json.loads(said)).reshape(-1, 4)[:, :3]
    np.testing.assert_allclose(found, wanted, atol=1e-5)


@pytest.mark.skipif(not COMPILER, reason="no C++ compiler here to compile GLSL with")
def test_a_compiler_gives_the_same(glsl, skins, wanted, tmp_path):
    text = re.sub(r"= vec4\[\d+\]\((.*?)\n\);", r"= {\1};", glsl, flags=re.S)
    text = text.replace(".xyz", ".xyz_()").replace("const vec4 CUTIS", "static vec4 CUTIS")
    text = re.sub(r"(\d\.\d+(?:e[+-]\d+)?)", r"\1f", text)
    (tmp_path / "a.cpp").write_text(SHIM + text + MAIN, "utf-8")
    subprocess.run(
        [COMPILER, "-std=c++17", "-O1", "-o", tmp_path / "a", tmp_path / "a.cpp"], check=True
    )
    lines = "\n".join(" ".join(f"{v:.9g}" for v in row) for row in skins)
    out = subprocess.run([tmp_path / "a"], input=lines, capture_output=True, text=True, check=True)
    found = np.array([[float(v) for v in line.split()] for line in out.stdout.splitlines()])
    np.testing.assert_allclose(found, wanted, atol=1e-5)


def test_the_constants_are_the_weights(glsl, skins, wanted):
    """The vectors as the text has them, through the network as the text describes it."""
    rows = re.findall(r"^vec4\((.*?)\),?$", glsl, re.M)
    flat = np.array([[float(v) for v in row.split(",")] for row in rows]).ravel()
    assert f"CUTIS_WEIGHTS[{len(rows)}]" in glsl
    x, at = to_coordinates(skins.astype(np.float64)), 0
    for outputs, width in ((70, 8), (70, 72), (70, 72), (3, 72)):
        weight = flat[at : at + outputs * width].reshape(outputs, width)
        at += weight.size
        inputs = np.zeros((len(x), width))
        inputs[:, : x.shape[1]], inputs[:, x.shape[1]] = x, 1
        x = inputs @ weight.T
        x = np.tanh(x) if outputs == 70 else 1 / (1 + np.exp(-x))
    assert at == flat.size
    np.testing.assert_allclose(x, wanted, atol=1e-5)


def test_the_text_is_plain(glsl):
    assert glsl.isascii()
    assert max(map(len, glsl.splitlines())) <= 100
    assert len([line for line in glsl.splitlines() if not line.startswith("vec4")]) < 40
