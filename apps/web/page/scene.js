// Draws: the model, the hands, what they do to it, and the ground.
const CLAY = { colour: [0.44, 0.20, 0.115], gloss: 0.07, opacity: 1, rim_opacity: 1 }
// A hand is opaque before the ground, and one sees the model through it. A silent glove's is a mere shade.
const SKIN = { colour: [0.33, 0.345, 0.37], gloss: 0.10, opacity: 0.64, rim_opacity: 1 }
const SILENT = { colour: [0.22, 0.22, 0.22], gloss: 0, opacity: 0.25, rim_opacity: 0.85 }
const GHOST = { colour: [0.10, 0.28, 0.62], gloss: 0, opacity: 0.20, rim_opacity: 0.75 }
const BONE = { colour: [0.80, 0.78, 0.70], gloss: 0.10, opacity: 1, rim_opacity: 1 }
const ARROW = { colour: [0.95, 0.52, 0.02], gloss: 0.20, opacity: 1, rim_opacity: 1 }
const WIRE = { ...BONE, colour: [0.15, 0.15, 0.17], gloss: 0.30 }
const REACH = { colour: [0.80, 0.40, 0.05], gloss: 0, opacity: 0, rim_opacity: 0.3, unlit: true }
const CONTACTS = [[0.95, 0.80, 0.10], [0.95, 0.40, 0.02], [0.75, 0.04, 0.02]].map(colour => ({ ...BONE, colour }))
const SOLID = 1 // in the stencil: a model, a bone, an arrow
const LIT = { grid: 0, dark: 0, facets: false, unlit: false, fade: 1, shadow: [0, 0, 0] }

// A ball of two halves; the fourth number says to which end of a capsule a half belongs.
function unitCapsule(rings = 8, sides = 20) {
  const places = [], corners = []
  for (let ring = 0; ring < 2 * rings; ++ring)
    for (let side = 0; side < sides; ++side) {
      const end = ring < rings ? 0 : 1, turn = 2 * Math.PI * side / sides
      const latitude = Math.PI / 2 * (end ? (ring - rings) / (rings - 1) : ring / (rings - 1) - 1)
      places.push(Math.cos(latitude) * Math.cos(turn), Math.cos(latitude) * Math.sin(turn), Math.sin(latitude), end)
      const a = ring * sides + side, b = ring * sides + (side + 1) % sides
      if (ring + 1 < 2 * rings) corners.push(a, b, b + sides, a, b + sides, a + sides)
    }
  return { places: new Float32Array(places), corners: new Uint16Array(corners) }
}

class Scene {
  // parts: what is shown, by name. run: its settings, the clay's contacts, and a drawn wire.
  constructor(canvas, parts, run) {
    const gl = canvas.getContext('webgl2', { antialias: true, alpha: true, stencil: true, powerPreference: 'high-performance' })
    if (!gl) throw new Error('this browser shows no WebGL2')
    Object.assign(this, { gl, canvas, parts, run })
    this.skins = null // of the left hands and of the right ones, when what they are made of has come
    this.figures = { hands: [], marks: [] } // without a run
    const program = (vertex, colour) => makeProgram(gl, glsl('stage') + vertex, glsl(colour) + glsl('light'))
    this.model = program(glsl('deform') + glsl('model'), 'paint')
    ;[this.skin, this.capsule, this.ground] = ['skin', 'capsule', 'ground'].map(name => program(glsl(name), 'plain'))
    this.makeCapsules()
    const square = makeBuffer(gl, gl.ARRAY_BUFFER, new Float32Array([-3, 0, -3, 3, 0, -3, -3, 0, 3, 3, 0, 3]), gl.STATIC_DRAW)
    this.groundArray = makeArray(gl, [[square, 3]])
  }

  makeCapsules() {
    const { gl } = this, { places, corners } = unitCapsule()
    const shape = makeBuffer(gl, gl.ARRAY_BUFFER, places, gl.STATIC_DRAW)
    this.capsuleCorners = corners.length
    this.instances = gl.createBuffer()
    const ends = [0, 16].map(offset => [this.instances, 4, { stride: 32, offset, divisor: 1 }])
    this.capsuleArray = makeArray(gl, [[shape, 4], ...ends], makeBuffer(gl, gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW))
  }

