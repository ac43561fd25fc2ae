"""Sums written out as vectors, for the two inner loops that compilers get wrong (decision 0025).

What is here are LLVM instructions, which every processor has in some width. Tables are C-contiguous
float32 and nothing checks indices. `tests/kernels/test_lanes.py` holds them against NumPy.
"""

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import binding, ir

from cutis.kernels.compiling import cgutils, intrinsic, types

FLOAT, INDEX, LANE = ir.FloatType(), ir.IntType(64), ir.IntType(32)
FLAGS = ("fast",)
OUTPUTS = 7
"""Outputs of a block of `dense_block`: a divisor of the paper's 70."""
LANES = 32 if binding.get_host_cpu_features().get("avx512f") else 8
"""Texels of it, so that OUTPUTS of them fit into the registers with something to spare."""


def _pointer(context: Any, builder: Any, kind: Any, array: Any, place: Any, lanes: int) -> Any:
    """To `lanes` floats from element `place` of the array on."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [place]), ir.VectorType(FLOAT, lanes).as_pointer())


def _shape(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    """Lengths of the array's axes."""
    return cgutils.unpack_tuple(builder, context.make_array(kind)(context, builder, array).shape)


def _spread(builder: Any, value: Any, lanes: int) -> Any:
    """A float in all lanes."""
    empty = ir.Constant(ir.VectorType(FLOAT, lanes), ir.Undefined)
    vector = builder.insert_element(empty, value, ir.Constant(LANE, 0))
    mask = ir.Constant(ir.VectorType(LANE, lanes), [0] * lanes)
    return builder.shuffle_vector(vector, empty, mask)


def _around(
    context: Any, builder: Any, kind: Any, table: Any, corner: Any, weights: Sequence[Any]
) -> Any:
    """Σ w_p w_q w_r table[i + p, j + q, k + r] as a vector of eight, innermost axis first."""
    shape = _shape(context, builder, kind, table)

    def part(axis: int, place: Any) -> Any:
        if axis == len(corner):
            pointer = _pointer(context, builder, kind, table, builder.mul(place, shape[-1]), 8)
            return builder.load(pointer, align=4, typ=ir.VectorType(FLOAT, 8))
        node = builder.add(builder.mul(place, shape[axis]), corner[axis])
        total = None
        for step, weight in enumerate(weights[axis]):
            inner = part(axis + 1, builder.add(node, ir.Constant(INDEX, step)))
            term = builder.fmul(weight, inner, FLAGS)
            total = term if total is None else builder.fadd(total, term, FLAGS)
        return total

    return part(0, ir.Constant(INDEX, 0))


def _sum_around(typing: Any, table: Any, cell: Any, weights: Any, out: Any, row: Any) -> Any:
    """Typing and code of `sum_around`."""

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        table_, cell_, weights_, out_, row_ = values
        kind, kind_out = signature.args[0], signature.args[3]
        spread = [
            [_spread(builder, w, 8) for w in cgutils.unpack_tuple(builder, each)]
            for each in cgutils.unpack_tuple(builder, weights_)
        ]
        corner = cgutils.unpack_tuple(builder, cell_)
        total = _around(context, builder, kind, table_, corner, spread)
        start = builder.mul(row_, _shape(context, builder, kind_out, out_)[-1])
        builder.store(total, _pointer(context, builder, kind_out, out_, start, 8), align=4)
        return context.get_dummy_value()

    indices = types.UniTuple(types.intp, len(cell))
    return types.void(table, indices, weights, out, types.intp), code


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
            one = builder.load(_pointer(context, builder, kind, array, place, 1), align=4)
            return _spread(builder, builder.extract_element(one, ir.Constant(LANE, 0)), LANES)

        def step(place: Any, k: int) -> Any:
            return builder.add(place, ir.Constant(INDEX, k))

        output = builder.mul(block_, ir.Constant(INDEX, OUTPUTS))
        sums = [cgutils.alloca_once(builder, vector) for _ in range(OUTPUTS)]
        for k, total in enumerate(sums):
            builder.store(scalar(kind_b, biases_, step(output, k)), total)
        rows = _shape(context, builder, kind_w, weights_)[1]
        start = builder.mul(builder.mul(block_, rows), ir.Constant(INDEX, OUTPUTS))
        texels = _shape(context, builder, kind_s, source_)[1]
        with cgutils.for_range(builder, count_, intp=INDEX) as loop:
            place = builder.add(builder.mul(loop.index, texels), first_)
            pointer = _pointer(context, builder, kind_s, source_, place, LANES)
            inputs = builder.load(pointer, align=4)
            weight = builder.add(start, builder.mul(loop.index, ir.Constant(INDEX, OUTPUTS)))
            for k, total in enumerate(sums):
                product = builder.fmul(scalar(kind_w, weights_, step(weight, k)), inputs, FLAGS)
                builder.store(builder.fadd(builder.load(total), product, FLAGS), total)
        width = _shape(context, builder, kind_o, out_)[1]
        for k, total in enumerate(sums):
            place = builder.add(builder.mul(step(output, k), width), first_)
            pointer = _pointer(context, builder, kind_o, out_, place, LANES)
            builder.store(builder.load(total), pointer, align=4)
        return context.get_dummy_value()

    signature = types.void(weights, biases, types.intp, types.intp, source, types.intp, out)
    return signature, code


sum_around: Callable[..., None] = intrinsic(_sum_around)
"""`sum_around(table, cell, weights, out, row)` inside compiled functions: the first eight of
out[row] = Σ w_p w_q w_r table[i + p, j + q, k + r] for `table` (a, b, c, 8), `cell` (i, j, k) and
`weights`, a tuple of as many float32 for each axis as there are nodes."""

dense_block: Callable[..., None] = intrinsic(_dense_block)
"""`dense_block(weights, biases, block, count, source, first, out)` inside compiled functions:
out[o, t] = biases[o] + Σ_i weights[block, i, o − OUTPUTS · block] · source[i, t] for i < `count`.

For the OUTPUTS o of `block` and LANES texels t from `first` on. `weights` (blocks, inputs,
OUTPUTS), `biases` (outputs,), `source` (inputs, texels), `out` (outputs, texels)."""
