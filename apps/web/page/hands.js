// The hands as capsules: flesh, bones, control vectors. Joints are OpenXR's, by number.
// Base, end, and the flesh about them in metres: a hand's of average size.
const FLESH = [
  [2, 3, 0.0150, 0.0125], [6, 7, 0.0135, 0.0110], [11, 12, 0.0140, 0.0110], [16, 17, 0.0140, 0.0105], [21, 22, 0.0135, 0.0100],
  [1, 2, 0.0170, 0.0150], [1, 6, 0.0170, 0.0135], [1, 11, 0.0170, 0.0140], [1, 16, 0.0170, 0.0140], [1, 21, 0.0170, 0.0135],
  [7, 12, 0.0110, 0.0110], [12, 17, 0.0110, 0.0105], [17, 22, 0.0105, 0.0100],
  [3, 4, 0.0115, 0.0105], [4, 5, 0.0105, 0.0080],
  [7, 8, 0.0102, 0.0088], [8, 9, 0.0088, 0.0078], [9, 10, 0.0078, 0.0064],
  [12, 13, 0.0102, 0.0090], [13, 14, 0.0090, 0.0080], [14, 15, 0.0080, 0.0066],
  [17, 18, 0.0098, 0.0085], [18, 19, 0.0085, 0.0075], [19, 20, 0.0075, 0.0062],
  [22, 23, 0.0088, 0.0075], [23, 24, 0.0075, 0.0067], [24, 25, 0.0067, 0.0055],
]
const FOREARM = 0.05

// Eight numbers a capsule: from and its radius, to and its radius.
class Capsules {
  constructor() { this.numbers = [] }
  add(from, to, fromRadius, toRadius) { this.numbers.push(...from, fromRadius, ...to, toRadius) }
  get count() { return this.numbers.length / 8 }
}

function fleshOf(hand, capsules) {
  const place = joint => hand.joints[joint].place
  for (const [base, end, r0, r1] of FLESH) {
    let to = place(end)
    if (TIPS.includes(end)) { // where the finger's flesh ends
      const way = minus(to, place(base)), length = size(way)
      if (length > r1) to = add(place(base), times(way, (length - r1) / length))
    }
    capsules.add(place(base), to, r0, r1)
  }
  for (const side of [-0.011, 0.011]) // the forearm's two bones
    capsules.add(add(place(1), turned(hand.joints[1].turn, [side, 0, 0])),
      add(place(1), turned(hand.joints[1].turn, [side, 0, FOREARM])), 0.0165, 0.0175)
}

function bonesOf(hand, capsules) {
  PARENTS.forEach((parent, joint) => {
    if (joint === 0) return
    const place = hand.joints[joint].place
    if (!TIPS.includes(joint)) capsules.add(place, place, 0.0040, 0.0040)
    if (parent >= 0) capsules.add(hand.joints[parent].place, place, 0.0024, 0.0024)
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
    const before = this.before
    const begins = update.held &&
      (!before || !before.held || update.restChanges !== before.restChanges || update.jumps !== before.jumps)
    if (begins) this.starts = update.hands.map(hand => hand && TIPS.map(tip => hand.joints[tip].place))
    this.before = update
  }
}
