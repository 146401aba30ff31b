"""What an engine's own output must satisfy, with no reference.

The drive where it was asked to be, closed joints, one branch, small estimated errors, Newton and Euler, power.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from scenes import Motion, Scene
from scenes.motion import UNITS, Samples, force_channels, kinematic_channels, quantity
from scenes.scene import GROUND, Body

from ..engines.axis import axis
from ..engines.motion_vectors import MotionVectors, Vectors, distances, inertia
from ..engines.press_switches import Acting, Acts, acts, fitted, press_forces, stroke_ends
from ..engines.reference import NOTHING, force_scales, sizes
from ..engines.travel import guide_travel
from .constraints import largest_length
from .errors import GROUPS, SHOWN_GROUPS
from .estimate import Estimate, estimate
from .round_off import EPS, distance

Violations = dict[tuple[str, str, str], Samples]  # by check, of what, relative to what

ROUNDINGS = 4  # of a difference of two places and of its length
RELATIVE = "larger of its scale and magnitude"


@dataclass(frozen=True)
class Check:
    """The worst violation over the whole run."""

    check: str
    of: str  # the body, the channel, or the whole mechanism
    worst: float  # relative
    max_at: float  # in the unit of the scene's axis
    where: str
    relative_to: str


def checks(
    scene: Scene,
    motion: Motion,
    travel: Mapping[str, float],
    may: Sequence[Acts] | None = None,
    ends: Sequence[float] | None = None,
) -> list[Check]:
    """Return every check that the motion has the channels for; `travel` is that of each moving point, m.

    `may` is whether each press force may act, by sample, and `ends` where their strokes end, m; None where the motion
    itself decides, which is of a whole cycle.
    """
    state = MotionVectors(scene, motion)
    violations = {("drive", scene.drive.body, "radian" if scene.driven_slide is None else "travel"): _drive(state)}
    for body in scene.bodies.values():
        if motion.samples.keys() >= _closed_by(scene, body):
            violations["closure", body.name, "travel of its points"] = _gaps(state, body, travel)
    if motion.samples.keys() >= set(kinematic_channels(scene)):
        estimated = estimate(scene, motion, travel, ends)
        violations["branch", "linkage", "sign of the Jacobian"] = _flips(estimated.branch)
        violations |= _estimated(estimated)
        if scene.has_masses and motion.samples.keys() >= set(force_channels(scene)):
            presses = zip(press_forces(scene), stroke_ends(state), strict=True)
            violations |= _balances(state, travel, estimated, may or [acts(state, *press) for press in presses])
    return [_worst(*what, violation, state) for what, violation in violations.items()]


def _worst(check: str, of: str, relative_to: str, violation: Samples, state: MotionVectors) -> Check:
    row = int(violation.argmax())
    max_at = float(axis(state.scene).of(state.motion)[row])
    where = state.scene.where(float(state.motion[state.scene.drive_channel][row]))
    return Check(check, of, float(violation[row]), max_at, where, relative_to)


def _flips(branch: Samples) -> Samples:
    """Return 1 where the sign is not that of the first pose that is not singular, shape (n,)."""
    first = np.append(branch[branch != 0], 1.0)[0]
    return np.where(branch * first >= 0, 0.0, 1.0)


def _estimated(estimated: Estimate) -> Violations:
    """Return the errors of the channel of each group that is furthest off."""
    errors = estimated.errors
    groups = [[channel for channel in errors if GROUPS[quantity(channel)] == group] for group in SHOWN_GROUPS]
    worst = (_furthest({channel: errors[channel] for channel in own}) for own in groups if own)
    return {(GROUPS[quantity(channel)], channel, RELATIVE): errors[channel] for channel in worst}


def _furthest(errors: Mapping[str, Samples]) -> str:
    """Return the channel with the largest error; one that is not a number is larger than all."""
    return [*errors][int(np.argmax([error.max() for error in errors.values()]))]


def _drive(state: MotionVectors) -> Samples:
    """Return how far the drive is from where it was asked to be, by 1 rad, its travel or its way so far, shape (n,)."""
    scene = state.scene
    asked = Motion({scene.drive_channel: scene.drive.at(state.motion["time"]).position})
    scale = 1.0 if scene.driven_slide is None else float(np.ptp(scene.drive.extent))
    off: Samples = np.abs(state.motion[scene.drive_channel] - asked[scene.drive_channel])
    return off / sizes(asked, scene.drive_channel, scale)


def _closed_by(scene: Scene, body: Body) -> set[str]:
    """Return the channels that say whether a body's joints are closed."""
    points, names = set(body.points), set[str]()
    if body.slide is not None:
        names = {body.name, body.slide.on}
        points |= set(() if body.slide.on == GROUND else scene.bodies[body.slide.on].points[:1])
    angles = {f"{name}.angle" for name in names if name in scene.turning}
    return angles | {f"{point}.{axis}" for point in points - set(scene.ground) for axis in "xy"}


