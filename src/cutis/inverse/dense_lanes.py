"""A compiled block of a fully connected layer: a few outputs of many texels, kept in registers.

What limits a plain loop over outputs and inputs is reading and writing the sums. Here the sums of
OUTPUTS outputs of LANES texels stay in registers while the inputs pass by; each input is read once
for all of the outputs, each weight once for all of the texels.
"""

from collections.abc import Callable
from typing import Any

from llvmlite import binding, ir

from cutis.albedo.lanes import FLAGS, FLOAT, INDEX, LANE, pointer_to, shape_of, shuffle
from cutis.kernels.compiling import cgutils, intrinsic, types

OUTPUTS = 7
"""Outputs of a block: a divisor of the paper's 70."""
LANES = 32 if binding.get_host_cpu_features().get("avx512f") else 8
"""Texels of a block, so that OUTPUTS of them fit into the registers with something to spare."""


def _dense_block(
    typing: Any, weights: Any, biases: Any, block: Any, count: Any, source: Any, first: Any,
    out: Any
) -> Any:  # fmt: skip
    """Typing and code of `dense_block`."""
    vector = ir.VectorType(FLOAT, LANES)

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        weights_, biases_, block_, count_, source_, first_, out_ = values
        kind_w, kind_b, _, _, kind_s, _, kind_o = signature.args

        def scalar(kind: Any, array: Any, place: Any) -> Any:
            one = builder.load(pointer_to(context, builder, kind, array, place, 1), align=4)
            empty = ir.Constant(vector, ir.Undefined)
            value = builder.extract_element(one, ir.Constant(LANE, 0))
            spread = builder.insert_element(empty, value, ir.Constant(LANE, 0))
            return shuffle(builder, spread, [0] * LANES)

        def step(place: Any, k: int) -> Any:
            return builder.add(place, ir.Constant(INDEX, k))

        output = builder.mul(block_, ir.Constant(INDEX, OUTPUTS))
        sums = [cgutils.alloca_once(builder, vector) for _ in range(OUTPUTS)]
        for k, total in enumerate(sums):
            builder.store(scalar(kind_b, biases_, step(output, k)), total)
        rows = shape_of(context, builder, kind_w, weights_)[1]
        start = builder.mul(builder.mul(block_, rows), ir.Constant(INDEX, OUTPUTS))
        texels = shape_of(context, builder, kind_s, source_)[1]
        with cgutils.for_range(builder, count_, intp=INDEX) as loop:
            place = builder.add(builder.mul(loop.index, texels), first_)
            pointer = pointer_to(context, builder, kind_s, source_, place, LANES)
            values_ = builder.load(pointer, align=4)
            weight = builder.add(start, builder.mul(loop.index, ir.Constant(INDEX, OUTPUTS)))
            for k, total in enumerate(sums):
                product = builder.fmul(scalar(kind_w, weights_, step(weight, k)), values_, FLAGS)
                builder.store(builder.fadd(builder.load(total), product, FLAGS), total)
        width = shape_of(context, builder, kind_o, out_)[1]
        for k, total in enumerate(sums):
            place = builder.add(builder.mul(step(output, k), width), first_)
            pointer = pointer_to(context, builder, kind_o, out_, place, LANES)
            builder.store(builder.load(total), pointer, align=4)
        return context.get_dummy_value()

    signature = types.void(weights, biases, types.intp, types.intp, source, types.intp, out)
    return signature, code


dense_block: Callable[..., None] = intrinsic(_dense_block)
"""`dense_block(weights, biases, block, count, source, first, out)` inside compiled functions:
out[o, t] = biases[o] + Σ_i weights[block, i, o − OUTPUTS · block] · source[i, t] for i < `count`.

For the OUTPUTS o of `block` and LANES texels t from `first` on. `weights` (blocks, inputs,
OUTPUTS), `biases` (outputs,), `source` (inputs, texels), `out` (outputs, texels): C-contiguous
float32; nothing checks indices."""
