"""The application in a real browser: what a user clicks, drags and sees. `make app-test` runs these tests."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress
from http.client import HTTPConnection
from io import BytesIO
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import rattlebox as rb
from rattlebox.app import worker
from rattlebox.app.draft import template

PlaywrightError = pytest.importorskip("playwright.sync_api").Error
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
LONG = 120_000  # ms; a busy machine draws slowly

pytestmark = [
    pytest.mark.browser,
    pytest.mark.filterwarnings("ignore"),
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium is installed; the browser tests did not run"),
]


@contextmanager
def served(folder):
    """Start `rattlebox app` and yield its process and address; fail at its end if an error went to its log."""
    command = [sys.executable, "-m", "rattlebox.cli", "app", str(folder), "--no-browser"]
    ours = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}  # NiceGUI reads them
    log = folder.with_name(f"{folder.name}.log")
    with log.open("w") as file:  # a pipe that nobody reads would be full one day
        process = subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT, env=ours)
    try:
        while not (found := re.search(r"http://127\.0\.0\.1:\d+/\?token=\S+", log.read_text())):
            assert process.poll() is None, log.read_text()
            time.sleep(0.05)
        yield process, found[0]
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        process.wait(timeout=60)
        print(log.read_text())
    assert not re.search(r'rattlebox.app.(?!guard)\w+\.py", line', log.read_text())  # others are of refused messages


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """Return the address and the folder of a server."""
    folder = tmp_path_factory.mktemp("app")
    with served(folder) as (_, address):
        yield address, folder


@pytest.fixture(scope="module")
def browser():
    """Return a browser."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def page(server, browser):
    """Open the page; fail at its end if the console had errors or a request left this machine."""
    page = browser.new_page(viewport={"width": 1440, "height": 900})
    page.set_default_timeout(LONG)
    problems, requests = [], []
    page.on("console", lambda message: message.type == "error" and problems.append(message.text))
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.on("websocket", lambda socket: requests.append(socket.url))
    page.goto(server[0])
    page.wait_for_function("window.rbDrawn !== undefined")
    yield page
    page.close()
    assert problems == []
    here = server[0].partition("://")[2].partition("/")[0]
    assert any(url.startswith(f"ws://{here}/") for url in requests)
    assert [url for url in requests if not url.startswith((f"http://{here}/", f"ws://{here}/", "data:", "blob:"))] == []


def pick(page, label, option):
    """Choose an option of a menu; one that opened while the page was being built closes again without a choice."""
    chosen = page.locator(".q-select", has=page.get_by_label(label, exact=True)).get_by_text(option, exact=True)
    for _ in range(10):
        page.get_by_label(label, exact=True).click()
        with suppress(PlaywrightError):
            page.get_by_role("option", name=option, exact=True).click(timeout=LONG / 8)
            chosen.wait_for(timeout=LONG / 8)
            return
        page.keyboard.press("Escape")
    pytest.fail(f"the menu {label} does not open")


def enter(page, values):
    """Fill in fields; the page may still replace what they show by the range that it suggests for a new parameter."""
    fields = {page.get_by_label(label, exact=True).first: value for label, value in values.items()}
    for _ in range(10):
        for field, value in fields.items():
            field.fill(value)
        page.wait_for_timeout(500)
        if all(field.input_value() == value for field, value in fields.items()):
            return
    pytest.fail(f"{values} cannot be entered")


def choose(page, title):
    """Choose another template."""
    before = toml(page)
    pick(page, "template", title)
    page.wait_for_function("(text) => document.querySelector('textarea').value !== text", arg=before)


def toml(page):
    """Return the text of the case."""
    return page.locator("textarea").first.input_value()


def is_busy():
    """Return whether other programs use this machine, so that times mean nothing."""
    return os.getloadavg()[0] > 0.7 * (os.cpu_count() or 1)


def picture(page, selector):
    """Return the pixels of a canvas."""
    return page.evaluate(f"document.querySelector('{selector}').toDataURL()")


def numbers(summary):
    """Return the lines of a summary but for the computing time."""
    lines = [line.strip() for line in summary.splitlines()]
    rows = [line for line in lines if re.match(r"\w.*  ", line) and not line.startswith("computing time")]
    return [" ".join(line.split()) for line in rows]


