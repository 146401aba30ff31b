"""Tables and sentences of what the tolerances of the workshop do: for the terminal, the page and the files."""

from collections.abc import Iterator, Mapping
from math import isnan, nan, sqrt

import numpy as np

from scenes import numbers_in

from ...engines.registry import REFERENCE
from ...judge.peaks.numbers import AT_JOINTS
from ...measure.many.study import MonteCarlo, Spread
from ...mechanics.axis import cycle_name, grouped
from ..numbers import Units, capital, percent, units, written
from . import TableRows
from .family import names
from .proof import UNKNOWN

DIGITS = 3  # of a difference of a number
LINEAR_TOL = 0.05  # relative: a linear model's standard deviation that is off by more misleads
MAX_MACHINES = 20  # that the JSON file has in full, picked by the seed


def in_si(study: MonteCarlo) -> TableRows:
    """Yield a row a number with everything that is known about it, in SI."""
    for s in study.spreads:
        named = {"name": s.name, "of": s.of, "unit": s.unit, "nominal": s.nominal, "mean": s.mean}
        sizes = {"standard deviation": s.deviation, "linear standard deviation": s.linear, "unexplained": s.unexplained}
        quantiles = {f"quantile {share}": value for share, value in s.quantiles.items()}
        shares = {f"share of {path}": share for path, share in s.shares.items()}
        differ = {f"{engine} differs by": size for engine, size in differences(study, s).items()}
        yield {**named, **sizes, **quantiles, **shares, **differ}


def differences(study: MonteCarlo, number: Spread) -> Mapping[str, float]:
    """How far each engine is off a number on the linkage as drawn, SI; NaN where it has none."""
    engines = [m.run.engine for m in study.judged.measurements if m.run.engine != REFERENCE]
    differs = next((peak.differs for peak in study.judged.peaks if peak.name == number.name), {})
    return {engine: differs.get(engine, nan) * number.size for engine in engines}


def summary(study: MonteCarlo) -> dict[str, object]:
    """What the JSON file has: the numbers, what varies, some machines in full by which others can check."""
    picked = np.sort(
        np.random.default_rng(study.seed).choice(study.asked, min(MAX_MACHINES, study.asked), replace=False)
    )
    numbers = [s.name for s in study.spreads]
    return {
        **{"machines": study.count, "running": study.running, "seed": study.seed},
        "variations": study.scene.variations,
        "numbers": [{**vars(s), "differs": differences(study, s)} for s in study.spreads],
        "enclosed": study.enclosed,
        "yield": dict(zip(("met", "low", "high"), study.met, strict=True)) if study.scene.limits else None,
        "failures": study.failures,
        "worst": None if study.worst is None else {"machine": study.worst[0], "number": study.worst[1].name},
        "picked": [
            {"machine": machine, "changes": study.changes(machine)}
            | {"numbers": dict(zip(numbers, study.values[machine], strict=True))}
            for machine in picked.tolist()
        ],
    }


def shown_units(study: MonteCarlo) -> Units:
    """Units of the page: those of the linkage as drawn."""
    return units(study.judged.reference)


def moving(study: MonteCarlo) -> list[Spread]:
    """The numbers that differ among the machines."""
    return [s for s in study.spreads if s.deviation > 0]


def overview(study: MonteCarlo) -> TableRows:
    """Yield a row a number: the drawing's, and how far the machines are off that."""
    for s in moving(study):
        drawn = {"number": capital(s.name), "as drawn": written(s.nominal, s.unit, shown_units(study))}
        deviations = {"standard deviation": _amount(study, s, s.deviation), "linear": _amount(study, s, s.linear)}
        error = {"the linear model is off by": percent(sqrt(s.unexplained))}
        mean = {"mean": _amount(study, s, s.mean - s.nominal, "+")}
        quantiles = {f"{100 * float(q):g} %": _amount(study, s, v - s.nominal, "+") for q, v in s.quantiles.items()}
        yield {**drawn, **deviations, **error, **mean, **quantiles}


def _amount(study: MonteCarlo, number: Spread, value: float, sign: str = "") -> str:
    """A difference of a number, to three digits, on one line."""
    return written(value, number.unit, shown_units(study), digits=DIGITS, sign=sign).replace(" ", "\u00a0")


def enclosed(study: MonteCarlo) -> TableRows:
    """Yield a row a pin: its largest force on the machines drawn, and on all that may be made, where proven."""
    for k, (s, number) in enumerate(zip(study.spreads, study.numbers, strict=True)):
        if number.kind == AT_JOINTS["reaction"] and s.deviation > 0 and (row := study.enclosed.get(s.of)):
            drawn, made = study.values[s.largest, k] - s.nominal, row.high - s.nominal
            shown = {"number": capital(s.name), "as drawn": written(s.nominal, s.unit, shown_units(study))}
            shown |= {"largest drawn": _amount(study, s, drawn, "+")}
            known = made <= s.nominal  # a bound that is farther off than the force is large is none
            shown |= {"no machine above": _amount(study, s, made, "+") if known else UNKNOWN}
            yield shown | {"over the largest drawn": f"{made / drawn:.2f}" if known else "–"}


