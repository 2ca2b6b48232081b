"""The page of sliders in a browser: a slider moved by keys gives the rates of ``tipoff.run``."""

import os
import shutil
import socket
import statistics
import subprocess
import sys
import time

import pytest

import tipoff
from tests.docs.pages import ROOT

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
MOST_MS = 5000.0  # a bound for a loaded machine; alone it takes below 100 ms
# From a key to the first drawing of other values, measured in the page.
WATCH = """root => addEventListener('keydown', () => {
  const began = performance.now(), was = root.dataset.drawn.split(' ')[0];
  window.drawn = new Promise((done) => {
    const watcher = new MutationObserver(() => {
      if (root.dataset.drawn.split(' ')[0] === was) return;
      watcher.disconnect();
      done(performance.now() - began);
    });
    watcher.observe(root, { attributes: true });
  });
}, true)"""


@pytest.fixture(scope="module")
def browser():
    pytest.importorskip("marimo", reason="marimo is not installed: make examples installs it")
    api = pytest.importorskip(
        "playwright.sync_api", reason="playwright is not installed: make examples installs it"
    )
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        pytest.skip(f"no browser on the path: {', '.join(BROWSERS)}")
    with api.sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def address(browser, tmp_path_factory):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    log = tmp_path_factory.mktemp("served") / "log.txt"
    command = [sys.executable, "-m", "marimo", "run", ROOT / "docs/examples/what_if.py"]
    with log.open("w") as said:
        server = subprocess.Popen(
            [*command, "--headless", "--port", str(port), "--", "--scene", "tiny"],
            cwd=ROOT,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
            stdout=said,
            stderr=subprocess.STDOUT,
        )
    try:
        for _ in range(600):
            if server.poll() is not None:
                pytest.fail(log.read_text())
            with socket.socket() as asked:
                if asked.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.1)
        yield f"http://127.0.0.1:{port}"
    finally:
        server.terminate()
        server.wait(timeout=30)


@pytest.fixture(scope="module")
def page(browser, address):
    """The page after its first final run, and the errors of its console; each test goes on where the
    one before left it."""
    opened = browser.new_page(viewport={"width": 1500, "height": 1000})
    errors: list[str] = []
    opened.on("pageerror", lambda error: errors.append(str(error)))
    opened.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
    opened.goto(address)
    opened.locator(".ejection[data-drawn$=final]").wait_for(timeout=500_000)
    yield opened, errors
    opened.close()


def shown(page) -> list[str]:
    """Exit rates (deg/s) on the page."""
    return [page.locator(f'[data-name="rate-{axis}"]').inner_text() for axis in "xyz"]


def expected(**changes: float) -> list[str]:
    """Those of ``tipoff.run``, as the page writes them."""
    keys = {name.replace("__", "."): value for name, value in changes.items()}
    rates = tipoff.run(tipoff.load("tiny").replace(keys)).outcome.rate
    return [f"{57.29577951308232 * rate:.3f}" for rate in rates]


def press(page, slider: int, key: str, count: int) -> list[float]:
    """Times (ms) from each press of a key to the drawing of its run."""
    page.get_by_role("slider").nth(slider).focus()
    spent = []
    for _ in range(count):
        page.keyboard.press(key)
        spent.append(page.evaluate("window.drawn"))
    return spent


def test_sliders_give_the_rates_of_run(page, capsys):
    opened, errors = page
    begun = shown(opened)
    assert begun == expected()  # the first test of the page
    drawing = opened.locator(".ejection")
    drawing.evaluate(WATCH)
    sliders = opened.get_by_role("slider")
    assert sliders.count() >= 9
    spent = press(opened, 0, "ArrowRight", 8)  # 0.1 to 0.18 deg
    spent += press(opened, 7, "ArrowLeft", 5)  # friction, 0.2 to 0.15
    opened.locator(".ejection[data-drawn$=final]").wait_for(timeout=300_000)
    assert shown(opened) != begun
    radians = 0.18 * 0.017453292519943295
    changed = {"thrust_offset__misalignment__axial": radians}
    assert shown(opened) == expected(**changed, friction__dynamic=0.15, friction__static=0.15)
    words = opened.locator('[data-name="error"]')
    words.filter(has_text="deg/s about each axis, mostly by the ").wait_for(timeout=300_000)
    # the launcher as scene.plot() draws it, in a cell of its own; one image, or this is an error
    opened.locator("img").wait_for(timeout=300_000)
    assert errors == []
    with capsys.disabled():
        print(f"\nslider to frame: median {statistics.median(spent):.0f} ms, best {min(spent):.0f}")
    assert statistics.median(spent) < MOST_MS


def test_it_plays_pauses_and_compares(page):
    opened, errors = page
    instant = opened.locator('[data-name="time"]')
    opened.get_by_role("button", name="Pause").click()
    at_rest = instant.inner_text()
    opened.wait_for_timeout(500)
    assert instant.inner_text() == at_rest
    opened.get_by_role("button", name="Play").click()
    opened.wait_for_function(
        "([place, text]) => place.textContent !== text", arg=[instant.element_handle(), at_rest]
    )
    opened.get_by_role("button", name="Compare with this run").click()
    opened.locator(".ejection").evaluate(WATCH)
    press(opened, 8, "ArrowRight", 1)
    assert opened.locator('[data-name="change-z"]').inner_text() != "+0.000"
    assert errors == []


def test_a_fault_of_a_scene_is_shown(page):
    opened, _ = page
    field = opened.get_by_label("Scene: a name of the catalogue")
    field.fill("no_such_launcher")
    field.press("Enter")
    opened.get_by_text("an unknown name", exact=False).first.wait_for(timeout=60_000)
