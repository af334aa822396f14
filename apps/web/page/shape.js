// The model's shape on the graphics card: a base, and the fields that are drawn over it. A step that
// bakes makes a new base by transform feedback, so that no vertex ever comes from the network but
// with a whole shape.
const BAKE_AT_ONCE = 256 * 64 // texels; a longer step is baked in several turns

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
    this.gl = gl
    this.model = model
    this.seams = splitSeams(model)
    this.bake = makeProgram(gl, glsl('deform') + glsl('bake'), 'void main() {}', ['baked_place', 'baked_normal'])
    this.corners = makeBuffer(gl, gl.ELEMENT_ARRAY_BUFFER, this.seams.drawn, gl.STATIC_DRAW)
    this.texcoords = this.seams.texcoords && makeBuffer(gl, gl.ARRAY_BUFFER, this.seams.texcoords, gl.STATIC_DRAW)
    const tints = this.seams.tints || (model.colours && forDrawn(model.colours, 3, this.seams))
    this.tints = tints && makeBuffer(gl, gl.ARRAY_BUFFER, tints, gl.STATIC_DRAW)
    this.states = [this.makeState(), this.makeState()] // the first is the base
    this.feedback = gl.createTransformFeedback()
    this.texture = gl.createTexture()
    this.pending = NOTHING
    this.weights = null // of a puppet
    this.isMoved = false // the other state is what the pending vectors make of the base
    this.number = null // of the frame whose shape this is; null: none has come
    this.setBase(model.places)
  }

  makeState() {
    const { gl } = this
    const array = gl.createVertexArray()
    gl.bindVertexArray(array)
    const buffers = [0, 1].map(which => {
      const buffer = makeBuffer(gl, gl.ARRAY_BUFFER, 12 * this.seams.count, gl.DYNAMIC_COPY)
      gl.enableVertexAttribArray(which)
      gl.vertexAttribPointer(which, 3, gl.FLOAT, false, 0, 0)
      return buffer
    })
    this.share(2, this.texcoords, 2, gl.FLOAT, 0)
    this.share(3, this.tints, 3, gl.UNSIGNED_SHORT, 6)
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.corners)
    gl.bindVertexArray(null)
    gl.bindBuffer(gl.ARRAY_BUFFER, null)
    return { array, buffers }
  }

  // An attribute that both states have; 1, where the model has none.
  share(place, buffer, size, type, stride) {
    const { gl } = this
    gl.vertexAttrib4f(place, 1, 1, 1, 1)
    if (!buffer) return
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer)
    gl.enableVertexAttribArray(place)
    gl.vertexAttribPointer(place, size, type, type !== gl.FLOAT, stride, 0)
  }

  dispose() {
    const { gl } = this
    if (this.weights) this.weights.dispose()
    for (const { array, buffers } of this.states) {
      gl.deleteVertexArray(array)
      buffers.forEach(buffer => gl.deleteBuffer(buffer))
    }
    for (const buffer of [this.corners, this.texcoords, this.tints]) gl.deleteBuffer(buffer)
    this.bake.dispose()
    gl.deleteTransformFeedback(this.feedback)
    gl.deleteTexture(this.texture)
  }

  setBase(places) {
    const { gl } = this
    const data = [places, normalsOf(places, this.model.corners)]
    this.states[0].buffers.forEach((buffer, which) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer)
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, forDrawn(data[which], 3, this.seams))
    })
    gl.bindBuffer(gl.ARRAY_BUFFER, null)
    this.pending = NOTHING
  }

  takeShape(shape) {
    this.setBase(shape.places)
    this.number = shape.number
  }

  takeWeights(weights) {
    if (!this.weights) this.weights = new Weights(this.gl, this)
    this.weights.take(weights)
    this.pending = NOTHING // which was for those before
  }

  takeStep(step) {
    if (step.weights !== null && (!this.weights || step.weights !== this.weights.number)) return
    this.isMoved = false
    this.pending = step.bakes ? NOTHING : step
    if (!step.bakes || step.count === 0) return
    if (step.weights === null) return this.bakeFields(step)
    this.weights.run(step)
    this.states.reverse()
  }

  // Makes what is pending the other state.
  makeMoved() {
    if (this.pending.weights === null) return this.run(this.pending)
    if (!this.isMoved) this.weights.run(this.pending)
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
    const { gl } = this
    this.bake.use()
    this.sendFields(fields, this.bake)
    this.transform(this.feedback, this.states[1].buffers)
  }

  // Writes what the program that is in use makes of the base.
  transform(feedback, buffers) {
    const { gl } = this
    gl.bindVertexArray(this.states[0].array)
    gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, feedback)
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

  bakeFields(step) {
    for (const part of inParts(step, BAKE_AT_ONCE)) {
      this.run(part)
      this.states.reverse()
    }
  }

  // The vertices as the shader makes them, in the mesh's order and units.
  vertices() {
    const { gl, model } = this
    this.makeMoved()
    const read = new Float32Array(3 * model.vertices)
    gl.bindBuffer(gl.ARRAY_BUFFER, this.states[1].buffers[0])
    gl.getBufferSubData(gl.ARRAY_BUFFER, 0, read)
    gl.bindBuffer(gl.ARRAY_BUFFER, null)
    const result = new Float64Array(3 * model.vertices)
    model.order.forEach((vertex, at) => {
      for (let axis = 0; axis < 3; ++axis)
        result[3 * vertex + axis] = model.origin[axis] + model.unit * read[3 * at + axis]
    })
    return result
  }

  // Before the program is used that draws: what that needs of others.
  prepare() { if (this.pending.weights !== null) this.makeMoved() }

  // paint: calls back for each part; by default there is one.
  draw(program, paint = part => part(0, this.model.corners.length)) {
    const { gl } = this, isMoved = this.pending.weights !== null
    this.sendFields(isMoved ? NOTHING : this.pending, program)
    gl.bindVertexArray(this.states[isMoved ? 1 : 0].array)
    paint((first, count) => gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * first))
    gl.bindVertexArray(null)
  }
}

// Whole fields, so many texels at once; one that is halfway stays with the next.
function inParts(step, most) {
  const parts = []
  let part = { count: 0, texels: [] }, isHalfway = false
  for (let at = 0, field = 0; field < step.count; ++field) {
    const size = 4 * (1 + (step.texels[at + 2] ? 3 : 0) + 2 * step.texels[at])
    if (!isHalfway && part.count > 0 && part.texels.length + size > 4 * most) {
      parts.push(part)
      part = { count: 0, texels: [] }
    }
    for (let n = at; n < at + size; ++n) part.texels.push(step.texels[n])
    part.count += 1
    isHalfway = step.texels[at + 3] >= 2
    at += size
  }
  return [...parts, part]
}