def download(page, button, file):
    """Click a button and save the file that it offers."""
    with page.expect_download() as event:
        button.click()
    event.value.save_as(file)
    return file


def test_slider_changes_the_curve(page):
    """A slider changes the case and draws its motion again, in 150 ms on a quiet machine; the page appears in 2 s."""
    page.get_by_text("finished at t = 5 s").wait_for()
    before = picture(page, ".rb-charts canvas")
    box = page.get_by_label("damper.gap").bounding_box()
    left, middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(left, middle)
    page.mouse.down()
    page.wait_for_timeout(500)
    page.evaluate(
        """() => addEventListener("mousemove", () => {
            const {count} = window.rbDrawn, start = performance.now();
            const look = () => {
                if (window.rbDrawn.count > count) window.rbTook = performance.now() - start;
                else requestAnimationFrame(look);
            };
            window.rbTook = undefined;
            look();
        }, true)"""
    )
    times = []
    for step in range(14):
        page.mouse.move(left + 0.025 * (step + 1) * box["width"], middle)
        page.wait_for_function("window.rbTook !== undefined")
        times.append(page.evaluate("window.rbTook"))
        page.wait_for_timeout(250)
    page.mouse.up()
    times.sort()
    paint = page.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime")
    print(f"\nslider to picture: {times[0]:.0f} ms at best, median {times[len(times) // 2]:.0f} ms")
    print(f"first paint: {paint:.0f} ms")
    assert picture(page, ".rb-charts canvas") != before
    assert rb.Case.from_toml(toml(page)).dampers[0].gap > 0.5e-3
    assert page.locator(".rb-charts canvas").count() == 4
    if not is_busy():
        assert times[0] < 150
        assert paint < 2000


