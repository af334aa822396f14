// Strip charts: the last so many values, and a line of words.
const brief = number => number < 100 ? number.toPrecision(3) : String(Math.round(number))

class Chart {
  constructor(canvas, name, unit, length = 240) {
    Object.assign(this, { canvas, name, unit, values: new Float32Array(length), at: 0 })
  }
  add(value) {
    this.values[this.at] = Number.isFinite(value) ? value : 0
    this.at = (this.at + 1) % this.values.length
  }
  draw() {
    const ratio = window.devicePixelRatio || 1
    const { canvas, values } = this, width = canvas.clientWidth, height = canvas.clientHeight
    if (width === 0) return
    Object.assign(canvas, { width: width * ratio, height: height * ratio })
    const pen = canvas.getContext('2d')
    pen.scale(ratio, ratio)
    const most = Math.max(...values), last = values[(this.at + values.length - 1) % values.length]
    pen.beginPath()
    values.forEach((_, n) => {
      const value = values[(this.at + n) % values.length]
      pen.lineTo(n / (values.length - 1) * width, height - 1 - (height - 17) * value / Math.max(most, 1e-9))
    })
    pen.strokeStyle = '#b4532a'
    pen.lineWidth = 1.2
    pen.stroke()
    pen.fillStyle = '#5c656d'
    pen.font = '11px system-ui, "DejaVu Sans", sans-serif'
    pen.fillText(this.name, 4, 12)
    const words = `${brief(last)}, most ${brief(most)} ${this.unit}`
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
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight
  Object.assign(canvas, { width: width * ratio, height: height * ratio })
  const pen = canvas.getContext('2d')
  pen.scale(ratio, ratio)
  const step = width / 17
  bendsOf(hand).forEach((bend, joint) => {
    const x = (joint + Math.floor(joint / 3) * 0.5) * step, long = Math.min(1, bend / 110) * (height - 2)
    pen.fillStyle = 'rgba(0, 0, 0, 0.06)'
    pen.fillRect(x, 0, step * 0.8, height)
    pen.fillStyle = '#34567a'
    pen.fillRect(x, height - long, step * 0.8, long)
  })
}
