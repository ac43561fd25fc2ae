"""The decoder of a table for other programs: ONNX that is exact, GLSL that filters textures.

    RGB_c = Σ₁₆ upper(melanin, eumelanin, thickness) · lower_c(blood, oxygenation)

In ONNX the nodes around a skin are gathered and weighed by the quadratic B-splines of the library.
For shaders both factors are sampled at nodes, so that the hardware filters them between: four 3-D
textures and an array of twelve layers, four terms in each texel, half floats. A call costs 16
fetches.
"""

import numpy as np
from numpy.typing import NDArray

from cutis.albedo.colour_table import AXES, CELLS, ENDS, HALF, TERMS, ColourTable
from cutis.inverse.onnx_export import Graph
from cutis.kernels.splines import basis
from cutis.optics.parameters import NAMES, PARAMETERS

NODES = (97, 17, 57, 97, 25)
"""Nodes of the textures along melanin, eumelanin, thickness, blood and oxygenation."""

GLSL = """\
// {note}
// melanin, blood, eumelanin, oxygenation: fractions; thickness: micrometres. Gives linear sRGB.
// GLSL 3.30, GLSL ES 3.00 or later. The table lies beside this text in {data},
// little-endian half floats, RGBA, first axis fastest:
//   cutis_upper_0 to cutis_upper_3: 3-D textures of {m} x {e} x {t} texels (melanin, eumelanin,
//   thickness), {upper} bytes each, one after the other;
//   cutis_lower: then an array of 12 layers of {b} x {o} texels (blood, oxygenation), four layers
//   for each of red, green and blue.
// Filter linearly, clamp to the edge, no mipmaps, not sRGB.
uniform highp sampler3D cutis_upper_0;
uniform highp sampler3D cutis_upper_1;
uniform highp sampler3D cutis_upper_2;
uniform highp sampler3D cutis_upper_3;
uniform highp sampler2DArray cutis_lower;

vec3 cutis_albedo(float melanin, float blood, float thickness, float eumelanin,
                  float oxygenation) {{
    vec3 p = vec3({melanin},
                  {eumelanin},
                  {thickness});
    vec2 q = vec2({blood},
                  {oxygenation});
    vec3 size = vec3({m}.0, {e}.0, {t}.0);
    vec2 sides = vec2({b}.0, {o}.0);
    p = (clamp(p, 0.0, 1.0) * (size - 1.0) + 0.5) / size;
    q = (clamp(q, 0.0, 1.0) * (sides - 1.0) + 0.5) / sides;
    vec4 u0 = texture(cutis_upper_0, p);
    vec4 u1 = texture(cutis_upper_1, p);
    vec4 u2 = texture(cutis_upper_2, p);
    vec4 u3 = texture(cutis_upper_3, p);
    vec3 rgb;
    for (int c = 0; c < 3; c++) {{
        float layer = float(4 * c);
        rgb[c] = dot(u0, texture(cutis_lower, vec3(q, layer)))
               + dot(u1, texture(cutis_lower, vec3(q, layer + 1.0)))
               + dot(u2, texture(cutis_lower, vec3(q, layer + 2.0)))
               + dot(u3, texture(cutis_lower, vec3(q, layer + 3.0)));
    }}
    return rgb;
}}
"""


def table_onnx(table: ColourTable) -> bytes:
    """The decoder, `skin` (n, 5) → `rgb` (n, 3), as the bytes of an .onnx file."""
    graph = Graph()
    columns = graph.node("Split", ["skin"], 5, axis=1)
    places = [_place(graph, columns[PARAMETERS.index(p)], i) for i, p in enumerate(AXES)]
    above = _weighed(graph, "upper", table.upper[None], places[:3])
    rgb = []
    for channel, layer in zip("rgb", table.lower, strict=True):
        below = _weighed(graph, f"lower_{channel}", layer[None], places[3:])
        product = graph.add("Mul", above, below)
        (total,) = graph.node(
            "ReduceSum", [product, graph.integers(f"terms_{channel}", [1])], 1, keepdims=1
        )
        rgb.append(total)
    (value,) = graph.node("Concat", rgb, 1, axis=1)
    return graph.finish(value, ("skin", 5), ("rgb", 3), f"skin: {', '.join(NAMES)}")


