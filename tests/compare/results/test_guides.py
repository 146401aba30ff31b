"""A guide's force by the ground's axes: read as the one across the guide, refused where it is none."""

import re
from pathlib import Path

import numpy as np
import pytest

import analytic
from compare.judge.foreign import assess_result
from compare.results.result import read_result
from scenes import InputError, Scene, Status
from scenes.model.motion import Samples
from tests import scene_files
from tests.comparisons import References, sampled
from tests.foreign import Writer, instants

TURN = 0.4  # rad, of another frame


def _columns(scene: Scene, body: str, turn: float = 0.0) -> dict[str, Samples]:
    """Return the components of the guide's force in a frame that is turned: the guide's normal times the force."""
    times = instants(scene, 40)
    true = analytic.solve(scene, scene.drive.law.at(times).position, times)
    slide = scene.slides[body]
    angle = true[f"{slide.on}.angle"] if slide.on in scene.turning else 0 * times
    force = true[f"{body}.guide_force"] * 1j * complex(*slide.along) * np.exp(1j * (angle - turn))
    others = {f"{slide.on}.angle": angle - turn} if slide.on in scene.turning else {}
    return {"time": times} | others | {f"{body}.guide_fx": force.real, f"{body}.guide_fy": force.imag}


@sampled(3)
@pytest.mark.parametrize("name", ["skew_sliders", "rocking_guide", "shaper", "wedge_and_ram", "offset_slider_crank"])
@pytest.mark.parametrize("turn", [0.0, TURN])
def test_it_is_the_force_across_the_guide(name: str, turn: float, tmp_path: Path, references: References) -> None:
    scene = scene_files.load(name)
    for body in scene.slides:
        columns = _columns(scene, body, turn)
        file = Writer().file(tmp_path, columns, f"promise = 1e-9\nframe = {{ angle = {turn} }}")
        found = assess_result(references(name), read_result(scene, f"theirs={file}"))
        assert found.run.status is Status.ok, found.run.reason
        assert f"{body}.guide_force" in {row.channel for row in found.errors}
        off = columns | {f"{body}.guide_f{q}": 1.01 * columns[f"{body}.guide_f{q}"] for q in "xy"}
        file = Writer().file(tmp_path, off, f"promise = 1e-9\nframe = {{ angle = {turn} }}")
        assert assess_result(references(name), read_result(scene, f"theirs={file}")).run.status is not Status.ok


def test_of_a_level_guide_one_component_is_enough(tmp_path: Path) -> None:
    scene = scene_files.load("offset_slider_crank")
    columns = _columns(scene, "slider")
    columns.pop("slider.guide_fx")
    result = read_result(scene, f"theirs={Writer().file(tmp_path, columns)}")
    assert result.run.motion is not None
    assert np.array_equal(result.run.motion["slider.guide_force"], columns["slider.guide_fy"])


def test_what_is_no_force_across_the_guide_is_named(tmp_path: Path) -> None:
    scene = scene_files.load("offset_slider_crank")
    columns = _columns(scene, "slider")
    level = columns | {"slider.guide_fx": columns["slider.guide_fy"]}
    both = columns | {"slider.guide_force": columns["slider.guide_fy"]}
    turning = scene_files.load("rocking_guide")
    body = next(body for body in turning.slides if body in turning.turning)
    alone = {name: values for name, values in _columns(turning, body).items() if not name.endswith(".angle")}
    half = {name: values for name, values in _columns(turning, body).items() if not name.endswith("_fy")}
    cases = [
        (scene, level, "slider.guide_fx: expected a force across the guide, found up to 0.71 of its largest along it"),
        (scene, both, "slider.guide_fx: expected it, or slider.guide_force, found both"),
        (turning, alone, f"{body}.guide_fx: expected {body}.angle or "),
        (turning, half, f"{body}.guide_fx: expected {body}.guide_fy too, as the guide is along no axis"),
    ]
    for linkage, table, line in cases:
        with pytest.raises(InputError, match=re.escape(f"columns.{line}")):
            read_result(linkage, f"theirs={Writer().file(tmp_path, table)}")
