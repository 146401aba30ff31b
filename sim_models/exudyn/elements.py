"""What adds an element to an assembled Exudyn system: a rule for each type."""

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from math import ceil, pi, tau
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from scenes.bodies import GROUND
from scenes.elements.constant_force_springs import ConstantForceSpring
from scenes.elements.element import Element
from scenes.elements.loads import (
    Force,
    ForceTable,
    GuideForce,
    Load,
    Moment,
    PressForce,
    TabledLoad,
    TableForce,
    TurningForce,
)
from scenes.elements.springs import Damper, PointPair, Spring, TorsionSpring

if TYPE_CHECKING:  # which kinds there are rules for is asked without Exudyn too
    from .poses import Configuration
    from .system import ExudynSystem

LoadValue: TypeAlias = Callable[[Any, float], float]  # of the system, as it is then, and its clock
PressSwitches: TypeAlias = Mapping[str, Sequence[float]]  # by place in the file: s within a cycle, on and off in turn

HALF_TURN = pi + 1e-9  # rad: half a turn is that, whichever way it was rounded
SAME_INSTANT_TOL = 1e-10  # of a cycle; so close before a switch counts as after it, whichever way the clock was rounded


class Target(NamedTuple):
    """What elements are added to."""

    system: "ExudynSystem"
    switches: PressSwitches
    start: "Configuration"  # the state at time zero

    def loaded(self, value: LoadValue | None, *vector: float) -> dict[str, Any]:
        """The vector of a load, N or N m, constant or times a value, as Exudyn takes it."""
        parts = [part / self.system.force_unit for part in vector]
        return {"loadVector": parts} if value is None else {"loadVectorUserFunction": _scaled(parts, value)}

    def push(
        self, load: Load, vector: tuple[float, float], value: LoadValue | None = None, *, turns: bool = False
    ) -> None:
        """Add a force at the point of a load; one that turns is fixed to the body."""
        self.push_at(load.body, self.system.bodies[load.body].points[load.at], vector, value, turns=turns)

    def push_at(
        self, body: str, place: complex, vector: tuple[float, float], value: LoadValue | None, *, turns: bool
    ) -> None:
        """Add a force at a place of a body, from its centre of mass, m."""
        marker = self.system.marker(body, place, "Rigid" if turns else "Position")
        given = self.loaded(value, *vector, 0.0)
        self.system.mbs.AddLoad(self.system.items.Force(markerNumber=marker, bodyFixed=turns, **given))

    def turns(self, body: str) -> bool:
        """Whether a body can turn: else what would turn with it is added as it stands."""
        return body in self.system.scene.turning

    def between(self, pair: PointPair) -> dict[str, Any]:
        """The markers of two points."""
        return {"markerNumbers": [self.system.at(*end) for end in pair.ends]}


def _force(load: Force, _: str, to: Target) -> None:
    to.push(load, load.force)


def _turning_force(load: TurningForce, _: str, to: Target) -> None:
    to.push(load, load.force, turns=to.turns(load.body))


def _press(load: PressForce, place: str, to: Target) -> None:
    """Off until the first of the instants of a cycle, on until the second, and so on."""
    drive, scene, instants = to.system.driven_by, to.system.scene, to.switches[place]
    cycle, repeats = scene.cycle, scene.periodic

    def acts(_mbs: Any, clock: float) -> float:
        # The number of switches that are past: odd while the force acts.
        time = drive.zero + clock + SAME_INSTANT_TOL * cycle
        return float(bisect_right(instants, time % cycle if repeats else time) % 2)

    to.push(load, load.force, acts)


def _by_table(load: TableForce, _: str, to: Target) -> None:
    to.push(load, load.direction, _value(to.system, load), turns=to.turns(load.body) and load.frame == "body")


def _moment(load: Moment, _: str, to: Target) -> None:
    marker = to.system.marker(load.body, 0j, "Rigid")
    moment = to.loaded(_value(to.system, load), 0.0, 0.0, 1.0 if load.moment is None else load.moment)
    to.system.mbs.AddLoad(to.system.items.Torque(markerNumber=marker, **moment))


