// Charts, each of which draws itself into a canvas of the form.
const FONT = '11px Inter, "DejaVu Sans", system-ui, sans-serif'
const colour = name => getComputedStyle(document.body).getPropertyValue(name)
// Of a canvas that is as fine as the screen, with words above the chart at the left and at the right.
function penOf(canvas, left, right = '') {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight
  Object.assign(canvas, { width: width * ratio, height: height * ratio })
  const pen = canvas.getContext('2d')
  pen.scale(ratio, ratio)
  Object.assign(pen, { fillStyle: colour('--soft'), font: FONT })
  pen.fillText(left, 4, 12)
  pen.fillText(right, width - 4 - pen.measureText(right).width, 12)
  return { pen, width, height, long: height - 17 }
}
const brief = number => number < 100 ? number.toPrecision(3) : String(Math.round(number))

// The last values in milliseconds.
class Strip {
  constructor(name, length = 240) { Object.assign(this, { name, values: new Float32Array(length), at: 0 }) }
  add(value) {
    this.values[this.at] = Number.isFinite(value) ? value : 0
    this.at = (this.at + 1) % this.values.length
  }
  draw(canvas) {
    const { name, at, values } = this, { length } = values, most = Math.max(...values), last = values[(at + length - 1) % length]
    const { pen, width, height, long } = penOf(canvas, name, `${brief(last)}, most ${brief(most)} ms`)
    pen.beginPath()
    values.forEach((_, n) => pen.lineTo(n / (length - 1) * width, height - 1 - long * values[(at + n) % length] / Math.max(most, 1e-9)))
    Object.assign(pen, { strokeStyle: colour('--accent'), lineWidth: 1.2 })
    pen.stroke()
  }
}

// How far each of a hand's joints is bent, three a finger, thumb to little finger.
const CHAINS = [[1, 2, 3, 4], [6, 7, 8, 9], [11, 12, 13, 14], [16, 17, 18, 19], [21, 22, 23, 24]]
function bendsOf(hand) {
  return CHAINS.flatMap(chain => [0, 1, 2].map(at => {
    const cosine = Math.abs(dot(hand.joints[chain[at]].turn, hand.joints[chain[at + 1]].turn))
    return 2 * Math.acos(Math.min(1, cosine)) * 180 / Math.PI
  }))
}
class Bends {
  constructor(slot) { this.slot = slot }
  draw(canvas, hands) {
    if (!hands[this.slot]) return
    const { pen, width, height, long } = penOf(canvas, 'thumb to little, degrees'), step = width / 17
    pen.fillStyle = colour('--chart')
    bendsOf(hands[this.slot]).forEach((bend, joint) => {
      const x = (joint + Math.floor(joint / 3) * 0.5) * step, high = Math.min(1, bend / 110) * long
      pen.fillRect(x, height - high, step * 0.8, high)
    })
  }
}
const CHARTS = { late: new Strip('late'), uneven: new Strip('uneven'), picture: new Strip('picture'), left: new Bends(0), right: new Bends(1) }
