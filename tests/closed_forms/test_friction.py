"""Friction against formulas that are derived here, by hand, for every engine that knows it.

All bodies are without mass, so that only what is written down acts. An engine's line has the largest relative error
that its rounding leaves, and how near to a jam it can tell the one side from the other.
"""

from dataclasses import replace
from math import asin, atan, cos, degrees, pi, radians, sin, sqrt, tan
from typing import Any, NamedTuple

import numpy as np
import pytest

from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.scene import PinFriction
from tests import scene_files

from .engines import ENGINES as ALL
from .engines import LIGHT, Held, by_name, every
from .friction import CRITICAL, LENGTH, LEVER, MU, SPEED, Q, pull


class Theory(NamedTuple):
    """An engine, and what it can be held to."""

    name: str  # of `engines`
    tolerance: float  # relative; of a sum of a few rounded terms
    nearness: float  # to a jam, of a length or a coefficient


ENGINES = (
    Theory("50 digits", 1e-15, 1e-9),
    Theory("analytic", 1e-15, 1e-9),
    Theory("exudyn pointwise", 1e-9, 1e-6),
    Theory("exudyn steps", 1e-9, 1e-6),
)
SAMPLING = Sampling(8)


@pytest.fixture(params=ENGINES, ids=[theory.name for theory in ENGINES])
def theory(request: pytest.FixtureRequest) -> Theory:
    of: Theory = request.param
    return of


def solved(theory: Theory, scene: Scene) -> Motion:
    (held,) = by_name(theory.name)
    return held.run(scene, SAMPLING)


def jams(theory: Theory, scene: Scene) -> bool:
    """Whether friction holds it, and it is said where, by the drive's position."""
    try:
        solved(theory, scene)
    except Failure as failure:
        return failure.status is Status.jammed and f"{scene.drive.body} at" in failure.reason
    return False


@every(held for held in ALL if held.friction < np.inf and held.refuses != LIGHT)
@pytest.mark.parametrize("pushed", [False, True])
def test_drawer_up_to_its_jam_and_beyond(held: Held, *, pushed: bool) -> None:
    """From c = 1 on none pulls against a load; of one along the motion P > 0 is a second solution then.

    The core says so; the others have the one that a drawer without friction goes on to.
    """
    load = -Q if pushed else Q
    for rung in (0.0, 0.5, 1 - 1e-6, 1 + 1e-6, 4.0):
        changes = {"friction.0.coefficient": rung * CRITICAL, "loads.0.force": [-load, 0]}
        scene, expected = scene_files.load("drawer", changes), pull(rung * CRITICAL, load)
        status = Status.jammed if expected == np.inf else Status.ok
        if pushed and rung > 1 and held.engine == "analytic":
            status = Status.undetermined
        ended = held.outcome(scene, SAMPLING)
        assert (ended.status if isinstance(ended, Failure) else Status.ok) is status, rung
        if isinstance(ended, Motion):
            # The massless drawer moves evenly: roundings of 2 e / L and of its pose, 1e-10, as often as forces grow.
            off = np.abs(ended["drive.force"] / expected - 1).max()
            assert not off > 1e-10 * (1 if pushed else 1 / (1 - rung)), rung


@every(held for held in ALL if held.friction < np.inf and held.refuses != LIGHT)
@pytest.mark.parametrize(
    "more", [{"smooth": 0.5}, {"viscous": 15}, {"smooth": 0.5, "viscous": 15}, {"length": 10.0}, {"length": 0.0601}]
)
def test_drawer_with_a_film_a_smooth_sense_or_another_contact(held: Held, more: dict[str, float]) -> None:
    """A contact of 0.06 m jams; one that is a tenth of a millimetre longer takes 600 times the load to pull."""
    changes = {f"friction.0.{key}": value for key, value in more.items()}
    motion, expected = held.run(scene_files.load("drawer", changes), SAMPLING), pull(**more)
    grown = 1e-10 * max(1.0, expected / Q)  # roundings of 2 e / L and of its pose, as often as forces grow
    assert not np.abs(motion["drive.force"] / expected - 1).max() > grown
    assert not np.abs(motion["drawer.friction_force"] - (Q - expected)).max() > 2 * grown * expected
    assert not np.abs(motion["friction.power"] - SPEED * (Q - expected)).max() > grown * expected


