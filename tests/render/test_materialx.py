"""MaterialX documents, read by the MaterialX package and by its own node graphs."""

import math
import xml.etree.ElementTree as ElementTree

import pytest

from cutis.errors import CutisError
from cutis.render.material import Gloss, Material
from cutis.render.materialx import (
    identifier,
    materialx,
    open_pbr,
    standard_surface,
    write_materialx,
)

SURFACES = ("open_pbr_surface", "standard_surface")


def skin(**changes):
    given = {
        "name": "face",
        "albedo": "face.albedo.exr",
        "single_scattering": "face.single_scattering.exr",
        "radius": (0.38, 0.21, 0.12),
        "anisotropy": 0.3,
        "millimetres": 100.0,
        **changes,
    }
    return Material(**given)


MAPPED = {"radius_texture": "face.radius.exr"}
DETAIL = {"normal": "face.normal.png", "roughness": "face.roughness.png"}


@pytest.fixture(scope="module")
def package():
    return pytest.importorskip("MaterialX", reason="pip install cutis[materialx] runs this")


@pytest.fixture(scope="module")
def library(package):
    """Node definitions that come with the package."""
    found = package.createDocument()
    folders = package.getDefaultDataLibraryFolders()
    package.loadLibraries(folders, package.getDefaultDataSearchPath(), found)
    return found


@pytest.fixture
def read(package, library):
    def parse(text):
        document = package.createDocument()
        package.readFromXmlString(document, text)
        document.importLibrary(library)
        return document

    return parse


@pytest.mark.parametrize("changes", [{}, MAPPED, DETAIL, {"credits": ("a -- b --", "<c>")}])
def test_document_is_valid_and_every_input_is_known(read, changes):
    document = read(materialx(skin(**changes)))
    valid, message = document.validate()
    assert valid, message
    for kind in SURFACES:
        (shader,) = document.getNodes(kind)
        definition = shader.getNodeDef()
        assert definition is not None
        for given in shader.getInputs():
            known = definition.getActiveInput(given.getName())
            assert known is not None, given.getName()
            assert known.getType() == given.getType()
        assert document.getNode(f"face_{kind}").getNodeDef() is not None


@pytest.mark.parametrize("kind", SURFACES)
def test_shader_code_can_be_made_from_it(package, read, kind):
    """All connections resolve: a generator finds the textures behind the inputs."""
    generators = pytest.importorskip("MaterialX.PyMaterialXGenOsl")
    shaders = pytest.importorskip("MaterialX.PyMaterialXGenShader")
    document = read(materialx(skin(**MAPPED, **DETAIL)))
    generator = generators.OslShaderGenerator.create()
    context = shaders.GenContext(generator)
    context.registerSourceCodeSearchPath(package.getDefaultDataSearchPath())
    code = generator.generate("skin", document.getNode(f"face_{kind}"), context)
    source = code.getSourceCode("pixel")
    assert "face.albedo.exr" in source
    assert "face.radius.exr" in source
    assert "face.normal.png" in source
    assert "face.roughness.png" in source


def numbers(inputs):
    return {name: value for name, value in inputs if not isinstance(value, str)}


def test_both_surfaces_have_the_radii_in_scene_units():
    material = skin()
    expected = [r / 100 for r in material.radius]
    pbr, autodesk = numbers(open_pbr(material)), numbers(standard_surface(material))
    scales = pbr["subsurface_radius_scale"]
    assert [pbr["subsurface_radius"] * s for s in scales] == pytest.approx(expected)
    assert max(scales) == 1  # OpenPBR allows no more
    radii = autodesk["subsurface_radius"]
    assert [autodesk["subsurface_scale"] * r for r in radii] == pytest.approx(expected)


def test_texture_of_radii_takes_the_place_of_numbers():
    material = skin(**MAPPED)
    pbr, autodesk = dict(open_pbr(material)), dict(standard_surface(material))
    assert pbr["subsurface_radius_scale"] == autodesk["subsurface_radius"] == "radius"
    assert pbr["subsurface_radius"] == autodesk["subsurface_scale"] == 0.01


def test_colour_is_tagged_and_data_is_not():
    root = ElementTree.fromstring(materialx(skin(**MAPPED)))
    files = {node.get("value"): node.get("colorspace") for node in root.iter("input")}
    assert files["face.albedo.exr"] == "lin_rec709"
    assert files["face.radius.exr"] is None
    assert root.get("colorspace") is None  # or it would hold for the radii
    assert "face.single_scattering.exr" not in files  # renderers invert the albedo themselves


class Graph:
    """Numbers that the package's own definition of a surface computes from its inputs."""

    def __init__(self, library, name, inputs):
        self.graph = library.getNodeGraph(name)
        definition = self.graph.getNodeDef()
        defaults = {i.getName(): i.getValue() for i in definition.getActiveInputs()}
        self.inputs = {**defaults, **inputs}

    def __call__(self, name):
        node = self.graph.getNode(name)

        def of(label):
            given = node.getInput(label)
            if given.getInterfaceName():
                return self.inputs[given.getInterfaceName()]
            return self(given.getNodeName()) if given.getNodeName() else given.getValue()

        match node.getCategory():
            case "power":
                return of("in1") ** of("in2")
            case "multiply":
                return of("in1") * of("in2")
            case "divide":
                return of("in1") / of("in2")
            case "add":
                return of("in1") + of("in2")
            case "subtract":
                return of("in1") - of("in2")
            case "min":
                return min(of("in1"), of("in2"))
            case "mix":
                return of("bg") * (1 - of("mix")) + of("fg") * of("mix")
            case "ifgreater":
                return of("in1") if of("value1") > of("value2") else of("in2")
            case "clamp":
                return min(max(of("in"), of("low")), of("high"))
            case "sqrt":
                return math.sqrt(of("in"))
            case "sign":
                return math.copysign(1, of("in"))
            case other:
                raise AssertionError(f"{other} is new in this graph")


