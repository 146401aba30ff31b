"""From the joint graph to a driver and Assur groups, in the order in which they can be solved.

A dyad, a group of class II, is two bodies joined by an inner joint, each hung by an outer joint on what is already
placed. Its assembly branch is read once from the sketch and stays a number: nothing is remembered from one crank angle
to the next. Where no dyad hangs on what is placed, the fewest bodies that do hold each other make one larger group.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import combinations

from scenes import Failure, Scene, Status

from .continuation import Track
from .geometry import RigidBody, as_complex, cross, rigid_body, sketched
from .newton_group import Group, Joint


@dataclass(frozen=True)
class Crank:
    """The driver: `body` turns about the ground point `pivot`."""

    body: str
    pivot: str


@dataclass(frozen=True)
class RRR:
    """Two bars: `body_1` from A to P, `body_2` from B to P; `branch` is the sign of (B - A) x (P - A)."""

    body_1: str
    A: str
    body_2: str
    B: str
    P: str
    branch: int


@dataclass(frozen=True)
class RRP:
    """A bar from A to P and a slider pinned to it at P; `branch` is the sign of (P - A) . t.

    The guide's line, through `through` along the unit vector `t`, is where the slider's point `first` runs.
    """

    bar: str
    A: str
    slider: str
    P: str
    first: str
    through: complex
    t: complex
    branch: int


Dyad = RRR | RRP


@dataclass(frozen=True)
class Decomposition:
    """A linkage in solving order: the crank, then one Assur group after the other."""

    crank: Crank
    groups: tuple[Dyad | Group, ...]
    bodies: Mapping[str, RigidBody]
    carries: Mapping[str, tuple[str, ...]]  # by body: the moving points that are placed with it, each once
    tracks: dict[Group, Track] = field(default_factory=dict)  # of the larger groups, each followed when first needed


def decompose(scene: Scene) -> Decomposition:
    """Split a linkage into its crank and its Assur groups: dyads as long as there are any, in the order of the file.

    Raises:
        Failure: `unsupported` when the sketch leaves a dyad's branch open, or when some bodies are held twice over.
    """
    driven = scene.bodies[scene.drive.body]
    crank = Crank(driven.name, next(point for point in driven.points if point in scene.ground))
    placed = set(scene.ground)
    carries: dict[str, tuple[str, ...]] = {}

    def place(body: str) -> None:
        carries[body] = tuple(point for point in scene.bodies[body].points if point not in placed)
        placed.update(carries[body])

    place(driven.name)
    groups: list[Dyad | Group] = []
    while left := [name for name in scene.bodies if name not in carries]:
        group = next(_dyads(scene, left, placed), None) or larger_group(scene, _fewest(scene, left, placed), placed)
        groups.append(group)
        for body in _members(group):
            place(body)
    bodies = {name: rigid_body(scene, body) for name, body in scene.bodies.items()}
    return Decomposition(crank, tuple(groups), bodies, carries)


def route(scene: Scene) -> str:
    """Return how a scene is solved: `closed form: crank, RRR, RRP` or `crank, RRR, Newton on one-plate-two-three`.

    Raises:
        Failure: `unsupported` when the sketch leaves a dyad's branch open, or when some bodies are held twice over.
    """
    groups = decompose(scene).groups
    said = [f"Newton on {'-'.join(g.bodies)}" if isinstance(g, Group) else type(g).__name__ for g in groups]
    closed_form = not any(isinstance(group, Group) for group in groups)
    return ("closed form: " if closed_form else "") + ", ".join(["crank", *said])


def _members(group: Dyad | Group) -> tuple[str, ...]:
    """Return the bodies in the order in which they are placed."""
    if isinstance(group, Group):
        return group.bodies
    return (group.body_1, group.body_2) if isinstance(group, RRR) else (group.slider, group.bar)


def _fewest(scene: Scene, left: list[str], placed: set[str]) -> tuple[str, ...]:
    """Return the fewest of the bodies left that hang on the placed points without a freedom of their own.

    All that is left has none, by Gruebler's count of the whole linkage.
    """
    subsets = (bodies for size in range(1, len(left) + 1) for bodies in combinations(left, size))
    bodies = next(bodies for bodies in subsets if _freedoms(scene, bodies, placed) <= 0)
    if _freedoms(scene, bodies, placed) < 0:
        raise Failure(Status.unsupported, f"{', '.join(bodies)} are held by more joints than they have freedoms")
    return bodies


def _freedoms(scene: Scene, bodies: tuple[str, ...], placed: set[str]) -> int:
    """Return Gruebler's count: three a body, less two for each pin and each slide."""
    slides = sum(scene.bodies[name].slide is not None for name in bodies)
    return 3 * len(bodies) - 2 * len(_joints(scene, bodies, placed)) - 2 * slides


def larger_group(scene: Scene, bodies: tuple[str, ...], placed: set[str]) -> Group:
    """Join bodies that are to be solved together, given the points that are placed already."""
    joints = _joints(scene, bodies, placed)
    return Group(bodies, joints, next(joint.point for joint in joints if joint.on is not None))


def _joints(scene: Scene, bodies: tuple[str, ...], placed: set[str]) -> tuple[Joint, ...]:
    """Return the bodies' pins: each on a placed point, or else on the first of the bodies that names the point."""
    first: dict[str, str | None] = dict.fromkeys(placed)
    joints = []
    for body in bodies:
        for point in scene.bodies[body].points:
            if point in first:
                joints.append(Joint(point, body, first[point]))
            first.setdefault(point, body)
    return tuple(joints)


def _dyads(scene: Scene, left: list[str], placed: set[str]) -> Iterator[Dyad]:
    """Yield the dyads among the bodies left that hang on the placed points by one outer joint each."""
    outer = {name: [p for p in scene.bodies[name].points if p in placed] for name in left}
    joined = [(P, *pair) for P, owners in scene.owners.items() for pair in combinations(owners, 2) if P not in placed]
    for P, first, second in joined:
        if first not in outer or second not in outer:
            continue
        slides = [name for name in (first, second) if scene.bodies[name].slide is not None]
        if not slides and len(outer[first]) == len(outer[second]) == 1:
            yield _rrr(scene, first, outer[first][0], second, outer[second][0], P)
        if len(slides) == 1:
            slider, bar = (first, second) if first in slides else (second, first)
            if len(outer[bar]) == 1 and not outer[slider]:
                yield _rrp(scene, bar, outer[bar][0], slider, P)


def _rrr(scene: Scene, body_1: str, A: str, body_2: str, B: str, P: str) -> RRR:
    at = sketched(scene)
    side = cross(at[B] - at[A], at[P] - at[A])
    return RRR(body_1, A, body_2, B, P, _sign(side, f"{P} lies on the line {A}-{B}"))


def _rrp(scene: Scene, bar: str, A: str, slider: str, P: str) -> RRP:
    slide = scene.bodies[slider].slide
    assert slide is not None
    at = sketched(scene)
    ahead = ((at[P] - at[A]) * as_complex(slide.along).conjugate()).real
    branch = _sign(ahead, f"{A}-{P} is square to the guide of {slider}")
    first = scene.bodies[slider].points[0]
    return RRP(bar, A, slider, P, first, as_complex(slide.through), as_complex(slide.along), branch)


def _sign(value: float, why_not: str) -> int:
    if value == 0:
        raise Failure(Status.unsupported, f"the sketch leaves the assembly branch open: {why_not}")
    return 1 if value > 0 else -1
