"""What must not pass in the pymunk model, and what it refuses."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import scenes
from scenes import Failure, ProcessorBudget, Sampling, Scene, Status, hard
from scenes.scene import ConstantSpeed
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk.constraints import LinkageConstraints, solved
from sim_models.pymunk.engine import DEFAULT, FAST
from sim_models.pymunk.masses import ballasted_masses
from sim_models.pymunk.runs.simulation import check_impulses, check_path
from sim_models.pymunk.runs.stepping import Integration
from sim_models.pymunk.settings import AnySettings, PymunkSettings, TextbookSettings
from sim_models.pymunk.start import start
from tests import scene_files
from tests.agreement import errors
from tests.comparisons import sampled

from .runs import driven_slider, reference, slider_crank, solve

PRESS = scenes.load("toggle_press")


def failure_of(scene: Scene, settings: AnySettings = DEFAULT) -> Failure:
    with pytest.raises(Failure) as caught:
        solve(scene, settings, Sampling(72))
    return caught.value


@pytest.mark.parametrize("settings", [PymunkSettings("", 72, 1, 10), TextbookSettings("", 60)])
def test_flip_is_seen_where_it_happens(settings: AnySettings) -> None:
    failure = failure_of(PRESS, settings)
    assert failure.status is Status.wrong_branch
    assert "deg" in failure.reason
    assert failure.motion is not None
    assert set(failure.motion.samples) == {*PRESS.channels.names()}


class Spoilable:
    """A run whose record can be spoilt at step 100, between two samples, and then checked."""

    def __init__(self, scene: Scene) -> None:
        self.linkage = LinkageConstraints(scene, ballasted_masses)
        self.branch = self.linkage.branch(start(self.linkage))
        self.run = Integration(scene, Sampling(72), 3, replace(DEFAULT, iterations=200), [])
        self.run.advance(ProcessorBudget(60.0, "a test"))
        self.good = self.run.record.copy()

    def checked(self, body: int = 0, column: int = 0, change: float = 0.0) -> dict[str, float]:
        self.run.record[:] = self.good
        self.run.record[101, body, column] += change
        return check_path(self.linkage, self.run.path, self.run.positions, self.branch)


def test_every_step_is_checked() -> None:
    run, (crank, rod, slider) = Spoilable(PRESS), (0, 3, 4)
    before = run.checked()
    after = run.checked(slider, 2, -3e-3)  # turned in its guide, which counts at the linkage's size
    assert after["joint_gap"] == pytest.approx(3e-3 * run.linkage.size / 0.077, abs=before["joint_gap"])
    gapes, drifts = [(rod, 0, 0.01), (rod, 0, -0.01), (rod, 1, -0.01)], [(crank, 2, 1e-3), (crank, 2, -1e-3)]
    diverged = dict.fromkeys(gapes + drifts, Status.diverged)
    for spoilt, status in (diverged | {(slider, 4, np.nan): Status.nonfinite}).items():
        with pytest.raises(Failure, match=f"at crank angle {100 / 216 * 360:.4f} deg") as caught:
            run.checked(*spoilt)
        assert caught.value.status is status


def test_what_a_slider_drifts_and_joints_open_by_is_of_its_travel() -> None:
    """Its way ends at 2.5 dm, far from zero: from 3.9 dm it is 1.4 dm long, and half of that is the crank's radius."""
    run, (rod, slider) = Spoilable(driven_slider(3.9)), (1, 2)
    before = run.checked()
    assert before["joint_gap"] <= 1e-3  # by the curvature of a third of a degree
    for sign in (1, -1):
        assert run.checked(slider, 0, sign * 7e-7 * 0.14)["drive"] == pytest.approx(7e-7, rel=1e-3)
        gap = run.checked(rod, 0, sign * 0.04 * 0.07)["joint_gap"]
        assert gap == pytest.approx(0.04, abs=before["joint_gap"])
        with pytest.raises(Failure, match="'slider' is not where the drive takes it"):
            run.checked(slider, 0, sign * 1.1e-6 * 0.14)


