"""From the stage to Blender: axes, units, and the bones of a hand. Needs NumPy, and nothing of Blender.

The stage has x to the right, y up, and z towards the operator; Blender has z up. So (x, y, z) becomes (x, -z, y), as Blender's
importer of glTF does it. A bone points along its y axis, and a joint of OpenXR along its -z axis, with y to the back of the
hand: the same change of axes on both sides of a rotation makes one of the other.
"""
import numpy as np

JOINT_NAMES = (
    "palm", "wrist", "thumb_metacarpal", "thumb_proximal", "thumb_distal", "thumb_tip",
    *(f"{finger}_{bone}" for finger in ("index", "middle", "ring", "little")
      for bone in ("metacarpal", "proximal", "intermediate", "distal", "tip")))
PALM, WRIST = 0, 1
SIDES = ("left", "right")
SUFFIXES = ("_L", "_R")


def _parents():
    parents = []
    for at, name in enumerate(JOINT_NAMES):
        of_wrist = name == "palm" or name.endswith("metacarpal")
        parents.append(-1 if at == WRIST else WRIST if of_wrist else at - 1)
    return tuple(parents)


PARENTS = _parents()  # -1: none
PARENTS_FIRST = (WRIST, *(at for at in range(len(JOINT_NAMES)) if at != WRIST))

# The thumb's metacarpal relative to the wrist in the open right hand (x y z w); that of the left hand is its mirror image.
THUMB_AT_REST = (0.05205, 0.11970, 0.39534, 0.90921)
TIP_M = 0.012  # the length of the bones at fingertips, which only show a direction


def bone_names(side):
    """The names of the bones, as the glTF export has them."""
    return [name + SUFFIXES[side] for name in JOINT_NAMES]


def to_blender(points):
    """(..., 3), from the stage's axes to Blender's."""
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


def to_stage(points):
    """The opposite of to_blender()."""
    return np.stack([points[..., 0], points[..., 2], -points[..., 1]], axis=-1)


def vertices(floats, setup, units_per_metre, out):
    """Puts the published floats (n, 3) into `out` (n, 3) float32, as metres of the stage in Blender's axes, without the model's
    offset."""
    scale = np.float32(setup.unit / units_per_metre)
    shift = np.float32(setup.origin / units_per_metre)
    np.multiply(floats[:, 0], scale, out=out[:, 0])
    np.multiply(floats[:, 2], -scale, out=out[:, 1])
    np.multiply(floats[:, 1], scale, out=out[:, 2])
    out += np.array([shift[0], -shift[2], shift[1]], np.float32)


def model_points(floats, setup):
    """(n, 3) float64: the vertices in the units and the axes of the model's file."""
    return setup.offset + setup.origin + setup.unit * floats.astype(float)


def rotations(quaternions):
    """(..., 3, 3), of quaternions x y z w of any length but 0, which is no rotation."""
    quaternions = np.asarray(quaternions, float)
    norms = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    x, y, z, w = np.moveaxis(np.where(norms > 0.0, quaternions / np.where(norms > 0.0, norms, 1.0), (0.0, 0.0, 0.0, 1.0)), -1, 0)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


_AXES = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def joint_matrices(joints):
    """(..., 26, 4, 4) of joints (..., 26, 7): the poses of the bones, in metres and in Blender's axes."""
    joints = np.asarray(joints, float)
    matrices = np.zeros((*joints.shape[:-1], 4, 4))
    matrices[..., :3, :3] = _AXES @ rotations(joints[..., 3:]) @ _AXES.T
    matrices[..., :3, 3] = to_blender(joints[..., :3])
    matrices[..., 3, 3] = 1.0
    return matrices


def inverses(matrices):
    """Of rigid motions (..., 4, 4)."""
    turned = np.swapaxes(matrices[..., :3, :3], -1, -2)
    inverse = np.zeros_like(matrices)
    inverse[..., :3, :3] = turned
    inverse[..., :3, 3] = -(turned @ matrices[..., :3, 3, None])[..., 0]
    inverse[..., 3, 3] = 1.0
    return inverse


