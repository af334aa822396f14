// What comes from the server: PROTOCOL.md, byte for byte.
const JOINTS = 26
const MODEL_HEAD = 88, BONE_BYTES = 28, COAT_BYTES = 24, UPDATE_HEAD = 72, NO_TEXTURE = 0xffffffff
// Of each joint, whose place hangs on it; the wrist's on none.
const PARENTS = [1, -1, 1, 2, 3, 4, 1, 6, 7, 8, 9, 1, 11, 12, 13, 14, 1, 16, 17, 18, 19, 1, 21, 22, 23, 24]
const TIPS = [5, 10, 15, 20, 25]
// Their turns follow from their parents': palm, index and middle finger's metacarpals, tips.
const FIXED = [0, 6, 11, ...TIPS]

function readModel(buffer) {
  const view = new DataView(buffer)
  const text = (at, count) => new TextDecoder().decode(new Uint8Array(buffer, at, count))
  if (buffer.byteLength < MODEL_HEAD || text(0, 8) !== 'NENDOWEB') throw new Error('this server is no nendo')
  if (view.getUint32(8, true) !== 8) throw new Error('this server speaks another version; reload the page')
  const vertices = view.getUint32(12, true), triangles = view.getUint32(16, true)
  const flags = view.getUint8(82), bones = [null, null]
  let places = MODEL_HEAD
  for (const slot of [0, 1]) {
    if (!(flags & 1 << slot)) continue
    bones[slot] = [readBones(view, places), readBones(view, places + JOINTS * BONE_BYTES)]
    places += 2 * JOINTS * BONE_BYTES
  }
  const order = places + 12 * vertices, corners = order + 4 * vertices, coats = corners + 12 * triangles
  const tints = flags & 16 ? 3 * triangles : vertices
  const texcoords = coats + COAT_BYTES * view.getUint32(84, true), colours = texcoords + (flags & 8 ? 24 * triangles : 0)
  const name = colours + (flags & 4 ? 6 * tints : 0)
  return {
    vertices, triangles,
    rate: view.getFloat64(24, true), unit: view.getFloat64(32, true),
    origin: [40, 48, 56].map(at => view.getFloat64(at, true)),
    unitsPerMetre: view.getFloat64(64, true), diagonal: view.getFloat64(72, true),
    loop: view.getUint16(80, true), bones,
    places: new Float32Array(buffer, places, 3 * vertices),
    order: new Uint32Array(buffer, order, vertices),
    corners: new Uint32Array(buffer, corners, 3 * triangles),
    coats: readCoats(view, coats, view.getUint32(84, true)),
    texcoords: flags & 8 ? new Float32Array(buffer, texcoords, 6 * triangles) : null,
    colours: flags & 4 ? new Uint16Array(buffer, colours, 3 * tints) : null,
    areColoursOfCorners: Boolean(flags & 16),
    name: text(name, view.getUint32(20, true)),
  }
}

function readCoats(view, from, count) {
  let first = 0
  return Array.from({ length: count }, (_, n) => {
    const at = from + COAT_BYTES * n, texture = view.getUint32(at + 4, true)
    const coat = { first, count: 3 * view.getUint32(at, true), texture: texture === NO_TEXTURE ? null : texture, colour: null }
    if (view.getUint32(at + 8, true)) coat.colour = [12, 16, 20].map(channel => view.getFloat32(at + channel, true))
    first += coat.count
    return coat
  })
}

// Of a hand, by joint: place and turn in its parent's axes.
function readBones(view, at) {
  const numbers = from => Array.from({ length: 7 }, (_, n) => view.getFloat32(from + 4 * n, true))
  return Array.from({ length: JOINTS }, (_, joint) => {
    const seven = numbers(at + BONE_BYTES * joint)
    return { place: seven.slice(0, 3), turn: seven.slice(3) }
  })
}

// What follows the first four bytes of a report, of the settings, of the commands and of the devices.
const textIn = buffer => new TextDecoder().decode(buffer.slice(4))

// The values of settings by their names, as `settings` sends them; radii are numbers.
function readSettings(buffer) {
  const settings = Object.fromEntries(textIn(buffer).split(' ').map(pair => pair.split('=')))
  return { ...settings, radius_m: settings.radius_m.split(',').map(Number) }
}

