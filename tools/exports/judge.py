"""Runs in Blender: imports exports and compares vertices and joints with nendo's own. See tools/check-exports."""
import csv
import glob
import json
import math
import os
import struct
import sys
import tomllib

import bpy
import numpy as np
from mathutils import Vector

WORK, MODEL = sys.argv[sys.argv.index("--") + 1:]
FPS = 30
NEAR = 1e-5  # of the diagonal
complaints = 0


def say(what, value, limit):
    global complaints
    fine = value <= limit
    complaints += not fine
    print(f"nendo: {'' if fine else 'TOO FAR: '}{what}: {value:.2e} (at most {limit:.2e})", flush=True)


def path(name):
    return os.path.abspath(os.path.join(WORK, name))


def read_ply(file):
    """The vertices of a binary little-endian PLY as nendo writes it."""
    data = open(file, "rb").read()
    head, _, body = data.partition(b"end_header\n")
    count, kinds, inside = 0, [], False
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            inside = words[1] == "vertex"
            count = int(words[2]) if inside else count
        elif words[0] == "property" and inside:
            kinds.append((words[2], {"double": "<f8", "float": "<f4", "uchar": "u1"}[words[1]]))
    table = np.frombuffer(body, dtype=np.dtype(kinds), count=count)
    return np.stack([table["x"], table["y"], table["z"]], axis=1).astype(float)


def read_csv(name):
    with open(path(name), newline="") as file:
        return list(csv.DictReader(file))


def begin():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = FPS


def go_to(frame):
    whole = math.floor(frame)
    bpy.context.scene.frame_set(whole, subframe=frame - whole)
    return bpy.context.evaluated_depsgraph_get()


def vertices(thing, graph):
    shaped = thing.evaluated_get(graph)
    mesh = shaped.to_mesh()
    places = np.empty(3 * len(mesh.vertices))
    mesh.vertices.foreach_get("co", places)
    shaped.to_mesh_clear()
    return places.reshape(-1, 3)


def in_gltf(thing, graph):
    """In the file's axes: Blender's importer turns y up into z up."""
    world = np.array(thing.evaluated_get(graph).matrix_world)
    places = vertices(thing, graph) @ world[:3, :3].T + world[:3, 3]
    return np.stack([places[:, 0], places[:, 2], -places[:, 1]], axis=1)


def scale_in(file):
    return document_in(file)[0]["nodes"][0]["scale"][0]


def document_in(file):
    with open(file, "rb") as glb:
        data = glb.read()
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20:20 + length]), data[28 + length:]


