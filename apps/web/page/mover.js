// The mouse places a hand, for gloves that have no tracker: the window's HandMover.
// From a right press near a hand, or a finger held on one, to its release. The camera hears nothing of it.
const HAND_REACH = 60 // pixels from a joint
const MAX_REACH = 2 // metres from the middle of the picture, on each axis: as far as arms reach
const PUSH = 0.01, RADIANS_A_PIXEL = 0.35 * Math.PI / 180

class HandMover {
  // see: what is in the picture now, { hands, pixelOf, origin }; nothing if there is none.
  constructor(canvas, camera, see) {
    Object.assign(this, { canvas, camera, see, held: null, moved: false })
    const hear = (name, act) => canvas.addEventListener(name, event => {
      if (act(event)) event.stopImmediatePropagation()
      canvas.classList.toggle('moving', this.held !== null)
    }, { capture: true, passive: false })
    hear('pointerdown', event => event.pointerType === 'touch' ? this.wait(event) : event.button === 2 && this.take(event))
    hear('pointermove', event => this.holds(event) ? this.follow(event) : this.stayOrForget(event))
    hear('wheel', event => this.held && this.push(event))
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'])
      hear(end, event => this.holds(event) ? this.letGo(event) : clearTimeout(this.timer))
  }
  // A finger takes the hand below it when it has been still for a while; a second finger is the camera's.
  wait(event) {
    clearTimeout(this.timer)
    this.first = event
    if (!this.held && event.isPrimary) this.timer = setTimeout(() => {
      if (!this.take(event)) return
      this.camera.forget(event)
      this.canvas.classList.add('moving')
    }, HOLD)
    return this.held !== null
  }
  stayOrForget(event) {
    const { first } = this
    if (first && Math.hypot(event.clientX - first.clientX, event.clientY - first.clientY) > 10) clearTimeout(this.timer)
  }
  holds(event) { return this.held !== null && event.pointerId === this.held.pointer }

  // The hand with the joint nearest to the pointer.
  take(event) {
    const seen = this.see()
    let nearest = HAND_REACH
    this.held = null
    for (const [slot, hand] of seen ? seen.hands.entries() : [])
      for (const { place } of hand ? hand.joints : []) {
        const pixel = seen.pixelOf(place)
        const distance = pixel ? Math.hypot(pixel[0] - event.clientX, pixel[1] - event.clientY) : Infinity
        if (distance >= nearest) continue
        nearest = distance
        this.held = { slot, pointer: event.pointerId, place: hand.joints[1].place, turn: hand.forearm, at: event, origin: seen.origin }
      }
    if (this.held) {
      // A hand that is farther away already stays where it is.
      const middle = add(this.camera.target, seen.origin)
      this.held.range = this.held.place.map((axis, at) =>
        [Math.min(axis, middle[at] - MAX_REACH), Math.max(axis, middle[at] + MAX_REACH)])
      this.canvas.setPointerCapture(event.pointerId)
    }
    return this.held !== null
  }
  letGo() {
    this.last = this.moved ? this.words() : null
    this.held = null
    return true
  }

  // With shift it turns about its wrist; otherwise it stays under the pointer.
  follow(event) {
    const { held, camera } = this
    const dx = event.clientX - held.at.clientX, dy = event.clientY - held.at.clientY
    const [right, up, back] = camera.axes()
    held.at = event
    this.moved = true
    if (event.shiftKey) {
      const by = product(turnAbout(right, RADIANS_A_PIXEL * dy), turnAbout(up, RADIANS_A_PIXEL * dx))
      held.turn = unit(product(by, held.turn))
    } else {
      const depth = Math.max(0, dot(back, minus(camera.eye(), minus(held.place, held.origin))))
      const metres = camera.pictureHeight(depth) / this.canvas.clientHeight
      this.go(add(times(right, dx * metres), times(up, -dy * metres)))
    }
    return true
  }
  // A step of the wheel is a centimetre; forward is away.
  push(event) {
    event.preventDefault()
    const steps = Math.sign(event.deltaY) * Math.min(1, Math.abs(event.deltaY) / 100)
    this.go(times(this.camera.axes()[2], PUSH * steps))
    return true
  }
  go(way) {
    this.held.place = add(this.held.place, way).map((axis, at) =>
      Math.min(this.held.range[at][1], Math.max(this.held.range[at][0], axis)))
    this.moved = true
  }

  words() {
    const { slot, place, turn } = this.held
    return `wrist ${slot === 0 ? 'left' : 'right'} ${[...place, ...turn].map(number => number.toFixed(6)).join(' ')}`
  }
  // The message to the loop since the last call; null: nothing.
  next() {
    const words = this.held && this.moved ? this.words() : this.last
    Object.assign(this, { moved: false, last: null })
    return words || null
  }
}
