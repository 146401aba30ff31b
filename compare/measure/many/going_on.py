"""The members of a family kept as they come, so that a run goes on from there; and run by many workers."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from multiprocessing import current_process
from pathlib import Path
from typing import Any, TypeAlias

from scenes import Scene, Status, with_changes

from ...engines import registry
from ...engines.kept import Kept, decoded, encoded
from ...engines.processes.inside import Ended, Limits
from ...engines.processes.isolation import isolated
from ...engines.processes.stopping import Progress
from ...engines.processes.workers import Lasting
from ...mechanics.mechanics import Mechanics
from .family import Asked, Member, MemberChanges, changed, members, solved_member

Task: TypeAlias = tuple[MemberChanges, Scene | Member]  # a member's changes, and its scene
Spread: TypeAlias = Callable[..., Iterator[tuple[Task, Member | Ended]]]  # of a function, tasks, and `poll`

ENGINES = Lasting()  # of a worker
SECONDS, MEMORY = 3600.0, 2**40  # for a member, beside its engines, which have limits of their own: a hang ends


def kept_members(folder: Path, scene: Scene, asked: Asked) -> Kept:
    """What is kept of the families of a scene in the folder where results go."""
    return Kept(folder / f"{scene.name}.partial.jsonl", (scene.tables, asked.engines, asked.sampling))


def going_on(
    kept: Kept, asked: Asked, changes: Sequence[MemberChanges], spread: Spread | None, progress: Progress
) -> Iterator[Member]:
    """Yield the members that are kept, then the others as they come, which are kept.

    Args:
        kept: the results of an earlier run that was stopped.
        asked: of every member.
        changes: one a member.
        spread: has workers do tasks, as `by_processes` and `engines.processes.cluster.spread`; None for this process.
        progress: called with what is being done, again and again; it may raise.
    """
    left = {str(change): change for change in changes}
    for name, data in kept.read():
        if name in left and (member := _read(data, asked, left[name])):
            del left[name]
            yield member
    run = members if spread is None else partial(_by_workers, spread)
    for member in run(asked, list(left.values()), progress):
        if member.status != Status.crashed.name:  # which may go well the next time
            kept.add(str(member.changes), _written(member))
        yield member


def _written(member: Member) -> Any:
    """A member as what JSON has, without its scene and the solver of that."""
    judged: Any = member.judgement
    bare = judged and replace(judged, scene=None, reference=replace(judged.reference, mechanics=None, at=None))
    return encoded(replace(member, judgement=bare))


def _read(data: Any, asked: Asked, change: MemberChanges) -> Member | None:
    """The member that was written, or None where something else was."""
    with suppress(Exception):  # whatever is there
        member = decoded(data)
        if not isinstance(member, Member) or member.changes != change:
            return None
        if member.judgement is None:
            return member
        scene = with_changes(asked.scene, change)
        known = replace(member.judgement.reference, mechanics=Mechanics(scene), at=registry.reference(scene))
        return replace(member, judgement=replace(member.judgement, scene=scene, reference=known))
    return None


def by_processes(count: int) -> Spread:
    """What spreads tasks over so many processes of this computer."""
    return partial(isolated, limits=Limits(SECONDS, MEMORY, count))


def _by_workers(spread: Spread, asked: Asked, changes: Sequence[MemberChanges], progress: Progress) -> Iterator[Member]:
    for name in (registry.REFERENCE, *asked.engines):  # whose solver and settings come back
        if not registry.ENTRIES[name].missing:
            registry.engine(name)
    tasks = [(change, changed(asked.scene, change)) for change in changes]
    at_work = partial(spread, partial(_on_worker, asked), poll=lambda: progress("waiting for workers"))
    lost = []
    for task, member in at_work(tasks):
        if isinstance(member, Ended):
            lost.append(task)
        else:
            yield member
    # Tried alone, a task that kills its worker again is to blame itself, and no other task is lost with it.
    for task in lost:  # once more, by itself: whatever ended its worker may have come from outside
        ((_, member),) = at_work([task])
        yield Member(task[0], member.status.name, member.reason) if isinstance(member, Ended) else member


def _on_worker(asked: Asked, task: Task) -> Member:
    """A member, by engines whose processes are there for the next one too."""
    current_process().daemon = False  # it may have processes of its own, which end with it
    with ENGINES.runs((*asked.engines, registry.ORACLE)) as runs:
        return solved_member(asked, *task, runs, lambda _: None)
