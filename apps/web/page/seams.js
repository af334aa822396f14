// A vertex at a seam of a picture has several texture coordinates, and at a seam of colours several colours. It is drawn as
// several vertices, which move alike: the model's own come first, and then the copies, each with its source.
function splitSeams({ vertices, corners, texcoords, colours, areColoursOfCorners }) {
  const tints = areColoursOfCorners ? colours : null, lists = [[texcoords, 2], [tints, 3]].filter(([values]) => values)
  if (!lists.length) return { count: vertices, sources: null, drawn: corners, texcoords, tints }
  const most = vertices + corners.length, drawn = new Uint32Array(corners.length), sources = new Uint32Array(most)
  const firsts = new Int32Array(most).fill(-1), next = new Int32Array(most).fill(-1) // the first corner, and the next copy
  let count = vertices
  for (let vertex = 0; vertex < vertices; ++vertex) sources[vertex] = vertex
  const isSame = (a, b) => lists.every(([values, size]) => {
    for (let n = 0; n < size; ++n) if (values[size * a + n] !== values[size * b + n]) return false
    return true
  })
  corners.forEach((vertex, corner) => {
    let at = vertex
    while (firsts[at] >= 0 && !isSame(firsts[at], corner)) {
      if (next[at] < 0) {
        next[at] = count
        sources[count++] = vertex
      }
      at = next[at]
    }
    if (firsts[at] < 0) firsts[at] = corner
    drawn[corner] = at
  })
  const used = firsts.slice(0, count).map(first => Math.max(0, first)) // a vertex without a corner is not drawn
  const own = (values, size) => values && forDrawn(values, size, { count, sources: used })
  return { count, sources: sources.slice(0, count), drawn, texcoords: own(texcoords, 2), tints: own(tints, 3) }
}

// What there is of each vertex, `size` numbers, for all that are drawn.
function forDrawn(values, size, { count, sources }) {
  if (!sources) return values
  const all = new values.constructor(size * count)
  sources.forEach((source, at) => { for (let n = 0; n < size; ++n) all[size * at + n] = values[size * source + n] })
  return all
}
