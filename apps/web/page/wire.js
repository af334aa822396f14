// What comes from the server: PROTOCOL.md, byte for byte.
const JOINTS = 26
const NO_TEXTURE = 0xffffffff
// Of each joint, whose place hangs on it; the wrist's on none.
const PARENTS = [1, -1, 1, 2, 3, 4, 1, 6, 7, 8, 9, 1, 11, 12, 13, 14, 1, 16, 17, 18, 19, 1, 21, 22, 23, 24]
const TIPS = [5, 10, 15, 20, 25]
// Their turns follow from their parents': palm, index and middle finger's metacarpals, tips.
const FIXED = [0, 6, 11, ...TIPS]

// Takes what is in a message, one after another.
class Reader {
  constructor(buffer, at = 0) { Object.assign(this, { view: new DataView(buffer), at }) }
  next(kind, bytes) { return this.view['get' + kind]((this.at += bytes) - bytes, true) }
  u8() { return this.next('Uint8', 1) }
  u16() { return this.next('Uint16', 2) }
  u32() { return this.next('Uint32', 4) }
  u64() { return Number(this.next('BigUint64', 8)) }
  f32() { return this.next('Float32', 4) }
  f64() { return this.next('Float64', 8) }
  some(count, take) { return Array.from({ length: count }, () => take()) }
  f32s(count) { return this.some(count, () => this.f32()) }
  list(Kind, count) {
    const list = new Kind(this.view.buffer, this.at, count)
    this.at += list.byteLength
    return list
  }
  text(bytes) { return new TextDecoder().decode(this.list(Uint8Array, bytes)) }
}

function readModel(buffer) {
  const from = new Reader(buffer)
  if (buffer.byteLength < 88 || from.text(8) !== 'NENDOWEB') throw new Error('this server is no nendo')
  if (from.u32() !== 8) throw new Error('this server speaks another version; reload the page')
  const [vertices, triangles, nameBytes] = from.some(3, () => from.u32())
  const [rate, unit, ...origin] = from.some(5, () => from.f64()), unitsPerMetre = from.f64(), diagonal = from.f64()
  const loop = from.u16(), flags = from.u16(), coats = from.u32(), areColoursOfCorners = Boolean(flags & 16)
  return {
    vertices, triangles, rate, unit, origin, unitsPerMetre, diagonal, loop, areColoursOfCorners,
    bones: [1, 2].map(side => flags & side ? [readJoints(from), readJoints(from)] : null),
    places: from.list(Float32Array, 3 * vertices),
    order: from.list(Uint32Array, vertices),
    corners: from.list(Uint32Array, 3 * triangles),
    coats: readCoats(from, coats),
    texcoords: flags & 8 ? from.list(Float32Array, 6 * triangles) : null,
    colours: flags & 4 ? from.list(Uint16Array, areColoursOfCorners ? 9 * triangles : 3 * vertices) : null,
    name: from.text(nameBytes),
  }
}

function readCoats(from, count) {
  let first = 0
  return from.some(count, () => {
    const count = 3 * from.u32(), texture = from.u32(), hasColour = from.u32(), colour = from.f32s(3)
    first += count
    return { first: first - count, count, texture: texture === NO_TEXTURE ? null : texture, colour: hasColour ? colour : null }
  })
}

// The place and the turn of each joint of a hand.
const readJoints = from => from.some(JOINTS, () => ({ place: from.f32s(3), turn: from.f32s(4) }))

// What follows the first four bytes of a report, of the settings, of the commands and of the devices.
const textIn = buffer => new TextDecoder().decode(buffer.slice(4))

// The values of settings by their names, as `settings` sends them; of each finger, five; radii are numbers.
function readSettings(buffer) {
  const settings = Object.fromEntries(textIn(buffer).split(' ').map(pair => pair.split('=')))
  const brushes = settings.brushes.split(',')
  return { ...settings, radius_m: settings.radius_m.split(',').map(Number), brushes: brushes.length > 1 ? brushes : Array(5).fill(brushes[0]) }
}

