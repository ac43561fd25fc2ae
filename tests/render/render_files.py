"""Pictures and meshes as files, written by hand so that what they hold is known."""

import json
import struct
from pathlib import Path

import numpy as np
import OpenImageIO as oiio


def read_exr(path: Path) -> np.ndarray:
    """(H, W, C) float pixels."""
    pixels = oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)
    assert pixels.ndim == 3, path
    return pixels


def write_exr(path: Path, pixels: np.ndarray) -> Path:
    """(H, W, 3) float pixels as they are."""
    buffer = oiio.ImageBuf(oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, oiio.FLOAT))
    buffer.set_pixels(oiio.ROI(), np.ascontiguousarray(pixels, np.float32))
    assert buffer.write(str(path))
    return path


QUARTERS = np.array([[(0.8, 0.1, 0.1), (0.1, 0.8, 0.1)], [(0.1, 0.1, 0.8), (0.7, 0.7, 0.1)]])
"""Colours of a texture's quarters: upper left, upper right; lower left, lower right."""


# A square that looks towards +Z, the corners from the lower left, against the clock.
SQUARE = [(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)]
UVS = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]  # from the lower left

_CORNERS = [(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
CUBE = (
    _CORNERS,
    [(0.5 + 0.2 * x + 0.1 * z, 0.5 + 0.2 * y - 0.1 * z) for x, y, z in _CORNERS],
    [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)],
)
"""Points, texture coordinates and faces of a closed cube."""


def write_obj(path: Path, points=SQUARE, uvs=UVS, faces=((1, 2, 3, 4),)) -> Path:
    """An OBJ of polygons whose corners have the texture coordinates of the same number."""
    lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"vt {u} {v}" for u, v in uvs]
    for face in faces:
        lines.append("f " + " ".join(f"{i}/{i}" if uvs else f"{i}" for i in face))
    path.write_text("\n".join(lines) + "\n")
    return path


def write_glb(path: Path) -> Path:
    """The square as binary glTF, whose texture coordinates count from the upper left."""
    uvs = [(u, 1.0 - v) for u, v in UVS]
    data = np.array(SQUARE, "<f4").tobytes() + np.array(uvs, "<f4").tobytes()
    data += np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes()
    content = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2}]}
        ],
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 12},
        ],
        "accessors": [
            {
                **{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                **{"min": [-1, -1, 0], "max": [1, 1, 0]},
            },
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
    }
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return path


def write_usda(path: Path) -> Path:
    """The square as a text USD."""
    points = ", ".join(map(str, SQUARE))
    uvs = ", ".join(map(str, UVS))
    path.write_text(
        f"""#usda 1.0
(
    defaultPrim = "square"
    metersPerUnit = 0.01
    upAxis = "Y"
)
def Mesh "square"
{{
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [{points}]
    texCoord2f[] primvars:st = [{uvs}] (interpolation = "vertex")
    uniform token subdivisionScheme = "none"
}}
"""
    )
    return path
