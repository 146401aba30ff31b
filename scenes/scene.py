"""The scene: everything the models share about a mechanism, in SI, and nothing they could share by mistake.

A scene holds what was written in its file: lengths, points, masses, joints by shared point names. It has no pose, no
branch solver and no derived lengths; each model works those out by its own means, because a mistake shared by two
models is one the comparison cannot see. What a body as drawn weighs has a second rule in the 50-digit model.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, make_dataclass, replace
from functools import cached_property
from math import pi, sqrt
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, Union

from pydantic import Field

from . import limits
from .bodies import GROUND, Body, DrawnBody, Slide
from .channels import Channels
from .drive import ConstantSpeed, Drive, DriveLaw, HarmonicLaw, MotionLaw, SegmentedLaw
from .elements import LISTS
from .elements.element import Element
from .elements.friction import Friction, GuideFriction, PinFriction
from .elements.loads import Force, GuideForce, Load, Moment, PressForce, TableForce
from .elements.springs import Spring, TorsionSpring
from .fields import FileTable, Finite, Gravity, Number, Place, Position, Positive, Vector, put, walk
from .joints import Guide, Joint, Pin, SlidingDrive, TurningDrive
from .quantities import DIMENSIONS
from .units import SI, units_of_all

__all__ = ["GROUND", "Body", "DrawnBody", "Pin", "Scene", "Sketch", "Slide", "Vector"]
__all__ += ["ConstantSpeed", "Drive", "DriveLaw", "HarmonicLaw", "MotionLaw", "SegmentedLaw"]
__all__ += ["Force", "GuideForce", "Load", "Moment", "PressForce", "TableForce"]
__all__ += ["Friction", "GuideFriction", "PinFriction", "Spring", "TorsionSpring"]


@dataclass(frozen=True)
class Sketch:
    """Rough positions of the moving points at one position of the drive; they pick the branch and nothing else."""

    drive: Position = field(metadata={"path": "angle"})  # rad of a crank, m of a driven slider
    points: Mapping[str, Place] = field(metadata={"path": "*"})  # m


class VariationTable(FileTable):
    """What the workshop may deviate: a number of the file, and by how much, for `--monte-carlo`."""

    path: str = Field(max_length=limits.PATH, description='Where the number is, as "bodies.rocker.lengths.O-P3".')
    plus_minus: Annotated[Positive, Field(le=limits.LARGEST)] = Field(
        description="In the number's unit: three standard deviations, or all of a uniform."
    )
    distribution: Literal["normal", "uniform"] = Field("normal", description='"normal" where absent, or "uniform".')

    @property
    def deviation(self) -> float:
        """The standard deviation, in the unit of the number: `plus_minus` is three of a normal distribution."""
        return self.plus_minus / (3 if self.distribution == "normal" else sqrt(3))


class LimitTable(FileTable):
    """What a channel or a magnitude may be over the whole range of the drive, in the units of the file."""

    least: Finite | None = Field(None, description="It may never be less.")
    most: Finite | None = Field(None, description="It may never be more.")


E = TypeVar("E", bound=Element)


@dataclass(frozen=True)
class _Linkage:
    """The first fields of a scene."""

    name: str
    title: str
    source: str
    file: str  # the name of its tables in messages: the file that had them, and what was changed in it
    ground: Mapping[str, Place] = field(metadata={"path": "ground.points"})  # m
    bodies: Mapping[str, Annotated[Body, DrawnBody]]  # the moving bodies, in file order
    drives: tuple[Drive, ...] = field(metadata={"path": "drives", "lone": "drive"})  # one, each with its guide


if TYPE_CHECKING:

    @dataclass(frozen=True)
    class _Loaded(_Linkage):
        """The linkage and what acts on it: one field for each list of elements, of which models name these."""

        loads: tuple[Load, ...] = field(default=(), kw_only=True)
        springs: tuple[Spring, ...] = field(default=(), kw_only=True)
        torsion_springs: tuple[TorsionSpring, ...] = field(default=(), kw_only=True)
        friction: tuple[Friction, ...] = field(default=(), kw_only=True)

else:
    _LISTS = [(key, tuple[Union[table.kinds], ...]) for key, table in LISTS.items()]  # noqa: UP007
    _FIELDS = [(key, kinds, field(default=(), kw_only=True)) for key, kinds in _LISTS]
    _Loaded = make_dataclass("_Loaded", _FIELDS, bases=(_Linkage,), frozen=True)


@dataclass(frozen=True)
class Scene(_Loaded):
    """One mechanism in SI, made of tables by `scenes.from_tables`, or of those of a file by `scenes.load`.

    It needs its file no more: the tables are all that was in it. Two scenes are equal where their mechanisms are.
    """

    gravity: tuple[Gravity, Gravity] | None  # m/s^2
    sketch: Sketch
    output: str  # the point that the report is about
    tolerances: Mapping[str, Mapping[str, float]]  # engine -> channel group -> largest relative error
    units: Mapping[str, tuple[str, float]] = field(default_factory=lambda: SI)  # of the file: name, and size in SI
    limits: Mapping[str, LimitTable] = field(default_factory=dict)  # by channel or magnitude, SI
    variations: tuple[VariationTable, ...] = ()  # what the workshop may deviate, in the units of the file
    # As TOML gives them, in the units of the file, and never changed; empty where the scene has other numbers.
    tables: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Give each drive the guide of its body, whatever numbers that has now."""
        drives = (replace(drive, slide=self.bodies[drive.body].slide) for drive in self.drives)
        object.__setattr__(self, "drives", tuple(drives))

    def __hash__(self) -> int:
        """The hash of its name: what an engine finds once a scene is known by the scene."""
        return hash((self.name, self.file))

    @property
    def has_masses(self) -> bool:
        """Whether forces are asked for; a scene without masses is kinematic."""
        return all(body.mass is not None for body in self.bodies.values())

    @cached_property
    def owners(self) -> Mapping[str, tuple[str, ...]]:
        """The bodies that name each point, in file order, the ground first."""
        owners: dict[str, tuple[str, ...]] = dict.fromkeys(self.ground, (GROUND,))
        for name, body in self.bodies.items():
            owners |= {point: (*owners.get(point, ()), name) for point in body.points}
        return owners

    @cached_property
    def pins(self) -> tuple[Pin, ...]:
        """Every pin: at each point the first body that names it, with each of the others."""
        return tuple(
            Pin(point, owners[0], other, point if number == 0 else f"{point}/{other}")
            for point, owners in self.owners.items()
            for number, other in enumerate(owners[1:])
        )

    @cached_property
    def slides(self) -> Mapping[str, Slide]:
        """The guides of the bodies that slide, in file order."""
        return {name: body.slide for name, body in self.bodies.items() if body.slide is not None}

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """All that holds two bodies to each other, in the order of the force channels: the drives are last."""
        guides = (Guide(name, slide) for name, slide in self.slides.items())
        listed: Iterator[Any] = (element for _, element in self.listed if isinstance(element, Joint))
        drives = (TurningDrive(drive) if drive.slide is None else SlidingDrive(drive) for drive in self.drives)
        return (*self.pins, *guides, *listed, *drives)

    @cached_property
    def drawn(self) -> Mapping[str, complex]:
        """Where the scene has the points of the ground and of the sketch, m."""
        return {name: x + 1j * y for name, (x, y) in (*self.ground.items(), *self.sketch.points.items())}

    @cached_property
    def aligned(self) -> Mapping[str, frozenset[str]]:
        """For each body and the ground: those whose frames slides keep parallel to its own, itself included."""
        groups = {name: frozenset((name,)) for name in (GROUND, *self.bodies)}
        for name, slide in self.slides.items():
            joined = groups[name] | groups[slide.on]
            groups |= dict.fromkeys(joined, joined)
        return groups

    @cached_property
    def turning(self) -> tuple[str, ...]:
        """The bodies that can turn: all but those that slides keep parallel to the ground."""
        return tuple(name for name in self.bodies if name not in self.aligned[GROUND])

    @cached_property
    def listed(self) -> Sequence[tuple[str, Element]]:
        """All that acts on the bodies besides their weight, each with its place in the file."""
        return [(f"{key}.{number}", one) for key in LISTS for number, one in enumerate(getattr(self, key))]

    @cached_property
    def elements(self) -> Sequence[tuple[str, Element]]:
        """The same without joints, and without friction, which follows from what the joints carry."""
        return [(place, each) for place, each in self.listed if not (each.by_joints or isinstance(each, Joint))]

    def of_type(self, kind: type[E]) -> Mapping[str, E]:
        """By place in the file, the elements of a type."""
        return {place: element for place, element in self.listed if isinstance(element, kind)}

    @cached_property
    def presses(self) -> Mapping[str, PressForce]:
        """The loads that depend on the direction of motion, each by its place in the file."""
        return self.of_type(PressForce)

    @cached_property
    def kinds(self) -> frozenset[str]:
        """The kinds of what acts on the bodies, and of drives that not every engine knows."""
        kinds = {element.kind for _, element in self.listed}
        return frozenset(kinds | {drive.kind for drive in self.drives if drive.kind})

    @cached_property
    def driven(self) -> Mapping[str, Drive]:
        """The drives by the bodies that they move."""
        return {drive.body: drive for drive in self.drives}

    @cached_property
    def drive(self) -> Drive:
        """The only drive, for what is a function of its position: tracks, ranges, dead points, assemblies."""
        (drive,) = self.drives
        return drive

    def with_law(self, law: DriveLaw) -> "Scene":
        """The scene with another law of its only drive, and without tables, which would have that one."""
        return replace(self, drives=(replace(self.drive, law=law),), tables={})

    @property
    def cycle(self) -> float:
        """How long one cycle takes, s."""
        return self.drive.law.cycle

    @property
    def pace(self) -> float:
        """The largest peak rate of a drive, in rad/s or in spans a second."""
        return max(drive.law.peak_rate / drive.unit for drive in self.drives)

    @property
    def steady(self) -> bool:
        """Whether one drive of constant speed has it all, so that its position stands for the time."""
        return all(isinstance(drive.law, ConstantSpeed) for drive in self.drives) and len(self.drives) == 1

    @property
    def periodic(self) -> bool:
        """Whether a cycle can follow the one before."""
        return self.drive.law.periodic

    def guided(self, point: str) -> tuple[str, Slide] | None:
        """The body at a point that slides on the ground, and its guide; None where none does."""
        slides = ((name, self.slides.get(name)) for name in self.owners[point])
        return next(((name, slide) for name, slide in slides if slide is not None and slide.on == GROUND), None)

    @cached_property
    def channels(self) -> Channels:
        """The table of its channels."""
        return Channels(self)

    def unit_of(self, channel: str) -> tuple[str, float]:
        """The unit of a channel or magnitude in the file, and its size in SI: of velocities its length a second."""
        si = self.channels[channel].unit
        return self.all_units[DIMENSIONS[si]] if si in DIMENSIONS else (si, 1.0)

    @cached_property
    def all_units(self) -> Mapping[str, tuple[str, float]]:
        """The unit of each dimension in the file: its name, and what it is in SI; a direction has none."""
        return units_of_all(self.units, slides=self.drive.slide is not None)

    @cached_property
    def numbers(self) -> Mapping[str, Number]:
        """By path in the file, the numbers that machines of one topology may differ by: not of laws or the sketch."""
        fixed = ("sketch",) if isinstance(self.drive.law, ConstantSpeed) else ("sketch", "drives")
        return {number.path: number for number in self.ranked_numbers if number.at[0] not in fixed}

    @cached_property
    def ranked_numbers(self) -> Sequence[Number]:
        """All numbers in the order of the fields, those of lists by the ranks of these."""
        ranks = {key: table.rank for key, table in LISTS.items()}
        return sorted(walk(self), key=lambda number: ranks.get(str(number.at[0]), 0))

    def size(self, number: Number) -> float:
        """What the file's unit of a number is in SI; of a guide's direction, which has a length of its own there."""
        guide = number.quantity.dimension == "direction" and number.at[0] == "bodies"
        slide = self.bodies[str(number.at[1])].slide if guide else None
        return self.all_units[number.quantity.dimension][1] if slide is None else 1 / slide.drawn

    def with_numbers(self, values: Mapping[str, Any]) -> "Scene":
        """The scene with other numbers, SI, by their paths in the file; of many machines arrays of shape (m, 1).

        Nothing is checked, and no body becomes a bar or a plate by them. Of a guide's direction the numbers are in
        shares of its length in the file. The scene has no tables, which would have the numbers of this one.
        """
        # Elements that hold a fact derived from numbers are made anew after them: the sense in which a press closes
        # depends on the direction of its guide.
        there = {self.numbers[path].at: value for path, value in values.items()}
        other: Scene = put(self, {**there, ("tables",): {}})
        for key in LISTS:
            for number, element in enumerate(getattr(other, key)):
                if (settled := element.settled(other)) is not element:
                    other = put(other, {(key, number): settled})
        return other

    def length(self, metres: float, digits: int = 4) -> str:
        """A length in the unit of the file, as messages name it: `12.41 mm`."""
        return self.amount("length", metres, digits)

    def amount(self, quantity: str, value: float, digits: int = 4) -> str:
        """A length, mass, force, angle or speed, SI, in the unit of the file, as messages name it."""
        unit, size = self.all_units[quantity]
        return f"{value / size:.{digits}g} {unit}"

    def position(self, position: float) -> str:
        """A position of the drive, rad or m, in the unit of the file: `30.0000 deg`, `560 mm`."""
        if self.drive.slide is not None:
            return self.length(position, 6)
        unit, size = self.units["angle"]
        return f"{position / size:z.{4 if size <= pi / 180 else 6}f} {unit}"

    def between(self, ends: tuple[float, float]) -> str:
        """A range of positions of the drive, rad or m, in the unit of the file."""
        return " to ".join(map(self.position, ends))

    def where(self, position: float) -> str:
        """What messages call a position of the drive, rad or m: `crank angle 30.0000 deg`, `table at 560 mm`."""
        name = "crank angle" if self.drive.slide is None else f"{self.drive.body} at"
        return f"{name} {self.position(position)}"

    @cached_property
    def moving_points(self) -> tuple[str, ...]:
        """The points that are not on the ground."""
        return tuple(point for point, owners in self.owners.items() if owners[0] != GROUND)
