# SPDX-License-Identifier: GPL-3.0-or-later
# Part of cutis. This file alone is under the GNU General Public License, version 3 or later (see
# COPYING beside it), because it is a script of Blender; it uses nothing of cutis but a JSON file.
"""Renders the pictures of a job with Blender's Cycles, 4.2 and later.

    blender --background --factory-startup --python scene.py -- job.json
    python scene.py job.json                    (a Python that has the module bpy)

The job is {"pictures": [{...}, ...]}; `cutis.render.scene.Scene` documents the entries, beside
which each picture has its `output`, an EXR that is written as float, linear Rec.709. Meshes and
textures that one picture shares with the one before stay loaded.

What happens is told on standard output, one line of JSON after the word CUTIS each:

    {"event": "device", "name": "CPU"}
    {"event": "note", "picture": 0, "message": "..."}
    {"event": "sample", "picture": 0, "sample": 12}
    {"event": "done", "picture": 0, "seconds": 9.1}
    {"event": "error", "picture": 0, "message": "..."}

An error ends the program with status 1. The scene is in metres, +Z up, the face towards −Y.
"""

import ctypes
import json
import math
import os
import re
import sys
import time
import warnings

import bpy  # type: ignore[import-not-found]
import numpy as np

# isort: split
import bmesh  # type: ignore[import-not-found]  # there once bpy is

warnings.filterwarnings("ignore", category=DeprecationWarning)  # use_nodes, until Blender 6

MILLIMETRE = 1e-3  # metres
LENS, SENSOR = 85.0, 36.0  # mm; the usual focal length of portraits
MARGIN = 0.06  # share of the picture's half side that stays free around the mesh
HEAD_HEIGHT = 240.0  # mm, vertex to chin and some neck; a mesh of unknown scale is taken for that
MOST_VERTICES, MOST_BYTES = 20_000_000, 4 << 30
LINEAR = "Linear Rec.709"
UDIM = "<UDIM>"  # in the name of a texture of several tiles, 1001 to 1999
BESIDE = 1e-3  # of a texture's side that texture coordinates may be outside

# The two lobes of the surface: roughness as a factor of the scene's, and share. Factors and shares
# are those that the Unreal Engine has for skin by default; the roughness they multiply is chosen.
LOBES = ((0.75, 0.85), (1.30, 0.15))
SKIN_IOR = 1.4  # as the tissue's

# Brings a white card that faces the camera to a luminance of WHITE_CARD (tests measure it).
WHITE_CARD = 0.8
GAIN = {"studio": 1.344, "sun": 0.848, "interior": 1.834, "furnace": 1.0}


class Problem(Exception):
    """What the user is told, one line."""


def tell(**event):
    """A line of its own, whatever half a line of Blender's may still be in the pipe."""
    os.write(1, f"\nCUTIS {json.dumps(event)}\n".encode())


def last_word(error):
    """What an error comes to, without the traceback that may be in its text."""
    lines = [line.strip() for line in str(error).splitlines()]
    around = ("Traceback", "File ", "Location:", "^", "~")
    good = [line for line in lines if line and not line.startswith(around)]
    return good[-1] if good else "no reason is given"


# Meshes ----------------------------------------------------------------------------------------


def import_mesh(path):
    """Meshes of a file in one space: a list of bpy meshes with transformations and modifiers in."""
    size = os.path.getsize(path)
    if not size:
        return []
    if size > MOST_BYTES:
        raise Problem(f"the mesh {path} has {size / 2**30:.1f} GiB; simplify it to 4 GiB or less")
    before = set(bpy.data.objects)
    kind = os.path.splitext(path)[1].lower()
    if kind == ".obj":  # Blender reads 0 there
        with open(path, "rb") as file:
            if any(re.match(rb"v\s.*(nan|inf)", line.lower()) for line in file):
                raise Problem(f"the mesh {path} has vertices that are not numbers; export it again")
    wanted: dict = {
        ".obj": (bpy.ops.wm.obj_import, {"use_split_objects": False, "use_split_groups": False}),
        ".gltf": (bpy.ops.import_scene.gltf, {"import_shading": "NORMALS"}),
        ".glb": (bpy.ops.import_scene.gltf, {"import_shading": "NORMALS"}),
    }
    usd: dict = {name: False for name in ("import_cameras", "import_lights", "import_usd_preview")}
    usd |= {"apply_unit_conversion_scale": False, "set_frame_range": False}
    usd |= {"import_textures_mode": "IMPORT_NONE"}
    operator, options = wanted.get(kind, (bpy.ops.wm.usd_import, usd))
    known = operator.get_rna_type().properties.keys()
    try:
        operator(filepath=path, **{k: v for k, v in options.items() if k in known})
    except RuntimeError as error:
        raise Problem(f"the mesh {path} cannot be read: {last_word(error)}") from error
    made = [o for o in bpy.data.objects if o not in before]
    graph = bpy.context.evaluated_depsgraph_get()
    meshes = []
    for thing in made:
        if thing.type == "MESH":
            evaluated = thing.evaluated_get(graph)
            mesh = bpy.data.meshes.new_from_object(evaluated)
            mesh.transform(evaluated.matrix_world)
            if evaluated.matrix_world.is_negative:
                mesh.flip_normals()
            meshes.append(mesh)
    for thing in made:
        bpy.data.objects.remove(thing)
    return [mesh for mesh in meshes if len(mesh.polygons)]


