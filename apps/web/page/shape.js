// The model's shape on the graphics card: a base, and the fields that are drawn over it. A step that
// bakes makes a new base by transform feedback, so that no vertex ever comes from the network but
// with a whole shape. Along a surface there is no field: a puppet's vertices are summed up here.

function normalsOf(places, corners) {
  const normals = new Float32Array(places.length)
  for (let at = 0; at < corners.length; at += 3) {
    const [a, b, c] = [3 * corners[at], 3 * corners[at + 1], 3 * corners[at + 2]]
    const ux = places[b] - places[a], uy = places[b + 1] - places[a + 1], uz = places[b + 2] - places[a + 2]
    const vx = places[c] - places[a], vy = places[c + 1] - places[a + 1], vz = places[c + 2] - places[a + 2]
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx
    for (const corner of [a, b, c]) {
      normals[corner] += x
      normals[corner + 1] += y
      normals[corner + 2] += z
    }
  }
  for (let at = 0; at < normals.length; at += 3) {
    const size = Math.hypot(normals[at], normals[at + 1], normals[at + 2]) || 1
    for (let axis = 0; axis < 3; ++axis) normals[at + axis] /= size
  }
  return normals
}

const NOTHING = { count: 0, texels: [], weights: null }

class Shape {
  constructor(gl, model) {
    Object.assign(this, { gl, model, seams: splitSeams(model) })
    this.bake = makeProgram(gl, glsl('deform') + glsl('bake'), 'void main() {}', ['baked_place', 'baked_normal'])
    this.corners = makeBuffer(gl, gl.ELEMENT_ARRAY_BUFFER, this.seams.drawn, gl.STATIC_DRAW)
    this.texcoords = this.seams.texcoords && makeBuffer(gl, gl.ARRAY_BUFFER, this.seams.texcoords, gl.STATIC_DRAW)
    const tints = this.seams.tints || (model.colours && forDrawn(model.colours, 3, this.seams))
    this.tints = tints && makeBuffer(gl, gl.ARRAY_BUFFER, tints, gl.STATIC_DRAW)
    this.held = makeBuffer(gl, gl.ARRAY_BUFFER, new Uint8Array(this.seams.count), gl.DYNAMIC_DRAW) // by masks
    this.states = [this.makeState(), this.makeState()] // the first is the base
    this.feedback = gl.createTransformFeedback()
    this.texture = gl.createTexture()
    this.weights = null // of a puppet
    this.number = null // of the frame whose shape this is; null: none has come
    this.setBase(model.places)
  }

  makeState() {
    const { gl } = this, { UNSIGNED_SHORT, UNSIGNED_BYTE } = gl
    const buffers = [0, 1].map(() => makeBuffer(gl, gl.ARRAY_BUFFER, 12 * this.seams.count, gl.DYNAMIC_COPY))
    const shared = [[this.texcoords, 2], [this.tints, 3, { type: UNSIGNED_SHORT }], [this.held, 1, { type: UNSIGNED_BYTE }]]
    return { array: makeArray(gl, [...buffers.map(buffer => [buffer, 3]), ...shared], this.corners), buffers }
  }

  dispose() {
    const { gl } = this, buffers = this.states.flatMap(state => state.buffers)
    for (const { array } of this.states) gl.deleteVertexArray(array)
    for (const buffer of [...buffers, this.corners, this.texcoords, this.tints, this.held]) gl.deleteBuffer(buffer)
    this.bake.dispose()
    gl.deleteTransformFeedback(this.feedback)
    gl.deleteTexture(this.texture)
  }

  // base: null if only the card has it. isOld: the card has another one.
  setBase(places) { Object.assign(this, { base: places, isOld: true, pending: NOTHING, isMoved: false }) }
  upload(state, places) {
    const data = [places, normalsOf(places, this.model.corners)]
    state.buffers.forEach((buffer, which) => fillBuffer(this.gl, buffer, forDrawn(data[which], 3, this.seams)))
  }
  // In the model's order, whose vertices come first.
  read(state) {
    const { gl } = this, places = new Float32Array(3 * this.model.vertices)
    gl.bindBuffer(gl.ARRAY_BUFFER, state.buffers[0])
    gl.getBufferSubData(gl.ARRAY_BUFFER, 0, places)
    gl.bindBuffer(gl.ARRAY_BUFFER, null)
    return places
  }

