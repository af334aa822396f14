// Hands and marks without a run, as the server has them (PROTOCOL.md, message 13), for Scene.
const LOOKS = { live: SKIN, ghost: GHOST, glass: SILENT }

function figuresOf({ hands, marks }, scene) {
  const many = [0, 0] // hands of each side
  return {
    hands: !scene.skins ? [] : hands.map(({ side, look, joints }) => {
      const slot = side === 'left' ? 0 : 1, skin = scene.skinOf(slot, many[slot]++)
      return { skin, bones: bonesFor(skin, joints), joints, look: LOOKS[look], isShade: look !== 'live' }
    }),
    marks: marks.map(({ from, to, radius, colour }) => ({ capsules: new Capsules().add(from, to, radius, radius), material: { ...BONE, colour } })),
  }
}

// The places of joints relative to their parents; those that fit the skin already, if they differ by what rounding does.
function bonesFor({ bones }, joints) {
  const read = joints.map(({ place, turn }, at) => {
    const parent = joints[PARENTS[at]]
    return { place: parent ? turned(inverse(parent.turn), minus(place, parent.place)) : place, turn }
  })
  return bones && read.every(({ place }, at) => size(minus(place, bones[at].place)) < 2e-4) ? bones : read
}
