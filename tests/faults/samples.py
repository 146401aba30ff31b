"""Faults in time, in the data, and of the solution: late, repeated, missing, not finite, noisy, coarse."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from math import radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compare.judge.canaries import spoilt_motion as spoilt
from compare.judge.causes.cause import Kind, common
from scenes import Failure, Motion
from scenes.channels import named
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import ConstantSpeed

from .fault import OF_BODIES, Clean, Fault


def times(clean: Clean) -> Iterator[Fault]:
    """Yield motions that are late, and rows that are repeated or out of order."""
    motion, count = clean.motion, clean.sampling.count
    linkage, all_channels = {*clean.channels}, {*clean.channels, clean.drive}

    def fault(
        kind: str, size: float, rows: Iterable[int], names: Collection[str] | None, cause: Kind, place: str = "all"
    ) -> Fault:
        return Fault("time", kind, size, cause, place, partial(spoilt.taken, motion, rows, names))

    late = [0, *range(count - 1)]
    for by, far in (("a sample", 1), ("three samples", 3)):
        then = [max(row - far, 0) for row in range(count)]
        yield fault(f"all late by {by}", far, then, all_channels, Kind.lag)
        yield fault(f"all but the drive late by {by}", far, then, linkage, Kind.lag)
        early = [min(row + far, count - 1) for row in range(count)]
        yield fault(f"all early by {by}", far, early, all_channels, Kind.lag)
    yield from _late_by_a_little(clean)
    for what, names in clean.grouped("velocity", "acceleration", "reaction", "torque", "force"):
        yield fault(f"{what} late by a sample", 1, late, names, Kind.lag, common(clean.scene.channels, names))
    for what, stems in {"point": clean.stems("vx"), "body": clean.stems("omega"), "joint": clean.stems("fx")}.items():
        for place in clean.some(stems, f"{what} late"):
            own = {name for name in clean.channels if clean.scene.channels[name].owner == place}
            if what == "joint":
                own &= {*clean.of("fx", "fy")}
            yield fault(f"a {what} late by a sample", 1, late, own, Kind.lag, place)
    middle = count // 3
    orders = {
        "a row repeated": ([*range(middle), middle - 1, *range(middle + 1, count)], Kind.held),
        "ten rows held": ([*range(middle), *[middle] * 10, *range(middle + 10, count)], Kind.held),
        "the last row held": ([*range(count - 1), count - 2], Kind.held),
        "the first row held": ([1, *range(1, count)], Kind.held),
        "every second row held": ([row // 2 * 2 for row in range(count)], Kind.held),
        "two rows swapped": ([*range(middle), middle + 1, middle, *range(middle + 2, count)], Kind.rows),
        "rows backwards": ([*range(count)][::-1], Kind.rows),
        "rows from another start": ([(row + middle) % (count - 1) for row in range(count)], Kind.lag),
    }
    for kind, (rows, cause) in orders.items():
        yield fault(kind, 1, rows, all_channels, cause)
        if cause is not Kind.held:
            yield fault(f"{kind}, but the drive", 1, rows, linkage, cause)
    yield fault("a row repeated with its instant", 1, orders["a row repeated"][0], None, Kind.held)
    yield fault("two rows swapped with their instants", 1, orders["two rows swapped"][0], None, Kind.rows)
    for share in (1e-3, 1e-6):
        change = partial(spoilt.shifted, motion, {"time": share * clean.scene.cycle})
        yield Fault("time", "other instants than asked for", share, Kind.lag, "all", change)


def _late_by_a_little(clean: Clean) -> Iterator[Fault]:
    """Yield the motion as it was a moment before, by the reference: with the drive, without it, the drive alone."""
    scene, motion = clean.scene, clean.motion
    rate = scene.drive.law.peak_rate
    step = scene.cycle / clean.sampling.samples
    travel = 1.0 if scene.drive.slide is None else float(np.ptp(scene.drive.law.extent))
    lags = {"3 degrees": radians(3) * travel / rate, "1e-3 rad": 1e-3 * travel / rate, "half a sample": step / 2}
    lags |= {"1e-5 of a cycle": 1e-5 * scene.cycle, "1e-8 of a cycle": 1e-8 * scene.cycle}
    for name, by in lags.items():
        for sign, how in ((1, "late"), (-1, "early")):
            instants = clean.sampling.times(scene) - sign * by
            if not scene.periodic:
                instants = np.clip(instants, 0.0, scene.cycle)
            try:
                then = clean.reference.at(inputs_of(scene, instants))
            except Failure:
                continue
            moved = partial(_moved, motion, clean.true, then)
            everything = partial(moved, [*clean.channels, clean.drive])
            seen = by * rate > clean.promise * 1e-3 * travel  # else in the drive alone, where an engine has no error
            cause, place = (Kind.lag, "all") if seen else (Kind.drive, "drive")
            yield Fault("time", f"all {how} by {name}", by, cause, place, everything)
            linkage = partial(moved, clean.channels)
            yield Fault("time", f"all but the drive {how} by {name}", by, Kind.lag, "all", linkage)
            if sign > 0:
                alone = partial(moved, [clean.drive])
                yield Fault("time", f"the drive alone {how} by {name}", by, Kind.drive, "drive", alone)
                for _, rates in clean.grouped("velocity") if name == "half a sample" else ():
                    yield Fault("time", "velocities half a sample late", by, Kind.lag, "all", partial(moved, rates))


def data(clean: Clean) -> Iterator[Fault]:
    """Yield motions that are not what was asked for."""
    motion, count = clean.motion, clean.sampling.count

    def fault(kind: str, place: str, change: Callable[[], Motion], cause: Kind = Kind.missing) -> Fault:
        return Fault("data", kind, 1, cause, place, change)

    def other(kind: str, name: str, samples: NDArray[Any], cause: Kind = Kind.missing) -> Fault:
        kind = f"{kind}: {named(name).group}"
        return fault(kind, clean.scene.channels[name].owner, partial(spoilt.replaced, motion, {name: samples}), cause)

    groups = {named(name).group: name for name in clean.some([*clean.channels, clean.drive], "data", 1000)}
    for group, name in groups.items():
        own, place = motion[name], clean.scene.channels[name].owner
        for kind, value in {"NaN": np.nan, "infinity": np.inf, "minus infinity": -np.inf}.items():
            change = partial(spoilt.at_row, motion, name, count // 3, value)
            yield fault(f"{kind} at a sample: {group}", place, change, Kind.nonfinite)
        yield other("NaN in all samples", name, np.full_like(own, np.nan), Kind.nonfinite)
        yield fault(f"a channel missing: {group}", place, partial(spoilt.without, motion, {name}))
        declared = partial(spoilt.without, motion, {name}, "cannot be had")
        yield fault(f"a channel declared unsupported: {group}", place, declared)
        yield replace(other("single precision", name, own.astype(np.float32)), magnitude=1e-7)
        yield other("a sample too few", name, own[:-1])
        if group != "drive" and np.ptp(own) > 10 * clean.promise * clean.size(name).max():
            for kind, value in {"zero": 0.0, "constant": float(own[0])}.items():
                yield other(f"a channel {kind}", name, np.full_like(own, value), Kind.constant)
    for group, names in clean.grouped("velocity", "acceleration", "reaction", "torque", "force"):
        declared = partial(spoilt.without, motion, names, "cannot be had")
        yield fault(
            f"all channels of a group declared unsupported: {group}", common(clean.scene.channels, names), declared
        )
    yield fault("a row too few", "all", partial(spoilt.taken, motion, range(count - 1)))
    yield fault("a row too many", "all", partial(spoilt.taken, motion, [*range(count), count - 1]))
    yield fault("no rows", "all", partial(spoilt.taken, motion, []))
    whole: dict[str, Any] = {name: samples.astype(np.int64) for name, samples in motion.samples.items()}
    yield fault("whole numbers", "all", partial(spoilt.replaced, motion, whole))


def solutions(clean: Clean) -> Iterator[Fault]:
    """Yield what poor solutions look like: noise, drift, spikes, ringing, differences, fewer digits."""
    motion, p, count = clean.motion, clean.promise, clean.sampling.count
    for what in dict.fromkeys(named(name).name for name in clean.channels):
        for by in (0.1, 5 * p):
            for place in clean.some(
                (clean.scene.channels[name].owner for name in clean.of(what)), f"noise {what} {by}"
            ):
                name = f"{place}.{what}"
                size = {name: float(by * clean.size(name).max())}
                noise = partial(_noisy, motion, [name], size)
                yield Fault("solver", f"noise: {what}", by, Kind.noise, place, noise)
                drift = partial(_drifting, motion, [name], size)
                yield Fault("solver", f"drift: {what}", by, Kind.solver, place, drift)
                row = (7 * len(name) + count // 4) % count
                spike = partial(spoilt.at_row, motion, name, row, float(motion[name][row]) + size[name])
                yield Fault("solver", f"a spike: {what}", by, Kind.spike, place, spike)
    sizes = {name: 5 * p * float(clean.size(name).max()) for name in clean.channels}
    noise = partial(_noisy, motion, clean.channels, sizes)
    yield Fault("solver", "noise in all channels", 5 * p, Kind.noise, "all", noise)
    for group, names in clean.grouped("acceleration", "reaction"):
        rung = {name: motion[name] + 10 * p * clean.size(name) * (-1.0) ** np.arange(count) for name in names}
        change = partial(spoilt.replaced, motion, rung)
        yield Fault("solver", f"ringing: {group}", 10 * p, Kind.noise, "all", change)
    yield from _coarse(clean)


def _coarse(clean: Clean) -> Iterator[Fault]:
    motion, step = clean.motion, clean.scene.cycle / clean.sampling.samples

    def fault(kind: str, size: float, cause: Kind, samples: Mapping[str, Samples]) -> Fault:
        return Fault(
            "solver",
            kind,
            size,
            cause,
            common(clean.scene.channels, samples),
            partial(spoilt.replaced, motion, samples),
        )

    of_points = [("", "v", "velocity"), ("v", "a", "acceleration")]
    for before, after, what in (*of_points, ("angle", "omega", "omega"), ("omega", "alpha", "alpha")):
        names = {}
        on_points = (before, after, what) in of_points
        for owner in clean.stems("vx" if on_points else "omega"):
            for axis in "xy" if on_points else ("",):
                source = motion[f"{owner}.{before}{axis}"]
                source = np.unwrap(source) if before == "angle" else source
                names[f"{owner}.{after}{axis}"] = np.gradient(source, step)
        if names:
            yield fault(f"central differences: {what}", step, Kind.differences, names)
    for digits in (2, 4):
        rounded = {name: _rounded(motion[name], digits) for name in clean.channels}
        yield fault(f"{digits} digits", 10.0**-digits, Kind.noise, rounded)
    smooth = {
        name: np.convolve(np.pad(motion[name], 1, "edge"), [0.25, 0.5, 0.25], "valid")
        for name in clean.of("ax", "ay", "alpha", "fx", "fy")
    }
    if smooth:
        yield fault("smoothed", 1, Kind.solver, smooth)
    for body in (
        clean.some(clean.stems(*OF_BODIES[1:]), "free") if isinstance(clean.scene.drive.law, ConstantSpeed) else ()
    ):
        quiet = partial(spoilt.scaled, motion, [f"{body}.alpha"], 0.0)
        yield Fault("solver", "an angular acceleration left out", 1, Kind.constant, body, quiet)


def _rounded(samples: Samples, digits: int) -> Samples:
    """Return samples rounded to some digits of their peak."""
    peak = float(np.abs(samples).max()) or 1.0
    return np.round(samples / peak, digits) * peak


def _noisy(motion: Motion, names: Iterable[str], size: Mapping[str, float], seed: int = 0) -> Motion:
    """Return the motion with normal noise of a size, by channel."""
    draw = np.random.default_rng(seed)
    return spoilt.replaced(
        motion, {name: motion[name] + size[name] * draw.standard_normal(len(motion[name])) for name in names}
    )


def _drifting(motion: Motion, names: Iterable[str], size: Mapping[str, float]) -> Motion:
    """Return the motion with an error that grows evenly to a size at the end, by channel."""
    return spoilt.replaced(
        motion, {name: motion[name] + size[name] * np.linspace(0, 1, len(motion[name])) for name in names}
    )


def _moved(motion: Motion, right: Motion, wrong: Motion, names: Iterable[str]) -> Motion:
    """Return the motion plus what lies between two others in some channels."""
    return spoilt.shifted(motion, {name: wrong[name] - right[name] for name in names})