def positions(mesh):
    """(vertices, 3) array of a mesh's vertices."""
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


def coordinates(mesh):
    """(loops, 2) texture coordinates of a mesh; None where it has none."""
    layer = next((u for u in mesh.uv_layers if u.active_render), mesh.uv_layers.active)
    if layer is None:
        return None
    flat = np.empty(2 * len(mesh.loops), np.float32)
    layer.data.foreach_get("uv", flat)
    return flat.reshape(-1, 2).astype(float)


def tiles(mesh):
    """The tile that each polygon is on, by the middle of it; 0 for places that no tile has."""
    counts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", counts)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    uv = coordinates(mesh)
    middle = np.add.reduceat(uv, starts, axis=0) / counts[:, None]
    least = np.minimum.reduceat(uv, starts, axis=0)
    most = np.maximum.reduceat(uv, starts, axis=0)
    inside = ((least >= -BESIDE) & (most <= 1 + BESIDE)).all(axis=1)
    u, v = np.floor(np.nan_to_num(middle).clip(-1, 100)).astype(int).T
    number = np.where((u >= 0) & (u <= 9) & (v >= 0) & (v < 100), 1001 + u + 10 * v, 0)
    return np.where(inside, 1001, number)


def textured(mesh):
    """Which polygons have an area in the texture."""
    usable = np.zeros(len(mesh.polygons), bool)
    uv = coordinates(mesh)
    if uv is None:
        return usable
    mesh.calc_loop_triangles()
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("loops", triangles)
    owners = np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", owners)
    a, b, c = uv[triangles.reshape(-1, 3)].transpose(1, 0, 2)
    u, v = b - a, c - a
    area = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    usable[owners[np.isfinite(area) & (area > 1e-14)]] = True
    return usable


def parts(mesh):
    """The connected part that each polygon belongs to, as the least vertex number in it."""
    edges = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", edges)
    a, b = edges.reshape(-1, 2).T
    label = np.arange(len(mesh.vertices))
    while True:
        least = np.minimum(label[a], label[b])
        new = label.copy()
        np.minimum.at(new, a, least)
        np.minimum.at(new, b, least)
        new = new[new]
        if (new == label).all():
            break
        label = new
    corner = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corner)
    first = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", first)
    return label[corner[first]]


def without(mesh, gone):
    """A copy of a mesh without some of its polygons."""
    copy = mesh.copy()
    form = bmesh.new()
    form.from_mesh(copy)
    faces = [face for face, out in zip(form.faces, gone, strict=True) if out]
    bmesh.ops.delete(form, geom=faces, context="FACES")
    form.to_mesh(copy)
    form.free()
    return copy


def split(mesh):
    """(skin or None, [parts that have no texture coordinates, such as eyes])."""
    usable = textured(mesh)
    if usable.all():
        return mesh, []
    part = parts(mesh)
    bare = ~np.isin(part, np.unique(part[usable]))
    skin = None if bare.all() else without(mesh, bare) if bare.any() else mesh
    numbers, counts = np.unique(part[bare], return_counts=True)
    if len(numbers) > 16:  # crumbs, not eyes: one object is enough
        return skin, [without(mesh, ~bare)]
    return skin, [without(mesh, part != n) for n, _ in zip(numbers, counts, strict=True)]