@pytest.mark.parametrize("weight", [0.0, 30.0, 100.0])
def test_drawer_pulled_beside_its_guide(theory: Theory, weight: float) -> None:
    """P = Q / (1 - 2 mu e / L) at a lever e, but P = Q + mu W where the weight W holds both ends of the contact down.

    The link pulls with P along the guide, at a lever e, so the guide's moment about D is M = e P, its force N = W. The
    ends are pressed by |N1| + |N2| = max(W, 2 e P / L), and P = Q + mu (|N1| + |N2|), however fast.
    """
    weighs = {"gravity": [0, -10], "bodies.drawer.mass": weight / 10, "bodies.drawer.com": [0, 0]}
    scene = scene_files.load("drawer", weighs | {"bodies.drawer.inertia": 0})
    lifted, down = pull(), Q + MU * weight
    expected = lifted if 2 * LEVER * lifted / LENGTH > weight else down
    motion = solved(theory, scene)
    # The sum that P is of three rounded terms.
    np.testing.assert_allclose(motion["drive.force"], expected, rtol=4 * theory.tolerance)
    np.testing.assert_allclose(motion["drawer.friction_force"], Q - expected, rtol=8 * theory.tolerance)
    np.testing.assert_allclose(motion["friction.power"], 0.4 * (Q - expected), rtol=8 * theory.tolerance)


def test_drawer_jams_on_a_guide_as_short_as_theory_says(theory: Theory) -> None:
    """P grows without bound as the guide's length comes down to 2 mu e: whatever Q is, nothing pulls it then.

    At its own first point, where e = 0, the link pulls it however short its guide and rough it is: M = 0, so P = Q.
    """
    for length, held in ((1 + theory.nearness, False), (1 - theory.nearness, True)):
        assert jams(theory, scene_files.load("drawer", {"friction.0.length": 2 * MU * LEVER * length})) is held
    own = {"bodies.drawer.points.H": [0.2, 0], "bodies.hand.slides.through": [0, 0], "sketch.H": [0.2, 0]}
    rough = {"friction.0.length": 1e-3, "friction.0.coefficient": 50.0, "sketch.P": [0.7, 0]}
    motion = solved(theory, scene_files.load("drawer", own | rough))
    np.testing.assert_allclose(motion["drive.force"], Q, rtol=theory.tolerance)


W, FACE = 50.0, atan(0.3)  # of the wedge: N on the ram, rad
INWARDS = {"drive.speed": -0.1, "drive.start": 0.5, "drive.end": 0.1}
# The ram drives and sinks, and the force is on the wedge, against it.
SINKING = {"body": "ram", "speed": -0.03, "start": -0.33, "end": -0.45}
BY_RAM: scene_files.Changes = {
    "drive": SINKING,
    "loads": [{"body": "wedge", "at": "W", "force": [-W, 0]}],
    "sketch": {"displacement": -0.33, "W": [0.1, 0], "T": [-0.4, -0.15], "F": [0, -0.03]},
}


@pytest.mark.parametrize("mu", [0.0, 0.1, 0.3, 0.8])
def test_wedge_that_is_driven(theory: Theory, mu: float) -> None:
    """W tan(phi - alpha) withdraws it, tan phi = mu: self-locking above tan alpha. -W tan(alpha + phi) drives it in.

    Withdrawn along x, it slides on under the block, which friction pulls along with it, up the face e = (cos alpha,
    sin alpha). From the wedge the block has N (n + mu e), n = (-sin alpha, cos alpha), whose vertical part carries W:
    N (cos alpha + mu sin alpha) = W. The drive has its horizontal one, N (mu cos alpha - sin alpha); inwards mu
    changes its sign.
    """
    rough = {"friction.0.coefficient": mu}
    # Of tan(alpha - phi) near zero, rounding leaves what it does of W.
    at: Any = {"rtol": 4 * theory.tolerance, "atol": theory.tolerance * W}
    withdrawn = solved(theory, scene_files.load("wedge_and_ram", rough))
    np.testing.assert_allclose(withdrawn["drive.force"], W * tan(atan(mu) - FACE), **at)
    inwards = solved(theory, scene_files.load("wedge_and_ram", rough | INWARDS))
    np.testing.assert_allclose(inwards["drive.force"], -W * tan(FACE + atan(mu)), **at)


