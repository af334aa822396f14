// What only a new loop can change: mode, kernel and radii. What is chosen is asked for by Apply.
const LEAST_RADIUS = 0.01, MOST_RADIUS = 0.4
const FINGERS = ['thumb', 'index', 'middle', 'ring', 'little']

// Radii to a micrometre: they have been in other units meanwhile.
const isSame = (a, b) => a.mode === b.mode && a.kernel === b.kernel && a.radii.every((radius, at) => Math.abs(radius - b.radii[at]) < 1e-6)

class Shaping {
  constructor(ask) {
    Object.assign(this, { ask, live: false })
    this.sliders = FINGERS.map((finger, at) => this.makeSlider(finger, at))
    element('shaping').addEventListener('input', event => this.choose(event.target))
    element('shaping').addEventListener('submit', event => {
      event.preventDefault()
      this.apply()
    })
  }
  apply() {
    if (element('apply').disabled) return
    const { mode, kernel, radii } = this.asked = this.wanted
    this.ask(`settings type${mode} ${kernel} ${radii.join(' ')}`)
  }
  makeSlider(finger, at) {
    const label = element('radii').appendChild(document.createElement('label'))
    const name = label.appendChild(document.createElement('span'))
    const range = label.appendChild(document.createElement('input'))
    const output = label.appendChild(document.createElement('output'))
    Object.assign(range, { type: 'range', min: 100 * LEAST_RADIUS, max: 100 * MOST_RADIUS, step: 0.5, id: 'radius-' + finger })
    return { label, name, range, output, at }
  }

  // What is in force; what was chosen and not applied is forgotten. False: it is not what was asked for.
  setModel({ settings }) {
    const refused = this.asked && !isSame(this.asked, settings)
    this.inForce = settings
    this.wanted = { ...settings, radii: [...settings.radii] }
    this.asked = null
    element('one-radius').checked = settings.radii.every(radius => radius === settings.radii[0])
    document.querySelector(`[name=mode][value="${settings.mode}"]`).checked = true
    element('kernel').value = settings.kernel
    this.sliders.forEach(({ range, at }) => { range.value = 100 * settings.radii[at] })
    this.show()
    return !refused
  }
  connected(yes) {
    this.live = yes
    if (this.wanted) this.show()
  }

  choose(input) {
    const { wanted } = this
    const slider = this.sliders.find(({ range }) => range === input)
    const one = element('one-radius').checked
    if (input.name === 'mode') wanted.mode = Number(input.value)
    if (input.id === 'kernel') wanted.kernel = input.value
    if (slider) wanted.radii[slider.at] = Number(input.value) / 100
    if (one && (slider || input.id === 'one-radius')) wanted.radii.fill(wanted.radii[0])
    this.show()
  }
  otherMode() { document.querySelector('[name=mode]:not(:checked)').click() }
  nextKernel() {
    const select = element('kernel')
    select.selectedIndex = (select.selectedIndex + 1) % select.length
    this.choose(select)
  }
  scale(factor) {
    if (!this.wanted) return
    this.wanted.radii = this.wanted.radii.map(radius => Math.min(MOST_RADIUS, Math.max(LEAST_RADIUS, factor * radius)))
    this.show()
  }
  show() {
    const { wanted, inForce } = this, one = element('one-radius').checked
    for (const { label, name, range, output, at } of this.sliders) {
      label.hidden = one && at > 0
      name.textContent = one ? 'radius' : FINGERS[at]
      if (Math.abs(range.value / 100 - wanted.radii[at]) > 0.003) range.value = 100 * wanted.radii[at]
      output.textContent = `${(100 * wanted.radii[at]).toFixed(1)} cm`
    }
    const same = isSame(wanted, inForce)
    element('apply').disabled = same || !this.live
    element('apply-note').textContent = same ? 'As in force.' : 'Restarts the loop from this shape; undo begins anew.'
  }
}
