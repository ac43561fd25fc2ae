"""GLSL in a headless browser: what pages of tests have in common."""

import html
import re
import shutil
import subprocess
from pathlib import Path

import pytest

BROWSER = next(
    (b for b in ("chromium", "chromium-browser", "google-chrome") if shutil.which(b)), ""
)
needs_browser = pytest.mark.skipif(not BROWSER, reason="no headless browser here to run GLSL in")

START = """<!doctype html><pre id="out">nothing</pre><script>
const out = document.getElementById("out");
try {
const gl = document.createElement("canvas").getContext("webgl2");
if (!gl || !gl.getExtension("EXT_color_buffer_float")) throw "no WebGL 2 with float targets";
const make = (type, text) => {
  const s = gl.createShader(type); gl.shaderSource(s, text); gl.compileShader(s);
  if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw "compile: " + gl.getShaderInfoLog(s);
  return s;
};
const program = gl.createProgram();
gl.attachShader(program, make(gl.VERTEX_SHADER, `#version 300 es
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3. : -1., gl_VertexID == 2 ? 3. : -1., 0., 1.);
}`));
"""
END = """
} catch (problem) { out.textContent = "failed: " + problem; }
</script>"""
"""A page is START, then a fragment shader of `program` and what is done with it, then END."""


def said_by(script: str, folder: Path, seconds: int) -> str:
    """What a page leaves in its text; skips where the browser has no WebGL 2."""
    page = folder / "page.html"
    page.write_text(START + script + END, "utf-8")
    flags = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--disable-dev-shm-usage"]
    flags += ["--enable-unsafe-swiftshader", f"--user-data-dir={folder / 'profile'}"]
    done = subprocess.run(
        [BROWSER, *flags, f"--virtual-time-budget={1000 * seconds}", "--dump-dom", page.as_uri()],
        capture_output=True, text=True, timeout=60 + 3 * seconds,
    )  # fmt: skip
    said = html.unescape(re.search(r'<pre id="out">(.*?)</pre>', done.stdout, re.S)[1])
    if said.startswith("failed: no WebGL"):
        pytest.skip("this browser has no WebGL 2 with float targets")
    return said
