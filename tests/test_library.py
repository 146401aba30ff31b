"""The shipped scenes: every engine solves them within their tolerances, and each is the linkage that it says it is."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import analytic
import scenes
from compare import registry
from compare.run import main
from scenes import Motion, Scene
from scenes.motion import kinematic_channels
from scenes.scene import GROUND

TURN = np.radians(np.arange(720) / 2)  # half-degree steps, without the end


def solve(name: str) -> Motion:
    return analytic.solve(scenes.load(name), TURN)


# --- every scene, through the command line --------------------------------------------------------------------------


@dataclass(frozen=True)
class Outcome:
    scene: Scene
    status: int
    summary: dict[str, Any]


@pytest.fixture(scope="module", params=scenes.shipped())
def outcome(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Outcome:
    """Run one scene once, at the default settings, which its tolerances are for."""
    folder: Path = tmp_path_factory.mktemp("library")
    status = main([request.param, "--check", "--out", str(folder)])
    summary = json.loads((folder / request.param / "summary.json").read_text(encoding="utf-8"))
    return Outcome(scenes.load(request.param), status, summary)


def test_every_tolerance_is_met(outcome: Outcome) -> None:
    assert outcome.status == 0
    assert all(gate["error"] <= gate["tolerance"] for gate in outcome.summary["gates"])


def test_every_engine_is_ok_or_says_why_not(outcome: Outcome) -> None:
    assert set(outcome.summary["engines"]) == set(registry.DEFAULT_ENGINES)
    for engine in outcome.summary["engines"].values():
        assert engine["status"] == "ok" or (engine["status"] == "unsupported" and engine["reason"])


def test_every_engine_that_is_ok_has_a_tolerance_for_every_group(outcome: Outcome) -> None:
    for name, engine in outcome.summary["engines"].items():
        if name == "analytic" or engine["status"] != "ok":
            continue  # the first is the reference itself
        groups = {row["group"] for row in outcome.summary["errors"] if row["engine"] == name}
        assert set(outcome.scene.tolerances[name]) == groups - {"drive"}, name


def test_the_reference_is_certified(outcome: Outcome) -> None:
    """To 1e-12: fifty times what doubles leave of the leg, and far below what it is used to judge but positions."""
    floor = outcome.summary["reference"]["floor"]["by_channel"]
    for channel in kinematic_channels(outcome.scene):
        if channel != "time":
            assert floor[channel] <= 1e-12, channel


@pytest.mark.parametrize("name", scenes.shipped())
def test_every_scene_says_what_it_is_and_where_it_is_from(name: str) -> None:
    scene = scenes.load(name)
    assert scene.name == name
    assert scene.title != name
    assert scene.source


@pytest.mark.parametrize(
    "name", ["toggle_press", "crank_press", "four_bar", "watt_six_bar", "stephenson_six_bar", "walking_leg"]
)
def test_the_drive_does_no_work_in_a_turn(name: str) -> None:
    """Weights and constant forces give back what they take. The mean over a period has no error but rounding."""
    torque = solve(name)["drive.torque"]
    assert abs(torque.mean()) <= 1e-12 * np.abs(torque).max()


# --- what each scene is ---------------------------------------------------------------------------------------------


def test_crank_press() -> None:
    height = solve("crank_press")["B.y"]
    assert abs(np.ptp(height) - 0.180) <= 1e-12  # m; in line, the stroke is twice the crank's radius, to rounding
    assert abs(height.min() + 1.390 + 0.090) <= 1e-12  # m; the rod in line below the crank
    # Where the paper's force begins, 20.40 deg before the lower dead centre; 209.1 mm/s by r, l and the sine law.
    there = analytic.solve(scenes.load("crank_press"), np.radians([270 - 20.40]))
    assert abs(there["B.y"][0] - height.min() - 0.006) <= 3e-6  # m; as much as 0.005 deg are
    assert abs(there["B.vy"][0] + 0.2091) <= 1e-4  # m/s; the digits given


def test_four_bar_is_a_crank_rocker() -> None:
    crank, ground, coupler, rocker = 1, 2, 2.5, 2.5  # of 100 mm
    shortest, *others, longest = sorted((crank, ground, coupler, rocker))
    assert shortest == crank
    assert shortest + longest < sum(others)  # Grashof: the crank turns fully
    motion = solve("four_bar")
    angles = transmission_angle(motion, "coupler", "rocker")
    for extreme, diagonal in ((angles.min(), ground - crank), (angles.max(), ground + crank)):
        by_cosine_law = np.degrees(np.arccos((coupler**2 + rocker**2 - diagonal**2) / (2 * coupler * rocker)))
        assert abs(extreme - by_cosine_law) <= 1e-10  # deg, rounding; 0 and 180 deg are among the samples


def test_four_bar_draws_a_straight_line() -> None:
    crank_angles = np.radians(np.arange(90, 271))
    motion = analytic.solve(scenes.load("four_bar"), crank_angles)
    x, y = motion["T.x"], motion["T.y"]
    for at, by_triangles_3_4_5 in ((0, 0.4), (90, 0.2), (180, 0.0)):  # m
        assert np.hypot(x[at] - by_triangles_3_4_5, y[at] - 0.4) <= 1e-14  # m, rounding
    assert np.ptp(y) <= 0.001  # m, of 0.4 m: straight to a quarter of a percent


@pytest.mark.parametrize(("name", "neighbours"), [("watt_six_bar", True), ("stephenson_six_bar", False)])
def test_six_bar_is_of_its_kind(name: str, neighbours: bool) -> None:
    """A six-bar has two ternary links: neighbours in Watt's, joined by binary links alone in Stephenson's."""
    scene = scenes.load(name)
    links = {GROUND: tuple(scene.ground)} | {body.name: body.points for body in scene.bodies.values()}
    pinned = {link: [pin for pin in scene.pins if link in (pin.first, pin.second)] for link in links}
    ternary = {link for link, pins in pinned.items() if len(pins) == 3}
    assert sorted(len(pins) for pins in pinned.values()) == [2, 2, 2, 2, 3, 3]
    assert any({pin.first, pin.second} == ternary for pin in scene.pins) is neighbours


@pytest.mark.parametrize(
    ("name", "bodies", "smallest"),
    [
        ("watt_six_bar", ("coupler", "bell_crank"), 45),
        ("watt_six_bar", ("link", "rocker"), 35),
        ("stephenson_six_bar", ("coupler", "rocker"), 45),
        ("stephenson_six_bar", ("left", "right"), 43),
        ("walking_leg", ("lower_rod", "swing"), 9),
    ],
)
def test_smallest_transmission_angle(name: str, bodies: tuple[str, str], smallest: float) -> None:
    assert abs(transmission_angle(solve(name), *bodies).min() - smallest) <= 0.5  # deg: as the scene's head rounds it


def test_watt_six_bar_doubles_a_swing() -> None:
    motion = solve("watt_six_bar")
    for body, swing in (("bell_crank", 50), ("rocker", 110)):
        assert abs(np.degrees(np.ptp(np.unwrap(motion[f"{body}.angle"]))) - swing) <= 0.5  # deg: as the head rounds it


def test_walking_leg_has_the_foot_path_of_jansen() -> None:
    """Against his numbers typed again, and circles: which of two meeting points is which is seen in his drawing."""
    path = jansen_foot_path()
    motion = solve("walking_leg")
    foot = motion["F.x"] + 1j * motion["F.y"]
    assert np.abs(foot - path / 100).max() <= 1e-13  # m; rounding, which a transmission angle of 9 deg multiplies by 6
    stride = np.ptp(path.real)
    stance = path.imag < path.imag.min() + 0.01 * stride
    assert abs(stance.mean() - 0.4) <= 0.01  # of the turn is the foot on the ground, flat to a hundredth of its stride,
    assert np.ptp(path.real[stance]) >= 0.75 * stride  # along three quarters of it,
    assert (np.diff(path.real, append=path.real[0])[stance] > 0).all()  # and never slips back


# --- geometry of their own ------------------------------------------------------------------------------------------

Places = NDArray[np.complex128]


def transmission_angle(motion: Motion, first: str, second: str) -> NDArray[np.float64]:
    """Return the angle, 0 to 90 deg, between two bars by their x axes."""
    return np.degrees(np.arcsin(np.abs(np.sin(motion[f"{first}.angle"] - motion[f"{second}.angle"]))))


def meet(centre_1: Places, radius_1: float, centre_2: Places, radius_2: float) -> Places:
    """Return where two circles meet, on the left of the way from the first centre to the second."""
    way = centre_2 - centre_1
    along = (radius_1**2 - radius_2**2 + np.abs(way) ** 2) / (2 * np.abs(way))
    meeting: Places = centre_1 + way / np.abs(way) * (along + 1j * np.sqrt(radius_1**2 - along**2))
    return meeting


def jansen_foot_path() -> Places:
    a, b, c, d, e, f, g, h, i, j, k, l, m = 38, 41.5, 39.3, 40.1, 55.8, 39.4, 36.7, 65.7, 49, 50, 61.9, 7.8, 15  # noqa: E741
    pivot = np.full(TURN.shape, -a - 1j * l)
    crank_pin = m * np.exp(1j * TURN)
    upper_knee = meet(pivot, b, crank_pin, j)
    hip = meet(pivot, d, upper_knee, e)
    lower_knee = meet(crank_pin, k, pivot, c)
    ankle = meet(lower_knee, g, hip, f)
    return meet(lower_knee, i, ankle, h)
