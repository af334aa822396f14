// Mode, kernel, radii and filter. What is chosen is asked for at once, once a picture at most. Labels and ranges are those of
// SETTINGS, which the server fills in from their description (flow/setting.hpp).
const MODES = { 1: 'type1', 2: 'type2', 3: 'clay', 4: 'parts' }
const FINGERS = ['thumb', 'index', 'middle', 'ring', 'little']
const PATIENCE = 1000 // ms, for which what was asked for is shown before what is in force

// Radii to a micrometre: they have been in other units meanwhile.
const isSame = (a, b) => ['mode', 'kernel', 'injective', 'filtered', 'strength', 'volume', 'hold'].every(part => a[part] === b[part]) &&
  a.brushes.every((brush, at) => brush === b.brushes[at]) && a.radii.every((radius, at) => Math.abs(radius - b.radii[at]) < 1e-6)

class Shaping {
  constructor(ask) {
    Object.assign(this, { ask, live: false, wanted: null, due: false, askedAt: -Infinity })
    for (const part of document.querySelectorAll('[data-label]')) part.textContent = SETTINGS[part.dataset.label].label
    for (const range of document.querySelectorAll('[data-range]')) {
      const { min, max } = SETTINGS[range.dataset.range]
      Object.assign(range, { min, max })
    }
    element('brush').append(...BRUSHES.map(name => new Option(name)))
    this.sliders = FINGERS.map((finger, at) => this.makeSlider(finger, at))
    element('shaping').addEventListener('input', event => this.choose(event.target))
    element('shaping').addEventListener('submit', event => event.preventDefault())
  }
  makeSlider(finger, at) {
    const label = element('radii').appendChild(document.createElement('label'))
    const name = label.appendChild(document.createElement('span'))
    const range = label.appendChild(document.createElement('input'))
    const output = label.appendChild(document.createElement('output'))
    Object.assign(range, { type: 'range', min: 100 * SETTINGS.radius_m.min, max: 100 * SETTINGS.radius_m.max, step: 0.5, id: 'radius-' + finger })
    return { label, name, range, output, at }
  }

  // What is in force, whoever has asked for it.
  follow(settings) {
    const first = !this.wanted
    if (!first && (this.due || performance.now() - this.askedAt < PATIENCE) && !isSame(this.wanted, settings)) return
    this.wanted = { ...settings, radii: [...settings.radii], brushes: [...settings.brushes] }
    if (first) element('one-radius').checked = settings.radii.every(radius => radius === settings.radii[0])
    else if (settings.radii.some(radius => radius !== settings.radii[0])) element('one-radius').checked = false
    document.querySelector(`[name=mode][value="${settings.mode}"]`).checked = true
    element('kernel').value = settings.kernel
    this.showBrush()
    element('injective').checked = settings.injective
    element('filtered').checked = settings.filtered
    element('volume').value = settings.volume
    element('hold').checked = settings.hold === 'hand'
    this.sliders.forEach(({ range, at }) => { range.value = 100 * settings.radii[at] })
    this.show()
  }
  connected(yes) {
    this.live = yes
    element('settings').disabled = !yes
  }

  change() {
    this.due = true
    this.show()
  }
  send() {
    if (!this.due || !this.live) return
    const { mode, kernel, injective, filtered, radii, brushes, strength, volume, hold } = this.wanted
    this.ask(`settings ${MODES[mode]} ${kernel} ${injective ? 'injective' : 'free'} ${filtered ? 'one-euro' : 'off'} ${radii.join(' ')} ${brushes.join(' ')} ${strength} ${volume} ${hold}`)
    Object.assign(this, { due: false, askedAt: performance.now() })
  }
  // Sends what is due, and shows what is in force from then on: the server is about to change it.
  giveWay() {
    this.send()
    this.askedAt = -Infinity
  }
  choose(input) {
    const { wanted } = this
    if (!wanted) return
    const slider = this.sliders.find(({ range }) => range === input)
    const one = element('one-radius').checked
    if (input.name === 'mode') wanted.mode = Number(input.value)
    if (input.id === 'kernel') wanted.kernel = input.value
    if (input.id === 'brush' && input.value) {
      wanted.brushes.fill(input.value)
      this.useStrokes()
    }
    if (input.id === 'strength' || input.id === 'volume') wanted[input.id] = Number(input.value)
    if (input.id === 'hold') wanted.hold = input.checked ? 'hand' : 'tips'
    if (input.id === 'injective' || input.id === 'filtered') wanted[input.id] = input.checked
    if (slider) wanted.radii[slider.at] = Number(input.value) / 100
    if (one && (slider || input.id === 'one-radius')) wanted.radii.fill(wanted.radii[0])
    this.change()
  }
  // Brushes are of type 2.
  useStrokes() {
    this.wanted.mode = 2
    document.querySelector('[name=mode][value="2"]').checked = true
  }
  // Fingers that have several show none.
  showBrush() {
    const { brushes, strength } = this.wanted
    element('brush').value = brushes.every(brush => brush === brushes[0]) ? brushes[0] : ''
    element('strength').value = strength
  }
  show() {
    const { wanted } = this, one = element('one-radius').checked
    for (const { label, name, range, output, at } of this.sliders) {
      label.hidden = one && at > 0
      name.textContent = one ? SETTINGS.radius_m.label : FINGERS[at]
      if (Math.abs(range.value / 100 - wanted.radii[at]) > 0.003) range.value = 100 * wanted.radii[at]
      output.textContent = `${(100 * wanted.radii[at]).toFixed(1)} cm`
    }
  }
}
