"""What the reader of a page waits for, in a browser on a machine that does nothing else: `pytest benchmarks`."""

from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from tests.browser.conftest import browser, press_report, press_study, report  # noqa: F401  (fixtures)
from tests.browser.test_bench import bench  # noqa: F401

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

FRAME = 1000 / 60  # ms
MAX_PAINT_RATIO = 2.2  # times the first paint of an empty page; 1.8 measured, 2.9 where all is laid out first
MAX_TASK_RATIO, THROTTLE = (
    3.0,
    4,
)  # a figure's longest task over that of the page itself: 1.7 measured, 77 by plotly's script
LOADS, ROUNDS = 5, 6  # the median of some loads; again, since other programs run
TASKS = """window.tasks = [];
const noted = list => list.getEntries().forEach(({ startTime, duration }) => tasks.push([startTime, duration]));
new PerformanceObserver(noted).observe({ type: 'longtask', buffered: true });"""


def test_first_paint_takes_about_two_empty_pages(browser: "Browser", press_report: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty.html"
    empty.write_text("<!doctype html><title>empty</title><p>empty")
    ratios: list[float] = []
    while len(ratios) < ROUNDS and not (ratios and ratios[-1] <= MAX_PAINT_RATIO):
        paths = empty, press_report / "report.html"
        of_empty, of_report = (median(first_paint(browser, path) for _ in range(LOADS)) for path in paths)
        ratios.append(of_report / of_empty)
    assert ratios[-1] <= MAX_PAINT_RATIO, f"{ratios} times that of an empty page"


def test_drawing_figures_holds_up_the_page_no_longer_than_its_text(browser: "Browser", press_report: Path) -> None:
    """On a slow processor, by the longest task after the page has loaded, in which the first figures are drawn."""
    ratios: list[float] = []
    while len(ratios) < ROUNDS and not (ratios and ratios[-1] <= MAX_TASK_RATIO):
        page = browser.new_page(viewport={"width": 1400, "height": 900}, reduced_motion="reduce")
        rate = {"rate": THROTTLE}
        page.context.new_cdp_session(page).send("Emulation.setCPUThrottlingRate", rate)
        page.add_init_script(TASKS)
        page.goto((press_report / "report.html").as_uri())
        page.evaluate("document.querySelector('.plot').scrollIntoView()")
        page.wait_for_selector(".plot .uplot")
        page.wait_for_timeout(1000)
        loaded = page.evaluate("performance.getEntriesByType('navigation')[0].loadEventEnd")
        before, after = (
            # Browsers report only tasks of 50 ms and more: without any the longest one is taken for 50 ms.
            max((time for start, time in page.evaluate("tasks") if (start >= loaded) == late), default=50.0)
            for late in (False, True)
        )
        ratios.append(after / before)
        page.close()
    assert ratios[-1] <= MAX_TASK_RATIO, f"{ratios} times the longest task before"


def test_values_of_a_curve_are_replaced_within_a_frame(report: "Page") -> None:
    """As often as there are frames."""
    median_time = report.evaluate(
        """async () => {
          const { plot } = document.querySelector('.plot'), frame = () => new Promise(requestAnimationFrame);
          const [{ traces: [trace] }] = plot.panels, { y } = trace, times = [];
          for (let n = 0; n < 30; n++) {
            plot.replace(trace, y.map(v => v + n));
            await frame();
            const start = performance.now();
            plot.refresh();
            await null;
            times.push(performance.now() - start);
          }
          plot.replace(trace, y);
          plot.refresh();
          await null;
          return times.sort((a, b) => a - b)[15];
        }"""
    )
    assert median_time < FRAME


def test_an_edit_takes_less_than_a_frame(browser: "Browser", bench: "Page") -> None:
    """Of processor time, since others use the machine too: 360 positions, and all that follows a typed number."""
    bench.evaluate(
        """async () => {
          const packed = Uint8Array.from(atob(document.getElementById("design").textContent), c => c.charCodeAt(0));
          const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
          const data = JSON.parse(await new Response(unpacked).text()), line = Function(`return ${data.line}`)();
          const rows = [...data.channels, ""].map(() => new Float64Array(360));
          const given = Object.values(data.given).map(() => Float64Array.from({ length: 360 }, (_, n) => n / 57));
          const numbers = data.numbers.map(({ value }) => value), box = document.querySelector("#bench [type=number]");
          window.solve = times => { while (times--) line(numbers, given, rows, 360); };
          window.edit = times => {
            while (times--) {
              box.value = +box.value + 0.01;
              box.dispatchEvent(new Event("input", { bubbles: true }));
            }
          };
        }"""
    )
    processes = browser.new_browser_cdp_session()

    def taken(run: str, times: int) -> float:
        """The processor time of one of so many runs, ms: the best of some, since others share the core's units."""

        def used() -> float:
            known = processes.send("SystemInfo.getProcessInfo")["processInfo"]
            return sum(float(process["cpuTime"]) for process in known if process["type"] == "renderer")

        best = np.inf
        for _ in range(8):
            # Processor time of the renderer process by the browser's own protocol. A clock of the page would count what
            # other processes take, and is rounded on purpose against timing attacks.
            before = used()
            bench.evaluate(f"{run}({times})")
            best = min(best, used() - before)
        return 1e3 * best / times

    solved, edited = taken("solve", 400), taken("edit", 10)
    bench.locator(".undo").click()
    assert solved < 0.3
    assert edited < 16


def first_paint(browser: "Browser", path: Path) -> float:
    """The time to the first contentful paint, ms."""
    page = browser.new_page()
    page.goto(path.as_uri(), wait_until="commit")
    page.wait_for_function("performance.getEntriesByName('first-contentful-paint').length")
    time = float(page.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime"))
    page.close()
    return time
