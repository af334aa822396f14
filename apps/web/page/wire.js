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
  if (from.u32() !== 9) throw new Error('this server speaks another version; reload the page')
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

// What follows the first four bytes of a message.
const textIn = buffer => new TextDecoder().decode(buffer.slice(4))

// The values of settings by their names, as `settings` sends them; radii are numbers.
function readSettings(buffer) {
  const settings = Object.fromEntries(textIn(buffer).split(' ').map(pair => pair.split('=')))
  return { ...settings, radius_m: settings.radius_m.split(',').map(Number) }
}

// By the names of commands why they are not possible; an empty reason: they are.
const readRefusals = buffer => new Map(textIn(buffer).split('\n').map(line => line.split('\t')).map(([name, , refusal]) => [name, refusal]))

// Where hands touch clay.
function readContacts(buffer) {
  const from = new Reader(buffer, 24), count = from.view.getUint16(2, true)
  return from.some(count, () => ({ place: from.f32s(3), strength: from.f32() }))
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
  const from = new Reader(buffer, 1), isInverted = from.u8() === 1, functions = from.u16(), number = from.u32()
  from.some(2 * functions, () => from.text(from.u8())) // names and signals, which the panel's form has as well
  return { number, isInverted, masks: from.some(from.u32(), () => ({ at: from.f32s(3), radius: from.f32() })) }
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
  const sum = place.map((x, row) => field.polynomial.length > 0 ? x + dot([1, ...place], field.polynomial.slice(4 * row)) : x)
  for (const { centre, inverse, coefficient } of field.functions) {
    const u = minus(place, centre).map(part => part * inverse), t = size(u)
    if (t >= 1) continue
    const clay = field.volume * (1 - t) ** 4
    const along = 15 * clay * dot(coefficient, u)
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
  const from = new Reader(buffer, 1), state = from.u8(), bits = from.u8(), has = (flags, bit) => (flags & bit) !== 0
  from.at = 4
  const steps = from.u32(), [number, , ticks] = from.some(4, () => from.u64()), [restChanges, jumps] = from.some(2, () => from.u32())
  const [, maxLate, sinceLast] = from.f32s(3), [lost, skipped] = from.some(2, () => from.u32())
  from.at = 72
  return {
    letGo: [has(state, 16), has(state, 32)], symmetric: has(state, 64), isPuppet: has(state, 128), held: has(state, 1),
    number, ticks, restChanges, jumps, maxLate, sinceLast, unseen: lost + skipped,
    hands: [0, 1].map(slot => has(bits, 1 << slot) ? {
      ...readHand(from, model.bones[slot][has(bits, 16 << slot) ? 1 : 0]), silent: has(bits, 4 << slot),
    } : null),
    steps: from.some(steps, () => readStep(from)),
  }
}
