// The panel, the search, the hints and the status bar, as in the window.
// As in Blender: where one looks from, and where from with Ctrl.
const RIGHT_ANGLE = Math.PI / 2
const VIEWS = {
  1: { plain: [0, 0], ctrl: [Math.PI, 0] },
  3: { plain: [RIGHT_ANGLE, 0], ctrl: [-RIGHT_ANGLE, 0] },
  7: { plain: [0, RIGHT_ANGLE], ctrl: [0, -RIGHT_ANGLE] },
}
// What the page does by itself, of COMMANDS, which the server fills in from its table (apps/commands).
const OWN = {
  'view front': panel => panel.camera.look(...VIEWS[1].plain),
  'view right': panel => panel.camera.look(...VIEWS[3].plain),
  'view top': panel => panel.camera.look(...VIEWS[7].plain),
  'frame all': panel => panel.camera.frame(),
  'fold panel': panel => panel.fold(),
  'search': panel => panel.search(),
  'paint masks': panel => panel.paintMasks(),
  'list keys': panel => panel.help(),
}
const MAX_UNDOABLE = 48 // that the server lists
const MESSAGE_LASTS = 8000 // ms
const HINTS_CLOSED = 'nendo-hints=closed' // a cookie: it is that of all ports of this machine
const helpOf = ({ help, keys }, refusal) => `${help}${refusal ? '\n' + refusal : ''} (${keys.join(', ')})`
const commandNamed = wanted => COMMANDS.find(({ name }) => name === wanted)
const grouped = number => String(number).replace(/\B(?=(\d{3})+$)/g, ',')
const setText = (part, text) => { if (part.textContent !== text) part.textContent = text }

class Panel {
  // shown: the parts of the picture, by their names.
  constructor(ask, shown) {
    Object.assign(this, { ask, shown, camera: null, live: false, settings: null, history: null, puppet: null, states: new Map(), devices: [[], []] })
    this.charts = Object.fromEntries(['late', 'uneven', 'picture'].map(name => [name, new Chart(name)]))
    this.hands = [0, 1].map(() => {
      const part = make('div', element('hands'), { className: 'hand', hidden: true })
      return { part, lines: make('p', part), bars: make('canvas', part, { className: 'bars' }) }
    })
    this.shaping = new Shaping(this.ask)
    this.buttons = COMMANDS.filter(({ button }) => button).map(command => this.makeButton(command))
    this.boxes = new Map(Object.keys(shown).map(part => ['show ' + part, this.makeBox('parts', part, commandNamed('show ' + part))]))
    this.paints = this.makeBox('group-more', 'paint masks', commandNamed('paint masks'))
    this.buttons.find(({ isBox }) => isBox).line.after(this.paints.parentNode)
    for (const button of document.querySelectorAll('button[data-own]')) {
      const command = commandNamed(button.dataset.own)
      button.setAttribute('aria-description', helpOf(command))
      button.addEventListener('click', () => this.give(command))
    }
    for (const { keys, help } of COMMANDS) {
      const row = element('keys').insertRow()
      make('kbd', row.insertCell(), { textContent: keys.join(', ') })
      row.insertCell().textContent = help
    }
    document.addEventListener('keydown', event => this.press(event))
    element('words').addEventListener('input', () => this.find(0))
    element('words').addEventListener('keydown', event => this.searchKey(event))
    this.hint()
    this.showParts()
    this.connected(false)
  }