def _place(graph: Graph, value: str, axis: int) -> tuple[str, list[str]]:
    """The cell (n, 1) of a parameter along its axis, whole, and the weights (n, 1) of its nodes."""
    name = AXES[axis].name
    low, high = ENDS[axis]
    if AXES[axis].name in ("melanin", "blood"):
        value = graph.add("Sqrt", graph.add("Sqrt", value))
    elif AXES[axis].name == "thickness":
        half = graph.constant("half_thickness", [HALF])
        value = graph.add("Div", value, graph.add("Add", value, half))
    value = graph.add("Sub", value, graph.constant(f"low_{name}", [low]))
    value = graph.add("Mul", value, graph.constant(f"scale_{name}", [CELLS[axis] / (high - low)]))
    value = graph.add("Max", value, graph.constant(f"first_{name}", [0]))
    value = graph.add("Min", value, graph.constant(f"end_{name}", [CELLS[axis]]))
    last = graph.constant(f"last_{name}", [CELLS[axis] - 0.5])
    cell = graph.add("Floor", graph.add("Min", value, last))
    f = graph.add("Sub", value, cell)
    one, a_half = graph.constant(f"one_{name}", [1]), graph.constant(f"a_half_{name}", [0.5])
    g = graph.add("Sub", one, f)
    outer = graph.add("Mul", a_half, graph.add("Mul", g, g))
    middle = graph.add("Add", a_half, graph.add("Mul", f, g))
    inner = graph.add("Mul", a_half, graph.add("Mul", f, f))
    return cell, [outer, middle, inner]


def _weighed(
    graph: Graph, name: str, nodes: NDArray[np.float32], places: list[tuple[str, list[str]]]
) -> str:
    """Terms (n, 16) of nodes (1, …, 16), weighed around their places."""
    shape = nodes.shape[1:-1]
    rows = graph.constant(name, nodes.reshape(-1, TERMS))
    strides = [int(np.prod(shape[i + 1 :])) for i in range(len(shape))]
    index = None
    for i, ((cell, _), stride) in enumerate(zip(places, strides, strict=True)):
        step = graph.add("Mul", cell, graph.constant(f"{name}_stride_{i}", [stride]))
        index = step if index is None else graph.add("Add", index, step)
    assert index is not None
    (index,) = graph.node("Cast", [index], 1, to=graph.onnx.TensorProto.INT64)
    (index,) = graph.node("Squeeze", [index, graph.integers(f"{name}_axis", [1])], 1)
    total = None
    for corner in np.ndindex(*(3,) * len(shape)):
        weight = None
        for (_, weights), k in zip(places, corner, strict=True):
            weight = weights[k] if weight is None else graph.add("Mul", weight, weights[k])
        assert weight is not None
        offset = sum(k * stride for k, stride in zip(corner, strides, strict=True))
        far = graph.integers(f"{name}_{'_'.join(map(str, corner))}", [offset])
        (found,) = graph.node("Gather", [rows, graph.add("Add", index, far)], 1, axis=0)
        part = graph.add("Mul", found, weight)
        total = part if total is None else graph.add("Add", total, part)
    assert total is not None
    return total


def table_textures(table: ColourTable) -> tuple[NDArray[np.float16], NDArray[np.float16]]:
    """`upper` (4, T, E, M, 4) and `lower` (12, O, B, 4) at the nodes, for textures."""
    at = [
        basis(np.linspace(0, 1, nodes), cells, degree=2)
        for nodes, cells in zip(NODES, CELLS, strict=True)
    ]
    above = np.einsum("am,be,ct,metr->cbar", *at[:3], table.upper, optimize=True)
    below = np.einsum("ab,do,cbor->cdar", *at[3:], table.lower, optimize=True)
    t, e, m, _ = above.shape
    upper = np.moveaxis(above.reshape(t, e, m, 4, 4), 3, 0)
    _, o, b, _ = below.shape
    lower = np.moveaxis(below.reshape(3, o, b, 4, 4), 3, 1).reshape(12, o, b, 4)
    return upper.astype(np.float16), lower.astype(np.float16)


def table_glsl(note: str, data: str) -> str:
    """`vec3 cutis_albedo(float melanin, …)` for the textures in a file called `data`.

    `note` is a line about where it comes from.
    """
    m, e, t, b, o = NODES
    places = {p.name: _unit(i) for i, p in enumerate(AXES)}
    return GLSL.format(note=note, data=data, m=m, e=e, t=t, b=b, o=o, upper=8 * m * e * t, **places)


def table_bytes(table: ColourTable) -> bytes:
    """The textures, one after the other, as `table_glsl` says."""
    upper, lower = table_textures(table)
    return upper.astype("<f2").tobytes() + lower.astype("<f2").tobytes()


def _unit(axis: int) -> str:
    """A parameter's place along its axis, 0 to 1, in its name."""
    name, (low, high) = AXES[axis].name, ENDS[axis]
    value = name
    if name in ("melanin", "blood"):
        value = f"sqrt(sqrt(max({name}, 0.0)))"
    elif name == "thickness":
        value = f"{name} / ({name} + {HALF:.1f})"
    return f"({value} - {low:.9f}) / {high - low:.9f}"
