import unittest

import numpy as np

import nendo
from fixtures import MOAI, TestCase, ball, volume

PSI = {  # Wendland (1995)
    "wendland-c0": lambda t: (1 - t) ** 2,
    "wendland-c2": lambda t: (1 - t) ** 4 * (4 * t + 1),
    "wendland-c4": lambda t: (1 - t) ** 6 * (35 * t**2 + 18 * t + 3) / 3,
    "wendland-c6": lambda t: (1 - t) ** 8 * (32 * t**3 + 25 * t**2 + 8 * t + 1),
}


def moved(points, starts, ends, radius, kernel):
    """The field by a dense matrix."""
    def matrix(one):
        t = np.linalg.norm(one[:, None] - starts[None], axis=-1) / radius
        return np.where(t < 1, PSI[kernel](np.minimum(t, 1)), 0)
    return points + matrix(points) @ np.linalg.solve(matrix(starts), ends - starts)


class Meshes(TestCase):
    def test_arrays_come_back(self):
        vertices, faces = ball()
        mesh = nendo.Mesh(vertices, faces)
        self.assert_same(mesh.vertices, vertices)
        self.assert_same(mesh.faces, faces.astype(np.uint32))
        self.assertEqual(mesh.fault, "")
        self.assertAlmostEqual(mesh.volume, volume(vertices, faces), delta=1e-12)
        self.assert_near(mesh.normals, vertices, 0.05)  # of a sphere
        self.assertAlmostEqual(mesh.diagonal, np.linalg.norm(np.ptp(vertices, axis=0)), delta=1e-12)
        shifted = mesh.with_vertices(vertices + 1)
        self.assert_same(mesh.vertices, vertices)
        self.assert_same(shifted.vertices, vertices + 1)
        self.assertIn("open", nendo.Mesh(vertices, faces[1:].copy()).fault)

    def test_polygons_are_kept_and_triangulated(self):
        square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
        mesh = nendo.Mesh(square, np.array([[0, 1, 2, 3]], np.uint32))
        self.assertEqual((mesh.face_starts.tolist(), mesh.face_corners.tolist()), ([0, 4], [0, 1, 2, 3]))
        self.assertEqual(mesh.faces.shape, (2, 3))

    def test_files_keep_every_bit(self):
        mesh = nendo.Mesh.read(MOAI)
        for ending in (".ply", ".obj"):
            mesh.write(self.folder / f"again{ending}")
            again = nendo.Mesh.read(self.folder / f"again{ending}")
            self.assert_same(again.vertices, mesh.vertices)
            self.assert_same(again.face_corners, mesh.face_corners)
        with self.assertRaises(FileNotFoundError):
            nendo.Mesh.read(self.folder / "none.obj")
        with self.assertRaises(nendo.Error):
            mesh.write(self.folder / "again.xyz")
        (self.folder / "bad.ply").write_bytes(b"ply\n\xff\xfe")
        with self.assertRaises(nendo.Error):
            nendo.Mesh.read(self.folder / "bad.ply")

    def test_cuts_joins_repairs_and_subdivisions_are_those_of_the_program(self):
        mesh = nendo.Mesh.read(MOAI)
        self.run_nendo("cut", MOAI, "--plane", "0,0.9,0,0.1,1,0", "--out", "part-%d.ply")
        parts = mesh.cut((0, 0.9, 0), (0.1, 1, 0))
        self.assertAlmostEqual(sum(part.volume for part in parts), mesh.volume, delta=1e-9)
        for number, part in enumerate(parts, 1):
            file = nendo.Mesh.read(self.folder / f"part-{number}.ply", weld=False)
            self.assert_same(part.vertices, file.vertices)
            self.assert_same(part.face_corners, file.face_corners)

        starts = np.array([[-2, y, -2] for y in (0.8, 0.9, 1.0)])
        ends = starts * [1, 1, 0] + [4, 0, 2]
        starts[:, 2], ends[:, 0], ends[:, 2] = (-2, 0, 2), 2, (-2, 0, 2)
        np.savetxt(self.folder / "wire.txt", np.hstack([starts, ends]), delimiter=",", fmt="%.17g")
        self.run_nendo("cut", MOAI, "--wire", "wire.txt", "--out", "wired-%d.ply")
        for number, part in enumerate(mesh.cut_by_wire(starts, ends), 1):
            self.assert_same(part.vertices, nendo.Mesh.read(self.folder / f"wired-{number}.ply", weld=False).vertices)

        for number, centre in enumerate(((0, 0, 0), (0.9, 0.2, 0.1))):
            nendo.Mesh(*ball(centre=centre)).write(self.folder / f"{number}.ply")
        self.run_nendo("join", "0.ply", "1.ply", "--seam", "0.1", "--out", "joined.ply")
        joined = nendo.join([nendo.Mesh.read(self.folder / f"{k}.ply") for k in (0, 1)], seam_width=0.1)
        self.assert_same(joined.vertices, nendo.Mesh.read(self.folder / "joined.ply", weld=False).vertices)
        self.assertEqual(joined.fault, "")

        vertices, faces = ball()
        holed = nendo.Mesh(vertices, faces[3:].copy())
        holed.write(self.folder / "holed.ply")
        self.run_nendo("repair", "holed.ply", "--out", "whole.ply")
        whole = holed.repair()
        self.assert_same(whole.vertices, nendo.Mesh.read(self.folder / "whole.ply", weld=False).vertices)
        self.assertEqual((whole.fault, len(whole.notes) > 0), ("", True))

        fine = mesh.subdivide()
        self.assertEqual(len(fine.faces), 4 * len(mesh.faces))
        self.assert_same(fine.vertices[:len(mesh.vertices)].copy(), mesh.vertices)
        with self.assertRaisesRegex(nendo.Error, "open"):
            holed.cut((0, 0, 0), (0, 1, 0))


