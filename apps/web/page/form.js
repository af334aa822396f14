// Controls that the server describes (PROTOCOL.md, message 12): of a screen, of the run's panel, and of its status bar.
const MAX_FILE = 128 << 20 // bytes that the server takes
const PATIENCE = 1000 // ms, for which a control shows what was chosen before it shows another value of the server
const ARROWS = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }
const isSame = (given, { value, decimals }) => given === value || Math.abs(given - value) < 0.5 / 10 ** decimals

// Each creator below returns a control, its class, and what shows a description in it. `inside` is for what follows.
const shows = (control, show, base = '') => ({ control, base, show })
function labelled(base, inputs, heard, show) {
  const control = create('label'), words = make('span', control)
  control.append(...inputs)
  for (const input of inputs) input.addEventListener('input', () => heard(input))
  return shows(control, wanted => { setText(words, wanted.name); show(wanted) }, base)
}
// The children of a parent, as many as are wanted. Those that are there stay.
function childrenOf(parent, count, kind) {
  while (parent.children.length < count) make(kind, parent)
  while (parent.children.length > count) parent.lastChild.remove()
  return [...parent.children]
}
// Calls back with the number of the button that is pressed in a control.
function listen(control, give) {
  control.addEventListener('click', ({ target }) => {
    const at = [...control.children].indexOf(target.closest('button'))
    if (at >= 0) give(at)
  })
}

