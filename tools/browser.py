"""Chromium with a page of `nendo run --web`, driven by the DevTools protocol over a pipe; for tools/check-browser and
tools/check-page. Needs chromium (tools/setup browser)."""
import base64
import json
import os
import re
import shutil
import subprocess
import sys
import time
import urllib.error
import urllib.request

PATIENCE_S = 30
UPDATE = 2  # the message
CTRL, SHIFT = 2, 8
KEYS = {"Escape": 27, "Enter": 13, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "End": 35, "Home": 36, "Delete": 46, "F3": 114, "Tab": 9}


# What tools ask the page for: `nendo` in its window, after the page's own script. It counts what has come.
PROBE = """addEventListener('DOMContentLoaded', () => {
    if (typeof panel === 'undefined') return
    const counts = { updates: 0, shapes: 0, weights: 0, bakes: 0, draws: 0 }
    const count = (owner, name, add) => {
        const own = owner[name]
        owner[name] = function (...given) { add(...given); return own.apply(this, given) }
    }
    count(window, 'takeUpdate', () => { counts.updates += 1 })
    count(window, 'takeShape', () => { counts.shapes += 1 })
    count(Shape.prototype, 'takeWeights', () => { counts.weights += 1 })
    count(Shape.prototype, 'takeStep', step => { counts[step.bakes ? 'bakes' : 'draws'] += step.count })
    window.nendo = {
        ask, counts,
        control: id => form.all().map(({ wanted }) => wanted).find(wanted => wanted.id === id), // as the server describes it
        vertices: () => Array.from(scene.shape.vertices()),
        state: () => latest && { number: Number(latest.number), held: latest.held, restChanges: latest.restChanges, jumps: latest.jumps,
            ticks: latest.ticks, loop: panel.model.loop, ...run,
            wrists: latest.hands.map(hand => hand && { ...hand.joints[1], turn: hand.forearm, pixel: scene && scene.pixelOf(hand.joints[1].place) }),
            open: isOpen(), shape: Boolean(scene) && scene.shape.number !== null },
    }
})"""


def way(start, end, steps=10):
    for step in range(1, steps + 1):
        time.sleep(0.02)
        yield [a + (b - a) * step / steps for a, b in zip(start, end)]