def sphere():
    """A head-sized ball whose front half carries the whole texture; the back mirrors it."""
    rows, columns = 96, 192
    v, u = np.meshgrid(np.linspace(0, 1, rows + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    polar, around = np.pi * v, 2 * np.pi * u  # around: 0 at the back, π at the front (−Y)
    xyz = [np.sin(polar) * -np.sin(around), np.sin(polar) * np.cos(around), -np.cos(polar)]
    uv = [
        np.where(np.abs(u - 0.5) <= 0.25, 2 * u - 0.5, np.where(u < 0.5, 0.5 - 2 * u, 2.5 - 2 * u)),
        v,
    ]
    return grid("sphere", 0.5 * HEAD_HEIGHT * np.stack(xyz, -1), np.stack(uv, -1))


def patch(aspect):
    """A flat square, or as wide as its texture, 200 mm high, facing the camera."""
    v, u = np.meshgrid([0.0, 1.0], [0.0, 1.0], indexing="ij")
    xyz = [200.0 * aspect * (u - 0.5), np.zeros_like(u), 200.0 * (v - 0.5)]
    return grid("patch", np.stack(xyz, -1), np.stack([u, v], -1))


def grid(name, xyz, uv):
    """A mesh of quadrilaterals from (rows, columns, 3) points and their texture coordinates."""
    rows, columns = xyz.shape[:2]
    number = np.arange(rows * columns).reshape(rows, columns)
    quads = [number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]]
    faces = np.stack(quads, -1).reshape(-1, 4)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(xyz.reshape(-1, 3).tolist(), [], faces.tolist())
    mesh.uv_layers.new().data.foreach_set("uv", uv.reshape(-1, 2)[faces.ravel()].ravel())
    form = bmesh.new()  # closes the seam, so that light walks through it
    form.from_mesh(mesh)
    bmesh.ops.remove_doubles(form, verts=form.verts, dist=1e-6 * float(np.ptp(xyz)))
    form.to_mesh(mesh)
    form.free()
    return mesh


class Subject:
    """What is looked at: meshes in metres around the origin, and how they fill a picture."""

    def __init__(self, picture, aspect):
        name = picture["mesh"]
        if name == "sphere":
            meshes, scale = [sphere()], 1.0
        elif name == "patch":
            meshes, scale = [patch(aspect)], 1.0
        else:
            meshes, scale = import_mesh(name), picture["millimetres_per_unit"]
        if not meshes:
            raise Problem(f"the mesh {name} has no faces; export it again with its surface")
        self.skin, self.eyes = [], []
        self._check(name, meshes, scale)
        for mesh in meshes:
            skin, bare = split(mesh)
            self.skin += [skin] if skin else []
            self.eyes += bare
        if not self.skin:
            raise Problem(
                f"the mesh {name} has no texture coordinates (UVs); unwrap it before exporting it"
            )
        self.notes = self._said(name)
        self._place(meshes, scale)
        self.turntable = bpy.data.objects.new("turntable", None)
        self.turntable.rotation_mode = "XYZ"
        bpy.context.scene.collection.objects.link(self.turntable)
        smooth = name != "patch"
        self.objects = [self._object(mesh, smooth, picture) for mesh in self.skin]
        self.eye_objects = [self._object(mesh, smooth, picture) for mesh in self.eyes]

    def _said(self, name):
        """What people should know of the skin's materials and where it has texture coordinates."""
        self.tiles: dict[int, int] = {}
        materials, bare = set(), False
        for mesh in self.skin:
            for number, count in zip(*np.unique(tiles(mesh), return_counts=True), strict=True):
                self.tiles[int(number)] = self.tiles.get(int(number), 0) + int(count)
            used = np.empty(len(mesh.polygons), np.int32)
            mesh.polygons.foreach_get("material_index", used)
            for index in np.unique(used):
                own = mesh.materials[index] if index < len(mesh.materials) else None
                materials.add(own.name) if own else None
                bare |= not own
        if len(materials) + bare < 2:
            return []
        listed = ", ".join(sorted(materials)[:6]) + (" and more" if len(materials) > 6 else "")
        return [
            f"parts of the mesh {name} have materials of their own ({listed}), which are not "
            "used: all that has texture coordinates shows this skin"
        ]

    def outside(self, there):
        """What to say of polygons that are on none of the tiles that are there, None for one."""
        known = {1001} if there is None else set(there)
        lost = {n: count for n, count in self.tiles.items() if n not in known}
        if not lost:
            return []
        share = 100 * sum(lost.values()) / sum(self.tiles.values())
        named = ", ".join(str(n) if n else "none" for n in sorted(lost)[:6])
        where = f"{share:.3g} % of the mesh has texture coordinates outside the texture"
        if there is None:
            return [
                f"{where} (on tile {named}) and shows the colours of its edge; name all tiles of a "
                f"set as NAME.{UDIM}.EXT"
            ]
        return [f"{where}: tile {named} is not there and shows as magenta"]

    def _check(self, name, meshes, scale):
        if sum(len(mesh.vertices) for mesh in meshes) > MOST_VERTICES:
            raise Problem(f"the mesh {name} has more than {MOST_VERTICES} vertices; simplify it")
        points = np.concatenate([positions(mesh) for mesh in meshes])
        if not np.isfinite(points).all():
            raise Problem(f"the mesh {name} has vertices that are not numbers; export it again")
        low, high = points.min(0), points.max(0)
        size = float((high - low).max())
        if size <= 1e-6 * float(np.abs(points).max()) or size < 1e-12 or size > 1e12:
            raise Problem(
                f"the mesh {name} has no size (all vertices at {low.tolist()})"
                if size < 1
                else f"the mesh {name} is {size:.3g} units wide; scale it"
            )
        height = float(high[2] - low[2]) or size
        self.guessed = scale is None
        self.scale = HEAD_HEIGHT / height if scale is None else scale
        if not 1.0 <= self.scale * size <= 20_000.0:
            raise Problem(
                f"the mesh {name} is {self.scale * size:.3g} mm wide or high at {self.scale:g} mm "
                "per unit; give the millimetres per mesh unit that make it 1 mm to 20 m"
            )
        self.centre = 0.5 * (low + high)
        self.points = (points - self.centre) * self.scale * MILLIMETRE
        self.radius = float(np.linalg.norm(self.points, axis=1).max())

    def _place(self, meshes, scale):
        for mesh in {*self.skin, *self.eyes}:
            xyz = (positions(mesh) - self.centre) * self.scale * MILLIMETRE
            mesh.vertices.foreach_set("co", xyz.ravel().astype(np.float32))
            mesh.update()

    def _object(self, mesh, smooth, picture):
        if mesh in self.eyes:  # turn about its own middle, which its material is made around
            xyz = positions(mesh)
            middle = 0.5 * (xyz.min(0) + xyz.max(0))
            mesh.vertices.foreach_set("co", (xyz - middle).ravel().astype(np.float32))
        thing = bpy.data.objects.new("subject", mesh)
        if mesh in self.eyes:
            thing.location = middle
        thing.parent = self.turntable
        if smooth:
            mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
        levels = picture["subdivision"]
        if levels is None:
            levels = default_levels(mesh) if picture["mesh"] not in ("sphere", "patch") else 0
        if levels:
            modifier = thing.modifiers.new("subdivision", "SUBSURF")
            modifier.levels = modifier.render_levels = levels
        mesh.materials.clear()
        mesh.materials.append(None)
        mesh.polygons.foreach_set("material_index", np.zeros(len(mesh.polygons), np.int32))
        bpy.context.scene.collection.objects.link(thing)
        return thing

    def remove(self):
        for thing in [*self.objects, *self.eye_objects, self.turntable]:
            bpy.data.objects.remove(thing)
        for mesh in list(bpy.data.meshes):
            if not mesh.users:
                bpy.data.meshes.remove(mesh)


def default_levels(mesh):
    """Cages of few quadrilaterals are made to be subdivided, scans of triangles are not."""
    corners = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", corners)
    if (corners == 4).mean() < 0.9 or len(corners) > 40_000:
        return 0
    return 2 if len(corners) < 10_000 else 1


# Materials -------------------------------------------------------------------------------------


class Nodes:
    """A node tree, built."""

    def __init__(self, tree):
        self.tree = tree
        tree.nodes.clear()

    def add(self, kind, inputs=None, **settings):
        """A node; inputs are values, or sockets to link."""
        node = self.tree.nodes.new(kind)
        for key, value in settings.items():
            setattr(node, key, value)
        for key, value in (inputs or {}).items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[key])
            else:
                node.inputs[key].default_value = value
        return node


