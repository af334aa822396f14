// A camera that goes round a place. Angles in radians, lengths in metres.
const FIELD_OF_VIEW = 30 * Math.PI / 180

class Camera {
  constructor(canvas, changed) {
    this.canvas = canvas
    this.changed = changed
    this.home = { azimuth: 0.38, elevation: 0.17, distance: 2.6, target: [0, 0.4, 0] }
    this.reset()
    const pointers = new Map()
    canvas.addEventListener('pointerdown', event => {
      canvas.setPointerCapture(event.pointerId)
      pointers.set(event.pointerId, event)
    })
    const forget = event => pointers.delete(event.pointerId)
    canvas.addEventListener('pointerup', forget)
    canvas.addEventListener('pointercancel', forget)
    canvas.addEventListener('pointermove', event => {
      const last = pointers.get(event.pointerId)
      if (!last) return
      const dx = event.clientX - last.clientX, dy = event.clientY - last.clientY
      if (pointers.size > 1) this.pinch(pointers, event)
      else if (event.shiftKey || event.buttons & 6) this.pan(dx, dy)
      else this.orbit(dx, dy)
      pointers.set(event.pointerId, event)
    })
    canvas.addEventListener('wheel', event => {
      event.preventDefault()
      this.zoom(Math.sign(event.deltaY) * Math.min(1, Math.abs(event.deltaY) / 100))
    }, { passive: false })
    canvas.addEventListener('dblclick', () => this.reset())
    canvas.addEventListener('contextmenu', event => event.preventDefault())
  }

  reset() {
    Object.assign(this, { ...this.home, target: [...this.home.target] })
    this.changed()
  }
  look(azimuth, elevation) {
    Object.assign(this, { azimuth, elevation })
    this.changed()
  }
  // All in the picture, from where one looks.
  frame() {
    Object.assign(this, { distance: this.home.distance, target: [...this.home.target] })
    this.changed()
  }
  orbit(dx, dy) {
    this.azimuth -= 0.006 * dx
    this.elevation = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.elevation + 0.006 * dy))
    this.changed()
  }
  pan(dx, dy) {
    const metres = this.pictureHeight(this.distance) / this.canvas.clientHeight
    const [right, up] = this.axes()
    this.target = add(this.target, add(times(right, -dx * metres), times(up, dy * metres)))
    this.changed()
  }
  zoom(steps) {
    this.distance = Math.min(20, Math.max(0.15, this.distance * 1.12 ** steps))
    this.changed()
  }
  pinch(pointers, event) {
    const other = [...pointers.values()].find(pointer => pointer.pointerId !== event.pointerId)
    const apart = point => Math.hypot(point.clientX - other.clientX, point.clientY - other.clientY)
    this.zoom(Math.log(apart(pointers.get(event.pointerId)) / Math.max(1, apart(event))) / Math.log(1.12))
  }

  // Of the picture: right, up, and towards the eye.
  axes() {
    const [sa, ca] = [Math.sin(this.azimuth), Math.cos(this.azimuth)]
    const [se, ce] = [Math.sin(this.elevation), Math.cos(this.elevation)]
    return [[ca, 0, -sa], [-sa * se, ce, -ca * se], [sa * ce, se, ca * ce]]
  }
  // The height of the world that the picture shows at this distance from the eye.
  pictureHeight(depth) {
    const narrow = Math.min(1, this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight))
    return 2 * Math.tan(FIELD_OF_VIEW / 2) * depth / narrow
  }
  eye() { return add(this.target, times(this.axes()[2], this.distance)) }
  // Column by column, as WebGL takes it. shift: of the middle, as a share of half the width.
  projection(aspect, shift) {
    const near = Math.max(0.02, this.distance - 4), far = this.distance + 8
    const [r, u, b] = this.axes(), eye = this.eye()
    const f = 1 / Math.tan(FIELD_OF_VIEW / 2), narrow = Math.min(1, aspect)
    const rows = [[...times(r, f * narrow / aspect), -f * narrow / aspect * dot(r, eye)], [...times(u, f * narrow), -f * narrow * dot(u, eye)],
      [...b, -dot(b, eye)]]
    const z = rows[2].map(number => (far + near) / (near - far) * number)
    z[3] += 2 * far * near / (near - far)
    const w = rows[2].map(number => -number)
    rows[0] = rows[0].map((number, at) => number + shift * w[at])
    const clip = []
    for (let column = 0; column < 4; ++column) clip.push(rows[0][column], rows[1][column], z[column], w[column])
    return clip
  }
}
