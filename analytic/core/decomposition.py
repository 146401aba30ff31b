"""From the joint graph to a driver and Assur groups, in the order in which they can be solved.

A dyad, a group of class II, is two bodies, its legs, joined by an inner joint, each hung by an outer joint on what is
already placed. Its assembly branch is read once from the sketch and stays a number: nothing is remembered from one
position of the drive to the next. Where no dyad hangs on what is placed, the fewest bodies that do hold each other make
one larger group.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import combinations
from typing import TypeAlias

import numpy as np

from scenes import Failure, Scene, Status
from scenes.arguments import scene_of
from scenes.drive import Drive
from scenes.scene import GROUND

from .dyads import cross
from .geometry import RigidBody, as_complex, longest_arm, rigid_body, sketched_attitude
from .groups.continuation import Track
from .groups.group_equations import Group
from .groups.joints import KINDS, PinJoint
from .numbers import Number, Vector, chosen

FLAT = 1e-12  # sine; guides this near to parallel in the drawing are so by rounding


@dataclass(frozen=True)
class Pinned:
    """A leg that turns about the placed point A: one body, or two with the drive between them, that change its length.

    Of two, `via` is the one with A, and `body` the other one, which has the inner pin.
    """

    body: str
    A: str
    via: str | None = None
    drive: Drive | None = field(default=None, compare=False)  # between the two


@dataclass(frozen=True)
class Guided:
    """A leg that slides on the placed body `on`: its point F runs through G along t, both fixed in the frame of `on`.

    Either of the two may be the slider of the scene: the line through either's point has to pass through
    the other's, and the frames are parallel.
    """

    body: str
    on: str
    F: Vector  # m, in the frame of `body`
    G: Vector  # m, in the frame of `on`
    t: Vector  # unit, in both frames
    slider: str  # the one of the two that the channels are named by


Leg: TypeAlias = Pinned | Guided


@dataclass(frozen=True)
class InnerPin:
    """RRR, RRP or PRP: the legs meet at the pin P; a pinned leg comes first."""

    legs: tuple[Leg, Leg]
    P: str
    branch: Number  # RRR: of (B - A) x (P - A); RRP: of (P - A) . t; PRP: of t1 x t2


@dataclass(frozen=True)
class InnerSlide:
    """RPR or RPP: the second leg is pinned at A and the first one slides on it."""

    legs: tuple[Leg, Pinned]
    P: str  # the guide's slider, by which the dyad is named, see `_Placed.named`
    guide: Guided  # of the first leg on the second
    branch: Number  # RPR: of (A1 - A2) . t; RPP: of t1 x t2


Dyad: TypeAlias = InnerPin | InnerSlide


@dataclass(frozen=True)
class Linkage:
    """A linkage in solving order: the driver, then one Assur group after the other."""

    driver: Leg | None  # none where the drive is between moving bodies: a group holds it
    groups: tuple[Dyad | Group, ...]
    bodies: Mapping[str, RigidBody]
    carries: Mapping[str, tuple[str, ...]]  # by body: the moving points that are placed with it, each once
    arm: Number  # m, the longest
    drives: tuple[Drive, ...]
    tracks: Mapping[Group, Track] = field(default_factory=dict)  # of the larger groups that have been followed

    @property
    def drive(self) -> Drive:
        """The only drive, for what is a function of its position: tracks, ranges, dead points, assemblies."""
        (drive,) = self.drives
        return drive


def decompose(scene: Scene) -> Linkage:
    """Split a linkage into its driver and its Assur groups: dyads while there are any, in the order of the file."""
    bodies = {name: rigid_body(scene, body) for name, body in scene_of(scene).bodies.items()}
    placed = _Placed(scene, bodies)
    driver = None
    for name, drive in scene.driven.items():
        if drive.on == GROUND:
            driver = next(leg for leg in placed.outer(name) if isinstance(leg, Pinned) == (drive.slide is None))
            placed.add(name)
    groups: list[Dyad | Group] = []
    # Greedy, in solving order: placing a group never spoils another one, since more placed points only help what is
    # left.
    while left := [name for name in scene.bodies if name not in placed.carries]:
        group = next(_dyads(placed, left), None) or _fewest(placed, left)
        groups.append(group)
        for body in members(group):
            placed.add(body)
    return Linkage(driver, tuple(groups), bodies, placed.carries, longest_arm(scene, bodies), scene.drives)


def route(scene: Scene) -> str:
    """Return how a scene is solved: `closed form: crank, RRR, RRP` or `crank, RRR, Newton on one-plate-two-three`.

    Raises:
        Failure: `unsupported` when the sketch leaves a dyad's branch open, or when some bodies are held twice over.
    """
    kinds = [*map(kind, decompose(scene).groups)]  # first: it refuses what is no scene
    groups = ", ".join([*map(_driver, scene.drives), *kinds])
    return f"closed form: {groups}" if in_closed_form(scene) else groups


def _driver(drive: Drive) -> str:
    """Return what a route calls a drive."""
    turning, sliding = ("crank", "driven slider") if drive.on == GROUND else ("driven elbow", "driven cylinder")
    return turning if drive.slide is None else sliding


def in_closed_form(scene: Scene) -> bool:
    """Return whether a scene is solved without iterations, as its groups are dyads alone, or raise as `route` does."""
    return not any(isinstance(group, Group) for group in decompose(scene).groups)


def kind(group: Dyad | Group) -> str:
    """Return the joints of a dyad, outer, inner, outer: `RRP`; or the bodies of a larger group."""
    if isinstance(group, Group):
        return f"Newton on {'-'.join(group.bodies)}"
    first, second = ("R" if isinstance(leg, Pinned) else "P" for leg in group.legs)
    return f"{first}R{second}" if isinstance(group, InnerPin) else f"{second}P{first}"


def guides_cross(group: Dyad | Group) -> bool:
    """Return whether a group is a dyad that is singular where two guides are parallel."""
    return kind(group) in ("PRP", "RPP")


def members(group: Dyad | Group) -> tuple[str, ...]:
    """Return the bodies in the order in which they are placed; the inner pin goes with the first, a slider if any."""
    if isinstance(group, Group):
        return group.bodies
    legs = sorted(group.legs, key=lambda leg: isinstance(leg, Pinned))
    return tuple(body for leg in legs for body in (isinstance(leg, Pinned) and leg.via, leg.body) if body)


class _Placed:
    """What is placed so far: bodies, the ground among them, and their points."""

    def __init__(self, scene: Scene, bodies: Mapping[str, RigidBody]) -> None:
        self.scene, self.bodies, self.at = scene, bodies, scene.drawn
        self.points = set(scene.ground)
        self.carries: dict[str, tuple[str, ...]] = {}

    def add(self, name: str) -> None:
        self.carries[name] = tuple(point for point in self.scene.bodies[name].points if point not in self.points)
        self.points.update(self.carries[name])

    def outer(self, name: str) -> list[Leg]:
        """Return the joints by which a body hangs on what is placed."""
        pins: list[Leg] = [Pinned(name, point) for point in self.scene.bodies[name].points if point in self.points]
        slides = (self.guided(name, other) for other in (GROUND, *self.carries))
        return pins + [guided for guided in slides if guided is not None]

    def guided(self, name: str, other: str) -> Guided | None:
        """Return the slide between two bodies, the second of which may be the ground."""
        for slider, on in ((name, other), (other, name)):
            slide = None if slider == GROUND else self.scene.bodies[slider].slide
            if slide is not None and slide.on == on:
                foot, through = self.bodies[slider].first, as_complex(slide.through)
                F, G = (foot, through) if slider == name else (through, foot)
                return Guided(name, other, F, G, as_complex(slide.along), slider)
        return None

    def named(self, body: str, other: str) -> str:
        """Return the name of a group by two bodies of its own: the first one's, or both where a point has that name.

        Groups are named by inner pins too. A point may be called as a body is, and no name has a slash.
        """
        return f"{body}/{other}" if body in self.scene.owners else body

    def direction(self, leg: Guided) -> Vector:
        """Return the direction of a guide in the sketch."""
        return sketched_attitude(self.scene, leg.body, self.bodies) * leg.t


def _dyads(placed: _Placed, left: list[str]) -> Iterator[Dyad]:
    """Yield the dyads among the bodies left that hang on what is placed by one outer joint each."""
    scene = placed.scene
    between = [(drive, drive.on, drive.body) for drive in scene.drives]
    driven = {name for _, *both in between for name in both}
    legs = {name: outer[0] for name in left if len(outer := placed.outer(name)) == 1 and name not in driven}
    for drive, first, second in between:
        for via, body in ((first, second), (second, first)) if {first, second} <= {*left} else ():
            match placed.outer(via), placed.outer(body):
                # Two bodies with the drive between them, of which one is pinned to what is placed and the other to
                # nothing, are one leg whose length or bend the drive changes.
                case [Pinned(_, A)], []:
                    legs[body] = Pinned(body, A, via, drive)
    for P, owners in scene.owners.items():
        for first, second in combinations(owners, 2):
            if P not in placed.points and first in legs and second in legs:
                yield _inner_pin(placed, P, legs[first], legs[second])
    # The slide between two legs is the inner joint: one of them, pinned, carries the guide or the slider of the other.
    for pair in combinations(legs, 2):
        for first, second in (pair, pair[::-1]):
            inner, pinned = placed.guided(first, second), legs[second]
            if inner is not None and isinstance(pinned, Pinned) and not {first, second} & driven:
                yield _inner_slide(placed, legs[first], pinned, inner)


def _inner_pin(placed: _Placed, P: str, one: Leg, two: Leg) -> InnerPin:
    at = placed.at
    if isinstance(one, Guided):
        if isinstance(two, Guided):
            return InnerPin((one, two), P, _crossing(placed, one, two))
        one, two = two, one
    if isinstance(two, Pinned):
        side = cross(at[two.A] - at[one.A], at[P] - at[one.A])
        return InnerPin((one, two), P, _sign(side, f"{P} lies on the line {one.A}-{two.A}"))
    ahead = ((at[P] - at[one.A]) * placed.direction(two).conjugate()).real
    return InnerPin((one, two), P, _sign(ahead, f"{one.A}-{P} is square to the guide of {two.slider}"))


def _inner_slide(placed: _Placed, one: Leg, two: Pinned, guide: Guided) -> InnerSlide:
    name = placed.named(guide.slider, guide.on if guide.slider == guide.body else guide.body)
    if isinstance(one, Guided):
        return InnerSlide((one, two), name, guide, _crossing(placed, one, guide))
    ahead = ((placed.at[one.A] - placed.at[two.A]) * placed.direction(guide).conjugate()).real
    branch = _sign(ahead, f"{one.A}-{two.A} is square to the guide of {guide.slider}")
    return InnerSlide((one, two), name, guide, branch)


def _crossing(placed: _Placed, one: Guided, two: Guided) -> Number:
    crossing = cross(placed.direction(one), placed.direction(two))
    why_not = f"the guides of {one.slider} and {two.slider} are parallel"
    return _sign(chosen(abs(crossing) > FLAT, crossing, 0.0), why_not)


def _sign(value: Number, why_not: str) -> Number:
    """Return the sign of a value; of a recorded one, zero where it is."""
    if np.ndim(value):
        return np.sign(value)
    if value == 0:
        raise Failure(Status.unsupported, f"the sketch leaves the assembly branch open: {why_not}")
    return 1 if value > 0 else -1


def _fewest(placed: _Placed, left: list[str]) -> Group:
    """Return the fewest of the bodies left that hang on what is placed without a freedom of their own."""
    # By Gruebler's count: three a body, less two for each pin and each slide, and one for a drive. All left has none.
    # Subsets in the order of their size: the cost is exponential in the number of bodies left, of which linkages with
    # larger groups have few.
    subsets = (bodies for size in range(1, len(left) + 1) for bodies in combinations(left, size))
    groups = (larger_group(placed, bodies) for bodies in subsets)
    group = next(group for group in groups if _held(group) >= 0)
    if _held(group) > 0 or not group.hangs_on:
        from scenes.file.freedoms import loose_bodies  # late: only a linkage that is refused needs it

        loose = ", ".join(loose_bodies(placed.scene))
        others = f", and {loose} can move while the drive is held" if loose else ""
        raise Failure(Status.unsupported, f"more joints than freedoms hold {', '.join(group.bodies)}{others}")
    return group


def _held(group: Group) -> int:
    """The constraints of a group in excess of its degrees of freedom; zero of an Assur group."""
    return len(group.parts) - 3 * len(group.bodies)


def larger_group(placed: _Placed, bodies: tuple[str, ...]) -> Group:
    """Join bodies that are to be solved together: to each other, and to what is placed."""
    known = frozenset((GROUND, *placed.carries))
    joints = tuple(joint for kind in KINDS for joint in kind.among(placed.scene, bodies, known))
    inner = next((joint.point for joint in joints if isinstance(joint, PinJoint) and joint.on is not None), None)
    return Group(bodies, joints, inner or placed.named(bodies[0], bodies[-1]))