class Browser:
    """Chromium with one page, which is told what to do over descriptors 3 and 4."""

    def __init__(self, folder, *more):
        to_browser, from_browser = os.pipe(), os.pipe()
        binary = shutil.which("chromium") or sys.exit("no chromium; run tools/setup browser")

        def hand_over():
            ends = [os.dup(to_browser[0]), os.dup(from_browser[1])]
            for place, end in zip((3, 4), ends):
                os.dup2(end, place)

        self.process = subprocess.Popen(
            [binary, "--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", "--no-first-run", "--disable-extensions", "--window-size=1280,800",
             f"--user-data-dir={folder}", *more, "about:blank"],
            preexec_fn=hand_over, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser[0])
        os.close(from_browser[1])
        self.out, self.into = os.fdopen(to_browser[1], "wb", 0), os.fdopen(from_browser[0], "rb")
        self.number, self.session, self.complaints, self.waiting, self.updates = 0, None, [], b"", []
        self.received = {}  # bytes by the type of message
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Runtime", "Log", "Page", "Network"):
            self.ask(domain + ".enable")
        self.ask("Page.addScriptToEvaluateOnNewDocument", source=PROBE)
        self.screen(1280, 800)

    def message(self):
        while b"\0" not in self.waiting:
            piece = self.into.read1(1 << 20)
            if not piece:
                raise RuntimeError("chromium has ended")
            self.waiting += piece
        line, self.waiting = self.waiting.split(b"\0", 1)
        return json.loads(line)

    def ask(self, method, **params):
        self.number += 1
        order = {"id": self.number, "method": method, "params": params}
        if self.session:
            order["sessionId"] = self.session
        self.out.write(json.dumps(order).encode() + b"\0")
        while True:
            told = self.message()
            if told.get("id") == self.number:
                if "error" in told:
                    raise RuntimeError(f"{method}: {told['error']['message']}")
                return told["result"]
            self.hear(told.get("method"), told.get("params"))

    def hear(self, event, params):
        if event == "Runtime.exceptionThrown":
            self.complaints.append(params["exceptionDetails"].get("exception", {}).get("description", "?"))
        if event == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.complaints.append(params["entry"]["text"])
        if event == "Network.webSocketFrameReceived" and params["response"]["opcode"] == 2:
            payload = params["response"]["payloadData"]
            size, kind = len(payload) * 3 // 4 - payload[-2:].count("="), base64.b64decode(payload[:4])[0]
            self.received[kind] = self.received.get(kind, 0) + size
            if kind == UPDATE:
                self.updates.append(size)

    def value(self, expression):
        told = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in told:
            raise RuntimeError(told["exceptionDetails"].get("exception", {}).get("description", expression))
        return told["result"].get("value")

    def wait(self, expression):
        end = time.monotonic() + PATIENCE_S
        while not self.value(expression):
            if time.monotonic() > end:
                raise RuntimeError(f"never true: {expression}; the page says: {self.value('document.body.innerText')} "
                                   f"{self.complaints}")
            time.sleep(0.1)

    # Real events, at the rectangles of elements.
    def middle(self, selector):
        """The middle of an element, which is scrolled to if need be. Nothing may be over it."""
        at = self.value(f"""(() => {{
            const part = document.querySelector({json.dumps(selector)})
            part.scrollIntoView({{ block: 'center' }})
            const box = part.getBoundingClientRect(), at = [box.x + box.width / 2, box.y + box.height / 2]
            const top = document.elementFromPoint(...at)
            return top && (part.contains(top) || top.contains(part)) ? at : `${{top && top.outerHTML.slice(0, 200)}} at ${{at}}` }})()""")
        if isinstance(at, str):
            raise RuntimeError(f"over {selector} is {at}")
        return at

    def click(self, selector, times=1):
        at = self.middle(selector)
        self.mouse("mouseMoved", at)
        for count in range(1, times + 1):
            self.mouse("mousePressed", at, button="left", buttons=1, clickCount=count)
            self.mouse("mouseReleased", at, button="left", buttons=0, clickCount=count)

    def press(self, command):
        self.click(f'[data-request="{command}"]')

    def choose_file(self, selector, path):
        found = self.ask("Runtime.evaluate", expression=f"document.querySelector({json.dumps(selector)})")["result"]["objectId"]
        self.ask("DOM.setFileInputFiles", files=[str(path)], objectId=found)

    def mouse(self, kind, at, **more):
        self.ask("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], **more)

    def drag(self, start, end, button="right", **more):
        buttons = {"left": 1, "right": 2}[button]
        self.mouse("mouseMoved", start)
        self.mouse("mousePressed", start, button=button, buttons=buttons, clickCount=1, **more)
        for at in way(start, end):
            self.mouse("mouseMoved", at, button=button, buttons=buttons, **more)
        self.mouse("mouseReleased", end, button=button, buttons=0, clickCount=1, **more)

    def touch(self, kind, *points):
        self.ask("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": n} for n, (x, y) in enumerate(points)])

    def tap(self, selector, hold_until="true"):
        self.touch("touchStart", self.middle(selector))
        self.wait(hold_until)
        self.touch("touchEnd")

    def swipe(self, *fingers, hold_until="true"):
        """Of each finger: from where to where."""
        self.touch("touchStart", *[start for start, _ in fingers])
        self.wait(hold_until)
        for places in zip(*[way(*finger) for finger in fingers]):
            self.touch("touchMove", *places)
        self.touch("touchEnd")

    def key(self, key, modifiers=0):
        more = {"windowsVirtualKeyCode": KEYS[key]} if key in KEYS else {"text": key} if not modifiers else {}
        self.ask("Input.dispatchKeyEvent", type="keyDown", key=key, modifiers=modifiers, **more)
        self.ask("Input.dispatchKeyEvent", type="keyUp", key=key, modifiers=modifiers)

    def write(self, text):
        for letter in text:
            self.key(letter)

    def screen(self, width, height, is_tablet=False):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=is_tablet)
        self.ask("Emulation.setTouchEmulationEnabled", enabled=is_tablet, maxTouchPoints=2)

    def picture(self, path):
        path.write_bytes(base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"]))

    def end(self):
        self.process.terminate()
        self.process.wait()


def check(law, words):
    print(f"  {'fine' if law else 'WRONG'}: {words}", flush=True)
    if not law:
        raise SystemExit(f"{sys.argv[0]}: {words}")


def begin(nendo, *options, glove="sim:sculpt?seed=7"):
    return begin_any(nendo, "run", "--left", glove, "--right", glove, *options)


def begin_any(*command, **more):
    """A command that serves the page. Returns the program, and the page's address."""
    program = subprocess.Popen(
        [*command, "--web", "0"],
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, **more)
    line = program.stderr.readline()
    url = re.search(r"http://\S+", line) or sys.exit(f"no address in: {line}")
    wait_for_model(url[0].replace("/#", "/model?token="))
    return program, url[0]


def wait_for_model(address):
    """Until the loop has begun: the page would ask for the model again, and Chromium would report each 503."""
    end = time.monotonic() + PATIENCE_S
    while True:
        try:
            return urllib.request.urlopen(address, timeout=PATIENCE_S).close()
        except urllib.error.HTTPError as error:
            if error.code != 503 or time.monotonic() > end:
                raise
        time.sleep(0.05)


def end(program):
    program.terminate()
    program.communicate(timeout=PATIENCE_S)


def complaints(browser):
    """But for the connection, which the end of the run takes away."""
    return [words for words in browser.complaints if not any(known in words for known in ("ERR_CONNECTION", "WebSocket"))]
