"""Tables and sentences of what the tolerances of the workshop do: for the terminal, the page and the files."""

from collections.abc import Iterator, Mapping
from math import isnan, nan, sqrt

import numpy as np
import pandas as pd

from scenes import numbers_in

from ...engines.axis import prefixed
from ...engines.registry import REFERENCE
from ...monte_carlo.spread import Spread
from ...monte_carlo.study import MonteCarlo
from ..family.tables import short_names
from ..numbers import percent, written
from ..units import Units, units

OFF = 0.05  # relative: a linear model's standard deviation that is off by more misleads
FEW = 20  # machines that the JSON file has in full, picked by the seed


def in_si(study: MonteCarlo) -> pd.DataFrame:
    """Return one row per number with everything that is known about it, in SI."""
    return pd.DataFrame(
        {"name": s.name, "of": s.of, "unit": s.unit, "nominal": s.nominal, "mean": s.mean}
        | {"standard deviation": s.deviation, "linear standard deviation": s.linear, "unexplained": s.unexplained}
        | {f"quantile {share}": value for share, value in s.quantiles.items()}
        | {f"share of {path}": share for path, share in s.shares.items()}
        | {f"{engine} differs by": size for engine, size in differences(study, s).items()}
        for s in study.spreads
    )


def differences(study: MonteCarlo, number: Spread) -> Mapping[str, float]:
    """Return how far each engine is off a number on the linkage as drawn, SI; NaN where it has none."""
    engines = [m.run.engine for m in study.judged.measurements if m.run.engine != REFERENCE]
    found = {peak.name: peak.differs for peak in study.judged.peaks}.get(number.name, {})
    return {engine: found.get(engine, nan) * number.size for engine in engines}


def summary(study: MonteCarlo) -> dict[str, object]:
    """Return what the JSON file has: the numbers, what varies, some machines in full by which others can check."""
    picked = np.sort(np.random.default_rng(study.seed).choice(study.asked, min(FEW, study.asked), replace=False))
    found = dict(zip((s.name for s in study.spreads), study.values[picked].T, strict=True))
    return {
        **{"machines": study.count, "running": study.running, "seed": study.seed},
        "variations": study.scene.variations,
        "numbers": [{**vars(s), "differs": differences(study, s)} for s in study.spreads],
        "failures": study.failures,
        "worst": None if study.worst is None else {"machine": study.worst[0], "number": study.worst[1].name},
        "picked": [
            {"machine": machine, "changes": study.changes(machine)}
            | {"numbers": {name: values[row] for name, values in found.items()}}
            for row, machine in enumerate(picked.tolist())
        ],
    }


def named_units(study: MonteCarlo) -> Units:
    """Return the units of the page, but for those of forces: each has the prefix that suits it."""
    found = units(study.nominal.reference)
    return {si: unit for si, unit in found.items() if si not in ("N", "N*m")}


def moving(study: MonteCarlo) -> list[Spread]:
    """Return the numbers that differ among the machines."""
    return [s for s in study.spreads if s.deviation > 0]


def title(number: Spread) -> str:
    """Return the name of a number as shown, with a capital letter."""
    return number.name[:1].upper() + number.name[1:]


def overview(study: MonteCarlo) -> pd.DataFrame:
    """Return one row per number: the drawing's, and how far the machines are off that."""
    named = named_units(study)

    def off(number: Spread, value: float) -> str:
        return _amount(value - number.nominal, number.unit, named, "+")

    return pd.DataFrame(
        {"number": title(s), "as drawn": written(s.nominal, s.unit.replace("*", " "), named)}
        | {"standard deviation": _amount(s.deviation, s.unit, named), "linear": _amount(s.linear, s.unit, named)}
        | {"the linear model is off by": percent(sqrt(s.unexplained)), "mean": off(s, s.mean)}
        | {f"{100 * float(share):g} %": off(s, value) for share, value in s.quantiles.items()}
        for s in moving(study)
    )


def _amount(value: float, unit: str, named: Units, sign: str = "") -> str:
    """Return a quantity to three digits, with its sign where `sign` is "+"."""
    if isnan(value):
        return "–"
    factor, name = named.get(unit) or prefixed(abs(value) or 1.0, unit.replace("*", " "))
    return f"{factor * value:{sign}.3g}\u00a0{name}".replace("-", "−").replace("\u00a0°", "°")


