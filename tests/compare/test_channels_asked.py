"""What a user asks for besides the scene: with some of its channels the whole comparison works, and is as strict."""

from argparse import ArgumentTypeError
from contextlib import nullcontext
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import scenes
from compare.cli.arguments import accuracy, matching
from compare.engines import registry, runner
from compare.engines.runner import Run
from compare.judge.checks import checks
from compare.judge.errors import compare
from compare.judge.measure import Standard, assess
from compare.judge.peaks.peaks import peaks
from compare.judge.triage import sentences
from compare.judge.verdict import compared, judged
from compare.mechanics.mechanics import Mechanics
from compare.mechanics.reference import Reference, uncertified
from compare.report.figures.curves import panels
from compare.report.output import files as output
from compare.report.tables import study as tables
from scenes import Motion, Request, Sampling, Settings, Status
from scenes.channels import Role, named
from scenes.model.motion import header
from tests import scene_files
from tests.comparisons import SAMPLING, Studies, all_checks, commanded, of_scene, sampled, studied

PRESS = scene_files.load("crank_press", {"drive.start": 90})
MOVED = (Role.kinematic, Role.force, Role.friction)  # roles of channels that are compared


@pytest.mark.parametrize(
    ("patterns", "asked"),
    [
        (["P5.y"], {"P5.y"}),
        (["P5.v?", "drive.torque"], {"P5.vx", "P5.vy", "drive.torque"}),
        (["*.guide_*", "rod.*"], {"slider.guide_force", "slider.guide_moment", "rod.angle", "rod.omega", "rod.alpha"}),
    ],
)
def test_channels_asked_for(patterns: list[str], asked: set[str]) -> None:
    scene = scenes.load("toggle_press")
    assert matching(scene, patterns) == asked
    assert set(Sampling(channels=matching(scene, patterns)).wanted(scene)) == asked | {"time", "crank_angle"}


@pytest.mark.parametrize(("text", "value"), [("fast", "fast"), ("exact", "exact"), ("1e-4", 1e-4), ("0.001", 1e-3)])
def test_accuracies(text: str, value: object) -> None:
    assert accuracy(text) == value


@pytest.mark.parametrize("text", ["best", "0", "1", "-1e-3", "nan", "inf", ""])
def test_accuracies_that_are_not(text: str) -> None:
    with pytest.raises(ArgumentTypeError, match="fast, balanced, exact or a relative error"):
        accuracy(text)


@sampled(1)
@pytest.mark.parametrize(
    ("name", "patterns"),
    [
        ("toggle_press", ["P5.y"]),
        ("toggle_press", ["drive.torque"]),
        ("toggle_press", ["P3.f?", "P3.x", "P3.y", "O.fx"]),
        ("crank_press", ["B.fy"]),  # with a press force, whose switches the reference must know
        ("four_bar", ["*.x", "*.y"]),
        ("shaper", ["block.*"]),
        ("driven_toggle", ["drive.force", "C.v?"]),
        ("swinging_law", ["crank.omega"]),
    ],
)
def test_few_channels(studies: Studies, name: str, patterns: list[str], tmp_path: Path) -> None:
    """The channels asked for and no others, with the errors that they have among all."""
    full, few = studies(name), studies(name, *patterns)
    wanted = few.sampling.wanted(few.scene)
    assert few.measurements[0].run.status is Status.ok, few.measurements[0].run.reason
    assert few.reference.scale == full.reference.scale
    assert set(few.reference.floor.by_channel) <= set(wanted)
    assert {row.channel for row in few.channel_errors} == set(wanted) - {"time"}
    for channel in set(wanted) - {"time"}:
        error, all_along = (pd.DataFrame(s.channel_errors).set_index("channel")["max"][channel] for s in (few, full))
        assert error == pytest.approx(all_along, abs=1e-13)
    folder = output.write(few, tmp_path)
    written = pd.read_csv(folder / "motion.analytic.csv")
    assert list(written.columns) == [header(channel) for channel in wanted]
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "Asked for:" in page
    assert "Assur groups" not in page, "nobody asked for them"
    for panel in panels(few.reference, few.sampling):
        assert set(panel.judged) <= set(wanted)
        for curve in panel.curves:
            assert np.isfinite(curve.of(few.motion)).all()


def test_panels_are_of_what_is_asked_for(studies: Studies) -> None:
    pins, one = (studies("toggle_press", *of) for of in (("P3.f?", "P3.x", "P3.y", "O.fx"), ("P5.y",)))
    titles = [panel.title.partition(":")[0] for panel in panels(pins.reference, pins.sampling)]
    assert titles == ["Pin O", "Pin P3"]
    (panel,) = panels(one.reference, one.sampling)
    assert [curve.name for curve in panel.curves] == ["along the guide"]
    assert panel.judged == ("P5.y",)


def motion_of(reference: Reference, *patterns: str) -> Motion:
    motion, scene = commanded(reference), reference.scene
    return Motion({c: motion[c] for c in Sampling(channels=matching(scene, patterns)).wanted(scene)})


@sampled(2)
@pytest.mark.parametrize(
    ("patterns", "made"),
    [
        (["P5.y"], set()),
        (["P5.x", "P5.y"], {"slider"}),
        (["P4.?", "P5.?"], {"rod", "slider"}),
        (["*.x", "*.y"], {"crank", "rocker", "toggle", "rod", "slider"}),
    ],
)
def test_checks_that_have_their_channels(reference: Reference, patterns: list[str], made: set[str]) -> None:
    motion = motion_of(reference, *patterns)
    found = checks(reference.mechanics, motion, reference.travel)
    assert {check.of for check in found if check.check != "drive"} == made
    whole = reference.at(motion.inputs(reference.scene))
    everything = checks(reference.mechanics, whole, reference.travel)
    assert {check.check for check in everything} == all_checks(reference.scene)


