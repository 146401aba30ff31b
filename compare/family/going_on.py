"""The members of a family kept as they come, so that a run goes on from there; and run by many workers."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenes import Sampling, Scene, Status, load, shipped

from ..engines import registry
from ..engines.data import decoded, encoded
from ..engines.isolation import Ended
from ..engines.kept import Kept
from ..engines.lasting import Lasting
from .family import SHOWN, Member, changed, members, solved_member

if TYPE_CHECKING:
    from dask.distributed import Client

Change = Mapping[str, float]

ENGINES = Lasting()  # of a worker


def kept_members(folder: Path, scene: Scene, engines: Sequence[str], sampling: Sampling) -> Kept:
    """Return what is kept of the families of a scene file in the folder where results go."""
    text = shipped().get(scene.file, Path(scene.file)).read_bytes()
    return Kept(folder / f"{scene.name}.partial.jsonl", (text, engines, sampling))


def going_on(
    kept: Kept,
    file: str,
    changes: Sequence[Change],
    engines: Sequence[str],
    sampling: Sampling,
    client: "Client | None",
    progress: Callable[[str], None],
) -> Iterator[Member]:
    """Yield the members that are kept, then the others as they come, which are kept.

    Args:
        kept: the results of an earlier run that was stopped.
        file: of the scene.
        changes: one a member.
        engines: their names.
        sampling: the instants.
        client: of the workers, who take the members; None for this process.
        progress: called with what is being done, again and again; it may raise.
    """
    left = {str(change): change for change in changes}
    for name, data in kept.read():
        if name in left and (member := _read(data, file, left[name])):
            del left[name]
            yield member
    run = members if client is None else partial(_spread, client)
    for member in run(file, list(left.values()), engines, sampling, progress):
        if member.status != Status.crashed.name:  # which may go well the next time
            kept.add(str(member.changes), _written(member))
        yield member


def _written(member: Member) -> Any:
    """Return a member as what JSON has, without its scene and the solver of that."""
    judged = member.judgement
    if judged is None:
        return encoded([member, {}])
    shown = {name: vars(judged)[name] for name in SHOWN}
    bare: Any = replace(judged, scene=None, reference=replace(judged.reference, scene=None, at=None))  # type: ignore[arg-type]
    return encoded([replace(member, judgement=bare), shown])


def _read(data: Any, file: str, change: Change) -> Member | None:
    """Return the member that was written, or None where something else was."""
    with suppress(Exception):  # whatever is there
        member, shown = decoded(data)
        if not isinstance(member, Member) or member.changes != change:
            return None
        if member.judgement is None:
            return member
        scene = load(file, change)
        known = replace(member.judgement.reference, scene=scene, at=registry.reference(scene))
        judged = replace(member.judgement, scene=scene, reference=known)
        vars(judged).update(shown)
        return replace(member, judgement=judged)
    return None


def _spread(
    client: "Client",
    file: str,
    changes: Sequence[Change],
    engines: Sequence[str],
    sampling: Sampling,
    progress: Callable[[str], None],
) -> Iterator[Member]:
    """Yield members as workers are done with them."""
    from ..engines.cluster import spread

    made = [(change, changed(file, change)) for change in changes]
    yield from (member for _, member in made if isinstance(member, Member))
    tasks = [(change, scene) for change, scene in made if isinstance(scene, Scene)]
    run = partial(_on_worker, engines, sampling)
    for (change, _), member in spread(run, tasks, client, lambda: progress("waiting for workers")):
        yield Member(change, member.status.name, member.reason) if isinstance(member, Ended) else member


def _on_worker(engines: Sequence[str], sampling: Sampling, task: tuple[Change, Scene]) -> Member:
    """Return a member, by engines whose processes are there for the next one too."""
    change, scene = task
    with ENGINES.runs((*engines, registry.ORACLE)) as runs:
        return solved_member(scene, change, engines, sampling, lambda _: None, runs)
