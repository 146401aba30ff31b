"""What an engine's own output must satisfy, with no reference.

The drive where it was asked to be, closed joints, one branch, small estimated errors, Newton and Euler, power.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import NamedTuple

import numpy as np

from scenes import Motion, Scene
from scenes.channels import Role
from scenes.drive import Drive
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import GROUND, Body

from ..mechanics.bodies import distances
from ..mechanics.elements import Push, applied, drive_power, inertial, magnitudes, of_joints, power_of
from ..mechanics.friction import newtons
from ..mechanics.mechanics import EPS, SHOWN_GROUPS, Mechanics
from ..mechanics.motion_vectors import Acts, MotionVectors
from ..mechanics.projection import projected
from ..mechanics.reference import Acting, fitted
from ..mechanics.round_off import projected_apart
from ..mechanics.scales import NOTHING, force_scales, judged_errors, off_origin, scales, sizes

Violations = dict[tuple[str, str, str], Samples]  # by check, of what, relative to what

KINDS = {"drive": 0, "position": 0, "velocity": 1, "acceleration": 2, "reaction": 3, "torque": 3, "force": 3}
POWERS = (1, 2, 2, 2)  # of the condition in what rounding changes; rates and forces are solved for in rounded poses
FORCES = 3  # the kind of forces
MIN_PROMISE = 1e-12  # of any setting
MAX_ROUNDINGS = 4  # of a difference of two places and of its length
RELATIVE = "larger of its scale and magnitude"
POWER = ("power", "mechanism", "largest force times the largest speed")


@dataclass(frozen=True)
class Check:
    """The worst violation over the whole run."""

    check: str
    of: str  # the body, the channel, or the whole mechanism
    worst: float  # relative
    max_at: float  # in the unit of the scene's axis
    where: str
    relative_to: str


class Estimate(NamedTuple):
    """What is known of a motion without a reference."""

    errors: Mapping[str, Samples]  # by channel, relative as against the reference, each of shape (n,)
    branch: Samples  # the sign of det J, shape (n,): it changes in a singular pose alone
    rounding: Samples  # of places and forces, relative, shape (n,)
    closed: Motion  # its projection onto the constraints


def checks(
    mechanics: Mechanics,
    motion: Motion,
    travel: Mapping[str, float],
    promise: float = MIN_PROMISE,
    may: Sequence[Acts] | None = None,
    ends: Sequence[float] | None = None,
    scale: Mapping[str, float] | None = None,
) -> list[Check]:
    """Every check that the motion has the channels for.

    `travel` is that of each moving point, m, see `travels`; `promise` what the motion is held to, below which no error
    needs an explanation; `may`, by sample, whether each press force may act, and `ends` where their strokes end, m:
    None where the motion itself shows it, which is then of a whole cycle. `scale`, by channel, is what errors are
    divided by; None where the motion's own projection shows it.
    """
    scene, state, places = mechanics.scene, MotionVectors(mechanics.scene, motion), mechanics.axis.of(motion)
    inputs, violations = inputs_of(scene, motion["time"]), dict[tuple[str, str, str], Samples]()
    for number, drive in enumerate(scene.drives):
        share = "radian" if drive.slide is None else "travel"
        violations["drive", drive.body, share] = _off(drive, inputs.driven(number).position, motion)
    for body in scene.bodies.values():
        if motion.samples.keys() >= closed_by(scene, body):
            violations["closure", body.name, "travel of its points"] = _gaps(mechanics, state, body, travel)
    if motion.samples.keys() >= {*scene.channels.names(Role.time, Role.input, Role.kinematic)}:
        # Kinematic channels complete: the motion is projected onto the constraints, and its distance from there is an
        # estimate of its error without a reference.
        estimated = estimate(mechanics, motion, travel, promise, ends, scale)
        violations["branch", "linkage", "sign of the Jacobian"] = _flips(estimated.branch)
        for group in SHOWN_GROUPS:  # its channel that is furthest off; one that is not a number is further than all
            shown = {c: error.max() for c, error in estimated.errors.items() if mechanics.groups[c] == group}
            if shown:
                channel = [*shown][int(np.argmax([*shown.values()]))]
                violations[group, channel, RELATIVE] = estimated.errors[channel]
        if mechanics.forces and motion.samples.keys() >= {*mechanics.forces}:
            violations |= _balances(mechanics, state, travel, estimated, may or [*state.acts(state.stroke_ends())])
    worst = []
    for (check, subject, relative_to), violation in violations.items():
        row = int(violation.argmax())
        where = scene.where(float(motion[scene.channels.drive.position][row]))
        worst.append(Check(check, subject, float(violation[row]), float(places[row]), where, relative_to))
    return worst


def _flips(branch: Samples) -> Samples:
    """1 where the sign is not that of the first pose that is not singular, shape (n,)."""
    first = np.append(branch[branch != 0], 1.0)[0]
    return np.where(branch * first >= 0, 0.0, 1.0)


def _off(drive: Drive, asked: Samples, motion: Motion) -> Samples:
    """How far a drive is from where it was asked to be, by 1 rad, its travel or its way so far, shape (n,)."""
    way: Samples = np.maximum(drive.unit, np.abs(asked - asked[:1]))
    rounding = (
        MAX_ROUNDINGS * EPS * np.hypot(asked, 0.0)
    )  # much of the travel of a slider far from where it is measured
    return np.maximum(np.abs(motion[drive.channel] - asked) - rounding, 0.0) / way


def closed_by(scene: Scene, body: Body) -> set[str]:
    """The channels by which one sees whether a body's joints are closed."""
    points, names = set(body.points), set[str]()
    if body.slide is not None:
        names = {body.name, body.slide.on}
        points |= set(() if body.slide.on == GROUND else scene.bodies[body.slide.on].points[:1])
    known = scene.channels
    angles = {known.bodies[name].angle for name in names if name in known.bodies}
    return angles.union(*(known.points[point].place for point in points - set(scene.ground)))


