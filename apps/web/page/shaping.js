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
  addFingers(name, setting) {
    FINGERS.forEach((_, finger) => this.add(name, setting, finger))
    const show = () => this.wanted && this.choose(this.controls.find(other => other.name === name), this.wanted[name][0])
    const one = this.append('check', show, setting, 'one-' + name)
    one.show({ name: `one ${setting.label} for all fingers`, value: true })
    this.controls.push({ name, setting, line: one.control, one: element('one-' + name) })
  }
  append(kind, give, { help, command, ...values }, id) {
    const made = Form.prototype[kind](give, values)
    made.control.setAttribute('aria-description', this.helpOf({ help, command }))
    made.control.children[1].id = id
    element('tool').append(made.control)
    return made
  }
  // Of a setting, or of a finger's share of it. A switch or one of two choices is a box.
  add(name, setting, finger = null) {
    const choices = setting.choices ? choicesOf(setting) : [], isBox = choices.length === 2, scale = setting.unit === 'm' ? 100 : 1
    const kind = isBox ? 'check' : choices.length > 0 ? 'choice' : 'number'
    const control = { name, setting, finger, scale, choices, isBox }
    const read = value => isBox ? choices[value ? 1 : 0] : choices.length > 0 ? value : value / scale
    const values = { ...setting, choices, min: setting.min * scale, max: Math.min(setting.max, LARGEST) * scale, step: scale > 1 ? 0.1 : 0.01, unit: scale > 1 ? 'cm' : '' }
    const made = this.append(kind, value => this.wanted && this.choose(control, read(value)), values, finger === null ? name : `${name}-${FINGERS[finger]}`)
    this.controls.push(Object.assign(control, { line: made.control, set: made.show }))
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
  showValue({ name, setting: { label }, finger, set, scale, choices, isBox }) {
    const isOfFinger = finger !== null, value = isOfFinger ? this.wanted[name][finger] : this.wanted[name]
    const shown = isBox ? value === choices[1] : choices.length > 0 ? value : (scale * value).toFixed(scale > 1 ? 1 : 2)
    set({ name: isOfFinger && !this.isOne(name) ? FINGERS[finger] : label, value: shown, choices })
  }
}
