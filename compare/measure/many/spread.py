"""How far the workshop's tolerances spread a number: over the machines drawn, and by the linear model beside it."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import nan

import numpy as np

from scenes.model.motion import Samples

from ...judge.peaks.numbers import CycleNumber

QUANTILES = (0.00135, 0.05, 0.5, 0.95, 0.99865)  # the outer ones are three standard deviations of a normal
ROUNDING = 1e-11  # relative: by so much a number that nothing changes differs from machine to machine


@dataclass(frozen=True)
class Spread:
    """One of the designer's numbers over all machines that run, SI."""

    name: str
    of: str  # the joint, point or body
    unit: str
    nominal: float  # of the linkage as drawn
    size: float  # what the engines' differences are relative to
    mean: float
    deviation: float  # standard deviation, 0 where it is rounding
    quantiles: Mapping[str, float]
    least: int  # the machine with the least value, from 0
    largest: int
    linear: float  # the standard deviation by the linear model
    unexplained: float  # the share of the sampled variance that the linear model leaves; its mean shift counts too
    shares: Mapping[str, float]  # by path, of the variance of the linear model


def spread(number: CycleNumber, values: Samples, linear: Samples, gradient: Mapping[str, float]) -> Spread:
    """The statistics of a number of all m machines, NaN of those that do not run, and by the linear model; shape (m,).

    The gradient is by path what a standard deviation of that number of the scene changes.
    """
    kept, nominal, size = ~np.isnan(values), float(number.value[0]), float(number.size[0])
    run = values[kept] if kept.any() else np.full(1, nan)
    least, largest = (int(np.nanargmin(values)), int(np.nanargmax(values))) if kept.any() else (-1, -1)
    deviation = float(run.std(ddof=1)) if run.size > 1 else nan
    if deviation <= ROUNDING * max(abs(nominal), abs(size)):
        deviation = 0.0
    quantiles = {f"{q:.5g}": float(value) for q, value in zip(QUANTILES, np.quantile(run, QUANTILES), strict=True)}
    unexplained = float(np.mean(np.square((values - linear)[kept]))) / deviation**2 if deviation > 0 else nan
    parts = np.square([*gradient.values()])
    of_all = float(parts.sum())
    shares = {path: float(part) / of_all if of_all else 0.0 for path, part in zip(gradient, parts, strict=True)}
    named = number.name, number.curve.of, number.unit, nominal, size
    sampled = float(run.mean()), deviation, quantiles, least, largest
    return Spread(*named, *sampled, of_all**0.5, unexplained, shares)
