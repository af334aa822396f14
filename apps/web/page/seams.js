// A vertex at a seam of a picture has several texture coordinates, and at a seam of colours several colours. It is drawn as
// several vertices, which move alike: the model's own come first, and then the copies, each with its source.
function splitSeams({ vertices, corners, texcoords, colours, areColoursOfCorners }) {
  // What corners have of their own: how many numbers, those of all corners, and those of all that is drawn.
  const lists = []
  const most = vertices + corners.length
  const list = (size, given) => given && lists[lists.push({ size, given, drawn: new given.constructor(size * most) }) - 1]
  const uv = list(2, texcoords), tints = list(3, areColoursOfCorners ? colours : null)
  if (!lists.length) return { count: vertices, sources: null, drawn: corners, texcoords: null, tints: null }
  const sources = new Uint32Array(most), next = new Int32Array(most).fill(-1)
  const isUsed = new Uint8Array(vertices), drawn = new Uint32Array(corners.length)
  let count = vertices
  for (let vertex = 0; vertex < vertices; ++vertex) sources[vertex] = vertex
  const put = (at, corner) => {
    for (const { size, given, drawn } of lists) for (let n = 0; n < size; ++n) drawn[size * at + n] = given[size * corner + n]
  }
  const isSame = (at, corner) => {
    for (const { size, given, drawn } of lists)
      for (let n = 0; n < size; ++n) if (drawn[size * at + n] !== given[size * corner + n]) return false
    return true
  }
  corners.forEach((vertex, corner) => {
    let at = vertex
    if (!isUsed[vertex]) {
      isUsed[vertex] = 1
      put(vertex, corner)
    }
    while (!isSame(at, corner)) {
      if (next[at] < 0) {
        next[at] = count
        sources[count] = vertex
        put(count++, corner)
      }
      at = next[at]
    }
    drawn[corner] = at
  })
  const used = one => one && one.drawn.slice(0, one.size * count)
  return { count, sources: sources.slice(0, count), drawn, texcoords: used(uv), tints: used(tints) }
}

// What there is of each vertex, `size` numbers, for all that are drawn.
function forDrawn(values, size, { count, sources }) {
  if (!sources) return values
  const all = new values.constructor(size * count)
  sources.forEach((source, at) => { for (let n = 0; n < size; ++n) all[size * at + n] = values[size * source + n] })
  return all
}
