"""Double-toggle clamp: its formulas against the closed loop, which the reference solves, and against the engines."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, replace

import numpy as np

from compare.engines import registry
from compare.engines.runner import run
from scenes import Failure, Motion, Sampling, Scene, load
from scenes.loads import Force

from ..claims import Claim, judge, worst
from .designs import design
from .equations import EQUATIONS, velocity_ratio
from .limits import constraints
from .tables import measured, simulated, table_1, table_2
from .variables import DESIGNS, SCENES, SOURCE, Moving, moving

ENGINES = ("exudyn", "pymunk")
FORCE = 1e5  # N, against the platen: far above its inertia, and no more than what pymunk's sweeps can settle
SAMPLES, ENGINE_SAMPLES = 720, 120
GROUPS: Mapping[str, str] = {
    "length": "position",
    "ratio": "velocity",
    "rate": "velocity",
    "rate²": "acceleration",
    "acceleration": "acceleration",
    "force ratio": "torque",
}  # of the scenes' tolerances, by kind of formula


def claims() -> Iterator[Claim]:
    """Yield every row of this source, by the reference."""
    v = over_strokes(_by_reference)
    for equation in EQUATIONS:
        yield judge(SOURCE, equation, v, _scale(v))
    designs = {name: design(name) for name in DESIGNS}
    yield from table_1(designs)
    yield from table_2(designs)
    for name, known in designs.items():
        yield from constraints(name, known)
    yield from measured(designs["scheme 4"])


def by_engines(tell: Callable[[str], None]) -> Iterator[Claim]:
    """Yield a row for each formula by each engine; `tell` is told of engines that cannot run."""
    for engine in ENGINES:
        try:
            rows = list(_by_engine(engine))
        except Failure as failure:
            tell(f"No row by {engine}: {failure.status.name}: {failure.reason}.")
            continue
        yield from rows


def _by_engine(engine: str) -> Iterator[Claim]:
    """Yield a row for each formula on an engine's own motion at its default settings, to the scenes' tolerances of it.

    Raises:
        Failure: the engine cannot run.
    """

    def solve(scene: Scene) -> Motion:
        result = run(engine, scene, Sampling(ENGINE_SAMPLES))
        if result.motion is None:
            raise Failure(result.status, result.reason)
        return result.motion

    v = over_strokes(solve)
    tolerances = [load(name).tolerances[engine] for name in SCENES.values()]
    for equation in EQUATIONS:
        if equation.claim != "eq R_S":  # the ratio of the two strokes below; near the lock it is of nothing by nothing
            tolerance = max(group[GROUPS[equation.kind]] for group in tolerances)
            row = judge(SOURCE, equation, v, _scale(v), tolerance)
            yield replace(row, claim=f"{row.claim}, {engine}", note=f"to {engine}'s tolerance of {tolerance:.0e}")
    ratio, way = v.vm / v.Vo, slice(ENGINE_SAMPLES, None)  # of scheme 4, the second
    open_ratio = float(v.Sm[way][0] / v.So[way][0])
    yield simulated(engine, worst(ratio - velocity_ratio(v)), open_ratio, float(ratio[way].max()))


def over_strokes(solve: Callable[[Scene], Motion]) -> Moving:
    """Return the clamp's variables over the strokes of both designs, one after the other."""
    parts = []
    for name, printed in DESIGNS.items():
        scene = load(SCENES[name])
        loaded = replace(scene, loads=(Force("platen", "C", (-FORCE, 0.0)),))
        values = {variable: float(text) for variable, text in printed.items()}
        parts.append(moving(scene, values, solve(loaded), solve(replace(scene, loads=())), FORCE))
    return Moving(*(np.concatenate([getattr(p, field.name) for p in parts]) for field in fields(Moving)))


def _by_reference(scene: Scene) -> Motion:
    sampling = Sampling(SAMPLES)
    return registry.reference(scene)(sampling.commanded(scene), sampling.times(scene))


def _scale(v: Moving) -> Mapping[str, tuple[float, str]]:
    """Return scale and unit of each kind of formula: L1, V_o and their products."""
    length, speed = float(v.L1.max()), float(v.Vo.max())
    return {
        "length": (length, "m"),
        "ratio": (1.0, ""),
        "force ratio": (1.0, ""),
        "rate": (speed / length, "rad/s"),
        "rate²": ((speed / length) ** 2, "rad/s²"),
        "acceleration": (speed**2 / length, "m/s²"),
    }
