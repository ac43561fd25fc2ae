"""A skin material as a MaterialX document, for renderers that read one [openpbr] [georgiev2019].

The document holds two materials that mean the same: an OpenPBR surface and an Autodesk Standard
Surface. In both, the subsurface colour is the diffuse albedo: the renderer inverts it to the
single-scattering albedo of its medium. Radii are in mm and scaled to units of the scene.

Two specular lobes of one interface are said as base and coat, since neither model has two: the base
is the stronger lobe, the coat the other, each as strong as its share. Standard Surface takes both
as they are. OpenPBR computes the base below the coat as rougher and less refracting, as if the coat
were a layer of its own; its inputs are set so that what comes out are the two lobes asked for.

Written with the standard library: the document is 60 lines of XML, the MaterialX package 28 MB.
Tests read it with that package.
"""

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path

from cutis.render.material import NEUTRAL, Gloss, Material
from cutis.textures import replacing

VERSION = "1.38"
"""Of the format: later readers upgrade it, earlier ones would refuse a later."""
Value = float | tuple[float, ...]
OUTPUTS = {
    "albedo": "color3",
    "radius": "color3",
    "normal": "vector3",
    "coat_roughness": "float",
    "open_pbr_roughness": "float",
    "standard_roughness": "float",
}
"""What the graph of textures may hold, by name."""


def write_materialx(material: Material, path: Path) -> None:
    """Writes NAME.mtlx, which names textures relative to it; CutisError where that fails."""
    text = materialx(material)
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def materialx(material: Material) -> str:
    """The document of a material."""
    root = ElementTree.Element("materialx", version=VERSION)
    if material.credits:
        root.append(ElementTree.Comment(" " + "; ".join(material.credits).replace("--", "–") + " "))
    name = identifier(material.name)
    graph = ElementTree.SubElement(root, "nodegraph", name=f"{name}_textures")
    _textures(graph, material)
    for kind, inputs in (
        ("open_pbr_surface", dict(open_pbr(material))),
        ("standard_surface", dict(standard_surface(material))),
    ):
        shader = ElementTree.SubElement(
            root, kind, name=f"{name}_{kind}_shader", type="surfaceshader"
        )
        for label, value in inputs.items():
            if isinstance(value, str):
                kind_of = OUTPUTS[value]
                _input(shader, label, kind_of, nodegraph=graph.attrib["name"], output=value)
            else:
                _input(shader, label, *_typed(value))
        surface = ElementTree.SubElement(
            root, "surfacematerial", name=f"{name}_{kind}", type="material"
        )
        _input(surface, "surfaceshader", "surfaceshader", nodename=shader.attrib["name"])
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def open_pbr(material: Material) -> Iterator[tuple[str, Value | str]]:
    """Inputs of the OpenPBR surface by name; text is an output of the graph of textures."""
    gloss, largest = material.gloss, max(material.radius)
    weight, roughness = _below_coat(gloss)
    yield "base_color", "albedo"
    yield "specular_weight", weight
    yield "specular_roughness", roughness if material.roughness is None else "open_pbr_roughness"
    yield "specular_ior", gloss.refractive_index
    yield "subsurface_weight", 1.0
    yield "subsurface_color", "albedo"
    if material.radius_texture is None:
        red, green, blue = (r / largest for r in material.radius)
        yield "subsurface_radius", largest * material.scale
        yield "subsurface_radius_scale", (red, green, blue)
    else:
        yield "subsurface_radius", material.scale
        yield "subsurface_radius_scale", "radius"
    yield "subsurface_scatter_anisotropy", material.anisotropy
    yield "coat_weight", gloss.lobes[1][1] * gloss.strength
    yield "coat_roughness", gloss.lobes[1][0] if material.roughness is None else "coat_roughness"
    yield "coat_ior", gloss.refractive_index
    yield "coat_darkening", 0.0  # the albedo is what is seen already
    if material.normal is not None:
        yield "geometry_normal", "normal"
        yield "geometry_coat_normal", "normal"


def standard_surface(material: Material) -> Iterator[tuple[str, Value | str]]:
    """Inputs of the Standard Surface by name; text is an output of the graph of textures."""
    gloss = material.gloss
    yield "base", 1.0
    yield "base_color", "albedo"
    yield "specular", gloss.lobes[0][1] * gloss.strength
    mapped = material.roughness is not None
    yield "specular_roughness", "standard_roughness" if mapped else gloss.lobes[0][0]
    yield "specular_IOR", gloss.refractive_index
    yield "subsurface", 1.0
    yield "subsurface_color", "albedo"
    yield "subsurface_radius", material.radius if material.radius_texture is None else "radius"
    yield "subsurface_scale", material.scale
    yield "subsurface_anisotropy", material.anisotropy
    yield "coat", gloss.lobes[1][1] * gloss.strength
    yield "coat_roughness", "coat_roughness" if mapped else gloss.lobes[1][0]
    yield "coat_IOR", gloss.refractive_index
    if material.normal is not None:
        yield "normal", "normal"
        yield "coat_normal", "normal"