def test_a_slot_needs_its_carrier(studies: Studies) -> None:
    few = studies("shaper", "block.*")
    assert {check.check for check in few.measurements[0].checks} == {"drive"}
    made = checks(few.reference.mechanics, motion_of(few.reference, "*.x", "*.y", "*.angle"), few.reference.travel)
    assert {check.of for check in made if check.check == "closure"} == set(few.scene.bodies)


@pytest.mark.parametrize(
    ("patterns", "status"), [(["P5.?"], Status.diverged), (["P5.y"], Status.wrong_branch), (["P4.*"], Status.ok)]
)
def test_a_wrong_run_is_noticed_by_what_is_left(reference: Reference, patterns: list[str], status: Status) -> None:
    """The slider a tenth of the stroke off, beside its guide and along it; without its channels nobody can know."""
    motion, scene = motion_of(reference, *patterns), reference.scene
    moved = {c: motion[c] + 0.1 * reference.stroke for c in ("P5.x", "P5.y") if c in motion}
    wrong = Motion(dict(motion.samples) | moved)
    run = Run("stub", None, Status.ok, motion=wrong)
    made = checks(Mechanics(scene), wrong, reference.travel)
    comparison = compare(reference, SAMPLING, wrong)
    verdict = compared(judged(run, made), scene, comparison, comparison.commanded)
    assert verdict.status is status


@cache
def pressing_or_not() -> tuple[Reference, Motion, Motion]:
    """The reference of the press, and its motion as the press force acts and without it."""
    pressing = uncertified(PRESS)
    without = of_scene(pressing, replace(PRESS, loads=()))
    return pressing, commanded(pressing), commanded(without)


@sampled(2)
@pytest.mark.parametrize("kind", sorted({PRESS.channels[name].quantity for name in PRESS.channels.names(*MOVED)}))
def test_one_channel_of_a_press_on_its_switch(kind: str) -> None:
    """One component of a vector is judged by the vector, on the side of the switch where it fits: right or spoilt.

    The middle sample is the lower dead point, where the press force ends and rounding decides whether it acts.
    """
    (pressing, on, off), scene = pressing_or_not(), PRESS
    on_switch = np.arange(SAMPLING.count) == SAMPLING.count // 2
    (may,) = pressing.acts(on)
    assert np.array_equal(on_switch, may.any(axis=0) & ~may.all(axis=0))
    channel = [name for name in scene.channels.names() if named(name).name == kind][-1]
    few = replace(SAMPLING, channels=frozenset({channel}))
    for side in (on, off):
        right = {c: np.where(on_switch, side[c], on[c]) for c in few.wanted(scene)}
        spoilt = right | {channel: 1.1 * right[channel] + 0.1 * pressing.scale[channel]}
        runs = (Run("stub", Settings("stub", promise=1e-9), Status.ok, motion=Motion(m)) for m in (right, spoilt))
        well, badly = (assess(Standard.of(pressing, few), run) for run in runs)
        assert well.run.status is Status.ok, well.run.reason
        assert badly.run.status is not Status.ok, channel
        assert len(sentences(pressing, [badly], set())) <= 1  # of one number a cause may be unknown
        assert peaks(pressing, few, [well, badly]) is not None


@sampled(2)
@pytest.mark.parametrize("seed", range(12))
def test_some_channels_of_some_places_are_judged(seed: int) -> None:
    """Where one joint, point or body has channels that another's were not asked for."""
    rng = np.random.default_rng(seed)
    reference = uncertified(scenes.load("toggle_press"))
    some = frozenset(rng.choice(reference.scene.channels.names(*MOVED), 6, replace=False))
    few = replace(SAMPLING, channels=some)
    motion = commanded(reference)
    off = {c: values + 0.1 * reference.scale[c] for c, values in motion.samples.items() if c in some}
    wrong = Motion({c: off.get(c, motion[c]) for c in few.wanted(reference.scene)})
    run = Run("stub", Settings("stub", promise=1e-9), Status.ok, motion=wrong)
    assert sentences(reference, [assess(Standard.of(reference, few), run)], set()) is not None


def test_gates_of_what_is_not_asked_for_are_left_out() -> None:
    scene = scenes.load("toggle_press")
    scene = replace(scene, tolerances={"analytic": {"position": 1e-9, "reaction": 1e-9, "torque": 0.0}})
    few = Sampling(72, channels=frozenset({"P5.y", "drive.torque"}))
    result = studied(scene, sampling=few)
    assert [(gate.group, gate.missed) for gate in result.held] == [("position", False), ("torque", True)]
    assert "P5.y, drive.torque" in tables.notes(result)[1]


def test_less_is_asked_of_the_engines(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every run of every engine, and the one that certifies the floor, is asked for these channels alone."""
    seen, real = [], registry.engine

    def spied(name: str) -> Any:
        def build(scene: scenes.Scene, settings: scenes.Settings, request: Request) -> scenes.Simulation:
            seen.append((name, request.channels))
            return real(name).build(scene, settings, request)

        return SimpleNamespace(**{**vars(real(name)), "build": build})

    monkeypatch.setattr(registry, "engine", spied)
    monkeypatch.setattr("compare.study.workers", lambda *_: nullcontext(runner.HERE))  # to see the engines at work
    few = frozenset({"P5.y"})
    studied(scenes.load("toggle_press"), sampling=Sampling(72, channels=few))
    assert {name for name, _ in seen} == {"analytic", "multiprecision"}
    assert {asked for _, asked in seen} == {few}
