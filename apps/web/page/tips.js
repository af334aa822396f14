// Help of controls, the text of their aria-description: for the mouse over one, for one that has the focus
// by keys, and for a finger that is held on one. Also of those that are not possible now.
const HOLD = 500 // ms, for which a finger is still
const apart = (a, b) => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY) // pixels between two events
const element = id => document.getElementById(id)
const create = (kind, values = {}) => Object.assign(document.createElement(kind), values)
// A new element, the last one in its parent.
const make = (kind, parent, values) => parent.appendChild(create(kind, values))
const setText = (part, text) => { if (part.textContent !== text) part.textContent = text }
// A control's help; empty: it has none.
const explain = (control, help) => help ? control.setAttribute('aria-description', help) : control.removeAttribute('aria-description')

class Tips {
  constructor() {
    Object.assign(this, { timer: 0, at: null, isHeld: false, over: null, x: 0 }) // what the mouse is over, and its x
    const hear = (name, act) => document.addEventListener(name, act, true)
    hear('pointerover', event => event.pointerType === 'mouse' && this.show(this.over = event.target))
    hear('focusin', event => event.target.matches(':focus-visible') && this.show(event.target))
    hear('pointerdown', event => this.press(event))
    for (const end of ['pointerup', 'pointercancel']) hear(end, () => clearTimeout(this.timer))
    hear('pointermove', event => this.at && apart(event, this.at) > 10 && clearTimeout(this.timer))
    hear('pointermove', event => { this.x = event.clientX })
    hear('scroll', () => this.hide())
    hear('click', event => { // that ends the press whose help was shown
      if (!this.isHeld || event.detail === 0) return
      event.stopPropagation()
      event.preventDefault()
    })
    hear('contextmenu', event => event.target.closest('[aria-description]') && event.preventDefault())
  }
  press(event) {
    const { pointerType, target } = event
    this.hide()
    Object.assign(this, { isHeld: false, at: event, over: pointerType === 'mouse' ? target : null })
    if (pointerType !== 'mouse') this.timer = setTimeout(() => { this.isHeld = this.show(target) }, HOLD)
  }
  hide() { element('tip').hidden = true }
  // Beside the panel, or below or above the control, in a drawing at the mouse, within the window. Returns whether there is something to show.
  show(target) {
    const control = target.closest && target.closest('[aria-description]'), tip = element('tip')
    tip.hidden = !control
    if (!control) return false
    tip.textContent = control.getAttribute('aria-description')
    const { left, top, bottom } = control.getBoundingClientRect(), panel = control.closest('#panel, #form-edit'), gap = 8
    const x = panel ? panel.getBoundingClientRect().right + gap : control.matches('.drawing') ? this.x : left, lowest = innerHeight - tip.offsetHeight - gap
    const y = panel ? Math.min(top, lowest) : bottom + gap > lowest ? top - tip.offsetHeight - gap : bottom + gap
    tip.style.left = `${Math.max(gap, Math.min(x, innerWidth - tip.offsetWidth - gap))}px`
    tip.style.top = `${Math.max(gap, y)}px`
    return true
  }
}
