// Controls that the server describes (PROTOCOL.md, message 12), and those of settings: all are made here.
const MAX_FILE = 128 << 20 // bytes that the server takes
function labelled(base, parts) {
  const control = document.createElement('label'), words = make('span', control)
  control.className = base
  return { control, base, inputs: parts.map(([kind, values]) => make(kind, control, values)), label: name => setText(words, name) }
}

class Form {
  // fetchPicture: as Paint takes it.
  constructor(ask, fetchPicture, say) {
    Object.assign(this, { ask, fetchPicture, say, parts: new Map(), pictures: new Map() })
    document.addEventListener('dragover', event => event.preventDefault())
    document.addEventListener('drop', event => {
      event.preventDefault()
      this.open(event.dataTransfer.files[0])
    })
  }
  take({ screen, parts }) {
    document.body.dataset.screen = screen
    for (const [name, { section }] of this.parts) section.hidden = !parts.some(part => part.name === name)
    for (const { name, controls } of parts) this.fill(this.partNamed(name), controls)
  }
  partNamed(name) {
    if (!this.parts.has(name)) this.parts.set(name, { section: make('section', document.body, { id: 'form-' + name, className: 'form' }), shown: [] })
    return this.parts.get(name)
  }
  // What is as before stays, with its focus.
  fill({ section, shown }, controls) {
    controls.forEach((wanted, at) => {
      const now = shown[at], text = JSON.stringify(wanted)
      if (now && now.text === text) return
      const stays = now && now.kind === wanted.kind && now.id === wanted.id
      const made = stays ? now : { kind: wanted.kind, id: wanted.id, ...this[wanted.kind](value => this.ask(`form\t${wanted.id}\t${value}`), wanted) }
      if (!now) section.append(made.control)
      else if (!stays) now.control.replaceWith(made.control)
      made.control.setAttribute('data-control', wanted.name)
      if (wanted.help) made.control.setAttribute('aria-description', wanted.help)
      if (wanted.share) made.control.style.setProperty('--share', wanted.share)
      made.control.className = [made.base, wanted.look, wanted.share === 0 ? 'flows' : ''].join(' ')
      made.show(wanted)
      shown[at] = Object.assign(made, { text })
    })
    for (const { control } of shown.splice(controls.length)) control.remove()
  }

  // Each makes a control, whose base is its class, and which calls back with a new value.
  text() {
    const control = document.createElement('p')
    return { control, base: '', show: ({ name }) => setText(control, name) }
  }
  title(_, { note }) {
    const control = document.createElement('h2'), words = make('span', control)
    make('small', control, { textContent: note })
    return { control, base: '', show: ({ name }) => setText(words, name) }
  }
  key(_, { colour }) {
    const control = document.createElement('p'), disc = make('i', control), words = make('span', control)
    disc.style.background = `rgb(${colour.map(part => Math.round(255 * part ** (1 / 2.2)))})`
    return { control, base: '', show: ({ name }) => setText(words, name) }
  }
  ring() {
    const control = document.createElement('div')
    return { control, base: 'ring', show: ({ value }) => control.style.setProperty('--part', value + '%') }
  }
  separator() { return { control: document.createElement('hr'), base: '', show() {} } }
  button(give, { picture }) {
    const control = document.createElement('button'), canvas = picture === undefined ? null : make('canvas', control, { width: 264, height: 198 })
    const words = make('span', control)
    control.addEventListener('click', () => give(''))
    return { control, base: canvas ? 'card' : '', show: ({ name, look, picture }) => {
      setText(words, name)
      control.setAttribute('aria-disabled', look === 'grey')
      if (canvas && picture !== null) this.paint(canvas, picture)
    } }
  }
  async paint(canvas, number) {
    if (!this.pictures.has(number)) this.pictures.set(number, this.fetchPicture(number).then(blob => blob && createImageBitmap(blob)))
    const image = await this.pictures.get(number)
    if (image) return canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height)
    this.pictures.delete(number) // the message was faster
    setTimeout(() => this.paint(canvas, number), 200)
  }
  check(give) {
    const { inputs: [input], label, ...made } = labelled('box', [['input', { type: 'checkbox' }]])
    input.addEventListener('input', () => give(input.checked))
    return { ...made, show: ({ name, value }) => { label(name); input.checked = value } }
  }
  choice(give, { choices }) {
    const { inputs: [input], label, ...made } = labelled('field', [['select', {}]])
    input.append(...choices.map(choice => new Option(choice)))
    input.addEventListener('input', () => give(input.value))
    return { ...made, show: ({ name, value, choices }) => {
      label(name)
      choices.forEach((choice, at) => setText(input.options[at], choice))
      input.value = value
    } }
  }
  // A slider and a field; with Ctrl, the wheel changes it as well.
  number(give, { min, max, unit, step = 'any' }) {
    const { inputs, label, ...made } = labelled('field', ['range', 'number'].map(type => ['input', { type, min, max, step }]))
    const put = value => give(Math.min(max, Math.max(min, Number(value))))
    make('span', made.control, { className: 'unit', textContent: unit })
    for (const input of inputs) input.addEventListener('input', () => put(input.value))
    made.control.addEventListener('wheel', event => {
      if (!event.ctrlKey) return
      event.preventDefault()
      put(Number(inputs[0].value) - Math.sign(event.deltaY) * (max - min) / 50)
    }, { passive: false })
    return { ...made, show: ({ name, value }) => {
      label(name)
      inputs[1].ariaLabel = name
      for (const input of inputs) if (!input.matches(input.type === 'range' ? ':active' : ':focus')) input.value = typeof value === 'number' ? Math.round(10 * value) / 10 : value
    } }
  }
  line(give) {
    const { inputs: [input], label, ...made } = labelled('field', [['input', { type: 'text' }]])
    input.addEventListener('input', () => give(input.value))
    return { ...made, show: ({ name, value }) => { label(name); if (input !== document.activeElement) input.value = value } }
  }
  file() {
    const { inputs: [input], label, ...made } = labelled('file', [['input', { type: 'file' }]])
    input.addEventListener('change', () => this.open(input.files[0]))
    return { ...made, show: ({ name }) => label(name) }
  }

  // A file of this device.
  async open(file) {
    if (!file || !document.body.dataset.screen) return
    if (file.size > MAX_FILE) return this.say(`${file.name} is larger than 128 MB; copy it to the machine of the gloves, and open it by its name.`)
    this.say(`Sending ${file.name} ...`)
    try {
      const answer = await fetch(`/open?token=${token}&name=${encodeURIComponent(file.name)}`, { method: 'POST', body: file })
      this.say(answer.ok ? '' : await answer.text())
    } catch (error) {
      this.say(`${file.name} was not taken.`)
    }
  }
}
