"""Faults in time, in the data, and of the solution: late, repeated, missing, not finite, noisy, coarse."""

from collections.abc import Iterator
from functools import partial
from math import radians

import numpy as np

from scenes import Failure, Motion
from scenes.motion import Samples, quantity
from scenes.scene import ConstantSpeed

from ..judge.errors import GROUPS
from . import spoilt_motion as spoilt
from .fault import OF_BODIES, OF_POINTS, Clean, Fault

LAG, HELD, ROWS, DRIVE = "late", "rows held", "rows out of order", "drive"
MISSING, NONFINITE, SPIKE, CONSTANT = "missing", "not finite", "spoilt sample", "constant"
NOISE, DIFFERENCES, SOLVER = "noise", "differences of samples", "discretisation"


def times(clean: Clean) -> Iterator[Fault]:
    """Yield motions that are late, and rows that are repeated or out of order."""
    motion, count = clean.motion, clean.sampling.count
    linkage, all_channels = {*clean.channels}, {*clean.channels, clean.drive}
    for by, far in (("a sample", 1), ("three samples", 3)):
        late = [max(row - far, 0) for row in range(count)]
        yield Fault("time", f"all late by {by}", far, LAG, "all", partial(spoilt.taken, motion, late, all_channels))
        yield Fault(
            "time", f"all but the drive late by {by}", far, LAG, "all", partial(spoilt.taken, motion, late, linkage)
        )
        early = [min(row + far, count - 1) for row in range(count)]
        yield Fault("time", f"all early by {by}", far, LAG, "all", partial(spoilt.taken, motion, early, all_channels))
    yield from _late_by_a_little(clean)
    for what in ("velocity", "acceleration", "reaction", "torque"):
        names = {name for name in clean.channels if GROUPS[quantity(name)] == what}
        if names:
            late = [0, *range(count - 1)]
            yield Fault("time", f"{what} late by a sample", 1, LAG, "all", partial(spoilt.taken, motion, late, names))
    for what, stems in {"point": clean.stems("vx"), "body": clean.stems("omega"), "joint": clean.stems("fx")}.items():
        for stem in clean.some(stems, f"{what} late"):
            late = [0, *range(count - 1)]
            own = {name for name in clean.channels if name.rpartition(".")[0] == stem}
            if what == "joint":
                own &= {*clean.of("fx", "fy")}
            yield Fault("time", f"a {what} late by a sample", 1, LAG, stem, partial(spoilt.taken, motion, late, own))
    middle = count // 3
    orders = {
        "a row repeated": ([*range(middle), middle - 1, *range(middle + 1, count)], HELD),
        "ten rows held": ([*range(middle), *[middle] * 10, *range(middle + 10, count)], HELD),
        "the last row held": ([*range(count - 1), count - 2], HELD),
        "the first row held": ([1, *range(1, count)], HELD),
        "every second row held": ([row // 2 * 2 for row in range(count)], HELD),
        "two rows swapped": ([*range(middle), middle + 1, middle, *range(middle + 2, count)], ROWS),
        "rows backwards": ([*range(count)][::-1], ROWS),
        "rows from another start": ([(row + middle) % (count - 1) for row in range(count)], LAG),
    }
    for kind, (rows, cause) in orders.items():
        yield Fault("time", kind, 1, cause, "all", partial(spoilt.taken, motion, rows, all_channels))
        if cause != HELD:
            yield Fault("time", f"{kind}, but the drive", 1, cause, "all", partial(spoilt.taken, motion, rows, linkage))
    yield Fault(
        "time",
        "a row repeated with its instant",
        1,
        HELD,
        "all",
        partial(spoilt.taken, motion, orders["a row repeated"][0]),
    )
    yield Fault(
        "time",
        "two rows swapped with their instants",
        1,
        ROWS,
        "all",
        partial(spoilt.taken, motion, orders["two rows swapped"][0]),
    )
    for share in (1e-3, 1e-6):
        change = partial(spoilt.shifted, motion, ["time"], share * clean.scene.drive.cycle)
        yield Fault("time", "other instants than asked for", share, LAG, "all", change)


def _late_by_a_little(clean: Clean) -> Iterator[Fault]:
    """Yield the motion as it was a moment before, by the reference: with the drive, without it, the drive alone."""
    scene, motion = clean.scene, clean.motion
    rate = scene.drive.peak_rate
    step = scene.drive.cycle / clean.sampling.samples
    travel = 1.0 if scene.driven_slide is None else float(np.ptp(scene.drive.extent))
    lags = {"3 degrees": radians(3) * travel / rate, "1e-3 rad": 1e-3 * travel / rate, "half a sample": step / 2}
    lags |= {"1e-5 of a cycle": 1e-5 * scene.drive.cycle, "1e-8 of a cycle": 1e-8 * scene.drive.cycle}
    for name, by in lags.items():
        for sign, how in ((1, "late"), (-1, "early")):
            instants = clean.sampling.times(scene) - sign * by
            if not scene.drive.repeats:
                instants = np.clip(instants, 0.0, scene.drive.cycle)
            position = scene.drive.at(instants).position
            try:
                then = clean.reference.at(position, instants)
            except Failure:
                continue
            with_drive = spoilt.moved(motion, clean.true, then, [*clean.channels, clean.drive])
            without = spoilt.moved(motion, clean.true, then, clean.channels)
            only = spoilt.moved(motion, clean.true, then, [clean.drive])
            yield Fault("time", f"all {how} by {name}", by, LAG, "all", partial(_same, with_drive))
            yield Fault("time", f"all but the drive {how} by {name}", by, LAG, "all", partial(_same, without))
            if sign > 0:
                yield Fault("time", f"the drive alone {how} by {name}", by, DRIVE, "drive", partial(_same, only))
                rates = [c for c in clean.channels if GROUPS[quantity(c)] == "velocity"]
                leapfrog = spoilt.moved(motion, clean.true, then, rates)
                if rates and name == "half a sample":
                    yield Fault("time", "velocities half a sample late", by, LAG, "all", partial(_same, leapfrog))


def data(clean: Clean) -> Iterator[Fault]:
    """Yield motions that are not what was asked for."""
    motion, count = clean.motion, clean.sampling.count
    groups = {GROUPS[quantity(name)]: name for name in clean.some([*clean.channels, clean.drive], "data", 1000)}
    for group, name in groups.items():
        stem = "drive" if name == clean.drive else name.rpartition(".")[0]
        for kind, value in {"NaN": np.nan, "infinity": np.inf, "minus infinity": -np.inf}.items():
            change = partial(spoilt.at_row, motion, name, count // 3, value)
            yield Fault("data", f"{kind} at a sample: {group}", 1, NONFINITE, stem, change)
        change = partial(spoilt.replaced, motion, {name: np.full_like(motion[name], np.nan)})
        yield Fault("data", f"NaN in all samples: {group}", 1, NONFINITE, stem, change)
        yield Fault("data", f"a channel missing: {group}", 1, MISSING, stem, partial(spoilt.without, motion, {name}))
        declared = partial(spoilt.without, motion, {name}, "cannot be had")
        yield Fault("data", f"a channel declared unsupported: {group}", 1, MISSING, stem, declared)
        single = partial(spoilt.replaced, motion, {name: motion[name].astype(np.float32)})
        yield Fault("data", f"single precision: {group}", 1e-7, MISSING, stem, single)
        yield Fault(
            "data",
            f"a sample too few: {group}",
            1,
            MISSING,
            stem,
            partial(spoilt.replaced, motion, {name: motion[name][:-1]}),
        )
        if group != "drive" and np.ptp(motion[name]) > 10 * clean.promise * clean.size(name).max():
            for kind, value in {"zero": 0.0, "constant": float(motion[name][0])}.items():
                change = partial(spoilt.replaced, motion, {name: np.full_like(motion[name], value)})
                yield Fault("data", f"a channel {kind}: {group}", 1, CONSTANT, stem, change)
    for group in ("velocity", "acceleration", "reaction", "torque"):
        names = {name for name in clean.channels if GROUPS[quantity(name)] == group}
        if names:
            declared = partial(spoilt.without, motion, names, "cannot be had")
            yield Fault("data", f"all channels of a group declared unsupported: {group}", 1, MISSING, "all", declared)
    yield Fault("data", "a row too few", 1, MISSING, "all", partial(spoilt.taken, motion, range(count - 1)))
    yield Fault("data", "a row too many", 1, MISSING, "all", partial(spoilt.taken, motion, [*range(count), count - 1]))
    yield Fault("data", "no rows", 1, MISSING, "all", partial(spoilt.taken, motion, []))
    whole = Motion({name: samples.astype(np.int64) for name, samples in motion.samples.items()})
    yield Fault("data", "whole numbers", 1, MISSING, "all", partial(_same, whole))


def solutions(clean: Clean) -> Iterator[Fault]:
    """Yield what poor solutions look like: noise, drift, spikes, ringing, differences, fewer digits."""
    motion, p = clean.motion, clean.promise
    count = clean.sampling.count
    for what in dict.fromkeys(quantity(name) for name in clean.channels):
        for by in (0.1, 5 * p):
            for stem in clean.some([name.rpartition(".")[0] for name in clean.of(what)], f"noise {what} {by}"):
                name = f"{stem}.{what}"
                size = float(by * clean.size(name).max())
                yield Fault(
                    "solver", f"noise: {what}", by, NOISE, stem, partial(spoilt.noisy, motion, [name], {name: size})
                )
                drift = partial(spoilt.drifting, motion, [name], {name: size})
                yield Fault("solver", f"drift: {what}", by, SOLVER, stem, drift)
                row = (7 * len(name) + count // 4) % count
                spike = partial(spoilt.at_row, motion, name, row, float(motion[name][row]) + size)
                yield Fault("solver", f"a spike: {what}", by, SPIKE, stem, spike)
    sizes = {name: 5 * p * float(clean.size(name).max()) for name in clean.channels}
    yield Fault(
        "solver", "noise in all channels", 5 * p, NOISE, "all", partial(spoilt.noisy, motion, clean.channels, sizes)
    )
    for group in ("acceleration", "reaction"):
        names = [name for name in clean.channels if GROUPS[quantity(name)] == group]
        ringing = (-1.0) ** np.arange(count)
        rung = {name: motion[name] + 10 * p * clean.size(name) * ringing for name in names}
        if names:
            yield Fault("solver", f"ringing: {group}", 10 * p, NOISE, "all", partial(spoilt.replaced, motion, rung))
    yield from _coarse(clean)


def _coarse(clean: Clean) -> Iterator[Fault]:
    motion, step = clean.motion, clean.scene.drive.cycle / clean.sampling.samples
    for before, after, of in (
        ("", "v", "points"),
        ("v", "a", "points"),
        ("angle", "omega", "bodies"),
        ("omega", "alpha", "bodies"),
    ):
        names = {}
        for stem in clean.stems("omega") if of == "bodies" else clean.stems("vx"):
            axes = ("",) if of == "bodies" else ("x", "y")
            for axis in axes:
                source = motion[f"{stem}.{before}{axis}"]
                source = np.unwrap(source) if before == "angle" else source
                names[f"{stem}.{after}{axis}"] = np.gradient(source, step)
        if names:
            kind = f"central differences: {after if of == 'bodies' else dict(OF_POINTS)[after]}"
            yield Fault("solver", kind, step, DIFFERENCES, "all", partial(spoilt.replaced, motion, names))
    for digits in (2, 4):
        rounded = {name: _rounded(motion[name], digits) for name in clean.channels}
        yield Fault(
            "solver", f"{digits} digits", 10.0**-digits, NOISE, "all", partial(spoilt.replaced, motion, rounded)
        )
    smooth = {
        name: np.convolve(np.pad(motion[name], 1, "edge"), [0.25, 0.5, 0.25], "valid")
        for name in clean.of("ax", "ay", "alpha", "fx", "fy")
    }
    if smooth:
        yield Fault("solver", "smoothed", 1, SOLVER, "all", partial(spoilt.replaced, motion, smooth))
    for stem in clean.some(clean.stems(*OF_BODIES[1:]), "free") if isinstance(clean.scene.drive, ConstantSpeed) else ():
        quiet = partial(spoilt.scaled, motion, [f"{stem}.alpha"], 0.0)
        yield Fault("solver", "an angular acceleration left out", 1, CONSTANT, stem, quiet)


def _rounded(samples: Samples, digits: int) -> Samples:
    """Return samples rounded to some digits of their peak."""
    peak = float(np.abs(samples).max()) or 1.0
    return np.round(samples / peak, digits) * peak


def _same(motion: Motion) -> Motion:
    return motion
