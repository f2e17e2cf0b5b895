#!/usr/bin/python3
"""The report page in a browser: every tab draws, nothing is asked of the network, keys and controls do what they say.

report_browser_test.py SOURCE_DIR IGAPREP IGASOLVE"""
import base64
import io
import json
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np
from matplotlib import image

SOURCE, IGAPREP, IGASOLVE = (Path(word).resolve() for word in sys.argv[1:4])
sys.path.insert(0, str(SOURCE / "scripts"))
import headless  # noqa: E402
from igatools import iga_results, report  # noqa: E402
from igatools.report import threed  # noqa: E402
from parts import run_tests, write_boxes  # noqa: E402

MISSING = headless.what_is_missing() or ("" if threed.library() else "libjs-three is not installed; scripts/setup installs it")
MIB = 2**20
STEEL = ("--E", "210e3", "--nu", "0.3", "--rho", "7.85e-9", "--unit-system", "t-mm-s")
RUN = """model = "model.h5"
output = "static.h5"
material = "steel"
[[support]]
fixed = "xyz"
plane = { point = [0, 0, 0], normal = [-1, 0, 0] }
[[load]]
force = [0, 0, -100]
plane = { point = [40, 0, 0], normal = [1, 0, 0] }
"""


def run(program, *words, folder):
    done = subprocess.run([program, *map(str, words), "--quiet", "--json"], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout)


def common(command, solved, **more):
    return {"command": command, "part": "part.stl", "material": solved["material"], "tolerance": 0.05, "reached": True,
            "length_unit": "mm", "span_sizes": [9, 6, 4], "unknowns": [1, 2, solved["unknowns"]], "seconds": 1.0,
            "peak_memory": 50.0, "notes": ["a note"], "findings": solved["findings"], "warnings": solved["warnings"],
            "model": "model.h5", "commands": ["igaprep part.stl"], "order_relied_on": 1.09, **more}


def modes_page(folder, part, span_size, modes):
    """Page of a part's modes on one grid, with histories as if there had been three."""
    run(IGAPREP, part, "-o", "model.h5", "--span-size", span_size, "--length-unit", "mm", "--trimmed", "nnls", folder=folder)
    solved = run(IGASOLVE, "eigen", "model.h5", *STEEL, "--modes", modes, "-o", "modes.h5", folder=folder)
    results = iga_results.read(folder / "modes.h5")
    found = results["/frequencies"][results.elastic()].tolist()
    return report.write_page(folder, common(
        "modes", solved, results="modes.h5", frequencies=found, errors=[0.02] * len(found), orders=[2.0] * len(found),
        agreements=[1.0] * len(found), histories=[[1.1 * f, 1.03 * f, f] for f in found], rigid_modes=6, complete=True))


def static_page(folder):
    (folder / "run.toml").write_text(RUN)
    solved = run(IGASOLVE, "static", "run.toml", folder=folder)
    (folder / "energy.csv").write_text("time [time],kinetic [force*mm],internal [force*mm]\n0,1,0\n1,0.5,0.4\n2,0,0.9\n")
    statics = solved["statics"]
    energy = statics["strain_energy"]
    return report.write_page(folder, common(
        "static", solved, results="static.h5", energies="energy.csv", supports=statics["supports"], loads=statics["loads"],
        quantities=[{"name": "strain energy", "unit": "mJ", "value": energy, "error": 0.01, "order": 1.5,
                     "history": [0.9 * energy, 0.97 * energy, energy]}]))


