// Keys and the search of commands, the hints, and messages to the user. The controls are those of a form.
// As in Blender: azimuth and elevation of where one looks from, and with Ctrl from the opposite side.
const VIEWS = { 1: [0, 0], 3: [Math.PI / 2, 0], 7: [0, Math.PI / 2] }
const opposite = ([azimuth, elevation]) => elevation > 0 ? [azimuth, -elevation] : [azimuth - Math.PI, elevation]
// What the page does by itself, of COMMANDS, which the server fills in from its table (apps/commands).
const OWN = {
  'view front': panel => panel.camera.look(...VIEWS[1]),
  'view right': panel => panel.camera.look(...VIEWS[3]),
  'view top': panel => panel.camera.look(...VIEWS[7]),
  'frame all': panel => panel.camera.frame(),
  'fold panel': panel => panel.fold(),
  'search': panel => panel.search(),
  'paint masks': panel => { panel.painter.isOn = !panel.painter.isOn },
  'list keys': panel => panel.search(),
}
const MESSAGE_LASTS = 8000 // ms
const HINTS_CLOSED = 'nendo-hints=closed' // a cookie: it is that of all ports of this machine
const KEY_NAMES = { ' ': 'Space', Escape: 'Esc' }
const FIELD_KEYS = { 'select-one': /./, number: /./, text: /./, range: /^(Arrow|Home|End)/, checkbox: /^ $/ } // by their types
const commandsHere = () => COMMANDS.filter(({ inRun, inTimeline }) => document.body.dataset.screen === 'timeline' ? inTimeline : inRun)
const commandNamed = wanted => COMMANDS.find(({ name }) => name === wanted)

class Panel {
  // shown: the parts of the picture, by their names. fetchImage: as Paint takes it.
  constructor(ask, shown, fetchImage) {
    Object.assign(this, { ask, shown, camera: null, painter: null, model: null, refusals: new Map() })
    this.form = new Form(this, fetchImage)
    for (const button of document.querySelectorAll('button[data-own]')) {
      const command = commandNamed(button.dataset.own)
      explain(button, `${command.help} (${command.keys.join(', ')})`)
      button.addEventListener('click', () => this.give(command))
    }
    document.addEventListener('keydown', event => this.press(event))
    element('words').addEventListener('input', () => this.find(0))
    element('words').addEventListener('keydown', event => this.searchKey(event))
    listen(element('found'), at => this.take(this.found[at]))
    this.hint()
  }

  give({ name, isForRun, isEdit }) {
    if (isForRun || isEdit) {
      const refusal = this.refusals.get(name) || '' // the server says it in advance
      this.report(refusal, true)
      if (!refusal) this.ask(isEdit ? `form\t${name}\t` : name)
      return
    }
    const part = name.replace('show ', '')
    if (part in this.shown) this.shown[part] = !this.shown[part]
    else OWN[name](this)
    this.form.showAgain()
    this.camera.changed()
  }
  isOn(name) { return name === 'paint masks' ? this.painter.isOn : this.shown[name.replace('show ', '')] }
  press(event) {
    const { key, ctrlKey, shiftKey, repeat, timeStamp } = event
    if (event.altKey || event.metaKey || element('search').open || FIELD_KEYS[event.target.type]?.test(key)) return
    if (key === ' ' && event.target.matches(':is(button, summary):focus-visible')) return // which it presses
    const name = KEY_NAMES[key] || key.replace('Arrow', ''), view = ctrlKey && VIEWS[key]
    const wanted = ctrlKey ? `Ctrl ${shiftKey ? 'Shift ' : ''}${name.length > 1 ? name : name.toUpperCase()}` : name
    const command = commandsHere().find(({ keys }) => keys.includes(wanted))
    if (!command && !view) return
    if (ctrlKey || key.length > 1 || !command.isForRun) event.preventDefault() // the browser's own F3, and a letter in the search
    if (repeat && !(command?.repeats && timeStamp > this.pressedAt + BETWEEN_INPUTS)) return
    this.pressedAt = timeStamp
    if (view) this.camera.look(...opposite(view))
    else this.give(command)
  }
  fold() {
    const folded = element('panel').classList.toggle('folded')
    document.querySelector('[data-own="fold panel"]').textContent = folded ? '+' : '\u2212'
  }
  // What the panel covers of the page's width. The picture ends above the strip of a timeline.
  covered() {
    const left = document.querySelector(':is(#form-ways, #form-course, #form-edit):not([hidden])'), strip = element('form-timeline')
    document.body.style.setProperty('--bar', strip?.clientHeight ? strip.clientHeight + 'px' : '')
    if (left) return left.getBoundingClientRect().right / innerWidth
    const panel = element('panel')
    return panel.classList.contains('folded') ? 0 : Math.min(0.4, panel.getBoundingClientRect().right / innerWidth)
  }

  // All commands with their keys, and those that have each word in their name, their button or their help.
  search() {
    element('words').value = ''
    element('search').showModal()
    this.find(0)
  }
  find(chosen) {
    const words = element('words').value.toLowerCase().split(' ')
    const fits = ({ name, button, help }) => words.every(word => `${name} ${button} ${help}`.toLowerCase().includes(word))
    this.found = commandsHere().filter(fits)
    this.chosen = clamp(chosen, 0, this.found.length - 1)
    element('found').replaceChildren()
    this.found.forEach(({ name, keys, help }, at) => {
      const refusal = this.refusals.get(name)
      const row = make('button', element('found'), { ariaDisabled: Boolean(refusal), ariaCurrent: at === this.chosen })
      for (const textContent of [name, keys.join(', '), refusal || help]) make('span', row, { textContent })
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
    const lines = matchMedia('(pointer: coarse)').matches ? [...HINTS.slice(0, -1), touches] : HINTS
    hints.hidden = document.cookie.includes(HINTS_CLOSED)
    const all = [...lines, { keys: 'F3, ?', text: 'Finds any command, and lists the keys.' }]
    hints.innerHTML = all.map(({ keys, text }) => `<p><b>${keys}</b><span>${text}</span></p>`).join('')
    make('button', hints.lastChild, { textContent: 'Do not show again' }).addEventListener('click', () => {
      document.cookie = `${HINTS_CLOSED}; max-age=34560000; samesite=strict`
      hints.hidden = true
    })
  }

  // In the status bar, beside the state.
  report(words, isError) {
    setText(element('message'), words)
    element('message').classList.toggle('error', isError)
    clearTimeout(this.timer)
    this.timer = setTimeout(() => setText(element('message'), ''), MESSAGE_LASTS)
  }
  say(words) { Object.assign(element('banner'), { textContent: words, hidden: words === '' }) }
  connected(yes, words) {
    element('form-run').setAttribute('aria-disabled', !yes)
    if (yes) this.form.showAgain()
    this.say(words)
  }
  setModel(model) {
    this.model = model
    element('model').textContent = model.name
    document.title = `${model.name} - Nendo`
  }
}
