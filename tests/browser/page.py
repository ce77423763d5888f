#!/usr/bin/env python3
"""page.py PAGE [THIMBLE]: tries the page in chromium without a window: it drags the needle as a visitor does.

THIMBLE, where it is there, is the native program that has to write the same bytes. Exit code 0: all is as it should be; 1: the lines
that say "not ok" say why; 77: a program is missing, which the last line names. Times are printed, and judge nothing."""

import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

SIZES = {"phone": (390, 844), "laptop": (1280, 800), "large": (1920, 1080)}
FRAMES = "let done = arguments[0], n = 0, t0 = performance.now(); (function f() { n++; const t = performance.now() - t0; t > 1500 ? done(n / t * 1000) : requestAnimationFrame(f); })();"
SEEDS = range(1, 1 + int(os.environ.get("THIMBLE_PAGE_SEEDS", "5")))
failed = []


def expect(fact, words):
    print("ok" if fact else "not ok", "-", words, flush=True)
    if not fact:
        failed.append(words)


def skip(words):
    print(words)
    sys.exit(77)


def start(webdriver, service):
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for word in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars"):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=service(shutil.which("chromedriver")), options=options)


class Visitor:
    def __init__(self, driver, page):
        self.driver, self.page = driver, page

    def open(self, size):
        # about:blank first: the same address again would not load anew.
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size[0] < 500})
        self.driver.get("about:blank")
        begin = time.monotonic()
        self.driver.get(self.page.as_uri())
        while not self.driver.execute_script("return window.page !== undefined && page.state !== undefined"):
            if time.monotonic() - begin > 60:
                raise SystemExit(f"the page does not start: {self.driver.find_element('id', 'failed').text}")
            time.sleep(0.05)
        return time.monotonic() - begin

    def choose(self, modality):
        self.driver.execute_script(f"document.getElementById('modalities').children[{modality}].click()")

    def drag(self, depth_mm, hold_s, picture=None, hold=False):
        """Presses, drags the needle to that depth in about a second, and holds the virtual clock's seconds long."""
        from selenium.webdriver.common.action_chains import ActionChains

        grip = self.driver.find_element("css selector", ".grip")
        self.driver.execute_script("arguments[0].scrollIntoView()", grip)
        height = grip.size["height"]
        per_mm = self.driver.execute_script(f"return page.engine.pixelsPerMetre({height})") / 1000
        steps = 12
        actions = ActionChains(self.driver, duration=40).move_to_element_with_offset(grip, 0, int(-height * 0.4)).click_and_hold()
        for i in range(steps):
            actions.move_by_offset(0, round(depth_mm * per_mm * (i + 1) / steps) - round(depth_mm * per_mm * i / steps))
        actions.perform()
        self.wait(hold_s)
        state = self.state()
        if picture:
            self.driver.execute_script("scrollTo(0, 0)")
            self.driver.save_screenshot(picture)
        if not hold:
            self.release()
        return state

    def release(self):
        from selenium.webdriver.common.action_chains import ActionChains

        ActionChains(self.driver).release().perform()

    def wait(self, virtual_s):
        """Of the page's own time, which is slow where there is no graphics card."""
        wanted = self.state()["time_s"] + virtual_s
        end = time.monotonic() + 120
        while self.state()["time_s"] < wanted and time.monotonic() < end:
            time.sleep(0.1)

    def state(self):
        return self.driver.execute_script("return page.state")

    def digest(self, seed):
        return self.driver.execute_async_script(f"const done = arguments[0]; page.engine.digest({seed}).then(done, (e) => done(String(e)))")


def native_digest(thimble, seed):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "study"
        subprocess.run([thimble, "study", "--experiment", "3", "--subjects", "1", "--no-control", "--seed", str(seed), "--out", out],
                       check=True, capture_output=True)
        return hashlib.sha256((out / "trials.csv").read_bytes()).hexdigest()