def test_wedge_driven_by_its_ram(theory: Theory) -> None:
    """W / tan(alpha - phi) sinks the ram against W on the wedge, and nothing does from mu = tan alpha on.

    The forces at the face are those of a wedge that is withdrawn; now the horizontal one is W.
    """
    motion = solved(theory, scene_files.load("wedge_and_ram", BY_RAM))
    np.testing.assert_allclose(motion["drive.force"], -W / tan(FACE - atan(0.1)), rtol=4 * theory.tolerance)
    for share, held in ((1 - theory.nearness, False), (1 + theory.nearness, True)):
        rough = {"friction.0.coefficient": 0.3 * share}
        assert jams(theory, scene_files.load("wedge_and_ram", BY_RAM | rough)) is held


def test_lever_turns_on_its_pin_s_friction_circle(theory: Theory) -> None:
    """Level, P (b - rho) = W (a + rho), rho = r sin phi with tan phi = mu; elsewhere its force touches the circle.

    The link pulls A along u with P, at a lever m about O; W hangs on B, at a lever x. The pin holds both, R = P u + W d
    with d = (0, -1), and resists the turning by rho |R|, so P m - W x = rho |R|. Of its square the larger P is it:

        (m^2 - rho^2) P^2 - 2 W (m x + rho^2 u·d) P + W^2 (x^2 - rho^2) = 0
    """
    weight, rho = 60.0, 0.05 * sin(atan(0.4))
    motion = solved(theory, scene_files.load("lever_on_a_pin"))
    assert abs(motion["drive.force"][4] / (weight * (0.3 + rho) / (0.1 - rho)) - 1) <= 4 * theory.tolerance
    A, B, P = (motion[f"{point}.x"] + 1j * motion[f"{point}.y"] for point in "ABP")
    u = (P - A) / np.abs(P - A)
    m, x, down = (A.conj() * u).imag, B.real, -u.imag
    a, b, c = m**2 - rho**2, weight * (m * x + rho**2 * down), weight**2 * (x**2 - rho**2)
    pull = (b + np.sqrt(b * b - a * c)) / a
    # The discriminant takes half of its two terms away from each other, and u is of differences of a link's length.
    np.testing.assert_allclose(motion["drive.force"], pull * down, rtol=32 * theory.tolerance)
    np.testing.assert_allclose(
        motion["O.friction_moment"], -rho * np.hypot(motion["O.fx"], motion["O.fy"]), rtol=8 * theory.tolerance
    )


RADIUS, ROD, F = 0.09, 1.39, 1.6e6  # of the crank press: m, m, N
DIAMETERS = {"O": 0.12, "A": 0.08, "B": 0.05}  # m
SMALL = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
MASSLESS = {f"bodies.{body}.mass": 0 for body in ("crank", "rod", "slider")}
STRETCHED: scene_files.Changes = {**MASSLESS, "loads.0.last": None, "drive.start": 270}


def pressing(theory: Theory, mu: float) -> Any:
    """Return the drive's torque by the force on the slider, m, from the stretched dead centre in eighths of a turn."""
    pins = (PinFriction(at=at, radius=diameter / 2, coefficient=mu) for at, diameter in DIAMETERS.items())
    scene = replace(scene_files.load("crank_press", STRETCHED), friction=tuple(pins))
    return solved(theory, scene)["drive.torque"] / F


def first_order(mu: float) -> tuple[Any, Any]:
    """Return the lever arms without friction, and what friction adds to them to the first order of mu, m."""
    theta = np.arange(9) * pi / 4  # from the stretched dead centre
    cos_psi = np.sqrt(1 - (RADIUS / ROD * np.sin(theta)) ** 2)
    k = RADIUS / ROD * np.cos(theta) / cos_psi
    added = mu / 2 * ((1 + k) * DIAMETERS["A"] + np.abs(k) * DIAMETERS["B"] + DIAMETERS["O"]) / cos_psi
    return -RADIUS * np.sin(theta) * (1 + k), added


