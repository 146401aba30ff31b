"""What all other models take from the scene, the oracle finds by its own means: a slip there sets it apart."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import interpolate

import analytic
import scenes
from compare.judge.floor import establish
from scenes import Sampling, Scene
from scenes.elements.loads import PressForce, TableForce
from scenes.elements.springs import TorsionSpring
from scenes.elements.tables import LoadCurve
from scenes.laws import LAWS
from scenes.scene import ConstantSpeed, HarmonicLaw, MotionLaw, SegmentedLaw
from scenes.splines import CubicSpline
from tests import agreement, scene_files
from tests.comparisons import sampled

pytest.importorskip("flint")

SAMPLING = Sampling(24)
FLOOR = 1e-12  # of the scenes below, see `agreement.FORCES`
FAR = 1e-7  # every slip below changes what it computes by 1e-6 or more, and some channel by that

LAW = [[0, 1], [0.3, 1.5], [0.5, 3], [0.9, 2.5], [1.2, 4]]
SEGMENTS = [{"to": 1 + k % 2 * 0.7 + 0.1 * k, "within": 0.1 + 0.07 * k, "law": law} for k, law in enumerate(LAWS, 1)]
TABLE = {"body": "coupler", "periodic": True, "table": [[0.1, 20], [0.2, -50], [0.5, 20]]}
LOADS = [{**TABLE, "at": "T", "along": [3, 4], "over": "time", "frame": "body"}, {**TABLE, "over": "drive"}]
SPRING = {"stiffness": 3, "angle": 1, "damping": 0.1}
SPRINGS = [
    {**SPRING, "at": "A", "between": ["crank", "ground"]},
    {**SPRING, "at": "B", "between": ["crank", "coupler"]},
]
SCENES: dict[str, tuple[str, scene_files.Changes]] = {
    "speed": ("crank", {}),
    "law": ("crank", {"drive": {"body": "crank", "law": LAW}}),
    "turning law": ("crank", {"drive": {"body": "crank", "law": [*LAW, [1.5, 1 + 2 * np.pi]], "periodic": True}}),
    "segments": ("crank", {"drive": {"body": "crank", "start": 1, "segments": SEGMENTS}}),
    "harmonics": ("crank", {"drive": {"body": "crank", "harmonics": [[1, 0.3, 0.2], [-0.4, 0.7, 1]]}}),
    "press": ("slider_crank", {"loads.0.last": 0.7, "drive.start": 0.1}),
    "tables": ("loaded_four_bar", {"loads": LOADS}),
    "torsion springs": ("loaded_four_bar", {"torsion_springs": SPRINGS, "drive.start": 8}),
    "table": ("slider_crank", {"loads": [{"body": "slider", "at": "B", "table": [[2.5, 0], [3, -10], [3.5, -50]]}]}),
}


def scene(name: str) -> Scene:
    file, changes = SCENES[name]
    return scene_files.load(file, changes)


def apart(scene: Scene) -> float:
    """Return how far the oracle is from the core where the drive is to be, or from what the drive asks for.

    It is the largest relative error of any channel; those of the drive are by 1 rad and by the largest rate.
    """
    time, oracle = SAMPLING.times(scene), agreement.exact(scene, SAMPLING)
    core = analytic.solve(scene, SAMPLING.commanded(scene), time)
    found = agreement.errors(core, oracle.samples)
    asked, rate = scene.drive.law.at(time), oracle[f"{scene.drive.body}.omega"]
    found["position"] = np.abs(oracle["crank_angle"] - asked.position)
    found["rate"] = np.abs(rate - asked.rate) / np.abs(rate).max()
    return max(float(error.max()) for error in found.values())


@sampled(3)
@pytest.mark.parametrize("name", SCENES)
def test_unbroken_the_oracle_and_the_core_agree(name: str) -> None:
    assert apart(scene(name)) <= FLOOR


@pytest.mark.parametrize("periodic", [False, True])
def test_both_take_rows_on_boundaries_for_the_same_segments(periodic: bool) -> None:
    """Boundaries that no double is, and which sums of them miss: of harmonic laws, whose accelerations jump there."""
    near = 0.1000000001, 0.0999999999, *[0.1] * 8  # so near to a row as counts as on it
    steps: list[dict[str, Any]] = [
        {"to": k % 2, "within": within, "law": "harmonic"} for k, within in enumerate(near, 1)
    ]
    steps += [{"within": 0.1}] * 2
    found = scene_files.load("crank", {"drive": {"body": "crank", "segments": steps, "periodic": periodic}})
    assert apart(found) <= FLOOR


Wrong = Callable[..., Any]  # of what is right, and its arguments


def faster(right: Wrong, law: Any, time: Any) -> Any:
    driven = right(law, time)
    return driven._replace(rate=driven.rate * (1 + 1e-6))


def late(right: Wrong, law: Any, time: Any) -> Any:
    return right(law, np.asarray(time) - 1e-6 * law.cycle)


def natural(_right: Any, law: MotionLaw) -> CubicSpline:
    own = interpolate.CubicSpline(law.times, law.positions, bc_type="natural")
    return CubicSpline(own.x, own.c, periodic=False)


def held(right: Wrong, table: LoadCurve, x: Any) -> Any:
    """Return the force at an entry before, not on the line to the next."""
    return right(table, np.asarray(table.arguments)[np.searchsorted(table.arguments[1:-1], x)])


def on_both_strokes(right: Wrong, load: PressForce, x: Any, v: Any, end: float) -> Any:
    return right(load, x, np.full_like(v, load.closing), end)


def too_early(right: Wrong, load: PressForce, x: Any, v: Any, end: float) -> Any:
    return right(replace(load, last=1.5 * load.last), x, v, end)


BY_FORMULA = {"segments": SegmentedLaw, "harmonics": HarmonicLaw}
SLIPS: tuple[tuple[str, type, str, Wrong], ...] = (
    *(("speed", ConstantSpeed, "at", wrong) for wrong in (faster, late)),
    ("speed", ConstantSpeed, "after", lambda right, law, cycles: right(law, cycles) + 1e-6),
    ("speed", Sampling, "commanded", lambda right, request, scene: right(request, scene) * (1 + 1e-6)),
    *(("turning law", MotionLaw, "at", wrong) for wrong in (faster, late)),
    ("turning law", MotionLaw, "after", lambda right, law, cycles: right(law, np.asarray(cycles) - 1e-6)),
    ("turning law", MotionLaw, "_trend", lambda _right, _law: 0.0),
    ("law", MotionLaw, "_spline", natural),
    *((kind, of, "at", wrong) for kind, of in BY_FORMULA.items() for wrong in (faster, late)),
    *((kind, of, "after", lambda right, law, cycles: right(law, cycles) + 1e-6) for kind, of in BY_FORMULA.items()),
    ("table", LoadCurve, "at", held),
    ("tables", LoadCurve, "at", lambda right, table, x: right(table, x) * (1 + 1e-6)),
    ("tables", LoadCurve, "within", lambda _right, _table, x: x),
    ("tables", TableForce, "direction", lambda _right, load: load.along),
    ("torsion springs", TorsionSpring, "moment", lambda right, spring, phi, _rate: right(spring, phi, 0)),
    ("torsion springs", TorsionSpring, "drives", lambda _right, _spring, _scene: 0),
    *(("press", PressForce, "acts", wrong) for wrong in (on_both_strokes, too_early)),
)


@sampled(8)
@pytest.mark.parametrize(("name", "of", "attribute", "wrong"), SLIPS)
def test_a_slip_in_what_models_share_sets_the_oracle_apart(
    monkeypatch: pytest.MonkeyPatch, name: str, of: type, attribute: str, wrong: Wrong
) -> None:
    right = getattr(of, attribute)
    if callable(right):
        monkeypatch.setattr(of, attribute, lambda *args: wrong(right, *args))
    else:
        monkeypatch.setattr(of, attribute, property(lambda self: wrong(right, self)))
    assert apart(scene(name)) > FAR


def test_a_press_force_that_closes_the_wrong_way_sets_the_oracle_apart() -> None:
    (load,) = scene("press").loads
    assert isinstance(load, PressForce)
    assert apart(replace(scene("press"), loads=(replace(load, closing=-load.closing),))) > FAR


def test_samples_on_the_switches_of_a_press_force_are_within_the_floor() -> None:
    """One at the dead point, where the force ends, and one where it begins, to the last digit."""
    press = scenes.load("crank_press", {"drive.start": 90})
    (load,) = press.loads
    assert isinstance(load, PressForce)
    begins, _, ends = analytic.solve(press, Sampling(72).commanded(press)[34:37])["B.y"]
    floor = establish(replace(press, loads=(replace(load, last=float(begins - ends)),))).floor
    assert max(floor.by_channel.values()) <= FLOOR
    assert not floor.doubt


def test_a_slip_in_what_models_share_casts_doubt_on_the_core(monkeypatch: pytest.MonkeyPatch) -> None:
    right = PressForce.acts
    monkeypatch.setattr(PressForce, "acts", lambda *args: on_both_strokes(right, *args))
    floor = establish(scene("press")).floor
    assert max(floor.by_channel.values()) > FAR
    assert "arbitrary precision" in floor.doubt