def try_hands(visitor):
    # 130 mm: some 10 to 20 mm beyond any wall, which a hand overshoots when nothing stops it.
    hand = visitor.drag(130, 4, "docs/pictures/browser.png" if os.environ.get("THIMBLE_WRITE_PICTURES") else None)
    expect(hand["contacts_lost"] >= 3 and hand["frequency_Hz"] >= 1, f"force in the hand shakes ({hand['contacts_lost']:.0f} contacts lost)")
    expect(hand["energy_in_J"] < 0, "its loop gives out energy")
    visitor.choose(1)
    finger = visitor.drag(130, 4)
    expect(finger["contacts_lost"] == 0 and finger["hold_s"] > 2, "force on the fingertip does not")
    visitor.choose(3)
    seen = visitor.drag(130, 2)
    labels = visitor.driver.execute_script("return page.engine.labels(0).map((l) => l.text)")
    expect(seen["force_bar_N"] > 1 and "12 N" in labels, "as a bar: the bar is drawn, and grows")
    visitor.choose(0)
    shoved = visitor.drag(180, 5)
    expect(shoved["frequency_Hz"] >= 1, f"shoving does not cure it ({shoved['frequency_Hz']:.1f} per second)")


def try_keys(visitor):
    from selenium.webdriver.common.keys import Keys

    visitor.choose(1)
    grip = visitor.driver.find_element("css selector", ".grip")
    grip.send_keys(Keys.ARROW_DOWN)  # down and up at once: the hand takes hold
    visitor.driver.execute_script("page.key({preventDefault() {}}, 1)")
    visitor.wait(1)
    visitor.driver.execute_script("page.hand.key = 0")
    expect(visitor.state()["needle_m"] > 0.01, "the arrow keys push")


def try_fingers(visitor):
    visitor.drag(50, 0.2, hold=True)
    moved, held = visitor.driver.execute_script(
        "const grip = document.querySelector('.grip'), before = page.hand.position;"
        "for (const kind of ['pointermove', 'pointerup']) grip.dispatchEvent(new PointerEvent(kind, { pointerId: 99, clientY: 9999 }));"
        "return [page.hand.position - before, page.hand.engaged]")
    visitor.release()
    expect(moved == 0 and held, "a second finger neither moves the hand nor lets go")


def try_sound(visitor):
    sound = visitor.driver.find_element("id", "sound")
    visitor.driver.execute_script("arguments[0].scrollIntoView()", sound)
    sound.click()
    expect(visitor.driver.execute_script("return page.audio !== undefined"), "the sound is there before anything is pressed")
    sound.click()


def try_network(visitor):
    choose = "const n = document.getElementById('network'); n.value = arguments[0]; n.dispatchEvent(new Event('change')); return document.getElementById('delay-text').textContent"
    shown = [visitor.driver.execute_script(choose, name) for name in ("geo", "")]
    expect(shown == ["300 ms", "50 ms"], f"the delay is the network's {shown}")


# A trial in VF whose wall vanishes.
RECORDED = """time_s,position_needle_m,position_surface_m,force_tissue_N,force_fixture_N,force_total_N,contact_time_s,tissue_phase,fixture_present
0,0,0.02,0,0,0,0,free,1
0.5,0.11,0.02,-1,-5,-6,0.1,penetrated,1
1,0.12,0.02,-1,0,-1,0,penetrated,0
"""


def try_replay(visitor):
    visitor.driver.execute_async_script(
        "const done = arguments[1]; page.replay.open(new File([arguments[0]], 'trial01_VF_50ms.csv')).then(() => { page.replay.playing = false; done(); })", RECORDED)
    labels = "return page.engine.labels(3).map((l) => l.text)"
    show = "page.replay.time = arguments[0]; page.replay.show(); " + labels
    touching, gone = (visitor.driver.execute_script(show, time_s) for time_s in (0.5, 1))
    expect("90 mm deep" in touching and "12 N" in touching, f"a recorded trial: depth from the skin, and the bar {touching}")
    expect("virtual wall" in touching and "virtual wall" not in gone, "its wall vanishes")
    visitor.driver.execute_script(show, 0.5)
    unseen = visitor.driver.execute_script("document.getElementById('wall').click(); " + labels)
    visitor.driver.execute_script("document.getElementById('wall').click()")
    expect("virtual wall" not in unseen, "a resting one is drawn anew")
    visitor.driver.execute_script("page.replay.rows = []; document.getElementById('replay').hidden = true")


