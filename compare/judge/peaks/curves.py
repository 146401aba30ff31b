"""Quantities followed over a cycle: the output's motion, the forces of joints, the drive's effort, singular poses."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.model.inputs import inputs_of
from scenes.model.motion import UNITS, Samples, quantity
from scenes.scene import GROUND

Values: TypeAlias = NDArray[Any]  # shape (..., n) of a motion's channels, complex for a vector
LEAST = ("transmission", "to_lock")  # the kinds of which the least value matters


@dataclass(frozen=True, eq=False)
class CycleCurve:
    """One quantity: a plane vector, or a number with a sign."""

    kind: str  # displacement, path, velocity, acceleration, reaction, guide_force, guide_moment, effort, one of `LEAST`
    of: str  # the point, joint or body
    parts: Mapping[str, Any]  # by channel, what one of its units adds; of many machines of shape (m, 1)
    scale: float  # of the errors of these channels
    origin: Any = 0.0  # what is taken off the sum
    along: complex | None = None  # the direction of a positive number, where it has one
    angle: str = ""  # the channel of the angle by which the vector turns, where that is on a body

    @property
    def channels(self) -> tuple[str, ...]:
        """The channels that it is taken from."""
        return (*self.parts, self.angle) if self.angle else (*self.parts,)

    @property
    def unit(self) -> str:
        """The unit of its values."""
        return UNITS[quantity(self.channels[0])]

    def values(self, motion: Motion) -> Values:
        """Its values in a motion."""
        values: Values = reduce(add, (part * motion[channel] for channel, part in self.parts.items())) - self.origin
        return values * np.exp(1j * motion[self.angle]) if self.angle else values

    def direction(self, motion: Motion, row: int) -> float:
        """The direction of the vector at a sample, rad; NaN where it has none."""
        value = self.values(motion)[row]
        if self.along is None and not np.iscomplexobj(value):
            return np.nan
        return float(np.angle(value * (self.along or 1.0)))


def curves(scene: Scene, scale: Mapping[str, float], motion: Motion) -> list[CycleCurve]:
    """The quantities for which a motion has the channels; `scale` is by channel what errors are divided by."""
    known = [*_output(scene, scale), *(_forces(scene, scale) if scene.has_masses else ()), *_singular(motion)]
    return [curve for curve in known if all(channel in motion for channel in curve.channels)]


def driving(scene: Scene, effort: Samples, motion: Motion) -> tuple[Samples, Samples, Samples]:
    """How large the drive's effort is, negative against its motion; its power, W; its rate; each of shape (..., n)."""
    rate = inputs_of(scene, motion["time"]).driven().rate
    with_motion = np.abs(effort) * np.sign(np.where(rate == 0, 1.0, effort * rate))  # what holds still drives
    return with_motion, effort * rate, rate


def _output(scene: Scene, scales: Mapping[str, float]) -> Iterator[CycleCurve]:
    """Yield the output's motion: numbers along its guide, vectors where it has none."""
    point, guided = scene.output, scene.guided(scene.output)
    for kind, q in (("displacement", ""), ("velocity", "v"), ("acceleration", "a")):
        x, y = both = f"{point}.{q}x", f"{point}.{q}y"
        if guided is None:
            yield CycleCurve(kind if q else "path", point, {x: 1, y: 1j}, scales[x])
            continue
        slide = guided[1]
        parts = {channel: part for channel, part in zip(both, slide.along, strict=True) if np.any(part != 0)}
        origin = 0.0 if q else sum(a * t for a, t in zip(slide.along, slide.through, strict=True))
        along = slide.along[0] + 1j * slide.along[1]
        yield CycleCurve(kind, point, parts, scales[x], origin, along if q else None)


def _forces(scene: Scene, scale: Mapping[str, float]) -> Iterator[CycleCurve]:
    """Yield the forces of pins, of the first body on the second, the force and moment of guides, and the drive's."""
    for pin in scene.pins:
        x, y = f"{pin.channel}.fx", f"{pin.channel}.fy"
        yield CycleCurve("reaction", pin.channel, {x: 1, y: 1j}, scale[x])
    for name, guide in scene.slides.items():
        force, moment = f"{name}.guide_force", f"{name}.guide_moment"
        across, angle = 1j * guide.along[0] - guide.along[1], f"{guide.on}.angle" if guide.on in scene.turning else ""
        yield CycleCurve("guide_force", name, {force: across}, scale[force], angle=angle)
        yield CycleCurve("guide_moment", name, {moment: 1}, scale[moment])
    for drive in scene.drives:
        fixed, channel = drive.slide if drive.on == GROUND else None, drive.effort_channel
        along = complex(*fixed.along) if fixed else None  # along a guide that swings it has no one direction
        yield CycleCurve("effort", drive.body, {channel: 1}, scale[channel], along=along)


def _singular(motion: Motion) -> Iterator[CycleCurve]:
    """Yield how far the groups of the analytic core are from a singular configuration."""
    for channel in motion.samples:
        if quantity(channel) in LEAST:
            yield CycleCurve(quantity(channel), channel.rpartition(".")[0], {channel: 1}, 1.0)