// By the names of commands that are on or not possible. The others are off and possible.
function readCommands(buffer) {
  return new Map(textIn(buffer).split('\n').slice(0, -1).map(line => {
    const [name, on, refusal] = line.split('\t')
    return [name, { isOn: on === 'on', refusal }]
  }))
}

// Of each hand: its glove, and the station of a tracker that moves its wrist.
function readDevices(buffer) {
  const devices = [[], []]
  for (const line of textIn(buffer).split('\n').slice(0, -1)) {
    const [side, title, state] = line.split('\t')
    devices[side === 'left' ? 0 : 1].push({ title, state })
  }
  return devices
}

const STEPS = ['stroke', 'reset', 'mode', 'kernel', 'radius', 'folding', 'filter', 'settings', 'subdivide', 'brush', 'puppet', 'volume', 'hold', 'mask', 'symmetry', 'refine', 'cut', 'join', 'copy', 'remove', 'topology']
function readSteps(buffer) {
  const view = new DataView(buffer), count = view.getUint8(1)
  const steps = Array.from({ length: count }, (_, n) => ({ kind: STEPS[view.getUint32(8 + 8 * n, true)] || 'step', at: view.getFloat32(12 + 8 * n, true) }))
  return { steps, undoable: view.getUint8(2) }
}

function readClay(buffer) {
  const view = new DataView(buffer), f32 = at => view.getFloat32(at, true)
  const contacts = Array.from({ length: view.getUint16(2, true) }, (_, n) => {
    const at = 24 + 16 * n
    return { place: [f32(at), f32(at + 4), f32(at + 8)], strength: f32(at + 12) }
  })
  return { contacts, penetration: f32(4), volume: view.getFloat64(8, true), first: view.getFloat64(16, true) }
}

function readShape(buffer) {
  const view = new DataView(buffer)
  return {
    loop: view.getUint16(2, true), vertices: view.getUint32(4, true), number: view.getBigUint64(8, true),
    places: new Float32Array(buffer, 16),
  }
}

function readWeights(buffer) {
  const view = new DataView(buffer), vertices = view.getUint32(8, true), terms = view.getUint32(12, true)
  return {
    number: view.getUint32(4, true), vectors: view.getUint16(2, true),
    values: new Float32Array(buffer, 16, terms),
    counts: new Uint16Array(buffer, 16 + 4 * terms, vertices),
    ofVector: new Uint16Array(buffer, 16 + 4 * terms + 2 * vertices, terms),
  }
}

