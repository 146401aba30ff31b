"""Where engines are stable: status and error over two parameters, cell by cell.

| map | across | up |
|---|---|---|
| `sweeps` | sweeps in each step, of an engine that iterates there | steps a cycle |
| `lock` | scenes ever closer to a lock | steps a cycle |
| `mass` | by what the heaviest body's mass is multiplied | steps a cycle |
| `drift` | cycles of the drive; the error is that of positions in the last one | steps a cycle |

An engine has maps if it has time steps (`at_steps` of its protocol), and the first of them if these iterate and theory
has an answer to how many sweeps they need (`iterations_needed`).
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import TypeAlias

import numpy as np
import pandas as pd

from scenes import Failure, InputError, Sampling, Scene, Settings, Status
from scenes.numbers import At, put

from ...engines import registry
from ...engines.outside import check_settings, stand_in
from ...engines.processes.inside import Ended
from ...engines.processes.stopping import kept
from ...engines.processes.workers import workers
from ...engines.reasons import described
from ...engines.runner import HERE, Runs
from ...judge.floor import establish
from ...judge.measure import Measurement, checked_run, measure
from ...mechanics.mechanics import SHOWN_GROUPS
from ...mechanics.reference import Reference

SAMPLES = 24  # a cycle
STEPS = (24, 72, 216, 648, 1944)  # a cycle, multiples of the samples
FEWER_STEPS = STEPS[:-1]  # of long runs
SWEEPS = (2, 4, 8, 16, 32, 64, 128, 256, 512)
MASS_FACTORS = (1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3)
TURNS = (1, 3, 10, 30, 100)

Variant: TypeAlias = tuple[str, Scene]
Cell: TypeAlias = dict[str, object]
Progress: TypeAlias = Callable[[str], None]
Counts: TypeAlias = Sequence[int]


@dataclass(frozen=True)
class Place:
    """Where a cell is on its map: `label` is what it is called across, at `x`."""

    map: str
    engine: str
    x: float
    label: str
    steps: int


def stability_table(
    scene: Scene, engines: Iterable[str], to_lock: Sequence[Variant], progress: Progress
) -> pd.DataFrame:
    """All maps of a scene, one row a cell; a stop keeps what is done.

    `to_lock` are scenes ever closer to a lock; their labels are numbers. `error` is the largest relative error, NaN
    where none is known; `needed` how many sweeps theory asks for, in the map of sweeps alone.

    Raises:
        InputError: the reference cannot solve the scene.
    """
    able = [engine for engine in engines if registry.engine(engine).at_steps]
    if not able:
        return pd.DataFrame()
    with workers([*able, registry.ORACLE], lambda: None) as runs:
        return pd.DataFrame([*kept(_cells(scene, able, to_lock, progress, runs))])


def _cells(
    scene: Scene, able: Sequence[str], to_lock: Sequence[Variant], progress: Progress, runs: Runs
) -> Iterator[Cell]:
    reference = establish(scene, runs=runs)
    for engine in able:
        if registry.engine(engine).iterations_needed:
            yield from over_sweeps(reference, engine, progress, runs=runs)
    yield from over_variants("lock", to_lock, able, progress, runs=runs)
    if scene.has_masses:
        yield from over_variants("mass", heavier(scene), able, progress, runs=runs)
    for engine in able:
        yield from over_turns(reference, engine, progress, runs=runs)


def over_sweeps(
    reference: Reference,
    engine: str,
    progress: Progress,
    sweeps: Counts = SWEEPS,
    all_steps: Counts = STEPS,
    runs: Runs = HERE,
) -> Iterator[Cell]:
    """Yield steps a cycle against sweeps a step, with how many sweeps theory asks for."""
    for steps in all_steps:
        known = runs.asked(engine, reference.scene, partial(_needed, engine, reference.scene, steps))
        needed, fault = (np.nan, f"iterations_needed: {known.reason}") if isinstance(known, Ended) else known
        for number in sweeps:
            progress(f"stability of {engine}: {number} sweeps, {steps} steps")
            place = Place("sweeps", engine, number, str(number), steps)
            cell = _crashed(place, fault) if fault else _cell(place, reference, runs, sweeps=(number,))
            yield cell | {"needed": needed}


def over_variants(
    kind: str,
    variants: Sequence[Variant],
    engines: Sequence[str],
    progress: Progress,
    all_steps: Counts = STEPS,
    runs: Runs = HERE,
) -> Iterator[Cell]:
    """Yield steps a cycle against scenes, whose labels are numbers."""
    for label, scene in variants:
        reference: Reference | Scene
        try:
            reference = establish(scene, runs=runs)
        except InputError:  # nothing to compare with; whether the engine notices is to be seen all the same
            reference = scene
        for engine in engines:
            for steps in all_steps:
                progress(f"stability of {engine}: {kind} {label}, {steps} steps")
                place = Place(kind, engine, float(label), label, steps)
                yield _cell(place, reference, runs)


def over_turns(
    reference: Reference,
    engine: str,
    progress: Progress,
    turns: Counts = TURNS,
    all_steps: Counts = FEWER_STEPS,
    runs: Runs = HERE,
) -> Iterator[Cell]:
    """Yield steps a cycle against cycles; the error is that of positions in the last cycle. None of a single stroke."""
    for number in turns if reference.scene.drive.repeats else ():
        for steps in all_steps:
            progress(f"stability of {engine}: drift over {number}, {steps} steps")
            place = Place("drift", engine, number, str(number), steps)
            yield _cell(place, reference, runs, turns=number)


def heavier(scene: Scene, factors: Sequence[float] = MASS_FACTORS) -> list[Variant]:
    """The scene with its heaviest body lighter and heavier, by factor."""
    heaviest = max(scene.bodies.values(), key=lambda body: body.mass or 0.0)
    where = ("bodies", heaviest.name)
    variants = []
    for factor in factors:
        heavy: dict[At, float] = {(*where, "mass"): factor * (heaviest.mass or 0.0)}
        if heaviest.inertia is not None:
            heavy[*where, "inertia"] = factor * heaviest.inertia
        variants.append((f"{factor:g}", put(scene, heavy)))
    return variants


def _needed(engine: str, scene: Scene, steps: int) -> tuple[float, str]:
    """How many sweeps theory asks for, not a number where the engine cannot take the scene; and what failed."""
    try:
        module = registry.imported(engine)
        assert module.at_steps
        assert module.iterations_needed
        return float(module.iterations_needed(scene, module.at_steps(steps))), ""
    except Failure:
        return np.nan, ""
    except Exception as error:  # an engine's own fault is an outcome to report
        return np.nan, f"iterations_needed: {described(error)}"


def _at_steps(engine: str, *numbers: int) -> Settings | str:
    """The settings for that many steps a cycle and, if given, sweeps a step; or what failed."""
    try:
        module = registry.imported(engine)
        assert module.at_steps
        check_settings(settings := module.at_steps(*numbers))
    except Exception as error:
        return described(error)
    return stand_in(settings) if registry.ENTRIES[engine].outside else settings


def _cell(
    place: Place, reference: Reference | Scene, runs: Runs, *, sweeps: tuple[int, ...] = (), turns: int = 1
) -> Cell:
    """Run one cell; with a scene for reference there are no errors."""
    scene = reference if isinstance(reference, Scene) else reference.scene
    settings = runs.asked(place.engine, scene, partial(_at_steps, place.engine, place.steps, *sweeps))
    if not isinstance(settings, Settings):
        return _crashed(place, f"at_steps: {settings.reason if isinstance(settings, Ended) else settings}")
    sampling = Sampling(SAMPLES, turns)
    if isinstance(reference, Scene):
        measured = Measurement(checked_run(place.engine, reference, sampling, settings, runs), None, [])
    else:
        measured = measure(reference, place.engine, sampling, settings, runs=runs)
    worst = measured.worst()
    errors = {group: worst[group] for group in SHOWN_GROUPS if group in worst}
    last = measured.worst("last_turn_max").get("position", np.nan)
    return asdict(place) | {
        "setting": settings.label,
        "status": measured.run.status.name,
        "reason": measured.run.reason,
        "error": last if place.map == "drift" else max(errors.values(), default=np.nan),
        **{f"{group}_max": error for group, error in errors.items()},
        "solve_s": measured.run.solve_s,
    }


def _crashed(place: Place, reason: str) -> Cell:
    """The cell of an engine that failed before its run."""
    figures = {"error": np.nan, "solve_s": np.nan}
    return asdict(place) | {"setting": "", "status": Status.crashed.name, "reason": reason} | figures