@unittest.skipIf(MISSING, MISSING)
class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = Path(cls.temporary.name)
        (cls.folder / "bar").mkdir()
        write_boxes(cls.folder / "bar/part.stl", [((0, 0, 0), (40, 10, 8))])
        cls.modes = modes_page(cls.folder / "bar", "part.stl", 4, 3)
        cls.modes = cls.modes.rename(cls.modes.with_name("modes.html"))
        cls.static = static_page(cls.folder / "bar")
        cls.driver = headless.browser()
        cls.addClassCleanup(cls.driver.quit)

    def open(self, page, tab="answer"):
        self.driver.get("about:blank")
        headless.complaints(self.driver), headless.requests(self.driver)  # of the page before
        self.driver.get(f"{page.as_uri()}#{tab}")
        if tab == "view":
            self.wait("document.getElementById('shape').options.length > 1")
            self.js("const play = document.getElementById('play'); if (play.getAttribute('aria-pressed') === 'true') play.click();")

    def js(self, script, *words):
        return self.driver.execute_script(script, *words)

    def wait(self, condition):
        end = time.monotonic() + 10
        while not self.js(f"return Boolean({condition});"):
            self.assertLess(time.monotonic(), end, condition)
            time.sleep(0.02)

    def picture(self):
        """Pixels of the 3-D view as drawn: (rows, columns, 3), 0 … 1."""
        self.js("return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)));")
        png = self.js("return document.getElementById('canvas').toDataURL('image/png');").split(",")[1]
        return image.imread(io.BytesIO(base64.b64decode(png)))[:, :, :3]

    def change(self, before):
        """Share of the pixels that are others than before; all where the picture has another size."""
        now = self.picture()
        return (np.abs(now - before).max(2) > 0.02).mean() if now.shape == before.shape else 1.0

    def key(self, element, *keys):
        found = self.driver.find_element("id", element)
        found.send_keys(*keys)

    def prefer(self, name, value):
        """What the user set in the operating system, until the end of the test."""
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": name, "value": value}]})
        self.addCleanup(self.driver.execute_cdp_cmd, "Emulation.setEmulatedMedia", {"features": []})

    def set(self, element, value):
        self.js("""const e = document.getElementById(arguments[0]);
                   if (e.type === 'checkbox') e.checked = arguments[1]; else e.value = arguments[1];
                   e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('change'));""", element, value)

    def test_loads_without_network_and_complaints(self):
        for page in (self.modes, self.static):
            self.open(page, "view")
            self.picture()
            self.assertEqual(headless.complaints(self.driver), [])
            self.assertEqual([address.split("#")[0] for address in headless.requests(self.driver)], [page.as_uri()])

    def test_every_tab_draws(self):
        self.open(self.static)
        for tab in ("answer", "view", "convergence", "energies", "warnings", "repeat"):
            self.js("document.getElementById(arguments[0]).click();", f"tab-{tab}")
            heights = self.js("return [...document.querySelectorAll('[role=tabpanel]')].map(p => [p.id, p.offsetHeight]);")
            self.assertEqual([panel for panel, height in heights if height > 60], [f"panel-{tab}"])
            self.assertEqual([panel for panel, height in heights if height > 0], [f"panel-{tab}"])
        for tab, curves in (("convergence", 1), ("energies", 2)):
            self.js("document.getElementById(arguments[0]).click();", f"tab-{tab}")
            widths = self.js("return [...document.querySelectorAll(arguments[0])].map(c => c.getBBox().width);",
                             f"#panel-{tab} .curve .line")
            self.assertEqual(len(widths), curves)
            self.assertGreater(min(widths), 100)
            plot = image.imread(io.BytesIO(self.driver.find_element("css selector", f"#panel-{tab} .plot > svg").screenshot_as_png))
            self.assertGreater(len(np.unique(plot.reshape(-1, plot.shape[2]), axis=0)), 20)

    def test_part_fills_the_picture(self):
        self.open(self.modes, "view")
        pixels = self.picture()
        part = np.abs(pixels - pixels[0, 0]).max(2) > 0.02
        self.assertGreater(part.mean(), 0.05)
        rows, columns = np.flatnonzero(part.any(1)), np.flatnonzero(part.any(0))
        self.assertGreater(max(np.ptp(rows) / part.shape[0], np.ptp(columns) / part.shape[1]), 0.6)
        self.assertGreater(len(np.unique((pixels[part] * 20).round(), axis=0)), 20)  # lit and coloured

    def test_turning_zooming_and_choosing(self):
        self.open(self.modes, "view")
        before = self.picture()
        self.assertEqual(self.change(before), 0)  # nothing moves by itself
        from selenium.webdriver.common.keys import Keys
        for keys in ((Keys.ARROW_LEFT,), (Keys.ARROW_UP,), ("+",), ("-",), (Keys.SHIFT, Keys.ARROW_LEFT)):
            before = self.picture()
            self.key("canvas", *keys)
            self.assertGreater(self.change(before), 0.01, keys)
        self.key("canvas", Keys.HOME)
        before = self.picture()
        self.key("canvas", Keys.PAGE_DOWN)
        self.assertGreater(self.change(before), 0.01)
        self.assertEqual(self.js("return document.getElementById('shape').value;"), "1")
        self.assertIn("Mode 8", self.js("return document.getElementById('canvas').getAttribute('aria-label');"))
        for button in self.js("return [...document.querySelectorAll('[data-turn], [data-view]')];"):
            before = self.picture()
            button.click()
            self.assertGreater(self.change(before), 0.01, button.get_attribute("outerHTML"))

    def test_dragging(self):
        from selenium.webdriver import ActionChains
        self.open(self.modes, "view")
        before = self.picture()
        canvas = self.driver.find_element("id", "canvas")
        ActionChains(self.driver).move_to_element(canvas).click_and_hold().move_by_offset(80, 30).release().perform()
        self.assertGreater(self.change(before), 0.01)

    def test_playing(self):
        self.open(self.modes, "view")
        self.key("canvas", " ")
        self.assertEqual(self.js("return document.getElementById('play').textContent;"), "Pause")
        before = self.picture()
        time.sleep(0.3)
        self.assertGreater(self.change(before), 0.01)
        self.key("play", " ")
        before = self.picture()
        time.sleep(0.2)
        self.assertEqual(self.change(before), 0)

    def test_reduced_motion(self):
        """Where people ask for little motion nothing plays by itself; elsewhere modes do."""
        for preference, playing in (("reduce", "false"), ("no-preference", "true")):
            self.prefer("prefers-reduced-motion", preference)
            self.driver.get("about:blank")
            self.driver.get(f"{self.modes.as_uri()}#view")
            self.wait("document.getElementById('shape').options.length > 1")
            self.assertEqual(self.js("return document.getElementById('play').getAttribute('aria-pressed');"), playing)

    def test_light_and_dark(self):
        grounds = []
        for scheme in ("light", "dark"):
            self.prefer("prefers-color-scheme", scheme)
            self.open(self.modes, "view")
            grounds.append(self.picture()[0, 0].mean())
        self.assertGreater(grounds[0], 0.8)
        self.assertLess(grounds[1], 0.3)

    def test_spans_surface_cut_and_colours(self):
        self.open(self.static, "view")
        self.assertIn("MPa", self.js("return document.getElementById('bar-title').textContent;"))
        self.assertIn("times as large", self.js("return document.getElementById('said').textContent;"))
        for element, value in (("show-trimmed", True), ("show-surface", False), ("show-surface", True), ("cut", "z"),
                               ("cut-place", 20), ("cut", ""), ("colour", "displacement"), ("colour", ""), ("amount", 20),
                               ("shape", -1)):
            before = self.picture()
            self.set(element, value)
            self.assertGreater(self.change(before), 0.003, (element, value))

    def test_tabs_by_keys(self):
        from selenium.webdriver.common.keys import Keys
        self.open(self.modes)
        def chosen():
            return self.js("return document.activeElement.id + document.querySelector('[aria-selected=true]').id;")

        self.key("tab-answer", Keys.ARROW_LEFT)
        self.assertEqual(chosen(), "tab-repeat" * 2)
        self.key("tab-repeat", Keys.ARROW_RIGHT)
        self.key("tab-answer", Keys.ARROW_RIGHT)
        self.assertEqual(chosen(), "tab-view" * 2)
        self.key("tab-view", Keys.END)
        self.assertEqual(chosen(), "tab-repeat" * 2)

    def test_legends(self):
        self.open(self.modes, "convergence")
        self.driver.find_element("css selector", ".legend button").click()
        self.assertEqual(self.js("return document.querySelectorAll('.curve.is-chosen').length;"), 1)
        self.driver.find_element("css selector", ".legend button").click()
        self.assertEqual(self.js("return document.querySelectorAll('.plot.chosen, .curve.is-chosen').length;"), 0)

    def test_names_of_controls(self):
        """As the browser tells them to assistive programs."""
        self.open(self.static, "view")
        seen = 0
        for tab in self.js("return [...document.querySelectorAll('[role=tab]')];"):
            tab.click()
            for element in self.js("""
                    const all = document.querySelectorAll('button, select, input, canvas, [role=img], [role=region]');
                    return [...all].filter(e => e.getBoundingClientRect().height > 0);"""):
                seen += 1
                self.assertTrue(element.accessible_name.strip(), element.get_attribute("outerHTML")[:200])
        self.assertGreater(seen, 40)

    def test_iga_writes_and_rewrites_the_page(self):
        folder = self.folder / "written"
        words = [SOURCE / "scripts/iga", "modes", self.folder / "bar/part.stl", *STEEL[:6], "--modes", 1, "--span-size", 6,
                 "-o", folder, "--bin", IGAPREP.parent, "--quiet"]
        done = subprocess.run([*map(str, words)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = folder / "report.html"
        self.assertIn(f"written      {page}", done.stdout)
        self.open(page, "view")
        self.assertEqual(self.js("return document.getElementById('shape').options.length;"), 2)
        first = page.read_text()
        page.unlink()
        done = subprocess.run([SOURCE / "scripts/iga", "report", folder], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (0, f"written      {page}\n"), done.stderr)
        self.assertEqual(page.read_text(), first)

    def test_foam_part_stays_small(self):
        folder = self.folder / "foam"
        folder.mkdir()
        page = modes_page(folder, SOURCE / "samples/01_foam_part/foam_part.stl", 20, 10)
        self.assertLess(page.stat().st_size, 10 * MIB)
        self.open(page, "view")
        self.assertEqual(self.js("return document.getElementById('shape').options.length;"), 11)
        self.assertGreater((np.abs(self.picture() - self.picture()[0, 0]).max(2) > 0.02).mean(), 0.1)


if __name__ == "__main__":
    run_tests(MISSING)
