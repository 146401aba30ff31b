"""Drives between moving bodies against absolute coordinates, orders of convergence, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

import scenes
from scenes import Failure, Motion, Sampling, Status
from sim_models.pymunk.engine import DEFAULT, EXACT, FAST
from sim_models.pymunk.settings import PymunkSettings, TextbookSettings
from sim_models.pymunk.sweeps import enough_sweeps
from tests import scene_files
from tests.agreement import errors, worst
from tests.closed_forms.elements import ON_CARRIED
from tests.comparisons import sampled

from .runs import Array, off, reference, solve

SAMPLING = Sampling(36)


def vector(motion: Motion, point: str, rate: str = "") -> Array:
    """A point's place or velocity, as complex numbers."""
    return np.asarray(motion[f"{point}.{rate}x"] + 1j * motion[f"{point}.{rate}y"])


def test_forces_by_rates_are_second_order() -> None:
    both = {
        key: table
        for name in ("spring and damper", "spring that twists, stiff and damped")
        for key, table in ON_CARRIED[name][0].items()
    }
    scene = scene_files.load("carried_block", both)
    exact = solve(scene, EXACT, SAMPLING)["drive.torque"]
    coarse, fine = (
        off(solve(scene, PymunkSettings("", n, 1, 2000), SAMPLING)["drive.torque"], exact) for n in (144, 288)
    )
    assert np.log2(coarse / fine) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("name", [name for name in ON_CARRIED if name not in ("force", "spring")])
def test_the_textbook_set_up_refuses_what_it_does_not_know(name: str) -> None:
    with pytest.raises(Failure, match="constant loads only"):
        solve(scene_files.load("carried_block", ON_CARRIED[name][0]), TextbookSettings("", 60))


# --- drives between moving bodies ------------------------------------------------------------------------------------

ROD_ON_THE_GROUND = {
    "bodies.rod.points": {"A": [10, 20]},
    "bodies.cylinder.points": {"B": [0, 0]},
    "bodies.bucket.points": {"B": [0, 300], "D": [0, 0], "T": [500, 0]},
}
STICK_FIRST = {"drive.body": "boom", "drive.on": "stick", "drive.speed": -20, "drive.start": 110, "drive.end": 60}
# A law with jumps of the acceleration.
JUMPS = [{"to": 700, "within": 0.6, "law": "harmonic"}, {"within": 0.1}, {"to": 560, "within": 0.5, "law": "harmonic"}]
BY_LAW = {"drive": {"body": "rod", "start": 560, "periodic": True, "segments": JUMPS}}
DRIVES: list[tuple[str, scene_files.Changes]] = [
    *((name, scene_files.NONE) for name in ("bucket", "busy_bucket", "swung_bucket", "elbow", "sleeved_elbow", "lift")),
    *(("bucket", ROD_ON_THE_GROUND), ("bucket", BY_LAW), ("elbow", {**STICK_FIRST, "sketch.angle": 90})),
]


@sampled(2)
@pytest.mark.parametrize(("name", "changes"), DRIVES)
def test_moving_drives_against_the_reference(name: str, changes: scene_files.Changes) -> None:
    scene = scene_files.load(name, changes)
    motion, expected = solve(scene, DEFAULT, SAMPLING), reference(scene, SAMPLING)
    # Rounding: the joint is the last that a sweep solves, and it is told where the step leads.
    assert off(motion[scene.channels.drive.position], SAMPLING.commanded(scene)) <= 1e-12
    # Measured: 4e-5 of accelerations of the elbow, which the extrapolation leaves, and less of all others.
    assert max(worst(errors(motion, expected)).values()) <= 2e-4


@sampled(1)
@pytest.mark.parametrize("name", ["swung_bucket", "elbow"])
def test_moving_drives_are_second_order(name: str) -> None:
    scene = scene_files.load(name, {"drive.speed": 0.5} if name == "swung_bucket" else scene_files.NONE)
    expected = reference(scene, SAMPLING)
    coarse, fine = (worst(errors(solve(scene, PymunkSettings("", n, 1, 2000), SAMPLING), expected)) for n in (144, 288))
    for order in ("x", "vx", "ax", "angle", "omega", "alpha"):
        # Measured: within 0.05. A cylinder that aims at the position itself is as good, but for the drive's.
        assert np.log2(coarse[order] / fine[order]) == pytest.approx(2, abs=0.1), order


# A rod on the crank's pin in a cylinder that swings, each shown by one point, 0.06 m of the guide from the pin.
SWUNG = {"bodies.cylinder.points": {"C": [0, 0]}, "bodies.rod.slides.through": [0, 0.06], "sketch": {"A": [0.1, 0.02]}}
HELD = """
format = 1
name = "held"
ground.points = { A = [0, 0], D = [2, 0] }
bodies.boom = { points = { A = [0, 0], B = [1, 1] } }
bodies.strut = { points = { B = [0, 0], D = [1, -1] } }
bodies.stick = { points = { B = [0, 0], T = [1, 0] } }
drive = { body = "stick", on = "boom", speed = 1, start = 2 }
sketch = { angle = 9, B = [1.1, 0.9] }
output = { point = "T" }
"""


def test_the_sketch_turns_cylinders_and_elbows(tmp_path: Path) -> None:
    """Of a passive cylinder the displacement is positive; a stick without a point of its own is as the boom shows."""
    motion = solve(scene_files.load("telescope", SWUNG), FAST, SAMPLING)
    apart = vector(motion, "A") - 0.3
    further = np.sqrt(np.abs(apart) ** 2 - 0.06**2)
    assert np.exp(1j * motion["rod.angle"]) == pytest.approx(apart / (further + 0.06j), abs=1e-5)
    (tmp_path / "held.toml").write_text(HELD)
    motion = solve(scenes.load(tmp_path / "held.toml"), FAST, SAMPLING)
    assert motion["crank_angle"] == pytest.approx(2 + motion["time"], abs=1e-12)
    assert vector(motion, "T") == pytest.approx(1 + 1j + np.exp(1j * (2 + motion["time"])), abs=1e-5)


def test_what_cannot_drive_between_moving_bodies_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    motor = PymunkSettings("", 72, 1, 10, extra="motor")
    for name, settings, reason in (
        ("bucket", TextbookSettings("", 60), "the textbook set-up has a motor on the ground only"),
        ("elbow", motor, "pymunk has motors for cranks at a constant speed only"),
        ("bucket", PymunkSettings("", 72, 1, 10, correction=0.5), "a drive between moving bodies lags"),
    ):
        with pytest.raises(Failure, match=reason) as caught:
            solve(scene_files.load(name), settings)
        assert caught.value.status is Status.unsupported
    monkeypatch.setattr("sim_models.pymunk.sweeps.MAX_SWEEPS", 50)
    enough_sweeps.cache_clear()
    with pytest.raises(Failure, match="a step would need") as caught:
        solve(scene_files.load("lift"))
    assert caught.value.status is Status.not_converged