function readPuppet(buffer) {
  const view = new DataView(buffer)
  let at = 8
  const text = () => {
    const count = view.getUint8(at), words = new TextDecoder().decode(new Uint8Array(buffer, at + 1, count))
    at += 1 + count
    return words
  }
  const functions = Array.from({ length: view.getUint16(2, true) }, () => ({ name: text(), signal: text() }))
  return { number: view.getUint32(4, true), functions }
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

function readHand(view, at, bones) {
  const wrist = { place: [0, 4, 8].map(axis => view.getFloat32(at + axis, true)), turn: readTurn(view, at + 18) }
  const hand = { forearm: readTurn(view, at + 12), joints: [], bytes: 24 }
  hand.joints[1] = wrist
  for (let joint = 0; joint < JOINTS; ++joint) {
    if (joint === 1) continue
    const parent = hand.joints[PARENTS[joint]], bone = bones[joint], fixed = FIXED.includes(joint)
    hand.joints[joint] = {
      place: add(parent.place, turned(parent.turn, bone.place)),
      turn: fixed ? product(parent.turn, bone.turn) : readTurn(view, at + hand.bytes),
    }
    if (!fixed) hand.bytes += 6
  }
  return hand
}

const WENDLAND = [
  (t, u) => u ** 2,
  (t, u) => u ** 4 * (4 * t + 1),
  (t, u) => u ** 6 * (35 * t * t + 18 * t + 3) / 3,
  (t, u) => u ** 8 * (32 * t ** 3 + 25 * t * t + 8 * t + 1),
]
// Where a field takes a place.
function taken(field, place) {
  const one = [1, ...place]
  const sum = [0, 1, 2].map(row => one.reduce((all, x, at) => all + x * (field.polynomial[4 * row + at] || 0), place[row]))
  for (const { centre, inverse, coefficient } of field.functions) {
    const u = minus(place, centre).map(part => part * inverse), t = size(u)
    if (t >= 1) continue
    const clay = field.volume * (1 - t) ** 4
    const along = 15 * clay * coefficient.reduce((all, a, axis) => all + a * u[axis], 0)
    const w = (1 - field.volume) * WENDLAND[field.kernel](t, 1 - t) + clay * (1 + t * (4 - 20 * t))
    coefficient.forEach((a, axis) => { sum[axis] += w * a + along * u[axis] })
  }
  return sum
}

// before: the step's field before this one. Where a flag says so, its functions continue from there.
function readField(view, at, before) {
  const flags = view.getUint8(at + 1), follows = (flags & 4) !== 0
  let from = at + 4
  const take = () => (from += 4, view.getFloat32(from - 4, true))
  const shared = flags & 2 ? take() : 0
  const volume = flags & 8 ? take() : 0
  const field = { kernel: view.getUint8(at), volume, halfway: (flags & 16) !== 0, polynomial: flags & 1 ? Array.from({ length: 12 }, take) : [], functions: [] }
  for (let left = view.getUint16(at + 2, true), number = 0; number < left; ++number) {
    const same = follows && before.functions[number]
    const centre = same ? taken(before, same.centre) : [take(), take(), take()]
    const coefficient = [take(), take(), take()]
    field.functions.push({ centre, coefficient, inverse: same ? same.inverse : flags & 2 ? shared : take() })
  }
  return { ...field, end: from }
}

// As the shader takes it, four numbers a texel.
function texelsOf({ kernel, volume, halfway, polynomial, functions }) {
  const head = [functions.length, kernel, polynomial.length > 0 ? 1 : 0, volume + (halfway ? 2 : 0)]
  return [...head, ...polynomial, ...functions.flatMap(({ centre, inverse, coefficient }) => [...centre, inverse, ...coefficient, 0])]
}

function readUpdate(buffer, model) {
  const view = new DataView(buffer)
  const u32 = at => view.getUint32(at, true), u64 = at => Number(view.getBigUint64(at, true))
  const state = view.getUint8(1), bits = view.getUint8(2)
  const update = {
    letGo: [(state & 16) !== 0, (state & 32) !== 0], symmetric: (state & 64) !== 0, isPuppet: (state & 128) !== 0,
    held: (state & 1) !== 0, inHand: (state & 8) !== 0, status: view.getUint8(3), number: view.getBigUint64(8, true),
    tick: u64(16), ticks: u64(24), missed: u64(32), restChanges: u32(40), jumps: u32(44),
    late: view.getFloat32(48, true), maxLate: view.getFloat32(52, true), sinceLast: view.getFloat32(56, true),
    lost: u32(60), skipped: u32(64), links: u32(68), bytes: buffer.byteLength, hands: [null, null], steps: [],
  }
  let at = UPDATE_HEAD
  for (let slot = 0; slot < 2; ++slot) {
    if (!(bits & 1 << slot)) continue
    const hand = readHand(view, at, model.bones[slot][bits & 16 << slot ? 1 : 0])
    hand.silent = (bits & 4 << slot) !== 0
    hand.wristLost = (bits & 64 << slot) !== 0
    update.hands[slot] = hand
    at += hand.bytes
  }
  for (let step = u32(4); step > 0; --step) {
    const bakes = view.getUint8(at) === 1, count = view.getUint16(at + 2, true), texels = []
    const vectors = view.getUint8(at + 1) === 1
    at += 4
    if (vectors) {
      const weights = u32(at)
      for (let n = 0; n < count; ++n, at += 12) texels.push(...[4, 8, 12].map(axis => view.getFloat32(at + axis, true)), 0)
      at += 4
      update.steps.push({ bakes, count, texels, weights })
      continue
    }
    for (let left = count, field = null; left > 0; --left) {
      field = readField(view, at, field)
      texels.push(...texelsOf(field))
      at = field.end
    }
    update.steps.push({ bakes, count, texels, weights: null })
  }
  return update
}
