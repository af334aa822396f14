// A camera that goes round a place. Angles in radians, lengths in metres.
const FIELD_OF_VIEW = 24 * Math.PI / 180

class Camera {
  constructor(canvas, changed) {
    Object.assign(this, { canvas, changed, covered: 0 }) // at the left, by the panel, as a share of the width
    this.home = { azimuth: 0.38, elevation: 0.17, distance: 2.6, target: [0, 0.4, 0] }
    this.reset()
    const pointers = this.pointers = new Map()
    canvas.addEventListener('pointerdown', event => {
      canvas.setPointerCapture(event.pointerId)
      pointers.set(event.pointerId, event)
    })
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, event => this.forget(event))
    canvas.addEventListener('pointermove', event => {
      const last = pointers.get(event.pointerId)
      if (!last) return
      const dx = event.clientX - last.clientX, dy = event.clientY - last.clientY
      if (pointers.size > 1) this.pinch(event, dx / 2, dy / 2)
      else if (event.shiftKey || event.buttons & 6) this.pan(dx, dy)
      else this.orbit(dx, dy)
      pointers.set(event.pointerId, event)
    })
    canvas.addEventListener('wheel', event => {
      event.preventDefault()
      this.zoom(clamp(event.deltaY / 100, -1, 1))
    }, { passive: false })
    canvas.addEventListener('dblclick', () => this.reset())
    canvas.addEventListener('contextmenu', event => event.preventDefault())
  }

  change(values) { Object.assign(this, values); this.changed() }
  reset() { this.change(this.home) }
  // The first view: all of a box.
  see({ low, high }) {
    const distance = size(minus(high, low)) / 2 / Math.sin(FIELD_OF_VIEW / 2)
    Object.assign(this.home, { target: times(add(low, high), 0.5), distance: Math.max(0.3, distance) })
    this.reset()
  }
  look(azimuth, elevation) { this.change({ azimuth, elevation }) }
  // All in the picture, from where one looks.
  frame() { this.change({ distance: this.home.distance, target: this.home.target }) }
  orbit(dx, dy) { this.look(this.azimuth - 0.006 * dx, clamp(this.elevation + 0.006 * dy, -Math.PI / 2, Math.PI / 2)) }
  pan(dx, dy) {
    const metres = this.pictureHeight(this.distance) / this.canvas.clientHeight
    const [right, up] = this.axes()
    this.change({ target: add(this.target, add(times(right, -dx * metres), times(up, dy * metres))) })
  }
  zoom(steps) { this.change({ distance: clamp(this.distance * 1.12 ** steps, 0.15, 20) }) }
  // One of two fingers has moved.
  pinch(event, dx, dy) {
    const before = this.pointers.get(event.pointerId), other = [...this.pointers.values()].find(pointer => pointer !== before)
    this.zoom(Math.log(Math.max(1, apart(before, other)) / Math.max(1, apart(event, other))) / Math.log(1.12))
    this.pan(dx, dy)
  }
  forget(event) { this.pointers.delete(event.pointerId) }

  // Of the picture: right, up, and towards the eye.
  axes() {
    const [sa, ca] = [Math.sin(this.azimuth), Math.cos(this.azimuth)]
    const [se, ce] = [Math.sin(this.elevation), Math.cos(this.elevation)]
    return [[ca, 0, -sa], [-sa * se, ce, -ca * se], [sa * ce, se, ca * ce]]
  }
  // The height of the world that the picture shows at this distance from the eye.
  pictureHeight(depth) {
    const narrow = Math.min(1, (1 - this.covered) * this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight))
    return 2 * Math.tan(FIELD_OF_VIEW / 2) * depth / narrow
  }
  eye() { return add(this.target, times(this.axes()[2], this.distance)) }
  // Column by column, as WebGL takes it. The middle is that of the part that is not covered.
  projection(aspect) {
    const near = Math.max(0.02, this.distance - 4), far = this.distance + 8
    const [r, u, b] = this.axes(), eye = this.eye()
    const f = 1 / Math.tan(FIELD_OF_VIEW / 2), narrow = Math.min(1, aspect * (1 - this.covered))
    const rows = [[...times(r, f * narrow / aspect), -f * narrow / aspect * dot(r, eye)], [...times(u, f * narrow), -f * narrow * dot(u, eye)],
      [...b, -dot(b, eye)]]
    const z = rows[2].map(number => (far + near) / (near - far) * number)
    z[3] += 2 * far * near / (near - far)
    const w = rows[2].map(number => -number)
    rows[0] = rows[0].map((number, at) => number + this.covered * w[at])
    return [0, 1, 2, 3].flatMap(column => [rows[0][column], rows[1][column], z[column], w[column]])
  }
}