class Textures:
    """Images in memory; those that a picture does not use any more are let go."""

    def __init__(self):
        self.images = {}

    def get(self, path, space):
        key = (path, space)
        if key not in self.images:
            numbers = tiles_of(path)
            first = path.replace(UDIM, str(numbers[0])) if numbers else path
            try:
                image = bpy.data.images.load(first)
            except RuntimeError as error:
                raise Problem(f"the texture {path} cannot be read: {last_word(error)}") from error
            image.colorspace_settings.name = space
            image.alpha_mode = "CHANNEL_PACKED"
            if not all(image.size):
                raise Problem(f"the texture {path} cannot be read")
            if numbers:
                image.source, image.filepath = "TILED", path
                image.tiles[0].number = numbers[0]
                for number in numbers[1:]:
                    image.tiles.new(number)
            self.images[key] = image
        return self.images[key]

    def keep(self, paths):
        for key in [k for k in self.images if k[0] not in paths]:
            bpy.data.images.remove(self.images.pop(key))


def tiles_of(path):
    """Numbers of the tiles of a texture's name that holds <UDIM>; none of another."""
    folder, name = os.path.split(path)
    head, token, tail = name.partition(UDIM)
    if not token:
        return []
    form = re.compile(f"{re.escape(head)}(1[0-9]{{3}}){re.escape(tail)}")
    found = sorted(int(m[1]) for m in map(form.fullmatch, os.listdir(folder)) if m)
    if not found:
        raise Problem(f"the texture {path} has no tiles")
    return found


def new_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    return material, Nodes(material.node_tree)


def faced(nodes, colour, of_view, of_colour):
    """The colour c as c (1 + k h): k a cubic of the cosine of the view, h a table over √c."""
    if isinstance(colour, list):
        colour = nodes.add("ShaderNodeCombineXYZ", dict(enumerate(colour))).outputs[0]
    place = nodes.add("ShaderNodeNewGeometry").outputs
    view = {0: place["Normal"], 1: place["Incoming"]}
    cosine = nodes.add("ShaderNodeVectorMath", view, operation="DOT_PRODUCT").outputs["Value"]
    cosine = nodes.add("ShaderNodeMath", {0: cosine}, operation="ABSOLUTE").outputs[0]
    k = of_view[3]
    for a in of_view[2::-1]:
        k = nodes.add("ShaderNodeMath", {0: k, 1: cosine, 2: a}, operation="MULTIPLY_ADD")
        k = k.outputs[0]
    h = curves(nodes, colour, [(i / (len(of_colour) - 1)) ** 2 for i in range(len(of_colour))],
               of_colour)  # fmt: skip
    change = nodes.add("ShaderNodeVectorMath", {0: h, "Scale": k}, operation="SCALE").outputs[0]
    changed = {0: colour, 1: change, 2: colour}
    return nodes.add("ShaderNodeVectorMath", changed, operation="MULTIPLY_ADD").outputs[0]


def curves(nodes, colour, x, y):
    """The same piecewise linear function, of values from 0 to 1, of each channel."""
    node = nodes.add("ShaderNodeRGBCurve", {"Color": colour})
    points = node.mapping.curves[3].points  # of all channels
    points[0].location, points[1].location = (x[0], y[0]), (x[-1], y[-1])
    for place in zip(x[1:-1], y[1:-1], strict=True):
        points.new(*place)
    for point in points:
        point.handle_type = "VECTOR"
    node.mapping.update()
    return node.outputs[0]


