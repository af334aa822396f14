// Settings. What is chosen is asked for at once, once a picture at most. All controls are made of SETTINGS,
// which the server fills in from their description (flow/setting.hpp).
const FINGERS = ['thumb', 'index', 'middle', 'ring', 'little']
const PATIENCE = 1000 // ms, for which what was asked for is shown before the current settings
const LARGEST = 20 // larger numbers have no use
const choicesOf = ({ choices }) => choices.split(/, | or /)
const sameForAll = values => values.every(value => value === values[0])

class Shaping {
  constructor(ask) {
    Object.assign(this, { ask, live: false, inForce: null, shown: null, wanted: null, due: new Set(), askedAt: -Infinity, controls: [] })
    this.modes = SETTINGS.mode.labels.map((label, at) => {
      const button = make('button', element('modes'), { textContent: label, role: 'radio', value: choicesOf(SETTINGS.mode)[at] })
      button.setAttribute('aria-description', this.helpOf(SETTINGS.mode))
      button.addEventListener('click', () => this.wanted && this.change('mode', button.value))
      return button
    })
    for (const [name, setting] of Object.entries(SETTINGS))
      if (setting.isOfFingers) this.addFingers(name, setting)
      else if (name !== 'mode') this.add(name, setting)
  }
  helpOf({ help, command }) { return command ? helpOf({ ...commandNamed(command), help }) : help }
  line(words, { help, command }, isBox) {
    const line = make('label', element('tool'), { className: isBox ? 'box' : 'field' })
    line.setAttribute('aria-description', this.helpOf({ help, command }))
    return { line, words: make('span', line, { textContent: words }) }
  }
  addFingers(name, setting) {
    FINGERS.forEach((_, finger) => this.add(name, setting, finger))
    const { line } = this.line(`one ${setting.label} for all fingers`, setting, true)
    const one = make('input', line, { type: 'checkbox', id: 'one-' + name, checked: true })
    const control = { name, setting, line, one }
    one.addEventListener('change', () => this.wanted && this.choose(this.controls.find(other => other.name === name), this.wanted[name][0]))
    this.controls.push(control)
  }
  // Of a setting, or of a finger's share of it. A switch or one of two choices is a box; numbers have a slider and a field.
  add(name, setting, finger = null) {
    const choices = setting.choices ? choicesOf(setting) : [], isBox = choices.length === 2
    const { line, words } = this.line(setting.label, setting, isBox)
    const control = { name, setting, finger, line, words, inputs: [], scale: setting.unit === 'm' ? 100 : 1, choices, isBox }
    const addInput = (kind, values, read) => {
      const input = make(kind, line, values)
      input.addEventListener('input', () => this.wanted && this.choose(control, read(input)))
      control.inputs.push(input)
      return input
    }
    const id = finger === null ? name : `${name}-${FINGERS[finger]}`
    if (isBox) addInput('input', { type: 'checkbox', id }, input => choices[input.checked ? 1 : 0])
    else if (choices.length > 0) addInput('select', { id }, ({ value }) => value).append(...choices.map(choice => new Option(choice)))
    else this.addNumber(control, addInput, id)
    this.controls.push(control)
  }
  addNumber(control, addInput, id) {
    const { setting: { min, max, label }, scale, line } = control, most = Math.min(max, LARGEST) * scale
    const limits = { min: min * scale, max: most, step: scale > 1 ? 0.1 : 0.01 }
    const read = ({ value }) => Math.min(most, Math.max(limits.min, Number(value))) / scale
    addInput('input', { ...limits, type: 'range', id }, read)
    addInput('input', { ...limits, type: 'number', ariaLabel: label }, read)
    make('span', line, { className: 'unit', textContent: scale > 1 ? 'cm' : '' })
    line.addEventListener('wheel', event => {
      if (!event.ctrlKey || !this.wanted) return
      event.preventDefault()
      const value = Number(control.inputs[0].value) - Math.sign(event.deltaY) * (most - limits.min) / 50
      this.choose(control, read({ value }))
    }, { passive: false })
  }
  isOne(name) { return element('one-' + name).checked }

  // Shows the current settings, from any client, after the requests of this page have had time to take effect.
  follow(inForce = this.inForce) {
    this.inForce = inForce
    const waits = this.due.size > 0 || performance.now() - this.askedAt < PATIENCE
    if (waits || inForce === this.shown) return
    for (const { name, one } of this.controls)
      if (one && (!this.wanted || !sameForAll(inForce[name]))) one.checked = sameForAll(inForce[name])
    this.shown = inForce
    this.wanted = { ...inForce, radius_m: [...inForce.radius_m], brushes: [...inForce.brushes] }
    this.show()
  }
  connected(yes) { this.live = yes }

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
  choose({ name, setting, finger }, value) {
    if (!setting.isOfFingers) return this.change(name, value)
    this.change(name, this.wanted[name].map((before, at) => this.isOne(name) || at === finger ? value : before))
  }
  // What works in the mode, and with the other settings.
  works({ modes, needs }) {
    const { wanted } = this
    return modes.includes(wanted.mode) && (!needs || [wanted[needs]].flat().some(value => value !== choicesOf(SETTINGS[needs])[0]))
  }
  show() {
    for (const button of this.modes) button.setAttribute('aria-checked', button.value === this.wanted.mode)
    for (const control of this.controls) {
      const { name, setting, finger, line, one } = control
      line.hidden = !this.works(setting) || (finger > 0 && this.isOne(name))
      if (!one) this.showValue(control)
    }
  }
  showValue({ name, setting, finger, words, inputs, scale, choices, isBox }) {
    const isOfFinger = finger !== null
    if (isOfFinger) words.textContent = this.isOne(name) ? setting.label : FINGERS[finger]
    const value = isOfFinger ? this.wanted[name][finger] : this.wanted[name]
    if (isBox) inputs[0].checked = value === choices[1]
    else if (choices.length > 0) inputs[0].value = value
    else for (const input of inputs) if (input !== document.activeElement || input.type === 'range') input.value = (scale * value).toFixed(scale > 1 ? 1 : 2)
  }
}
