// What comes from the server: PROTOCOL.md, byte for byte.
const JOINTS = 26

function readModel(buffer) {
  const view = new DataView(buffer)
  const text = (at, count) => new TextDecoder().decode(new Uint8Array(buffer, at, count))
  if (buffer.byteLength < 104 || text(0, 8) !== 'NENDOWEB') throw new Error('this server is no nendo')
  if (view.getUint32(8, true) !== 1) throw new Error('this server speaks another version; reload the page')
  const vertices = view.getUint32(12, true), triangles = view.getUint32(16, true)
  const places = 104, order = places + 12 * vertices, corners = order + 4 * vertices, name = corners + 12 * triangles
  return {
    vertices, triangles,
    rate: view.getFloat64(24, true), unit: view.getFloat64(32, true),
    origin: [40, 48, 56].map(at => view.getFloat64(at, true)),
    unitsPerMetre: view.getFloat64(64, true), diagonal: view.getFloat64(72, true),
    radii: [80, 84, 88, 92, 96].map(at => view.getFloat32(at, true)),
    mode: view.getUint16(100, true), loop: view.getUint16(102, true),
    places: new Float32Array(buffer, places, 3 * vertices),
    order: new Uint32Array(buffer, order, vertices),
    corners: new Uint32Array(buffer, corners, 3 * triangles),
    name: text(name, view.getUint32(20, true)),
  }
}

function readShape(buffer) {
  const view = new DataView(buffer)
  return {
    loop: view.getUint16(2, true), vertices: view.getUint32(4, true), number: view.getBigUint64(8, true),
    places: new Float32Array(buffer, 16),
  }
}

// Three of a quaternion's parts, 15 bits each; the largest one follows.
function readTurn(view, at) {
  const words = [view.getUint16(at, true), view.getUint16(at + 2, true), view.getUint16(at + 4, true)]
  const largest = (words[0] >> 15) | (words[1] >> 15) << 1
  const turn = [0, 0, 0, 0]
  let left = 1, next = 0
  for (let part = 0; part < 4; ++part) {
    if (part === largest) continue
    const value = ((words[next++] & 0x7fff) / 32767 * 2 - 1) * Math.SQRT1_2
    turn[part] = value
    left -= value * value
  }
  turn[largest] = Math.sqrt(Math.max(0, left))
  return turn
}

function readHand(view, at) {
  const wrist = [0, 4, 8].map(axis => view.getFloat32(at + axis, true))
  const joints = []
  for (let joint = 0, from = at + 12; joint < JOINTS; ++joint, from += 12)
    joints.push({
      place: [0, 1, 2].map(axis => wrist[axis] + 1e-5 * view.getInt16(from + 2 * axis, true)),
      turn: readTurn(view, from + 6),
    })
  return { joints }
}

// A step's fields as the shader takes them, four numbers a texel.
function readField(view, at, texels) {
  const kernel = view.getUint8(at), flags = view.getUint8(at + 1), functions = view.getUint16(at + 2, true)
  let from = at + 4
  const take = () => (from += 4, view.getFloat32(from - 4, true))
  const shared = flags & 2 ? take() : 0
  texels.push(functions, kernel, flags & 1, 0)
  for (let number = 0; flags & 1 && number < 12; ++number) texels.push(take())
  for (let number = 0; number < functions; ++number) {
    const c = [take(), take(), take()], a = [take(), take(), take()]
    texels.push(...c, flags & 2 ? shared : take(), ...a, 0)
  }
  return from
}

function readUpdate(buffer) {
  const view = new DataView(buffer)
  const u32 = at => view.getUint32(at, true), u64 = at => Number(view.getBigUint64(at, true))
  const bits = view.getUint8(2)
  const update = {
    held: view.getUint8(1) !== 0, status: view.getUint8(3), number: view.getBigUint64(8, true),
    tick: u64(16), ticks: u64(24), missed: u64(32), commits: u32(40), undos: u32(44),
    late: view.getFloat32(48, true), mostLate: view.getFloat32(52, true), sinceLast: view.getFloat32(56, true),
    lost: u32(60), skipped: u32(64), links: u32(68), bytes: buffer.byteLength, hands: [null, null], steps: [],
  }
  let at = 88
  for (let slot = 0; slot < 2; ++slot) {
    if (!(bits & 1 << slot)) continue
    const hand = readHand(view, at)
    hand.silent = (bits & 4 << slot) !== 0
    hand.samples = u32(72 + 4 * slot)
    hand.badRecords = u32(80 + 4 * slot)
    update.hands[slot] = hand
    at += 12 + 12 * JOINTS
  }
  for (let step = u32(4); step > 0; --step) {
    const bakes = view.getUint8(at) === 1, count = view.getUint16(at + 2, true), texels = []
    at += 4
    for (let field = 0; field < count; ++field) at = readField(view, at, texels)
    update.steps.push({ bakes, count, texels })
  }
  return update
}
