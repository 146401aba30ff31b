"""What the first screen shows: the designer's numbers, one row an engine."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import degrees, isnan
from typing import NamedTuple, TypeVar

from scenes import Scene, Status
from scenes.channels import Channel, named

from ...engines.registry import REFERENCE
from ...judge.agreement import worst_error
from ...judge.measure import Measurement
from ...judge.peaks.peaks import Peak
from ...mechanics.axis import DriveAxis, axis
from ...study import Study
from ..figures.style import colour
from ..numbers import Units, capital, percent, written
from ..output.earlier import SummaryPeak

Number = TypeVar("Number", Peak, SummaryPeak)

IN_MS: Units = {"s": (1e3, "ms")}  # of times that a clock took
SAME_TOL = 1e-9  # relative: less is no change
MEANINGS = {"quick return": "time to close over time to open"}  # where the name of a number leaves it open
OF_A_PIN, OF_A_JOINT, OF_THE_DRIVE = ("fx",), ("fx", "guide_force", "guide_moment"), ("torque", "force")  # quantities


class PoseButton(NamedTuple):
    """A button that shows a pose, with the point of a channel marked."""

    channel: str
    point: str
    at: float  # on the axis, SI
    text: str


class Answer(NamedTuple):
    """One of the designer's numbers."""

    name: str
    meaning: str  # what the name alone leaves open, in a few words; mostly nothing
    text: str
    value: float
    unit: str
    of: str  # the joint, where its name is not in that of the number
    place: PoseButton | None
    direction: str
    differ: str  # by how much the engines differ at most
    each: str  # by how much each of them does
    before: str  # what it was in an earlier run, and by how much it changed since

    @property
    def cells(self) -> tuple[str, ...]:
        """Its name, value and place, and by how much the engines differ."""
        return self.name, self.text, f"{self.of} {self.place.text if self.place else ''}".strip(), self.differ


def answers(
    scene: Scene, peaks: Sequence[Peak], units: Units, before: Sequence[SummaryPeak] = ()
) -> tuple[list[Answer], list[Answer]]:
    """The numbers of the whole linkage, of the forces of its pins the largest; and those of every joint.

    Each beside that of an earlier run, if there is one, the largest pin force beside the largest then, at whatever pin.
    """
    along, (whole, at_joints) = axis(scene), parted(peaks)
    was = {(peak.name, peak.of): peak.value for peak in before}
    largest_was = next((old.value for old in parted(before)[0] if named(old.channel).name in OF_A_PIN), None)

    def answer(peak: Peak, *, largest: bool = False) -> Answer:
        sizes = [size for size in peak.differs.values() if not isnan(size)]
        return Answer(
            name="Largest pin force" if largest else capital(peak.name),
            meaning=MEANINGS.get(peak.name, ""),
            text=written(peak.value, peak.unit, units),
            value=peak.value,
            unit=peak.unit,
            of=peak.of if largest else "",
            place=pose_button(along, scene.channels[peak.channel], peak.position),
            direction="" if isnan(peak.direction) else f"{degrees(peak.direction):.0f}°".replace("-", "−"),
            differ=percent(max(sizes)) if sizes else "–",
            each=", ".join(f"{engine} {percent(size)}" for engine, size in peak.differs.items()),
            before=_before(peak, largest_was if largest else was.get((peak.name, peak.of)), units),
        )

    return [answer(peak, largest=peak in at_joints) for peak in whole], [*map(answer, at_joints)]


def _before(peak: Peak, was: float | None, units: Units) -> str:
    """What a number was, and its change in per cent."""
    if was is None:
        return ""
    if abs(peak.value - was) <= SAME_TOL * abs(was):
        return "same"
    change = f" ({100 * (peak.value / was - 1):+.3g}\u00a0%)".replace("-", "−") if was else ""
    return f"{written(was, peak.unit, units)}{change}"


def of_ok(study: Study) -> list[Peak]:
    """The designer's numbers, with by how much each engine that is ok differs: what a rejected one has is no doubt."""
    ok = {m.run.engine for m in study.measurements if m.run.status is Status.ok}
    return [
        replace(p, differs={engine: size for engine, size in p.differs.items() if engine in ok}) for p in study.peaks
    ]


def parted(peaks: Sequence[Number]) -> tuple[list[Number], list[Number]]:
    """The numbers of the whole linkage, the largest pin force before the drive's; and those of every joint."""
    at_joints = [peak for peak in peaks if named(peak.channel).name in OF_A_JOINT]
    pins = [peak for peak in at_joints if named(peak.channel).name in OF_A_PIN]
    whole = [peak for peak in peaks if peak not in at_joints and peak.value != 0]  # a cycle without losses has no work
    drives = (row for row, peak in enumerate(whole) if named(peak.channel).name in OF_THE_DRIVE)
    whole[(row := next(drives, len(whole))) : row] = sorted(pins, key=lambda peak: peak.value)[-1:]
    return whole, at_joints


def pose_button(along: DriveAxis, channel: Channel, position: float) -> PoseButton | None:
    """A place on the axis, given in SI: `171°`, `3.2 mm`; none where it is NaN."""
    if isnan(position):
        return None
    return PoseButton(channel.name, channel.point, position, along.text(position))


def engines(study: Study) -> Iterator[dict[str, object]]:
    """A row an engine, in the order asked for: how its run ended, its largest error and where that is, its time."""
    times = {(row.engine, row.setting): row.solve_min_s for row in study.speed[::-1]}  # of a solve per cycle
    for number, m in enumerate(study.measurements):
        run, worst = m.run, worst_error(study.scene, m)
        time = times.get((run.engine, run.settings.label if run.settings else ""))
        yield {
            "engine": _named(m),
            "colour": colour(number),
            "status": run.status.name,
            "worst": worst.size if worst else None,
            "time": "–" if time is None else written(time, "s", IN_MS, digits=3),
            "place": pose_button(axis(study.scene), study.scene.channels[worst.channel], worst.position)
            if worst
            else None,
        }


def _named(measured: Measurement) -> str:
    """An engine's name with its version; for the reference, whose version is a package's, what it is."""
    run, version = measured.run, measured.run.version.partition(",")[0]
    if measured.foreign:
        return f"{run.engine} ({version})" if version else run.engine
    return f"{run.engine} (reference)" if run.engine == REFERENCE else version or run.engine
