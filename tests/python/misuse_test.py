"""Wrong arrays, leaks, and the stubs."""
import ast
import gc
import inspect
import pathlib
import re
import resource
import sys
import unittest

import numpy as np

import nendo
from fixtures import LONG, TestCase, ball

REFUSED = (TypeError, ValueError, nendo.Error)


def wrong_array(random):
    """An array of any type, shape and order, with any numbers; or no array."""
    shape = tuple(random.choice([0, 1, 2, 3, 4, 7, 23, 24, 26, 40]) for _ in range(random.integers(0, 5)))
    types = [np.float64, np.float32, np.int32, np.uint32, np.int64, np.uint8, np.complex128, ">f8", object, "U3", bool,
             nendo.sample_dtype, nendo.pose_dtype]
    kind = np.dtype(types[random.integers(len(types))])
    array = np.zeros(shape, kind)
    if kind.kind in "fiu":
        extremes = [0, 1, -1, np.nan, np.inf, 1e300, -1e-300, 2**31, 0.5]
        with np.errstate(all="ignore"):
            array = np.array(random.choice(extremes, shape), np.float64).astype(kind)
    change = random.integers(8)
    if change == 0:
        return array.tolist()
    if change == 1 and array.ndim:
        return array[::2]
    if change == 2:
        return array.T
    if change == 3 and array.ndim:
        return np.broadcast_to(array, (3, *array.shape))
    if change == 4 and kind.itemsize > 1 and not kind.hasobject:
        return np.frombuffer(b"\x01" + array.tobytes() + b"\xff" * 7, kind, array.size, offset=1).reshape(shape)
    return [array, None, "text", 1.5][0 if change < 7 else random.integers(4)]


class WrongArrays(TestCase):
    def test_random_arrays_are_refused_or_used(self):
        random = np.random.default_rng(5)
        vertices, faces = ball(rings=5, corners=6)
        mesh, three = nendo.Mesh(vertices, faces), vertices[:3].copy()
        skeleton, calibration = nendo.HandSkeleton("right"), nendo.Calibration.average()
        field = nendo.Field(three, three + 0.1, radius=1.0)
        type1 = nendo.Type1Deformer(vertices, three, radius=1.0)
        type2 = nendo.Type2Deformer(vertices, three, radius=1.0, piece_length=0.5)
        balls, hands = nendo.Clay(mesh, balls=2), nendo.Clay(mesh, hands=[skeleton])
        calls = [
            lambda a: nendo.Mesh(a, faces), lambda a: nendo.Mesh(vertices, a), lambda a: nendo.Mesh(a, a), mesh.with_vertices,
            lambda a: mesh.cut_by_wire(a, a), lambda a: mesh.cut_by_wire(three, a), lambda a: mesh.cut(a, (0, 1, 0)),
            lambda a: nendo.deform(a, three, three, radius=1.0), lambda a: nendo.deform(vertices, a, three, radius=1.0),
            lambda a: nendo.deform(vertices, a, a, radius=1.0), lambda a: nendo.deform(vertices, three, three, radius=a),
            field.displace, field.displacements, lambda a: nendo.Type1Deformer(vertices, a, radius=1.0),
            lambda a: nendo.Type1Deformer(a, three, radius=1.0), lambda a: nendo.Type1Deformer(vertices, three, radius=1.0, mask=a),
            lambda a: nendo.Type1Deformer(vertices, three, radius=a), type1.grab, type1.apply, type1.commit, type1.undo, type2.begin,
            type2.stroke_to, type2.end_at, type2.reset, lambda a: balls.press(a, np.ones(2)), lambda a: balls.press(three[:2].copy(), a),
            hands.press_hands, skeleton.pose, lambda a: skeleton.pose(np.zeros(23), a), calibration.joint_angles,
            lambda a: nendo.Calibration.fit([("flat", a), ("fist", a)], side="left"), lambda a: nendo.join([mesh, a]),
            lambda a: nendo.Clay(a, balls=1), lambda a: nendo.Recording(a), lambda a: nendo.Session(a, left="sim"),
        ]
        refused = 0
        count = int(2000 * LONG)
        for number in range(count):
            array = wrong_array(random)
            try:
                calls[number % len(calls)](array)
            except REFUSED as error:
                refused += 1
                self.assertTrue(str(error))
        self.assertGreater(refused, 0.8 * count)
        self.assert_same(mesh.vertices, vertices)

    def test_messages_name_the_argument_and_the_remedy(self):
        vertices, faces = ball()
        start = vertices[:1].copy()
        for array, kind, text in ((vertices.astype(np.float32), TypeError, r"vertices: float64 .*not float32.*astype"),
                                  (vertices[:, ::-1], ValueError, "vertices: .*ascontiguousarray"),
                                  (vertices.tolist(), TypeError, "vertices: a NumPy array of float64 is needed, not list"),
                                  (vertices[:, :2].copy(), ValueError, r"vertices: the shape \(n, 3\) is needed, not \(\d+, 2\)"),
                                  (np.where(vertices == vertices[4], np.nan, vertices), ValueError, "vertices: row .* not finite")):
            with self.assertRaisesRegex(kind, text):
                nendo.deform(array, start, start, radius=1.0)
        for bad, kind in ((faces.astype(np.int64), TypeError), (faces - 1, ValueError), (faces + 1, ValueError), (faces[:, :2].copy(), ValueError)):
            with self.assertRaisesRegex(kind, "faces: "):
                nendo.Mesh(vertices, bad)


