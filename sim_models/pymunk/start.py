"""A consistent start for pymunk: the pose on the sketch's branch, by continuation, and where the drive takes it.

pymunk closes open joints by itself, but on any branch nearby. Hence the sketch's gaps are closed and the drive is moved
in small steps, each corrected by Newton's method; no step may change the branch.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from itertools import product
from math import radians, sqrt
from typing import TypeAlias

import numpy as np

from scenes import Failure, ProcessorBudget, Scene, Status
from scenes.model.constraints import joint_rows, misfit
from scenes.model.motion import Samples
from scenes.scene import GROUND

from .constraints import LinkageConstraints
from .masses import Masses, fictitious_masses
from .planes import ComplexArray, PoseArray

MAX_TURN = radians(5.0)  # of the crank in one continuation step; of a driven slider, by the linkage's size
MAX_PART = 1 / 72  # of the drive's range in one continuation step, or of a longer way to it
MAX_CLOSING = 0.1  # of the sketch's gaps in one continuation step
MIN_STEP = 1e-6  # of a whole path; a linkage that needs smaller ones is singular
MAX_NEWTON_STEPS = 6  # near a solution 3 or 4 are enough; more means a jump to another one
MAX_PATIENT_NEWTON_STEPS = 60  # nearly singular, it gains one bit per step
SECONDS = 10.0  # of processor time on one path, half of what an engine's process has; the shipped scenes take 0.03
TRIALS = 9  # places within a step, from where there is no next one, to find one where the bodies stay apart
MIN_PUSH = 1e-3  # of the linkage's size: a cylinder's displacement where the sketch has its pins too close
CLOSED_TOL = 1e-12  # largest constraint residual, by the linkage's size; well above round-off
MAX_SCENES = 6  # whose starts are kept; one that is run has up to three, by the masses

DrivePlace: TypeAlias = tuple[float, PoseArray]  # a position of the drive, rad or m, and the pose there
Gaps: TypeAlias = Samples | float  # what the constraints are to be, shape (3 bodies,)
Shown: TypeAlias = Mapping[str, ComplexArray]  # by body the arms and places of its points in the sketch, (2, points)


@lru_cache(MAX_SCENES)
def begun(scene: Scene, masses: Masses) -> tuple[LinkageConstraints, PoseArray]:
    """The linkage with those masses, and its pose at the drive's start, shape (1, bodies, 3); once a scene."""
    linkage = LinkageConstraints(scene, masses)
    return linkage, start(linkage)


def start(linkage: LinkageConstraints) -> PoseArray:
    """The pose at the drive's start, on the sketch's branch, shape (1, bodies, 3)."""
    position = linkage.drive.in_range(linkage.scene.sketch.drive)
    q = _sketch(linkage, position)
    # Homotopy: the sketch satisfies C(q) = gaps exactly; the right-hand side is brought to zero in steps, so that the
    # pose moves continuously from the sketch and no step may jump to another assembly.
    gaps = linkage.gaps(q, np.array([position]))
    *_, (_, q) = _follow(linkage, q, lambda s: (position, (1 - s) * gaps), MAX_CLOSING)
    return move(linkage, q, position, linkage.drive.law.start)


def move(linkage: LinkageConstraints, q: PoseArray, here: float, there: float) -> PoseArray:
    """The pose q, shape (1, bodies, 3), carried along from one position of the drive to another, rad or m."""
    *_, (_, q) = way(linkage, q, here, there)
    return q


def rates(linkage: LinkageConstraints, q: PoseArray, drive_rate: float) -> PoseArray:
    """Return dq/dt on the constraints, shape (1, bodies, 3)."""
    prescribed = np.zeros(q.size)
    prescribed[-1] = drive_rate
    return np.linalg.solve(linkage.jacobian(q)[0], prescribed).reshape(q.shape)