def answers(page):
    """Return the times in which the page shows another tab and takes a step of a slider, medians of 5 [s]."""
    shown = """(text) => [...document.querySelectorAll(".q-tab-panel button")].some(
        (button) => button.offsetParent && button.textContent.includes(text))"""
    tabs, steps = [], []
    for _ in range(5):
        page.locator(".q-slider .q-slider__track-container").first.focus()
        before, start = toml(page), time.monotonic()
        page.keyboard.press("ArrowRight")
        page.wait_for_function("(text) => document.querySelector('textarea').value !== text", arg=before, polling=10)
        steps.append(time.monotonic() - start)
        for tab, button in (("Saved runs", "Compare"), ("Watch", "Pause")):
            start = time.monotonic()
            page.evaluate(
                "(name) => [...document.querySelectorAll('.q-tab')].find((tab) => tab.textContent.includes(name)).click()",
                tab,
            )
            page.wait_for_function(shown, arg=button, polling=10)
            tabs.append(time.monotonic() - start)
    return sorted(tabs)[len(tabs) // 2], sorted(steps)[2]


def test_box_of_balls_moves_and_is_cancelled(page, server):
    """Two hundred spheres move during the run, and the page answers; Cancel leaves no files."""
    busy = is_busy()
    choose(page, "Shaken box of balls")
    longer = toml(page).replace('duration = "1 s"', 'duration = "5 s"').replace("snapshots = 200", "snapshots = 1000")
    page.locator("textarea").first.fill(longer)
    page.wait_for_timeout(1000)  # the page waits for the end of typing
    page.get_by_role("button", name="Run and save").click()
    page.wait_for_function("window.rbParticles && window.rbParticles.frames > 3")
    assert page.evaluate("window.rbParticles.particles") == 200
    before = picture(page, ".rb-scene canvas")
    frame = page.evaluate("window.rbParticles.frame")
    page.wait_for_function(f"window.rbParticles.frame !== {frame}")
    page.wait_for_timeout(200)
    assert picture(page, ".rb-scene canvas") != before
    page.get_by_text("computed up to t").wait_for()  # motion and energy grow
    during = answers(page)
    page.get_by_role("button", name="Cancel").wait_for()  # the run is still in progress
    page.get_by_role("button", name="Cancel").click()
    page.get_by_text("cancelled").wait_for()
    assert not list(server[1].glob("*.vtkhdf"))
    without = answers(page)
    for name, busy_time, idle_time in zip(("another tab", "step of a slider"), during, without, strict=True):
        print(f"\n{name}: {1e3 * busy_time:.0f} ms during a run, {1e3 * idle_time:.0f} ms without")
        assert busy_time < (max(1.0, 4 * idle_time) if busy else 1.0)


def test_controls_of_particles(page, server, tmp_path):
    """Copy gives the case; the run has the bits of `simulate`; snapshots are scrubbed, coloured, cut and turned."""
    choose(page, "Shaken box of balls")
    short = toml(page).replace("count = 200", "count = 100").replace('duration = "1 s"', 'duration = "0.5 s"')
    page.locator("textarea").first.fill(short.replace("snapshots = 200", "snapshots = 12"))
    page.wait_for_timeout(1000)  # the page waits for the end of typing
    page.evaluate("() => { navigator.clipboard.writeText = async (text) => { window.rbCopied = text; }; }")
    page.get_by_role("button", name="Copy").click()
    page.wait_for_function("typeof window.rbCopied === 'string'")
    assert rb.Case.from_toml(page.evaluate("window.rbCopied")) == rb.Case.from_toml(toml(page))
    page.get_by_role("button", name="Run and save").click()
    page.get_by_text("saved as run-").wait_for()
    (name,) = server[1].glob("run-*.vtkhdf")
    assert rb.load(name.with_suffix(".nc")) == rb.simulate(
        rb.Case.from_toml(toml(page)), snapshots=tmp_path / "x.vtkhdf", progress=False
    )
    page.wait_for_function("window.rbParticles.frames === 12")

    def changed_by(action):
        before = picture(page, ".rb-scene canvas")
        action()
        page.wait_for_function(
            "(before) => document.querySelector('.rb-scene canvas').toDataURL() !== before", arg=before
        )

    def turn():
        box = page.locator(".rb-scene canvas").bounding_box()
        page.mouse.move(box["x"] + 200, box["y"] + 200)
        page.mouse.down()
        page.mouse.move(box["x"] + 260, box["y"] + 220, steps=3)
        page.mouse.up()

    page.get_by_role("slider", name="time").fill("7")
    page.wait_for_function("window.rbParticles.frame === 7")
    page.wait_for_timeout(1000)
    assert page.evaluate("window.rbParticles.frame") == 7  # it does not play on
    changed_by(lambda: page.locator("label", has_text="colour").locator("select").select_option("spin"))
    changed_by(lambda: page.locator("label", has_text="colour").locator("select").select_option("species"))
    changed_by(lambda: page.get_by_label("cut plane").fill("0"))
    changed_by(turn)
    for file in server[1].glob(f"{name.stem}.*"):  # other tests look for the runs that they keep
        file.unlink()


def test_map_is_clicked_and_the_case_downloaded(page, server, tmp_path):
    """A map fills; a click on a point changes the case; the downloaded case gives the same summary on the command line."""
    page.get_by_role("tab", name="Map").click()
    enter(page, {"from": "0.2 mm", "to": "0.8 mm", "values": "4"})
    page.get_by_role("button", name="Compute map").click()
    page.get_by_text("saved as map-").wait_for()
    page.wait_for_timeout(500)
    box = page.locator(".nicegui-echart")
    x, y = page.evaluate(
        """(id) => {
            const {chart} = getElement(id), {data} = chart.getOption().series[0];
            return chart.convertToPixel({seriesIndex: 0}, data[data.length - 1]);
        }""",
        int(box.get_attribute("id").removeprefix("c")),
    )
    box.click(position={"x": x, "y": y})
    page.wait_for_function("document.querySelector('textarea').value.includes('0.8 mm')")
    assert rb.Case.from_toml(toml(page)).dampers[0].gap == pytest.approx(0.8e-3)
    page.get_by_role("tab", name="Watch").click()  # a late answer to a click may have come after the look at the map
    page.get_by_text("finished at t = 5 s").wait_for()
    page.get_by_role("button", name="Run and save").click()
    page.get_by_text("saved as run-").wait_for()
    page.get_by_text("Summary", exact=True).click()
    summary = page.locator(".font-mono.whitespace-pre").first
    summary.wait_for()
    shown = numbers(summary.inner_text())
    file = download(page, page.get_by_role("button", name="Download case"), tmp_path / "case.toml")
    command = [sys.executable, "-m", "rattlebox.cli", "run", file, "-o", tmp_path / "out"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    (name,) = server[1].glob("run-*.nc")
    assert rb.load(tmp_path / "out" / "run.nc") == rb.load(name)
    assert len(shown) > 15
    assert numbers(done.stdout) == shown
    script = download(page, page.get_by_role("button", name="Python script"), tmp_path / "case.py")
    done = subprocess.run([sys.executable, script], cwd=tmp_path, check=True, capture_output=True, text=True)
    assert numbers(done.stdout) == shown
    page.get_by_role("tab", name="Saved runs").click()
    page.get_by_role("button", name="Download", exact=True).click()
    file = download(page, page.locator(".q-menu").get_by_text("MATLAB"), tmp_path / "run.mat")
    assert file.read_bytes().startswith(b"MATLAB")


def test_narrow_window_and_wrong_input(page):
    """At 1024 pixels nothing is cut; an unknown key and a case beyond the memory have their messages in the page."""
    page.set_viewport_size({"width": 1024, "height": 768})
    for tab in ("Map", "Saved runs", "Drawing", "Watch"):
        page.get_by_role("tab", name=tab).click()
        assert page.evaluate("document.documentElement.scrollWidth") <= 1024
    text = toml(page)
    page.locator("textarea").first.fill(text.replace("gap =", "gapp ="))
    page.get_by_text("there is no such field here").first.wait_for()
    page.get_by_text("the pictures show an earlier case").wait_for()
    page.locator("textarea").first.fill(f'output = {{ rate = "1 THz" }}\n{text}')
    page.get_by_text(re.compile(r"\d GB")).first.wait_for()
    page.locator("textarea").first.fill(text)
    page.get_by_text("finished at t = 5 s").wait_for()


def test_pictures_for_the_documentation(page, tmp_path):
    """The pictures and the film of the documentation can be taken; with PICTURES=FOLDER they are written there."""
    from PIL import Image

    folder = Path(os.environ.get("PICTURES") or tmp_path)
    page.set_viewport_size({"width": 1440, "height": 820})
    page.get_by_text("finished at t = 5 s").wait_for()
    page.wait_for_timeout(700)
    page.screenshot(path=folder / "app_watch.png")
    if os.environ.get("PICTURES"):
        choose(page, "Row of three balls")
        page.get_by_role("tab", name="Map").click()
        enter(page, {"from": "0.3 mm", "to": "30 mm"})
        page.get_by_role("switch", name="log").first.click()
        page.get_by_role("switch", name="ratio").click()
        pick(page, "second parameter", "load.amplitude")
        page.get_by_role("button", name="Compute map").click()
        page.get_by_text("saved as map-").wait_for()
        page.wait_for_timeout(1000)
        page.screenshot(path=folder / "app_map.png")
        page.get_by_role("tab", name="Watch").click()
    choose(page, "Shaken box of balls")
    page.get_by_role("button", name="Run and save").click()
    page.wait_for_function("window.rbParticles && window.rbParticles.frames > 40")
    frames = []
    for _ in range(24 if os.environ.get("PICTURES") else 2):
        shot = Image.open(BytesIO(page.screenshot(clip={"x": 460, "y": 50, "width": 980, "height": 620})))
        frames.append(shot.resize((588, 372)).convert("P", palette=Image.Palette.ADAPTIVE, colors=64))
        page.wait_for_timeout(60)
    page.get_by_text("saved as run-").wait_for()
    page.wait_for_function("window.rbParticles.frames === 200")  # each snapshot once
    page.screenshot(path=folder / "app_particles.png")
    frames[0].save(folder / "app_film.gif", save_all=True, append_images=frames[1:], duration=120, loop=0)
    assert (folder / "app_film.gif").stat().st_size < 1_500_000


def stored(folder, name, text):
    """Compute a case and store it in the folder of the page under a name, as its worker does."""
    worker.run(lambda *_: None, text, str(folder), name, False)
    return [folder / f"{name}{suffix}" for suffix in (".nc", ".vtkhdf")]


def test_map_fills_block_by_block(page):
    """The map in the browser has the points of finished blocks during the study, and all of them at its end."""
    choose(page, "Shaken box of balls")
    short = toml(page).replace("count = 200", "count = 60").replace('duration = "1 s"', 'duration = "0.3 s"')
    page.locator("textarea").first.fill(short.replace(", snapshots = 200", ""))
    page.get_by_role("tab", name="Map").click()
    pick(page, "parameter", "structure.motion.amplitude")
    page.get_by_label("values").first.fill("8")
    page.wait_for_timeout(1000)
    page.get_by_role("button", name="Compute map").click()
    drawn = """() => {
        const box = document.querySelector(".nicegui-echart"), chart = box && getElement(+box.id.slice(1)).chart;
        const {series} = (chart && chart.getOption()) || {};
        return series && series.length ? series[0].data.filter(([x, y]) => y !== null).length : 0;
    }"""
    page.wait_for_function(f"(({drawn})() % 8) > 0", polling=20)  # more than none, fewer than all
    page.get_by_text(re.compile(r"\d of 8 variants")).wait_for()
    page.get_by_text("saved as map-").wait_for()
    page.wait_for_function(f"({drawn})() === 8")


def test_saved_runs_are_compared(page, server, tmp_path):
    """Two ticked runs are drawn in one figure, with the differences of their cases and their results."""
    text = rb.Case.from_toml(toml(page)).to_toml().replace('duration = "5.0 s"', 'duration = "1.0 s"')
    files = stored(server[1], "narrow", text) + stored(server[1], "wide", text.replace('"0.002 m"', '"0.001 m"'))
    page.get_by_role("tab", name="Saved runs").click()
    for name in ("narrow", "wide"):
        page.get_by_role("checkbox", name=name).click()
    page.get_by_role("button", name="Compare the ticked runs").click()
    table = page.locator(".q-tab-panel .font-mono", has_text="Differences of the cases")
    table.wait_for()
    lines = [line.split() for line in table.inner_text().splitlines()]
    assert ["dampers[0].gap", "0.002", "m", "0.001", "m"] in lines
    assert lines[1] == ["narrow", "wide"]
    page.wait_for_function(
        "[...document.querySelectorAll('.rb-charts canvas')].filter((c) => c.offsetParent).length === 2"
    )
    colours = """() => {
        const canvas = [...document.querySelectorAll(".rb-charts canvas")].find((c) => c.offsetParent);
        const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height), found = {};
        for (let i = 0; i < data.length; i += 4) if (data[i + 3] === 255) {
            const name = [data[i], data[i + 1], data[i + 2]].join();
            found[name] = (found[name] || 0) + 1;
        }
        return found;
    }"""
    first, second = (",".join(str(int(c[k : k + 2], 16)) for k in (1, 3, 5)) for c in rb.plots.SERIES_COLOURS[:2])
    page.wait_for_function(f"(({colours})()['{first}'] || 0) > 50 && (({colours})()['{second}'] || 0) > 50")
    if os.environ.get("PICTURES"):
        page.mouse.move(5, 5)
        page.screenshot(path=Path(os.environ["PICTURES"]) / "app_compare.png")
    for file in files:
        file.unlink(missing_ok=True)


def test_case_files_are_opened(page, tmp_path):
    """A case file from elsewhere is opened; one with an unknown key has its message in the page, and loses nothing."""
    page.get_by_text("finished at t = 5 s").wait_for()
    good, bad, binary = (tmp_path / name for name in ("good.toml", "bad.toml", "binary.toml"))
    text = toml(page).replace('"2 mm"', '"1.6 mm"')
    good.write_text(text)
    bad.write_text(text.replace("gap =", "gapp ="))
    binary.write_bytes(b"\x89PNG\xff")

    def choose_file(file):
        page.get_by_role("button", name="Open", exact=True).click()
        page.locator("input[type=file]").set_input_files(file)
        page.locator(".q-dialog").wait_for(state="detached")  # it fades out
        page.wait_for_function("!Object.values(mounted_app.elements).some(({tag}) => tag.includes('dialog'))")

    choose_file(good)
    page.wait_for_function("document.querySelector('textarea').value.includes('1.6 mm')")
    page.get_by_text("finished at t = 5 s").wait_for()
    choose_file(bad)
    page.get_by_text("gapp: there is no such field here").first.wait_for()
    page.get_by_text("did you mean 'gap'?").first.wait_for()
    assert not page.locator(".rb-charts").first.is_visible()  # no picture of another case
    choose_file(binary)
    page.get_by_text("binary.toml is not a text in UTF-8").wait_for()
    assert "gapp" in toml(page)
    choose_file(good)
    page.get_by_text("finished at t = 5 s").wait_for()


def test_paused_run_is_resumed_after_a_reload(page, server):
    """After Pause and a reload, the page lists the paused run, and Resume completes it."""
    choose(page, "Shaken box of balls")
    short = toml(page).replace("count = 200", "count = 60").replace('duration = "1 s"', 'duration = "5 s"')
    page.locator("textarea").first.fill(short.replace("snapshots = 200", "snapshots = 12"))
    page.wait_for_timeout(1000)
    before = set(server[1].glob("run-*.vtkhdf"))
    page.get_by_role("button", name="Run and save").click()
    page.get_by_text("computed up to t").wait_for()
    page.get_by_role("button", name="Pause").first.click()
    page.get_by_text("paused; Run and save resumes").wait_for()
    page.reload()
    page.get_by_role("tab", name="Saved runs (1 paused)").click()
    page.get_by_role("button", name="Resume").click()
    page.get_by_text(re.compile("saved as run-")).wait_for()
    (name,) = set(server[1].glob("run-*.vtkhdf")) - before
    assert rb.load(name.with_suffix(".nc")).status == "finished"
    page.wait_for_function("window.rbParticles.frames === 12")
    for file in server[1].glob(f"{name.stem}.*"):
        file.unlink()


def test_frame_of_a_thousand_particles(page, server):
    """Without drawing, a frame of 1000 particles takes the processor a small part of the 33 ms of 30 frames a second."""
    text = template("box").replace("count = 200", "count = 1000").replace('"settled"', '"lattice"')
    text = text.replace('["50 mm", "36 mm", "36 mm"]', '["90 mm", "72 mm", "72 mm"]')
    files = stored(server[1], "thousand", text.replace('"1 s"', '"3 ms"').replace("snapshots = 200", "snapshots = 30"))
    page.get_by_role("tab", name="Saved runs").click()
    page.get_by_role("button", name="Open its case").first.click()
    page.wait_for_function("window.rbParticles && window.rbParticles.frames === 30")
    assert page.evaluate("window.rbParticles.particles") == 1000
    decode, update = page.evaluate(
        """async () => {
            const {fetchBody} = await import("rattlebox-binary");
            const box = document.querySelector(".rb-scene").parentElement, view = getElement(+box.id.slice(1));
            view.playing = false;
            const timed = async (count, action) => {
                const times = [];
                for (let k = 0; k < count; k++) {
                    const start = performance.now();
                    await action(k);
                    times.push(performance.now() - start);
                }
                return times.sort((a, b) => a - b)[Math.floor(count / 10)]; // on a busy machine most take longer
            };
            const body = await (await fetch(`${view.url}?first=0`)).blob();
            const load = () => fetchBody(URL.createObjectURL(body));
            return [await timed(20, load) / 30, await timed(120, (k) => { view.frame = k % 30; view.show(); })];
        }"""
    )
    print(f"\na frame of 1000 particles: {decode:.2f} ms to decode, {update:.2f} ms to update")
    assert decode + update < 33 / 4
    for file in files:
        file.unlink(missing_ok=True)


DEEP = '42["event",' + "[" * 200_000 + "]" * 200_000 + "]"
SOCKET = "/_nicegui_ws/socket.io/?EIO=4&transport="


def test_server_refuses_others(server):
    """Without the token, with another host or origin, with tricks in paths or numbers, the server itself refuses."""
    address, token = re.match(r"http://(.*?)/\?token=(.*)", server[0]).groups()
    upgrade = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
    }

    def status(path, **headers):
        connection = HTTPConnection(address, timeout=120)
        connection.request("GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()})
        return connection.getresponse().status

    assert status(f"/?token={token}") == 200
    assert status("/") == 403
    assert status(f"/?token={token}", Host="evil.example") == 403
    assert status(f"/?token={token}", Origin="http://evil.example") == 403
    assert status(f"/data/%2e%2e/x?token={token}") == 400
    assert status(f"/data/x/1?first=1e400&token={token}") == 422
    assert status(f"/data/x/1?first={'9' * 5000}&token={token}") in (404, 422)
    assert status(f"{SOCKET}polling&token={token}", Origin="http://evil.example") == 403

    socket = f"{SOCKET}websocket"
    assert status(f"{socket}&token={token}", **upgrade) == 101
    assert status(socket, **upgrade) == 403
    assert status(f"{socket}&token={token}", Origin="http://evil.example", **upgrade) == 403
    assert status(f"{socket}&token={token}", Host="evil.example", **upgrade) == 403


def test_deep_and_huge_messages_are_dropped(page, server):
    """Deep JSON, huge numbers and rubbish, sent by requests and by websockets, leave the server as it was."""
    messages = [DEEP, f'42["event",{"9" * 5000}]', "4" + "9" * 100_000, "451-[", "rubbish", "4" * 3_000_000]
    send = """async ([url, text]) => {
        const socket = new WebSocket(url);
        const message = () => new Promise((resolve) => { socket.onmessage = socket.onclose = resolve; });
        await message();
        socket.send("40");
        await message();
        socket.send(text);
        await Promise.race([message(), new Promise((resolve) => setTimeout(resolve, 300))]);
        socket.close();
    }"""
    for text in messages:
        page.evaluate(send, [f"{server[0].partition('/?')[0].replace('http', 'ws')}{SOCKET}websocket", text])
    polled = """async ([url, text]) => {
        const start = await (await fetch(url)).text();
        return (await fetch(`${url}&sid=${JSON.parse(start.slice(1)).sid}`, {method: "POST", body: text})).status;
    }"""
    assert page.evaluate(polled, [f"{SOCKET}polling", DEEP]) in (200, 400)
    page.get_by_role("switch", name="compare without damper").click()
    page.get_by_text("finished at t = 5 s").wait_for()
    page.wait_for_function("window.rbDrawn.count > 1")


def workers(parent=None, among=()):
    """Return the numbers of the running processes that compute for a server, or of those among some."""
    lines = subprocess.run(["ps", "-wweo", "pid=,ppid=,stat=,args="], capture_output=True, text=True, check=True).stdout
    rows = [line.split(maxsplit=3) for line in lines.splitlines()]
    ours = [(int(pid), int(above)) for pid, above, state, text in rows if "spawn_main" in text and state[0] != "Z"]
    return [pid for pid, above in ours if above == parent or pid in among]


def test_closed_page_and_killed_server(browser, tmp_path):
    """Closing the page ends its run; after kill -9 of the server its workers end, and finished results are intact."""

    def start_box():
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.set_default_timeout(LONG)
        page.goto(address)
        page.get_by_text("finished at t = 5 s").wait_for()
        page.get_by_role("button", name="Run and save").click()
        page.get_by_text("saved as run-").wait_for()
        choose(page, "Shaken box of balls")
        page.locator("textarea").first.fill(toml(page).replace('duration = "1 s"', 'duration = "100 s"'))
        page.wait_for_timeout(1000)
        page.get_by_role("button", name="Run and save").click()
        page.get_by_text(re.compile(r"\d % of \d+ steps")).wait_for()
        return page

    def wait_until(condition):
        end = time.monotonic() + 120
        while not condition():
            assert time.monotonic() < end
            time.sleep(0.1)

    with served(tmp_path) as (process, address):
        page = start_box()
        assert len(workers(process.pid)) == 3  # the live view, the run, and one in advance
        page.close()
        wait_until(lambda: len(workers(process.pid)) == 1)
        page = start_box()
        computing = workers(process.pid)
        process.kill()
        wait_until(lambda: not workers(among=computing))
        page.close()
    kept = [rb.load(file) for file in tmp_path.glob("run-*.nc")]
    assert [run.status for run in kept] == ["finished", "finished"]


def mapped(page, file, parameter, low, high, count, measure, *, log=False):
    """Compute a map as the lecture sheet says, and return parameter and measure of the downloaded table."""
    page.get_by_role("tab", name="Map").click()
    pick(page, "parameter", parameter)
    enter(page, {"from": low, "to": high, "values": str(count)})
    if log:
        page.get_by_role("switch", name="log").first.click()
    page.get_by_label("measure").fill(measure)
    page.get_by_role("option", name=measure, exact=True).click()
    page.get_by_role("button", name="Compute map").click()
    page.get_by_role("button", name="Stop").wait_for()
    page.get_by_role("button", name="Compute map").wait_for(timeout=20 * LONG)
    page.get_by_text("saved as map-").wait_for()
    file = download(page, page.get_by_role("button", name="CSV table"), file)
    table = pd.read_csv(file, comment="#")
    assert len(table) == count
    (name,) = (name for name, each in rb.MEASURES.items() if each.long_name == measure)
    return table[parameter].to_numpy(), table[name].to_numpy()


def test_lecture_best_gap_and_chaos(page, tmp_path):
    """The first two experiments of the lecture sheet give its numbers in the page."""
    choose(page, "Row of three balls")
    page.get_by_text("finished at t = 3 s").wait_for()
    gap, rms = mapped(page, tmp_path / "a.csv", "damper.gap", "0.3 mm", "100 mm", 40, "RMS displacement", log=True)
    gap, rms = 1e3 * gap, 1e3 * rms
    assert rms.min() == pytest.approx(1.3, abs=0.05)
    assert 4 < gap[rms.argmin()] < 8
    assert np.allclose(rms[gap > 14], 3.0, atol=0.01)
    choose(page, "Ball of the reference paper")
    page.get_by_role("tab", name="Watch").click()
    page.get_by_text("finished at t = 5 s").wait_for()
    _, impacts = mapped(page, tmp_path / "b.csv", "damper.start", "-0.1", "0.1", 21, "impacts")
    assert (impacts.min(), impacts.max()) == (196, 236)
    _, rms = mapped(page, tmp_path / "c.csv", "damper.start", "-0.1", "0.1", 21, "RMS displacement")
    assert np.ptp(rms) < 0.006 * rms.mean()


@pytest.mark.slow
def test_lecture_number_of_balls_and_amplitude(page, server, tmp_path):
    """The last two experiments of the lecture sheet give its numbers in the page."""
    choose(page, "Shaken box of balls")
    page.wait_for_timeout(1000)
    text = toml(page).replace('duration = "1 s"', 'duration = "0.5 s"')
    before, losses = set(server[1].glob("run-*.nc")), []
    for diameter in (12, 8, 6):
        balls = f'diameter = "{diameter} mm", mass = "60 g"'
        page.locator("textarea").first.fill(text.replace('diameter = "6 mm", count = 200', balls))
        page.wait_for_timeout(1000)
        page.get_by_role("button", name="Run and save").click()
        page.get_by_role("button", name="Cancel").wait_for()
        page.get_by_role("button", name="Run and save").wait_for(timeout=20 * LONG)
        (file,) = set(server[1].glob("run-*.nc")) - before
        before.add(file)
        values = rb.load(file).summary().values
        losses.append(1e3 * values["supplied_energy"] * (1 - values["share_motion"]))
    assert np.allclose(losses, [240, 250, 200], rtol=0.1)
    page.locator("textarea").first.fill(text.replace(", snapshots = 200", ""))
    page.wait_for_timeout(1000)
    measure, axis = "loss in the damper", "structure.motion.amplitude"
    amplitude, loss = mapped(page, tmp_path / "d.csv", axis, "0.5 mm", "20 mm", 8, measure, log=True)
    quotient = 1e-3 * loss / amplitude**2
    assert quotient.argmax() in (5, 6)
    assert np.allclose(quotient[[0, 5, 7]], [2.1, 10, 5.6], rtol=0.12)
