"""Compiled sums of spline coefficients, several functions at once, one in each lane of a vector.

The last axis of a table runs over functions of the same cell; sums over the nodes around the cell
go along it with vectors. Compilers rarely find that form in nested loops, so it is written out as
LLVM instructions, which every processor has in some width. `tests/albedo/test_lanes.py` holds them
against NumPy.

Tables are C-contiguous float32; `weights` hold a tuple of float32 for each of the last axes before
the lanes, `cell` an index for each axis before the lanes, the first node of the cell where there
are weights. Nothing checks indices.
"""

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir

from cutis.kernels.compiling import cgutils, intrinsic, types

FLOAT, INDEX, LANE = ir.FloatType(), ir.IntType(64), ir.IntType(32)
FLAGS = ("fast",)


def pointer_to(context: Any, builder: Any, kind: Any, array: Any, place: Any, lanes: int) -> Any:
    """To `lanes` floats from element `place` of the array on."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [place]), ir.VectorType(FLOAT, lanes).as_pointer())


def shape_of(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    """Lengths of the array's axes."""
    return cgutils.unpack_tuple(builder, context.make_array(kind)(context, builder, array).shape)


def shuffle(builder: Any, vector: Any, lanes: Sequence[int]) -> Any:
    """The vector made of these lanes of `vector`."""
    mask = ir.Constant(ir.VectorType(LANE, len(lanes)), list(lanes))
    return builder.shuffle_vector(vector, ir.Constant(vector.type, ir.Undefined), mask)


def _spread(builder: Any, weights: Any, lanes: int) -> list[Any]:
    """Each weight of a tuple in all lanes."""
    empty = ir.Constant(ir.VectorType(FLOAT, lanes), ir.Undefined)
    first = ir.Constant(LANE, 0)
    vectors = [
        builder.insert_element(empty, w, first) for w in cgutils.unpack_tuple(builder, weights)
    ]
    return [shuffle(builder, vector, [0] * lanes) for vector in vectors]


def _across(builder: Any, vector: Any, lanes: int) -> Any:
    """Sum of the lanes, a power of two, by halves."""
    while lanes > 1:
        lanes //= 2
        low, high = (shuffle(builder, vector, range(k, k + lanes)) for k in (0, lanes))
        vector = builder.fadd(low, high, FLAGS)
    return builder.extract_element(vector, ir.Constant(LANE, 0))


def _around(
    context: Any, builder: Any, kind: Any, table: Any, cell: Any, weights: Any, lanes: int
) -> Any:
    """Σ w_p w_q … table[…, i + p, j + q, …] as a vector, innermost axis first."""
    shape = shape_of(context, builder, kind, table)
    corner = cgutils.unpack_tuple(builder, cell)
    spread = [_spread(builder, each, lanes) for each in cgutils.unpack_tuple(builder, weights)]
    bare = len(corner) - len(spread)

    def part(axis: int, place: Any) -> Any:
        if axis == len(corner):
            start = builder.mul(place, shape[-1])
            pointer = pointer_to(context, builder, kind, table, start, lanes)
            return builder.load(pointer, align=4, typ=ir.VectorType(FLOAT, lanes))
        node = builder.add(builder.mul(place, shape[axis]), corner[axis])
        if axis < bare:
            return part(axis + 1, node)
        total = None
        for step, weight in enumerate(spread[axis - bare]):
            inner = part(axis + 1, builder.add(node, ir.Constant(INDEX, step)))
            term = builder.fmul(weight, inner, FLAGS)
            total = term if total is None else builder.fadd(total, term, FLAGS)
        return total

    return part(0, ir.Constant(INDEX, 0))


def _indices(cell: Any) -> Any:
    return types.UniTuple(types.intp, len(cell))


def _spline_lanes(lanes: int) -> Callable[..., None]:
    @intrinsic
    def spline_lanes(typing: Any, table: Any, cell: Any, weights: Any, out: Any, row: Any) -> Any:
        """Writes the sum around `cell` into the first lanes of out[row]."""

        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            table_, cell_, weights_, out_, row_ = values
            kinds = signature.args
            total = _around(context, builder, kinds[0], table_, cell_, weights_, lanes)
            start = builder.mul(row_, shape_of(context, builder, kinds[3], out_)[-1])
            pointer = pointer_to(context, builder, kinds[3], out_, start, lanes)
            builder.store(total, pointer, align=4)
            return context.get_dummy_value()

        return types.void(table, _indices(cell), weights, out, types.intp), code

    return spline_lanes


def _spline_product(lanes: int) -> Callable[..., Any]:
    @intrinsic
    def spline_product(
        typing: Any, first: Any, cell: Any, weights: Any, second: Any, place: Any, others: Any
    ) -> Any:
        """Sum over lanes of the sum around `cell` of `first` times that around `place`."""

        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            first_, cell_, weights_, second_, place_, others_ = values
            kinds = signature.args
            a = _around(context, builder, kinds[0], first_, cell_, weights_, lanes)
            b = _around(context, builder, kinds[3], second_, place_, others_, lanes)
            return _across(builder, builder.fmul(a, b, FLAGS), lanes)

        signature = types.float32(first, _indices(cell), weights, second, _indices(place), others)
        return signature, code

    return spline_product


spline_lanes_8 = _spline_lanes(8)
spline_product_8 = _spline_product(8)
spline_product_16 = _spline_product(16)