LOBES = [(0.3, 0.52), (0.2, 0.35), (0.45, 0.6), (0.52, 0.3)]


@pytest.mark.parametrize("mix", [0.0, 0.15, 0.5, 0.85, 1.0])
@pytest.mark.parametrize("roughness", LOBES)
@pytest.mark.parametrize("strength", [1.0, 0.6])
def test_open_pbr_comes_to_the_two_lobes(library, mix, roughness, strength):
    """By the model's own graph: what it does to the base below a coat is undone."""
    gloss = Gloss(roughness, mix, 1.4, strength)
    inputs = numbers(open_pbr(skin(gloss=gloss)))
    graph = Graph(library, "NG_open_pbr_surface_surfaceshader", inputs)
    reflected = (0.4 / 2.4) ** 2
    assert graph("coat_ior_to_F0") == pytest.approx(reflected)
    lobes = {
        inputs["coat_roughness"]: inputs["coat_weight"] * reflected,
        round(graph("effective_specular_roughness"), 6): graph("scaled_specular_F0_clamped"),
    }
    shares = {roughness[0]: mix, roughness[1]: 1 - mix}
    expected = {r: share * strength * reflected for r, share in shares.items()}
    assert lobes == pytest.approx(expected)


def test_base_under_a_coat_too_rough_is_as_smooth_as_can_be():
    assert numbers(open_pbr(skin(gloss=Gloss((0.1, 1.0), 0.6))))["specular_roughness"] == 0


def factors(text):
    """What each output of roughness multiplies its image by."""
    root = ElementTree.fromstring(text)
    found = {node.get("name"): node for node in root.iter("multiply")}
    return {
        name.removesuffix("_product"): float(node.find("input[@name='in2']").get("value"))
        for name, node in found.items()
    }


@pytest.mark.parametrize(("grey", "within"), [(0.1, 1e-5), (0.5, 1e-5), (0.6, 1e-5), (0.8, 0.07)])
def test_roughness_map_scales_both_lobes(library, grey, within):
    """With a map of one grey the surfaces are those of lobes as rough as it says.

    Beyond 0.63 the model cuts off what the coat adds: at 0.8 the base is 6 % too smooth.
    """
    material = skin(**DETAIL)
    first, second = (r * grey / 0.5 for r in material.gloss.roughness)
    factor = factors(materialx(material))
    assert factor["coat_roughness"] * grey == pytest.approx(second, rel=1e-6)
    assert factor["standard_roughness"] * grey == pytest.approx(first, rel=1e-6)
    given = numbers(open_pbr(material)) | {
        "specular_roughness": factor["open_pbr_roughness"] * grey,
        "coat_roughness": factor["coat_roughness"] * grey,
    }
    graph = Graph(library, "NG_open_pbr_surface_surfaceshader", given)
    assert graph("effective_specular_roughness") == pytest.approx(first, rel=within)


def test_normals_bend_base_and_coat():
    pbr, autodesk = dict(open_pbr(skin(**DETAIL))), dict(standard_surface(skin(**DETAIL)))
    assert pbr["geometry_normal"] == pbr["geometry_coat_normal"] == "normal"
    assert autodesk["normal"] == autodesk["coat_normal"] == "normal"
    assert "geometry_normal" not in dict(open_pbr(skin()))


@pytest.mark.parametrize("mix", [0.0, 0.3, 1.0])
def test_reflected_light_adds_up_to_one_interface(mix):
    """At normal incidence coat over base is within 1 % of a single interface, mixed or not."""
    inputs = numbers(standard_surface(skin(gloss=Gloss((0.3, 0.52), mix, 1.4))))
    reflected = (0.4 / 2.4) ** 2
    coat = inputs["coat"] * reflected
    total = coat + (1 - coat) * inputs["specular"] * reflected
    assert total == pytest.approx(reflected, rel=0.01)
    assert total <= reflected + 1e-12


@pytest.mark.parametrize(
    ("name", "expected"),
    [("face", "face"), ("1001", "skin_1001"), ("müde.v2", "m_de_v2"), ("", "skin_"), ("²", "_")],
)
def test_names_are_those_that_materialx_allows(name, expected):
    assert identifier(name) == expected


def test_name_of_any_kind_gives_a_valid_document(read):
    document = read(materialx(skin(name="1 face/ä&<", albedo='1 face ä&<".albedo.exr')))
    valid, message = document.validate()
    assert valid, message
    graph = document.getNodeGraph("skin_1_face_____textures")
    file = graph.getNode("albedo_image").getInput("file")
    assert file.getValueString() == '1 face ä&<".albedo.exr'


def test_file_is_written_whole_or_not_at_all(tmp_path):
    path = tmp_path / "face.mtlx"
    write_materialx(skin(), path)
    assert path.read_text("utf-8") == materialx(skin())
    with pytest.raises(CutisError, match="does not exist"):
        write_materialx(skin(), tmp_path / "none" / "face.mtlx")
