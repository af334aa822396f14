// Masks are painted on the model: drag over what fingertips shall leave as it is; with shift, over what may move again.
const BRUSH = 0.04 // of the model's diagonal
const BETWEEN = 0.3 // of the brush's radius, between places of a stroke
const HALF = 0.75 // of a mask's radius, where half is held: the brush's edge
const BESIDE = 14 // pixels from the pointer to a vertex that it meets

class MaskPainter {
  // see: { scene, model, puppet, camera }.
  constructor(canvas, see, ask) {
    Object.assign(this, { see, ask, isOn: false, stroke: null })
    const hear = (name, act) => canvas.addEventListener(name, event => act(event) && event.stopImmediatePropagation(), { capture: true })
    hear('pointerdown', event => this.begin(event))
    hear('pointermove', event => this.stroke && this.paint(event))
    for (const end of ['pointerup', 'pointercancel']) hear(end, () => this.stroke && this.end())
  }
  // Beside the model, the camera turns.
  begin(event) {
    if (!this.isOn || !event.isPrimary || event.button !== 0) return false
    this.stroke = { drawn: this.see().scene.shape.vertices(), places: [], frees: event.shiftKey }
    if (!this.paint(event)) this.stroke = null
    return this.stroke !== null
  }
  // Masks are of the model before it was shaped. What is painted is shown at once, and sent as one change at the end.
  paint({ clientX, clientY }) {
    const { scene, model, puppet } = this.see(), { drawn, places, frees } = this.stroke, at = this.vertexAt([clientX, clientY], drawn)
    if (at === null) return places.length > 0
    const rest = restOf(model, at), radius = BRUSH * model.diagonal
    if (places.length > 0 && size(minus(rest, places.at(-1))) < BETWEEN * radius) return true
    places.push(rest)
    const isLeft = mask => !frees || size(minus(mask.at, rest)) > radius
    puppet.masks = puppet.masks.filter(isLeft).concat(frees ? [] : [{ at: rest, radius: radius / HALF }])
    scene.shape.setHeld(heldBy(puppet, model))
    return true
  }
  end() {
    const { places, frees } = this.stroke, radius = BRUSH * this.see().model.diagonal
    for (const place of places) this.ask(`mask ${frees ? 'free' : 'hold'} ${[...place, radius].map(number => number.toFixed(6)).join(' ')}`)
    this.stroke = null
    return true
  }
  // The vertex that is drawn nearest to the eye below the pointer, by its number in the message; null: none is there.
  vertexAt([x, y], places) {
    const { scene, model, camera } = this.see(), eye = add(camera.eye(), scene.origin)
    let nearest = null, least = Infinity
    model.order.forEach((vertex, at) => {
      const place = [0, 1, 2].map(axis => places[3 * vertex + axis] / model.unitsPerMetre), pixel = scene.pixelOf(place)
      if (!pixel || Math.hypot(pixel[0] - x, pixel[1] - y) > BESIDE) return
      const depth = size(minus(place, eye))
      if (depth < least) [nearest, least] = [at, depth]
    })
    return nearest
  }
}

const restOf = ({ origin, unit, places }, at) => [0, 1, 2].map(axis => origin[axis] + unit * places[3 * at + axis])

// Of each vertex, how much it is held, 0 to 255. The shares of the masks remain with the model, so that a mask that is added
// takes one pass over the vertices.
function heldBy({ masks, isInverted }, model) {
  const isSame = (mask, at) => `${mask.at} ${mask.radius}` === `${masks[at]?.at} ${masks[at]?.radius}`
  if (!model.held?.masks.every(isSame)) model.held = { masks: [], shares: new Float32Array(model.vertices) }
  for (const mask of masks.slice(model.held.masks.length)) hold(model, mask, model.held.shares)
  model.held.masks = masks
  return Uint8Array.from(model.held.shares, share => Math.round(255 * (isInverted ? 1 - share : share)))
}

// A mask holds a vertex within half of its radius wholly, and then less.
function hold({ origin, unit, places, vertices }, { at: [x, y, z], radius }, shares) {
  for (let vertex = 0, at = 0; vertex < vertices; ++vertex) {
    const distance = Math.hypot(origin[0] + unit * places[at++] - x, origin[1] + unit * places[at++] - y, origin[2] + unit * places[at++] - z)
    shares[vertex] = Math.max(shares[vertex], clamp(2 - 2 * distance / radius, 0, 1))
  }
}
