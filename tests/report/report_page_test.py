#!/usr/bin/env python3
"""Opens a page of `skinbench report` in headless Chromium and uses it as a reader would.

usage: report_page_test.py SKINBENCH FOLDER       FOLDER takes the result files and pages
Ends with 77 (skipped) where there is no Chromium.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

NAMES = ["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"]


class Browser:
    """Chromium over its debugging pipe: JSON messages that end with a zero byte, on descriptors 3 and 4."""

    def __init__(self, program):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        theirs, self.out = os.pipe()
        self.into, also_theirs = os.pipe()
        high = [os.dup(end) for end in (theirs, also_theirs)]
        command = [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                   "--remote-debugging-pipe", f"--user-data-dir={self.profile.name}", "about:blank"]
        # The shell moves the two ends to the descriptors that Chromium expects.
        self.process = subprocess.Popen(
            ["/bin/sh", "-c", f'exec 3<&{high[0]} 4>&{high[1]}; exec "$@"', "sh"] + command, pass_fds=high,
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in (theirs, also_theirs, *high):
            os.close(end)
        self.number, self.rest, self.events, self.session = 0, b"", [], None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")

    def message(self):
        while b"\0" not in self.rest:
            part = os.read(self.into, 1 << 20)
            if not part:
                raise RuntimeError("Chromium has gone")
            self.rest += part
        first, self.rest = self.rest.split(b"\0", 1)
        return json.loads(first)

    def call(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def wait(self, method):
        while not any(event.get("method") == method for event in self.events):
            self.events.append(self.message())

    def open(self, path, width=1280, height=900):
        self.events.clear()
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.call("Page.navigate", url="file://" + path)
        self.wait("Page.loadEventFired")
        self.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def value(self, script):
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"].get("exception", {}).get("description", script))
        return answer["result"].get("value")

    def key(self, name, code, text=""):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code,
                      text=text if kind == "keyDown" else "")

    def click(self, find):
        x, y = self.value(f"(() => {{ const e = {find}; e.scrollIntoView({{block: 'center', behavior: 'instant'}}); "
                          "const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()")
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def complaints(self):
        """Errors of scripts, everything on the console, and what was asked of the network."""
        self.value("0")
        found = []
        for event in self.events:
            method, given = event.get("method"), event.get("params", {})
            if method == "Runtime.exceptionThrown":
                found.append(given["exceptionDetails"].get("exception", {}).get("description", "exception"))
            elif method == "Runtime.consoleAPICalled":
                found.append(f"console.{given['type']}: {given['args']}")
            elif method == "Log.entryAdded":
                found.append(given["entry"]["text"])
            elif method == "Network.requestWillBeSent" and not given["request"]["url"].startswith(("file:", "blob:")):
                found.append("asks for " + given["request"]["url"])
        return found

    def close(self):
        self.session = None
        try:
            self.call("Browser.close")
        except (RuntimeError, OSError):
            pass
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.profile.cleanup()


failures = 0


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("failed:", what)


def times(median):
    samples = [median * (1 + 0.002 * (i % 5 - 2)) for i in range(20)]
    return {"mean": median, "median": median, "min": samples[0], "max": samples[4], "cv": 0.003, "p95": samples[4],
            "interval": [median * 0.999, median * 1.001], "outliers": 0, "round_sizes": [10, 10],
            "drift": {"relative": 0.001, "p": 0.6}, "samples": samples}


def case(route, variant, codec, median, **more):
    mesh = variant.startswith("mesh")
    identity = f"{route}/{variant}/{codec}" + ("/meshopt/redirect" if mesh else "") + "+no-fragments"
    row = {"id": identity, "route": route, "variant": variant, "codec": codec, "builder": "meshopt" if mesh else None,
           "layout": "redirect" if mesh else None, "cull": "off", "scenario": "direct", "raster": "no-fragments",
           "options": {"influences": "4"}, "status": "ok", "reason": None, "gpu_ms": times(median),
           "passes_ms": {"skin": median / 4 if variant == "compute" else None, "depth": None, "draw": median * 0.75},
           "host_ms": {"record": 0.05, "submit": 0.001}, "limit_ms": median / 2, "meshlets": 900 if mesh else None,
           "memory_bytes": {"vertex": 4096 if codec == "uc" else 2048, "index": 1024, "meshlet": 0,
                            "additional_meshlet": 0, "tuple": 0, "palette": 64, "skinned": 0,
                            "total": 5184 if codec == "uc" else 3136},
           "accuracy": {"max_position_error": 1e-7, "max_normal_error": 1e-6, "tolerance": 2e-6}}
    return {**row, **more}


def results(software=False):
    cases = [case(route, variant, codec, 10 + 3 * i + 2 * j + k) for k, codec in enumerate(["uc", "oss"])
             for j, (routes, variant) in enumerate([(("vk", "gl"), "vertex"), (("vk", "gl"), "compute"),
                                                    (("vk-ext", "vk-nv", "gl-nv"), "mesh")])
             for i, route in enumerate(routes)]
    cases.append(case("gl-ext", "mesh", "uc", 1, status="skipped", gpu_ms=None, passes_ms=None,
                      reason="no GL_EXT_mesh_shader </script><img src=x onerror=alert(1)>"))
    cases.append(case("vk", "none", "</script><b>&", 1, status="failed", gpu_ms=None, passes_ms=None,
                      reason="\"off\" by <far> & more\nsecond line"))
    return {"schema": "skinbench-results/1", "tool": {"version": "1", "revision": "abc"},
            "host": {"os": "Linux", "cpu": "a CPU"},
            "devices": [{"route_api": api, "name": "Card <1>", "driver": "driver", "software": software}
                        for api in ("vulkan", "opengl")],
            "scene": {"name": "hero <b>", "vertices": 100, "triangles": 200, "joints": 30, "unique_tuples": 40,
                      "mean_influences": 1.5, "max_influences": 4},
            "settings": {"copies": 7, "frames": 20, "warmup": 0, "width": 64, "height": 64, "pose": "frozen",
                         "rounds": 2}, "warnings": ["the clock was <b>low</b>"], "noise_floor": 0.003, "cases": cases}


def axis(name, values, **more):
    return {"name": name, "option": "--" + name, "changes": "plan", "top_level": False, "usual": values[0],
            "values": values, "beside": None, **more}


def several_views():
    """Vertex is faster with 1 and 2 views, compute with 4 and 8."""
    content = results()
    content["cases"] = [
        case("vk", variant, "uc", median, options={"influences": "4", "views": str(views)},
             id=f"vk/{variant}/uc+no-fragments" + (f"+{views}-views" if views > 1 else ""))
        for views in (1, 2, 4, 8) for variant, median in (("vertex", 4 * views), ("compute", 7 + views))]
    return content


def of_tomorrow():
    """A file with an axis, an axis beside it, a route, a variant and a figure that this program does not know."""
    content = results()
    content["axes"] = [axis("route", ["vk", "new"], top_level=True, usual=None),
                       axis("variant", ["vertex", "later"], top_level=True, usual=None),
                       axis("warp_speed", ["slow", "fast"]), axis("fuel", ["oil", "gas"], beside="warp_speed")]
    content["devices"] = [{"route_api": "novel", "name": "Card", "driver": "driver", "software": True,
                           "routes": ["new"]}]
    options = [{"warp_speed": "slow"}, {"warp_speed": "fast", "fuel": "oil"}, {"warp_speed": "fast", "fuel": "gas"}]
    content["cases"] = [case("new", "later", "uc", 4 + i, id=f"new/later/uc+{i}", options=words,
                             thrust={"mean": 1500.5 * i}) for i, words in enumerate(options)]
    return content


def holds(whole, part):
    """Whether all of `part` is in `whole`."""
    if isinstance(part, dict):
        return isinstance(whole, dict) and all(key in whole and holds(whole[key], part[key]) for key in part)
    if isinstance(part, list):
        return isinstance(whole, list) and len(whole) == len(part) and all(map(holds, whole, part))
    return whole == part


def damaged():
    """A file whose values are of the wrong kinds where loading lets them through."""
    broken = results()
    broken["settings"].update(rounds=[], warmup={})
    broken.update(limits=[7], environment=[], self_test="no", calibrations=[3], axes=[7, {"name": 5, "values": "few"}])
    broken["devices"][0].update(routes=7, peak=[], version=3)
    broken["cases"][0].update(builder=7, options=[], host_ms="x", counters=[1], achieved=5, meshlets="many")
    broken["cases"][1]["gpu_ms"].update(interval=[2, 1], drift=4, p95="slow", outliers=[])
    broken["cases"][2].update(memory_bytes={"total": 5, "vertex": "much"}, unserialised_ms=3, limit_id=[],
                              accuracy={"max_position_error": 1, "max_normal_error": [], "image_difference": "x"})
    return broken


def make(skinbench, folder, name, files):
    paths = []
    for number, content in enumerate(files):
        paths.append(os.path.join(folder, f"{name}_{number}.json"))
        with open(paths[-1], "w") as out:
            json.dump(content, out)
    page = os.path.join(folder, name + ".html")
    subprocess.run([skinbench, "report", *paths, "-o", page], check=True)
    return page


ROWS = "[...document.querySelectorAll('table.cases tbody tr')]"


def header(name):
    return f"[...document.querySelectorAll('table.cases thead button')].find((b) => b.textContent.startsWith('{name}'))"


def column(browser, name):
    return browser.value("(() => { const heads = [...document.querySelectorAll('table.cases thead th')]; "
                         f"const at = heads.findIndex((c) => c.textContent.startsWith('{name}')); "
                         f"return {ROWS}.map((r) => r.children[at].textContent); }})()")


def use_one_file(browser, page, content):
    browser.open(page)
    title = browser.value("document.querySelector('h1').textContent")
    check(title == "hero <b> on Card <1>", "the title names the scene and the device")
    check(browser.value("document.querySelectorAll('figure svg').length") >= 6, "the charts are there")
    check(browser.value("[...document.querySelectorAll('svg:not([aria-hidden])')].every((s) => "
                        "s.getAttribute('role') === 'img' && (s.ariaLabel || "
                        "document.getElementById(s.getAttribute('aria-labelledby')).textContent))"),
          "every chart has a name")
    check(browser.value("document.querySelectorAll('img, main b, script:not([type])').length") == 2,
          "no markup of the file is an element (the page's own two scripts are)")
    body = browser.value("document.body.innerText")
    for part in ("</script><img src=x onerror=alert(1)>", "\"off\" by <far> & more", "the clock was <b>low</b>"):
        check(part in body, f"the page tells {part}")
    choices, routes = (browser.value(f"document.getElementById('{part}').textContent") for part in ("choices", "apis"))
    check("codec: uc → oss (7)" in choices, "an older file's choices are compared")
    check(all(pair in routes for pair in ("vk → gl (4)", "vk-ext → vk-nv (2)", "vk-nv → gl-nv (2)")) and
          "vk-ext → gl-nv" not in routes, "routes are compared that differ in the API or the extension alone")
    identities = [row["id"] for row in content["cases"]]
    check(sorted(column(browser, "case")) == sorted(identities), "the table has every case")

    browser.click(header("median"))
    shown = [float(value) for value in column(browser, "median") if value != "–"]
    check(len(shown) == 14 and shown == sorted(shown), "a click on a heading sorts")
    check(column(browser, "median")[-1] == "–", "cases without a time stand last")
    sorts = "[...document.querySelectorAll('table.cases thead th')].map((c) => c.ariaSort).filter((s) => s !== 'none')"
    check(browser.value(sorts) == ["ascending"], "the heading says so")
    check(browser.value(f"document.activeElement === {header('median')}"), "the heading keeps the focus")
    browser.key("Enter", 13, "\r")
    shown = [float(value) for value in column(browser, "median") if value != "–"]
    check(shown == sorted(shown, reverse=True) and browser.value(sorts) == ["descending"], "Enter sorts the other way")
    browser.key("Tab", 9)
    check(browser.value("document.activeElement.closest('th')?.textContent.startsWith('95 %')"),
          "Tab goes to the next heading")

    opener = f"{ROWS}[0].querySelector('button')"
    browser.value(f"{opener}.focus()")
    browser.key("Enter", 13, "\r")
    check(browser.value(f"{opener}.ariaExpanded") == "true" and
          browser.value("document.querySelectorAll('tr.record svg').length") == 1,
          "Enter on a case opens its record with the samples")
    browser.value("document.querySelector('input[type=search]').focus()")
    for letter in "vk-nv":
        browser.key(letter, ord(letter.upper()), letter)
    shown = column(browser, "case")
    check(len(shown) == 2 and all("vk-nv" in identity for identity in shown), "the search filters")
    browser.value("(() => { const make = URL.createObjectURL.bind(URL); "
                  "URL.createObjectURL = (blob) => { window.saved = blob; return make(blob); }; })()")
    browser.click("document.querySelector('button.download')")
    saved = json.loads(browser.value("window.saved.text()"))
    check(holds(saved, content), "the JSON to download is the whole file")
    check("axes" in saved and saved["devices"][0]["routes"] == ["vk", "vk-ext", "vk-nv"],
          "completed where it is of an older version")
    check(browser.complaints() == [], f"the console is silent: {browser.complaints()}")


def use_file_of_tomorrow(browser, page):
    with open(page) as file:
        text = file.read()
    start = text.index(">", text.index('id="tables"')) + 1
    end = text.index("</script>", start)
    tables = json.loads(text[start:end])
    tables["columns"].append({"path": "thrust.mean", "per": "", "scale": 2, "form": "fixed", "digits": 1,
                              "header": "thrust", "unit": "N", "group": "", "marked": True})
    with open(page, "w") as file:
        file.write(text[:start] + json.dumps(tables) + text[end:])
    browser.open(page)
    check(browser.complaints() == [], f"what is not known is no error: {browser.complaints()}")
    choices = browser.value("document.getElementById('choices').textContent")
    check("warp speed: slow → fast (2)" in choices, "an added axis is a choice, whatever the axis beside it is")
    check("fuel: oil → gas (1)" in choices, "and so is that one")
    check(column(browser, "thrust") == ["0.0*", "3,001.0*", "6,002.0*"], "an added column is in the table of all cases")
    check(browser.value("document.querySelectorAll('#stages .swatch.v-1').length") > 0,
          "a variant has the colour of its place in the table")
    check("novel: driver" in browser.value("document.querySelector('header').textContent"), "an API is named as it is")


def main():
    skinbench, folder = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    program = next((found for name in NAMES if (found := shutil.which(name))), None)
    if not program:
        print("SKIPPED: no Chromium, so nobody looked at the page of the report; install chromium-headless-shell")
        return 77
    os.makedirs(folder, exist_ok=True)
    browser = Browser(program)
    try:
        content = results()
        use_one_file(browser, make(skinbench, folder, "one", [content]), content)

        check(not browser.value("document.getElementById('views')"), "one view makes no curve")

        use_file_of_tomorrow(browser, make(skinbench, folder, "tomorrow", [of_tomorrow()]))

        browser.open(make(skinbench, folder, "views", [several_views()]))
        check(browser.complaints() == [], f"the console is silent with several views: {browser.complaints()}")
        check(browser.value("document.querySelectorAll('#views path.line').length") == 2, "each variant has a line")
        crossing = browser.value("document.querySelector('#views .wide tbody').innerText")
        check(crossing.split() == "compute vertex 2.33 2.33 to 2.34".split(), f"the crossing is named: {crossing}")
        check("4 influences, 4 views" in browser.value("document.querySelector('.findings').innerText"),
              "numbers of views are different work")

        other = results(software=True)
        other["settings"]["copies"] = 9
        page = make(skinbench, folder, "two", [content, other, content])
        for width in (390, 1280):
            browser.open(page, width)
            check(browser.value("document.documentElement.scrollWidth") <= width, f"the page is no wider than {width}")
            check(browser.complaints() == [], f"the console is silent with several files: {browser.complaints()}")
        check(browser.value("document.querySelectorAll('#files svg').length") == 1, "equal cases of files are compared")
        compared = browser.value("document.getElementById('files').innerText")
        check("settings: copies\t7\t9\t7" in compared and "width" not in compared, f"settings that differ are named: {compared}")
        check(os.path.join(folder, "two_1.json") in compared, "files are named as they were typed")
        warnings = browser.value("[...document.querySelectorAll('#files .banner')].map((e) => e.textContent)")
        check(len(warnings) == 1 and "two_1.json does not draw what" in warnings[0] and "(copies)" in warnings[0],
              f"files that draw something else are warned of: {warnings}")
        medians = browser.value(ROWS + ".filter((r) => r.className === 'software')"
                                ".map((r) => r.children[2].textContent)")
        check(len(medians) == 16 and all(value == "–" or value.endswith("*") for value in medians),
              "times of software drivers are marked")
        check("not how fast a GPU is" in browser.value("document.querySelector('header').textContent"), "and explained")

        cards = [results(), results()]
        for digit, file in zip("12", cards):
            for device in file["devices"]:
                device["uuid"] = digit * 8 + "-0000-0000-0000-000000000000"
                device["driver"] = "a driver whose name and version take a whole line of a wide window 580.159.04"
        browser.open(make(skinbench, folder, "cards", cards), 1200)
        check(browser.value("(() => { const box = document.querySelector('.differences .wide'); "
                            "return box.textContent.includes('22222222') && box.scrollWidth <= box.clientWidth; })()"),
              "what differs between two files is seen whole")
        check(not browser.value("document.querySelector('#files .banner')"), "two cards that draw the same: no warning")
        check(browser.value("document.querySelector('h1').textContent") == "hero <b> on 2 devices",
              "two cards of one name are two devices")
        check("Card <1> (UUID 22222222…)" in browser.value("document.body.textContent"), "and named apart")

        browser.open(make(skinbench, folder, "damaged", [damaged()]))
        check(browser.complaints() == [], f"damaged values are no error: {browser.complaints()}")
        check(browser.value(ROWS + ".length") == 16, "nor do they lose cases")
        empty = {**results(), "cases": []}
        browser.open(make(skinbench, folder, "empty", [empty]))
        check(browser.complaints() == [], f"a file without cases is no error: {browser.complaints()}")
    finally:
        browser.close()
    print("failed" if failures else "the page works in", program)
    return 1 if failures else 0


sys.exit(main())