def _relative_to_parents(matrices):
    """The root keeps its pose."""
    above = matrices[..., list(PARENTS), :, :].copy()
    above[..., WRIST, :, :] = np.eye(4)
    return inverses(above) @ matrices


def rest_matrices(joints, side):
    """(26, 4, 4): an open hand with the bones of this one (26, 7), its wrist at zero, and fingers that point forwards. All
    poses of a hand have the same, except for the arch of its palm."""
    local = _relative_to_parents(joint_matrices(joints))
    thumb = np.array(THUMB_AT_REST)
    if SIDES[side] == "left":
        thumb[1:3] *= -1.0
    rest = np.tile(np.eye(4), (len(JOINT_NAMES), 1, 1))
    for at in PARENTS_FIRST[1:]:
        above, name = rest[PARENTS[at]], JOINT_NAMES[at]
        rest[at, :3, 3] = above[:3, :3] @ local[at, :3, 3] + above[:3, 3]
        if name == "thumb_metacarpal":
            rest[at, :3, :3] = _AXES @ rotations(thumb) @ _AXES.T
        elif name == "palm" or name.endswith("metacarpal"):
            rest[at, :3, :3] = local[at, :3, :3]
        elif name.startswith("thumb"):
            rest[at, :3, :3] = above[:3, :3]
    return rest


def bone_lengths_m(rest):
    """(26,): to the next joint of the finger. The palm's and the wrist's bones end near the next joints."""
    lengths = np.full(len(JOINT_NAMES), TIP_M)
    for at, parent in enumerate(PARENTS):
        if parent >= 0 and parent != WRIST:
            lengths[parent] = np.linalg.norm(rest[at, :3, 3] - rest[parent, :3, 3])
    middle = JOINT_NAMES.index("middle_metacarpal")
    lengths[WRIST] = np.linalg.norm(rest[middle, :3, 3] - rest[WRIST, :3, 3])
    lengths[PALM] = 2.0 * TIP_M
    return np.maximum(lengths, 1e-3)  # Blender removes bones without length


def bone_bases(joints, rest):
    """(..., 26, 4, 4): what turns each bone of the armature with these matrices at rest, relative to its parent, into the pose of
    the joints (..., 26, 7). Blender calls it matrix_basis."""
    return inverses(_relative_to_parents(rest)) @ _relative_to_parents(joint_matrices(joints))


def quaternions(turns):
    """(..., 4), w x y z with w >= 0, of rotations (..., 3, 3)."""
    m = np.asarray(turns, float)
    trace = m[..., 0, 0] + m[..., 1, 1] + m[..., 2, 2]
    # Four times the square of each component; the greatest is far from 0 (S. W. Shepperd, 1978).
    squares = np.stack([1 + trace, 1 + 2 * m[..., 0, 0] - trace, 1 + 2 * m[..., 1, 1] - trace, 1 + 2 * m[..., 2, 2] - trace], -1)
    xy, xz, yz = m[..., 1, 0] + m[..., 0, 1], m[..., 0, 2] + m[..., 2, 0], m[..., 2, 1] + m[..., 1, 2]
    wx, wy, wz = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    w, x, y, z = np.moveaxis(squares, -1, 0)
    rows = np.stack([np.stack(row, -1) for row in ((w, wx, wy, wz), (wx, x, xy, xz), (wy, xy, y, yz), (wz, xz, yz, z))], -2)
    best = np.take_along_axis(rows, squares.argmax(-1)[..., None, None], axis=-2)[..., 0, :]
    best = best / np.linalg.norm(best, axis=-1, keepdims=True)
    return np.where(best[..., :1] < 0.0, -best, best)


def continuous(over_time):
    """Quaternions (k, ..., 4) with the signs that make neighbours in time similar, as key frames need it."""
    signs = np.ones(over_time.shape[:-1])
    dots = np.sum(over_time[1:] * over_time[:-1], axis=-1)
    signs[1:] = np.cumprod(np.where(dots < 0.0, -1.0, 1.0), axis=0)
    return over_time * signs[..., None]
