"""The decoder network as a function of the OpenGL Shading Language.

The function is a loop over the weights, which stand before it as constants; a layer's bias is the
weight of an input that is always 1. Parameters come in their units, colour is linear sRGB.
"""

import numpy as np
from numpy.typing import NDArray

from cutis.inverse.network import HIDDEN, LAYERS, Perceptron
from cutis.optics.parameters import PARAMETERS

GLSL = """\
// {note}
// melanin, blood, eumelanin, oxygenation: fractions; thickness: micrometres. Gives linear sRGB.
// GLSL 3.30, GLSL ES 3.00 or later.
const vec4 CUTIS_WEIGHTS[{count}] = vec4[{count}](
{weights}
);

vec3 cutis_albedo(float melanin, float blood, float thickness, float eumelanin,
                  float oxygenation) {{
    vec4 x[{width}];
    vec4 y[{width}];
    for (int i = 0; i < {width}; i++) x[i] = vec4(0.0);
    x[0] = vec4({inputs[0]},
                {inputs[1]},
                {inputs[2]},
                {inputs[3]});
    x[1] = vec4({inputs[4]}, 1.0, 0.0, 0.0);
    int at = 0;
    for (int layer = 0; layer < {layers}; layer++) {{
        int columns = layer == 0 ? 2 : {width};
        int rows = layer == {last} ? 3 : {hidden};
        for (int i = 0; i < {width}; i++) y[i] = vec4(0.0, 0.0, 1.0, 0.0);  // input {hidden} is 1
        for (int row = 0; row < rows; row++) {{
            float sum = 0.0;
            for (int i = 0; i < columns; i++) sum += dot(CUTIS_WEIGHTS[at++], x[i]);
            if (layer == {last}) sum *= 0.5;  // 1 / (1 + exp(-s)) = (1 + tanh(s / 2)) / 2
            sum = 1.0 - 2.0 / (exp(2.0 * clamp(sum, -10.0, 10.0)) + 1.0);
            y[row / 4][row % 4] = sum;
        }}
        for (int i = 0; i < {width}; i++) x[i] = y[i];
    }}
    return 0.5 + 0.5 * x[0].xyz;
}}
"""


def decoder_glsl(decoder: Perceptron, note: str) -> str:
    """`vec3 cutis_albedo(float melanin, …)` with the weights of a decoder network.

    `note` is a line about where it comes from. A call costs 10 000 multiplications.
    """
    width = -(-(HIDDEN + 1) // 4)
    weights = []
    for weight, bias in zip(decoder.weights, decoder.biases, strict=True):
        rows, columns = weight.shape
        whole = np.zeros((rows, 8 if columns < HIDDEN else 4 * width), dtype=np.float32)
        whole[:, :columns], whole[:, columns] = weight, bias
        weights.append(whole.reshape(-1, 4))
    return GLSL.format(
        note=note,
        count=sum(len(w) for w in weights),
        weights=_vectors(np.concatenate(weights)),
        width=width,
        inputs=[_coordinate(i) for i in range(len(PARAMETERS))],
        layers=LAYERS,
        last=LAYERS - 1,
        hidden=HIDDEN,
    )


def _vectors(values: NDArray[np.float32]) -> str:
    # nine digits hold a float32; the exponent form is a float to every compiler
    return ",\n".join(f"vec4({', '.join(f'{v:.8e}' for v in row)})" for row in values)


def _coordinate(index: int) -> str:
    """A parameter's network coordinate in its name (`optics.Parameter.to_coordinate`)."""
    known = PARAMETERS[index]
    low, high = known.low ** (1 / known.root), known.high ** (1 / known.root)
    root = known.name if known.root == 1 else f"pow(max({known.name}, 0.0), {1 / known.root:.9f})"
    return f"({root} - {low:.9f}) / {high - low:.9f}"
