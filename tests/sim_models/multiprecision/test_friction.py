"""Friction at every joint: against equations written in the tests, the balance of power, no friction, and jams."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import scenes
from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.scene import ConstantSpeed, Force, GuideFriction, PinFriction
from tests import scene_files
from tests.absolute_bodies import local_points, mass_properties
from tests.agreement import attitude
from tests.comparisons import sampled
from tests.friction_scenes import everywhere

from .runs import run

flint = pytest.importorskip("flint")

from sim_models.multiprecision import engine as model  # noqa: E402  (its engine is there)
from sim_models.multiprecision.friction import Pressed  # noqa: E402

SAMPLES = 8


def place(scene: Scene, motion: Motion, point: str, of: str) -> Any:
    """Return where a point is, or a rate of that, complex: of `of` = "", "v" or "a"."""
    if point in scene.ground:
        return complex(*scene.ground[point]) if not of else 0j
    return motion[f"{point}.{of}x"] + 1j * motion[f"{point}.{of}y"]


def growth_of_kinetic_energy(scene: Scene, motion: Motion) -> Any:
    """Return Σ m a·v + I alpha omega, W, by each body's first point and the arm c from there to its centre of mass."""
    total = 0.0
    for name, body in scene.bodies.items():
        local = local_points(scene, body)
        mass, com, inertia = mass_properties(body, local)
        c = attitude(scene, motion, name) * complex(*(np.asarray(com) - local[body.points[0]]))
        omega, alpha = (motion[f"{name}.{of}"] if name in scene.turning else 0.0 for of in ("omega", "alpha"))
        v, a = (place(scene, motion, body.points[0], of) for of in "va")
        v, a = v + 1j * omega * c, a + (1j * alpha - omega**2) * c
        gravity = complex(*scene.gravity or (0, 0))
        total = total + mass * (np.conj(a - gravity) * v).real + inertia * alpha * omega
    return total


@sampled(2)
@pytest.mark.parametrize("name", ["toggle_press", "rocking_guide", "elbow", "three_at_a_pin"])
def test_power_is_balanced(name: str) -> None:
    """Drive power + loads' power + gravity + friction.power = d(kinetic energy)/dt; all loads are plain forces."""
    scene = everywhere(scene_files.load(name), 0.2, viscous=0.1)
    motion = run(scene)
    assert isinstance(scene.drive.law, ConstantSpeed)
    assert not scene.springs
    drive = motion["drive.torque"] * scene.drive.law.speed
    loads = np.zeros(drive.shape)
    for load in scene.loads:
        assert isinstance(load, Force)
        loads += (complex(*load.force).conjugate() * place(scene, motion, load.at, "v")).real
    terms = drive, loads, motion["friction.power"], -growth_of_kinetic_energy(scene, motion)
    assert np.all(motion["friction.power"] < 0)
    # Ten terms of rounded channels: some 1e-16 of the largest each.
    assert np.abs(sum(terms)).max() <= 1e-14 * np.abs(terms).max()


def pinched(coefficient: float) -> Scene:
    """Return a slider-crank whose slider jams on a short guide, with friction nowhere else."""
    guide = GuideFriction(slider="slider", length=0.1, coefficient=coefficient)
    return replace(scene_files.load("slider_crank", {"drive.start": 0.1}), friction=(guide,))


def test_a_jam_says_where_and_from_what_share_of_the_friction_on() -> None:
    """The share is that which just passes: with a little less of the coefficient everywhere is a solution."""
    with pytest.raises(Failure, match=r"^friction holds the linkage at crank angle \S+ rad, from 0\.\d+ of") as failure:
        run(pinched(5.0), SAMPLES)
    assert failure.value.status is Status.jammed


def test_nobody_who_asks_for_no_forces_is_told_of_a_jam() -> None:
    request = Sampling(SAMPLES, channels=frozenset({"B.x"}))
    simulation = model.build(pinched(5.0), model.DEFAULT, request)
    simulation.solve()
    assert set(simulation.read().samples) == {"time", "crank_angle", "B.x"}


def test_nothing_of_the_scene_s_own_formulas_is_used(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = everywhere(scenes.load("toggle_press"))
    expected = run(scene, SAMPLES)
    monkeypatch.setattr(PinFriction, "arm", property(lambda _: 1e3))
    for kind in (PinFriction, GuideFriction):
        monkeypatch.setattr(kind, "sense", lambda *_: 1e3)
    motion = run(scene, SAMPLES)
    assert all(np.array_equal(motion[channel], expected[channel]) for channel in expected.samples)


@pytest.mark.parametrize("far", [1.1, 1e6])
def test_what_the_digits_do_not_prove_is_no_solution(monkeypatch: pytest.MonkeyPatch, far: float) -> None:
    """Joints' forces that are off by a tenth, or by far, are not taken for some: no ball of few digits is one."""
    followed = Pressed.followed
    monkeypatch.setattr(Pressed, "followed", lambda self: [far * g for g in followed(self)])
    with pytest.raises(Failure, match=r"prove the f(orces|riction's forces at crank angle)") as failure:
        run(everywhere(scene_files.load("toggle_press")), SAMPLES)
    assert failure.value.status is Status.not_converged