def skin_material(picture, textures):
    """Random-walk subsurface below two lobes of GGX."""
    material, nodes = new_material("skin")

    def source(value, space):
        """The number or colour as it is, or the texture's socket."""
        if not isinstance(value, str):
            return value
        image = textures.get(value, space)
        return nodes.add("ShaderNodeTexImage", image=image, extension="EXTEND").outputs["Color"]

    colour = source(picture["base_colour"], LINEAR)
    if picture["facing"]:
        colour = faced(nodes, colour, *picture["facing"])
    inputs = {
        "Base Color": colour if not isinstance(colour, list) else [*colour, 1.0],
        "IOR": SKIN_IOR,
        "Specular IOR Level": 0.5 * picture["specular"],
    }
    settings = {"distribution": "GGX"}
    if picture["method"] != "diffuse":
        inputs |= {
            "Subsurface Weight": 1.0,
            "Subsurface Radius": source(picture["radius"], "Non-Color"),
            "Subsurface Scale": MILLIMETRE * picture["scale"],
            "Subsurface Anisotropy": picture["anisotropy"],
        }
        settings["subsurface_method"] = picture["method"].upper()
    if picture["method"] == "random_walk_skin":
        inputs["Subsurface IOR"] = picture["subsurface_ior"]
    if picture["normal"]:
        mapped = source(picture["normal"], "Non-Color")
        inputs["Normal"] = nodes.add("ShaderNodeNormalMap", {"Color": mapped}).outputs["Normal"]
    roughness = source(picture["roughness"], "Non-Color")
    lobes = []
    for factor, _ in LOBES if picture["specular"] else LOBES[:1]:
        if isinstance(roughness, bpy.types.NodeSocket):
            product = {0: roughness, 1: factor}
            rough = nodes.add("ShaderNodeMath", product, operation="MULTIPLY", use_clamp=True)
            rough = rough.outputs[0]
        else:
            rough = min(roughness * factor, 1.0)
        node = nodes.add("ShaderNodeBsdfPrincipled", inputs | {"Roughness": rough}, **settings)
        lobes.append(node.outputs[0])
    surface = lobes[0]
    if len(lobes) == 2:
        mixed = {0: LOBES[1][1], 1: lobes[0], 2: lobes[1]}
        surface = nodes.add("ShaderNodeMixShader", mixed).outputs[0]
    nodes.add("ShaderNodeOutputMaterial", {"Surface": surface})
    return material


# Half angle in degrees at the middle of a ball of 24 mm, and colour: pupil, iris, limbus, sclera.
EYE = (
    (0.0, (0.005, 0.005, 0.005)),
    (9.0, (0.005, 0.005, 0.005)),
    (10.0, (0.10, 0.055, 0.03)),
    (24.0, (0.06, 0.033, 0.02)),
    (28.0, (0.02, 0.012, 0.01)),
    (31.0, (0.62, 0.56, 0.52)),
    (60.0, (0.60, 0.50, 0.46)),
    (180.0, (0.50, 0.36, 0.32)),
)


def eye_material(ball):
    """What has no texture coordinates: an eyeball that looks ahead, or plain ivory."""
    material, nodes = new_material("eye")
    colour = [0.6, 0.55, 0.5, 1.0]
    if ball:
        place = nodes.add("ShaderNodeTexCoord").outputs["Object"]
        ahead = nodes.add("ShaderNodeVectorMath", {0: place}, operation="NORMALIZE").outputs[0]
        cosine = {0: ahead, 1: (0.0, -1.0, 0.0)}
        cosine = nodes.add("ShaderNodeVectorMath", cosine, operation="DOT_PRODUCT").outputs["Value"]
        angle = nodes.add("ShaderNodeMath", {0: cosine}, operation="ARCCOSINE").outputs[0]
        share = {0: angle, 1: math.pi}
        share = nodes.add("ShaderNodeMath", share, operation="DIVIDE").outputs[0]
        colour = ramp(nodes, share, [(degrees / 180, rgb) for degrees, rgb in EYE])
    inputs = {"Base Color": colour, "Roughness": 0.08, "IOR": 1.376}
    surface = nodes.add("ShaderNodeBsdfPrincipled", inputs).outputs[0]
    nodes.add("ShaderNodeOutputMaterial", {"Surface": surface})
    return material


def ramp(nodes, factor, stops):
    """The colour at a factor between 0 and 1, straight between the stops."""
    node = nodes.add("ShaderNodeValToRGB", {0: factor})
    elements = node.color_ramp.elements
    while len(elements) < len(stops):
        elements.new(1.0)
    for element, (place, rgb) in zip(elements, stops, strict=True):
        element.position, element.color = place, (*rgb, 1.0)
    return node.outputs["Color"]


def plain_material(rgb):
    material, nodes = new_material("plain")
    surface = nodes.add("ShaderNodeBsdfDiffuse", {"Color": [*rgb, 1.0]}).outputs[0]
    nodes.add("ShaderNodeOutputMaterial", {"Surface": surface})
    return material


# Lights ----------------------------------------------------------------------------------------