def _gaps(mechanics: Mechanics, state: MotionVectors, body: Body, travel: Mapping[str, float]) -> Samples:
    """By how much the body's points miss their distances, and it its guide, by their travel, shape (n,)."""
    # A point belongs to every body that names it, so a pin that is open shows as a wrong distance in one of them. Of
    # two points the larger travel counts: it is the less accurate one whose error opens the distance.
    gap = np.zeros(state.motion["time"].shape)
    for (p, q), length in distances(body).items():
        first, second = state.place(p), state.place(q)
        deviation = np.abs(np.abs(first - second) - length)
        rounding = (
            MAX_ROUNDINGS * EPS * np.maximum(np.abs(first), np.abs(second))
        )  # of links that are long for the travel
        gap = np.maximum(
            gap, np.where(deviation <= rounding, 0.0, deviation) / max(travel.get(p, 0.0), travel.get(q, 0.0))
        )
    if body.slide is not None:
        in_guide, (origin, _) = state.on_guide(body), state.frame(body.slide.on)
        places = np.abs(state.place(body.points[0])) + np.abs(origin) + abs(complex(*body.slide.through))
        deviation = np.where(
            np.abs(in_guide.imag) <= MAX_ROUNDINGS * EPS * (places + np.abs(in_guide)), 0.0, np.abs(in_guide.imag)
        )
        gap = np.maximum(gap, deviation / max(travel[p] for p in mechanics.along_guides[body.name] if p in travel))
        if body.name in mechanics.scene.turning:
            angle = state.angle(body.name) - state.angle(body.slide.on)  # rad, at an arm of its travel
            gap = np.maximum(gap, np.abs(np.remainder(angle + np.pi, 2 * np.pi) - np.pi))
    return gap


@np.errstate(all="ignore")  # what is not finite is so in the result
def estimate(
    mechanics: Mechanics,
    motion: Motion,
    travel: Mapping[str, float],
    promise: float = MIN_PROMISE,
    ends: Sequence[float] | None = None,
    scale: Mapping[str, float] | None = None,
) -> Estimate:
    """How far a motion is from its projection onto the constraints: its errors, without a reference.

    Its kinematic channels are complete; arguments are those of `checks`. On the switch of a press force all channels
    count on the side where they fit best. What doubles leave is no error: of the largest value of its kind, and where
    more than the promise is left, of the projection when all numbers are off by their last places.
    """
    turns = np.ones_like(motion["time"])
    for drive in mechanics.scene.drives:
        if drive.slide is None:  # how often a crank has turned: its angle is rounded by as much more
            turns = np.maximum(turns, np.abs(motion[drive.channel]) / (2 * np.pi))
    # Two filters against false alarms. First a bound: eps times a power of the condition times the largest value of the
    # kind, which costs nothing. If more than the promise is left above that, the projection is repeated with all
    # numbers a few last places off, and what moves as much is explained too.
    projection = projected(mechanics, motion, ends)
    closed, condition = projection.closed, projection.condition
    acting = magnitudes(mechanics, closed)
    in_newtons = newtons(mechanics, MotionVectors(mechanics.scene, closed))
    scale, far = scale or scales(mechanics, closed, travel, acting), off_origin(mechanics, motion)
    eps = [EPS * turns, *[EPS * np.maximum(turns, far)] * (len(POWERS) - 1)]  # places themselves are as large as far
    true = Motion({**closed.samples, **projection.forces})
    errors = judged_errors(mechanics, motion, true, scale)
    units: dict[str, Samples | float] = {**scale, **mechanics.newtons, **in_newtons}
    for kind, power in enumerate(POWERS):  # rounding is by the largest value of a kind, in units that make them alike
        of_kind = [channel for channel in errors if KINDS[mechanics.groups[channel]] == kind]
        values = [np.abs(true[channel]) / units[channel] for channel in of_kind if channel not in mechanics.friction]
        if kind == FORCES:  # what joints carry, and what they leave that cancels in them
            values += acting.values()
        rounding = eps[kind] * condition**power * reduce(np.maximum, values, np.zeros_like(condition))
        for channel in of_kind:
            explained = rounding * (units[channel] / sizes(true, mechanics.scene.channels[channel], scale[channel]))
            errors[channel] = np.where((errors[channel] <= explained) | np.isinf(condition), 0.0, errors[channel])
    if any(not error.max() <= promise for error in errors.values()):
        moved = projected_apart(mechanics, motion, true, scale, ends)
        # At a single sample the few draws of signs may all but cancel, where those beside it do not.
        errors = {c: np.where(error <= _of_three(moved[c]), 0.0, error) for c, error in errors.items()}
    return Estimate(errors, projection.branch, EPS * condition * far, closed)


