import importlib.util
import json
import os
import struct
import subprocess
import tempfile
import unittest

import numpy as np

from nendo_live import mapping

PROGRAM = os.environ.get("NENDO_PROGRAM", "nendo")


def times(a, b):
    """The product of two quaternions w x y z."""
    w, v = a[0] * b[0] - np.dot(a[1:], b[1:]), a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.array([w, *v])


def turned(q, v):
    """A vector, turned by a quaternion w x y z."""
    return times(times(q, np.array([0.0, *v])), q * [1, -1, -1, -1])[1:]


def hand(seed, count=()):
    """Joints (..., 26, 7) whose neighbours are near each other, as random hands."""
    random = np.random.default_rng(seed)
    joints = random.normal(scale=0.05, size=(*count, 26, 7))
    joints[..., 3:] = random.normal(size=(*count, 26, 4))
    joints[..., 3:] /= np.linalg.norm(joints[..., 3:], axis=-1, keepdims=True)
    return joints


class Axes(unittest.TestCase):
    def test_up_stays_up_and_left_stays_left(self):
        # The stage: x to the right, y up, z to the operator. Blender from the front: x to the right, z up, -y to the viewer.
        np.testing.assert_array_equal(mapping.to_blender(np.eye(3)), [[1, 0, 0], [0, 0, 1], [0, -1, 0]])
        points = np.random.default_rng(1).normal(size=(5, 3))
        np.testing.assert_array_equal(mapping.to_stage(mapping.to_blender(points)), points)

    def test_vertices_are_metres_of_the_stage(self):
        class setup:
            origin, unit, offset = np.array([1.0, -2.0, 3.0]), 0.25, np.array([100.0, 0.0, 0.0])
        floats = np.random.default_rng(2).normal(size=(50, 3)).astype(np.float32)
        out = np.empty((50, 3), np.float32)
        mapping.vertices(floats, setup, 4.0, out)
        for place, numbers in zip(out, floats.astype(float)):
            x, y, z = (setup.origin + setup.unit * numbers) / 4.0
            np.testing.assert_allclose(place, [x, -z, y], atol=1e-6)
        np.testing.assert_allclose(mapping.model_points(floats, setup), setup.offset + setup.origin + 0.25 * floats, atol=1e-12)