class Room:
    """The light around a subject of radius r at the origin; sizes and places in units of r."""

    def __init__(self, kind, radius, backdrop):
        self.radius, self.made = radius, []
        world = bpy.data.worlds.new("world")
        world.use_nodes = True
        bpy.context.scene.world = world
        self.world, self.nodes = world, Nodes(world.node_tree)
        getattr(self, kind)(backdrop)

    def sky(self, stops, strength=1.0):
        """A world whose radiance depends on the height alone; stops from straight down to up."""
        if len(stops) == 1:
            colour = [*stops[0][1], 1.0]
        else:
            place = self.nodes.add("ShaderNodeTexCoord").outputs["Generated"]
            height = self.nodes.add("ShaderNodeSeparateXYZ", {0: place}).outputs["Z"]
            share = {0: height, 1: 0.5, 2: 0.5}
            share = self.nodes.add("ShaderNodeMath", share, operation="MULTIPLY_ADD").outputs[0]
            colour = ramp(self.nodes, share, [(0.5 + 0.5 * z, rgb) for z, rgb in stops])
        emitted = {"Color": colour, "Strength": strength}
        surface = self.nodes.add("ShaderNodeBackground", emitted).outputs[0]
        self.nodes.add("ShaderNodeOutputWorld", {"Surface": surface})

    def lamp(self, kind, direction, distance, size, radiance, kelvin=None):
        """A lamp that looks at the origin.

        direction: (degrees to the picture's right, degrees up) as seen from the subject, 0 towards
        the camera. radiance: of the surface of an area lamp; irradiance of a sun.
        """
        light = bpy.data.lights.new("lamp", kind)
        right, up = (math.radians(d) for d in direction)
        x, y, z = math.sin(right) * math.cos(up), -math.cos(right) * math.cos(up), math.sin(up)
        thing = bpy.data.objects.new("lamp", light)
        thing.location = [distance * self.radius * c for c in (x, y, z)]
        thing.rotation_mode = "XYZ"  # a lamp shines along −Z
        thing.rotation_euler = (math.pi / 2 - up, 0.0, right)
        if kind == "AREA":
            light.shape, light.size = "DISK", size * self.radius
            # Cycles: radiance = power / (π area) for a lamp that shines from one side
            light.energy = radiance * math.pi * math.pi * (0.5 * light.size) ** 2
        else:
            light.energy, light.angle = radiance, math.radians(size)
        if kelvin:
            light.use_nodes = True
            nodes = Nodes(light.node_tree)
            colour = nodes.add("ShaderNodeBlackbody", {0: kelvin}).outputs[0]
            surface = nodes.add("ShaderNodeEmission", {"Color": colour}).outputs[0]
            nodes.add("ShaderNodeOutputLight", {"Surface": surface})
        bpy.context.scene.collection.objects.link(thing)
        self.made.append(thing)

    def wall(self, distance, rgb):
        """A backdrop behind the subject, square to the view."""
        size, far = 40 * self.radius, distance * self.radius
        mesh = bpy.data.meshes.new("wall")
        corners = [(-size, far, -size), (size, far, -size), (size, far, size), (-size, far, size)]
        mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
        mesh.materials.append(plain_material(rgb))
        thing = bpy.data.objects.new("wall", mesh)
        bpy.context.scene.collection.objects.link(thing)
        self.made.append(thing)

    def furnace(self, backdrop):
        """The same radiance, 1, from everywhere: what comes back is the albedo."""
        self.sky([(0.0, (1.0, 1.0, 1.0))])

    def studio(self, backdrop):
        """Neutral: a large key lamp, a weaker fill, a rim from behind, a grey backdrop."""
        self.sky([(0.0, (0.10, 0.10, 0.10))])
        self.lamp("AREA", (-40, 35), 4.0, 2.6, 7.0)
        self.lamp("AREA", (50, 10), 4.5, 3.5, 0.9)
        self.lamp("AREA", (140, 25), 4.0, 1.8, 3.5)
        if backdrop:
            self.wall(5.0, (0.18, 0.18, 0.18))

    def sun(self, backdrop):
        """A clear day: the sun at 40° to the side of the camera, the sky, light from the ground."""
        self.lamp("SUN", (45, 40), 10.0, 0.53, 3.6, kelvin=5500)
        self.sky(
            [
                (-1.0, (0.20, 0.17, 0.13)),
                (-0.02, (0.24, 0.21, 0.17)),
                (0.02, (0.52, 0.68, 0.80)),
                (0.25, (0.33, 0.53, 0.74)),
                (1.0, (0.13, 0.28, 0.50)),
            ]
        )

    def interior(self, backdrop):
        """A room in the evening: a lamp, a window's last light from the other side, warm walls."""
        self.sky([(-1.0, (0.07, 0.055, 0.04)), (1.0, (0.15, 0.125, 0.10))])
        self.lamp("AREA", (42, 28), 3.2, 0.9, 24.0, kelvin=4200)
        self.lamp("AREA", (-70, 10), 4.5, 3.0, 1.1, kelvin=7500)
        self.lamp("AREA", (-145, 30), 4.0, 1.0, 8.0, kelvin=3800)
        if backdrop:
            self.wall(6.0, (0.17, 0.13, 0.095))

    def remove(self):
        for thing in self.made:
            bpy.data.objects.remove(thing)
        bpy.data.worlds.remove(self.world)


# Camera and picture ----------------------------------------------------------------------------