def _gaps(state: MotionVectors, body: Body, travel: Mapping[str, float]) -> Samples:
    """Return by how much the body's points miss their distances, and it its guide, by their travel, shape (n,).

    A point belongs to every body that names it, so a pin that is open shows as a wrong distance in one of them. Of two
    points the larger travel counts: it is the less accurate one whose error opens the distance. A body that is turned
    against its guide is off by that angle, rad, at an arm of its travel.
    """
    gap = np.zeros(state.motion["time"].shape)
    for (p, q), length in distances(body).items():
        first, second = state.place(p), state.place(q)
        off = np.abs(np.abs(first - second) - length)
        rounding = ROUNDINGS * EPS * np.maximum(np.abs(first), np.abs(second))  # of links that are long for the travel
        gap = np.maximum(gap, np.where(off <= rounding, 0.0, off) / max(travel.get(p, 0.0), travel.get(q, 0.0)))
    if body.slide is not None:
        on, (origin, _) = state.on_guide(body), state.frame(body.slide.on)
        places = np.abs(state.place(body.points[0])) + np.abs(origin) + abs(complex(*body.slide.through))
        off = np.where(np.abs(on.imag) <= ROUNDINGS * EPS * (places + np.abs(on)), 0.0, np.abs(on.imag))
        gap = np.maximum(gap, off / guide_travel(state.scene, travel, body))
        if body.name in state.scene.turning:
            between = state.angle(body.name) - state.angle(body.slide.on)
            gap = np.maximum(gap, np.abs(np.remainder(between + np.pi, 2 * np.pi) - np.pi))
    return gap


def _balances(
    state: MotionVectors, travel: Mapping[str, float], estimated: Estimate, may: Sequence[Acts]
) -> Violations:
    """Return what forces and power leave over; on the switch of a press force, on the side where it is less.

    What rounding explains is zero.
    """
    least: Violations = {}
    rounding = EPS * estimated.condition * distance(state.scene, state.motion)

    def misfit(acting: Acting) -> tuple[Samples, Mapping[str, Samples]]:
        """Return the power left over, to which all sliders add; the rest, each of one body, is the least of any."""
        standing = replace(state, acting=acting)
        scale = _scales(standing, estimated.closed, travel)
        left_over = dict(_newton_euler(standing, scale, rounding))
        power = _power(standing, travel, rounding)
        left_over["power", "mechanism", "largest force times the largest speed"] = power
        least.update({what: np.minimum(least.get(what, np.inf), over) for what, over in left_over.items()})
        return power, {}

    fitted(press_forces(state.scene), may, misfit)
    return least


def _scales(state: MotionVectors, closed: Motion, travel: Mapping[str, float]) -> dict[str, float]:
    """Return what is left over on each body is relative to: the peak force on it, or on any where it carries nothing.

    It carries nothing if that is so in the motion's own poses, in `closed`: what an engine finds there is its noise.
    """
    peaks, carried = _peaks(state), _peaks(replace(state, motion=closed))
    nothing = NOTHING * min(max(carried.values()), max(peaks.values()))
    own = {name: 0.0 if carried[name] < nothing else peak for name, peak in peaks.items()}
    return force_scales(state.scene, state.motion, travel, own)


def _peaks(state: MotionVectors) -> dict[str, float]:
    """Return the largest of the forces on each body."""
    bodies = state.scene.bodies.values()
    return {body.name: max(float(np.abs(force).max()) for force, _ in _pushes(state, body)) for body in bodies}


def _pushes(state: MotionVectors, body: Body) -> list[tuple[Vectors, Vectors]]:
    """Return the forces on a body, with their points of attack."""
    return [*state.joint_forces(body), *((push.force, push.at) for push in state.applied(body))]


def _newton_euler(
    state: MotionVectors, scale: Mapping[str, float], rounding: Samples
) -> Iterator[tuple[tuple[str, str, str], Samples]]:
    """Yield, body by body, what its reactions and loads leave over of m a and of I alpha about the centre of mass."""
    explained, length = rounding * max(scale.values()), largest_length(state.scene)
    for body in state.scene.bodies.values():
        com, _, acceleration = state.com(body)
        force = -(body.mass or 0.0) * acceleration
        moment = state.couples(body) - inertia(body) * state.turning(body.name)[2]
        for push, at in _pushes(state, body):
            force = force + push
            moment = moment + ((at - com).conjugate() * push).imag
        left, turning = np.abs(force), np.abs(moment)
        yield ("Newton", body.name, "peak force on the body"), np.where(left <= explained, 0.0, left) / scale[body.name]
        turning = np.where(turning <= explained * length, 0.0, turning)
        yield ("Euler", body.name, "peak force times the linkage's size"), turning / (scale[body.name] * length)


def _power(state: MotionVectors, travel: Mapping[str, float], rounding: Samples) -> Samples:
    """Return what the power of drive, loads, springs and gravity leaves over of the rate of kinetic energy."""
    driven = state.scene.bodies[state.scene.drive.body]
    if state.scene.driven_slide is None:
        terms = [state.motion["drive.torque"] * state.turning(driven.name)[1]]
    else:
        terms = [state.motion["drive.force"] * state.displacement(driven)[1]]
    for body in state.scene.bodies.values():
        terms += [(push.velocity.conjugate() * push.force).real for push in state.applied(body)]
        _, v, a = state.com(body)
        _, omega, alpha = state.turning(body.name)
        terms.append(-(body.mass or 0.0) * (v * a.conjugate()).real - inertia(body) * omega * alpha)
    forces = [c for c in force_channels(state.scene) if UNITS[quantity(c)] == "N"]
    peaks = {c: float(np.abs(state.motion[c]).max()) for c in forces}
    natural = max(force_scales(state.scene, state.motion, travel, peaks).values(), default=0.0)
    natural *= max((float(np.abs(state.point(p)[1]).max()) for p in state.scene.moving_points), default=0.0)
    peak = max(natural, *(float(np.abs(term).max()) for term in terms)) or 1.0
    left = np.abs(sum(terms)) / peak
    return np.where(left <= rounding, 0.0, left)