class Bones(unittest.TestCase):
    def test_a_bone_points_where_the_joint_points(self):
        """A joint of OpenXR points along -z, its back is +y; a bone points along +y, and its z axis is here the back."""
        joints = hand(3)
        for joint, matrix in zip(joints, mapping.joint_matrices(joints)):
            q = joint[[6, 3, 4, 5]]
            for column, axis in ((0, (1, 0, 0)), (1, (0, 0, -1)), (2, (0, 1, 0))):
                np.testing.assert_allclose(matrix[:3, column], mapping.to_blender(turned(q, axis)), atol=1e-12)
            np.testing.assert_allclose(matrix[:3, 3], mapping.to_blender(joint[:3]), atol=1e-15)

    def test_bases_turn_the_rest_into_the_pose(self):
        """Walks the bones as Blender does: parent's pose, offset at rest, basis."""
        joints = hand(4, (6,))
        for side in (0, 1):
            rest = mapping.rest_matrices(joints[0], side)
            bases = mapping.bone_bases(joints, rest)
            wanted = mapping.joint_matrices(joints)
            for at in range(6):
                pose = {}
                for bone in mapping.PARENTS_FIRST:
                    parent = mapping.PARENTS[bone]
                    above = np.eye(4) if parent < 0 else pose[parent] @ np.linalg.inv(rest[parent])
                    pose[bone] = above @ rest[bone] @ bases[at, bone]
                    np.testing.assert_allclose(pose[bone], wanted[at, bone], atol=1e-12)

    def test_the_rest_is_the_skeleton_with_all_angles_at_zero(self):
        if not importlib.util.find_spec("nendo"):
            self.skipTest("the module nendo is not here")
        import nendo
        random = np.random.default_rng(5)
        angles = random.uniform(-0.3, 1.0, 23)
        angles[nendo.ANGLE_NAMES.index("palm_arch")] = 0.0
        wrist = np.eye(4)
        wrist[:3, :3], wrist[:3, 3] = mapping.rotations(random.normal(size=4)), (0.3, 1.0, -0.2)
        for side, name in enumerate(mapping.SIDES):
            skeleton = nendo.HandSkeleton(name)
            posed, open_hand = (np.asarray(skeleton.pose(each)) for each in (angles, np.zeros(23)))
            joints = np.zeros((26, 7))
            for at, matrix in enumerate(wrist @ posed):
                w, *xyz = mapping.quaternions(matrix[:3, :3])
                joints[at] = [*matrix[:3, 3], *xyz, w]
            rest = mapping.rest_matrices(joints, side)
            for at, matrix in enumerate(open_hand):
                np.testing.assert_allclose(rest[at, :3, 3], mapping.to_blender(matrix[:3, 3]), atol=1e-5)
                for column, axis in ((0, 0), (2, 1)):
                    np.testing.assert_allclose(rest[at, :3, column], mapping.to_blender(matrix[:3, axis]), atol=1e-4)

    def test_lengths_reach_the_next_joint(self):
        rest = mapping.rest_matrices(hand(6), 1)
        lengths = mapping.bone_lengths_m(rest)
        for name, follower in (("index_proximal", "index_intermediate"), ("thumb_distal", "thumb_tip")):
            at, after = mapping.JOINT_NAMES.index(name), mapping.JOINT_NAMES.index(follower)
            self.assertAlmostEqual(lengths[at], np.linalg.norm(rest[after, :3, 3] - rest[at, :3, 3]))
        self.assertGreater(lengths.min(), 0.0)

    def test_names_and_parents_are_those_of_the_gltf_export(self):
        with tempfile.TemporaryDirectory() as folder:
            for words in (["record", "sim:pinch?hand=left", "sim:grasp", "--duration", "0.3s", "--out", "take.nendo"],
                          ["export", "take.nendo", "--out", "take.glb"]):
                subprocess.run([PROGRAM, *words], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            with open(os.path.join(folder, "take.glb"), "rb") as file:
                data = file.read()
        nodes = json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])["nodes"]
        for side in (0, 1):
            names = mapping.bone_names(side)
            parents = {nodes[child]["name"]: node["name"] for node in nodes for child in node.get("children", ())}
            for name, parent in zip(names, mapping.PARENTS):
                self.assertEqual(parents[name], names[parent] if parent >= 0 else mapping.SIDES[side] + " hand")
            mine = {node["name"] for node in nodes if node["name"].endswith(mapping.SUFFIXES[side])}
            self.assertEqual(mine, set(names))


class Quaternions(unittest.TestCase):
    def test_they_are_those_of_the_rotations(self):
        random = np.random.default_rng(7)
        wanted = random.normal(size=(300, 4))
        wanted[:6] = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [1e-9, 1, 0, 0], [0.5, 0.5, -0.5, 0.5]]
        wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
        found = mapping.quaternions(mapping.rotations(wanted[:, [1, 2, 3, 0]]))
        np.testing.assert_allclose(np.abs(np.sum(found * wanted, axis=1)), 1.0, atol=1e-12)
        self.assertTrue((found[:, 0] >= 0).all())
        np.testing.assert_array_equal(mapping.rotations(np.zeros(4)), np.eye(3))

    def test_neighbours_in_time_are_similar(self):
        angles = np.linspace(0, 4 * np.pi, 100)
        turns = np.stack([np.cos(angles / 2), np.sin(angles / 2), 0 * angles, 0 * angles], -1)
        jumping = mapping.quaternions(mapping.rotations(turns[:, [1, 2, 3, 0]]))
        self.assertLess(np.sum(jumping[1:] * jumping[:-1], axis=1).min(), 0.0)
        smooth = mapping.continuous(jumping)
        self.assertGreater(np.sum(smooth[1:] * smooth[:-1], axis=1).min(), 0.9)


if __name__ == "__main__":
    unittest.main()
