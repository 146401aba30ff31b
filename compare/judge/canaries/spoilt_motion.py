"""Ways to spoil a motion: each returns another one, whose named channels are wrong."""

from collections.abc import Collection, Iterable, Mapping

from scenes import Motion
from scenes.model.motion import Samples


def replaced(motion: Motion, samples: Mapping[str, Samples]) -> Motion:
    """Return the motion with other samples in some channels."""
    return Motion({**motion.samples, **samples}, motion.unsupported)


def scaled(motion: Motion, names: Iterable[str], factor: float) -> Motion:
    """Return the motion with some channels times a factor: -1 for the opposite sign, 1000 for mm in place of m."""
    return replaced(motion, {name: factor * motion[name] for name in names})


def shifted(motion: Motion, amounts: Mapping[str, Samples | float]) -> Motion:
    """Return the motion with something added to some channels, the same to every sample or an amount to each."""
    return replaced(motion, {name: motion[name] + amount for name, amount in amounts.items()})


def swapped(motion: Motion, first: Iterable[str], second: Iterable[str]) -> Motion:
    """Return the motion with channels in each other's place."""
    pairs = [*zip(first, second, strict=True)]
    return replaced(motion, {a: motion[b] for a, b in pairs} | {b: motion[a] for a, b in pairs})


def taken(motion: Motion, rows: Iterable[int], names: Collection[str] | None = None) -> Motion:
    """Return the motion with other rows, in some channels or all: a row may come twice, or in another order."""
    chosen = [*rows]
    other = {name: samples[chosen] for name, samples in motion.samples.items() if names is None or name in names}
    return replaced(motion, other)


def at_row(motion: Motion, name: str, row: int, value: float) -> Motion:
    """Return the motion with one sample replaced."""
    samples = motion[name].copy()
    samples[row] = value
    return replaced(motion, {name: samples})


def without(motion: Motion, names: Collection[str], reason: str = "") -> Motion:
    """Return the motion without some channels: declared unsupported where a reason is given."""
    kept = {name: samples for name, samples in motion.samples.items() if name not in names}
    return Motion(kept, {**motion.unsupported, **dict.fromkeys(names if reason else (), reason)})
