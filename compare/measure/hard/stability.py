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
from contextlib import suppress
from functools import partial
from itertools import product
from typing import Any, TypeAlias

import numpy as np
import pandas as pd

from scenes import Failure, InputError, Sampling, Scene, Settings, Status
from scenes.fields import put

from ...engines import registry
from ...engines.outside import Told, check_settings, stood_in, told
from ...engines.processes.inside import Ended
from ...engines.processes.stopping import Progress, kept
from ...engines.processes.workers import workers
from ...engines.reasons import described, text_of
from ...engines.runner import Runs
from ...judge.floor import establish
from ...judge.measure import Measurement, checked_run, measure
from ...mechanics.mechanics import SHOWN_GROUPS
from ...mechanics.reference import Reference

SAMPLES = 24  # a cycle
STEPS = (24, 72, 216, 648, 1944)  # a cycle, multiples of the samples, up a map
SWEEPS = (2, 4, 8, 16, 32, 64, 128, 256, 512)
MASS_FACTORS = (1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3)
TURNS = (1, 3, 10, 30, 100)

Variants: TypeAlias = Sequence[tuple[str, Scene]]
Cell: TypeAlias = dict[str, object]
Place: TypeAlias = tuple[str, str, str, int]  # the map, the engine, the number that it stands at across, and the steps


def stability_table(scene: Scene, engines: Iterable[str], to_lock: Variants, progress: Progress) -> pd.DataFrame:
    """All maps of a scene, one row a cell; a stop keeps what is done.

    `to_lock` are scenes ever closer to a lock; their labels are numbers. `error` is the largest relative error, NaN
    where none is known; `needed` how many sweeps theory asks for, in the map of sweeps alone. InputError where the
    reference cannot solve the scene.
    """
    able = [engine for engine in engines if registry.engine(engine).at_steps]
    if not able:
        return pd.DataFrame()

    def cells() -> Iterator[Cell]:
        reference = establish(scene, runs=runs)
        for engine in able:
            if registry.engine(engine).iterations_needed:
                yield from over_sweeps(reference, engine, progress, runs)
        yield from over_variants("lock", to_lock, able, progress, runs)
        if scene.has_masses:
            yield from over_variants("mass", heavier(scene), able, progress, runs)
        for engine in able:
            yield from over_turns(reference, engine, progress, runs)

    with workers([*able, registry.ORACLE], lambda: None) as runs:
        return pd.DataFrame([*kept(cells())])


def over_sweeps(reference: Reference, engine: str, show: Progress, runs: Runs) -> Iterator[Cell]:
    """Yield steps a cycle against sweeps a step, with how many sweeps theory asks for."""
    for steps in STEPS:
        known, why = _answer(runs, reference.scene, _needed, engine, reference.scene, steps)
        needed, fault = known if isinstance(known, float) else np.nan, why and f"iterations_needed: {why}"
        for number in SWEEPS:
            show(f"stability of {engine}: {number} sweeps, {steps} steps")
            cell = _cell(("sweeps", engine, str(number), steps), reference, runs, fault)
            yield cell | {"needed": needed}


def over_variants(kind: str, variants: Variants, engines: Sequence[str], show: Progress, runs: Runs) -> Iterator[Cell]:
    """Yield steps a cycle against scenes, whose labels are numbers."""
    for label, scene in variants:
        reference: Reference | Scene = scene
        with suppress(InputError):  # nothing to compare with; whether the engine notices is to be seen all the same
            reference = establish(scene, runs=runs)
        for engine, steps in product(engines, STEPS):
            show(f"stability of {engine}: {kind} {label}, {steps} steps")
            yield _cell((kind, engine, label, steps), reference, runs)


def over_turns(reference: Reference, engine: str, show: Progress, runs: Runs) -> Iterator[Cell]:
    """Yield steps a cycle against cycles; the error is that of positions in the last cycle. None of a single stroke."""
    for number, steps in product(TURNS if reference.scene.periodic else (), STEPS[:-1]):  # these runs are long
        show(f"stability of {engine}: drift over {number}, {steps} steps")
        yield _cell(("drift", engine, str(number), steps), reference, runs)