@pytest.mark.parametrize(
    "theory", ENGINES[:2], indirect=True, ids=["50 digits", "analytic"]
)  # of a coefficient of 1e-5 Exudyn's steps leave nothing
def test_crank_press_to_the_first_order_of_friction(theory: Theory) -> None:
    """It adds m = mu / 2 [(1 + k) d_A + |k| d_B + d_0] / cos psi to the lever arm, k = lambda cos theta / cos psi.

    The crank's angle from the stretched dead centre is theta, lambda = r / l. The rod is inclined by psi, l sin psi =
    r sin theta, so it turns k times as fast as the crank, the other way round: A turns by 1 + k, B by k, and O by 1, to
    one of the crank. Each resists by rho = mu d / 2 times what the rod carries, F / cos psi, all to the first order of
    mu. The drive does their work beside that of F, whose arm is r sin theta (1 + k), so m is relative to F.

    Where mu changes its sign the drive turns the other way round. That mirrors the linkage at a dead centre, stretched
    with k = lambda and folded with k = -lambda: m is odd in mu there, and its relative error falls as mu^2. Elsewhere
    it is not, and the error falls as mu.
    """
    errors = []
    for mu in SMALL:
        arm, added = first_order(mu)
        errors.append(np.abs((pressing(theory, mu) - arm) / added - 1))
    order, dead = -np.diff(np.log10(errors), axis=0), np.arange(9) % 4 == 0
    # At dead centres mu^4 is next, and 1e-5 is lost in the crank's rounded angle. Elsewhere the first power is small,
    # some d / l, and seen alone from 1e-4 on.
    np.testing.assert_allclose(order[:3, dead], 2, atol=0.01)
    np.testing.assert_allclose(order[3, ~dead], 1, atol=0.06)


ARM, LINK = 0.1, 0.15  # of the toggle: m
CIRCLES = {at: radius * sin(atan(0.15)) for at, radius in (("O", 0.025), ("A", 0.02), ("B", 0.015))}  # m
TOGGLE: scene_files.Changes = {
    **{f"bodies.{body}.mass": 0 for body in ("lever", "rod", "slider")},
    **{f"friction.{number}.radius": radius for number, radius in enumerate((25, 20, 15))},
    **{"bodies.rod.lengths.A-B": 150, "sketch.B": [249, 0]},
}


def locking_angle() -> float:
    """Return theta of the toggle where r sin(theta + psi - delta) = rho_A + rho_O, deg, by halving."""
    delta, low, high = asin((CIRCLES["A"] + CIRCLES["B"]) / LINK), 0.0, 0.5
    for _ in range(60):
        theta = (low + high) / 2
        psi = asin(ARM / LINK * sin(theta))
        short = ARM * sin(theta + psi - delta) < CIRCLES["A"] + CIRCLES["O"]
        low, high = (theta, high) if short else (low, theta)
    return degrees(low)


def test_toggle_that_its_lever_opens_locks_itself(theory: Theory) -> None:
    """The load does not turn it below r sin(theta + psi - delta) = rho_A + rho_O, sin delta = (rho_A + rho_B) / l.

    The lever opens it by theta, and the rod falls by psi, l sin psi = r sin theta. The lever turns on O and in A the
    one way, the rod on B the other way. So the rod's push touches the circles of A and B on opposite sides, at the
    angle delta with the rod: psi - delta with the guide. A parallel line through A would pass O by
    r sin(theta + psi - delta); it passes nearer by rho_A. Within O's own circle, rho_O, it is held by O alone, and the
    drive needs no torque, whatever the guide has of friction, which only changes the rod's force.
    """
    angle, near = locking_angle(), theory.nearness  # deg
    at = {"drive.start": angle - near, "drive.end": angle + near}
    torque = solved(theory, scene_files.load("self_locking_toggle", {**TOGGLE, **at}))["drive.torque"]
    assert torque[0] > 0 > torque[-1]


@pytest.mark.parametrize("moment", [-1e-3, -1e3])
def test_toggle_that_its_slider_opens_jams(theory: Theory, moment: float) -> None:
    """Below that angle no push on the slider opens it against a moment on the lever, however small that is.

    All turns as above, so the rod's line is the same; where it passes O within its circle, it turns nothing.
    """
    changes = {**TOGGLE, "units.speed": "mm/s", "loads": [{"body": "lever", "moment": moment}]}
    for off, held in ((theory.nearness, False), (-theory.nearness, True)):
        theta = radians(locking_angle() + off)
        x = 1e3 * (ARM * cos(theta) + sqrt(LINK**2 - (ARM * sin(theta)) ** 2))  # mm
        drive = {"body": "slider", "speed": -1e-3, "start": x, "end": x - 1}
        sketch = {"displacement": x, "A": [100, 9], "B": [x, 0]}
        pushed = scene_files.load("self_locking_toggle", changes | {"drive": drive, "sketch": sketch})
        assert jams(theory, pushed) is held
