"""Friction of `absolute_forces`: Newton's and Euler's equations with what resists in the joints, all unknowns at once.

    A x + sum_j w_j y_j = b,    y_j = -c_j s_j |r_j| - viscous_j rate_j,

where x are reactions and the drive's effort, r_j is what of them friction goes by, and w_j what a unit of it does to
the bodies. From c = 0, x is followed in small steps of one factor on all coefficients.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from scenes.elements.friction import Friction, GuideFriction, PinFriction

from .absolute_bodies import Floats

if TYPE_CHECKING:
    from .absolute_coordinates import Absolute
    from .absolute_forces import Instant

ITERATIONS = 30
STARTS = 100  # of a search for other solutions
SEVERAL = "several"  # whether one was found
SLOW = 1e-6  # of the largest rate, or speed: here models differ on the sense, within what they find of the motion
LARGEST_STEP, LEAST_STEP = 1 / 16, 1e-10  # of the factor
CHANGE = 0.1  # of the largest unknown, in a step


class JammedError(AssertionError):
    """The solution does not go on past a factor on all coefficients."""

    def __init__(self, factor: float) -> None:
        super().__init__(f"jammed past {factor:.6g} of the coefficients")
        self.factor = factor


class Resistance(NamedTuple):
    """Friction of one joint at one instant."""

    channel: str
    coefficient: float
    radius: float | None  # m, of a pin
    does: Floats  # w, shape (3 bodies,)
    carries: Floats  # r by x, shape (2, unknowns)
    rate: float
    sense: float
    viscous: float

    def coulomb(self, factor: float) -> float:
        """Return c s."""
        mu = factor * self.coefficient
        return self.sense * (mu if self.radius is None else self.radius * float(np.sin(np.arctan(mu))))

    def norm(self, x: Floats) -> tuple[float, Floats]:
        """Return |r| and its gradient."""
        r = self.carries @ x
        if self.radius is None:
            larger = int(np.abs(r).argmax())
            return float(np.abs(r[larger])), np.sign(r[larger]) * self.carries[larger]
        size = float(np.hypot(*r))
        return size, r / (size or 1.0) @ self.carries


def slips(model: "Absolute", now: "Instant") -> Iterator[tuple[Friction, float, float]]:
    """Yield each friction, how fast its joint's parts move on each other, and the largest such rate in the linkage."""
    scene = model.scene
    spins = {name: model.turning(name, *now[:3])[1] for name in scene.bodies}
    speeds = [np.hypot(*(model.point(name, p) @ now.dQ)) for name, body in scene.bodies.items() for p in body.points]
    for friction in scene.friction:
        if isinstance(friction, PinFriction):
            pin = friction.pin(scene)
            yield friction, spins.get(pin.second, 0.0) - spins.get(pin.first, 0.0), max(map(abs, spins.values()))
        elif isinstance(friction, GuideFriction):
            yield friction, model.displaced(friction.slider, now.Q, now.dQ)[1], float(max(speeds))


def unsure(model: "Absolute", now: "Instant") -> bool:
    """Whether a joint is so slow that nobody is held to the sense of its friction."""
    return any(one.smooth is None and abs(rate) <= SLOW * largest for one, rate, largest in slips(model, now))


def resistances(
    model: "Absolute", now: "Instant", unknown: Sequence[str], between: Callable[..., Floats]
) -> list[Resistance]:
    """Return the friction of a scene; `between` takes two bodies, and what the first does on the second."""
    scene, found = model.scene, []
    for friction, rate, largest in slips(model, now):
        carries = np.zeros((2, len(unknown)))
        if isinstance(friction, PinFriction):
            pin, radius = friction.pin(scene), friction.radius
            names, sizes = [f"{pin.channel}.fx", f"{pin.channel}.fy"], (1.0, 1.0)
            does = between(pin.first, pin.second, np.zeros(2), np.zeros(2), 1.0)
        else:
            assert isinstance(friction, GuideFriction)
            name, radius = friction.slider, None
            names, sizes = [f"{name}.guide_force", f"{name}.guide_moment"], (1.0, 2 / friction.length)
            slide, at = scene.slides[name], model.point(name, scene.bodies[name].points[0]) @ now.Q
            does = between(slide.on, name, model.vector(slide.on, slide.along) @ now.Q, at, 0.0)
        carries[[0, 1], [unknown.index(name) for name in names]] = sizes
        sense = float(friction.sense(rate, largest))
        given = friction.channel(scene), friction.coefficient, radius, does, carries
        found.append(Resistance(*given, rate, sense, friction.viscous or 0.0))
    return found