def _sketch(linkage: LinkageConstraints, position: float) -> PoseArray:
    """Lay every body on the sketch as well as it fits, shape (1, bodies, 3); the joints are open."""
    drawn = linkage.scene.drawn
    shown = {
        name: np.array([(arm, drawn[point]) for point, arm in member.points.items() if point in drawn]).reshape(-1, 2).T
        for name, member in linkage.members.items()
    }
    q = np.zeros((1, len(shown), 3))
    angles = _angles(linkage, shown, position)
    for pose, (name, (arms, places)) in zip(q[0], shown.items(), strict=True):
        pose[2] = angles[linkage.scene.aligned[name]]
        if len(arms):  # else it is only on guides, which are met from anywhere
            z = (places - arms * np.exp(1j * pose[2])).mean()
            pose[:2] = z.real, z.imag
    return q


def _angles(linkage: LinkageConstraints, shown: Shown, position: float) -> dict[frozenset[str], float]:
    """The angles of the bodies that slides keep parallel: as sketched, but a crank is turned from what it is driven on.

    A common angle of bodies fits the arms a of their points p best where sum conj(a) p is real, both less their means.
    """
    scene = linkage.scene
    ground, carrier, driven = (scene.aligned[name] for name in (GROUND, linkage.drive.on, linkage.drive.body))
    angles = {ground: 0.0}
    for group in {*scene.aligned.values()} - {ground}:
        fits = (np.vdot(a - a.mean(), p - p.mean()) for a, p in (shown[name] for name in sorted(group)) if len(a))
        if fit := sum(fits) or _fit_of_pairs(linkage, group, shown, position):
            angles[group] = float(np.angle(fit))
    if linkage.drive.slide is None:
        angles[driven] = angles.setdefault(carrier, angles.get(driven, position) - position) + position
    return dict.fromkeys(scene.aligned.values(), 0.0) | angles


def _fit_of_pairs(linkage: LinkageConstraints, group: frozenset[str], shown: Shown, position: float) -> complex:
    """How a carrier and its slider are turned by one point of each, as a complex number of that angle; 0 if unknown.

    Of a slider that is not driven the displacement is the positive one with which they are as far apart as shown.
    """
    for name in sorted(group & linkage.slides.keys()):
        along, carrier = complex(*linkage.slides[name].along), linkage.slides[name].on
        for (a, A), (b, B) in product(shown[carrier].T, shown[name].T):
            apart = linkage.through(name) + b - linkage.first_arm(name) - a  # in the carrier's frame, at zero
            # In the carrier's frame the vector between two points is `before` + s along the guide and `across` beside
            # it: by their distance in the sketch s follows up to a sign, and the positive one is taken.
            across, before = (along.conjugate() * apart).imag, (along.conjugate() * apart).real
            further = max(sqrt(max(abs(B - A) ** 2 - across**2, 0.0)) - before, MIN_PUSH * linkage.size)
            if B != A:
                s = position if name == linkage.drive.body else further
                return complex((B - A) * (apart + s * along).conjugate())
    return 0j


@lru_cache(MAX_SCENES)
def obstacle(scene: Scene) -> tuple[Status, str] | None:
    """What the pose at the drive's start meets on its way through the whole range, once a scene."""
    linkage, q = begun(scene, fictitious_masses)  # whatever the masses, the way is the same
    try:
        for end in linkage.drive.law.extent:
            move(linkage, q, linkage.drive.law.start, end)
    except Failure as failure:
        return failure.status, failure.reason
    return None


def assembles(linkage: LinkageConstraints, q: PoseArray, positions: Samples) -> bool:
    """Tell whether n poses are near ones that close all joints, and those nearest the drive's ends near ones there."""
    ends = np.array(linkage.drive.law.extent)  # rad or m, as the positions, shape (n,)
    nearest = np.abs(positions[:, None] - ends).argmin(axis=0)
    q, positions = np.concatenate([q, q[nearest]]), np.concatenate([positions, ends])
    return _newton(linkage, q, positions) is not None


