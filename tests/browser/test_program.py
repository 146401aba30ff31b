"""The page's program has the numbers of the core, before and after edits."""

import json
from collections.abc import Iterator
from importlib.resources import files as resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import analytic
from analytic import page_program
from compare.report.plain import plain
from scenes import Sampling, Scene, Status, load, shipped, with_changes
from scenes.drive import Samples
from tests import scene_files
from tests.comparisons import sampled

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser

SAMPLING = Sampling(120)
LARGER = {"class_iii", "dump_truck", "scissor_lift"}  # with a group that is solved by Newton's method
CLAMPS = {"double_toggle_clamp", "double_toggle_clamp_friction", "double_toggle_clamp_scheme4"}  # near a singular pose
ROUND_OFF = 1e-9  # of a channel's scale: one that is less is nothing but round-off
EDITS = 10  # of each of 20 scenes
# What the page's script has around it in a report: where its data come from, and what the picture has read.
STUB = """<script type=module>
const unpacked = async () => document.getElementById("data").textContent, pause = async () => {};
const head = { quanta: [], channels: [] }, value = () => NaN, count = %d;
document.body.append(Object.assign(document.createElement("div"), { id: "bench" }));
%s
window.after = numbers => {
  const own = Float64Array.from(numbers);
  return [solve(own, arrays(count)).map(row => [...row]), [...own]];
};
</script>"""


@pytest.fixture(scope="module")
def blank(browser: "Browser") -> "Iterator[Page]":
    page = browser.new_page()
    yield page
    page.close()


def solved_in(page: "Page", scene: Scene, folder: Path, numbers: Samples) -> tuple[list[str], Samples, Samples]:
    """The channels, what the page's program has for them and the reach, shape (edits, channels + 1, n).

    Last are its numbers, with the ends of strokes that it found.
    """
    position, time = SAMPLING.commanded(scene), SAMPLING.times(scene)
    program = page_program(scene, position, time)
    assert program is not None
    named = [{"path": path, "value": value} for path, value in zip(program["numbers"], program["values"], strict=True)]
    data = {**program, "numbers": named, "extent": scene.drive.law.extent, "demands": [], "wound": {}}
    script = resources("compare.report.bench").joinpath("program.js").read_text(encoding="utf-8")
    text = f"<!doctype html><meta charset=utf-8><body><script type=json id=data>{json.dumps(plain(data))}</script>"
    (folder / "page.html").write_text(text + STUB % (len(position), script), encoding="utf-8")
    page.goto((folder / "page.html").as_uri())
    page.wait_for_function("'after' in window")
    answers = [page.evaluate("numbers => after(numbers)", list(own)) for own in numbers]
    return program["channels"], *(np.array(part, float) for part in zip(*answers, strict=True))


def dyads() -> list[str]:
    return sorted(set(shipped()) - LARGER)


def differences(channels: list[str], page: Samples, core: Any) -> Samples:
    """By channel the largest difference, as a part of its peak, or of a billionth of the linkage's largest."""
    truth = np.array([core[channel] for channel in channels])
    largest: dict[str, float] = {}
    for channel, values in zip(channels, truth, strict=True):
        kind = channel.rpartition(".")[2]
        largest[kind] = max(largest.get(kind, 0.0), float(np.abs(values).max()))
    floor = np.array([ROUND_OFF * largest[channel.rpartition(".")[2]] + 1e-300 for channel in channels])
    return np.asarray(np.abs(page[:-1] - truth).max(axis=1) / np.maximum(np.abs(truth).max(axis=1), floor))


@sampled(4)
@pytest.mark.parametrize("name", dyads())
def test_the_page_has_the_numbers_of_the_core(blank: "Page", name: str, tmp_path: Path) -> None:
    """To 1e-12 of each channel's peak; of the clamps, whose forces are differences of large ones, to 2e-12."""
    scene = load(name)
    position, time = SAMPLING.commanded(scene), SAMPLING.times(scene)
    program = page_program(scene, position, time)
    assert program is not None
    channels, (rows,), _ = solved_in(blank, scene, tmp_path, np.array([program["values"]]))
    off = differences(channels, rows, analytic.solve(scene, position, time))
    assert (off <= (2e-12 if name in CLAMPS else 1e-12)).all(), channels[int(np.argmax(off))]
    assert (rows[-1] >= 0).all()


@pytest.mark.slow
def test_the_page_has_the_numbers_of_the_core_after_edits(blank: "Page", tmp_path: Path) -> None:
    """Of 200 machines, three numbers of each changed by some per cent, to 1e-10 where the core assembles them."""
    random, compared = np.random.default_rng(29), 0
    for scene in (*map(load, dyads()), scene_files.load("elements")):
        position, time, name = SAMPLING.commanded(scene), SAMPLING.times(scene), scene.name
        program = page_program(scene, position, time)
        assert program is not None
        own = [k for k, path in enumerate(program["numbers"]) if path in scene.numbers and "along" not in path]
        chosen = random.choice([k for k in own if program["values"][k]], 3, replace=False)
        if "drive.speed" in program["numbers"]:
            chosen[0] = program["numbers"].index("drive.speed")
        factors = 1 + 0.02 * random.standard_normal((EDITS, 3))
        numbers = np.tile(program["values"], (EDITS, 1))
        numbers[:, chosen] *= factors
        paths = [program["numbers"][k] for k in chosen]
        changes = {p: numbers[:, k] / scene.size(scene.numbers[p]) for p, k in zip(paths, chosen, strict=True)}
        steady = type(scene.drive.law).__name__ == "ConstantSpeed"
        core = analytic.solve_many(scene, changes, position, None if steady else time)
        channels, rows, found = solved_in(blank, scene, tmp_path, numbers)
        for machine in np.flatnonzero(core.ok).tolist():
            one = {channel: core[channel][machine] for channel in channels}
            off = differences(channels, rows[machine], one)
            assert (off <= 1e-10).all(), (name, paths, channels[int(np.argmax(off))], off.max())
            compared += 1
            at = {p: v[machine] for p, v in changes.items()}
            ends = analytic.solver(with_changes(scene, at)).stroke_ends if "loads.0" in program["strokes"] else {}
            for place, end in ends.items():
                assert abs(found[machine, program["numbers"].index(place)] - end) <= 1e-12
        for machine in np.flatnonzero(~core.ok).tolist():
            if core.status[machine] is Status.cannot_assemble and "expected" not in core.reason[machine]:
                assert not (rows[machine, -1] >= 0).all(), (name, core.reason[machine])
    assert compared >= 150


def test_where_the_page_finds_no_solution_it_has_no_number(blank: "Page", tmp_path: Path) -> None:
    """With so much friction its few Newton steps do not do: the formulas give numbers there, which are none."""
    scene = load("toggle_press_friction")
    program = page_program(scene, SAMPLING.commanded(scene))
    assert program is not None
    numbers = [
        0.6 if p.endswith("coefficient") else v for p, v in zip(program["numbers"], program["values"], strict=True)
    ]
    _, (rows,), _ = solved_in(blank, scene, tmp_path, np.array([numbers]))
    without = ~(rows[-1] >= 0)
    assert 20 < without.sum() < 60
    assert np.isnan(rows[:, without]).all()
    assert np.isfinite(rows[:, ~without]).all()