def shares(study: MonteCarlo) -> TableRows:
    """Yield a row a number with the share of its variance that each variation has."""
    named = names(study.scene.variations)
    for s in moving(study):
        shares = (f"{100 * share:.1f} %" for share in s.shares.values())
        yield {"number": capital(s.name), **dict(zip(named, shares, strict=True))}


def against_engines(study: MonteCarlo) -> TableRows:
    """Yield a row a number: by how much the engines differ on the linkage as drawn, and the machines do."""
    for s in moving(study):
        named = {"number": capital(s.name), "the machines' standard deviation": _amount(study, s, s.deviation)}
        sizes = differences(study, s)
        differ = {f"{engine} differs by": _amount(study, s, size) for engine, size in sizes.items()}
        yield (
            named
            | differ
            | {f"{engine}, of the deviation": percent(size / s.deviation) for engine, size in sizes.items()}
        )


def worst(study: MonteCarlo, machine: int) -> TableRows:
    """Yield how far each number of the file is off the drawing on one machine."""
    here = study.changes(machine)
    drawn = zip(study.scene.variations, here.values(), numbers_in(study.scene, [*here]), strict=True)
    for v, value, number in drawn:
        share = f"{100 * (value - number) / v.plus_minus:+.0f} %".replace("-", "−")
        numbers = {"as drawn": f"{number:.7g}", "here": f"{value:.7g}"}
        yield {"number of the file": v.path, **numbers, "of what is allowed": share}


def failures(study: MonteCarlo) -> TableRows:
    """Yield why machines do not run, and how many."""
    for f in study.failures:
        count = {"machines": grouped(f.count), "of all": percent(f.count / study.count)}
        yield {**count, "status": f.status, "reason, of the first": f.reason, "the first": grouped(f.first)}


# --- sentences -------------------------------------------------------------------------------------------------------


def ran(study: MonteCarlo) -> str:
    """How many machines were drawn, and how many of them run."""
    stopped = "" if study.complete else f"Stopped after {grouped(study.count)} of {grouped(study.asked)} machines. "
    return f"{stopped}{grouped(study.running)} of {grouped(study.count)} machines run, drawn with seed {study.seed}."


def setup(study: MonteCarlo) -> str:
    """What varies."""
    varied = study.scene.variations
    uniform = sum(v.distribution == "uniform" for v in varied)
    kinds = f"{len(varied) - uniform} by normal distributions, {uniform} by uniform ones"
    return f"{len(varied)} numbers of the scene vary, {kinds}: {', '.join(names(varied))}."


def verdicts(study: MonteCarlo) -> Iterator[str]:
    """Yield the yield, how well the linear model predicts the spread, and how engines' differences compare with it."""
    if study.scene.limits:
        count, low, high = study.met
        machines = f"machines ({grouped(count)} of {grouped(study.count)})"
        share = f"{100 * count / study.count:.4g} % of the {machines} meet all limits"
        share += f" over the first {cycle_name(study.scene)}" if study.judged.sampling.turns > 1 else ""
        yield f"Yield: {share}; with 95 % confidence {100 * low:.4g} to {100 * high:.4g} %."
    shown = moving(study)
    bends = {s.name: abs(s.linear / s.deviation - 1) for s in shown}
    # A sampled standard deviation is itself uncertain by 1 / sqrt(2 N) of it, of a normal distribution. Only what is
    # off by three times that, and by the tolerance besides, is called bent.
    bent = [name for name, share in bends.items() if share > LINEAR_TOL + 3 * sqrt(0.5 / study.count)]  # beyond chance
    if bent:
        listed = ", ".join(f"{name} (off by {percent(bends[name])})" for name in bent)
        yield f"Tolerances do not add up linearly for {listed}: take the standard deviation of the machines drawn."
    elif shown:
        most = percent(max(bends.values()))
        yield f"Adding the tolerances up linearly gives each standard deviation to within {most}."
    for engine in (m.run.engine for m in study.judged.measurements):
        ratios = [(differences(study, s).get(engine, nan) / s.deviation, s.name) for s in shown]
        known = [ratio for ratio in ratios if not isnan(ratio[0])]
        if known:
            largest, name = max(known, key=lambda ratio: ratio[0])
            span = f"{percent(min(known)[0])} to {percent(largest)} of what the tolerances do to the same number"
            yield f"{engine} differs from the reference by {span}; the most at the {name}."