def _share(share: float) -> str:
    return "–" if isnan(share) else percent(share)


def names(study: MonteCarlo) -> list[str]:
    """Return short names of what varies."""
    return short_names([variation.path for variation in study.scene.variations])


def shares(study: MonteCarlo) -> pd.DataFrame:
    """Return one row per number with the share of its variance that each variation has."""
    return pd.DataFrame(
        {"number": title(s)}
        | {name: f"{100 * share:.1f} %" for name, share in zip(names(study), s.shares.values(), strict=True)}
        for s in moving(study)
    )


def against_engines(study: MonteCarlo) -> pd.DataFrame:
    """Return one row per number: by how much the engines differ on the linkage as drawn, and the machines do."""
    named = named_units(study)
    return pd.DataFrame(
        {"number": title(s), "the machines' standard deviation": _amount(s.deviation, s.unit, named)}
        | {f"{engine} differs by": _amount(off, s.unit, named) for engine, off in differences(study, s).items()}
        | {f"{engine}, of the deviation": _share(off / s.deviation) for engine, off in differences(study, s).items()}
        for s in moving(study)
    )


def worst(study: MonteCarlo, machine: int) -> pd.DataFrame:
    """Return how far each number of the file is off the drawing on one machine."""
    found, variations = study.changes(machine), study.scene.variations
    drawn = numbers_in(study.scene.file, [*found])
    return pd.DataFrame(
        {"number of the file": v.path, "as drawn": f"{number:.7g}", "here": f"{found[v.path]:.7g}"}
        | {"of what is allowed": f"{100 * (found[v.path] - number) / v.plus_minus:+.0f} %".replace("-", "−")}
        for v, number in zip(variations, drawn, strict=True)
    )


def failures(study: MonteCarlo) -> pd.DataFrame:
    """Return why machines do not run, and how many."""
    return pd.DataFrame(
        {"machines": f"{f.count:,}", "of all": percent(f.count / study.count), "status": f.status}
        | {"reason, of the first": f.reason, "the first": f"{f.first:,}"}
        for f in study.failures
    )


# --- sentences -------------------------------------------------------------------------------------------------------


def ran(study: MonteCarlo) -> str:
    """Return how many machines were drawn, and how many of them run."""
    stopped = "" if study.complete else f"Stopped after {study.count:,} of {study.asked:,} machines. "
    return f"{stopped}{study.running:,} of {study.count:,} machines run, drawn with seed {study.seed}."


def setup(study: MonteCarlo) -> str:
    """Return what varies."""
    uniform = sum(v.distribution == "uniform" for v in study.scene.variations)
    kinds = f"{len(study.scene.variations) - uniform} by normal distributions, {uniform} by uniform ones"
    return f"{len(study.scene.variations)} numbers of the scene vary, {kinds}: {', '.join(names(study))}."


def verdicts(study: MonteCarlo) -> Iterator[str]:
    """Yield how well the linear model predicts the spread, and how the engines' differences compare with it."""
    shown = moving(study)
    off = {s.name: abs(s.linear / s.deviation - 1) for s in shown}
    bent = [name for name, share in off.items() if share > OFF + 3 * sqrt(0.5 / study.count)]  # beyond chance
    if bent:
        which = ", ".join(f"{name} (off by {percent(off[name])})" for name in bent)
        yield f"Tolerances do not add up linearly for {which}: take the standard deviation of the machines drawn."
    elif shown:
        yield f"Adding the tolerances up linearly gives each standard deviation to within {percent(max(off.values()))}."
    for m in study.judged.measurements:
        ratios = {s.name: differences(study, s).get(m.run.engine, nan) / s.deviation for s in shown}
        known = {name: ratio for name, ratio in ratios.items() if not isnan(ratio)}
        if known:
            name = max(known, key=lambda name: known[name])
            least = min(known.values())
            yield (
                f"{m.run.engine} differs from the reference by {percent(least)} to {percent(known[name])} of what the"
                f" tolerances do to the same number; the most at the {name}."
            )
