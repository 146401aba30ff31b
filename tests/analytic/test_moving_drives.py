"""Drives between moving bodies: closed forms against the group's equations, virtual work, and the energy of the whole.

The general route, Newton's method on the group that the drive closes, shares no formula of a moving leg with them.
"""

from typing import Any

import numpy as np
import pytest

import analytic
from analytic.core import decomposition
from compare.mechanics.bodies import weights
from scenes import Motion, Scene
from scenes.model.motion import Samples
from tests import scene_files
from tests.comparisons import sampled

ROD_ON_THE_GROUND = {  # the cylinder is the bucket's, the rod the ground's
    "bodies.rod.points": {"A": [10, 20]},
    "bodies.cylinder.points": {"B": [0, 0]},
    "bodies.bucket.points": {"B": [0, 300], "D": [0, 0], "T": [500, 0]},
}
ON_A_SLIDER = {  # RRP: the rod moves a block on a guide
    "bodies.bucket.points": {"B": [0, 0], "T": [50, 0]},
    "bodies.bucket.slides": {"through": [0, -100], "along": [1, 0]},
    "ground.points.D": None,
    "sketch.B": [550, -100],
    "sketch.displacement": 660,
}
STICK_FIRST = {"drive.body": "boom", "drive.on": "stick", "drive.speed": -20, "drive.start": 110, "drive.end": 60}
STICK_FIRST |= {"sketch.angle": 90}
CASES: list[tuple[str, dict[str, Any]]] = [
    ("bucket", {}),
    ("bucket", ROD_ON_THE_GROUND),
    ("bucket", ON_A_SLIDER),
    ("elbow", {}),
    ("elbow", STICK_FIRST),
]


def way(scene: Scene, count: int = 25) -> Samples:
    """Positions along the drive's way but for its ends, rad or m."""
    return np.linspace(*scene.drive.law.extent, count + 2)[1:-1]


def by_newton(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> Motion:
    """The motion with no leg that the drive changes taken for one: the bodies left are one larger group."""
    pinned, dyads = decomposition.Pinned, decomposition._dyads
    monkeypatch.setattr(decomposition, "_dyads", lambda placed, left: (d for d in dyads(placed, left) if plain(d)))

    def plain(dyad: Any) -> bool:
        return not any(isinstance(leg, pinned) and leg.via for leg in dyad.legs)

    motion = analytic.solve(scene, way(scene))
    monkeypatch.undo()
    return motion


@sampled(2)
@pytest.mark.parametrize(("name", "changes"), CASES)
def test_closed_forms_and_the_groups_equations(
    name: str, changes: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = scene_files.load(name, changes)
    assert analytic.in_closed_form(scene)
    one, other = analytic.solve(scene, way(scene)), by_newton(scene, monkeypatch)
    for channel in scene.channels.names():
        stem = channel[:-1] if channel[-1] in "xy" else channel
        size = max(np.abs(other[c]).max() for c in other.samples if c.startswith(stem))
        size = size if scene.has_masses and size > 1e-6 else 1.0  # of what is zero by symmetry
        # Newton's roundings by the group's condition
        assert not (np.abs(one[channel] - other[channel]) > 1e-11 * size).any(), channel


@sampled(2)
@pytest.mark.parametrize(("name", "changes"), [*CASES, ("lift", {})])
def test_the_drive_pays_for_the_energy(name: str, changes: dict[str, Any]) -> None:
    """What the drive's effort is by its displacement is the change of kinetic and potential energy."""
    scene = scene_files.load(name, changes)
    x = way(scene)
    h = 1e-4 * np.ptp(x)  # differences of fourth order: rounding and error are 1e-10 there
    change = 8 * (energy(scene, x + h) - energy(scene, x - h)) - (energy(scene, x + 2 * h) - energy(scene, x - 2 * h))
    motion = analytic.solve(scene, x)
    effort = motion["drive.torque" if scene.drive.slide is None else "drive.force"]
    assert not (np.abs(effort - change / (12 * h)) > 1e-8 * np.abs(effort).max()).any()


def energy(scene: Scene, x: Samples) -> Samples:
    """The kinetic and the potential energy, J, of bodies by their own channels."""
    motion, total = analytic.solve(scene, x), np.zeros(x.shape)
    for name, body in scene.bodies.items():
        own, first = weights(scene, body), body.points[0]
        at = [motion[f"{first}.{q}x"] + 1j * motion[f"{first}.{q}y"] for q in ("", "v") if first not in scene.ground]
        place, rate = at or (complex(*scene.ground[first]), 0)
        angle, omega = (motion[f"{name}.{q}"] if name in scene.turning else 0 * x for q in ("angle", "omega"))
        arm = own.com * np.exp(1j * angle)
        kinetic = own.mass * np.abs(rate + 1j * omega * arm) ** 2 + own.inertia * omega**2
        total += kinetic / 2 - own.mass * (np.conj(complex(*(scene.gravity or (0, 0)))) * (place + arm)).real
    return total


def test_a_cylinder_without_mass_lifts_a_weight() -> None:
    """By hand: the moment of the weight about D over the lever of the line A-B about D."""
    nothing = dict.fromkeys(("bodies.cylinder.mass", "bodies.rod.mass"), 0.0)
    still: dict[str, Any] = {"drive.speed": 1e-6, "bodies.rod.points.B": [0, 0], "bodies.rod.slides.through": [0, 0]}
    gone = {f"bodies.{body}.{key}": None for body in ("cylinder", "rod") for key in ("com", "inertia")}
    straight = {"bodies.rod.slides.along": [1, 0], "sketch.displacement": 510, "drive.start": 500, "drive.end": 700}
    scene = scene_files.load("bucket", nothing | still | gone | straight)
    motion = analytic.solve(scene, way(scene))
    A, D = complex(0, 0.4), complex(0.6, 0)
    B = motion["B.x"] + 1j * motion["B.y"]
    com = (0.25 + 0.05j) * np.exp(1j * motion["bucket.angle"])
    line = (B - A) / np.abs(B - A)
    by_hand = 100 * 9.81 * com.real / (np.conj(B - D) * line).imag
    assert not (np.abs(motion["drive.force"] - by_hand) > 1e-12 * np.abs(by_hand).max()).any()
    assert not (np.abs(motion["rod.guide_force"]) > 1e-12 * np.abs(by_hand).max()).any()
    pushed = motion["drive.force"] * line  # by the ground's pin on the cylinder, which the rod pushes back
    assert not (np.abs(motion["A.fx"] + 1j * motion["A.fy"] - pushed) > 1e-12 * np.abs(by_hand).max()).any()


@sampled(2)
@pytest.mark.parametrize(("name", "changes"), [*CASES, ("lift", {})])
def test_the_recorded_line_is_the_formulas(name: str, changes: dict[str, Any]) -> None:
    scene = scene_files.load(name, changes)
    wanted = frozenset(scene.channels.names())
    x = way(scene)
    path = f"bodies.{'rod' if 'rod' in scene.bodies else 'bar'}.mass"
    many = analytic.solve_many(scene, {path: [4.0, 6.0]}, x, channels=wanted)
    assert [status.name for status in many.status] == ["ok", "ok"]
    alone = analytic.solve(scene_files.load(name, changes | {path: 6.0}), x, channels=wanted)
    for channel in wanted - {"time"}:
        size = max(np.abs(alone[channel]).max(), 1.0)
        assert not (np.abs(many.samples[channel][1] - alone[channel]) > 1e-12 * size).any(), channel