  takeShape(shape) {
    this.setBase(shape.places)
    this.number = shape.number
  }

  // held: of each vertex, 0 to 255.
  setHeld(held) { fillBuffer(this.gl, this.held, forDrawn(held, 1, this.seams)) }

  // What was pending was for the previous ones.
  takeWeights(weights) { if (weights.counts.length === this.model.vertices) Object.assign(this, { weights, pending: NOTHING }) }

  takeStep(step) {
    if (step.weights !== null && (!this.weights || step.weights !== this.weights.number)) return
    if (!step.bakes) Object.assign(this, { pending: step, isMoved: false })
    else if (step.weights !== null) this.setBase(this.moved(step))
    else this.bakeFields(step)
  }
  bakeFields(step) {
    this.pending = NOTHING
    if (step.count === 0) return
    this.run(step)
    this.states.reverse()
    this.base = null
  }
  // What a step's vectors make of the base: each vertex moves by the sum of its terms, a value times a vector.
  moved({ texels }) {
    this.base ||= this.read(this.states[0])
    const { values, counts, ofVector } = this.weights, places = new Float32Array(this.base)
    for (let vertex = 0, term = 0; vertex < counts.length; ++vertex)
      for (const end = term + counts[vertex]; term < end; ++term)
        for (let axis = 0; axis < 3; ++axis) places[3 * vertex + axis] += values[term] * texels[3 * ofVector[term] + axis]
    return places
  }

  // Before anything is drawn, or made of the base: what the card lacks. Makes pending vectors the other state.
  prepare() {
    if (this.isOld) this.upload(this.states[0], this.base)
    this.isOld = false
    if (this.pending.weights === null || this.isMoved) return
    this.upload(this.states[1], this.moved(this.pending))
    this.isMoved = true
  }

  // Binds the fields, for a program that contains deform.glsl.
  sendFields(fields, program) {
    const { gl } = this
    const rows = Math.max(1, Math.ceil(fields.texels.length / 1024))
    const data = new Float32Array(1024 * rows)
    data.set(fields.texels)
    gl.activeTexture(gl.TEXTURE0)
    gl.bindTexture(gl.TEXTURE_2D, this.texture)
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 256, rows, 0, gl.RGBA, gl.FLOAT, data)
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST)
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST)
    program.set({ fields: 0, field_count: fields.count })
  }

  // From the base to the other state.
  run(fields) {
    const { gl } = this, { buffers } = this.states[1]
    this.prepare()
    this.bake.use()
    this.sendFields(fields, this.bake)
    gl.bindVertexArray(this.states[0].array)
    gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, this.feedback)
    buffers.forEach((buffer, which) => gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, which, buffer))
    gl.enable(gl.RASTERIZER_DISCARD)
    gl.beginTransformFeedback(gl.POINTS)
    gl.drawArrays(gl.POINTS, 0, this.seams.count)
    gl.endTransformFeedback()
    gl.disable(gl.RASTERIZER_DISCARD)
    buffers.forEach((_, which) => gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, which, null))
    gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, null)
    gl.bindVertexArray(null)
  }

  // The vertices as they are drawn, in the mesh's order and units.
  vertices() {
    const { model } = this, result = new Float64Array(3 * model.vertices)
    if (this.pending.weights === null) this.run(this.pending)
    this.prepare()
    const places = this.read(this.states[1])
    model.order.forEach((vertex, at) => {
      for (let axis = 0; axis < 3; ++axis) result[3 * vertex + axis] = model.origin[axis] + model.unit * places[3 * at + axis]
    })
    return result
  }

  // paint: calls back for each part; by default there is one.
  draw(program, paint = part => part(0, this.model.corners.length)) {
    const { gl } = this, isMoved = this.pending.weights !== null
    this.sendFields(isMoved ? NOTHING : this.pending, program)
    gl.bindVertexArray(this.states[isMoved ? 1 : 0].array)
    paint((first, count) => gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * first))
    gl.bindVertexArray(null)
  }
}
