// Charts of the page's measurements, as shapes of a drawing.
const brief = number => number < 100 ? number.toPrecision(3) : String(Math.round(number))
const HEAD = 17 // pixels, of the words above a chart
const headOf = words => ['words', 'soft', 4, 8, words]

// The last values in milliseconds.
class Strip {
  constructor(name, length = 240) { Object.assign(this, { name, values: new Float32Array(length), at: 0 }) }
  add(value) {
    this.values[this.at] = Number.isFinite(value) ? value : 0
    this.at = (this.at + 1) % this.values.length
  }
  shapes(width, height) {
    const values = [...this.values.slice(this.at), ...this.values.slice(0, this.at)], most = Math.max(...values)
    const places = values.flatMap((value, n) => [n / (values.length - 1) * width, height - 1 - (height - HEAD) * value / Math.max(most, 1e-9)])
    return [headOf(`${this.name} ${brief(values.at(-1))}, at most ${brief(most)} ms`), ['line', 'accent', ...places]]
  }
}

// How far each of a hand's joints is bent, three a finger, thumb to little finger.
const bendsOf = ({ joints }) => TIPS.flatMap(tip => [tip - 3, tip - 2, tip - 1]).map(at => {
  const cosine = Math.abs(dot(joints[at].turn, joints[PARENTS[at]].turn))
  return 2 * Math.acos(Math.min(1, cosine)) * 180 / Math.PI
})
class Bends {
  constructor(slot) { this.slot = slot }
  shapes(width, height, hands) {
    const bars = !hands[this.slot] ? [] : bendsOf(hands[this.slot]).map((bend, joint) => {
      const left = (joint + Math.floor(joint / 3) * 0.5) * width / 17, right = left + width / 21
      const top = height - Math.min(1, bend / 110) * (height - HEAD)
      return ['area', 'chart', left, top, right, top, right, height, left, height]
    })
    return [headOf('thumb to little, degrees'), ...bars]
  }
}
const CHARTS = { late: new Strip('late'), uneven: new Strip('uneven'), picture: new Strip('picture'), left: new Bends(0), right: new Bends(1) }
