// The panel: buttons, keys, figures.
// As in Blender: where one looks from, and where from with Ctrl.
const RIGHT_ANGLE = Math.PI / 2
const VIEWS = {
  1: { plain: [0, 0], ctrl: [Math.PI, 0] },
  3: { plain: [RIGHT_ANGLE, 0], ctrl: [-RIGHT_ANGLE, 0] },
  7: { plain: [0, RIGHT_ANGLE], ctrl: [0, -RIGHT_ANGLE] },
}
const KEYS = [
  ['g', 'grab: the hands take hold', panel => panel.ask('grab')],
  ['l', 'let go; what is shaped stays', panel => panel.ask('let go')],
  ['a', 'take hold anew where the hands are, without a commit', panel => panel.ask('take hold')],
  ['c', 'commit: this shape becomes the rest shape', panel => panel.ask('commit')],
  ['u', 'undo the last step', panel => panel.step('undo')],
  ['r', 'redo what was undone', panel => panel.step('redo')],
  ['Ctrl Z', 'undo, too; with Shift, or Ctrl Y: redo'],
  ['x', 'reset: back to the model as it was loaded', panel => panel.ask('reset')],
  ['t', 'a take: record from here on, and end that', panel => panel.record()],
  [',', 'of a puppet: the left hand lets go, takes hold again', panel => panel.clutch(0)],
  ['\'', 'of a puppet: the right hand lets go, takes hold again', panel => panel.clutch(1)],
  ['y', 'symmetry: one hand shapes both sides, or plays both of a puppet', panel => panel.toggleSymmetry()],
  ['z', 'clear the masks: everything moves', panel => panel.ask('mask clear')],
  ['Z', 'invert the masks', panel => panel.ask('mask invert')],
  ['.', 'mark this moment in the recording', panel => panel.ask('mark')],
  ['o', 'overdub: the gloves\' layer comes in, or goes out (--over, --layer)', panel => panel.ask('punch')],
  ['k', 'keep the recording of what was just done (--keep-last)', panel => panel.ask('keep')],
  ['s', 'save the model as it is now', panel => panel.ask('save')],
  ['m', 'the next mode', panel => panel.shaping.nextMode(Boolean(panel.update && panel.update.isPuppet))],
  ['n', 'the next kernel', panel => panel.shaping.nextKernel()],
  ['[', 'smaller radii', panel => panel.shaping.scale(1 / 1.1)],
  [']', 'larger radii', panel => panel.shaping.scale(1.1)],
  ['w', 'the next brush of type 2', panel => panel.shaping.nextBrush()],
  ['-', 'a weaker brush; below 0 the opposite', panel => panel.shaping.strengthen(-0.1)],
  ['=', 'a stronger brush', panel => panel.shaping.strengthen(0.1)],
  ['i', 'the surface never folds, or may', panel => panel.toggle('injective', '')],
  [';', 'more clay: the volume stays; from all to air', panel => panel.shaping.nextVolume()],
  ['j', 'the whole hand holds, or its fingertips', panel => panel.toggle('hold', '')],
  ['e', 'subdivide: the model gets more vertices for finer strokes', panel => panel.ask('subdivide')],
  ['E', 'refine: more triangles where it was stretched, fewer where it was crowded', panel => panel.ask('refine')],
  ['h', 'hands on and off', panel => panel.toggle('skin')],
  ['b', 'bones on and off', panel => panel.toggle('bones')],
  ['v', 'control vectors on and off', panel => panel.toggle('vectors')],
  ['d', 'radii on and off', panel => panel.toggle('radii')],
  ['0', 'where hands touch clay, on and off', panel => panel.toggle('contacts')],
  ['f', 'facets in place of smooth shading', panel => panel.toggle('facets')],
  ['1', 'the view from the front; with Ctrl from the back', panel => panel.camera.look(...VIEWS[1].plain)],
  ['3', 'from the right; with Ctrl from the left', panel => panel.camera.look(...VIEWS[3].plain)],
  ['7', 'from the top; with Ctrl from the bottom', panel => panel.camera.look(...VIEWS[7].plain)],
  ['Home', 'all of the model in the picture', panel => panel.camera.frame()],
  ['p', 'the panel folded and unfolded', panel => panel.fold()],
  ['?', 'this list', panel => panel.help()],
]
const MOST_UNDOABLE = 48 // that the server tells
const element = id => document.getElementById(id)

class Panel {
  constructor(ask, shown) {
    this.ask = request => {
      if (this.noted) this.tell('')
      ask(request)
    }
    Object.assign(this, { camera: null, live: false, noted: false, settings: null, history: null, puppet: null })
    this.late = new Chart(element('chart-late'), 'late', 'ms')
    this.rate = new Chart(element('chart-rate'), 'ticks a second', 'Hz')
    this.bytes = new Chart(element('chart-bytes'), 'a message', 'bytes')
    this.shaping = new Shaping(this.ask)
    const requests = [...document.querySelectorAll('[data-request]')]
    for (const button of requests) button.addEventListener('click', () => this.ask(button.dataset.request))
    this.steps = requests.filter(button => ['undo', 'redo'].includes(button.dataset.request))
    this.buttons = [...requests, element('record'), element('symmetry')]
    element('record').addEventListener('click', () => this.record())
    element('symmetry').addEventListener('click', () => this.toggleSymmetry())
    for (const part of ['skin', 'bones', 'vectors', 'radii', 'contacts', 'facets'])
      element('show-' + part).addEventListener('change', event => shown(part, event.target.checked))
    element('help-button').addEventListener('click', () => this.help())
    element('fold-button').addEventListener('click', () => this.fold())
    for (const [key, words] of KEYS) {
      const row = element('keys').insertRow()
      row.insertCell().appendChild(document.createElement('kbd')).textContent = key
      row.insertCell().textContent = words
    }
    document.addEventListener('keydown', event => this.press(event))
    this.connected(false)
  }

