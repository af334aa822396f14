// What is drawn as capsules: bones, control vectors. Joints are OpenXR's, by number.
// Eight numbers a capsule: from and its radius, to and its radius.
class Capsules {
  constructor() { this.numbers = [] }
  add(from, to, fromRadius, toRadius) { this.numbers.push(...from, fromRadius, ...to, toRadius); return this }
  get count() { return this.numbers.length / 8 }
}

function bonesOf(hand, capsules) {
  PARENTS.forEach((parent, joint) => {
    if (joint === 0) return
    const place = hand.joints[joint].place
    const isTip = TIPS.includes(joint) // its place is on the skin, and the last bone ends within
    if (!isTip) capsules.add(place, place, 0.0040, 0.0040)
    if (parent < 0) return
    const base = hand.joints[parent].place, way = minus(base, place), length = size(way)
    const inFlesh = isTip && length > 0 ? Math.min(0.005 / length, 0.5) : 0
    capsules.add(base, add(place, times(way, inFlesh)), 0.0024, 0.0024)
  })
}

function arrow(from, to, width, capsules) {
  const way = minus(to, from), length = size(way)
  if (length < width) return
  const neck = add(from, times(way, Math.max(0, 1 - 3 * width / length)))
  capsules.add(from, neck, width / 3, width / 3)
  capsules.add(neck, to, width, width / 20)
}

// Where the fingertips grabbed: frames do not say, but when a hold begins.
class Holds {
  constructor() { this.begin() }
  // Of another loop.
  begin() { Object.assign(this, { starts: [null, null], before: null }) }
  follow(update) {
    const { before } = this, isNew = !before?.held || update.restChanges !== before.restChanges || update.jumps !== before.jumps
    if (update.held && isNew) this.starts = update.hands.map(hand => hand && TIPS.map(tip => hand.joints[tip].place))
    this.before = update
  }
}
