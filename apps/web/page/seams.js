// A vertex at a seam of a picture has several texture coordinates. It is drawn as several vertices, which move alike: the
// model's own come first, and then those that are more, each with its source.
function splitSeams({ vertices, corners, texcoords }) {
  if (!texcoords) return { count: vertices, sources: null, drawn: corners, texcoords: null }
  const most = vertices + corners.length
  const sources = new Uint32Array(most), next = new Int32Array(most).fill(-1), uv = new Float32Array(2 * most)
  const isUsed = new Uint8Array(vertices), drawn = new Uint32Array(corners.length)
  let count = vertices
  for (let vertex = 0; vertex < vertices; ++vertex) sources[vertex] = vertex
  const put = (at, u, v) => uv.set([u, v], 2 * at)
  corners.forEach((vertex, corner) => {
    const u = texcoords[2 * corner], v = texcoords[2 * corner + 1]
    let at = vertex
    if (!isUsed[vertex]) {
      isUsed[vertex] = 1
      put(vertex, u, v)
    }
    while (uv[2 * at] !== u || uv[2 * at + 1] !== v) {
      if (next[at] < 0) {
        next[at] = count
        sources[count] = vertex
        put(count++, u, v)
      }
      at = next[at]
    }
    drawn[corner] = at
  })
  return { count, sources: sources.slice(0, count), drawn, texcoords: uv.slice(0, 2 * count) }
}

// What there is of each vertex, `size` numbers, for all that are drawn.
function forDrawn(values, size, { count, sources }) {
  if (!sources) return values
  const all = new values.constructor(size * count)
  sources.forEach((source, at) => { for (let n = 0; n < size; ++n) all[size * at + n] = values[size * source + n] })
  return all
}
