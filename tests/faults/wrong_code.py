"""One wrong line in the core, in what all models share of the scene, or in the comparison itself; each in a worker."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from sys import getprofile, setprofile
from types import FrameType, SimpleNamespace
from typing import TypeAlias, cast

import numpy as np

from compare.engines import registry
from compare.engines.processes.inside import Ended, Limits
from compare.engines.processes.isolation import isolated
from compare.engines.registry import REFERENCE
from compare.engines.runner import Run, Runs, run
from compare.judge.agreement import Judgement
from compare.judge.canaries.canaries import canaries
from compare.judge.canaries.noticed import CLEAR_ERROR
from compare.judge.canaries.spoilt_motion import shifted
from compare.judge.causes.cause import Kind
from compare.judge.floor import establish
from compare.judge.judgement import judgement
from compare.judge.measure import Standard, assess, gates, missed, offers
from compare.mechanics.reference import uncertified
from compare.mechanics.round_off import explain
from scenes import Motion, Settings, Status, load
from scenes.channels import named
from scenes.model.inputs import passing

from .catalogue import catalogue
from .fault import Clean, Fault, above
from .mutants import Mutant, applied, mutants
from .table import SAMPLING, Record

CORE = (
    *("core.dyads", "core.placing", "core.kinematics", "core.kinetostatics"),
    *("core.groups.group_equations", "core.groups.newton_group", "channels"),
)
SHARED = {
    "scenes.elements.loads": (),
    "scenes.drive": ("ConstantSpeed.after", "ConstantSpeed.at", "MotionLaw.at", "MotionLaw._trend"),
    "scenes.laws": ("Law.after",),
}
COMPARISON = {
    "compare.judge.measure": ("assess", "Gate.missed", "gates", "missed"),
    "compare.judge.verdict": ("limits", "judged", "compared"),
    "compare.judge.errors": ("compare", "error_table", "worst_of"),
    "compare.judge.checks": ("checks", "_off", "_gaps", "_balances", "_newton_euler", "_peaks", "_flips"),
    "compare.mechanics.elements": ("inertial", "power_of"),
    "compare.mechanics.round_off": ("Explained.left_over", "Explained.error"),
    "compare.engines.runner": ("complete", "_check_complete", "_check_rows"),
    "compare.mechanics.scales": ("relative_errors", "sizes", "apart", "force_scales", "_kinematic"),
}
FAULTS = 25  # of each engine's motion, that a comparison with a wrong line is tried with
ROUNDING = 10  # times what doubles explain: the core's limit, besides its promise
LIMITS = Limits(seconds=60.0)

Item: TypeAlias = tuple[Mutant, str]  # and the name of a scene


def core_faults(scenes: Sequence[str], count: int, poll: Callable[[], None]) -> Iterator[Record]:
    """Yield wrong lines of the analytic core that its solution of the scenes passes, evenly spread over its modules."""
    for name in scenes:
        called = _called(name)
        lines = [one for module in CORE for one in mutants(f"analytic.{module}") if one.function in called]
        items = [(one, name) for one in _sample(lines, count // len(scenes))]
        yield from _records(partial(_judged, "core"), items, poll)


def _called(name: str) -> set[str]:
    """Return the names of the core's functions that are called where it solves a scene."""
    scene, called = load(name), set[str]()

    def note(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and frame.f_globals.get("__name__", "").startswith("analytic."):
            called.add(frame.f_code.co_qualname)

    before = getprofile()
    setprofile(note)
    try:
        registry.reference(scene)(SAMPLING.inputs(scene))
    finally:
        setprofile(before)
    return called


def shared_faults(scenes: Sequence[str], poll: Callable[[], None]) -> Iterator[Record]:
    """Yield wrong lines of loads and drives, which all models take from the scene, on each of the scenes."""
    lines = [one for module, functions in SHARED.items() for one in mutants(module, functions)]
    yield from _records(partial(_judged, "shared"), [(one, name) for name in scenes for one in lines], poll)


def comparison_faults(scene: str, count: int, poll: Callable[[], None]) -> Iterator[Record]:
    """Yield wrong lines of what judges a run; found are those that the canaries notice."""
    lines = _sample([one for module, functions in COMPARISON.items() for one in mutants(module, functions)], count)
    yield from _records(_canaried, [(one, scene) for one in lines], poll)


def _sample(found: Sequence[Mutant], count: int) -> list[Mutant]:
    """Return some of the mutants, evenly spread."""
    return [found[number] for number in sorted({*np.linspace(0, len(found) - 1, count).astype(int)})]


def _records(
    judge: Callable[[Item], Record | None], items: Sequence[Item], poll: Callable[[], None]
) -> Iterator[Record]:
    """Yield a record of each wrong line that is run at all; one whose worker ended is found."""
    for (mutant, scene), outcome in isolated(judge, items, LIMITS, poll):
        if isinstance(outcome, Ended):
            family = "core" if mutant.module.startswith("analytic") else "shared"
            yield _record(family, mutant, scene, True, True, outcome.status.name, REFERENCE, outcome.reason)
        elif outcome is not None:
            yield outcome


def _record(
    family: str, mutant: Mutant, scene: str, is_above: bool, found: bool, by: str, place: str, blamed: str
) -> Record:
    """Return a record; its cause is named where code is blamed, in these words."""
    true_place = {"core": REFERENCE, "shared": "scene"}.get(family, family)
    where = f"{mutant.module}.{mutant.function}: {mutant.line}" + f" ({blamed})" * bool(blamed)
    causes = place, str(Kind.code if blamed else Kind.unknown), true_place, str(Kind.code)
    return Record(family, mutant.kind, 1.0, scene, REFERENCE, is_above, found, by, *causes, where)


def _judged(family: str, item: Item) -> Record | None:
    """Judge a scene by a core, or with a scene layer, that has a wrong line."""
    mutant, name = item
    clean, fault = _clean(name), Fault(family, mutant.kind, 1.0, Kind.code, mutant.function)
    with applied(mutant):
        try:
            inputs = passing(clean.scene, clean.sampling.commanded(clean.scene), clean.true["time"])
            wrong = registry.reference(clean.scene)(inputs)
        except Exception:
            wrong = Motion({})
        is_above = wrong.samples.keys() < clean.true.samples.keys() or above(fault, clean, wrong)
        try:
            judged = judgement(establish(clean.scene), registry.DEFAULT_ENGINES, SAMPLING, _offers, lambda _: None)
        except Exception as error:
            by = f"{type(error).__name__}: {error}"
            return _record(family, mutant, name, is_above, True, by, REFERENCE, "the reference cannot solve the scene")
    failed = [engine for engine, (status, _) in judged.verdicts.items() if status != Status.ok.name]
    doubt = judged.reference.floor.doubt
    place = REFERENCE if doubt or REFERENCE in failed else ", ".join(failed)
    return _record(family, mutant, name, is_above, not judged.ok, ", ".join(failed), place, doubt)


def _offers(engine: str) -> tuple[Sequence[Settings], str]:
    return offers(engine, "balanced"), ""


@cache
def _clean(name: str) -> Clean:
    """Return the core's own run of a scene, held to what doubles explain."""
    reference = uncertified(load(name))
    explained = explain(reference, SAMPLING)
    core = run(REFERENCE, reference.scene, SAMPLING)
    assert core.settings is not None
    limit = core.settings.promise + ROUNDING * max(float(np.max(error)) for error in explained.sensitivity.values())
    clean = Clean(reference, SAMPLING, replace(core, settings=replace(core.settings, promise=limit)))
    assert clean.true.samples  # solved while all lines are right
    return clean


@cache
def _to_be_refused(name: str) -> tuple[Judgement, tuple[Run, ...]]:
    """Return a scene's judgement, and spoilt runs that it refuses: by large faults, and barely beyond what may be."""
    clean = judgement(uncertified(load(name)), registry.DEFAULT_ENGINES, SAMPLING, _offers, lambda _: None)
    spoilt = []
    for measured in clean.measurements:
        of = Clean(clean.reference, SAMPLING, measured.run)
        faults = [fault for fault in catalogue(of) if fault.spoil is not None]
        motions = [fault.spoil() for fault in faults[:: max(len(faults) // FAULTS, 1)] if fault.spoil]
        allowed = clean.scene.tolerances.get(measured.run.engine, {})
        for channel in of.channels[:: max(len(of.channels) // FAULTS, 1)]:
            for most in {of.promise, allowed.get(named(channel).group, of.promise)}:
                motions.append(shifted(of.motion, {channel: CLEAR_ERROR * most * of.size(channel).max()}))
        spoilt += [replace(measured.run, motion=motion) for motion in motions]
    return clean, tuple(one for one in spoilt if not _passes(clean, one))


def _canaried(item: Item) -> Record | None:
    """Judge by a comparison with a wrong line: it is above where it lets a fault through or refuses a clean run.

    The line is wrong from the start, as on the command line: in the reference's scales too.
    """
    mutant, name = item
    right, spoilt = _to_be_refused(name)
    runs = {m.run.engine: m.run for m in right.measurements}
    with applied(mutant):
        try:
            wrong = judgement(uncertified(right.scene), [*runs], SAMPLING, _offers, lambda _: None, known(runs))
            refused, noticed = bool(wrong.misses), "; ".join([*wrong.missed, *canaries(wrong)])
            is_above = refused or any(_passes(wrong, one) for one in spoilt)
        except Exception as error:  # which no user can overlook
            is_above, noticed = True, f"{type(error).__name__}: {error}"
    place = "comparison" * bool(noticed)
    return _record("comparison", mutant, name, is_above, bool(noticed), "canaries", place, noticed)


def known(runs: Mapping[str, Run]) -> Runs:
    """Return what stands in for engines whose runs are known, whatever their settings."""
    return cast("Runs", SimpleNamespace(run=lambda name, *_: runs[name]))


def _passes(wrong: Judgement, outcome: Run) -> bool:
    """Return whether nothing stops a CI run; a comparison that crashes stops one."""
    try:
        judged = assess(Standard(wrong.reference, SAMPLING, wrong.explained), outcome)
        return not missed([judged], gates(wrong.scene, [judged]))
    except Exception:
        return False