class Form {
  // fetchImage: as Paint takes it.
  constructor(panel, fetchImage) {
    Object.assign(this, { panel, fetchImage, parts: new Map(), pictures: new Map() })
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.showAgain())
    for (const name of ['dragover', 'drop']) document.addEventListener(name, event => {
      event.preventDefault()
      this.open(event.dataTransfer.files[0]) // there is none until it is dropped
    })
  }
  // kind: 0 is a screen's form, 1 the run's panel, 2 its status bar. Parts of other kinds stay.
  take(kind, { screen, parts }) {
    if (kind === 0) document.body.dataset.screen = screen
    for (const [name, part] of this.parts) if (part.kind === kind) part.section.hidden = !parts.some(one => one.name === name)
    for (const { name, controls } of parts) this.fill(this.partNamed(name, kind), controls)
    const shown = new Set(this.all().flatMap(({ wanted: { picture, shapes = [] } }) => [picture, ...shapes.map(([, what]) => what)]))
    for (const number of this.pictures.keys()) if (!shown.has(number)) this.pictures.delete(number)
  }
  partNamed(name, kind) {
    const id = 'form-' + name, place = () => element(id) || make('section', document.body, { id, className: 'form controls' })
    if (!this.parts.has(name)) this.parts.set(name, { kind, section: place(), shown: new Map() })
    return this.parts.get(name)
  }
  // What is as before stays, with its focus.
  fill({ kind, section, shown }, controls) {
    let unnamed = 0, around = section, last = null
    const keyOf = wanted => `${wanted.kind} ${wanted.kind === 'section' ? wanted.name : wanted.id || ++unnamed}`
    const all = new Map(controls.map(wanted => [keyOf(wanted), wanted]))
    for (const [key, { control }] of shown) {
      if (all.has(key)) continue
      control.remove()
      shown.delete(key)
    }
    for (const [key, wanted] of all) {
      const made = shown.get(key) || { sends: kind === 0 ? 'form' : 'panel', ...this[wanted.kind](value => this.change(made, value), wanted) }
      const { control, inside } = made
      if (inside && around !== section) [around, last] = [section, around.parentNode]
      const next = last ? last.nextSibling : around.firstChild
      if (control !== next) around.insertBefore(control, next)
      ;[around, last] = inside ? [inside, null] : [around, control]
      this.follow(made, wanted)
      shown.set(key, made)
    }
  }
  // Shows the server's value, unless it is older than the user's.
  follow(made, wanted) {
    const text = JSON.stringify(wanted), { control } = made, { id, kind, name, help, look, share } = wanted
    if (made.text === text) return
    const isOlder = made.timer && !isSame(made.given, wanted), hasOtherHelp = made.wanted?.help !== help
    Object.assign(made, { text, wanted })
    control.className = [made.base, look, share === 0 ? 'flows' : ''].join(' ')
    control.dataset.control = name
    if (kind === 'command' || kind === 'box') control.dataset.request = id
    if (id) control.setAttribute('aria-disabled', look === 'grey')
    if (share) control.style.setProperty('--share', share)
    explain(made.head || control, help)
    if (hasOtherHelp && control.contains(tips.over)) tips.show(tips.over)
    if (!isOlder) this.settle(made)
  }
  settle(made) {
    if (made.timer && made.wanted.kind === 'number' && made.control.matches(':active')) return this.change(made, made.given) // it is held
    clearTimeout(made.timer)
    made.timer = 0
    made.show(made.wanted)
  }
  // The user's value is shown at once. Of a control without a value, each press is sent.
  change(made, given) {
    const { kind, id, value } = made.wanted
    if (kind === 'command' || kind === 'box') this.panel.give(commandNamed(id))
    else this.panel.ask(`${made.sends}\t${id}\t${given}`, value === undefined ? null : made)
    if (kind === 'box') return made.show(made.wanted) // it shows what has come of it
    if (value === undefined) return
    clearTimeout(made.timer)
    Object.assign(made, { given, timer: setTimeout(() => this.settle(made), PATIENCE) })
    made.show({ ...made.wanted, value: given })
  }
  all() { return [...this.parts.values()].flatMap(({ shown }) => [...shown.values()]) }
  // When the page's own state, a picture or the colours have changed.
  showAgain() { for (const made of this.all()) if (!made.timer) made.show(made.wanted) }
  drawCharts(hands) {
    for (const { control, chart } of this.all())
      if (chart && control.clientWidth > 0) draw(control, chart.shapes(control.clientWidth, control.clientHeight, hands))
  }

  section(_, { open }) {
    const control = create('details', { open }), head = make('summary', control), inside = make('div', control, { className: 'controls' })
    return { ...shows(control, ({ name }) => setText(head, name)), head, inside }
  }
  text() {
    const control = create('p')
    return shows(control, ({ name }) => setText(control, name))
  }
  title() {
    const control = create('h2'), words = make('span', control), beside = make('small', control)
    return shows(control, ({ name, note }) => { setText(words, name); setText(beside, note) })
  }
  key() {
    const control = create('p'), disc = make('i', control), words = make('span', control)
    return shows(control, ({ name, colour }) => {
      setText(words, name)
      disc.style.background = `rgb(${colour.map(part => Math.round(255 * part ** (1 / 2.2)))})`
    })
  }
  ring() {
    const control = create('div')
    return shows(control, ({ value }) => control.style.setProperty('--part', value + '%'), 'ring')
  }
  separator() { return shows(create('hr'), () => {}) }
  chart(_, { id }) { return { ...shows(create('canvas'), () => {}, 'chart'), chart: CHARTS[id] } }
  bars(_, wanted) { return this.chart(_, wanted) }
  command(give) { return this.button(give, {}) }
  button(give, { picture }) {
    const control = create('button'), canvas = picture === undefined ? null : make('canvas', control, { width: 264, height: 198 })
    const words = make('span', control)
    control.addEventListener('click', () => give(''))
    return shows(control, ({ name, picture }) => {
      setText(words, name)
      const image = canvas && picture !== null && this.imageOf(picture)
      if (image) canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height)
    }, canvas ? 'card' : '')
  }
  drawing(give, { listens }) {
    const drawing = new Drawing(give, number => this.imageOf(number), listens)
    return shows(drawing.canvas, wanted => drawing.show(wanted), 'drawing')
  }
  // The bitmap of a picture; null: it is not there yet, and all is shown again when it is.
  imageOf(number) {
    if (!this.pictures.has(number)) this.load(number)
    return this.pictures.get(number)
  }
  async load(number) {
    this.pictures.set(number, null)
    const image = await this.fetchImage(number)
    if (!image) return this.pictures.delete(number) // what is shown next asks again
    this.pictures.set(number, image)
    this.showAgain()
  }
  check(give) {
    const input = create('input', { type: 'checkbox' })
    return labelled('box', [input], () => give(input.checked), ({ id, value }) => { input.checked = value ?? this.panel.isOn(id) })
  }
  box(give) { return this.check(give) }
  choice(give) {
    const input = create('select')
    return labelled('field', [input], () => give(input.value), ({ value, choices }) => {
      childrenOf(input, choices.length, 'option').forEach((option, at) => setText(option, choices[at]))
      input.value = value
    })
  }
  // Buttons with pictures above their names. Arrow keys choose as well.
  radio(give, { name }) {
    const control = create('div', { role: 'radiogroup', ariaLabel: name })
    let chosen = 0
    listen(control, give)
    control.addEventListener('keydown', event => {
      const { length } = control.children, next = (chosen + ARROWS[event.key] + length) % length
      if (!(next >= 0)) return
      event.preventDefault()
      give(next)
      control.children[next].focus()
    })
    return shows(control, ({ value, choices }) => {
      chosen = value
      childrenOf(control, choices.length, 'button').forEach((button, at) => {
        const { name, help, picture } = choices[at]
        const drawn = picture && `<svg viewBox="0 0 100 100" preserveAspectRatio="none"><path d="${PICTURES[picture]}"/></svg>`
        if (!button.firstChild) button.innerHTML = drawn + '<span></span>'
        setText(button.lastChild, name)
        Object.assign(button, { role: 'radio', value: name, ariaChecked: at === value })
        explain(button, help)
      })
    }, 'radio')
  }
  // The present row is in the middle after each change.
  list(give, { name }) {
    const control = create('div', { ariaLabel: name })
    let seen = ''
    listen(control, give)
    return shows(control, ({ value, rows }) => {
      const lines = childrenOf(control, rows.length, 'button'), now = lines[value], text = JSON.stringify([value, rows])
      lines.forEach((line, at) => Object.assign(line, { textContent: rows[at].name, className: rows[at].look, ariaCurrent: at === value }))
      if (now && text !== seen) control.scrollTop = now.offsetTop - control.offsetTop - control.clientHeight / 2 // the panel stays
      seen = text
    }, 'list')
  }
  // A slider and a field; with Ctrl, the wheel changes it as well. What is typed or dragged is not overwritten.
  number(give, { unit }) {
    const inputs = ['range', 'number'].map(type => create('input', { type }))
    let latest = null, edited = null
    const write = () => { for (const input of inputs) if (input !== edited) input.value = latest.value.toFixed(latest.decimals) }
    const put = (value, from = null) => {
      edited = from
      give(clamp(value, latest.min, latest.max))
    }
    const made = labelled('field', inputs, input => input.value && put(Number(input.value), input), wanted => {
      const { name, min, max, decimals } = wanted
      for (const input of inputs) Object.assign(input, { ariaLabel: name, min, max, step: 10 ** -decimals })
      latest = wanted
      write()
    })
    make('span', made.control, { className: 'unit', textContent: unit })
    for (const input of inputs) input.addEventListener('change', () => { edited = null; write() })
    made.control.addEventListener('wheel', event => {
      if (!event.ctrlKey) return
      event.preventDefault()
      put(latest.value - Math.sign(event.deltaY) * (latest.max - latest.min) / 50)
    }, { passive: false })
    return made
  }
  line(give) {
    const input = create('input', { type: 'text' })
    return labelled('field', [input], () => give(input.value), ({ value }) => { if (input !== document.activeElement) input.value = value })
  }
  file() {
    const input = create('input', { type: 'file' })
    return labelled('file', [input], () => this.open(input.files[0]), () => {})
  }

  // A file of this device.
  async open(file) {
    const { panel } = this
    if (!file || !document.body.dataset.screen) return
    if (file.size > MAX_FILE) return panel.say(`${file.name} is larger than 128 MB; copy it to the machine of the gloves, and open it by its name.`)
    panel.say(`Sending ${file.name} ...`)
    try {
      const answer = await fetch(`/open?token=${token}&name=${encodeURIComponent(file.name)}`, { method: 'POST', body: file })
      panel.say(answer.ok ? '' : await answer.text())
    } catch (error) {
      panel.say(`${file.name} was not taken.`)
    }
  }
}
