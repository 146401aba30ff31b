"""A family of linkages: one scene with other numbers, each member solved by the reference and cross-checked."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from math import prod
from typing import NamedTuple, TypeAlias

import numpy as np

from scenes import Failure, InputError, Motion, Sampling, Scene, Settings, Status, with_changes
from scenes.file.changes import label
from scenes.model.motion import Samples

from ...engines import registry
from ...engines.processes.stopping import Progress
from ...engines.processes.workers import workers
from ...engines.reasons import described
from ...engines.runner import Runs
from ...judge.agreement import FromSamples, Judgement
from ...judge.floor import solved
from ...judge.judgement import judgement
from ...judge.measure import Measurement, offers
from ...judge.peaks.curves import curves
from ...judge.peaks.peaks import Peak
from ...mechanics.axis import axis
from ...mechanics.mechanics import Mechanics
from ...mechanics.round_off import Explained
from .grid import VariedNumber

MemberChanges: TypeAlias = Mapping[str, float]  # path in the scene file -> value, in the units of the file

DRAWN = ("displacement", "velocity", "acceleration", "effort")  # kinds of curves
INVALID = "invalid"  # status of a member that is no scene, beside those of an engine


@dataclass(frozen=True)
class Cycle:
    """One linkage over one cycle of its drive, by the reference."""

    position: Samples  # on the axis of the curves, SI: of the drive, or the time under a law
    curves: Mapping[str, Samples]  # of the output and the drive, by name, SI, each of shape (n,)


@dataclass(frozen=True)
class Member:
    """One linkage of a family: its cycle and its judged engines, or the reason why it cannot run."""

    changes: MemberChanges
    status: str
    reason: str
    cycle: Cycle | None = None
    judgement: Judgement | None = None

    @property
    def measurements(self) -> Sequence[Measurement]:
        """Its engines' runs, in the order asked for."""
        return self.judgement.measurements if self.judgement else ()

    @property
    def numbers(self) -> dict[str, Peak]:
        """The numbers of its cycle by kind; of those of joints the largest."""
        peaks = self.judgement.peaks if self.judgement else ()
        return {each.kind: max((p for p in peaks if p.kind == each.kind), key=lambda p: p.value) for each in peaks}


@dataclass(frozen=True)
class Family:
    """The members that were run, in the order of the grid; fewer than asked for where the user stopped."""

    scene: Scene  # as its file has it
    variations: Sequence[VariedNumber]
    engines: Sequence[str]
    members: list[Member] = field(default_factory=list)

    @property
    def asked(self) -> int:
        """How many members were asked for."""
        return prod(len(variation.values) for variation in self.variations)

    @property
    def complete(self) -> bool:
        """Whether all of them were run."""
        return len(self.members) == self.asked


class Asked(NamedTuple):
    """What is asked of every member."""

    scene: Scene  # as its tables have it
    engines: Sequence[str]
    sampling: Sampling


def members(asked: Asked, changes: Iterable[MemberChanges], progress: Progress) -> Iterator[Member]:
    """Yield one member after the other, those that cannot run too."""
    with workers([*asked.engines, registry.ORACLE], lambda: None) as runs:
        for change in changes:
            yield solved_member(asked, change, changed(asked.scene, change), runs, progress)


def changed(scene: Scene, change: MemberChanges) -> Scene | Member:
    """The scene of a member; of one that is no scene the member itself."""
    try:
        return with_changes(scene, change)
    except InputError as error:
        return Member(change, INVALID, str(error).removeprefix(f"{label(scene.file, change)}: "))


def solved_member(asked: Asked, change: MemberChanges, scene: Scene | Member, runs: Runs, progress: Progress) -> Member:
    """A member solved, certified and cross-checked, or why it cannot run."""
    if isinstance(scene, Member):
        return scene
    try:
        return _member(asked, change, scene, runs, progress)
    except InputError as error:
        return Member(change, INVALID, str(error).removeprefix(f"{scene.file}: "))
    except Failure as failure:
        return Member(change, failure.status.name, failure.reason)
    except Exception as error:  # one odd linkage must not take the others with it
        return Member(change, Status.crashed.name, described(error))


def _member(asked: Asked, change: MemberChanges, scene: Scene, runs: Runs, progress: Progress) -> Member:
    judged = judgement(solved(scene, runs=runs), asked.engines, asked.sampling, balanced, progress, runs)
    return Member(change, Status.ok.name, "", _cycle(judged), _kept(judged))


def balanced(engine: str) -> tuple[Sequence[Settings], str]:
    """What every linkage of many is judged by: an engine's balanced settings, of which nothing is to be noted."""
    return offers(engine, "balanced"), ""


def _cycle(judged: Judgement) -> Cycle:
    motion, drawn = judged.reference.cycle, dict[str, Samples]()
    for curve in curves(judged.scene, judged.reference.scale, motion):
        values = curve.values(motion)
        if curve.kind == "path":
            drawn |= {"x": values.real, "y": values.imag}
        elif curve.kind in DRAWN:
            name = judged.scene.channels[curve.channels[0]].quantity if curve.kind == "effort" else curve.kind
            drawn[name] = np.abs(values) if np.iscomplexobj(values) else values
    return Cycle(motion[axis(judged.scene).channel], drawn)


def _kept(judged: Judgement) -> Judgement:
    """A judgement without samples, of which two hundred members would take half a gigabyte, and what they show."""
    # The motions go, while the names of their channels stay, since pages list what each engine gave. Causes and peaks
    # are found from samples: they are evaluated before and put into the new judgement's cache.
    nothing, measurements = np.empty(0), []
    for m in judged.measurements:  # whose motions keep the names of their channels
        names = m.run.motion and replace(m.run.motion, samples=dict.fromkeys(m.run.motion.samples, nothing))
        measurements.append(replace(m, run=replace(m.run, motion=names), comparison=None))
    mechanics, solve = Mechanics(judged.scene), copy(judged.reference.at)
    reference = replace(judged.reference, mechanics=mechanics, at=solve, cycle=Motion({}))
    found = FromSamples(judged.causes, judged.peaks)
    explained = Explained(nothing, {})
    return replace(judged, reference=reference, explained=explained, measurements=measurements, from_samples=found)
