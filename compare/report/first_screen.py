"""What the first screen shows: the verdict's sign, the designer's numbers, one row an engine."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import degrees, isnan

from scenes import Scene
from scenes.motion import quantity

from ..engines.axis import Axis, axis
from ..engines.registry import REFERENCE
from ..judge.agreement import Word, worst_error
from ..judge.measure import Measurement
from ..judge.peaks.peaks import Peak
from ..study import Study
from .numbers import percent, written
from .style import colour
from .units import Units

MARKS = {Word.agrees: "✓", Word.in_part: "≈", Word.disagrees: "✗", Word.not_solved: "✗"}
MEANINGS = {"Quick return": "time to close over time to open"}  # where a name leaves it open
OF_A_PIN, OF_A_JOINT, OF_THE_DRIVE = ("fx",), ("fx", "guide_force", "guide_moment"), ("torque", "force")  # quantities


@dataclass(frozen=True)
class Place:
    """A button that shows a pose, with a channel marked."""

    channel: str
    at: float  # on the axis, SI
    text: str


@dataclass(frozen=True)
class Shown:
    """One of the designer's numbers."""

    name: str
    text: str
    value: float
    unit: str
    of: str  # the joint, where its name is not in that of the number
    place: Place | None
    direction: str
    differ: str  # by how much the engines differ at most
    each: str  # by how much each of them does

    @property
    def cells(self) -> tuple[str, ...]:
        """Its name, value and place, and by how much the engines differ."""
        return self.name, self.text, f"{self.of} {self.place.text if self.place else ''}".strip(), self.differ

    @property
    def meaning(self) -> str:
        """What the name alone leaves open, in a few words; mostly nothing."""
        return MEANINGS.get(self.name, "")


@dataclass(frozen=True)
class Row:
    """One engine: how its run ended, its largest error and where that is, its time."""

    engine: str  # with its version
    colour: str
    status: str
    worst: float
    place: Place | None
    time: str


def peaks(scene: Scene, found: Sequence[Peak], units: Units) -> list[Shown]:
    """Return the numbers of the whole linkage, of the forces of its pins the largest."""
    pins = [peak for peak in found if quantity(peak.channel) in OF_A_PIN]
    largest = max(pins, key=lambda peak: peak.value, default=None)
    joints = _of_joints(found)
    whole = [peak for peak in found if peak not in joints and peak.value != 0]  # a cycle without losses has no work
    first = [_shown(scene, peak, units) for peak in whole]
    if largest is None:
        return first
    at = next((n for n, peak in enumerate(whole) if quantity(peak.channel) in OF_THE_DRIVE), len(first))
    return [*first[:at], _shown(scene, largest, units, "Largest pin force", largest.of), *first[at:]]


def joints(scene: Scene, found: Sequence[Peak], units: Units) -> list[Shown]:
    """Return the largest force and moment of every joint."""
    return [_shown(scene, peak, units) for peak in _of_joints(found)]


def _of_joints(found: Sequence[Peak]) -> Sequence[Peak]:
    return [peak for peak in found if quantity(peak.channel) in OF_A_JOINT]


def _shown(scene: Scene, peak: Peak, units: Units, name: str = "", of: str = "") -> Shown:
    sizes = [size for size in peak.differs.values() if not isnan(size)]
    return Shown(
        name or peak.name[:1].upper() + peak.name[1:],
        written(peak.value, peak.unit, units),
        peak.value,
        peak.unit,
        of,
        _place(axis(scene), peak.channel, peak.position),
        "" if isnan(peak.direction) else f"{degrees(peak.direction):.0f}°".replace("-", "−"),
        percent(max(sizes)) if sizes else "–",
        ", ".join(f"{engine} {percent(size)}" for engine, size in peak.differs.items()),
    )


def engines(study: Study) -> Iterator[Row]:
    """Yield a row per engine, in the order asked for."""
    over = axis(study.scene)
    for number, m in enumerate(study.measurements):
        worst = worst_error(study.scene, m)
        size = worst.size if worst else float("nan")
        place = _place(over, worst.channel, worst.position) if worst else None
        yield Row(_named(m), colour(number), m.run.status.name, size, place, _time(study, m))


def _place(over: Axis, channel: str, position: float) -> Place | None:
    """Return a place on the axis, given in SI: `171°`, `3.2 mm`."""
    if isnan(position):
        return None
    at = f"{round(position * over.factor, 10) + 0.0:.4g}".replace("-", "−")
    return Place(channel, position, f"{at}°" if over.unit == "deg" else f"{at} {over.unit}")


def _named(measured: Measurement) -> str:
    """Return an engine's name with its version; for the reference, whose version is a package's, what it is."""
    run = measured.run
    version = run.version.partition(",")[0]
    if measured.own:
        return f"{run.engine} ({version})" if version else run.engine
    return f"{run.engine} (reference)" if run.engine == REFERENCE else version or run.engine


def _time(study: Study, measured: Measurement) -> str:
    """Return the time of a solve per cycle at the settings of the run, as the table of speed has it."""
    settings, speed = measured.run.settings, study.speed
    label = settings.label if settings else None
    times = (row.solve_min_s for row in speed if (row.engine, row.setting) == (measured.run.engine, label))
    return next((written(time, "s", {}) for time in times), "–")