def frame(picture, subject, camera):
    """Looks at the subject from the front so that it fills the picture at any turn.

    Under the furnace light a patch is seen square on without perspective, its middle half only.
    """
    width, height = picture["width"], picture["height"]
    lens = camera.data
    lens.sensor_fit = "HORIZONTAL" if width >= height else "VERTICAL"
    lens.sensor_width = lens.sensor_height = SENSOR
    lens.clip_start, lens.clip_end = 1e-3 * subject.radius, 1e3 * subject.radius
    camera.rotation_euler = (math.pi / 2, 0.0, 0.0)
    points = subject.points
    if picture["mesh"] == "patch" and picture["light"] == "furnace":
        lens.type = "ORTHO"
        lens.ortho_scale = 0.5 * 0.2
        camera.location = (0.0, -4 * subject.radius, 0.0)
        return
    lens.type, lens.lens = "PERSP", LENS * picture["zoom"]
    half = [
        0.5 * SENSOR / LENS * side / max(width, height) * (1 - MARGIN) for side in (width, height)
    ]
    around = np.hypot(points[:, 0], points[:, 1])  # as far out, and as near, as any turn brings it
    if picture["mesh"] == "patch":
        around = np.abs(points[:, 0])
    near = np.abs(points[:, 2]) / half[1] + (around if picture["mesh"] != "patch" else 0.0)
    # A point on a circle of radius a is at most a / sqrt(d² − a²) to the side of the middle.
    side = around * math.sqrt(1 + 1 / half[0] ** 2)
    distance = float(max(near.max(), side.max()))
    camera.location = (0.0, -distance, 0.0)
    longest = max(width, height)
    lens.shift_x = (picture["centre"][0] - 0.5) * width / longest * picture["zoom"]
    lens.shift_y = (picture["centre"][1] - 0.5) * height / longest * picture["zoom"]


def choose_device(wanted):
    """CPU, or GPU where Cycles finds one; returns its name."""
    scene = bpy.context.scene
    scene.cycles.device = "CPU"
    if wanted == "cpu":
        return "CPU"
    preferences = bpy.context.preferences.addons["cycles"].preferences
    for kind in ("OPTIX", "CUDA", "HIP", "ONEAPI", "METAL"):
        try:
            preferences.compute_device_type = kind
        except TypeError:  # not built for this system
            continue
        preferences.refresh_devices()
        found = [d for d in preferences.devices if d.type == kind]
        if found:
            for device in preferences.devices:
                device.use = device.type == kind
            scene.cycles.device = "GPU"
            return f"{kind}: {', '.join(d.name for d in found)}"
    if wanted == "gpu":
        raise Problem("Cycles finds no GPU here; leave the device to it, or ask for the CPU")
    return "CPU"


def settings(picture):
    """How light is computed: no clamps or thresholds, so that means are right."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = picture["width"], picture["height"]
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = picture["transparent"]
    image = scene.render.image_settings
    if hasattr(image, "media_type"):  # 5.0: before the format
        image.media_type = "IMAGE"
    image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR", "32", "ZIP"
    image.color_mode = "RGBA" if picture["transparent"] else "RGB"
    scene.render.use_file_extension = False
    cycles = scene.cycles
    cycles.samples, cycles.seed = picture["samples"], picture["seed"]
    cycles.use_adaptive_sampling = False
    cycles.sampling_pattern = "TABULATED_SOBOL"
    cycles.light_sampling_threshold = 0.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.max_bounces, cycles.diffuse_bounces, cycles.glossy_bounces = 12, 6, 4
    cycles.film_exposure = GAIN[picture["light"]] * 2.0 ** picture["exposure"]
    cycles.use_denoising = picture["denoise"]
    if picture["denoise"]:
        cycles.denoiser = "OPENIMAGEDENOISE"
        cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
        cycles.denoising_prefilter = "ACCURATE"


class Progress:
    """Tells samples from Cycles' own status lines, and ends when the one who asked is gone."""

    def __init__(self):
        self.parent = os.getppid()
        if sys.platform == "linux":  # at once; elsewhere it has to wait for a status line
            ctypes.CDLL(None).prctl(1, 9)  # PR_SET_PDEATHSIG, SIGKILL
        self.picture, self.sample = 0, -1
        bpy.app.handlers.render_stats.append(self.heard)

    def heard(self, status, *_):
        if os.name == "posix" and os.getppid() != self.parent:
            os._exit(1)
        found = re.search(r"Sample (\d+)/\d+", status if isinstance(status, str) else "")
        if found and int(found[1]) != self.sample:
            self.sample = int(found[1])
            tell(event="sample", picture=self.picture, sample=self.sample)


