"""Looks of every kind, for tests that hold for all of them."""

from hypothesis import strategies as st
from PIL import Image

from cutis.looks import (
    Blend,
    BlotchesPart,
    Ceiling,
    Contrast,
    Floor,
    FrecklesPart,
    Layer,
    Look,
    Multiply,
    Offset,
    PatchesPart,
    PicturePart,
    RangePart,
    RegionsPart,
    Set,
    Soften,
    Stroke,
    StrokesPart,
)
from cutis.optics import NAMES, RARE_NAMES, parameter

SKIN = "#c08060"
share = st.floats(0, 1)
seed = st.integers(0, 1000)
name = st.text(max_size=12)
radius = st.one_of(st.floats(0.01, 0.5), st.sampled_from(["0.7px", "2.5px", "9px", "17px"]))
any_map = st.sampled_from([*NAMES, *RARE_NAMES])
five = st.sampled_from(NAMES)


def write_pictures(folder):
    """What the looks name: paint.png, grey, and regions.png with SKIN; 32 x 24."""
    paint = Image.linear_gradient("L").resize((32, 24))
    paint.save(folder / "paint.png")
    regions = Image.new("RGB", (32, 24), "#102030")
    regions.paste(SKIN, (7, 5, 20, 18))
    regions.save(folder / "regions.png")


@st.composite
def areas(draw):
    """`areas` with its radius."""
    kind = draw(st.sampled_from(["all", "detail", "large"]))
    return {"areas": kind, "radius": None if kind == "all" else draw(radius)}


@st.composite
def edits(draw):
    """One edit."""
    kind = draw(st.sampled_from([Multiply, Offset, Set, Blend, Floor, Ceiling, Contrast, Soften]))
    if kind is Soften:
        return Soften(map=draw(any_map), radius=draw(radius))
    if kind is Contrast:
        if draw(st.booleans()):
            return Contrast(map=draw(five), by=draw(st.floats(0, 4)))
        return Contrast(
            map=draw(any_map), by=draw(st.floats(0, 4)), about="local", radius=draw(radius)
        )
    known = parameter(draw(any_map))
    fields = {"map": known.name, **draw(areas())}
    value = st.floats(known.low, known.high)
    if kind is Multiply:
        return Multiply(by=draw(st.floats(0, 5)), **fields)
    if kind is Offset:
        return Offset(by=draw(value) - draw(value), **fields)
    more = {"share": draw(share)} if kind is Blend else {}
    return kind(to=draw(value), **fields, **more)


@st.composite
def strokes(draw):
    """One stroke."""
    points = st.lists(st.tuples(st.floats(-0.2, 1.2), st.floats(-0.2, 1.2)), min_size=1, max_size=5)
    return Stroke(
        points=tuple(draw(points)), radius=draw(st.floats(0.01, 0.4)), hardness=draw(share),
        opacity=draw(share), erase=draw(st.booleans()), tile=draw(st.sampled_from([1001, 1002])),
    )  # fmt: skip


@st.composite
def ranges(draw):
    """A range of a map as it is, over its median or what is around, or of its large areas."""
    of = parameter(draw(five))
    kind = draw(st.sampled_from(["value", "percentile", "median", "local", "large"]))
    fields = {"map": of.name}
    if kind in ("local", "large"):
        fields |= {"radius": draw(radius), **({"over": "local"} if kind == "local" else
                                              {"areas": "large"})}  # fmt: skip
    if kind == "median":
        fields["over"] = "median"
    if kind == "percentile":
        low, high = sorted(draw(st.tuples(st.integers(0, 100), st.integers(0, 100))))
        low, high = f"p{low}", f"p{high}"
    else:
        ends = (0.5, 2) if kind in ("median", "local") else (of.low, of.high)
        low, high = sorted(draw(st.tuples(st.floats(*ends), st.floats(*ends))))
    side = draw(st.sampled_from(["above", "below"]))
    return RangePart(**fields, **{side: draw(st.sampled_from([low, (low, high)]))})


@st.composite
def parts(draw):
    """One part of a mask."""
    kind = draw(st.sampled_from(["picture", "regions", "strokes", "range", "grown"]))
    part = {
        "picture": st.just(PicturePart(path="paint.png")),
        "regions": st.sampled_from([
            RegionsPart(path="regions.png", take=(SKIN,)),
            RegionsPart(path="regions.png", take=("cheek", "#102030"), names={"cheek": SKIN}),
        ]),
        "strokes": st.lists(strokes(), max_size=3).map(lambda s: StrokesPart(strokes=tuple(s))),
        "range": ranges(),
        "grown": st.one_of(
            st.builds(PatchesPart, seed=seed),
            st.builds(BlotchesPart, seed=seed, size=st.floats(0.02, 0.5),
                      density=st.floats(0.01, 0.99), soft=st.floats(0.02, 4)),
            st.builds(FrecklesPart, seed=seed, size=st.floats(0.01, 0.05),
                      density=st.floats(0.01, 0.7), clustered=share, soft=share),
        ),
    }[kind]  # fmt: skip
    how = {"how": draw(st.sampled_from(["add", "subtract", "intersect"])),
           "invert": draw(st.booleans()),
           "feather": draw(st.one_of(st.none(), radius))}  # fmt: skip
    return draw(part).model_copy(update=how)


layers = st.builds(
    Layer, name=name, note=name, on=st.sampled_from([True, True, True, False]), amount=share,
    edits=st.lists(edits(), max_size=3).map(tuple), mask=st.lists(parts(), max_size=3).map(tuple),
)  # fmt: skip
looks = st.builds(
    Look, name=name, note=name, tissue=st.sampled_from([None, "measured2026"]), amount=share,
    layers=st.lists(layers, max_size=4).map(tuple),
)  # fmt: skip