def closed(linkage: LinkageConstraints, q: PoseArray) -> PoseArray:
    """The poses near n poses that close all joints, the drive where it is; as they are if any has none."""
    found = _newton(linkage, q, linkage.drive_position(q))
    return q if found is None else found


def way(linkage: LinkageConstraints, q: PoseArray, here: float, there: float) -> Iterator[DrivePlace]:
    """Yield the places on the way from one position of the drive, where the pose is q, to another."""
    low, high = linkage.drive.law.extent
    unit = 1.0 if linkage.drive.slide is None else linkage.size
    step = min(MAX_TURN * unit, MAX_PART * max(high - low, abs(there - here)))
    return _follow(linkage, q, lambda s: (here + s * (there - here), 0.0), step / max(abs(there - here), step))


# Continuation with Newton's method as the corrector: a step that has no solution, or one on another branch, is halved,
# and the next one after a good step is twice as long, up to the largest. It fails where a step would be shorter than
# `MIN_STEP` (`_stuck` finds out why), or when its processor time is used up.
def _follow(
    linkage: LinkageConstraints, q: PoseArray, path: Callable[[float], tuple[float, Gaps]], largest: float
) -> Iterator[DrivePlace]:
    """Yield the places, the last at s = 1, that solve C(q) = gaps on a path s -> (position, gaps), 0 <= s <= 1."""
    here = linkage.branch(q)
    budget = ProcessorBudget(SECONDS, f"the way to {linkage.scene.where(path(1.0)[0])}")
    s, step = 0.0, largest
    while s < 1:
        ahead = min(1.0, s + step)
        position, gaps = path(ahead)
        budget.check(f"{s:.2%} of it is done, in steps of {step:.1e} of it")
        pose = _newton(linkage, q, np.array([position]), gaps)
        if pose is not None and linkage.branch(pose) == here:
            q, s, step = pose, ahead, min(largest, 2 * step)
            yield position, q
        elif step > MIN_STEP:
            step /= 2
        else:
            raise _stuck(linkage, q, position, gaps, path(min(1.0, s + largest))[0])


def _stuck(linkage: LinkageConstraints, q: PoseArray, position: float, gaps: Gaps, ahead: float) -> Failure:
    """Tell why there is no next place: none exists, or two are too close together; `ahead` is a step further."""
    scene, where = linkage.scene, linkage.scene.where(position)
    if _newton(linkage, q, np.array([position]), gaps, MAX_PATIENT_NEWTON_STEPS) is None:
        units, joints = np.tile([linkage.size, linkage.size, 1.0], q.shape[1]), joint_rows(scene.joints)
        open_by = misfit(
            scene,
            np.linspace(position, ahead, TRIALS)[1:],
            lambda position, pose: linkage.gaps(pose.reshape(q.shape), np.array([position]))[0],
            lambda pose: linkage.jacobian(pose.reshape(q.shape))[0],
            *(q.ravel(), units, joints, linkage.size),
        )
        return Failure(Status.cannot_assemble, f"the bodies cannot be put together at {where}{open_by}")
    return Failure(Status.not_converged, f"two ways to put the bodies together are too close to distinguish at {where}")


def _newton(
    linkage: LinkageConstraints, q: PoseArray, positions: Samples, gaps: Gaps = 0.0, steps: int = MAX_NEWTON_STEPS
) -> PoseArray | None:
    """The solutions of C(q) = gaps near n poses q, shape (n, bodies, 3), or None if any has none."""
    for _ in range(steps):
        excess = linkage.gaps(q, positions) - gaps
        if np.abs(excess).max() <= CLOSED_TOL * linkage.size:
            return q
        try:
            q = q - np.linalg.solve(linkage.jacobian(q), excess[..., None]).reshape(q.shape)
        except np.linalg.LinAlgError:
            return None
    return None
