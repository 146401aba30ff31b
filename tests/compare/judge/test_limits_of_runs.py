"""Limits hold over all cycles that a run has, and what a run's own samples miss is not met."""

from math import pi

import numpy as np
import pytest

import analytic
import compare
from compare.judge.proof import SampledRun, held
from compare.report.tables.proof import sentences
from scenes import InputError, Motion, Sampling, Scene
from scenes.drive import ConstantSpeed
from scenes.model.enclosures import Enclosure, Enclosures
from tests import scene_files

LIGHT: scene_files.Changes = {"bodies.slider.mass": 0.01}
DEGREES = {"units": {"angle": "deg"}, "sketch.angle": 28.6}
GROWING = LIGHT | {
    "loads": [{"body": "slider", "at": "B", "over": "time", "table": [[0, -1], [0.6, -2], [1.2, -80], [2, -90]]}]
}
SPRING = {"loads": None, "torsion_springs": [{"at": "O", "between": ["ground", "crank"], "stiffness": 2, "angle": 0}]}
BETWEEN = {"loads": None, "torsion_springs": [{"at": "A", "between": ["crank", "rod"], "stiffness": 3, "angle": 0}]}
TWO_TURNS = {"body": "crank", "over": "drive", "table": [[0, 0], [360, 9], [500, 40], [720, 0]], "periodic": True}
LAW = {"body": "crank", "law": [[0, 0], [0.2, 1], [0.5, 4], [0.9, 2 * pi]], "periodic": True}
SEGMENTS = [{"to": 2, "within": 0.4, "law": "cycloidal"}, {"to": -2 * pi, "within": 0.5, "law": "harmonic"}]
# Of the slider-crank, whose crank makes a turn in 0.628 s, or by a law.
LASTING: dict[str, scene_files.Changes] = {
    "a table over the time": GROWING,
    "a table over the drive, of two turns": LIGHT | DEGREES | {"loads": [TWO_TURNS]},
    "a spring of the drive that winds up": LIGHT | SPRING,
    "a spring between two bodies that winds up": LIGHT | BETWEEN,
    "a crank that turns the other way": GROWING | {"drive.speed": -10},
    "a periodic law": GROWING | {"drive": LAW},
    "periodic segments": GROWING | {"drive": {"body": "crank", "segments": SEGMENTS, "periodic": True}},
}
TURNS, SAMPLES = 3, 1440  # a cycle: between two of them a peak rises by 1e-5 of itself


@pytest.mark.parametrize("case", LASTING)
def test_bounds_are_of_the_whole_run(case: str) -> None:
    scene, dense = scene_files.load("slider_crank", LASTING[case]), Sampling(SAMPLES, TURNS)
    effort = analytic.solve(scene, dense.commanded(scene), dense.times(scene))["drive.torque"]
    found = analytic.enclose(scene, {"drive.torque"}, turns=TURNS)
    least, most = found.rows
    assert found.cycles == TURNS
    first = effort[: SAMPLES + 1]
    assert np.ptp(effort) > 1.2 * np.ptp(first)  # so that bounds of the first cycle alone are none
    slack = 1e-3 * np.ptp(effort)  # what the samples leave of a peak
    assert effort.min() - slack <= least.low <= effort.min() + 1e-9
    assert effort.max() - 1e-9 <= most.high <= effort.max() + slack
    for row, place in ((least, effort.argmin()), (most, effort.argmax())):
        over = dense.commanded(scene) if isinstance(scene.drive.law, ConstantSpeed) else dense.times(scene)
        step = 3 * abs(over[1] - over[0])
        assert row.position_low - step <= over[place] <= row.position_high + step


def test_a_spring_that_winds_up() -> None:
    """Of no masses and no loads the drive holds k phi, by hand: after three turns 2 times 6 pi."""
    scene = scene_files.load("slider_crank", {**SPRING, "bodies.slider.mass": 0})
    least, most = analytic.enclose(scene, {"drive.torque"}, turns=3).rows
    assert (least.low, most.high) == pytest.approx((0, 12 * pi), abs=1e-6 * 12 * pi)


