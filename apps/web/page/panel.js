// The panel: buttons, keys, figures.
// As in Blender: where one looks from, and where from with Ctrl.
const RIGHT_ANGLE = Math.PI / 2
const VIEWS = {
  1: { plain: [0, 0], ctrl: [Math.PI, 0] },
  3: { plain: [RIGHT_ANGLE, 0], ctrl: [-RIGHT_ANGLE, 0] },
  7: { plain: [0, RIGHT_ANGLE], ctrl: [0, -RIGHT_ANGLE] },
}
// What the page does by itself, of COMMANDS, which the server fills in from its table (apps/commands).
const OWN = {
  'show hands': panel => panel.toggle('skin'),
  'show bones': panel => panel.toggle('bones'),
  'show vectors': panel => panel.toggle('vectors'),
  'show radii': panel => panel.toggle('radii'),
  'show contact': panel => panel.toggle('contacts'),
  'show facets': panel => panel.toggle('facets'),
  'view front': panel => panel.camera.look(...VIEWS[1].plain),
  'view right': panel => panel.camera.look(...VIEWS[3].plain),
  'view top': panel => panel.camera.look(...VIEWS[7].plain),
  'frame all': panel => panel.camera.frame(),
  'fold panel': panel => panel.fold(),
  'list keys': panel => panel.help(),
}
const MAX_UNDOABLE = 48 // that the server lists
const helpOf = ({ help, keys }, refusal) => `${help}${refusal ? '\n' + refusal : ''} (${keys.join(', ')})`
const element = id => document.getElementById(id)

class Panel {
  constructor(ask, shown) {
    Object.assign(this, { ask, camera: null, live: false, settings: null, history: null, puppet: null, states: new Map() })
    this.late = new Chart(element('chart-late'), 'late', 'ms')
    this.rate = new Chart(element('chart-rate'), 'ticks per second', 'Hz')
    this.bytes = new Chart(element('chart-bytes'), 'a message', 'bytes')
    this.shaping = new Shaping(this.ask)
    this.buttons = new Map(COMMANDS.filter(({ button }) => button).map(command => [command, this.makeButton(command)]))
    for (const part of ['skin', 'bones', 'vectors', 'radii', 'contacts', 'facets'])
      element('show-' + part).addEventListener('change', event => shown(part, event.target.checked))
    element('help-button').addEventListener('click', () => this.help())
    element('fold-button').addEventListener('click', () => this.fold())
    for (const part of document.querySelectorAll('[data-help]'))
      part.title = helpOf(COMMANDS.find(({ name }) => name === part.dataset.help))
    for (const { keys, help } of COMMANDS) {
      const row = element('keys').insertRow()
      row.insertCell().appendChild(document.createElement('kbd')).textContent = keys.join(', ')
      row.insertCell().textContent = help
    }
    document.addEventListener('keydown', event => this.press(event))
    this.connected(false)
  }

  makeButton(command) {
    const button = element('buttons').appendChild(document.createElement('button'))
    button.dataset.request = command.name
    button.addEventListener('click', () => this.give(command))
    return button
  }
  // The server says in advance which commands are on, and why some are not possible.
  stateOf(name) { return this.states.get(name) || { isOn: false, refusal: '' } }
  give(command) {
    if (!command.isForRun) return OWN[command.name](this)
    const { refusal } = this.stateOf(command.name)
    if (refusal) return this.report(refusal)
    if (command.isSetting) this.shaping.giveWay()
    this.ask(command.name)
  }
  press(event) {
    if (event.altKey || event.metaKey) return
    if (event.target.matches('select')) return // which has keys of its own
    if (event.ctrlKey) return this.pressWithCtrl(event)
    if (event.repeat) return
    if (event.key === 'Home' && event.target.matches('input[type=range]')) return
    const command = COMMANDS.find(({ keys }) => keys.includes(event.key))
    if (command) this.give(command)
  }
  pressWithCtrl(event) {
    const key = event.key.toUpperCase(), view = VIEWS[key]
    const command = COMMANDS.find(({ keys }) => keys.includes(`Ctrl ${event.shiftKey ? 'Shift ' : ''}${key}`))
    if (!command && !view) return
    event.preventDefault()
    if (view) this.camera.look(...view.ctrl)
    else this.give(command)
  }
  setStates(states) {
    this.states = states
    this.showStates()
  }
  showStates() {
    for (const [command, button] of this.buttons) {
      const { isOn, refusal } = this.stateOf(command.name)
      button.disabled = !this.live || refusal !== ''
      button.title = helpOf(command, refusal)
      button.textContent = isOn ? command.buttonOn : command.button
      button.classList.toggle('on', isOn)
    }
  }
  fold() {
    const folded = element('panel').classList.toggle('folded')
    element('fold-button').textContent = folded ? '+' : '\u2212'
    this.camera.changed()
  }
  // What the panel covers of the page's width, as far as it counts.
  covered() {
    const panel = element('panel')
    return panel.classList.contains('folded') ? 0 : Math.min(0.4, panel.getBoundingClientRect().right / innerWidth)
  }
  toggle(part, kind = 'show-') { element(kind + part).click() }
  help() {
    const dialog = element('help')
    if (dialog.open) dialog.close()
    else dialog.showModal()
  }

