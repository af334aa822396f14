// Drawings in canvases: charts, and those of forms (PROTOCOL.md, message 12), with the pointer in them.
const BETWEEN_INPUTS = 50 // ms, because a form takes one input for each of its pictures

// Draws shapes, stretched across, but not their words. imageOf: the bitmap of a picture; null: it is not there yet.
function draw(canvas, shapes, across = 1, imageOf = null) {
  const ratio = window.devicePixelRatio || 1, style = getComputedStyle(canvas), inkOf = name => style.getPropertyValue('--' + name), pen = canvas.getContext('2d')
  Object.assign(canvas, { width: canvas.clientWidth * ratio, height: canvas.clientHeight * ratio })
  pen.scale(ratio, ratio)
  Object.assign(pen, { font: '13px Inter, "DejaVu Sans", system-ui, sans-serif', textBaseline: 'middle', lineWidth: 1.2 })
  for (const [kind, what, ...rest] of shapes) {
    if (kind === 'picture') {
      const image = imageOf(what), [left, top, right, bottom, from, to] = rest
      if (image) pen.drawImage(image, from, 0, to - from, image.height, left * across, top, (right - left) * across, bottom - top)
      continue
    }
    const [x, y, more] = rest, points = kind === 'diamond' ? [x, y - 7, x + 7 / across, y, x, y + 7, x - 7 / across, y] : rest
    Object.assign(pen, { fillStyle: inkOf(what), strokeStyle: inkOf(kind === 'diamond' ? more : what) })
    if (kind === 'words') pen.fillText(more, x * across, y)
    pen.beginPath()
    for (let at = 0; at + 1 < points.length; at += 2) pen.lineTo(points[at] * across, points[at + 1])
    if (kind !== 'line') { pen.closePath(); pen.fill() }
    if (kind === 'line' || kind === 'diamond') pen.stroke()
  }
}

class Drawing {
  // give: takes an event with its numbers.
  constructor(give, imageOf, listens) {
    const canvas = create('canvas'), at = { x: 0, y: 0, panned: 0, wheel: 0, ctrlKey: false, kind: 'move' }
    Object.assign(this, { canvas, give, imageOf, at, timer: 0, sentAt: 0 })
    new ResizeObserver(() => this.show(this.wanted, true)).observe(canvas)
    if (listens) this.listen()
  }
  show(wanted, isResized = false) {
    const { canvas } = this, across = canvas.clientWidth / wanted.width
    if (wanted.listens && (isResized || wanted.asks) && across > 0) this.give(`size\t${canvas.clientWidth} 0 0 0 0`)
    this.wanted = wanted
    canvas.style.height = wanted.height + 'px'
    if (across > 0) draw(canvas, wanted.shapes, across, this.imageOf)
  }
  listen() {
    const { canvas, at } = this, hear = (name, act) => canvas.addEventListener(name, event => event.isPrimary !== false && act(event), { passive: false })
    hear('pointerdown', event => {
      canvas.setPointerCapture(event.pointerId)
      this.follow(event)
      if (at.kind === 'drag') this.send('down')
    })
    hear('pointermove', event => this.follow(event))
    hear('lostpointercapture', () => at.kind === 'drag' && this.send('drag', 'up'))
    hear('pointerleave', () => this.send('leave'))
    hear('wheel', event => {
      event.preventDefault()
      at.wheel -= clamp(event.deltaY / 100, -1, 1)
      this.follow(event)
    })
  }
  // Moves are collected for a while. The middle button pans.
  follow({ offsetX, offsetY, buttons, ctrlKey }) {
    const { at, wanted, canvas } = this, x = offsetX * wanted.width / canvas.clientWidth
    if (buttons & 4) at.panned += x - at.x
    Object.assign(at, { x, y: offsetY, ctrlKey, kind: buttons & 1 ? 'drag' : 'move' })
    this.timer ||= setTimeout(() => this.send(at.kind), Math.max(0, this.sentAt + BETWEEN_INPUTS - performance.now()))
  }
  send(...kinds) {
    clearTimeout(this.timer)
    Object.assign(this, { timer: 0, sentAt: performance.now() })
    for (const kind of kinds) {
      const { x, y, panned, wheel, ctrlKey } = this.at
      this.give(`${kind}\t${[x, y, panned, wheel].map(number => number.toFixed(2)).join(' ')} ${ctrlKey ? 1 : 0}`)
      Object.assign(this.at, { panned: 0, wheel: 0 })
    }
  }
}
