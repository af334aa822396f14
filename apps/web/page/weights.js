// A puppet's weights on the graphics card. A step for them is a vector for each of some points; the shape that they make of
// the base, and its normals, come out by transform feedback.
const TEXELS_WIDE = 2048

// Of each vertex, the triangles about it, as their other two corners.
function roundOf(corners, vertices) {
  const counts = new Uint32Array(vertices), firsts = new Uint32Array(vertices), others = new Uint32Array(2 * corners.length)
  corners.forEach(corner => { counts[corner] += 1 })
  for (let vertex = 1; vertex < vertices; ++vertex) firsts[vertex] = firsts[vertex - 1] + counts[vertex - 1]
  const next = firsts.slice()
  for (let at = 0; at < corners.length; ++at) {
    const first = at - at % 3, place = next[corners[at]]++
    others[2 * place] = corners[first + (at + 1) % 3]
    others[2 * place + 1] = corners[first + (at + 2) % 3]
  }
  return { own: inPairs(firsts, counts), others }
}

function inPairs(firsts, counts) {
  const pairs = new Uint32Array(2 * firsts.length)
  firsts.forEach((first, at) => pairs.set([first, counts[at]], 2 * at))
  return pairs
}

class Weights {
  constructor(gl, shape) {
    this.gl = gl
    this.shape = shape
    this.number = null
    this.moving = makeProgram(gl, glsl('surface'), 'void main() {}', ['moved_place'])
    this.turning = makeProgram(gl, glsl('normals'), 'void main() {}', ['moved_normal'])
    this.feedback = gl.createTransformFeedback()
    this.textures = Object.fromEntries(['terms', 'vectors', 'places', 'round'].map(name => [name, gl.createTexture()]))
    const { own, others } = roundOf(shape.model.corners, shape.model.vertices)
    this.fill('round', gl.RG32UI, gl.RG_INTEGER, gl.UNSIGNED_INT, others, 2, TEXELS_WIDE)
    this.fill('places', gl.RGB32F, gl.RGB, gl.FLOAT, new Float32Array(3 * shape.seams.count), 3, TEXELS_WIDE)
    this.rounds = this.attribute(5, own)
    this.terms = null
  }

  dispose() {
    const { gl } = this
    Object.values(this.textures).forEach(texture => gl.deleteTexture(texture))
    for (const buffer of [this.rounds, this.terms]) gl.deleteBuffer(buffer)
    gl.deleteTransformFeedback(this.feedback)
    for (const program of [this.moving, this.turning]) program.dispose()
  }

  attribute(place, pairs) {
    const { gl, shape } = this
    const buffer = makeBuffer(gl, gl.ARRAY_BUFFER, forDrawn(pairs, 2, shape.seams), gl.STATIC_DRAW)
    for (const { array } of shape.states) {
      gl.bindVertexArray(array)
      gl.enableVertexAttribArray(place)
      gl.vertexAttribIPointer(place, 2, gl.UNSIGNED_INT, 0, 0)
    }
    gl.bindVertexArray(null)
    gl.bindBuffer(gl.ARRAY_BUFFER, null)
    return buffer
  }

  // Makes a texture of these numbers, with this number of them per texel.
  fill(name, internal, format, type, numbers, size, wide) {
    const { gl } = this
    const rows = Math.max(1, Math.ceil(numbers.length / size / wide))
    const data = new numbers.constructor(size * wide * rows)
    data.set(numbers)
    gl.activeTexture(gl.TEXTURE0)
    gl.bindTexture(gl.TEXTURE_2D, this.textures[name])
    gl.texImage2D(gl.TEXTURE_2D, 0, internal, wide, rows, 0, format, type, data)
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST)
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST)
  }

  take({ number, values, counts, ofVector }) {
    const { gl } = this
    const terms = new Float32Array(2 * values.length), firsts = new Uint32Array(counts.length)
    values.forEach((value, at) => terms.set([ofVector[at], value], 2 * at))
    for (let vertex = 1; vertex < counts.length; ++vertex) firsts[vertex] = firsts[vertex - 1] + counts[vertex - 1]
    this.fill('terms', gl.RG32F, gl.RG, gl.FLOAT, terms, 2, TEXELS_WIDE)
    gl.deleteBuffer(this.terms)
    this.terms = this.attribute(4, inPairs(firsts, counts))
    this.number = number
  }

  bind(program, names) {
    const { gl } = this
    names.forEach((name, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit)
      gl.bindTexture(gl.TEXTURE_2D, this.textures[name])
      program.set({ [name]: unit })
    })
    gl.activeTexture(gl.TEXTURE0)
  }

  // From the base to the other state.
  run(step) {
    const { gl, shape } = this
    const [places, normals] = shape.states[1].buffers
    this.fill('vectors', gl.RGBA32F, gl.RGBA, gl.FLOAT, new Float32Array(step.texels), 4, 256)
    this.moving.use()
    this.bind(this.moving, ['terms', 'vectors'])
    shape.transform(this.feedback, [places])
    this.copyPlaces(places)
    this.turning.use()
    this.bind(this.turning, ['places', 'round'])
    shape.transform(this.feedback, [normals])
  }

  // From the buffer, on the card: whole rows, and then what is left.
  copyPlaces(buffer) {
    const { gl, shape } = this
    const rows = Math.floor(shape.seams.count / TEXELS_WIDE), left = shape.seams.count % TEXELS_WIDE
    gl.bindTexture(gl.TEXTURE_2D, this.textures.places)
    gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, buffer)
    if (rows > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, TEXELS_WIDE, rows, gl.RGB, gl.FLOAT, 0)
    if (left > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, rows, left, 1, gl.RGB, gl.FLOAT, 12 * TEXELS_WIDE * rows)
    gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, null)
  }
}
