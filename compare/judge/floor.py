"""How far the reference may itself be off, and whether it is to be believed: measured by arbitrary precision.

The reference is in doubt where it contradicts itself, or differs from arbitrary precision by more than it promises and
round-off explains. Then nothing is held against it.
"""

from dataclasses import replace

from scenes import Failure, InputError, Sampling, Scene, Settings, Status

from ..engines import axis as units
from ..engines import registry, runner
from ..engines.reasons import described
from ..engines.reference import Floor, Reference, found
from ..engines.runner import Run, Runs
from ..engines.stopping import Stopped
from .measure import Measurement, assess
from .perturbation import neighbours
from .round_off import explain

FLOOR_SAMPLES = 72  # a cycle: what arbitrary precision can afford in every run
DRIVE = Settings("").drive_promise
NO_ANSWER = {Status.unsupported, Status.timed_out, Status.not_converged, Status.crashed}  # which casts no doubt


def establish(scene: Scene, channels: frozenset[str] | None = None, runs: Runs = runner) -> Reference:
    """Solve one cycle of the reference, take the scales from it, and certify it for some of the channels or all.

    Args:
        scene: the mechanism.
        channels: those to certify; None for all.
        runs: what runs arbitrary precision.

    Raises:
        InputError: the reference cannot solve the scene, so that there is nothing to compare with.
    """
    try:
        return solved(scene, channels, runs)
    except (InputError, Stopped):
        raise
    except Failure as failure:
        raise InputError(f"{scene.file}: bodies: {failure.status.name}: {failure.reason}") from None
    except Exception as error:  # a fault of the core's own, with which there is nothing to compare
        raise InputError(f"{scene.file}: the reference failed: {described(error)}") from error


def solved(scene: Scene, channels: frozenset[str] | None = None, runs: Runs = runner) -> Reference:
    """Return what `establish` does.

    Raises:
        Failure: the reference cannot solve the scene.
        InputError: the output does not move.
    """
    uncertified = replace(found(scene), neighbours=neighbours(scene))
    return replace(uncertified, floor=certified(uncertified, channels, runs))


def certified(reference: Reference, channels: frozenset[str] | None = None, runs: Runs = runner) -> Floor:
    """Return the floor of a reference, measured at a few positions of one cycle.

    Args:
        reference: without a floor.
        channels: those to certify; None for all.
        runs: what runs arbitrary precision.
    """
    scene, sampling = reference.scene, Sampling(FLOOR_SAMPLES, channels=channels)
    explained = explain(reference, sampling)
    own = reference.at(sampling.commanded(scene), sampling.times(scene))
    settings = registry.engine(registry.REFERENCE).DEFAULT
    core = assess(reference, sampling, Run(registry.REFERENCE, settings, Status.ok, motion=own), explained)
    oracle = assess(reference, sampling, runs.run(registry.ORACLE, scene, sampling), explained)
    doubt = _doubt(core, oracle)
    if oracle.comparison is None:
        return Floor({}, f"not certified: {oracle.run.reason}", doubt)
    where = f"{FLOOR_SAMPLES} {'angles' if units.turns_fully(scene) else 'instants'}"
    by = f"{registry.ENTRIES[registry.ORACLE].version} at {where} a {units.cycle_name(scene)}"
    floor = {channel: float(error.max()) for channel, error in oracle.comparison.commanded.items()}
    worst = max(floor, key=floor.__getitem__)
    limit = "" if floor[worst] <= settings.promise else f", all that doubles leave of {worst}: {explained.why(worst)}"
    return Floor(floor, by, doubt, limit)


def _doubt(core: Measurement, oracle: Measurement) -> str:
    """Return why the reference is not to be believed, with whom to suspect; or nothing.

    The checks are a third opinion. They take the scene's laws and loads as all models but arbitrary precision do.
    """
    if any(check.check == "drive" and not check.worst <= DRIVE for check in core.checks):  # it is where it was put
        return f"the scene's drive contradicts itself, suspect the scene's layer: {core.run.reason}"
    if core.run.status is not Status.ok:
        return f"the core contradicts itself, suspect the core: {core.run.reason}"
    if oracle.run.status is Status.ok or oracle.run.status in NO_ANSWER:
        return ""
    if oracle.run.found_by == "checks":
        return f"arbitrary precision alone differs, suspect the scene's laws, tables and loads: {oracle.run.reason}"
    return f"the core and arbitrary precision differ, suspect the core: {oracle.run.reason}"
