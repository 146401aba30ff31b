"""From the joint graph to a driver and Assur groups of class II, in the order in which they can be solved.

A dyad is two bodies joined by an inner joint, each hung by an outer joint on what is already placed. Its assembly
branch is read once from the sketch and stays a number: nothing is remembered from one crank angle to the next.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

from scenes import Failure, Scene, Status

from .geometry import RigidBody, as_complex, cross, rigid_body, sketched


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
    """A linkage in solving order: the crank, then one dyad after the other."""

    crank: Crank
    dyads: tuple[Dyad, ...]
    bodies: Mapping[str, RigidBody]
    carries: Mapping[str, tuple[str, ...]]  # by body: the moving points that are placed with it, each once


def decompose(scene: Scene) -> Decomposition:
    """Split a linkage into its crank and its dyads.

    Raises:
        Failure: `unsupported` when what is left holds no RRR or RRP dyad, or when the sketch leaves a branch open.
    """
    driven = scene.bodies[scene.drive.body]
    crank = Crank(driven.name, next(point for point in driven.points if point in scene.ground))
    placed = set(scene.ground)
    carries: dict[str, tuple[str, ...]] = {}

    def place(body: str) -> None:
        carries[body] = tuple(point for point in scene.bodies[body].points if point not in placed)
        placed.update(carries[body])

    place(driven.name)
    dyads: list[Dyad] = []
    while left := [name for name in scene.bodies if name not in carries]:
        dyad = next(_dyads(scene, left, placed), None)
        if dyad is None:
            raise Failure(
                Status.unsupported,
                f"the bodies {', '.join(left)} hold no dyad of pins, or of pins and a slide, that hangs on the others",
            )
        dyads.append(dyad)
        for body in (dyad.body_1, dyad.body_2) if isinstance(dyad, RRR) else (dyad.slider, dyad.bar):
            place(body)
    bodies = {name: rigid_body(scene, body) for name, body in scene.bodies.items()}
    return Decomposition(crank, tuple(dyads), bodies, carries)


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