def try_lost_context(visitor):
    """The WebGL context goes and comes back, as after sleep or a new graphics driver."""
    before, after = visitor.driver.execute_async_script(
        "const done = arguments[0], view = page.views[1], gl = view.gl, context = gl.getExtension('WEBGL_lose_context');"
        "const corner = () => { const pixel = new Uint8Array(4); view.draw(true); gl.readPixels(10, 10, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); return [...pixel]; };"
        "const before = corner();"
        "view.solid.addEventListener('webglcontextlost', () => setTimeout(() => context.restoreContext()), { once: true });"
        "view.solid.addEventListener('webglcontextrestored', () => done([before, corner()]), { once: true });"
        "context.loseContext();")
    expect(before == after and after[3] > 0, f"pictures come back after a lost context {after}")


PAD = """window.motors = [];
const pad = {buttons: [{pressed: false}], axes: [0, 0], vibrationActuator: {playEffect(kind, levels) { motors.push(levels); return Promise.resolve(); }}};
navigator.getGamepads = () => [pad];"""


def try_gamepad(visitor):
    strongest = "return Math.max(0, ...motors.splice(0).map((m) => m.strongMagnitude))"
    visitor.driver.execute_script(PAD)
    for modality, name in ((1, "force on the fingertip"), (0, "force in the hand")):
        visitor.choose(modality)
        visitor.wait(0.2)
        visitor.driver.execute_script("motors.length = 0")
        visitor.drag(130, 1.5)
        strong = visitor.driver.execute_script(strongest)
        expect(strong > 0.2 if modality == 1 else strong == 0, f"{name}: a gamepad's motor goes up to {strong:.2f}")
    visitor.choose(1)
    visitor.driver.execute_script("const pad = navigator.getGamepads()[0]; pad.buttons[0].pressed = true; pad.axes[1] = 1")
    visitor.wait(0.5)
    pushed = visitor.state()["needle_m"]
    visitor.driver.execute_script("navigator.getGamepads = () => []")
    expect(pushed > 0.02, f"A held and the stick down push the needle ({1000 * pushed:.0f} mm)")


SHOWN = "return +document.querySelector('.grip').getAttribute('aria-valuenow')"


def try_calm(visitor):
    """Who asked for reduced motion sees the needle at rest while it shakes."""
    swing = {}
    for feature in ("no-preference", "reduce"):
        visitor.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-reduced-motion", "value": feature}]})
        visitor.choose(0)
        visitor.drag(130, 2, hold=True)
        visitor.wait(1.5)
        depths = []
        for _ in range(25):
            depths.append(visitor.driver.execute_script(SHOWN))
            visitor.wait(0.03)
        visitor.release()
        swing[feature] = max(depths) - min(depths)
    visitor.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    expect(swing["reduce"] < swing["no-preference"] / 2, f"reduced motion: the drawn needle swings by {swing['reduce']} mm, not {swing['no-preference']}")


def try_sizes(visitor):
    for name, size in SIZES.items():
        started = visitor.open(size)
        width = visitor.driver.execute_script("return document.documentElement.scrollWidth")
        expect(width <= size[0], f"{name}: nothing is wider than the screen ({width} of {size[0]})")
        fps = visitor.driver.execute_async_script(FRAMES)
        print(f"     {name} {size[0]}x{size[1]}: first needle after {started:.2f} s, {fps:.0f} frames per second with software GL", flush=True)