  press(event) {
    if (event.altKey || event.metaKey) return
    if (event.target.matches('select')) return // which has keys of its own
    if (event.ctrlKey) return this.pressWithCtrl(event)
    if (event.repeat) return
    if (event.key === 'Home' && event.target.matches('input[type=range]')) return
    const key = KEYS.find(([name]) => name === event.key)
    if (key && key[2]) key[2](this)
  }
  pressWithCtrl(event) {
    const key = event.key.toLowerCase(), view = VIEWS[key]
    if (key !== 'z' && key !== 'y' && !view) return
    event.preventDefault()
    if (view) this.camera.look(...view.ctrl)
    else this.step(key === 'y' || event.shiftKey ? 'redo' : 'undo')
  }
  canStep(request) { return Boolean(this.update) && (request === 'undo' ? this.update.canUndo : this.update.canRedo) }
  // The button is grey then; a key says why nothing happens.
  step(request) {
    if (!this.live) return
    if (this.canStep(request)) this.ask(request)
    else this.tell(`There is nothing to ${request}.`, true)
  }
  showSteps() {
    for (const button of this.steps) button.disabled = !this.live || !this.canStep(button.dataset.request)
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
  clutch(slot) {
    const { update } = this
    if (update && update.isPuppet) this.ask(`clutch ${slot === 0 ? 'left' : 'right'} all ${update.letGo[slot] ? 'on' : 'off'}`)
  }
  toggleSymmetry() {
    const { update } = this
    if (update) this.ask(`symmetry ${update.symmetric ? 'off' : 'on'}`)
  }
  record() {
    if (this.settings) this.ask(this.settings.recorded ? 'end recording' : 'record')
  }
  help() {
    const dialog = element('help')
    if (dialog.open) dialog.close()
    else dialog.showModal()
  }

  tell(words, noted = false) {
    element('told').textContent = words
    this.noted = noted // it stays until the next command
  }
  say(words) {
    element('banner').textContent = words
    element('banner').hidden = words === ''
  }
  connected(yes) {
    this.live = yes
    for (const button of this.buttons) button.disabled = !yes
    this.showSteps()
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
    const lines = [history.undoable < MOST_UNDOABLE ? 'the beginning' : 'earlier', ...words].map((text, at) => {
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
  // What each function listens to; an edited puppet takes the place of the one before.
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
    element('record').textContent = settings.recorded ? 'End recording' : 'Record'
    element('record').classList.toggle('on', settings.recorded)
    this.shaping.follow(settings)
  }

  add(update) {
    const before = this.update
    this.update = update
    this.late.add(update.mostLate / 1000)
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
    element('hold').textContent = update.held ? 'The hands hold the model.' : 'The hands have let go.'
    element('symmetry').classList.toggle('on', update.symmetric)
    this.showSteps()
    const lost = update.lost + update.skipped
    element('timing').textContent = `${model.rate} Hz wanted, ${MODES[settings.mode]}\n${update.ticks} ticks, ${update.missed} missed` +
      `${lost > 0 ? `, ${lost} not shown` : ''}\n${update.commits} commits`
    this.drawClay()
    for (const chart of [this.late, this.rate, this.bytes]) chart.draw()
    update.hands.forEach((hand, slot) => this.drawGlove(hand, slot))
  }
  drawClay() {
    const { clay, settings, model } = this
    element('clay').hidden = !clay || settings.mode !== 3
    if (element('clay').hidden) return
    const cm3 = volume => (volume * (100 / model.unitsPerMetre) ** 3).toFixed(1)
    element('clay-told').textContent = `touches at ${clay.contacts.length} places, ${clay.penetration.toFixed(3)} mm deep\n` +
      (clay.first > 0 ? `volume ${cm3(clay.volume)} cm\u00b3, at first ${cm3(clay.first)}` : 'volume not kept: no closed surface')
  }
  drawGlove(hand, slot) {
    const id = 'glove-' + slot
    let part = element(id)
    if (!part) {
      part = element('gloves').appendChild(document.createElement('div'))
      Object.assign(part, { id, className: 'glove' })
      part.appendChild(document.createElement('span'))
      part.appendChild(document.createElement('canvas')).className = 'bars'
    }
    part.hidden = !hand
    if (!hand) return
    part.className = hand.silent ? 'glove silent' : 'glove'
    const { sent, delivered, missed, refused, bad } = hand.records
    part.firstChild.textContent = `${slot === 0 ? 'left' : 'right'}: ${hand.samples} samples${hand.silent ? ', silent' : ''}${hand.uncalibrated ? ', uncalibrated' : ''}; ` +
      (missed === 0xFFFFFFFF ? `${delivered} delivered, losses on the line unknown`
        : `${sent} sent, ${delivered} delivered, ${missed} missed`) + `, ${refused} refused, ${bad} bad records`
    drawBends(part.lastChild, hand)
  }
}