  makeBox(parent, text, command) {
    const line = make('label', element(parent), { className: 'box' })
    make('span', line, { textContent: text })
    line.setAttribute('aria-description', helpOf(command))
    const box = make('input', line, { type: 'checkbox' })
    box.dataset.own = command.name
    box.addEventListener('click', event => {
      event.preventDefault() // it shows what has come of it
      this.give(command)
    })
    return box
  }
  // Symmetry is a box, as in the window.
  makeButton(command) {
    const { name, group } = command, isBox = name === 'symmetry'
    const control = isBox ? this.makeBox('group-' + group, name, command) : make('button', element('group-' + group))
    control.dataset.request = name
    if (!isBox) control.addEventListener('click', () => this.give(command))
    return { command, control, isBox, line: isBox ? control.parentNode : control }
  }
  // The server says in advance which commands are on, and why some are not possible.
  stateOf(name) { return this.states.get(name) || { isOn: false, isHidden: false, refusal: '' } }
  give(command) {
    if (this.boxes.has(command.name)) return this.toggle(command.name)
    if (!command.isForRun) return OWN[command.name](this)
    const { refusal } = this.stateOf(command.name)
    this.report(refusal, true)
    if (refusal) return
    if (command.isSetting) this.shaping.giveWay()
    this.ask(command.name)
  }
  press(event) {
    if (event.altKey || event.metaKey || element('search').open) return
    if (event.target.matches('select, input[type=number], input[type=text]')) return // which have keys of their own
    if (event.ctrlKey) return this.pressWithCtrl(event)
    if (event.repeat) return
    if (event.key === 'Home' && event.target.matches('input[type=range]')) return
    const command = COMMANDS.find(({ keys }) => keys.includes(event.key))
    if (!command) return
    if (event.key.length > 1) event.preventDefault() // the browser's own F3
    this.give(command)
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
    const isPuppet = Boolean(this.update && this.update.isPuppet) // whose masks are edited in the window
    this.paints.parentNode.hidden = isPuppet
    for (const { command, control, isBox, line } of this.buttons) {
      const { isOn, isHidden, refusal } = this.stateOf(command.name)
      line.hidden = isHidden || (isPuppet && command.name.startsWith('mask '))
      line.setAttribute('aria-disabled', !this.live || refusal !== '')
      line.setAttribute('aria-description', helpOf(command, refusal))
      if (isBox) control.checked = isOn
      else setText(control, isOn ? command.buttonOn : command.button)
      control.classList.toggle('on', isOn)
    }
  }
  showParts() { for (const [name, box] of this.boxes) box.checked = this.shown[name.slice(5)] }
  paintMasks() { this.paints.checked = this.painter.isOn = !this.painter.isOn }
  fold() {
    const folded = element('panel').classList.toggle('folded')
    document.querySelector('[data-own="fold panel"]').textContent = folded ? '+' : '\u2212'
    this.camera.changed()
  }
  // What the panel covers of the page's width.
  covered() {
    const left = document.querySelector(':is(#form-ways, #form-course):not([hidden])')
    if (left) return left.getBoundingClientRect().right / innerWidth
    const panel = element('panel')
    return panel.classList.contains('folded') ? 0 : Math.min(0.4, panel.getBoundingClientRect().right / innerWidth)
  }
  toggle(name) {
    const part = name.slice(5)
    this.shown[part] = !this.shown[part]
    this.showParts()
    this.camera.changed()
  }
  help() {
    const dialog = element('help')
    if (dialog.open) dialog.close()
    else dialog.showModal()
  }
  search() {
    element('words').value = ''
    element('search').showModal()
    this.find(0)
  }
  // The commands that have each word in their name, their button or their help.
  find(chosen) {
    const words = element('words').value.toLowerCase().split(' ')
    const fits = ({ name, button, help }) => words.every(word => `${name} ${button} ${help}`.toLowerCase().includes(word))
    this.found = COMMANDS.filter(fits)
    this.chosen = Math.max(0, Math.min(chosen, this.found.length - 1))
    element('found').replaceChildren()
    this.found.forEach((command, at) => {
      const { refusal } = this.stateOf(command.name)
      const row = make('button', element('found'), { ariaDisabled: refusal !== '', ariaCurrent: at === this.chosen })
      for (const textContent of [command.name, command.keys.join(', '), refusal || command.help]) make('span', row, { textContent })
      row.addEventListener('click', () => this.take(command))
      if (at === this.chosen) row.scrollIntoView({ block: 'nearest' })
    })
  }
  take(command) {
    element('search').close()
    if (command) this.give(command)
  }
  searchKey(event) {
    const steps = { ArrowDown: 1, ArrowUp: -1 }[event.key]
    if (steps) this.find(this.chosen + steps)
    else if (event.key === 'Enter') this.take(this.found[this.chosen])
    else return
    event.preventDefault()
  }
  // Over the picture at the first start, until they are closed.
  hint() {
    const hints = element('hints'), touches = { keys: 'finger', text: 'Turns the view, two shift and zoom; held on a hand, it moves it.' }
    hints.hidden = document.cookie.includes(HINTS_CLOSED)
    for (const { keys, text } of matchMedia('(pointer: coarse)').matches ? [...HINTS.slice(0, -1), touches] : HINTS) {
      const line = make('p', hints)
      make('b', line, { textContent: keys })
      make('span', line, { textContent: text })
    }
    const last = make('p', hints)
    make('span', last, { textContent: 'F3 finds any command, ? lists the keys.' })
    make('button', last, { textContent: 'Do not show again' }).addEventListener('click', () => {
      document.cookie = `${HINTS_CLOSED}; max-age=34560000; samesite=strict`
      hints.hidden = true
    })
  }