class Studio:
    """Renders one picture after another and keeps what the next one shares."""

    def __init__(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = bpy.context.scene
        self.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        self.scene.collection.objects.link(self.camera)
        self.scene.camera = self.camera
        self.textures = Textures()
        self.subject: Subject | None = None
        self.room: Room | None = None
        self.key = self.device = None
        self.told: set[str] = set()

    def arrange(self, picture):
        """Sets everything up for a picture; returns the material of its skin."""
        paths = ("base_colour", "radius", "normal", "roughness")
        self.textures.keep({picture[p] for p in paths if isinstance(picture[p], str)})
        settings(picture)
        if self.device != picture["device"]:
            self.device = picture["device"]
            tell(event="device", name=choose_device(self.device))
        subject = self.look_at(picture)
        colour = picture["base_colour"]
        if isinstance(colour, str):
            there = tiles_of(colour) or None
            subject.notes += [note for note in subject.outside(there) if note not in subject.notes]
        for note in [note for note in subject.notes if note not in self.told]:
            self.told.add(note)
            tell(event="note", message=note)
        material = skin_material(picture, self.textures)
        for thing in subject.objects:
            thing.data.materials[0] = material
        subject.turntable.rotation_euler = (
            math.radians(-picture["tilt"]),
            0.0,
            math.radians(picture["turn"]),
        )
        if self.room:
            self.room.remove()
        backdrop = picture["backdrop"] and not picture["transparent"]
        self.room = Room(picture["light"], subject.radius, backdrop)
        frame(picture, subject, self.camera)
        return material

    def render(self, picture):
        material = self.arrange(picture)
        self.shoot(picture["output"])
        bpy.data.materials.remove(material)

    def shoot(self, output):
        self.scene.render.filepath = output
        bpy.ops.render.render(write_still=True)
        if not os.path.exists(output):
            raise Problem("Cycles wrote no picture")

    def save(self, picture):
        """Writes a .blend: the material as an asset, on its subject, with lights and camera.

        Textures lie beside the file and are named relative to it. All is made in the units that the
        material is for.
        """
        global MILLIMETRE
        asset = picture["asset"]
        MILLIMETRE = asset["units_per_millimetre"]
        material = self.arrange(picture)
        material.name = asset["name"]
        self.shoot(picture["output"] + ".exr")
        show(material, picture["output"] + ".exr")
        material.asset_mark()
        for key in ("author", "description", "license", "copyright"):
            setattr(material.asset_data, key, asset[key])
        for tag in asset["tags"]:
            material.asset_data.tags.new(tag)
        scale_by_value(material.node_tree, picture["scale"])
        lay_out(material.node_tree)
        for path in (1000 * "/", "//"):  # the old path would stay in the file behind the new one
            self.scene.render.filepath = path
        for image in self.textures.images.values():
            image.name = os.path.basename(image.filepath)
            image.filepath = "//" + os.path.basename(image.filepath)
        bpy.ops.wm.save_as_mainfile(
            filepath=picture["output"], compress=True, relative_remap=False, copy=True
        )

    def look_at(self, picture):
        """The subject; its mesh is loaded unless it is there."""
        aspect = 1.0
        if picture["mesh"] == "patch" and isinstance(picture["base_colour"], str):
            width, height = self.textures.get(picture["base_colour"], LINEAR).size
            aspect = width / height
        names = ("mesh", "millimetres_per_unit", "subdivision")
        key = (aspect, *(picture[name] for name in names))
        if self.subject and key == self.key:
            return self.subject
        if self.subject:
            self.subject.remove()
        self.subject, self.key = Subject(picture, aspect), key
        for thing in self.subject.eye_objects:
            size = np.ptp(positions(thing.data), axis=0)
            thing.data.materials[0] = eye_material(size.min() > 0.7 * size.max())
        return self.subject


# Materials as assets ---------------------------------------------------------------------------


def show(material, path):
    """A rendered picture as the preview of a material in the asset browser."""
    image = bpy.data.images.load(path)
    pixels = np.empty(4 * image.size[0] * image.size[1], np.float32)
    image.pixels.foreach_get(pixels)
    texels = pixels.reshape(-1, 4)
    rgb = texels[:, :3].clip(0, 1)
    texels[:, :3] = np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * rgb ** (1 / 2.4) - 0.055)
    preview = material.preview_ensure()
    preview.image_size = image.size
    preview.image_pixels_float.foreach_set(pixels)
    bpy.data.images.remove(image)


def scale_by_value(tree, factor):
    """One node for the length of a millimetre, where each lobe had a number of its own."""
    unit = tree.nodes.new("ShaderNodeValue")
    unit.label = unit.name = "Scene units per millimetre"
    unit.outputs[0].default_value = MILLIMETRE
    scale = unit.outputs[0]
    if factor != 1:
        product = tree.nodes.new("ShaderNodeMath")
        product.operation, product.inputs[1].default_value = "MULTIPLY", factor
        tree.links.new(scale, product.inputs[0])
        scale = product.outputs[0]
    for node in tree.nodes:
        if node.type == "BSDF_PRINCIPLED":
            tree.links.new(scale, node.inputs["Subsurface Scale"])


def lay_out(tree):
    """Nodes in columns, each left of what it goes into."""
    column = {node: 0 for node in tree.nodes}
    for _ in tree.nodes:
        for link in tree.links:
            column[link.from_node] = max(column[link.from_node], column[link.to_node] + 1)
    lowest = [0] * (1 + max(column.values()))
    for node, place in column.items():
        node.location = (-320 * place, lowest[place])
        lowest[place] -= 700 if node.type == "BSDF_PRINCIPLED" else 320


def main(path):
    with open(path, encoding="utf-8") as file:
        pictures = json.load(file)["pictures"]
    number, studio, progress = 0, Studio(), Progress()
    try:
        for number, picture in enumerate(pictures):
            progress.picture, progress.sample = number, -1
            start = time.monotonic()
            (studio.save if "asset" in picture else studio.render)(picture)
            tell(event="done", picture=number, seconds=round(time.monotonic() - start, 3))
    except Problem as problem:
        tell(event="error", picture=number, message=str(problem))
        return 1
    except MemoryError:
        tell(event="error", picture=number, message="out of memory")
        return 1
    return 0


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    status = main(given[0])
    sys.stdout.flush()
    os._exit(status)  # all is written; taking itself apart, the module of 4.2 crashes