class Deformation(TestCase):
    def setUp(self):
        super().setUp()
        self.random = np.random.default_rng(2)
        self.mesh = nendo.Mesh.read(MOAI)
        self.vertices = self.mesh.vertices
        self.starts = self.vertices[self.random.choice(len(self.vertices), 10, replace=False)]
        self.ends = self.starts + 0.1 * self.random.standard_normal((10, 3))

    def test_a_field_solves_the_equations(self):
        for kernel in PSI:
            field = nendo.Field(self.starts, self.ends, radius=0.4, kernel=kernel)
            expected = moved(self.vertices, self.starts, self.ends, 0.4, kernel)
            self.assert_near(field.displace(self.vertices), expected, 1e-12)
            self.assert_near(field.displacements(self.vertices), expected - self.vertices, 1e-12)
            self.assert_same(nendo.deform(self.vertices, self.starts, self.ends, radius=0.4, kernel=kernel),
                             field.displace(self.vertices))
            t = np.linalg.norm(self.vertices[:, None] - field.centres, axis=-1) / field.radii
            by_hand = np.where(t < 1, PSI[kernel](np.minimum(t, 1)), 0) @ field.coefficients
            self.assert_near(by_hand, expected - self.vertices, 1e-12)
        linear = nendo.Field(self.starts, self.starts @ np.diag([1.1, 1, 0.9]) + 1, radius=0.4, polynomial="linear")
        self.assert_near(linear.displace(self.vertices), self.vertices @ np.diag([1.1, 1, 0.9]) + 1, 1e-9)
        several = nendo.Field(self.starts, self.ends, radius=np.linspace(0.2, 0.5, 10))
        self.assert_near(several.displace(self.starts), self.ends, 1e-12)

    def test_deform_is_that_of_the_program(self):
        rows = np.hstack([self.starts, self.ends - self.starts])
        np.savetxt(self.folder / "vectors.csv", rows, delimiter=",", fmt="%.17g", header="x,y,z,dx,dy,dz", comments="")
        self.run_nendo("deform", MOAI, "--vectors", "vectors.csv", "--radius", "0.4", "--out", "out.ply")
        ends = self.starts + rows[:, 3:]
        program = nendo.Mesh.read(self.folder / "out.ply").vertices
        self.assert_near(nendo.deform(self.vertices, self.starts, ends, radius=0.4), program, 1e-14)

    def test_type_1_starts_from_the_rest_shape(self):
        deformer = nendo.Type1Deformer(self.vertices, self.starts, radius=0.4, undo_bytes=1 << 24)
        near = 1e-5 * self.mesh.diagonal
        expected = moved(self.vertices, self.starts, self.ends, 0.4, "wendland-c2")
        deformer.apply(self.ends + 0.1)
        self.assert_near(deformer.apply(self.ends), expected, near)
        self.assert_same(deformer.rest, self.vertices)
        deformer.commit(self.ends)
        self.assert_near(deformer.rest, expected, near)
        self.assertEqual(deformer.steps, (1, 0))
        deformer.undo(self.starts)
        self.assert_same(deformer.rest, self.vertices)
        deformer.redo(self.ends)
        self.assert_near(deformer.rest, expected, near)
        deformer.reset(self.starts)
        self.assert_same(deformer.rest, self.vertices)
        deformer.release()
        deformer.grab(self.starts)
        self.assert_near(deformer.apply(self.ends), expected, near)

    def test_a_mask_protects_and_injective_fields_do_not_fold(self):
        mask = np.zeros(len(self.vertices))
        deformer = nendo.Type1Deformer(self.vertices, self.starts, radius=0.4, mask=mask)
        self.assert_same(deformer.apply(self.ends), self.vertices)
        axis = np.linspace(-1, 1, 41)
        grid = np.stack(np.meshgrid(axis, axis, [0.0], indexing="ij"), axis=-1).reshape(-1, 3)
        start, end = np.array([[0, 0, 0.0]]), np.array([[0.6, 0, 0.0]])

        def folds(injective):
            shape = nendo.Type1Deformer(grid, start, radius=0.5, injective=injective).apply(end).reshape(41, 41, 3)
            a, b = np.diff(shape[:, :-1], axis=0), np.diff(shape[:-1], axis=1)
            return (np.cross(a, b)[..., 2] <= 0).any()
        self.assertEqual((folds(False), folds(True)), (True, False))

    def test_type_2_follows_the_path(self):
        tip = self.starts[:1].copy()
        deformer = nendo.Type2Deformer(self.vertices, tip, radius=0.4, piece_length=0.02, undo_bytes=1 << 24)
        at = int(np.linalg.norm(self.vertices - tip, axis=1).argmin())
        for step in np.linspace(0, 0.2, 30):
            deformer.stroke_to(tip + [step, 0, 0])
        deformer.end_at(tip + [0.2, 0, 0])
        self.assert_near(deformer.shape[at], tip[0] + [0.2, 0, 0], 1e-3)
        deformer.begin(tip)
        self.assertEqual(deformer.steps, (1, 0))
        deformer.undo(tip)
        self.assert_same(deformer.shape, self.vertices)

    def test_clay_yields_to_balls_and_hands_and_keeps_its_volume(self):
        vertices, faces = ball(radius=0.04, rings=32, corners=48)
        clay = nendo.Clay(nendo.Mesh(vertices, faces), balls=1)
        radius = np.array([0.02])
        clay.press(np.array([[0, 0.1, 0.0]]), radius)
        first = clay.volume
        self.assertAlmostEqual(first / volume(vertices, faces), 1, delta=1e-5)
        report = clay.press(np.array([[0, 0.05, 0.0]]), radius)
        distance = np.linalg.norm(clay.vertices - [0, 0.05, 0], axis=1)
        self.assertGreater(distance.min(), 0.02 - 1e-4)
        self.assertGreater(report["touching"], 0)
        self.assertAlmostEqual(clay.volume / first, 1, delta=0.01)

        skeleton, above, into = nendo.HandSkeleton("right"), np.eye(4), np.eye(4)
        above[:3, 3], into[:3, 3] = (0, 0.3, 0.1), (0, 0.045, 0.1)
        clay = nendo.Clay(nendo.Mesh(vertices, faces), hands=[skeleton])
        for wrist in (above, into):
            report = clay.press_hands(skeleton.pose(np.zeros(23), wrist)[None])
        self.assertTrue(report["moved"])
        for wrong in ({}, {"balls": 1, "hands": [skeleton]}, {"balls": 1000}):
            with self.assertRaises(ValueError):
                nendo.Clay(nendo.Mesh(vertices, faces), **wrong)

    def test_unsolvable_fields_are_errors(self):
        with self.assertRaises(nendo.Error):
            nendo.Field(np.zeros((2, 3)), np.full((2, 3), 1e200), radius=1.0)
        for wrong in ({"radius": -1.0}, {"radius": float("nan")}, {"radius": 1.0, "kernel": "gauss"},
                      {"radius": np.ones(3)}, {"radius": 1.0, "keep_volume": 2.0}):
            with self.assertRaises(ValueError):
                nendo.Field(self.starts, self.ends, **wrong)


if __name__ == "__main__":
    unittest.main()