def heavier(scene: Scene) -> Variants:
    """The scene with its heaviest body lighter and heavier, by factor."""
    # Only the heaviest body's mass is changed: the ratio of masses decides how fast an iteration over joints converges,
    # while a common factor changes nothing.
    heaviest = max(scene.bodies.values(), key=lambda body: body.mass or 0.0).weighed
    scene = put(scene, {("bodies", heaviest.name): heaviest})
    inertial = {"mass": heaviest.mass or 0.0} | ({} if heaviest.inertia is None else {"inertia": heaviest.inertia})
    return [
        (
            f"{factor:g}",
            put(scene, {("bodies", heaviest.name, name): factor * value for name, value in inertial.items()}),
        )
        for factor in MASS_FACTORS
    ]


def _needed(engine: str, scene: Scene, steps: int) -> tuple[float, str]:
    """How many sweeps theory asks for, not a number where the engine cannot take the scene; and what failed."""
    try:
        module: Any = registry.imported(engine)
        return float(module.iterations_needed(scene, module.at_steps(steps))), ""
    except Failure:
        return np.nan, ""
    except Exception as error:  # an engine's own fault is an outcome to report
        return np.nan, described(error)


def _at_steps(engine: str, *numbers: int) -> tuple[Told | None, str]:
    """What is told of the settings for that many steps a cycle and, if given, sweeps a step; and what failed."""
    try:
        module: Any = registry.imported(engine)
        check_settings(settings := module.at_steps(*numbers))
        return told(settings), ""
    except Exception as error:
        return None, described(error)


def _answer(runs: Runs, scene: Scene, function: Callable[..., Any], engine: str, *more: object) -> tuple[Any, str]:
    """What an engine's own process answers, or None; and what failed, as any of it may."""
    known = runs.asked(engine, scene, partial(function, engine, *more))
    if isinstance(known, Ended):
        return None, known.reason
    with suppress(Exception):  # whatever it has sent
        answer, fault = known
        return answer, text_of(fault)
    return None, "its answer is none"


def _steps(engine: str, scene: Scene, runs: Runs, *numbers: int) -> tuple[Settings | None, str]:
    """The settings of `_at_steps`, or None; and what failed."""
    known, fault = _answer(runs, scene, _at_steps, engine, *numbers)
    try:
        return (None if fault else stood_in(known)), fault and f"at_steps: {fault}"
    except Exception as error:
        return None, f"at_steps: {described(error)}"


def _cell(place: Place, reference: Reference | Scene, runs: Runs, fault: str = "") -> Cell:
    """Run one cell; with a scene for reference there are no errors, and after a fault of the engine there is no run."""
    kind, engine, label, steps = place
    sweeps = [int(label)] if kind == "sweeps" else []
    scene = reference if isinstance(reference, Scene) else reference.scene
    cell: Cell = {"map": kind, "engine": engine, "x": float(label), "label": label, "steps": steps, "setting": ""}
    settings, reason = (None, fault) if fault else _steps(engine, scene, runs, steps, *sweeps)
    if settings is None:
        return cell | {"status": Status.crashed.name, "reason": reason, "error": np.nan, "solve_s": np.nan}
    sampling = Sampling(SAMPLES, int(label) if kind == "drift" else 1)
    if isinstance(reference, Scene):
        measured = Measurement(checked_run(engine, reference, sampling, settings, runs), None, [])
    else:
        measured = measure(reference, engine, sampling, settings, runs=runs)
    run, worst = measured.run, measured.worst()
    errors = {f"{group}_max": worst[group] for group in SHOWN_GROUPS if group in worst}
    last = measured.worst("last_turn_max").get("position", np.nan)
    error = last if kind == "drift" else max(errors.values(), default=np.nan)
    cell |= {"setting": settings.label, "status": run.status.name, "reason": run.reason, "error": error}
    return cell | errors | {"solve_s": run.solve_s}
