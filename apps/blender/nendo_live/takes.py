"""A take: what the hands and the shape do while the user records, as objects of their own with actions. Ticks are chosen for the
frames of the scene while recording; the objects are made afterwards, by steps that are short."""
import os

import bpy
import numpy as np

from . import compat, keys, mapping, scene

CACHE, SHAPE_KEYS, NO_SHAPE = "CACHE", "KEYS", "NONE"
MAX_SHAPE_KEYS = 250
_LINEAR = 1  # Blender's number for this interpolation
_MIN_LOCATION_M = 1e-6


class Take:
    """Collects keys. `first_frame` is the frame of the scene that the first tick gets."""

    def __init__(self, objects, epoch, rate_hz, first_frame, shape_as, cache_path):
        self.objects, self.epoch, self.first_frame, self.shape_as = objects, epoch, first_frame, shape_as
        self.hands = ([], [])  # of each side: (frame from 0, joints)
        self.shapes = []       # (frame from 0, points), only where the shape changed
        self.length = 0        # in frames
        self.last_number = 0   # of the records that were taken
        self.note = ""         # why the recording of the shape ended early
        self._hands, self._shapes = keys.Sampler(rate_hz), keys.Sampler(rate_hz)
        self._cache_path, self.cache, self._shown = cache_path, None, None

    def add_frame(self, frame):
        for at, chosen in self._hands.feed(frame.woke_ns, frame):
            self.length = at + 1
            for side in (0, 1):
                if chosen.present[side]:
                    self.hands[side].append((at, chosen.joints[side]))
        self.last_number = frame.number

    def add_shape(self, time_ns, points):
        """The points are kept, so they must not change."""
        if self.shape_as == NO_SHAPE:
            return
        for at, chosen in self._shapes.feed(time_ns, points):
            try:
                self._add_points(at, chosen)
            except OSError as error:
                self.note = f"The shape is not recorded further: {error.strerror}"
                self.shape_as = NO_SHAPE
                return

    def _add_points(self, at, points):
        if self.shape_as == CACHE:
            if self.cache is None:
                self.cache = keys.PointCache(self._cache_path, len(points))
            self.cache.add(points)
        elif points is not self._shown:
            if len(self.shapes) == MAX_SHAPE_KEYS:
                self.note = f"The shape has {MAX_SHAPE_KEYS} keys, and is not recorded further"
                return
            self.shapes.append((at, points))
        self._shown = points

    def is_empty(self):
        return self.length == 0

    def build(self):
        """Makes the objects. A generator: between its steps the interface may work."""
        number = 1 + max((each.get("nendo_take", 0) for each in bpy.data.collections), default=0)
        collection = bpy.data.collections.new(f"Nendo take {number}")
        collection["nendo_take"] = number
        bpy.context.scene.collection.children.link(collection)
        self.collection = collection
        stage = bpy.data.objects.new(f"take {number} stage", None)
        live = self.objects.find(scene.STAGE)
        if live is not None:
            stage.matrix_world = live.matrix_world
            stage.empty_display_size = live.empty_display_size
        collection.objects.link(stage)
        yield
        for side in (0, 1):
            if self.hands[side] and self.objects.rigs()[side] is not None:
                yield from self._build_hand(side, stage, collection, number)
        if self.cache is not None or self.shapes:
            yield from self._build_model(stage, collection, number)

    def _copy(self, live, stage, collection, number):
        thing = live.copy()
        thing.name = f"{live.name} take {number}"
        del thing[scene.TAG]
        scene.parent_to(thing, stage)
        collection.objects.link(thing)
        return thing

    def _build_hand(self, side, stage, collection, number):
        frames = np.array([at for at, _ in self.hands[side]], float) + self.first_frame
        joints = np.array([joints for _, joints in self.hands[side]])
        bases = mapping.bone_bases(joints, self.objects.rest(side))
        turns = mapping.continuous(mapping.quaternions(bases[..., :3, :3]))
        yield
        rig = self._copy(self.objects.rigs()[side], stage, collection, number)
        _, new_curve = compat.animate(rig, f"{mapping.SIDES[side]} hand take {number}")
        for at, name in enumerate(mapping.bone_names(side)):
            path = f'pose.bones["{name}"].'
            for index in range(4):
                _key(new_curve(path + "rotation_quaternion", index, name), frames, turns[:, at, index])
            moves = np.abs(bases[:, at, :3, 3]).max() > _MIN_LOCATION_M
            for index in range(3 if moves else 0):
                _key(new_curve(path + "location", index, name), frames, bases[:, at, index, 3])
            yield

    def _build_model(self, stage, collection, number):
        live = self.objects.find(scene.MODEL)
        if live is None:
            return
        model = self._copy(live, stage, collection, number)
        model.data = live.data.copy()
        yield
        if self.cache is not None:
            while self.cache.frames < self.length and not self.note:  # the last shapes may have been too late
                self.cache.add(self._shown)
            self.cache.finish()
            modifier = model.modifiers.new("take", "MESH_CACHE")
            modifier.cache_format = "PC2"
            modifier.filepath = bpy.path.relpath(self.cache.path) if bpy.data.filepath else self.cache.path
            modifier.frame_start = self.first_frame
            return
        yield from self._build_shape_keys(model, number)

    def _build_shape_keys(self, model, number):
        """Each key goes from 0 to 1 in one frame and back in one: in between, Blender mixes neighbours."""
        first = self.shapes[0][1].ravel()
        model.data.vertices.foreach_set("co", first)
        model.data.update()
        model.shape_key_add(name="Basis", from_mix=False)
        names = []
        for at, points in self.shapes[1:]:  # the first shape is the basis
            block = model.shape_key_add(name=f"frame {at + self.first_frame}", from_mix=False)
            block.data.foreach_set("co", points.ravel())
            names.append(block.name)
            yield
        _, new_curve = compat.animate(model.data.shape_keys, f"shape take {number}")
        begins = [at for at, _ in self.shapes]
        for at, name in enumerate(names, 1):
            frames, values = [begins[at] - 1, begins[at]], [0.0, 1.0]
            if at + 1 < len(begins):
                end = begins[at + 1] - 1
                if end > begins[at]:
                    frames, values = frames + [end], values + [1.0]
                frames, values = frames + [end + 1], values + [0.0]
            _key(new_curve(f'key_blocks["{name}"].value', 0, ""), np.array(frames, float) + self.first_frame, np.array(values))
            yield

    def discard(self):
        """Nothing was recorded, or nothing should be kept."""
        if self.cache is not None:
            self.cache.discard()


def _key(curve, frames, values):
    points = curve.keyframe_points
    points.add(len(frames))
    points.foreach_set("co", np.stack([frames, values], axis=1).astype(np.float32).ravel())
    points.foreach_set("interpolation", np.full(len(frames), _LINEAR, np.int32))
    curve.update()


def cache_path(name):
    """A new file beside the .blend, or None if that was never saved."""
    if not bpy.data.filepath:
        return None
    folder, base = os.path.split(bpy.data.filepath)
    for number in range(1, 10000):
        path = os.path.join(folder, f"{os.path.splitext(base)[0]}-{name}-{number}.pc2")
        if not os.path.exists(path):
            return path
    return None
