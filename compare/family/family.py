"""A family of linkages: one scene with other numbers, each member solved by the reference and cross-checked."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from math import prod
from pathlib import Path

import numpy as np

from scenes import Failure, InputError, Motion, Sampling, Scene, Status, load
from scenes.changes import label

from ..engines import registry
from ..engines.reasons import described
from ..engines.runner import Runs
from ..engines.workers import workers
from ..judge.escalation import offers
from ..judge.floor import solved
from ..judge.judgement import Judgement, judgement
from ..judge.measure import Measurement
from ..judge.round_off import Explained
from .cycle import Cycle, cycle
from .grid import Variation

SHOWN = ("causes", "peaks")  # of a judgement, which are found by samples
INVALID = "invalid"  # status of a member that is no scene, beside those of an engine


@dataclass(frozen=True)
class Member:
    """One linkage of a family: its cycle and its judged engines, or the reason why it cannot run."""

    changes: Mapping[str, float]  # path in the scene file -> value, in the units of the file
    status: str
    reason: str
    cycle: Cycle | None = None
    judgement: Judgement | None = None

    @property
    def measurements(self) -> Sequence[Measurement]:
        """Its engines' runs, in the order asked for."""
        return self.judgement.measurements if self.judgement else ()


@dataclass(frozen=True)
class Family:
    """The members that were run, in the order of the grid; fewer than asked for where the user stopped."""

    scene: Scene  # as its file has it
    variations: Sequence[Variation]
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


def members(
    file: str | Path,
    changes: Iterable[Mapping[str, float]],
    engines: Sequence[str],
    sampling: Sampling,
    progress: Callable[[str], None],
) -> Iterator[Member]:
    """Yield one member after the other, those that cannot run too."""
    with workers([*engines, registry.ORACLE], lambda: None) as runs:
        for change in changes:
            scene = changed(file, change)
            yield (
                scene if isinstance(scene, Member) else solved_member(scene, change, engines, sampling, progress, runs)
            )


def changed(file: str | Path, change: Mapping[str, float]) -> Scene | Member:
    """Return the scene of a member; of one that is no scene the member itself."""
    try:
        return load(file, change)
    except InputError as error:
        return Member(change, INVALID, str(error).removeprefix(f"{label(file, change)}: "))


def solved_member(
    scene: Scene,
    change: Mapping[str, float],
    engines: Sequence[str],
    sampling: Sampling,
    progress: Callable[[str], None],
    runs: Runs,
) -> Member:
    """Return a member, whether it can run or not."""
    try:
        return _member(scene, change, engines, sampling, progress, runs)
    except InputError as error:
        return Member(change, INVALID, str(error).removeprefix(f"{scene.file}: "))
    except Failure as failure:
        return Member(change, failure.status.name, failure.reason)
    except Exception as error:  # one odd linkage must not take the others with it
        return Member(change, Status.crashed.name, described(error))


def _member(
    scene: Scene,
    change: Mapping[str, float],
    engines: Sequence[str],
    sampling: Sampling,
    progress: Callable[[str], None],
    runs: Runs,
) -> Member:
    """Solve, certify and cross-check one member.

    Raises:
        Failure: the reference cannot solve it.
        InputError: there is nothing to compare, since its output stands still.
    """
    reference = solved(scene, runs=runs)
    judged = judgement(reference, engines, sampling, lambda name: (offers(name, "balanced"), ""), progress, runs)
    return Member(change, Status.ok.name, "", cycle(judged), _kept(judged))


def _kept(judged: Judgement) -> Judgement:
    """Return a judgement without samples, of which two hundred members would take half a gigabyte, and what they show.

    Motions keep the names of their channels.
    """
    reference = replace(judged.reference, at=copy(judged.reference.at), cycle=Motion({}), neighbours=())
    measurements = [
        replace(m, run=replace(m.run, motion=_names(m.run.motion)), comparison=None) for m in judged.measurements
    ]
    nothing = Explained(np.empty(0), {})
    kept = replace(judged, reference=reference, explained=nothing, measurements=measurements)
    vars(kept).update({name: getattr(judged, name) for name in SHOWN})
    return kept


def _names(motion: Motion | None) -> Motion | None:
    return motion and replace(motion, samples=dict.fromkeys(motion.samples, np.empty(0)))
