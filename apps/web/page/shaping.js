// Settings. What is chosen is asked for at once, once a picture at most. Names, labels, ranges and brushes are those of SETTINGS,
// which the server fills in from their description (flow/setting.hpp). An input has the name of its setting, and its value; a
// checkbox has the value of the setting when it is checked, and in data-off the value when it is not.
const FINGERS = ['thumb', 'index', 'middle', 'ring', 'little']
const PATIENCE = 1000 // ms, for which what was asked for is shown before the current settings

class Shaping {
  constructor(ask) {
    Object.assign(this, { ask, live: false, inForce: null, shown: null, wanted: null, due: new Set(), askedAt: -Infinity })
    this.inputs = element('shaping').elements
    for (const part of document.querySelectorAll('[data-label]')) part.textContent = SETTINGS[part.dataset.label].label
    for (const radio of this.inputs.mode) radio.nextElementSibling.textContent = SETTINGS.mode.choices[radio.value]
    for (const name of ['brush_strength', 'keep_volume']) {
      const { min, max } = SETTINGS[name]
      Object.assign(this.inputs[name], { min, max })
    }
    this.inputs.brushes.append(...SETTINGS.brushes.choices.map(name => new Option(name)))
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

  // Shows the current settings, from any client, after the requests of this page have had time to take effect.
  follow(inForce = this.inForce) {
    this.inForce = inForce
    const waits = this.due.size > 0 || performance.now() - this.askedAt < PATIENCE
    if (waits || inForce === this.shown) return
    const radii = [...inForce.radius_m], isOne = radii.every(radius => radius === radii[0])
    if (!this.wanted || !isOne) element('one-radius').checked = isOne
    this.shown = inForce
    this.wanted = { ...inForce, radius_m: radii }
    for (const [name, value] of Object.entries(inForce)) this.showValue(this.inputs[name], value)
    this.sliders.forEach(({ range, at }) => { range.value = 100 * radii[at] })
    this.show()
  }
  // Some settings have no input. Brushes that differ are no choice of theirs, so that none is shown.
  showValue(input, value) {
    if (!input) return
    if (input.type === 'checkbox') input.checked = value === input.value
    else input.value = value
  }
  connected(yes) {
    this.live = yes
    element('settings').disabled = !yes
  }

  change(name, value) {
    this.wanted[name] = value
    this.due.add(name)
    this.shown = null // so that the current settings come back if this is refused
    this.show()
  }
  send() {
    if (this.due.size === 0 || !this.live) return
    this.ask(`settings ${[...this.due].map(name => `${name}=${this.wanted[name]}`).join(' ')}`)
    this.due.clear()
    this.askedAt = performance.now()
  }
  // Sends the requests that are due, and shows the next settings: the server is about to change them.
  giveWay() {
    this.send()
    Object.assign(this, { askedAt: -Infinity, shown: this.inForce })
  }
  choose(input) {
    if (!this.wanted) return
    const slider = this.sliders.find(({ range }) => range === input)
    if (!slider && input.id !== 'one-radius') return this.chooseNamed(input)
    const radii = this.wanted.radius_m
    if (slider) radii[slider.at] = Number(input.value) / 100
    if (element('one-radius').checked) radii.fill(radii[0])
    this.change('radius_m', radii)
  }
  chooseNamed(input) {
    const value = input.type === 'checkbox' && !input.checked ? input.dataset.off : input.value
    this.change(input.name, value)
  }
  // What works in the mode.
  showTools(mode) {
    for (const [name, { modes }] of Object.entries(SETTINGS)) {
      const input = this.inputs[name]
      const parts = [...document.querySelectorAll(`[data-of=${name}]`), ...(input?.closest ? [input.closest('label')] : [])]
      for (const part of parts) part.hidden = !modes.includes(mode)
    }
  }
  show() {
    const { wanted } = this, one = element('one-radius').checked
    this.showTools(wanted.mode)
    for (const { label, name, range, output, at } of this.sliders) {
      const radius = wanted.radius_m[at]
      label.hidden = one && at > 0
      name.textContent = one ? SETTINGS.radius_m.label : FINGERS[at]
      if (Math.abs(range.value / 100 - radius) > 0.003) range.value = 100 * radius
      output.textContent = `${(100 * radius).toFixed(1)} cm`
    }
  }
}