def numbers_in(document, binary, accessor):
    accessor = document["accessors"][accessor]
    kind, width = {5123: "<u2", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]], {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
    start = document["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0)
    numbers = np.frombuffer(binary, dtype=kind, count=width * accessor["count"], offset=start)
    return numbers.reshape(-1, width) if width > 1 else numbers


def vertices_in(file, obj):
    """For each vertex of Blender's importer, the model's vertices in its place at rest, as rows. The importer takes the vertices
    that each primitive uses, one primitive after another."""
    document, binary = document_in(file)
    by_place = {}
    for number, place in enumerate(read_obj(obj).astype("<f4") + 0):
        by_place.setdefault(place.tobytes(), []).append(number)
    found = []
    for primitive in document["meshes"][document["nodes"][0]["mesh"]]["primitives"]:
        places = numbers_in(document, binary, primitive["attributes"]["POSITION"]) + np.float32(0)
        used = np.unique(numbers_in(document, binary, primitive["indices"]))
        found += [by_place[places[vertex].tobytes()] for vertex in used]
    most = max(len(numbers) for numbers in found)
    return np.array([numbers + numbers[:1] * (most - len(numbers)) for numbers in found])


def vertices_of_rest(thing):
    """The shape of the first key, in the model's own axes and units."""
    basis = thing.data.shape_keys.key_blocks[0]
    places = np.empty(3 * len(basis.data))
    basis.data.foreach_get("co", places)
    places = places.reshape(-1, 3)
    return np.stack([places[:, 0], places[:, 2], -places[:, 1]], axis=1)


def read_obj(file):
    with open(file) as text:
        return np.array([[float(word) for word in line.split()[1:4]] for line in text if line.startswith("v ")])


def farthest(places, wanted):
    return float(np.max(np.linalg.norm(places - wanted, axis=1)))


def farthest_off(places, shape, candidates):
    """Of the importer's vertices. Where several of the model's are in one place at rest, such as those of closed lips, a vertex
    must be where one of them is."""
    off = np.linalg.norm(places[:, None, :] - shape[candidates], axis=2)
    return float(np.max(np.min(off, axis=1)))


def diagonal(places):
    return float(np.linalg.norm(places.max(axis=0) - places.min(axis=0)))


def import_glb(name):
    begin()
    bpy.ops.import_scene.gltf(filepath=path(name))
    return bpy.data.objects["model"]


def judge_tips(name, rows, first_frame, step):
    """Fingertip joints of the armatures against the CSV's."""
    worst = 0.0
    for number in range(0, len(rows), step):
        go_to((float(rows[number]["time_s"]) - float(rows[0]["time_s"])) * FPS + first_frame)
        for side, suffix in (("left", "_L"), ("right", "_R")):
            for finger in ("thumb", "index", "little"):
                for rig in (o for o in bpy.data.objects if o.type == "ARMATURE" and finger + "_tip" + suffix in o.pose.bones):
                    place = rig.matrix_world @ rig.pose.bones[finger + "_tip" + suffix].head
                    wanted = [float(rows[number][f"{side}_{finger}_tip_{axis}_m"]) for axis in "xyz"]
                    worst = max(worst, (Vector((place.x, place.z, -place.y)) - Vector(wanted)).length)
                    judge_tips.seen += 1
    say(f"{name}: fingertips, metres", worst, 2e-5)


judge_tips.seen = 0


def judge_rigs(name, has_model):
    """Each hand is an armature of its own, with its own bones and skin, and the model hangs under neither."""
    global complaints
    begin()
    bpy.ops.import_scene.gltf(filepath=path(name))
    found = {}
    for thing in bpy.data.objects:
        if thing.type == "ARMATURE":
            skins = sorted(child.name for child in thing.children)
            found[thing.name] = (thing.parent, skins, len(thing.data.bones), {bone.name[-2:] for bone in thing.data.bones})
    wanted = {side + " hand": (None, [side + " hand skin"], 26, {suffix}) for side, suffix in (("left", "_L"), ("right", "_R"))}
    model = bpy.data.objects.get("model")
    fine = found == wanted and (model is not None and model.parent is None) == has_model
    complaints += not fine
    print(f"nendo: {'' if fine else 'WRONG: '}{name}: armatures {found}", flush=True)


def judge_even(take, limit, obj):
    """The frames of a file at 30 a second, against the sequence of meshes."""
    model = import_glb(take + "-even.glb")
    scale = scale_in(path(take + "-even.glb"))
    candidates = vertices_in(path(take + "-even.glb"), obj)
    worst = 0.0
    meshes = sorted(glob.glob(path(take + "-[0-9]*.ply")))
    for number in range(0, len(meshes), 7):
        wanted = read_ply(meshes[number]) * scale
        places = in_gltf(model, go_to(number))
        worst = max(worst, farthest_off(places, wanted, candidates) / diagonal(wanted))
    say(f"{take}-even.glb: vertices, parts of the diagonal", worst, limit)


def judge_replayed(take, obj, tips_every):
    model = import_glb(take + ".glb")
    scale = scale_in(path(take + ".glb"))
    candidates = vertices_in(path(take + ".glb"), obj)
    rows = read_csv(take + ".csv")
    rest = vertices_of_rest(model)
    worst, most, seen = 0.0, 0.0, 0
    for file in glob.glob(path(take + "-replayed-*.ply")):
        time_s = float(os.path.basename(file)[len(take + "-replayed-"):-len(".ply")])
        wanted = read_ply(file) * scale
        places = in_gltf(model, go_to((time_s - float(rows[0]["time_s"])) * FPS))
        worst = max(worst, farthest_off(places, wanted, candidates) / diagonal(wanted))
        most = max(most, farthest(places, rest * scale) / diagonal(wanted))
        seen += 1
    assert seen > 2
    print(f"nendo: {take}: vertices move by {most:.3f} of the diagonal", flush=True)
    say(f"{take}.glb against {seen} shapes of nendo replay, parts of the diagonal", worst, NEAR)
    judge_tips(take + ".glb", rows, 0, tips_every)


def judge_cache(take, kind):
    begin()
    bpy.ops.import_scene.obj(filepath=os.path.abspath(MODEL), split_mode="OFF", axis_forward="-Z", axis_up="Y")
    model = next(o for o in bpy.data.objects if o.type == "MESH")
    cache = model.modifiers.new("take", "MESH_CACHE")
    cache.cache_format = kind
    cache.filepath = path(f"{take}.{kind.lower()}")
    cache.frame_start = 0
    worst = 0.0
    meshes = sorted(glob.glob(path(take + "-[0-9]*.ply")))
    for number in range(0, len(meshes), 11):
        wanted = read_ply(meshes[number])
        worst = max(worst, farthest(vertices(model, go_to(number)), wanted) / diagonal(wanted))
    say(f"{take}.{kind.lower()}: vertices, parts of the diagonal", worst, NEAR)


def judge_bvh(take):
    rows = read_csv(take + "-even.csv")
    worst = 0.0
    for side, suffix in (("left", "_L"), ("right", "_R")):
        begin()
        bpy.ops.import_anim.bvh(filepath=path(f"{take}-{side}.bvh"), axis_forward="-Z", axis_up="Y")
        rig = next(o for o in bpy.data.objects if o.type == "ARMATURE")
        for number in range(0, len(rows), 9):
            go_to(number + 1)
            for finger in ("thumb", "index", "little"):
                place = rig.matrix_world @ rig.pose.bones[finger + "_distal" + suffix].tail
                wanted = [100.0 * float(rows[number][f"{side}_{finger}_tip_{axis}_m"]) for axis in "xyz"]
                worst = max(worst, (Vector((place.x, place.z, -place.y)) - Vector(wanted)).length)
    say(f"{take}-left.bvh, {take}-right.bvh: fingertips, centimetres", worst, 2e-3)


def names_in(puppet):
    """The functions of a puppet file, with their twins."""
    with open(puppet, "rb") as file:
        puppet = tomllib.load(file)
    names = set()
    for name, function in puppet["functions"].items():
        names.add(name)
        if function.get("least", 0) < 0:
            names.add(name + "_negative")
        if "mirror" in puppet and name.endswith("Left"):
            names.add(name[:-len("Left")] + "Right")
    return names


def judge_functions(take, puppet, obj):
    """The keys have the functions' names, each of them is played, and without them the shape is the model."""
    global complaints
    model = import_glb(take + "-even.glb")
    keys = model.data.shape_keys.key_blocks
    names = [key.name for key in keys[1:]]
    wanted = names_in(puppet)
    used = dict.fromkeys(names, 0.0)
    for number in range(0, int(bpy.context.scene.frame_end) + 1, 3):
        graph = go_to(number)
        now = model.evaluated_get(graph).data.shape_keys.key_blocks
        for name in names:
            used[name] = max(used[name], now[name].value)
    fine = len(names) == len(wanted) and set(names) == wanted
    complaints += not fine
    played = ", ".join(f"{name} to {used[name]:.2f}" for name in names)
    print(f"nendo: {'' if fine else 'WRONG NAMES: '}{take}: {len(names)} keys: {played}", flush=True)
    model.data.shape_keys.animation_data_clear()
    for key in keys[1:]:
        key.value = 0.0
    rest = read_obj(obj) * scale_in(path(take + "-even.glb"))
    off = farthest_off(in_gltf(model, go_to(0)), rest, vertices_in(path(take + "-even.glb"), obj))
    say(f"{take}: at values of 0 the shape is the model's, parts of the diagonal", off / diagonal(rest), NEAR)
    return used


def base_colour(material):
    """What the importer made of a material's base colour, by which it may multiply the vertices' own."""
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")

    def factor(socket, of_vertices):
        if not socket.is_linked:
            return socket.default_value
        inputs = socket.links[0].from_node.inputs
        return next((one.default_value for one in inputs if one.type == socket.type and not one.is_linked), of_vertices)

    return [*factor(shader.inputs["Base Color"], (1.0, 1.0, 1.0))[:3], factor(shader.inputs["Alpha"], 1.0)]


def judge_colours(name, mtl):
    import_glb(name)
    lines = [line.split() for line in open(mtl) if line.strip() and not line.startswith("#")]
    named, colours = None, {}
    for words in lines:
        named = words[1] if words[0] == "newmtl" else named
        if words[0] == "Kd":
            colours[named] = [float(word) for word in words[1:4]]
    far = max(abs(a - b) for one, kd in colours.items() for a, b in zip(base_colour(bpy.data.materials[one]), kd))
    say(f"{name}: colours of {len(colours)} materials", far, 1e-3)


def judge_texture(name, file):
    import_glb(name)
    kept = [image for image in bpy.data.images if image.size[0] > 0 and image.type == "IMAGE"]
    used = [node.image for material in bpy.data.materials if material.use_nodes
            for node in material.node_tree.nodes if node.type == "TEX_IMAGE"]
    wanted = np.array(bpy.data.images.load(os.path.abspath(file)).pixels)
    pixels = [np.array(image.pixels) for image in kept if image in used]
    far = min((np.abs(one - wanted).max() for one in pixels if one.shape == wanted.shape), default=1.0)
    say(f"{name}: texture", far, 1e-6)


def draw(name, frame, camera_from):
    import_glb(name)
    go_to(frame)
    for material in bpy.data.materials: # the engine below does not look at shaders
        if material.use_nodes:
            material.diffuse_color = base_colour(material)
    scene = bpy.context.scene
    for place, energy in (((1.5, -2.0, 2.0), 90.0), ((-2.0, -1.0, 1.0), 40.0)):
        light = bpy.data.objects.new("light", bpy.data.lights.new("light", "POINT"))
        light.data.energy = energy
        light.location = place
        scene.collection.objects.link(light)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    bounds = [o.matrix_world @ Vector(corner) for o in bpy.data.objects if o.type == "MESH" and o.data.name != "Icosphere"
              for corner in o.bound_box]
    middle = sum(bounds, Vector()) / len(bounds)
    camera.location = middle + Vector(camera_from)
    camera.rotation_euler = (middle - camera.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.display.shading.color_type = "MATERIAL"
    scene.render.resolution_x, scene.render.resolution_y = 960, 720
    scene.render.filepath = path(name.replace(".glb", ".png"))
    bpy.ops.render.render(write_still=True)
    print(f"nendo: picture: {scene.render.filepath}", flush=True)


judge_replayed("type1", MODEL, 31)
judge_replayed("face", "apps/models/face.obj", 97)
judge_replayed("stone", MODEL, 97)
used = judge_functions("face", "apps/models/face.puppet.toml", "apps/models/face.obj")
complaints += sorted(used.values())[1] < 0.5  # sim:faces plays all of them but one eye
used = judge_functions("stone", "tools/exports/moai.puppet.toml", MODEL)
complaints += used["noseLift_negative"] < 0.5 or used["chinOut"] < 0.5
judge_colours("face.glb", "apps/models/face.mtl")
judge_texture("page.glb", "apps/models/face689.png")
judge_even("type1", NEAR, MODEL)
judge_even("linked", 1e-4 + NEAR, MODEL)
judge_even("type2", 1e-4 + NEAR, MODEL)
for take in ("type1", "type2"):
    for kind in ("PC2", "MDD"):
        judge_cache(take, kind)
judge_bvh("type1")
judge_rigs("type2.glb", True)
judge_rigs("gloves.glb", False)
assert judge_tips.seen > 0
draw("type1.glb", 40, (0.9, -1.6, 0.5))
draw("face-even.glb", 144, (0.35, -1.3, 0.1))
print(f"nendo: {complaints} complaints", flush=True)
sys.exit(1 if complaints else 0)
