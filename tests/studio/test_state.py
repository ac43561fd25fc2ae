"""What pages do to a look; two of them at once lose nothing of each other's."""

import pytest
from pydantic import TypeAdapter

from cutis.errors import CutisError
from cutis.studio.state import AnyOp, empty

OPS = TypeAdapter(AnyOp)


def do(state, **op):
    return state.after(OPS.validate_python(op))


def melanin(by):
    return {"do": "multiply", "map": "melanin", "by": by}


@pytest.fixture
def state():
    return do(empty(), op="add", layers=[{"name": "two"}, {"name": "three"}])


def names(state):
    return [layer.name for layer in state.look.layers]


def test_layers_are_added_moved_doubled_and_removed(state):
    assert names(state) == ["Skin", "two", "three"]
    first, second, third = state.ids
    assert names(do(state, op="move", id=first, to=2)) == ["two", "three", "Skin"]
    assert do(state, op="move", id=first, to=2).ids == (second, third, first)
    doubled = do(state, op="duplicate", id=second)
    assert names(doubled) == ["Skin", "two", "two", "three"]
    assert len(set(doubled.ids)) == 4
    assert do(state, op="remove", id=second).ids == (first, third)
    assert names(do(state, op="add", layers=[{"name": "low"}], at=0))[0] == "low"
    assert do(state, op="move", id=first, to=99).ids[-1] == first


def test_a_slider_is_one_edit_of_its_map(state):
    id = state.ids[0]
    once = do(state, op="tune", id=id, map="melanin", edit=melanin(2))
    twice = do(once, op="tune", id=id, map="melanin", edit=melanin(3))
    assert [edit.by for edit in twice.look.layers[0].edits] == [3]
    none = do(twice, op="tune", id=id, map="melanin", edit=None)
    assert none == state


def test_two_pages_change_one_layer(state):
    """Each sends what it did, on what the other has done by then."""
    id = state.ids[0]
    both = do(state, op="tune", id=id, map="melanin", edit=melanin(2))
    both = do(both, op="set", id=id, field="amount", value=0.5)
    both = do(both, op="part", id=id, part={"part": "patches"})
    both = do(both, op="part", id=id, part={"part": "patches", "seed": 8})
    both = do(both, op="tune", id=id, map="blood", edit={**melanin(2), "map": "blood"})
    layer = both.look.layers[0]
    assert (layer.amount, len(layer.edits), len(layer.mask)) == (0.5, 2, 2)


def test_parts_of_masks_are_replaced_and_taken_away(state):
    id = state.ids[1]
    one = do(state, op="part", id=id, part={"part": "patches"})
    other = do(one, op="part", id=id, at=0, part={"part": "patches", "seed": 3})
    assert [part.seed for part in other.look.layers[1].mask] == [3]
    assert do(other, op="part", id=id, at=0, part=None) == state


def test_strokes_of_two_pages_are_both_kept(state):
    id = state.ids[1]
    stroke = {"points": [[0.5, 0.5], [0.6, 0.5]], "radius": 0.1}
    both = do(do(state, op="stroke", id=id, stroke=stroke), op="stroke", id=id,
              stroke={**stroke, "erase": True})  # fmt: skip
    (part,) = both.look.layers[1].mask
    assert [one.erase for one in part.strokes] == [False, True]


@pytest.mark.parametrize(
    ("op", "said"),
    [
        ({"op": "remove", "id": "0" * 8}, "gone"),
        ({"op": "set", "id": None, "field": "amount", "value": 2}, "amount"),
        ({"op": "set", "id": None, "field": "edits", "value": "x"}, "edits"),
        ({"op": "tune", "id": None, "map": "melanin", "edit": melanin(-1)}, "by"),
        ({"op": "part", "id": None, "at": 4, "part": None}, "gone"),
        ({"op": "add", "layers": [{"edits": [{"do": "explode"}]}]}, "explode"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(state, op, said):
    if "id" in op:
        op["id"] = op["id"] or state.ids[0]
    with pytest.raises(CutisError, match=said):
        do(state, **op)
