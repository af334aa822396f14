// Comes, looks, and comes again when the connection is lost.
const token = location.hash.slice(1)
const holds = new Holds()
let socket = null, latest = null, patience = 500, dirty = true, scene = null, trouble = '', seen = '', sentAt = 0
const due = new Map() // requests that wait for the next picture, by their controls
const arrived = new Map() // forms that are shown with the next picture, the newest of each kind
const SERVICE_RESTART = 1012
const BETWEEN_SENDS = 15 // ms, because the server closes a client that sends more than 128 messages per second

const shown = { hands: true, bones: false, vectors: true, radii: false, contact: false, facets: false }
const run = { settings: { radius_m: [] }, puppet: null, contacts: [], wire: [] } // as the server has described it
const panel = new Panel(ask, shown, fetchImage), { form } = panel
try {
  scene = new Scene(element('scene'), shown, run)
} catch (error) {
  trouble = `No picture: ${error.message}. Figures and buttons work all the same.`
  panel.say(trouble)
}
const tips = new Tips()
const camera = new Camera(element('scene'), () => { dirty = true })
panel.camera = camera
const mover = new HandMover(element('scene'), camera, () => scene && scene.shape && latest &&
  { hands: latest.hands, origin: scene.origin, pixelOf: place => scene.pixelOf(place) }, ask)
panel.painter = new MaskPainter(element('scene'), () => ({ scene, model: panel.model, puppet: run.puppet, camera }), ask)

// A form is of another screen than the run.
const isShaping = () => (document.body.dataset.screen || 'shaping') === 'shaping'
// of: a control, of which only the newest request is sent, with the next picture; null: the request is sent at once.
function ask(request, of = null) {
  if (!isOpen() || (!isShaping() && !request.startsWith('form\t'))) return
  due.delete(of)
  due.set(of, request)
  if (of === null) sendAll()
}
function sendAll() {
  for (const request of due.values()) socket.send(request)
  due.clear()
  sentAt = performance.now()
}
const isOpen = () => socket !== null && socket.readyState === WebSocket.OPEN

function again(why) {
  panel.connected(false, `${why} Trying again.`)
  setTimeout(connect, patience)
  patience = Math.min(5000, 1.6 * patience)
}

async function connect() {
  let model
  try {
    const answer = await fetch('/model?token=' + token)
    if (answer.status === 403) return panel.say('This address has no token, or an old one: open the whole address that nendo printed.')
    if (!answer.ok) return again((await answer.text()).trim() + '.')
    model = readModel(await answer.arrayBuffer())
  } catch (error) {
    return again('No answer from nendo; has the run ended?')
  }
  if (panel.model && panel.model.name !== model.name) [latest, seen] = [null, ''] // the picture shows all of it
  panel.setModel(model)
  holds.begin()
  if (scene) {
    scene.setModel(model, fetchImage, () => { dirty = true })
    if (!scene.skins) fetchSkin()
  }
  open(model)
}

async function fetchSkin() {
  const answer = await fetch('/skin?token=' + token)
  if (answer.ok) scene.setSkin(readSkin(await answer.arrayBuffer()))
  dirty = true
}

// Null: there is none, or it is damaged. What is transparent becomes black.
async function fetchImage(number) {
  try {
    const answer = await fetch(`/picture?token=${token}&number=${number}`)
    return answer.ok ? await createImageBitmap(await answer.blob(), { premultiplyAlpha: 'premultiply', colorSpaceConversion: 'none' }) : null
  } catch (error) {
    return null
  }
}

function open(model) {
  let stale = false // the shape is another loop's than the model
  socket = new WebSocket(`ws://${location.host}/ws?token=${token}`)
  socket.binaryType = 'arraybuffer'
  socket.onopen = () => {
    panel.connected(true, trouble)
    patience = 500
  }
  socket.onmessage = ({ data }) => {
    if (stale) return
    const [type, more] = new Uint8Array(data, 0, 2)
    if (type === 1) stale = !takeShape(readShape(data), model)
    else if (type === 2) takeUpdate(readUpdate(data, model), model)
    else if (type === 3) panel.report(textIn(data), more === 1)
    else if (type === 4) run.settings = readSettings(data)
    else if (type === 6) scene?.shape.takeWeights(readWeights(data))
    else if (type === 7) takePuppet(readPuppet(data), model)
    else if (type === 8) run.contacts = readContacts(data)
    else if (type === 9) panel.refusals = readRefusals(data)
    else if (type === 11) run.wire = readWire(data)
    else if (type === 12) arrived.set(more, data)
    else if (type === 13) takeFigures(JSON.parse(textIn(data)))
    if (stale) socket.close()
    dirty = true
  }
  // A loop that takes the place of another waits with its model already.
  socket.onclose = ({ code }) => {
    due.clear()
    if (stale || code === SERVICE_RESTART) connect()
    else again('The connection is lost.')
  }
}

function takeFigures(figures) {
  if (!scene) return
  scene.figures = figuresOf(figures, scene)
  const { view } = figures, text = JSON.stringify(view)
  if (!view || text === seen) return
  seen = text
  camera.see(view)
  camera.look(view.azimuth * Math.PI / 180, view.elevation * Math.PI / 180)
}

function takePuppet(puppet, model) {
  run.puppet = puppet
  if (scene) scene.shape.setHeld(heldBy(puppet, model))
}

function takeShape(shape, model) {
  if (shape.loop === model.loop && scene) scene.shape.takeShape(shape)
  return shape.loop === model.loop
}

function takeUpdate(update, { rate }) {
  if (!latest && scene) camera.see(scene.boxWith(update.hands))
  latest = update
  holds.follow(update)
  CHARTS.late.add(update.maxLate / 1000)
  CHARTS.uneven.add(Math.abs(update.sinceLast / 1000 - 1000 / rate))
  setText(element('unseen'), update.unseen > 0 ? `${update.unseen} frames not shown` : '')
  if (!scene || scene.shape.number === null) return
  for (const step of update.steps) scene.shape.takeStep(step)
  scene.shape.number = update.number
}

function picture() {
  requestAnimationFrame(picture)
  if (due.size > 0 && performance.now() - sentAt >= BETWEEN_SENDS) sendAll()
  if (!dirty) return
  dirty = false
  for (const [kind, data] of arrived) form.take(kind, JSON.parse(textIn(data)))
  arrived.clear()
  const begin = performance.now()
  camera.covered = panel.covered()
  if (scene) scene.draw(camera, latest, holds)
  CHARTS.picture.add(performance.now() - begin)
  if (latest) form.drawCharts(latest.hands)
}

addEventListener('resize', () => { dirty = true })
addEventListener('hashchange', () => location.reload())
element('scene').addEventListener('webglcontextlost', () => {
  trouble = 'The graphics card has been taken away.'
  scene = null
  panel.say(trouble + ' Reload the page.')
})
connect()
picture()