@pytest.mark.parametrize("sign", [1, -1])
def test_forces_that_are_not_the_engines_are_seen(sign: int) -> None:
    linkage, forces = LinkageConstraints(PRESS, ballasted_masses), np.array([[1.0, 2.0], [5.0, 3.0], [4.0, 0.0]])
    off = sign * 5.0 * np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.2]])
    found = check_impulses(linkage, np.arange(3.0), forces, forces + 4e-7 * off)
    assert found["impulses"] == pytest.approx(4e-7)
    with pytest.raises(Failure, match=r"the reactions are not the engine's impulses at crank angle 114\.5916 deg"):
        check_impulses(linkage, np.arange(3.0), forces, forces + 2e-6 * off)


# In the four-bar B is at 0.6 from A, C at 0.05 from D and at |2.1 + 0.3i| from B: too long a coupler.
APART = abs(2.1 + 0.3j) - 0.05 - abs(3 + 2.5j - (1 + 2j - 0.6 * np.exp(3.5j)))
# A-K, about 370 mm, is itself no given length.
UNMET = {"bodies.plate.lengths.A-L": 100, "bodies.plate.lengths.K-L": 200, "sketch.L": [90, 50]}
REFUSED: dict[str, tuple[Scene, Status, str]] = {
    # The rod is at right angles to the guide where 0.35 sin(angle) = 0.3.
    "a crank that cannot turn round": (
        *(slider_crank({"bodies.crank.points.A": [3.5, 0]}), Status.cannot_assemble),
        f"crank angle {np.arcsin(0.3 / 0.35):.4f}",
    ),
    # 1.2 m minus 1.19999 m: the bars do not reach within 0.6 deg of 180, less than one continuation step on both sides.
    "a narrow lock": (
        *(scene_files.load("stretched_rocker", {"bodies.rocker.lengths.B-Q": 0.49999}), Status.cannot_assemble),
        "crank angle 3.130",
    ),
    "bodies that do not reach": (
        *(scene_files.load("loaded_four_bar", {"bodies.rocker.lengths.C-D": 0.05}), Status.cannot_assemble),
        f"with all else closed C stays open by {APART:.4g} m at crank angle 3.500000 rad",
    ),
    "points by lengths that do not meet": (
        *(scene_files.load("driven_toggle", UNMET), Status.cannot_assemble),
        "from A and K to L of 'plate'",
    ),
    # 4 dm is where the rod and the crank are in line.
    "a start too near a lock": (
        *(driven_slider(3.999), Status.cannot_assemble),
        "pymunk starts 3 steps before zero, where the bodies cannot be put together at slider at 4 dm",
    ),
    "a massless rod": (slider_crank({"bodies.rod.mass": 0}), Status.unsupported, "'rod'"),
    "a point mass between bodies that forces move": (
        *(scene_files.load("toggle_press", {"bodies.rod.com": [150, 0], "bodies.rod.inertia": 0}), Status.unsupported),
        "'rod'",
    ),
    "bodies that turn together without inertia": (scene_files.load("telescope"), Status.unsupported, "'cylinder'"),
}


@sampled(3)
@pytest.mark.parametrize("case", REFUSED)
def test_refused_by_name_and_place(case: str) -> None:
    scene, status, reason = REFUSED[case]
    failure = failure_of(scene)
    assert failure.status is status
    assert reason in failure.reason


@sampled(2)
@pytest.mark.parametrize(
    ("scene", "largest"),
    [
        # Beside a pin on the crank a point mass alone makes it turn heavily. Measured: 3e-7 of accelerations, which the
        # extrapolation leaves.
        (slider_crank({"bodies.rod.com": [1, 0], "bodies.rod.inertia": 0}), 1e-5),
        # Either's inertia is both's: they turn as one. Measured: 2e-5 of accelerations, likewise.
        (scene_files.load("telescope", {"bodies.cylinder.inertia": 1e-3}), 1e-4),
        (scene_files.load("telescope", scene_files.without_masses("telescope")), 1e-4),
        (slider_crank({"bodies.crank.mass": 0}), 1e-5),
    ],
    ids=["point mass", "one inertia of two", "kinematic", "massless crank"],
)
def test_what_can_be_turned_is_not_refused(scene: Scene, largest: float) -> None:
    motion, expected = solve(scene, DEFAULT, Sampling(72)), reference(scene, Sampling(72))
    assert max(error.max() for error in errors(motion, expected).values()) <= largest


