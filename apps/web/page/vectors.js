// Places and turns: arrays of three numbers, and quaternions x, y, z, w.
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s]
const dot = (a, b) => a.reduce((sum, part, axis) => sum + part * b[axis], 0)
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
const size = a => Math.hypot(...a)
const clamp = (number, low, high) => Math.min(high, Math.max(low, number))

function turned([x, y, z, w], v) {
  const twice = times(cross([x, y, z], v), 2)
  return add(add(v, times(twice, w)), cross([x, y, z], twice))
}

function product([ax, ay, az, aw], [bx, by, bz, bw]) {
  return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]
}
// By an angle in radians about an axis of length 1.
const turnAbout = (axis, angle) => [...times(axis, Math.sin(angle / 2)), Math.cos(angle / 2)]
const unit = all => all.map(part => part / size(all))