  // In the status bar, beside the state.
  report(words, isError) {
    setText(element('message'), words)
    element('message').classList.toggle('error', isError)
    this.reported = performance.now()
  }
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
    element('history').replaceChildren()
    const lines = [history.undoable < MAX_UNDOABLE ? 'the beginning' : 'earlier', ...words].map((textContent, at) => {
      const line = make('button', element('history'), { textContent, className: at > history.undoable ? 'undone' : '', ariaCurrent: at === history.undoable })
      line.addEventListener('click', () => this.goTo(at))
      return line
    })
    const list = element('history')
    list.scrollTop = lines[history.undoable].offsetTop - list.offsetTop - list.clientHeight / 2 // the panel stays
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
    element('functions').replaceChildren()
    for (const { name, signal } of puppet.functions) make('div', element('functions'), { textContent: `${name}: ${signal}` })
  }
  setSettings(settings) {
    this.settings = settings
    this.shaping.follow(settings)
  }

  add(update) {
    const before = this.update
    this.update = update
    if (!before || before.isPuppet !== update.isPuppet) this.showStates()
    this.charts.late.add(update.maxLate / 1000)
    this.charts.uneven.add(Math.abs(update.sinceLast / 1000 - 1000 / this.model.rate))
  }

  draw() {
    const { update, model, settings } = this
    if (!update || !model || !settings) return
    if (performance.now() - this.reported > MESSAGE_LASTS) setText(element('message'), '')
    this.drawStatus()
    setText(element('timing'), `${update.ticks} ticks, ${update.restChanges} changes of the rest shape` +
      (update.lost + update.skipped > 0 ? `, ${update.lost + update.skipped} not shown` : ''))
    this.drawClay()
    for (const chart of Object.values(this.charts)) chart.draw()
    update.hands.forEach((hand, slot) => this.drawHand(hand, slot))
  }
  cm3(volume) { return (volume * (100 / this.model.unitsPerMetre) ** 3).toFixed(1) }
  drawStatus() {
    const { update, model, clay, settings } = this
    const items = [update.held ? 'holds the model' : 'holds nothing', `${grouped(model.vertices)} vertices`]
    if (clay && settings.mode === 'clay' && clay.first > 0) items.push(`${this.cm3(clay.volume)} cm3`)
    items.push(`${model.rate} Hz, ${grouped(update.missed)} missed`)
    update.hands.forEach((hand, slot) => {
      if (!hand) return
      const age = this.devices[slot].map(({ state }) => /\d+ ms(?= old)/.exec(state)).find(found => found)
      items.push(`${slot ? 'right' : 'left'} ${hand.silent ? 'silent' : hand.wristLost ? 'tracker lost' : age || ''}`)
    })
    const state = element('state')
    if (state.children.length !== items.length) state.replaceChildren(...items.map(() => document.createElement('span')))
    items.forEach((item, at) => setText(state.children[at], item))
  }
  drawClay() {
    const { clay, settings } = this
    element('contact').hidden = !clay || settings.mode !== 'clay'
    if (element('contact').hidden) return
    setText(element('clay'), `touches at ${clay.contacts.length} places, ${clay.penetration.toFixed(3)} mm deep\n` +
      (clay.first > 0 ? `volume ${this.cm3(clay.volume)} cm3, at first ${this.cm3(clay.first)}` : 'volume not kept: no closed surface'))
  }
  setDevices(devices) {
    this.devices = devices
    devices.forEach((some, slot) => setText(this.hands[slot].lines, some.map(({ title, state }) => `${title}\n${state}`).join('\n')))
  }
  drawHand(hand, slot) {
    const { part, bars } = this.hands[slot]
    part.hidden = !hand
    if (!hand) return
    part.classList.toggle('silent', hand.silent || hand.wristLost)
    drawBends(bars, hand)
  }
}
