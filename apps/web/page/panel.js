// The panel: buttons, keys, figures.
const KEYS = [
  ['g', 'grab: the hands take hold', panel => panel.ask('grab')],
  ['l', 'let go; what is shaped stays', panel => panel.ask('let go')],
  ['c', 'commit: this shape becomes the rest shape', panel => panel.ask('commit')],
  ['u', 'undo the last commit', panel => panel.ask('undo')],
  ['r', 'redo what was undone', panel => panel.ask('redo')],
  ['x', 'reset: back to the model as it was loaded', panel => panel.reset()],
  ['t', 'a take: record from this shape on, and end that', panel => panel.record()],
  ['k', 'keep the recording of what was just done (--keep-last)', panel => panel.ask('keep')],
  ['s', 'save the model as it is now', panel => panel.ask('save')],
  ['m', 'the other mode', panel => panel.shaping.otherMode()],
  ['n', 'the next kernel', panel => panel.shaping.nextKernel()],
  ['[', 'smaller radii', panel => panel.shaping.scale(1 / 1.1)],
  [']', 'larger radii', panel => panel.shaping.scale(1.1)],
  ['Enter', 'apply the mode, kernel and radii that are chosen', panel => panel.shaping.apply()],
  ['h', 'hands on and off', panel => panel.toggle('skin')],
  ['b', 'bones on and off', panel => panel.toggle('bones')],
  ['v', 'control vectors on and off', panel => panel.toggle('vectors')],
  ['d', 'radii on and off', panel => panel.toggle('radii')],
  ['f', 'facets in place of smooth shading', panel => panel.toggle('facets')],
  ['?', 'this list', panel => panel.help()],
]
const element = id => document.getElementById(id)

class Panel {
  constructor(ask, shown) {
    this.ask = ask
    this.late = new Chart(element('chart-late'), 'late', 'ms')
    this.rate = new Chart(element('chart-rate'), 'ticks a second', 'Hz')
    this.bytes = new Chart(element('chart-bytes'), 'a message', 'bytes')
    this.shaping = new Shaping(ask)
    const requests = [...document.querySelectorAll('[data-request]')]
    for (const button of requests) button.addEventListener('click', () => ask(button.dataset.request))
    this.buttons = [...requests, element('reset'), element('record')]
    element('record').addEventListener('click', () => this.record())
    element('reset').addEventListener('click', () => this.reset())
    element('reset-dialog').addEventListener('close', ({ target }) => {
      if (target.returnValue === 'reset') ask('reset')
      target.returnValue = ''
    })
    for (const part of ['skin', 'bones', 'vectors', 'radii', 'facets'])
      element('show-' + part).addEventListener('change', event => shown(part, event.target.checked))
    element('help-button').addEventListener('click', () => this.help())
    for (const [key, words] of KEYS) {
      const row = element('keys').insertRow()
      row.insertCell().appendChild(document.createElement('kbd')).textContent = key
      row.insertCell().textContent = words
    }
    document.addEventListener('keydown', event => this.press(event))
    this.connected(false)
  }

  press(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || event.repeat) return
    // Which have keys of their own, or take Enter for a click.
    if (event.target.matches('select') || element('reset-dialog').open) return
    if (event.key === 'Enter' && event.target.matches('button, input')) return
    const key = KEYS.find(([name]) => name === event.key)
    if (key) key[2](this)
  }
  toggle(part) { element('show-' + part).click() }
  reset() {
    if (!element('reset').disabled) element('reset-dialog').showModal()
  }
  record() {
    if (this.model) this.ask(this.model.recorded ? 'end recording' : 'record')
  }
  help() {
    const dialog = element('help')
    if (dialog.open) dialog.close()
    else dialog.showModal()
  }

  tell(words) { element('told').textContent = words }
  say(words) {
    element('banner').textContent = words
    element('banner').hidden = words === ''
  }
  connected(yes) {
    for (const button of this.buttons) button.disabled = !yes
    this.shaping.connected(yes)
  }
  setModel(model) {
    this.model = model
    element('model').textContent = model.name
    document.title = `${model.name} - Nendo`
    element('record').textContent = model.recorded ? 'End the recording' : 'Record'
    element('record').classList.toggle('on', model.recorded)
    return this.shaping.setModel(model)
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
    const { update, model } = this
    if (!update || !model) return
    element('hold').textContent = update.held ? 'The hands hold the model.' : 'The hands have let go.'
    const lost = update.lost + update.skipped
    element('timing').textContent = `${model.rate} Hz wanted, type ${model.settings.mode}\n${update.ticks} ticks, ${update.missed} missed` +
      `${lost > 0 ? `, ${lost} not shown` : ''}\n${update.commits} commits, ${update.undos} undone`
    for (const chart of [this.late, this.rate, this.bytes]) chart.draw()
    update.hands.forEach((hand, slot) => this.drawGlove(hand, slot))
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
    part.firstChild.textContent = `${slot === 0 ? 'left' : 'right'}: ${hand.samples} samples` +
      `${hand.silent ? ', silent' : ''}${hand.badRecords > 0 ? `, ${hand.badRecords} bad records` : ''}`
    drawBends(part.lastChild, hand)
  }
}
