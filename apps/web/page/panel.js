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
const commandNamed = wanted => COMMANDS.find(({ name }) => name === wanted)

class Panel {
  // shown: the parts of the picture, by their names. fetchPicture: as Paint takes it.
  constructor(ask, shown, fetchPicture) {
    Object.assign(this, { ask, shown, camera: null, painter: null, model: null, refusals: new Map() })
    this.form = new Form(this, fetchPicture)
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

  give(command) {
    const { name, isForRun } = command, part = name.replace('show ', '')
    if (isForRun) return this.giveToRun(name)
    if (part in this.shown) this.shown[part] = !this.shown[part]
    else OWN[name](this)
    this.form.showOwn()
    this.camera.changed()
  }
  // The server says in advance which commands are not possible.
  giveToRun(name) {
    const refusal = this.refusals.get(name) || ''
    this.report(refusal, true)
    if (!refusal) this.ask(name)
  }
  isOn(name) { return name === 'paint masks' ? this.painter.isOn : this.shown[name.replace('show ', '')] }
  press(event) {
    if (event.altKey || event.metaKey || element('search').open) return
    if (event.target.matches('select, input[type=number], input[type=text]')) return // which have keys of their own
    if (event.ctrlKey) return this.pressWithCtrl(event)
    if (event.repeat) return
    if (event.key === 'Home' && event.target.matches('input[type=range]')) return
    const command = COMMANDS.find(({ keys }) => keys.includes(event.key))
    if (!command) return
    if (event.key.length > 1 || !command.isForRun) event.preventDefault() // the browser's own F3, and a letter in the search
    this.give(command)
  }
  pressWithCtrl(event) {
    const key = event.key.toUpperCase(), view = VIEWS[key]
    const command = COMMANDS.find(({ keys }) => keys.includes(`Ctrl ${event.shiftKey ? 'Shift ' : ''}${key}`))
    if (!command && !view) return
    event.preventDefault()
    if (view) this.camera.look(...opposite(view))
    else this.give(command)
  }
  fold() {
    const folded = element('panel').classList.toggle('folded')
    document.querySelector('[data-own="fold panel"]').textContent = folded ? '+' : '\u2212'
  }
  // What the panel covers of the page's width.
  covered() {
    const left = document.querySelector(':is(#form-ways, #form-course):not([hidden])')
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
    this.found = COMMANDS.filter(fits)
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
    for (const { keys, text } of [...lines, { keys: 'F3, ?', text: 'Finds any command, and lists the keys.' }]) {
      const line = make('p', hints)
      make('b', line, { textContent: keys })
      make('span', line, { textContent: text })
    }
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
  say(words) {
    element('banner').textContent = words
    element('banner').hidden = words === ''
  }
  connected(yes) { element('form-run').setAttribute('aria-disabled', !yes) }
  setModel(model) {
    this.model = model
    element('model').textContent = model.name
    document.title = `${model.name} - Nendo`
  }
}