def test_overflow_is_no_result() -> None:
    scene = slider_crank()
    assert isinstance(scene.drive.law, ConstantSpeed)
    failure = failure_of(scene.with_law(replace(scene.drive.law, speed=1e200)))  # which the file could not say
    assert failure.status is Status.nonfinite


def test_a_singular_matrix_gives_no_numbers_and_leaves_the_others_alone() -> None:
    J = np.array([np.eye(3), np.ones((3, 3)), 2 * np.eye(3)])
    found = solved(J, np.ones((3, 3)))
    assert np.isnan(found[1]).all()
    assert found[[0, 2], 0, 0].tolist() == [1.0, 0.5]


@sampled(1)
@pytest.mark.parametrize("label", ["0", "-1e-6"])
def test_a_dead_centre_between_two_samples_is_not_stepped_over(label: str) -> None:
    """The run itself comes as near to the dead centre as it may; the slider is to go on to it, or past it."""
    rung = next(rung for rung in hard.ladder("dead_centre_driven").rungs if rung.label == label)
    assert failure_of(rung.scene(), FAST).status in (Status.cannot_assemble, Status.not_converged)


@pytest.mark.parametrize("settings", [FAST, TextbookSettings("", 60)])
def test_a_run_that_takes_too_long_names_its_steps(settings: AnySettings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim_models.pymunk.runs.simulation.SECONDS", 0.0)
    failure = failure_of(PRESS, settings)
    assert failure.status is Status.timed_out
    assert re.search("of processor time were not enough for .*steps", failure.reason)


def test_a_continuation_that_takes_too_long_names_where_it_leads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim_models.pymunk.start.SECONDS", 0.0)
    failure = failure_of(PRESS)
    assert failure.status is Status.timed_out
    assert "not enough for the way to crank angle" in failure.reason


def test_the_way_from_the_sketch_takes_no_steps_of_a_short_range(monkeypatch: pytest.MonkeyPatch) -> None:
    """A seventy-second of the way, not of the range: 1e-4 deg of it would be 10 million steps away."""
    monkeypatch.setattr("sim_models.pymunk.start.SECONDS", 1.0)
    drive = {"drive.speed": 60, "drive.start": 0, "drive.end": 1e-4}
    assert np.isfinite(start(LinkageConstraints(scene_files.load("four_bar", drive), ballasted_masses))).all()


def test_the_run_up_is_no_longer_than_a_cycle() -> None:
    """In a millisecond pymunk corrects 0.6 % of a joint's error: what then is left of it, no run-up takes away."""
    assert isinstance(PRESS.drive.law, ConstantSpeed)
    quick = PRESS.with_law(replace(PRESS.drive.law, speed=1000 * PRESS.drive.law.speed))
    settings = PymunkSettings("", 72, 1, 100, correction=None)
    assert pymunk_model.build(quick, settings, Sampling(72)).counters["steps"] == 2 * 72


def test_a_linkage_whose_points_are_all_at_one_place(tmp_path: Path) -> None:
    """Its size is the way of its drive; at an even 0.5 m/s along 45 deg the drive lifts m g sin 45 deg."""
    text = (
        'format = 1\nname = "plate"\ngravity = [0, -9.80665]\nground.points = { G = [0, 0] }\n'
        "bodies.plate = { points = { P = [0, 0] }, mass = 1, com = [0, 0], inertia = 1, "
        "slides = { through = [0, 0], along = [1, 1] } }\n"
        'drive = { body = "plate", speed = 0.5, start = 0, end = 2.5 }\n'
        'sketch = { displacement = 0, P = [0, 0] }\noutput = { slider = "P" }\n'
    )
    (file := tmp_path / "plate.toml").write_text(text, encoding="utf-8")
    motion = solve(scenes.load(file), sampling=Sampling(24))
    half = 9.80665 / 2**0.5  # N
    for channel in ("drive.force", "plate.guide_force"):
        assert not (abs(motion[channel] - half).max() > 1e-12 * half)  # round-off of one division
