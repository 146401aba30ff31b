"""How far the reference may itself be off, and whether it is to be believed: measured by arbitrary precision.

The reference is in doubt where it contradicts itself, or differs from arbitrary precision by more than it promises and
round-off explains. Then nothing is held against it.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from scenes import Failure, InputError, Sampling, Scene, Settings, Status
from scenes.errors import LONGEST, one_line

from ..engines import registry
from ..engines.reasons import described
from ..engines.runner import HERE, Run, Runs
from ..mechanics import axis as units
from ..mechanics.mechanics import Mechanics
from ..mechanics.reference import Floor, Reference, first_cycle
from .measure import Measurement, Standard, assess
from .sketch import UnclearSketchError, with_notes, with_sketch

FLOOR_SAMPLES = 72  # a cycle: what arbitrary precision can afford in every run
DRIVE = Settings("").drive_promise
NO_ANSWER = {Status.unsupported, Status.timed_out, Status.not_converged, Status.crashed}  # which casts no doubt


class UnsolvedError(InputError):
    """The line on a scene that the reference cannot solve, and the failure behind it, if it is one of the core's."""

    def __init__(self, text: str, failure: Failure | None = None) -> None:
        super().__init__(text)
        self.failure = failure

    @property
    def sentence(self) -> str:
        """What a page on that scene has, which needs no path in its file and no key of a status."""
        if self.failure is None:
            return str(self)
        return f"{self.failure.status.value.removesuffix('.')}: {one_line(self.failure.reason, LONGEST)}."


@contextmanager
def solvable(scene: Scene) -> Iterator[None]:
    """Convert failures of the reference on a scene to UnsolvedError."""
    try:
        yield
    except UnsolvedError:
        raise
    except InputError as error:
        raise UnsolvedError(str(error)) from None
    except Failure as failure:
        place = "sketch" if isinstance(failure, UnclearSketchError) else "bodies"
        raise UnsolvedError(f"{scene.file}: {place}: {failure.status.name}: {failure.reason}", failure) from None
    except Exception as error:  # a fault of the core's own, with which there is nothing to compare
        raise UnsolvedError(f"{scene.file}: the reference failed: {described(error)}") from error


def establish(scene: Scene, channels: frozenset[str] | None = None, runs: Runs = HERE) -> Reference:
    """Solve one cycle of the reference, take the scales from it, and certify it for some of the channels or all.

    Raises:
        UnsolvedError: the reference cannot solve the scene, so that there is nothing to compare with.
    """
    with solvable(scene):
        return solved(scene, channels, runs)


def solved(scene: Scene, channels: frozenset[str] | None = None, runs: Runs = HERE) -> Reference:
    """What `establish` returns.

    Raises:
        Failure: the reference cannot solve the scene, or its sketch does not show one assembly.
        InputError: the output does not move.
    """
    mechanics = Mechanics(scene)
    try:
        reference = first_cycle(mechanics)
    except Failure as failure:
        raise with_sketch(mechanics, failure) from None
    reference = with_notes(reference)
    sampling = Sampling(FLOOR_SAMPLES, channels=channels)
    standard = Standard.of(reference, sampling)
    answer = reference.at(sampling.inputs(scene))
    settings = registry.engine(registry.REFERENCE).DEFAULT
    both = (
        Run(registry.REFERENCE, settings, Status.ok, motion=answer.prompt),
        runs.run(registry.ORACLE, scene, sampling),
    )
    # The core's answer and that of arbitrary precision go through the same judgement as any engine. The floor is their
    # difference at FLOOR_SAMPLES positions; a disagreement beyond promise and round-off is a doubt, and who contradicts
    # itself is suspected first.
    core, oracle = (assess(standard, run) for run in both)
    if oracle.run.status is Status.wrong_branch and oracle.run.found_by == "reference" and reference.rough_sketch:
        raise UnclearSketchError(f"{registry.ENTRIES[registry.ORACLE].distribution} takes {reference.rough_sketch}")
    doubt = _doubt(core, oracle)
    if oracle.comparison is None:
        return replace(reference, floor=Floor({}, f"not certified: {oracle.run.reason}", doubt))
    where = f"{FLOOR_SAMPLES} {'angles' if units.turns_fully(scene) else 'instants'}"
    source = f"{registry.ENTRIES[registry.ORACLE].version} at {where} a {units.cycle_name(scene)}"
    floor = {channel: float(error.max()) for channel, error in oracle.comparison.commanded.items()}
    worst = max(floor, key=floor.__getitem__)
    kept = floor[worst] <= settings.promise
    limit = "" if kept else f", all that doubles leave of {worst}: {standard.explained.why(worst)}"
    return replace(reference, floor=Floor(floor, source, doubt, limit))


def _doubt(core: Measurement, oracle: Measurement) -> str:
    """Why the reference is not to be believed, with whom to suspect; or nothing."""
    if any(check.check == "drive" and not check.worst <= DRIVE for check in core.checks):  # it is where it was put
        return f"the scene's drive contradicts itself, suspect the scene's layer: {core.run.reason}"
    if core.run.status is not Status.ok:
        return f"the core contradicts itself, suspect the core: {core.run.reason}"
    if oracle.run.status is Status.ok or oracle.run.status in NO_ANSWER:
        return ""
    if oracle.run.found_by == "checks":  # a third opinion, which takes laws and loads as all other models do
        return f"arbitrary precision alone differs, suspect the scene's laws, tables and loads: {oracle.run.reason}"
    return f"the core and arbitrary precision differ, suspect the core: {oracle.run.reason}"