  report(words) { element('message').textContent = words }
  say(words) {
    element('banner').textContent = words
    element('banner').hidden = words === ''
  }
  connected(yes) {
    this.live = yes
    this.showStates()
    this.shaping.connected(yes)
  }
  setModel(model) {
    this.model = model
    element('model').textContent = model.name
    document.title = `${model.name} - Nendo`
  }
  // A line a step, and one for the beginning. A click on one goes there.
  setHistory(history) {
    this.history = history
    const words = history.steps.map(({ kind, at }) => `${Math.floor(at / 60)}:${String(Math.floor(at % 60)).padStart(2, '0')}  ${kind}`)
    const lines = [history.undoable < MAX_UNDOABLE ? 'the beginning' : 'earlier', ...words].map((text, at) => {
      const line = document.createElement('button')
      line.textContent = text
      line.className = at > history.undoable ? 'undone' : ''
      line.setAttribute('aria-current', at === history.undoable ? 'step' : 'false')
      line.addEventListener('click', () => this.goTo(at))
      return line
    })
    element('history').replaceChildren(...lines)
    lines[history.undoable].scrollIntoView({ block: 'nearest' })
  }
  goTo(at) {
    const { undoable } = this.history
    for (let step = undoable + (this.update && this.update.inHand ? 1 : 0); step > at; --step) this.ask('undo')
    for (let step = undoable; step < at; ++step) this.ask('redo')
  }
  // What each function listens to; an edited puppet replaces the previous one.
  setPuppet(puppet) {
    this.puppet = puppet
    element('puppet').hidden = puppet.functions.length === 0
    element('functions').replaceChildren(...puppet.functions.map(({ name, signal }) => {
      const line = document.createElement('div')
      line.textContent = `${name}: ${signal}`
      return line
    }))
  }
  setSettings(settings) {
    this.settings = settings
    this.shaping.follow(settings)
  }

  add(update) {
    const before = this.update
    this.update = update
    this.late.add(update.maxLate / 1000)
    this.bytes.add(update.bytes)
    const now = performance.now()
    if (before && now - this.rated > 200) {
      this.rate.add((update.ticks - this.ratedTicks) / (now - this.rated) * 1000)
      Object.assign(this, { rated: now, ratedTicks: update.ticks })
    } else if (!before || update.ticks < before.ticks) {
      Object.assign(this, { rated: now, ratedTicks: update.ticks })
    }
  }

  draw() {
    const { update, model, settings } = this
    if (!update || !model || !settings) return
    element('hold').textContent = update.held ? 'The hands hold the model.' : 'The hands hold nothing.'
    const lost = update.lost + update.skipped
    element('timing').textContent = `${model.rate} Hz wanted, ${settings.mode}\n${update.ticks} ticks, ${update.missed} missed` +
      `${lost > 0 ? `, ${lost} not shown` : ''}\n${update.restChanges} changes of the rest shape`
    this.drawClay()
    for (const chart of [this.late, this.rate, this.bytes]) chart.draw()
    update.hands.forEach((hand, slot) => this.drawHand(hand, slot))
  }
  drawClay() {
    const { clay, settings, model } = this
    element('clay').hidden = !clay || settings.mode !== 'clay'
    if (element('clay').hidden) return
    const cm3 = volume => (volume * (100 / model.unitsPerMetre) ** 3).toFixed(1)
    element('clay-state').textContent = `touches at ${clay.contacts.length} places, ${clay.penetration.toFixed(3)} mm deep\n` +
      (clay.first > 0 ? `volume ${cm3(clay.volume)} cm\u00b3, at first ${cm3(clay.first)}` : 'volume not kept: no closed surface')
  }
  partOf(slot) {
    const id = 'hand-' + slot
    if (element(id)) return element(id)
    const part = element('hands').appendChild(document.createElement('div'))
    Object.assign(part, { id, className: 'hand', hidden: true })
    part.appendChild(document.createElement('div'))
    part.appendChild(document.createElement('canvas')).className = 'bars'
    return part
  }
  setDevices(devices) {
    devices.forEach((ofHand, slot) => this.partOf(slot).firstChild.replaceChildren(...ofHand.map(({ title, state }) => {
      const line = document.createElement('div')
      line.textContent = `${title}\n${state}`
      return line
    })))
  }
  drawHand(hand, slot) {
    const part = this.partOf(slot)
    part.hidden = !hand
    if (!hand) return
    part.className = hand.silent || hand.wristLost ? 'hand silent' : 'hand'
    drawBends(part.lastChild, hand)
  }
}
