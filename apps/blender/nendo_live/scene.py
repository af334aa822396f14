"""The objects that show a run: an empty for the stage, the model, and an armature for each hand."""
import bpy
import numpy as np
from mathutils import Matrix

from . import compat, mapping

TAG = "nendo_live"  # a property of the objects: an undo replaces objects, and users rename them
STAGE, MODEL = "stage", "model"


class CannotMake(Exception):
    """Objects cannot be made now. The message is one line for the user."""


def set_geometry(mesh, points, sizes, corners):
    """Replaces the mesh by these points (n, 3), and polygons with these numbers of corners."""
    mesh.clear_geometry()
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(points, np.float32).ravel())
    sizes = np.ascontiguousarray(sizes, np.int32)
    starts = (np.cumsum(sizes) - sizes).astype(np.int32)
    compat.set_polygons(mesh, sizes, starts, np.ascontiguousarray(corners, np.int32).ravel())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(sizes), bool))
    mesh.update(calc_edges=True)
    mesh.validate()


def parent_to(thing, parent):
    """Without an inverse matrix: the thing's own transform is relative to the parent."""
    thing.parent = parent
    thing.matrix_parent_inverse = Matrix()


class Objects:
    """Of one run. `label` is in the names of new objects. All functions are called by Blender's main thread."""

    def __init__(self, name, label=""):
        self.name, self.label = name, label or name
        self._names = {}
        self._rigs = {}  # of each side: names, rest and order of the bones
        self._points = np.zeros((0, 3), np.float32)

    def find(self, kind):
        """The object, or None if there is none."""
        tag = f"{self.name}/{kind}"
        known = bpy.data.objects.get(self._names.get(kind, ""))
        if known is None or known.get(TAG) != tag:
            known = next((each for each in bpy.data.objects if each.get(TAG) == tag), None)
            self._names[kind] = known.name if known else ""
        return known

    def rigs(self):
        """The armature of each hand, or None."""
        return [self.find(side) for side in mapping.SIDES]

    def _object(self, kind, name, make_data):
        thing = self.find(kind)
        if thing is None:
            thing = bpy.data.objects.new(name, make_data())
            thing[TAG] = f"{self.name}/{kind}"
            self._names[kind] = thing.name
            self._collection().objects.link(thing)
        return thing

    def _collection(self):
        for collection in bpy.data.collections:
            if collection.get(TAG) == self.name:
                return collection
        collection = bpy.data.collections.new(f"Nendo {self.label}")
        collection[TAG] = self.name
        bpy.context.scene.collection.children.link(collection)
        return collection

    def make(self, content, frame, template=None, placement=None):
        """Makes the objects that are missing, and fits those that are there to this content. `template` is a mesh whose polygons
        and materials the model takes, if it has as many vertices. `placement` moves the stage. Raises CannotMake."""
        if bpy.context.mode != "OBJECT":
            raise CannotMake("Leave edit mode, so that the objects of the run can be made")
        stage = self._object(STAGE, f"{self.label} stage", lambda: None)
        stage.empty_display_size = 0.1
        if placement is not None:
            stage.matrix_world = placement
        if content.vertices:
            self._make_model(stage, content, template)
        for side in (0, 1):
            if frame.present[side]:
                self._make_rig(stage, side, frame.joints[side], content.radii_m[side])

    def _make_model(self, stage, content, template):
        if template is not None and len(template.vertices) != content.vertices:
            template = None
        model = self.find(MODEL)
        if model is not None and model.mode != "OBJECT":
            raise CannotMake("Leave edit mode, so that the model can follow the run")
        model = self._object(MODEL, f"{self.label} model",
                             lambda: template.copy() if template else bpy.data.meshes.new(f"{self.label} model"))
        parent_to(model, stage)
        if model.data.shape_keys:
            model.shape_key_clear()
        if template is None:
            sizes = np.full(len(content.triangles), 3)
            set_geometry(model.data, np.zeros((content.vertices, 3)), sizes, content.triangles)

    def _make_rig(self, stage, side, joints, radii_m):
        names, rest = mapping.bone_names(side), mapping.rest_matrices(joints, side)
        rig = self._object(mapping.SIDES[side], f"{mapping.SIDES[side]} hand",
                           lambda: bpy.data.armatures.new(f"{mapping.SIDES[side]} hand"))
        parent_to(rig, stage)
        rig.data.display_type = "ENVELOPE"
        self._rigs.pop(side, None)
        bones = rig.data.bones
        if all(name in bones for name in names) and len(bones) == len(names) and \
                np.abs(np.array([bones[name].matrix_local for name in names]) - rest).max() < 1e-4:
            return  # the same hand
        self._edit_bones(rig, names, rest, radii_m)
        for bone in rig.pose.bones:
            bone.rotation_mode = "QUATERNION"

    @staticmethod
    def _edit_bones(rig, names, rest, radii_m):
        layer = bpy.context.view_layer
        active, hidden = layer.objects.active, rig.hide_get()
        with compat.in_window():
            try:
                rig.hide_set(False)
                layer.objects.active = rig
                bpy.ops.object.mode_set(mode="EDIT")
            except RuntimeError:
                raise CannotMake(f"Show the collection of {rig.name}, so that its bones can be made") from None
            try:
                edit = rig.data.edit_bones
                for bone in list(edit):
                    edit.remove(bone)
                lengths = mapping.bone_lengths_m(rest)
                for at in mapping.PARENTS_FIRST:
                    bone = edit.new(names[at])
                    bone.head, bone.tail = (0.0, 0.0, 0.0), (0.0, lengths[at], 0.0)
                    bone.matrix = Matrix(rest[at].tolist())
                    bone.head_radius = bone.tail_radius = float(radii_m[at]) or 0.008
                    bone.envelope_distance = 0.0
                    if mapping.PARENTS[at] >= 0:
                        bone.parent = edit[names[mapping.PARENTS[at]]]
            finally:
                bpy.ops.object.mode_set(mode="OBJECT")
                rig.hide_set(hidden)
                layer.objects.active = active

    def _rig_facts(self, side, rig):
        """The rest of the bones as Blender has rounded it, in the order of the joints; and the joint of each pose bone."""
        if side not in self._rigs:
            names = mapping.bone_names(side)
            rest = np.array([rig.data.bones[name].matrix_local for name in names], float)
            self._rigs[side] = (rest, [names.index(bone.name) for bone in rig.pose.bones])
        return self._rigs[side]

    def rest(self, side):
        return self._rig_facts(side, self.find(mapping.SIDES[side]))[0]

    def show_hands(self, frame):
        for side, rig in enumerate(self.rigs()):
            if rig is None or not frame.present[side] or rig.mode == "EDIT" or len(rig.pose.bones) != len(mapping.JOINT_NAMES):
                continue
            rest, order = self._rig_facts(side, rig)
            bases = mapping.bone_bases(frame.joints[side], rest)[order]
            columns = np.ascontiguousarray(bases.transpose(0, 2, 1), np.float32)
            rig.pose.bones.foreach_set("matrix_basis", columns.ravel())
            rig.update_tag(refresh={"OBJECT", "DATA"})

    def show_shape(self, floats, content, frame):
        """Moves the vertices. False if the model is being edited, or has other vertices."""
        model = self.find(MODEL)
        if model is None or model.mode != "OBJECT" or len(model.data.vertices) != len(floats):
            return False
        model.data.vertices.foreach_set("co", self.points(floats, content, frame).ravel())
        model.data.update()
        return True

    def points(self, floats, content, frame):
        """(n, 3) float32, in the coordinates of the model's object. The next call overwrites them."""
        if len(self._points) != len(floats):
            self._points = np.empty((len(floats), 3), np.float32)
        mapping.vertices(floats, content.setup, frame.units_per_metre, self._points)
        return self._points

    def remove(self):
        """Removes all objects of the run, and their data."""
        for kind in (*mapping.SIDES, MODEL, STAGE):
            thing = self.find(kind)
            if thing is None:
                continue
            data = thing.data
            bpy.data.objects.remove(thing)
            if data is not None and data.users == 0:
                (bpy.data.meshes if isinstance(data, bpy.types.Mesh) else bpy.data.armatures).remove(data)
        for collection in bpy.data.collections:
            if collection.get(TAG) == self.name and not collection.all_objects:
                bpy.data.collections.remove(collection)
                break