def test_what_comes_back_is_enclosed_once() -> None:
    table = {"body": "crank", "over": "drive", "table": [[0, 0], [90, 5], [180, 0]], "periodic": True}
    for changes in ({}, {"loads": [table], **DEGREES}):
        scene = scene_files.load("slider_crank", changes)
        once, thrice = (analytic.enclose(scene, turns=turns) for turns in (1, 3))
        assert thrice.cycles is None
        angle = {row[:2]: row for row in thrice.rows}["crank.angle", "most"]
        assert angle.high == pytest.approx(6 * pi, abs=1e-5)  # what goes round goes on
        assert angle.position_high == pytest.approx(6 * pi)
        assert [row for row in once.rows if row.channel != "crank.angle"] == [
            row for row in thrice.rows if row.channel != "crank.angle"
        ]


def test_a_limit_is_held_over_the_whole_run() -> None:
    limits = {"drive.torque": {"most": 50}, "B.x": {"least": 1.9}}
    scene = scene_files.load("slider_crank", {**GROWING, "limits": limits})
    first = held(scene, Sampling(samples=8), analytic.enclose(scene))
    assert [limit.outcome for limit in first] == ["met", "met"]
    result = compare.check(scene, engines=("analytic",), samples=8, turns=3)
    assert [limit.outcome for limit in result.limits] == ["missed", "met"]
    assert not result.ok
    assert next(sentences(result)).startswith("Proven over the first 3 turns: it assembles")


def test_turns_that_no_drive_makes() -> None:
    scene = scene_files.load("slider_crank")
    for turns in (0, 1.5, True, "2"):
        with pytest.raises(InputError, match="turns: expected a whole number from 1"):
            analytic.enclose(scene, turns=turns)  # type: ignore[arg-type]
    once = scene_files.load("slider_crank", {"drive.end": pi})
    with pytest.raises(InputError, match="turns: expected 1 of a drive that runs once"):
        analytic.enclose(once, turns=2)


LIMITED = {"limits": {"drive.torque": {"most": 10}}}
PROVEN = Enclosure("drive.torque", "most", 9.0, 9.5, 0.0, 0.1)


def outcome(proof: Enclosures, *runs: SampledRun) -> tuple[str, str]:
    scene: Scene = scene_files.load("slider_crank", LIMITED)
    (limit,) = held(scene, Sampling(samples=8), proof, runs)
    return limit.outcome, limit.text


def sampled(name: str, most: float, promise: float) -> SampledRun:
    torque = np.array([0.0, most, 1.0])
    motion = Motion({"time": np.arange(3.0), "crank_angle": np.arange(3.0), "drive.torque": torque})
    return SampledRun(name, motion, promise, {"drive.torque": 10.0})


def test_no_limit_is_met_that_samples_miss() -> None:
    """Whatever bounds have it: the reference's own, or those of an engine that is ok, beyond what it may be off."""
    proof, fine = Enclosures([PROVEN], None), sampled("the closed form", 9.2, 1e-9)
    assert outcome(proof, fine)[0] == "met"
    ended, text = outcome(proof, sampled("the closed form", 11.0, 1e-9))
    assert ended == "missed"
    assert "11.000 N m at 57.3° in the samples of the closed form" in text
    ended, text = outcome(proof, fine, sampled("exudyn", 10.5, 1e-6))
    assert ended == "not decided"
    assert "but 10.500 N m at 57.3° in the samples of exudyn" in text
    ended, text = outcome(proof, fine, sampled("pymunk", 10.04, 5e-3))  # off by 0.05 at most
    assert ended == "met"
    assert "within its promise 10.040 N m at 57.3° in the samples of pymunk" in text
    assert outcome(Enclosures((), (0.1, 0.2)), sampled("the closed form", 11.0, 1e-9))[0] == "missed"


def test_what_is_proven_of_a_part_is_no_proof_of_the_rest() -> None:
    ended, text = outcome(Enclosures([PROVEN], None, 100, 1000))
    assert ended == "not decided"
    assert text.endswith("over the first 100 of 1000 turns")
    above = PROVEN._replace(low=10.5, high=11.0)
    assert outcome(Enclosures([above], None, 100, 1000))[0] == "missed"
