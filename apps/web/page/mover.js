// The mouse places a hand, for gloves that have no tracker: the window's HandMover.
// From a right press near a hand, or a finger held on one, to its release. The camera hears nothing of it.
const HAND_REACH = 60 // pixels from a joint
const MAX_REACH = 2 // metres from the middle of the picture, on each axis: as far as arms reach
const PUSH = 0.01, RADIANS_A_PIXEL = 0.35 * Math.PI / 180

class HandMover {
  // see: what is in the picture now, { hands, pixelOf, origin }; nothing if there is none.
  constructor(canvas, camera, see, ask) {
    Object.assign(this, { canvas, camera, see, ask, held: null })
    const hear = (name, act) => canvas.addEventListener(name, event => {
      if (act(event)) event.stopImmediatePropagation()
      canvas.classList.toggle('moving', this.held !== null)
    }, { capture: true, passive: false })
    hear('pointerdown', event => event.pointerType === 'touch' ? this.wait(event) : event.button === 2 && this.take(event))
    hear('pointermove', event => this.holds(event) ? this.follow(event) : this.first && apart(event, this.first) > 10 && clearTimeout(this.timer))
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
  holds(event) { return this.held !== null && event.pointerId === this.held.pointer }

  // The hand with the joint nearest to the pointer.
  take(event) {
    const seen = this.see() || { hands: [] }
    const farFrom = pixel => pixel ? Math.hypot(pixel[0] - event.clientX, pixel[1] - event.clientY) : Infinity
    const jointsOf = (hand, slot) => hand ? hand.joints.map(({ place }) => ({ hand, slot, far: farFrom(seen.pixelOf(place)) })) : []
    const { hand, slot } = seen.hands.flatMap(jointsOf).reduce((a, b) => b.far < a.far ? b : a, { far: HAND_REACH })
    this.held = null
    if (!hand) return false
    const middle = add(this.camera.target, seen.origin), { place } = hand.joints[1]
    // A hand that is farther away already stays where it is.
    const range = place.map((axis, at) => [Math.min(axis, middle[at] - MAX_REACH), Math.max(axis, middle[at] + MAX_REACH)])
    this.held = { slot, place, range, pointer: event.pointerId, turn: hand.forearm, at: event, origin: seen.origin }
    this.canvas.setPointerCapture(event.pointerId)
    return true
  }
  letGo() {
    this.held = null
    return true
  }

  // With shift it turns about its wrist; otherwise it stays under the pointer.
  follow(event) {
    const { held, camera } = this
    const dx = event.clientX - held.at.clientX, dy = event.clientY - held.at.clientY
    const [right, up, back] = camera.axes()
    held.at = event
    if (event.shiftKey) {
      const by = product(turnAbout(right, RADIANS_A_PIXEL * dy), turnAbout(up, RADIANS_A_PIXEL * dx))
      this.go([0, 0, 0], unit(product(by, held.turn)))
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
    this.go(times(this.camera.axes()[2], PUSH * clamp(event.deltaY / 100, -1, 1)))
    return true
  }
  go(way, turn = this.held.turn) {
    const { slot, place, range } = this.held
    Object.assign(this.held, { turn, place: add(place, way).map((axis, at) => clamp(axis, ...range[at])) })
    const numbers = [...this.held.place, ...turn].map(number => number.toFixed(6))
    this.ask(`wrist ${slot === 0 ? 'left' : 'right'} ${numbers.join(' ')}`, this)
  }
}
