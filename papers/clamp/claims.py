"""Double-toggle clamp: all claims of its source, by the reference's loops and by the engines; and its pictures."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from compare.engines import registry
from compare.engines.runner import run
from compare.report.figures.figure import Figure, draw, stacked
from compare.report.figures.style import colour, layout, marker
from scenes import Failure, Motion, Sampling, Scene, load
from scenes.elements.loads import Force

from ..claims import Claim, comparison, judge, largest
from ..written import Symbols
from .equations import EQUATIONS, KINDS, VELOCITY_RATIO, moving, scale
from .formulas import PUBLISHED, acceleration, at, platen_stroke, velocity_ratio
from .limits import constraints, largest_force_ratio
from .printed import SCENES, TABLE_1, TABLE_2
from .tables import SPEED, corners, measured, table_1, table_2

SOURCE = "double-toggle clamp"
ENGINES = ("exudyn", "pymunk")
FORCE = 1e5  # N, against the platen: far above its inertia, and no more than what pymunk's sweeps can settle
SAMPLES, ENGINE_SAMPLES = 720, 120


def claims() -> Iterator[Claim]:
    """Every row of this source, by the reference."""
    v = over_strokes(lambda scene: registry.motion(scene, Sampling(SAMPLES)))
    for equation in EQUATIONS:
        yield judge(equation, v, scale(v))
    designs = {name: corners(name) for name in TABLE_2}
    yield from table_1(designs)
    yield from table_2(designs)
    for name, known in designs.items():
        yield from constraints(name, known)
    yield largest_force_ratio()
    yield from measured(designs["scheme 4"])


def by_engines(report: Callable[[str], None]) -> Iterator[Claim]:
    """A row for each formula by each engine; engines that cannot run are reported through `report`."""
    for engine in ENGINES:
        try:
            yield from list(_by_engine(engine))
        except Failure as failure:
            report(f"No row by {engine}: {failure.status.name}: {failure.reason}.")


def _by_engine(engine: str) -> Iterator[Claim]:
    """A row for each formula on an engine's own motion at its default settings, to the scenes' tolerances of it."""

    def solve(scene: Scene) -> Motion:
        result = run(engine, scene, Sampling(ENGINE_SAMPLES))
        if result.motion is None:
            raise Failure(result.status, result.reason)
        return result.motion

    # An engine is not exact: its rows are held to the tolerance that the shipped scenes declare for it, by the channel
    # group of the quantity, and to the looser of the two designs' tolerances.
    v = over_strokes(solve)
    tolerances = [load(name).tolerances[engine] for name in SCENES.values()]
    for equation in EQUATIONS:
        if equation.claim != "eq R_S":  # the ratio of the two strokes below; near the lock it is of nothing by nothing
            tolerance = max(group[KINDS[equation.kind][0]] for group in tolerances)
            row = judge(equation, v, scale(v), tolerance)
            yield replace(row, claim=f"{row.claim}, {engine}", note=f"to {engine}'s tolerance of {tolerance:.0e}")
    ratio, way = v["v_m"] / v["V_o"], slice(ENGINE_SAMPLES, None)  # of scheme 4, the second
    open_ratio = float(v["S_m"][way][0] / v["S_o"][way][0])
    deviation = largest(VELOCITY_RATIO.printed(v))
    yield comparison(
        f"simulated R_V, as ADAMS, {engine}",
        "within 1.2 %",
        [deviation <= 0.012],
        f"within {100 * deviation:.1e} %; scheme 4: R_S {open_ratio:.5f}, R_V max {ratio[way].max():.4f}",
        "of v_o, at default settings; the formula is exact, and 1.2 % are far more than an integration leaves",
    )


def over_strokes(solve: Callable[[Scene], Motion]) -> Symbols:
    """The clamp's symbols over the strokes of both designs, one after the other."""
    parts = []
    for name, d in PUBLISHED.items():
        scene = load(SCENES[name])
        loaded = replace(scene, loads=(Force("platen", "C", (-FORCE, 0.0)),))
        # The force ratio is that of a force on the platen alone. The clamp is solved with and without that force and
        # the drive's forces are subtracted, so that inertia cancels.
        parts.append(moving(scene, d, solve(loaded), solve(replace(scene, loads=())), FORCE))
    return {symbol: np.concatenate([part[symbol] for part in parts]) for symbol in parts[0]}


def figures() -> Iterator[tuple[str, str, Figure]]:
    """Yield title, note and figure of every picture."""
    ratios, accelerations = stacked(), stacked()
    for number, (name, d) in enumerate(PUBLISHED.items()):
        pose = at(d, d.alpha_max * np.linspace(1, 0, 361))
        ratio, left = velocity_ratio(pose), platen_stroke(pose)
        way, line = left[0] - left, {"color": colour(number), "width": 1.8}
        draw(ratios, name, way, ratio, line=line)
        printed = [float(TABLE_1[row][name]) for row in ("R_V max", "R_V startup")]
        there, circle = way[[int(ratio.argmax()), 0]], marker(number, "circle-open", 9)
        draw(ratios, f"{name}, printed", there, printed, mode="markers", marker=circle)
        draw(accelerations, name, way, acceleration(pose, SPEED), line=line | {"dash": "solid"})
        misprinted = acceleration(pose, SPEED, printed=True)
        draw(accelerations, f"{name}, as printed", way, misprinted, line=line | {"dash": "dot"})
    for figure in (ratios, accelerations):
        figure.update_xaxes(title="way of the platen from open [mm]")
    yield (
        "Clamp: velocity ratio over the stroke",
        "From open to locked. Circles: the printed peaks and startup values, where the computed ones are.",
        ratios.update_yaxes(title="R_V = v_m / v_o [-]", rangemode="tozero").update_layout(layout(480)),
    )
    yield (
        "Clamp: acceleration of the platen over the stroke",
        f"At an assumed {SPEED:g} mm/s of the crosshead. Solid: the corrected formula; dotted: as printed.",
        accelerations.update_yaxes(title="a_m [mm/s²]").update_layout(layout(480)),
    )
