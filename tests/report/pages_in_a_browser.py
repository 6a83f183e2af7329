"""Pages of the program in a browser: what they show and how they answer to pointer, touch and keys.

usage: pages_in_a_browser.py KLUFT WORK_DIRECTORY
"""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NOT_INSTALLED = 77
PHONE = {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}
sys.dont_write_bytecode = True
sys.path.append(str(ROOT / "validation/suite"))

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys
except ImportError:
    BROWSER = None
if not BROWSER or not DRIVER:
    print("skipped: chromium, chromium-driver and python3-selenium are not installed")
    sys.exit(NOT_INSTALLED)

from fields import data_arrays  # noqa: E402

DRAWN = "return document.getElementById('body').dataset.drawn"


def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1280,1000"):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


def until(condition, what, seconds=20):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.05)
    raise AssertionError(f"expected {what}, found it not within {seconds} s")


class Page:
    def __init__(self, driver, path):
        self.driver = driver
        driver.get(path.resolve().as_uri())
        until(lambda: driver.execute_script("return document.documentElement.dataset.ready"), f"{path} to be ready")

    def script(self, text, *words):
        return self.driver.execute_script(text, *words)

    def part(self, name):
        return self.driver.find_element("id", name)

    def text(self, name):
        return self.part(name).text

    def state(self):
        """The state that the body shows."""
        return int((self.script(DRAWN) or "-1").split()[0])

    def shows(self, state):
        until(lambda: self.state() == state, f"state {state}")

    def pixels(self):
        return self.script("return document.getElementById('body').toDataURL()")

    def has_changed(self, before, what):
        return until(lambda: self.pixels() != before, f"another picture after {what}")

    def no_errors(self):
        errors = [entry for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
        assert not errors, errors

    def fits(self):
        wide, window = self.script("return [document.documentElement.scrollWidth, innerWidth]")
        assert wide <= window, f"the page is {wide} wide in a window of {window}"


def check_slider(page, n_states):
    assert page.part("slider").get_attribute("max") == str(n_states - 1)
    at_peak = page.state()
    assert "nearest to the peak" in page.text("where")
    page.part("slider").send_keys(Keys.HOME)
    page.shows(0)
    assert page.text("where").startswith(f"State 1 of {n_states}: load step 0")
    before = page.pixels()
    page.part("slider").send_keys(Keys.ARROW_RIGHT)
    page.shows(1)
    page.has_changed(before, "an arrow key")
    page.part("next").click()
    page.shows(2)
    page.part("to-peak").click()
    page.shows(at_peak)
    page.part("slider").send_keys(Keys.END)
    page.shows(n_states - 1)


def check_curve_click(page):
    """A click on the curve goes to the state whose point is nearest: at its left end the first one that has a point."""
    canvas = page.part("curve")
    size = canvas.size
    page.script("arguments[0].scrollIntoView({block: 'center'})", canvas)
    ActionChains(page.driver).move_to_element_with_offset(canvas, -size["width"] // 2 + 60, size["height"] // 2 - 60).click().perform()
    until(lambda: 0 <= page.state() <= 2, "a state at the foot of the curve")


def check_hover(page, fields):
    """The block at the middle of the body is told with the stress that its file has; a click keeps it."""
    page.part("slider").send_keys(Keys.END)
    page.shows(int(page.part("slider").get_attribute("max")))
    canvas = page.part("body")
    page.script("arguments[0].scrollIntoView({block: 'center'})", canvas)
    found = None
    for dx, dy in ((0, 0), (9, 4), (-12, 11), (15, -14), (-20, -8), (25, 19)):
        ActionChains(page.driver).move_to_element_with_offset(canvas, dx, dy).perform()
        if page.text("hovered").startswith("Block "):
            found = page.text("hovered")
            break
    assert found, "no block under the pointer"
    block = int(found.split()[1])
    sigma_1 = fields["sigma_1"][block]
    told = page.script("return [...document.querySelectorAll('#hovered dd')].map((each) => each.textContent)")
    number, unit = told[1].split(",")[0].split()
    assert abs(float(number) * {"MPa": 1e6, "kPa": 1e3, "Pa": 1.0}[unit] / sigma_1 - 1) < 2e-3, (told, sigma_1)
    ActionChains(page.driver).click().perform()
    until(lambda: page.text("pinned").startswith(f"Block {block}"), "the block to be kept")
    page.part("unpin").click()
    assert page.text("pinned") == ""
    page.part("find").send_keys("7", Keys.ENTER)
    until(lambda: page.text("pinned").startswith("Block 7"), "block 7 to be kept")


def check_joints(page, interfaces):
    """Somewhere along the body the pointer meets a joint, whose opening is that of its file."""
    canvas = page.part("body")
    for dx in range(-40, 41, 2):
        ActionChains(page.driver).move_to_element_with_offset(canvas, dx, 3).perform()
        if page.text("hovered").startswith("Joint "):
            break
    told = page.text("hovered")
    assert told.startswith("Joint "), told
    joint = int(told.split()[1])
    facts = page.script("return [...document.querySelectorAll('#hovered dd')].map((each) => each.textContent)")
    number, unit = facts[5].split()
    gap = float(number) * {"m": 1.0, "mm": 1e-3, "µm": 1e-6}[unit]
    assert abs(gap - interfaces["gap"][joint]) <= 2e-3 * abs(interfaces["gap"][joint]) + 1e-12, (facts, interfaces["gap"][joint])


def check_magnification(page):
    before = page.pixels()
    magnification = page.part("magnification")
    magnification.send_keys(Keys.END)
    until(lambda: page.text("magnification-text") == "100", "a magnification of 100")
    page.has_changed(before, "the magnification")
    magnification.send_keys(Keys.HOME)
    until(lambda: page.text("magnification-text") == "1", "a magnification of 1")


def check_layers(page):
    for name in ("crosses", "slips", "forces"):
        before = page.pixels()
        page.part(name).click()
        page.has_changed(before, name)
    for choice, value in (("field", "displacement"), ("field", "material"), ("joint-field", "normal_traction")):
        before = page.pixels()
        page.script("const box = document.getElementById(arguments[0]); box.value = arguments[1]; box.dispatchEvent(new Event('input'))", choice, value)
        page.has_changed(before, value)


def check_keys(page):
    """Every control is reached by the tabulator and shows it; the body moves by keys."""
    page.script("document.activeElement.blur(); window.scrollTo(0, 0)")
    reached, unseen = set(), []
    for _ in range(80):
        ActionChains(page.driver).send_keys(Keys.TAB).perform()
        name, width = page.script("const a = document.activeElement; return [a.id, parseFloat(getComputedStyle(a).outlineWidth)]")
        reached.add(name)
        if name and not width > 0:
            unseen.append(name)
    wanted = {"slider", "previous", "next", "to-peak", "curve-x", "curve-y", "body", "zoom-in", "field", "magnification", "crosses", "find",
              "history-y", "command"}
    assert wanted <= reached, wanted - reached
    assert not unseen, unseen
    page.script("document.getElementById('body').focus()")
    for key in (Keys.ARROW_LEFT, "+", "0"):
        before = page.pixels()
        page.part("body").send_keys(key)
        page.has_changed(before, f"the key {key!r}")


def check_scene(page):
    button = page.script("return [...document.querySelectorAll('#scene button')].find((each) => each.title.includes('stages.1.steps'))")
    assert button is not None, "no key stages.1.steps in the scene"
    button.click()
    assert page.part("command").get_attribute("value").endswith(" --set stages.1.steps=12"), page.part("command").get_attribute("value")


def check_phone(driver, path, pictures):
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", PHONE)
    page = Page(driver, path)
    page.fits()
    for name in ("slider", "body", "curve", "field"):
        box = page.script("const box = document.getElementById(arguments[0]).getBoundingClientRect(); return [box.left, box.right, box.height]", name)
        assert box[0] >= 0 and box[1] <= PHONE["width"] and box[2] > 20, (name, box)
    page.part("next").click()
    page.no_errors()
    driver.save_screenshot(str(pictures / "phone.png"))
    driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


SCENE = """kluft: 1
extends: MODELS/quickstart.yaml
geometry: {tessellation: {triangles: {spacing: 5 cm}}}
stages:
  - {name: pressure, pressure: {left: 1 MPa, right: 1 MPa, top: 1 MPa}, steps: 2}
  - name: platen
    strain: {boundary: top, value: 1 %}
    steps: 12
output: {pictures: false, fields_every: 2}
"""


def check_ticks(page):
    """A tick at zero that steps of 1e-5 have not met by 3.4e-21 is one at zero."""
    text = page.script(
        "const axis = Chart.getChart('history').scales.y, values = [-1e-5, -3.4e-21, 1e-5];"
        "const ticks = values.map((value) => ({ value }));"
        "return values.map((value, i) => axis.options.ticks.callback.call(axis, value, i, ticks))")
    assert text[1] == "0" and float(text[0].replace("\u2212", "-")) == -1e-5 and float(text[2]) == 1e-5, text


def check_study(driver, kluft, work):
    """The table of a study's page is sorted by a click on a head, by size and not as texts; the page fits a phone."""
    words = ["study", "step-size", str(ROOT / "models/quickstart.yaml"), "-o", "study", "--quiet",
             "--set", "geometry.tessellation.triangles.spacing=6 cm", "--set", "stages.1.strain.value=0.2 %"]
    subprocess.run([kluft, *words], cwd=work, check=True, stdout=subprocess.DEVNULL)
    for phone in (False, True):
        if phone:
            driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", PHONE)
        driver.get((work / "study/study.html").resolve().as_uri())
        wide, window = driver.execute_script("return [document.documentElement.scrollWidth, innerWidth]")
        assert wide <= window, (wide, window)
        head = driver.execute_script(
            "return [...document.querySelectorAll('th button')].filter((each) => each.textContent === 'stages.1.steps').at(-1)")
        column = "return [...arguments[0].closest('table').tBodies[0].rows].map((row) => row.cells[1].textContent)"
        driver.execute_script("arguments[0].click()", head)
        steps = [int(text) for text in driver.execute_script(column, head)]
        assert steps == sorted(steps) and len(steps) == 6, steps
        driver.execute_script("arguments[0].click()", head)
        assert driver.execute_script(column, head) == [str(each) for each in steps[::-1]]
    driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def arrays_of(path):
    return data_arrays(path)["CellData"]


def run_in(kluft, work):
    (work / "scene.yaml").write_text(SCENE.replace("MODELS", str(ROOT / "models")), encoding="utf-8")
    subprocess.run([kluft, "run", "scene.yaml", "-o", "run", "--quiet"], cwd=work, check=False)
    return work / "run"


def main(kluft, work):
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    os.environ["HOME"] = str(work)
    run = run_in(kluft, work)
    steps = sorted(int(path.stem.split("_")[1]) for path in (run / "fields").glob("blocks_*.vtu"))
    driver = browser()
    try:
        page = Page(driver, run / "report.html")
        assert "Strength" in driver.find_element("css selector", ".answer").text
        check_slider(page, len(steps))
        check_curve_click(page)
        check_hover(page, arrays_of(run / f"fields/blocks_{steps[-1]:06}.vtu"))
        check_joints(page, arrays_of(run / f"fields/interfaces_{steps[-1]:06}.vtu"))
        check_magnification(page)
        check_layers(page)
        check_keys(page)
        check_ticks(page)
        check_scene(page)
        page.fits()
        page.no_errors()
        driver.save_screenshot(str(work / "wide.png"))
        check_phone(driver, run / "report.html", work)
        check_study(driver, kluft, work)
        page.no_errors()
    finally:
        driver.quit()
    print(f"a run with {len(steps)} states: all as expected")


if __name__ == "__main__":
    main(str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]))
