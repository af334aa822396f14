// The skin of a hand, as the window draws it (apps/render/hand_skin.hpp). The server sends that of an
// open right hand; a left one is its mirror image.
function readSkin(buffer) {
  const from = new Reader(buffer), vertices = from.u32(), triangles = from.u32()
  return {
    open: readJoints(from), places: from.list(Float32Array, 3 * vertices), carriers: from.list(Uint8Array, 4 * vertices),
    shares: from.list(Uint8Array, 4 * vertices), corners: from.list(Uint16Array, 3 * triangles),
  }
}

const inverse = ([x, y, z, w]) => [-x, -y, -z, w]
const INDEX_KNUCKLE = 7, MIDDLE_KNUCKLE = 12, LITTLE_KNUCKLE = 22
const boneOf = (joints, at) => size(minus(joints[at + 1].place, joints[at].place))
// From the wrist to the tip of the middle finger.
const lengthOf = joints => [0, 1, 2].reduce((sum, bone) => sum + boneOf(joints, MIDDLE_KNUCKLE + bone), size(joints[MIDDLE_KNUCKLE].place))

// The open hand with a wearer's bones, about its wrist.
function sizedAs(bones, open) {
  const joints = open.map(({ turn }) => ({ turn, place: [0, 0, 0] }))
  for (let step = 2; step <= JOINTS; ++step) {
    const at = step % JOINTS, parent = joints[PARENTS[at]]
    joints[at].place = add(parent.place, turned(parent.turn, bones[at].place))
  }
  return joints
}

// How much flesh is stretched along a joint's axes: across by the size of the hand, along by the length
// of the bone, and in the palm by its breadth and length.
function stretchesTo(sized, open) {
  const across = lengthOf(sized) / lengthOf(open)
  const inPalm = (joints, knuckle) => turned(inverse(joints[1].turn), joints[knuckle].place)
  const breadth = joints => Math.abs(inPalm(joints, INDEX_KNUCKLE)[0] - inPalm(joints, LITTLE_KNUCKLE)[0])
  const long = joints => Math.abs(inPalm(joints, MIDDLE_KNUCKLE)[2])
  return open.map((joint, at) => {
    if (at === 1) return [breadth(sized) / breadth(open), across, long(sized) / long(open)]
    if (at === 0 || TIPS.includes(at)) return [across, across, across]
    return [across, across, boneOf(sized, at) / boneOf(open, at)]
  })
}

class Skin {
  // side: -1 for a left hand, 1 for a right one.
  constructor(gl, skin, side) {
    Object.assign(this, { gl, skin, side, bones: null })
    this.open = skin.open.map(({ place: [x, y, z], turn: [a, b, c, w] }) => ({ place: [side * x, y, z], turn: [a, side * b, side * c, w] }))
    const type = gl.UNSIGNED_BYTE, put = (data, usage) => makeBuffer(gl, gl.ARRAY_BUFFER, data, usage)
    this.buffers = [0, 1].map(() => put(4 * skin.places.length, gl.DYNAMIC_DRAW)) // places, normals
    const carriers = [put(skin.carriers, gl.STATIC_DRAW), 4, { type, isInteger: true }], shares = [put(skin.shares, gl.STATIC_DRAW), 4, { type }]
    const corners = makeBuffer(gl, gl.ELEMENT_ARRAY_BUFFER, skin.corners, gl.STATIC_DRAW)
    this.array = makeArray(gl, [...this.buffers.map(buffer => [buffer, 3]), carriers, shares], corners)
  }

  // Makes the open hand's skin the wearer's.
  fit(bones) {
    const { skin, open, side } = this, places = new Float32Array(skin.places.length)
    Object.assign(this, { bones, sized: sizedAs(bones, open) })
    const stretches = stretchesTo(this.sized, open)
    for (let at = 0; at < places.length / 3; ++at) {
      const [x, y, z] = skin.places.subarray(3 * at, 3 * at + 3)
      for (let rank = 4 * at; rank < 4 * at + 4; ++rank) {
        const joint = skin.carriers[rank], share = skin.shares[rank] / 255, { turn, place } = open[joint]
        if (share === 0) continue
        const own = turned(inverse(turn), minus([side * x, y, z], place))
        const moved = add(this.sized[joint].place, turned(turn, own.map((number, axis) => number * stretches[joint][axis])))
        moved.forEach((number, axis) => { places[3 * at + axis] += share * number })
      }
    }
    const normals = normalsOf(places, skin.corners).map(number => side * number) // a mirror turns triangles over
    ;[places, normals].forEach((numbers, which) => fillBuffer(this.gl, this.buffers[which], numbers))
  }

  // The movements of the joints from the open hand, for the shader. Of a turn's two signs it is the one
  // nearer to the parent's, so that mixtures take the short way.
  screws(joints) {
    const turns = [], shifts = []
    for (let step = 1; step <= JOINTS; ++step) {
      const at = step % JOINTS, { place, turn } = joints[at], before = turns[PARENTS[at]]
      let by = product(turn, inverse(this.sized[at].turn))
      if (before && dot(before, by) < 0) by = by.map(part => -part)
      turns[at] = by
      shifts[at] = product([...times(minus(place, turned(by, this.sized[at].place)), 0.5), 0], by)
    }
    return { turns: turns.flat(), shifts: shifts.flat() }
  }

  // joints: of the hand, about the scene's origin. draw: called with the program ready, to draw triangles.
  draw(program, bones, joints, values, draw) {
    const { gl } = this
    if (bones !== this.bones) this.fit(bones)
    program.use({ ...values, ...this.screws(joints) })
    gl.bindVertexArray(this.array)
    draw(() => gl.drawElements(gl.TRIANGLES, this.skin.corners.length, gl.UNSIGNED_SHORT, 0))
    gl.bindVertexArray(null)
  }
}