// By the names of commands that are on, hidden or not possible. The others are off and possible.
function readCommands(buffer) {
  return new Map(textIn(buffer).split('\n').slice(0, -1).map(line => {
    const [name, state, refusal] = line.split('\t')
    return [name, { isOn: state === 'on', isHidden: state === 'hidden', refusal }]
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
  const from = new Reader(buffer, 1), count = from.u8(), undoable = from.u8()
  from.at = 8
  return { undoable, steps: from.some(count, () => ({ kind: STEPS[from.u32()] || 'step', at: from.f32() })) }
}

function readClay(buffer) {
  const from = new Reader(buffer, 2), count = from.u16(), penetration = from.f32(), volume = from.f64(), first = from.f64()
  return { penetration, volume, first, contacts: from.some(count, () => ({ place: from.f32s(3), strength: from.f32() })) }
}

// The ends of a drawn wire, the newest last.
function readWire(buffer) {
  const from = new Reader(buffer, 2)
  return from.some(from.u16(), () => [from.f32s(3), from.f32s(3)])
}

function readShape(buffer) {
  const from = new Reader(buffer, 2), loop = from.u16(), vertices = from.u32()
  return { loop, vertices, number: from.u64(), places: from.list(Float32Array, 3 * vertices) }
}

function readWeights(buffer) {
  const from = new Reader(buffer, 4), number = from.u32(), vertices = from.u32(), terms = from.u32()
  return { number, values: from.list(Float32Array, terms), counts: from.list(Uint16Array, vertices), ofVector: from.list(Uint16Array, terms) }
}

function readPuppet(buffer) {
  const from = new Reader(buffer, 2), count = from.u16(), number = from.u32(), text = () => from.text(from.u8())
  const functions = from.some(count, () => ({ name: text(), signal: text() })), isInverted = from.view.getUint8(1) === 1
  return { number, functions, isInverted, masks: from.some(from.u32(), () => ({ at: from.f32s(3), radius: from.f32() })) }
}

// Three of a quaternion's parts, 15 bits each; the largest one follows.
function readTurn(from) {
  const words = from.some(3, () => from.u16()), turn = [0, 0, 0, 0]
  const largest = (words[0] >> 15) | (words[1] >> 15) << 1
  let left = 1, next = 0
  for (let part = 0; part < 4; ++part) {
    if (part === largest) continue
    turn[part] = ((words[next++] & 0x7fff) / 32767 * 2 - 1) * Math.SQRT1_2
    left -= turn[part] ** 2
  }
  turn[largest] = Math.sqrt(Math.max(0, left))
  return turn
}

function readHand(from, bones) {
  const place = from.f32s(3), forearm = readTurn(from), joints = []
  joints[1] = { place, turn: readTurn(from) }
  for (let joint = 0; joint < JOINTS; ++joint) {
    if (joint === 1) continue
    const parent = joints[PARENTS[joint]], bone = bones[joint]
    const turn = FIXED.includes(joint) ? product(parent.turn, bone.turn) : readTurn(from)
    joints[joint] = { place: add(parent.place, turned(parent.turn, bone.place)), turn }
  }
  return { forearm, joints, bones }
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
function readField(from, before) {
  const kernel = from.u8(), flags = from.u8(), count = from.u16()
  const shared = flags & 2 ? from.f32() : 0, volume = flags & 8 ? from.f32() : 0
  const field = { kernel, volume, halfway: (flags & 16) !== 0, polynomial: flags & 1 ? from.f32s(12) : [], functions: [] }
  for (let number = 0; number < count; ++number) {
    const same = (flags & 4) !== 0 && before.functions[number]
    const centre = same ? taken(before, same.centre) : from.f32s(3), coefficient = from.f32s(3)
    field.functions.push({ centre, coefficient, inverse: same ? same.inverse : flags & 2 ? shared : from.f32() })
  }
  return field
}

// As the shader takes it, four numbers a texel.
function texelsOf({ kernel, volume, halfway, polynomial, functions }) {
  const head = [functions.length, kernel, polynomial.length > 0 ? 1 : 0, volume + (halfway ? 2 : 0)]
  return [...head, ...polynomial, ...functions.flatMap(({ centre, inverse, coefficient }) => [...centre, inverse, ...coefficient, 0])]
}

// weights: those that its vectors are for; null: it has fields.
function readStep(from) {
  const bakes = from.u8() === 1, hasVectors = from.u8() === 1, count = from.u16()
  if (hasVectors) return { bakes, count, weights: from.u32(), texels: from.f32s(3 * count) }
  const texels = []
  for (let left = count, field = null; left > 0; --left) {
    field = readField(from, field)
    texels.push(...texelsOf(field))
  }
  return { bakes, count, weights: null, texels }
}

function readUpdate(buffer, model) {
  const from = new Reader(buffer, 1), state = from.u8(), bits = from.u8(), status = from.u8(), steps = from.u32()
  const [number, tick, ticks, missed] = from.some(4, () => from.u64()), restChanges = from.u32(), jumps = from.u32()
  const [late, maxLate, sinceLast] = from.f32s(3), [lost, skipped, links] = from.some(3, () => from.u32())
  return {
    letGo: [(state & 16) !== 0, (state & 32) !== 0], symmetric: (state & 64) !== 0, isPuppet: (state & 128) !== 0,
    held: (state & 1) !== 0, inHand: (state & 8) !== 0, status, number, tick, ticks, missed, restChanges, jumps,
    late, maxLate, sinceLast, lost, skipped, links, bytes: buffer.byteLength,
    hands: [0, 1].map(slot => bits & 1 << slot ? {
      ...readHand(from, model.bones[slot][bits & 16 << slot ? 1 : 0]), silent: (bits & 4 << slot) !== 0, wristLost: (bits & 64 << slot) !== 0,
    } : null),
    steps: from.some(steps, () => readStep(from)),
  }
}
