// Strip charts: the last values in milliseconds, and a line of words.
const FONT = '11px Inter, "DejaVu Sans", system-ui, sans-serif'
const colour = name => getComputedStyle(document.body).getPropertyValue(name)
// Of a canvas that is as fine as the screen.
function penOf(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight
  Object.assign(canvas, { width: width * ratio, height: height * ratio })
  const pen = canvas.getContext('2d')
  pen.scale(ratio, ratio)
  return { pen, width, height }
}
const brief = number => number < 100 ? number.toPrecision(3) : String(Math.round(number))

class Chart {
  constructor(name, length = 240) {
    const canvas = make('canvas', element('timing').parentNode, { className: 'chart' })
    Object.assign(this, { canvas, name, values: new Float32Array(length), at: 0 })
  }
  add(value) {
    this.values[this.at] = Number.isFinite(value) ? value : 0
    this.at = (this.at + 1) % this.values.length
  }
  draw() {
    const { values } = this
    if (this.canvas.clientWidth === 0) return
    const { pen, width, height } = penOf(this.canvas)
    const most = Math.max(...values), last = values[(this.at + values.length - 1) % values.length]
    pen.beginPath()
    values.forEach((_, n) => {
      const value = values[(this.at + n) % values.length]
      pen.lineTo(n / (values.length - 1) * width, height - 1 - (height - 17) * value / Math.max(most, 1e-9))
    })
    pen.strokeStyle = colour('--accent')
    pen.lineWidth = 1.2
    pen.stroke()
    pen.fillStyle = colour('--soft')
    pen.font = FONT
    pen.fillText(this.name, 4, 12)
    const words = `${brief(last)}, most ${brief(most)} ms`
    pen.fillText(words, width - 4 - pen.measureText(words).width, 12)
  }
}

// How far each of a hand's joints is bent, three a finger, thumb to little finger.
const CHAINS = [[1, 2, 3, 4], [6, 7, 8, 9], [11, 12, 13, 14], [16, 17, 18, 19], [21, 22, 23, 24]]
function bendsOf(hand) {
  return CHAINS.flatMap(chain => [0, 1, 2].map(at => {
    const [a, b] = [hand.joints[chain[at]].turn, hand.joints[chain[at + 1]].turn]
    const cosine = Math.abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3])
    return 2 * Math.acos(Math.min(1, cosine)) * 180 / Math.PI
  }))
}
function drawBends(canvas, hand) {
  if (canvas.clientWidth === 0) return
  const { pen, width, height } = penOf(canvas), step = width / 17
  bendsOf(hand).forEach((bend, joint) => {
    const x = (joint + Math.floor(joint / 3) * 0.5) * step, long = Math.min(1, bend / 110) * (height - 17) // below its title
    pen.fillStyle = colour('--chart')
    pen.fillRect(x, height - long, step * 0.8, long)
  })
  pen.fillStyle = colour('--soft')
  pen.font = FONT
  pen.fillText('thumb to little, degrees', 4, 12)
}
