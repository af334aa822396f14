// Hands without a run, as the server has them (PROTOCOL.md, message 13).
const LOOKS = { live: SKIN, ghost: GHOST, glass: SILENT }

class Figures {
  constructor(scene) { Object.assign(this, { scene, skins: new Map(), hands: [], marks: [] }) }
  take({ hands, marks }) {
    const many = new Map()
    this.marks = marks
    this.hands = hands.map(({ side, look, joints }) => {
      const number = many.get(side) || 0, bones = bonesIn(joints)
      many.set(side, number + 1)
      return { skin: this.skinOf(side, number), bones, joints, look: LOOKS[look], isShade: look !== 'live' }
    }).filter(({ skin }) => skin)
    for (const hand of this.hands) hand.bones = this.sameBones(hand)
  }
  skinOf(side, number) {
    const { scene, skins } = this, name = side + number
    if (!skins.has(name) && scene.readSkin) skins.set(name, new Skin(scene.gl, scene.readSkin, side === 'left' ? -1 : 1))
    return skins.get(name)
  }
  // Those that fit the skin already, if they differ by what rounding does.
  sameBones({ skin, bones }) {
    return skin.bones && bones.every(({ place }, at) => size(minus(place, skin.bones[at].place)) < 2e-4) ? skin.bones : bones
  }
}

// The places of joints relative to their parents.
const bonesIn = joints => joints.map(({ place, turn }, at) => {
  const parent = joints[PARENTS[at]]
  return { place: parent ? turned(inverse(parent.turn), minus(place, parent.place)) : place, turn }
})