  // fetchImage, changed: as Paint takes them.
  setModel(model, fetchImage, changed) {
    this.shape?.dispose()
    this.paint?.dispose()
    this.shape = new Shape(this.gl, model)
    this.paint = new Paint(this.gl, model, fetchImage, changed)
    this.scale = model.unit / model.unitsPerMetre
    if (this.name !== model.name) this.findPlace(model) // a new connection does not move the picture
    this.name = model.name
    this.offset = minus(times(model.origin, 1 / model.unitsPerMetre), this.origin)
  }
  // The model is on the ground about the middle, as large as on the stage. There may be none, but hands alone.
  findPlace(model) {
    if (model.vertices === 0) return Object.assign(this, { origin: [0, 0, 0], box: [], height: 0.3 })
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity]
    model.places.forEach((number, at) => {
      low[at % 3] = Math.min(low[at % 3], number)
      high[at % 3] = Math.max(high[at % 3], number)
    })
    const corners = [low, high].map(corner => add(times(corner, this.scale), times(model.origin, 1 / model.unitsPerMetre)))
    const [x, , z] = times(add(...corners), 0.5)
    this.origin = [x, corners[0][1], z]
    this.box = corners.map(corner => minus(corner, this.origin))
    this.height = this.box[1][1]
  }
  // Of the model and the hands, about the origin.
  boxWith(hands) {
    const places = [...this.box, ...hands.flatMap(hand => hand ? hand.joints.map(({ place }) => minus(place, this.origin)) : [])]
    const [low, high] = [Math.min, Math.max].map(most => [0, 1, 2].map(axis => most(...places.map(place => place[axis]))))
    return { low, high }
  }

  // Of the canvas, from its top left: where a place on the stage is drawn; null: behind the eye.
  pixelOf(place) {
    if (!this.view) return null
    const [x, y, z] = minus(place, this.origin), m = this.view.clip_of_world
    const row = at => m[at] * x + m[4 + at] * y + m[8 + at] * z + m[12 + at]
    const w = row(3), { clientWidth, clientHeight } = this.canvas
    return w > 0 ? [(1 + row(0) / w) / 2 * clientWidth, (1 - row(1) / w) / 2 * clientHeight] : null
  }

  capsules(capsules, material) {
    if (capsules.count === 0) return
    const { gl } = this
    this.capsule.use({ ...this.view, ...LIT, ...material })
    gl.bindVertexArray(this.capsuleArray)
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances)
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(capsules.numbers), gl.STREAM_DRAW)
    gl.drawElementsInstanced(gl.TRIANGLES, this.capsuleCorners, gl.UNSIGNED_SHORT, 0, capsules.count)
    gl.bindVertexArray(null)
  }

  setSkin(readSkin) { Object.assign(this, { readSkin, skins: [[], []] }) }
  skinOf(slot, number = 0) { return this.skins[slot][number] ||= new Skin(this.gl, this.readSkin, slot === 0 ? -1 : 1) }
  // Depth first, so that only its nearest layer is mixed in.
  drawSkin({ skin, bones, joints, look, isShade }) {
    const { gl } = this
    skin.draw(this.skin, bones, joints, { ...this.view, ...LIT, ...look }, triangles => {
      gl.colorMask(false, false, false, false)
      triangles()
      gl.colorMask(true, true, true, true)
      gl.stencilFunc(isShade ? gl.ALWAYS : gl.EQUAL, SOLID, 255)
      triangles()
      if (isShade) return
      gl.stencilFunc(gl.NOTEQUAL, SOLID, 255)
      this.skin.set({ opacity: 1 })
      triangles()
    })
  }

  resize() {
    const ratio = Math.min(2, window.devicePixelRatio || 1)
    const width = Math.round(this.canvas.clientWidth * ratio), height = Math.round(this.canvas.clientHeight * ratio)
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height })
  }

  draw(camera, update, holds) {
    const { gl, canvas } = this
    this.resize()
    const round = way => turned(turnAbout([0, 1, 0], camera.azimuth), unit(way))
    const aspect = canvas.width / Math.max(1, canvas.height)
    this.view = {
      clip_of_world: camera.projection(aspect), eye: camera.eye(),
      key: round([-0.55, 0.75, 0.55]), fill: round([0.85, 0.25, 0.50]), rim: round([0.45, 0.45, -0.80]),
    }
    gl.viewport(0, 0, canvas.width, canvas.height)
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT)
    gl.enable(gl.DEPTH_TEST)
    gl.enable(gl.BLEND)
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA)
    gl.depthFunc(gl.LEQUAL)
    if (!this.shape) return
    const beside = this.beside(update, holds)
    this.shape.prepare()
    gl.enable(gl.STENCIL_TEST)
    if (update) this.drawGround(beside)
    gl.clear(gl.STENCIL_BUFFER_BIT)
    gl.stencilFunc(gl.ALWAYS, SOLID, 255)
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.REPLACE)
    this.model.use({ ...this.view, ...LIT, ...CLAY, scale: this.scale, offset: this.offset, facets: this.parts.facets })
    this.shape.draw(this.model, part => this.paint.each(this.model, CLAY.colour, part))
    this.capsules(beside.bones, BONE)
    this.capsules(beside.arrows, ARROW)
    this.capsules(beside.wire, WIRE)
    beside.contacts.forEach((some, at) => this.capsules(some, CONTACTS[at]))
    beside.marks.forEach(({ capsules, material }) => this.capsules(capsules, material))
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.KEEP)
    beside.hands.forEach(hand => this.drawSkin(hand))
    gl.disable(gl.STENCIL_TEST)
    gl.depthMask(false)
    this.capsules(beside.reaches, REACH)
    gl.depthMask(true)
  }

  // What there is beside the model, about the scene's origin.
  beside(update, holds) {
    const [bones, arrows, reaches, wire, ...contacts] = Array.from({ length: 4 + CONTACTS.length }, () => new Capsules())
    const parts = { bones, arrows, reaches, wire, contacts, hands: [], marks: [] }
    if (!update) return { ...parts, ...this.figures }
    const { settings: { mode, radius_m } } = this.run, isByHands = mode === 'clay' || mode === 'parts'
    if (isByHands && this.parts.contact) this.addContacts(parts.contacts)
    this.run.wire.forEach((ends, at) => { // the newest, and what it has swept
      const [from, to] = ends.map(end => minus(end, this.origin)), isNewest = at + 1 === this.run.wire.length
      parts[isNewest ? 'wire' : 'reaches'].add(from, to, 0.0015, 0.0015)
    })
    update.hands.forEach((given, slot) => {
      if (!given) return
      const place = at => minus(at, this.origin)
      const joints = given.joints.map(joint => ({ place: place(joint.place), turn: joint.turn }))
      if (this.parts.hands && this.skins)
        parts.hands.push({ skin: this.skinOf(slot), bones: given.bones, joints, look: given.silent ? SILENT : SKIN, isShade: given.silent })
      if (this.parts.bones) bonesOf({ joints }, parts.bones)
      const starts = holds.starts[slot]
      if (!update.held || !starts || isByHands || update.isPuppet) return // their tips hold nothing
      TIPS.forEach((tip, finger) => {
        const start = place(starts[finger])
        if (this.parts.vectors) arrow(start, joints[tip].place, 0.007, parts.arrows)
        if (this.parts.radii) parts.reaches.add(start, start, radius_m[finger], radius_m[finger])
      })
    })
    return parts
  }

  // The harder a hand presses, the larger and the redder.
  addContacts(capsules) {
    const longest = Math.min(0.3, Math.max(0.05, this.height))
    for (const { place, strength } of this.run.contacts) {
      const at = minus(place, this.origin), radius = longest * (0.010 + 0.015 * strength)
      capsules[Math.min(CONTACTS.length - 1, Math.floor(CONTACTS.length * strength))].add(at, at, radius, radius)
    }
  }

  // With the shadows on it, none of which is drawn twice: the stencil says where one is.
  drawGround(beside) {
    const { gl } = this
    const fade = 2.6 * Math.min(2, Math.max(0.1, this.height))
    this.ground.use({ ...this.view, ...LIT, grid: 0.1, fade })
    gl.bindVertexArray(this.groundArray)
    gl.depthMask(false)
    gl.stencilFunc(gl.ALWAYS, 0, 255)
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.KEEP)
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4)
    gl.stencilFunc(gl.EQUAL, 0, 255)
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR)
    const shadow = { dark: 0.2, fade, shadow: this.view.key }
    this.model.use({ ...this.view, ...LIT, ...CLAY, ...shadow, scale: this.scale, offset: this.offset })
    this.shape.draw(this.model)
    for (const { skin, bones, joints } of beside.hands)
      skin.draw(this.skin, bones, joints, { ...this.view, ...LIT, ...CLAY, ...shadow }, triangles => triangles())
    gl.depthMask(true)
  }
}