def try_words(visitor):
    visitor.driver.execute_script("const l = document.getElementById('language'); l.value = 'it'; l.dispatchEvent(new Event('change'))")
    expect("ago" in visitor.driver.find_element("tag name", "h2").text, "it speaks Italian")
    empty = visitor.driver.execute_script("return [...document.querySelectorAll('[data-words]')].filter((e) => e.textContent === '' || e.textContent === 'undefined').map((e) => e.dataset.words)")
    expect(not empty, f"each text has words {empty}")
    visitor.driver.execute_script("document.getElementById('virtual').click()")
    texts = set(visitor.driver.execute_script("return page.engine.networks().map((n) => n[1])"))
    for modality in range(4):
        visitor.choose(modality)
        visitor.wait(6)
        texts |= set(visitor.driver.execute_script("return page.engine.labels(0).map((l) => l.text)"))
    visitor.driver.execute_script("document.getElementById('virtual').click()")
    english = visitor.driver.execute_script(
        "return arguments[0].filter((t) => /[a-z]{3}/i.test(t) && !(t.replace(/\\d+(\\.\\d+)?/g, '#') in FROM_CPP.it))", sorted(texts))
    expect(not english, f"so have the texts of the picture and the networks {english}")


def try_accessibility(visitor):
    axe = visitor.page.parent / "axe.js"
    if not axe.exists():
        print("     accessibility not tried: npm could not fetch axe-core")
        return
    visitor.driver.execute_script(axe.read_text())
    result = visitor.driver.execute_async_script("const done = arguments[0]; axe.run().then((r) => done(r.violations.map((v) => v.id + ': ' + v.nodes.length)))")
    expect(not result, f"axe-core finds no error {result}")


def try_bytes(visitor, thimble):
    for seed in SEEDS:
        digest = visitor.digest(seed)
        expect(digest == native_digest(thimble, seed), f"seed {seed}: the native program's bytes ({digest[:12]})")
    command = [shutil.which("chromium"), "--headless", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu", "--virtual-time-budget=1000", "--dump-dom",
               visitor.page.as_uri() + "#check=1"]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False).stdout
    found = dom.partition('<pre id="check">')[2].partition("</pre>")[0]
    expect(bool(found) and json.loads(found)["sha256"] == native_digest(thimble, 1), "#check=1 leaves the same digest")


def try_log(driver):
    errors = [entry["message"] for entry in driver.get_log("browser") if entry["level"] == "SEVERE"]
    expect(not errors, f"no error on the console {errors}")
    addresses = []
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            addresses.append(message["params"]["request"]["url"].split("?")[0])
    out = [a for a in addresses if not a.startswith(("file:", "about:", "data:", "blob:"))]
    expect(not out, f"no request to anywhere {out}")


def main(page, thimble):
    if not page.exists():
        skip("no page: deploy/browser makes it, and installs what it needs")
    if shutil.which("chromium") is None or shutil.which("chromedriver") is None:
        skip("no browser: it needs package chromium and package chromium-driver")
    try:
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service
    except ImportError:
        skip("no way to steer the browser: it needs package python3-selenium")
    size = page.stat().st_size
    expect(size <= 2_000_000, f"one file of {size / 1e6:.2f} MB")
    driver = start(webdriver, Service)
    try:
        driver.set_script_timeout(120)
        visitor = Visitor(driver, page)
        try_sizes(visitor)
        visitor.open(SIZES["laptop"])
        try_hands(visitor)
        try_keys(visitor)
        try_fingers(visitor)
        try_sound(visitor)
        try_network(visitor)
        try_replay(visitor)
        try_lost_context(visitor)
        try_gamepad(visitor)
        try_calm(visitor)
        if thimble is not None:
            try_bytes(visitor, thimble)
        try_words(visitor)
        try_accessibility(visitor)
        try_log(driver)
    finally:
        driver.quit()
    return 1 if failed else 0


if __name__ == "__main__":
    native = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve(), native if native and native.exists() else None))