def resisted(A: Floats, b: Floats, joints: Sequence[Resistance]) -> tuple[Floats, dict[str, float]]:
    """Return x, and the channels of friction, with `SEVERAL` as one more; JammedError where no x follows."""
    x: Floats = np.asarray(np.linalg.solve(A, b), float)
    if not joints:
        return x, {}
    x, factor, orientation = _newton(A, b, joints, 0.0, x)[0], 0.0, np.linalg.slogdet(A)[0]
    units = np.linalg.solve(A, np.transpose([joint.does for joint in joints]))
    gains = [
        [joint.norm(unit)[0] * abs(other.coulomb(1.0)) for other, unit in zip(joints, units.T, strict=True)]
        for joint in joints
    ]
    unique = np.abs(np.linalg.eigvals(gains)).max() < 1  # the loads change by less than what friction was found by
    step = 1.0 if unique else LARGEST_STEP
    while factor < 1:
        found, determinant = _newton(A, b, joints, min(factor + step, 1.0), x)
        near = unique or np.abs(found - x).max() <= CHANGE * np.abs(found).max()
        if determinant == orientation and near:
            x, factor, step = found, min(factor + step, 1.0), min(2 * step, LARGEST_STEP)
        else:
            step /= 2
        if step < LEAST_STEP:
            raise JammedError(factor)
    acting = {joint.channel: _acting(joint, 1.0, x)[0] for joint in joints}
    power = sum(acting[joint.channel] * joint.rate for joint in joints)
    return x, acting | {"friction.power": power, SEVERAL: not unique and another(A, b, joints, x, units)}


def another(A: Floats, b: Floats, joints: Sequence[Resistance], x: Floats, units: Floats) -> bool:
    """Return whether there is a solution other than x, as far as one is found from frictions of all sizes."""
    draw, size, c = np.random.default_rng(1), float(np.abs(x).max()), [joint.coulomb(1.0) for joint in joints]
    for _ in range(STARTS):
        start = size * 10 ** draw.uniform(-1, 3) * draw.standard_normal(len(joints)) * c
        found, determinant = _newton(A, b, joints, 1.0, x - units @ start)
        if determinant != 0 and np.abs(found - x).max() > 1e-6 * size:
            return True
    return False


def _acting(joint: Resistance, factor: float, x: Floats) -> tuple[float, Floats]:
    """Return y and its gradient."""
    size, slope = joint.norm(x)
    return -joint.coulomb(factor) * size - joint.viscous * joint.rate, -joint.coulomb(factor) * slope


def _newton(A: Floats, b: Floats, joints: Sequence[Resistance], factor: float, x: Floats) -> tuple[Floats, float]:
    """Return x with the least correction, and the sign of the determinant there, zero where there is none."""
    last = np.inf
    for _ in range(ITERATIONS):
        residual, J = A @ x - b, A.copy()
        for joint in joints:
            y, slope = _acting(joint, factor, x)
            residual, J = residual + joint.does * y, J + np.outer(joint.does, slope)
        sign = float(np.linalg.slogdet(J)[0])
        if sign == 0:
            return x, 0.0
        correction = np.linalg.solve(J, residual)
        length = float(np.abs(correction).max())
        if length <= 1e-9 * np.abs(x).max() and not length < last / 2:
            return x, sign
        x, last = x - correction, length
    return x, 0.0
