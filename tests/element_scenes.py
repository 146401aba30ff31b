"""Scenes drawn at random with loads, springs, dampers and drives of every kind, on `linkage_scenes`."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from hypothesis import strategies as st

from scenes import Scene
from scenes.bodies import GROUND
from scenes.elements.loads import TurningForce
from scenes.elements.springs import Damper
from scenes.elements.tables import COLUMN, LoadCurve, Over
from scenes.scene import (
    Friction,
    GuideForce,
    GuideFriction,
    Load,
    Moment,
    Pin,
    PinFriction,
    Spring,
    TableForce,
    TorsionSpring,
)

from .linkage_scenes import scene_of
from .linkages import directions, numbers, signs, vectors, xy
from .moving_drives import moving_drawings

DISPLACEMENTS = (-1.0, 0.1, 1.5)  # m
ENTRIES = (-0.1, 0.4, 0.7)  # of the drive's range, or of the time of a cycle


@st.composite
def element_scenes(draw: st.DrawFn, first: str, kind: str) -> Scene:
    """Draw a linkage with a drive of a kind, a dyad of a kind, and elements on it."""
    scene, _ = scene_of(draw, draw(moving_drawings(first, kind)))
    loads = [draw(st.sampled_from(_loads(scene)))(draw) for _ in range(draw(st.integers(1, 3)))]
    springs = tuple(_spring(draw, spring) for spring in scene.springs)
    springs = tuple(spring for spring in springs if spring.stiffness or spring.damping is not None)
    torsion = tuple(_torsion_springs(draw, scene))
    scene = replace(scene, loads=(*scene.loads, *loads), springs=springs, torsion_springs=torsion)
    return replace(scene, friction=tuple(_friction(draw, scene)))


def _spring(draw: st.DrawFn, like: Spring) -> Spring:
    """Draw a spring or a damper between the ends of another."""
    damping, stiffness = draw(st.none() | numbers(0.1, 3)), draw(st.just(0.0) | numbers(1, 20))
    given = like.first, like.second, stiffness, like.length
    return Spring(*given) if damping is None else Damper(*given, damping)


def _loads(scene: Scene) -> list[Callable[[st.DrawFn], Load]]:
    """What draws a load of each kind that the scene has a body for."""
    places = [(name, point) for name, body in scene.bodies.items() for point in body.points]
    sliding = [place for place in places if place[0] in scene.slides]
    turning = [(name, scene.bodies[name].points[0]) for name in scene.turning if name not in scene.slides]

    def place(draw: st.DrawFn, of: list[tuple[str, str]]) -> tuple[str, str]:
        return draw(st.sampled_from(of))

    def turned(draw: st.DrawFn) -> Load:
        return TurningForce(*place(draw, places), xy(draw(vectors(20))))

    def tabled(draw: st.DrawFn) -> Load:
        body, at = place(draw, places)
        table = _table(draw, scene, "forces", slides=body in scene.slides)
        frame: Any = draw(st.sampled_from(("ground", "body")))
        return TableForce(body, at, xy(draw(directions())), table, frame)

    def along(draw: st.DrawFn) -> Load:
        body, at = place(draw, sliding)
        if draw(st.booleans()):
            return GuideForce(body, at, draw(numbers(-20, 20)))
        return GuideForce(body, at, None, _table(draw, scene, "forces", slides=scene.slides[body].on != GROUND))

    def moment(draw: st.DrawFn) -> Load:
        if turning and draw(signs) > 0:
            return Moment(*place(draw, turning), None, _table(draw, scene, "moments", slides=False))
        return Moment(*place(draw, places), draw(numbers(-20, 20)))

    return [turned, tabled, moment, *([along] if sliding else [])]


def _table(draw: st.DrawFn, scene: Scene, values: str, *, slides: bool) -> LoadCurve:
    """A table over the drive, the time, or of a slider its displacement, periodic or not."""
    kinds: tuple[Over, ...] = ("drive", "time", "displacement") if slides else ("drive", "time")
    over, periodic = draw(st.sampled_from(kinds)), draw(st.booleans())
    low, high = scene.drive.law.extent if over == "drive" else (0.0, scene.cycle)
    arguments = DISPLACEMENTS if over == "displacement" else tuple(float(low + x * (high - low)) for x in ENTRIES)
    sizes = [draw(numbers(-20, 20)) for _ in arguments]
    if periodic:
        sizes[-1] = sizes[0]
    return LoadCurve(**{COLUMN[over]: arguments, values: tuple(sizes)}, periodic=periodic)


def _torsion_springs(draw: st.DrawFn, scene: Scene) -> Iterator[TorsionSpring]:
    pins = [(pin.point, *ends) for pin in scene.pins for ends in ((pin.first, pin.second), (pin.second, pin.first))]
    for _ in range(draw(st.integers(0, 2))):
        damping = draw(st.none() | numbers(0.1, 2))
        stiffness = draw(numbers(1, 20)) if damping is None else draw(st.just(0.0) | numbers(1, 20))
        yield TorsionSpring(*draw(st.sampled_from(pins)), stiffness, draw(numbers(-4, 4)), damping)


def _friction(draw: st.DrawFn, scene: Scene) -> Iterator[Friction]:
    """Yield friction of some joints, at times so much that it jams: pins and contacts of some percent of the crank."""
    most = draw(st.sampled_from((0.4, 0.4, 0.4, 1.2)))
    joints: list[Pin | str] = [pin for pin in scene.pins if {pin.first, pin.second} & {*scene.turning}]  # others rest
    for joint in (*joints, *scene.slides):
        if draw(st.booleans()):
            viscous = draw(st.none() | numbers(0.1, 2))
            smooth = draw(st.sampled_from((None, None, None, 0.5)))
            more: dict[str, Any] = {"coefficient": draw(numbers(0.02, most)), "viscous": viscous, "smooth": smooth}
            if isinstance(joint, str):
                yield GuideFriction(slider=joint, length=draw(numbers(0.1, 0.8)), **more)
            else:
                yield PinFriction(at=joint.point, body=joint.second, radius=draw(numbers(0.01, 0.08)), **more)