def _below_coat(gloss: Gloss) -> tuple[float, float]:
    """OpenPBR's specular weight and roughness whose base, under the coat, is the stronger lobe.

    The base has index η = (1−w) n + w·1 below a coat of weight w and the same index n, and its
    reflectivity at normal incidence F₀ is multiplied by the specular weight; its roughness is
    (1−w) r + w min(1, 2 r_coat⁴ + r⁴)^¼. Solved for (1−w) F₀(n) and the roughness asked for. Where
    the coat alone makes it rougher than that, r is 0.
    """
    (wanted, share), (coat_roughness, other) = gloss.lobes
    index, coat = gloss.refractive_index, other * gloss.strength
    reflected = _normal_reflectance((1 - coat) * index + coat)
    weight = (
        share * gloss.strength * _normal_reflectance(index) / reflected if reflected > 0 else 0.0
    )

    def roughened(roughness: float) -> float:
        under = min(1.0, 2 * coat_roughness**4 + roughness**4) ** 0.25
        return (1 - coat) * roughness + coat * under

    low, high = 0.0, 1.0
    while high - low > 1e-9:  # roughened() grows with roughness
        middle = (low + high) / 2
        low, high = (middle, high) if roughened(middle) < wanted else (low, middle)
    return weight, low


def _normal_reflectance(index: float) -> float:
    """F₀ of a dielectric."""
    return ((index - 1) / (index + 1)) ** 2


def identifier(name: str) -> str:
    """A name that MaterialX allows: letters, digits and _, not beginning with a digit."""
    allowed = "".join(c if c.isascii() and (c.isalnum() or c == "_") else "_" for c in name)
    return allowed if allowed and not allowed[0].isdigit() else f"skin_{allowed}"


def _textures(graph: ElementTree.Element, material: Material) -> None:
    """The nodes behind `OUTPUTS`, as far as the material has textures for them."""
    _output(graph, "albedo", _image(graph, "albedo", "color3", material.albedo, "lin_rec709"))
    if material.radius_texture is not None:
        _output(graph, "radius", _image(graph, "radius", "color3", material.radius_texture))
    if material.normal is not None:
        image = _image(graph, "normal", "vector3", material.normal)
        node = ElementTree.SubElement(graph, "normalmap", name="normal_map", type="vector3")
        _input(node, "in", "vector3", nodename=image)
        _output(graph, "normal", "normal_map")
    if material.roughness is None:
        return
    image = _image(graph, "roughness", "float", material.roughness)
    (main, _), (coat, _) = material.gloss.lobes
    # below a coat the model is linear in both roughnesses at once (until it cuts off at 1), so that
    # one factor undoes it
    _scaled(graph, "open_pbr_roughness", image, _below_coat(material.gloss)[1] / NEUTRAL)
    _scaled(graph, "standard_roughness", image, main / NEUTRAL)
    _scaled(graph, "coat_roughness", image, coat / NEUTRAL)


def _scaled(graph: ElementTree.Element, output: str, image: str, factor: float) -> None:
    """An output that is `factor` times an image, at most 1."""
    product = ElementTree.SubElement(graph, "multiply", name=f"{output}_product", type="float")
    _input(product, "in1", "float", nodename=image)
    _input(product, "in2", "float", value=_number(factor))
    least = ElementTree.SubElement(graph, "min", name=f"{output}_limit", type="float")
    _input(least, "in1", "float", nodename=product.attrib["name"])
    _input(least, "in2", "float", value="1")
    _output(graph, output, least.attrib["name"])


def _image(
    graph: ElementTree.Element, name: str, kind: str, file: str, space: str | None = None
) -> str:
    """An image node; returns its name."""
    node = ElementTree.SubElement(graph, "image", name=f"{name}_image", type=kind)
    tag = {} if space is None else {"colorspace": space}
    _input(node, "file", "filename", value=file, **tag)
    return node.attrib["name"]


def _output(graph: ElementTree.Element, name: str, node: str) -> None:
    ElementTree.SubElement(graph, "output", name=name, type=OUTPUTS[name], nodename=node)


def _typed(value: Value) -> tuple[str, str]:
    if isinstance(value, tuple):
        return "color3", ", ".join(_number(v) for v in value)
    return "float", _number(value)


def _number(value: float) -> str:
    assert math.isfinite(value)
    return f"{value:.7g}"


def _input(
    parent: ElementTree.Element, name: str, kind: str, value: str | None = None, **more: str
) -> None:
    attributes = {"name": name, "type": kind, **({} if value is None else {"value": value}), **more}
    ElementTree.SubElement(parent, "input", attributes)