def _guide_force(load: GuideForce, _: str, to: Target) -> None:
    """Along a guide that turns it is fixed to the body; on the carrier the line on which both act stays where it is."""
    system, value, turns = to.system, _value(to.system, load), to.turns(load.body)
    # A force along a guide acts in line on the slider's point and on the carrier. Exudyn's loads are at fixed places of
    # a body: the carrier's is where the slider's point would be with the displacement zero. A shift along the line of
    # action changes no moment.
    slide, size = system.scene.slides[load.body], 1.0 if load.force is None else load.force
    x, y = (size * part for part in slide.along)
    to.push(load, (x, y), value, turns=turns)
    if slide.on != GROUND:
        point = system.through(load.body) + system.bodies[load.body].points[load.at] - system.lever(load.body)
        to.push_at(slide.on, point, (-x, -y), value, turns=turns)


def _spring(spring: Spring, _: str, to: Target) -> None:
    unit, damping = to.system.force_unit, spring.damping or 0.0
    values = {"stiffness": spring.stiffness / unit, "damping": damping / unit}
    to.system.mbs.AddObject(to.system.items.SpringDamper(**to.between(spring), **values, referenceLength=spring.length))


def _torsion_spring(spring: TorsionSpring, _: str, to: Target) -> None:
    system, bodies = to.system, (spring.first, spring.second)
    ends = {"markerNumbers": [system.angle_of(body) for body in bodies]}
    values = {"stiffness": spring.stiffness / system.force_unit, "damping": (spring.damping or 0.0) / system.force_unit}
    # Exudyn's coordinates count whole turns from the start on, the scene's spring angle is within half a turn there:
    # the difference, a whole number of turns, goes into the spring's offset.
    first, second = (system.pose_of(body, to.start.q)[1] for body in bodies)
    turns = 0 if spring.drives(system.scene) else ceil((second - first - HALF_TURN) / tau)  # else within half a turn
    offset = spring.angle + turns * tau
    system.mbs.AddObject(system.items.CoordinateSpringDamper(**ends, **values, offset=offset))


def _constant_force_spring(spring: ConstantForceSpring, _: str, to: Target) -> None:
    values = {"stiffness": 0.0, "damping": 0.0, "referenceLength": 0.0, "force": spring.force / to.system.force_unit}
    to.system.mbs.AddObject(to.system.items.SpringDamper(**to.between(spring), **values))


RULES: Mapping[type[Element], Callable[[Any, str, Target], None]] = {
    Force: _force,
    TurningForce: _turning_force,
    PressForce: _press,
    GuideForce: _guide_force,
    ForceTable: _guide_force,
    TableForce: _by_table,
    Moment: _moment,
    Spring: _spring,
    Damper: _spring,
    TorsionSpring: _torsion_spring,
    ConstantForceSpring: _constant_force_spring,
}


def _scaled(parts: Sequence[float], value: LoadValue) -> Callable[[Any, float, Any], list[float]]:
    def vector(mbs: Any, clock: float, _unused: Any) -> list[float]:
        size = value(mbs, clock)
        return [size * part for part in parts]

    return vector


def _value(system: "ExudynSystem", load: TabledLoad) -> LoadValue | None:
    """What a load's vector is to be multiplied by: the value of its table in the step at hand; None without one."""
    table, driven, drive = load.table, system.prescribed, system.driven_by
    if table is None:
        return None
    if table.over == "time":
        return lambda _, clock: float(table.at(drive.zero + clock))
    if table.over == "displacement" or driven.slide is not None:
        markers = [(system.gauge(load.body if table.over == "displacement" else driven.body), 1)]
    else:
        markers = [(system.angle_of(body), sign) for body, sign in ((driven.body, 1), (driven.on, -1))]
    read = system.coordinate_at
    return lambda mbs, _: float(table.at(sum(sign * read(mbs, marker) for marker, sign in markers)))