def _of_three(values: Samples) -> Samples:
    """The largest of each sample and both beside it, shape (n,)."""
    before, after = np.append(values[:1], values[:-1]), np.append(values[1:], values[-1:])
    return np.asarray(np.fmax(np.fmax(before, values), after))


def _balances(
    mechanics: Mechanics, state: MotionVectors, travel: Mapping[str, float], estimated: Estimate, may: Sequence[Acts]
) -> Violations:
    """What forces and power leave over above rounding; on a press force's switch, on the side where it is less."""
    least: Violations = {}
    peaks_of_joints = {c: float(np.abs(state.motion[c]).max()) for c in mechanics.forces if mechanics.units[c] == "N"}
    fastest = max((float(np.abs(state.point(p)[1]).max()) for p in mechanics.scene.moving_points), default=0.0)
    drive, joints, inertia = drive_power(state), [*of_joints(state)], [*inertial(state)]

    def misfit(acting: Acting) -> tuple[Samples, Mapping[str, Samples]]:
        """The power left over, to which all sliders add; the rest, each of one body, is the least of any."""
        now, closed = (replace(state, acting=acting, motion=motion) for motion in (state.motion, estimated.closed))
        loads = [*applied(now)]
        left = _newton_euler(now, (*inertia, *joints, *loads))
        terms = [drive, *(power_of(now, push) for push in (*loads, *inertia))]
        peaks = _peaks(joints, loads, mechanics.size)
        carried = _peaks([*of_joints(closed)], [*applied(closed)], mechanics.size)
        # Relative to the peak force on the body, or on any where it carries nothing: if that is so in the motion's own
        # poses, what an engine finds there is its noise.
        nothing = NOTHING * min(max(carried.values()), max(peaks.values()))
        peak_forces = {name: 0.0 if carried[name] < nothing else peak for name, peak in peaks.items()}
        scale = force_scales(mechanics, state.motion, travel, peak_forces)
        natural = max(force_scales(mechanics, state.motion, travel, peaks_of_joints).values(), default=0.0) * fastest
        explained = estimated.rounding * max(scale.values())
        for (check, name, relative_to), residual in left.items():
            arm = 1.0 if check == "Newton" else mechanics.size
            share = np.where(residual <= explained * arm, 0.0, residual) / (scale[name] * arm)
            least[check, name, relative_to] = np.minimum(least.get((check, name, relative_to), np.inf), share)
        power = np.abs(sum(terms)) / (max(natural, *(float(np.abs(term).max()) for term in terms)) or 1.0)
        power = np.where(power <= estimated.rounding, 0.0, power)
        least[POWER] = np.minimum(least.get(POWER, np.inf), power)
        return power, {}

    fitted(mechanics.presses, may, misfit)
    return least


def _newton_euler(state: MotionVectors, pushes: Sequence[Push]) -> Violations:
    """What all that acts on each body, its inertia too, leaves over: N, and about the centre of mass N m."""
    left: Violations = {}
    for name, body in state.scene.bodies.items():
        # Newton: the sum of all forces, inertia among them; Euler: the sum of moments about the centre of mass, where
        # inertia has no lever.
        acting, com = [push for push in pushes if push.body == name], state.com(body)[0]
        moments = (((push.at - com).conjugate() * push.force).imag + push.moment for push in acting)
        left["Newton", name, "peak force on the body"] = np.abs(sum(push.force for push in acting))
        left["Euler", name, "peak force times the linkage's size"] = np.abs(sum(moments))
    return left


def _peaks(joints: Sequence[Push], loads: Sequence[Push], arm: float) -> dict[str, float]:
    """By body the peak of the forces on it, N, and of the moments of loads and springs, by an arm."""
    peaks: dict[str, float] = {}
    for push in (*joints, *loads):
        peaks[push.body] = max(peaks.get(push.body, 0.0), float(np.abs(push.force).max()))
    for push in loads:
        peaks[push.body] = max(peaks[push.body], float(np.abs(push.moment).max()) / arm)
    return peaks
