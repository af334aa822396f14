// WebGL2 in fewer words.
const glsl = name => document.getElementById('glsl-' + name).textContent
const GLSL_HEAD = '#version 300 es\nprecision highp float;\nprecision highp int;\n'

function makeShader(gl, kind, text) {
  const shader = gl.createShader(kind)
  gl.shaderSource(shader, GLSL_HEAD + text)
  gl.compileShader(shader)
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader))
  return shader
}

// Uniforms by their names: program.set({ scale: 2, eye: [0, 0, 1] }).
function makeProgram(gl, vertex, fragment, feedback = []) {
  const program = gl.createProgram()
  gl.attachShader(program, makeShader(gl, gl.VERTEX_SHADER, vertex))
  gl.attachShader(program, makeShader(gl, gl.FRAGMENT_SHADER, fragment))
  if (feedback.length > 0) gl.transformFeedbackVaryings(program, feedback, gl.SEPARATE_ATTRIBS)
  gl.linkProgram(program)
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program))
  const setters = new Map(), kinds = { [gl.FLOAT]: 'uniform1f', [gl.FLOAT_VEC3]: 'uniform3fv', [gl.FLOAT_VEC4]: 'uniform4fv' }
  for (let at = 0; at < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++at) {
    const { name, type } = gl.getActiveUniform(program, at), place = gl.getUniformLocation(program, name)
    const set = value => gl[kinds[type] || 'uniform1i'](place, value)
    setters.set(name.replace('[0]', ''), type === gl.FLOAT_MAT4 ? value => gl.uniformMatrix4fv(place, false, value) : set)
  }
  return {
    dispose() { gl.deleteProgram(program) },
    use(values = {}) { gl.useProgram(program); this.set(values) },
    set(values) { for (const [name, value] of Object.entries(values)) setters.get(name)?.(value) },
  }
}

function makeBuffer(gl, target, data, usage) {
  const buffer = gl.createBuffer()
  gl.bindBuffer(target, buffer)
  gl.bufferData(target, data, usage)
  return buffer
}

// The first numbers of a buffer.
function fillBuffer(gl, buffer, data) {
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer)
  gl.bufferSubData(gl.ARRAY_BUFFER, 0, data)
  gl.bindBuffer(gl.ARRAY_BUFFER, null)
}

// Vertices with these attributes, in the order of their places: a buffer, how many numbers, and what is not usual.
// Those without a buffer are 1. corners: a buffer, if there is one.
function makeArray(gl, attributes, corners = null) {
  const array = gl.createVertexArray()
  gl.bindVertexArray(array)
  attributes.forEach(([buffer, size, { type = gl.FLOAT, isInteger = false, stride = 0, offset = 0, divisor = 0 } = {}], place) => {
    gl.vertexAttrib4f(place, 1, 1, 1, 1)
    if (!buffer) return
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer)
    gl.enableVertexAttribArray(place)
    if (isInteger) gl.vertexAttribIPointer(place, size, type, stride, offset)
    else gl.vertexAttribPointer(place, size, type, true, stride, offset)
    gl.vertexAttribDivisor(place, divisor)
  })
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, corners)
  gl.bindVertexArray(null)
  gl.bindBuffer(gl.ARRAY_BUFFER, null)
  return array
}