class Leaks(TestCase):
    def test_memory_and_references_stay_level(self):
        vertices, faces = ball()
        start = vertices[:2].copy()
        skeleton, angles = nendo.HandSkeleton("left"), np.zeros((4, 23))
        with nendo.open("sim?rate=500") as glove:
            def once():
                mesh = nendo.Mesh(vertices, faces)
                mesh.vertices, mesh.faces, glove.read(), glove.stats, glove.info.facts
                nendo.deform(vertices, start, start + 0.1, radius=1.0)
                skeleton.pose(angles)
                try:
                    mesh.with_vertices(start)
                except ValueError:
                    pass
                try:
                    nendo.Field(start, start + 1e200, radius=1.0)
                except nendo.Error:
                    pass
            for _ in range(300):
                once()
            gc.collect()
            counts = [sys.getrefcount(each) for each in (vertices, faces, start, angles, nendo.sample_dtype, nendo.Error)]
            before = self.resident_bytes()
            for _ in range(int(3000 * LONG)):
                once()
            gc.collect()
            self.assertEqual([sys.getrefcount(each) for each in (vertices, faces, start, angles, nendo.sample_dtype, nendo.Error)], counts)
            self.assertLess(self.resident_bytes() - before, 4e6)

    def resident_bytes(self):
        return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


class Stubs(TestCase):
    def setUp(self):
        super().setUp()
        folder = pathlib.Path(nendo.__file__).parent
        self.assertTrue((folder / "py.typed").exists())
        self.stub = ast.parse((folder / "__init__.pyi").read_text())

    def test_the_stubs_have_the_names_of_the_module(self):
        declared = {node.name for node in self.stub.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        declared |= {node.target.id for node in self.stub.body if isinstance(node, ast.AnnAssign)}
        self.assertEqual({name for name in declared if not name.startswith("_") or name == "__version__"}, set(nendo.__all__))
        for node in self.stub.body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                stubs = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
                stubs |= {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
                own = {name for name in vars(getattr(nendo, node.name)) if not name.startswith("_")}
                self.assertEqual({name for name in stubs if not name.startswith("_")}, own, node.name)

    def test_arguments_are_those_of_the_functions(self):
        functions = [(nendo, node) for node in self.stub.body if isinstance(node, ast.FunctionDef)]
        for node in self.stub.body:
            if isinstance(node, ast.ClassDef) and node.name in nendo.__all__:
                functions += [(getattr(nendo, node.name), item) for item in node.body if isinstance(item, ast.FunctionDef)]
        checked = 0
        for owner, node in functions:
            doc = inspect.getdoc(getattr(owner, node.name)) or ""
            signature = re.match(rf"{node.name}\((.*)\) -> ", doc)
            if not signature or node.name == "__exit__" or any(ast.unparse(each) == "property" for each in node.decorator_list):
                continue
            names = re.findall(r"(?:^|, )(\*{0,2}\w*)(?=[:,]|$)", re.sub(r"\[[^\]]*\]|<[^>]*>|'[^']*'", "", signature[1]))
            arguments = node.args
            wanted = [each.arg for each in arguments.args] + ["*"] * bool(arguments.kwonlyargs) + [each.arg for each in arguments.kwonlyargs]
            bare = [name for name in names if name not in ("", "self", "arg0")]
            self.assertEqual([name for name in bare if not name.startswith("**")],
                             [name for name in wanted if name != "self" and not name.startswith("**")], node.name)
            checked += 1
        self.assertGreater(checked, 30)

    def test_every_public_name_has_a_docstring(self):
        for name in nendo.__all__:
            public = getattr(nendo, name)
            if inspect.isclass(public):
                for own in vars(public):
                    if not own.startswith("_") and own != "code":
                        doc = inspect.getdoc(getattr(public, own)) or ""
                        self.assertTrue(doc.partition("\n")[2] if doc.startswith(own + "(") else doc, f"{name}.{own}")
            if callable(public):
                self.assertTrue(public.__doc__, name)


if __name__ == "__main__":
    unittest.main()
