"""The application in a real browser: what a user clicks, drags and sees. `make app-test` runs these tests."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from http.client import HTTPConnection
from io import BytesIO
from pathlib import Path

import pytest

import rattlebox as rb

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


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """Start `rattlebox app` and return its address and folder."""
    folder = tmp_path_factory.mktemp("app")
    command = [sys.executable, "-m", "rattlebox.cli", "app", str(folder), "--no-browser"]
    ours = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}  # NiceGUI reads them
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=ours)
    try:
        lines = []
        while not (found := re.search(r"http://127\.0\.0\.1:\d+/\?token=\S+", "".join(lines))):
            lines.append(process.stdout.readline())
            assert process.poll() is None, lines
        yield found[0], folder
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)


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
    page.goto(server[0])
    page.wait_for_function("window.rbDrawn !== undefined")
    yield page
    page.close()
    assert problems == []
    assert [url for url in requests if not url.startswith(("http://127.0.0.1:", "data:", "blob:"))] == []


def choose(page, template):
    """Choose a template."""
    page.get_by_label("template").click()
    page.get_by_role("option", name=template).click()


def toml(page):
    """Return the text of the case."""
    page.get_by_role("tab", name="TOML").click()
    return page.locator("textarea").first.input_value()


def test_slider_changes_the_curve(page):
    """Dragging a slider draws the motion again and changes the case."""
    page.get_by_text("finished at t = 5 s").wait_for()
    drawn = page.evaluate("window.rbDrawn.count")
    box = page.get_by_label("damper.gap").bounding_box()
    times = []
    for step in range(6):
        before, start = page.evaluate("[window.rbDrawn.count, performance.now()]")
        page.mouse.move(box["x"] + box["width"] * (0.5 + 0.05 * step), box["y"] + box["height"] / 2)
        page.mouse.down() if step == 0 else None
        page.wait_for_function(f"window.rbDrawn.count > {before}") if step else None
        times.append(page.evaluate("window.rbDrawn.at") - start)
    page.mouse.up()
    print(f"slider to picture: {min(times[1:]):.0f} to {max(times[1:]):.0f} ms")
    print(
        "first paint:", page.evaluate("performance.getEntriesByType('paint').map(e => Math.round(e.startTime))"), "ms"
    )
    assert page.evaluate("window.rbDrawn.count") > drawn
    assert rb.Case.from_toml(toml(page)).dampers[0].gap > 0.5e-3
    assert page.locator(".rb-charts canvas").count() == 4


def test_box_of_balls_moves_and_is_cancelled(page, server):
    """Two hundred spheres move during the run; Cancel leaves no files."""
    choose(page, "Shaken box of balls")
    page.get_by_role("button", name="Run and keep").click()
    page.wait_for_function("window.rbParticles && window.rbParticles.frames > 3")
    assert page.evaluate("window.rbParticles.particles") == 200
    frame = page.evaluate("window.rbParticles.frame")
    page.wait_for_function(f"window.rbParticles.frame !== {frame}")
    page.get_by_role("button", name="Cancel").click()
    page.get_by_text("cancelled").wait_for()
    assert not list(server[1].glob("*.vtkhdf"))


def test_map_is_clicked_and_the_case_downloaded(page, server, tmp_path):
    """A map fills; a click on a point changes the case; the downloaded case gives the same summary on the command line."""
    page.get_by_role("tab", name="Map").click()
    page.get_by_label("from").first.fill("0.2 mm")
    page.get_by_label("to", exact=True).first.fill("0.8 mm")
    page.get_by_label("values").first.fill("4")
    page.get_by_role("button", name="Compute map").click()
    page.get_by_text("kept as map-").wait_for()
    page.wait_for_timeout(500)
    chart = page.locator(".nicegui-echart").first.bounding_box()
    for step in range(40):  # look for the last point of the line
        page.mouse.click(chart["x"] + chart["width"] - 20, chart["y"] + 18 + step * (chart["height"] - 60) / 40)
        if "0.8 mm" in toml(page):
            break
        page.get_by_role("tab", name="Map").click()
    assert rb.Case.from_toml(toml(page)).dampers[0].gap == pytest.approx(0.8e-3)
    page.get_by_role("tab", name="Watch").click()  # a late answer to a click may have come after the look at the map
    page.get_by_text("finished at t = 5 s").wait_for()
    page.get_by_role("button", name="Run and keep").click()
    page.get_by_text("kept as run-").wait_for()
    with page.expect_download() as event:
        page.get_by_role("button", name="Download case").click()
    file = tmp_path / "case.toml"
    event.value.save_as(file)
    subprocess.run([sys.executable, "-m", "rattlebox.cli", "run", file, "-o", tmp_path / "out"], check=True)
    (name,) = server[1].glob("run-*.nc")
    assert rb.load(tmp_path / "out" / "run.nc") == rb.load(name)


def test_narrow_window_and_wrong_input(page):
    """At 1024 pixels nothing is cut; an unknown key has its message in the page."""
    page.set_viewport_size({"width": 1024, "height": 768})
    assert page.evaluate("document.documentElement.scrollWidth") <= 1024
    text = toml(page).replace("gap =", "gapp =")
    page.locator("textarea").first.fill(text)
    page.get_by_text("there is no such field here").first.wait_for()


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
        page.get_by_label("from").first.fill("0.3 mm")
        page.get_by_label("to", exact=True).first.fill("30 mm")
        page.get_by_role("switch", name="log").first.click()
        page.get_by_role("switch", name="ratio").click()
        page.get_by_label("second parameter").click()
        page.get_by_role("option", name="load.amplitude").click()
        page.get_by_role("button", name="Compute map").click()
        page.get_by_text("kept as map-").wait_for()
        page.wait_for_timeout(1000)
        page.screenshot(path=folder / "app_map.png")
        page.get_by_role("tab", name="Watch").click()
    choose(page, "Shaken box of balls")
    page.get_by_role("button", name="Run and keep").click()
    page.wait_for_function("window.rbParticles && window.rbParticles.frames > 40")
    frames = []
    for _ in range(24 if os.environ.get("PICTURES") else 2):
        shot = Image.open(BytesIO(page.screenshot(clip={"x": 460, "y": 50, "width": 980, "height": 620})))
        frames.append(shot.resize((588, 372)).convert("P", palette=Image.Palette.ADAPTIVE, colors=64))
        page.wait_for_timeout(60)
    page.screenshot(path=folder / "app_particles.png")
    frames[0].save(folder / "app_film.gif", save_all=True, append_images=frames[1:], duration=120, loop=0)
    assert (folder / "app_film.gif").stat().st_size < 1_500_000


def test_server_refuses_others(server):
    """Without the token, with another host or origin, and with a path that leads out, the server itself refuses."""
    address, token = re.match(r"http://(.*?)/\?token=(.*)", server[0]).groups()

    def status(path, **headers):
        connection = HTTPConnection(address, timeout=30)
        connection.request("GET", path, headers=headers)
        return connection.getresponse().status

    assert status(f"/?token={token}") == 200
    assert status("/") == 403
    assert status(f"/?token={token}", Host="evil.example") == 403
    assert status(f"/?token={token}", Origin="http://evil.example") == 403
    assert status(f"/data/%2e%2e/x?token={token}") == 400
    assert status(f"/data/x/1?first=1e400&token={token}") == 422
    assert status(f"/data/x/1?first={'9' * 5000}&token={token}") in (404, 422)
    assert status(f"/_nicegui_ws/socket.io/?EIO=4&transport=polling&token={token}", Origin="http://evil.example") == 403


def test_killed_server_keeps_what_was_finished(tmp_path):
    """After kill -9 the finished results are intact, and the workers end."""
    from rattlebox.app.draft import template

    text = template("steel_ball").replace("5 s", "0.2 s")
    code = (
        "import sys, asyncio, rattlebox\nfrom rattlebox.app.jobs import Worker\n"
        "async def main():\n"
        "    first, second = Worker(), Worker()\n"
        f"    await first.do('run', {text!r}, {str(tmp_path)!r}, 'run-001', False)\n"
        f"    print(second.pid, flush=True)\n"
        f"    await second.do('run', {template('box')!r}, {str(tmp_path)!r}, 'run-002', False)\n"
        "if __name__ == '__main__':\n    asyncio.run(main())\n"
    )
    script = tmp_path / "main.py"
    script.write_text(code)
    process = subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True)
    pid = int(process.stdout.readline())
    while not (tmp_path / "run-002.checkpoint").exists():
        assert process.poll() is None
        time.sleep(0.1)
    process.kill()
    process.wait()
    for _ in range(100):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            break
        time.sleep(0.2)
    else:
        pytest.fail("the worker did not end")
    assert rb.load(tmp_path / "run-001.nc").status == "finished"
