"""Quantities followed over a cycle: the output's motion, the forces of joints, the drive's effort, singular poses."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.channels import TO_LOCK, TRANSMISSION
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import GROUND

Values: TypeAlias = NDArray[Any]  # shape (..., n) of a motion's channels, complex for a vector
LEAST_MATTERS = (TRANSMISSION, TO_LOCK)  # the kinds of which the least value matters


@dataclass(frozen=True, eq=False)
class CycleCurve:
    """One quantity: a plane vector, or a number with a sign."""

    kind: str  # displacement, path, velocity, acceleration, reaction, guide_force, guide_moment, effort, or a least one
    of: str  # the point, joint or body
    unit: str  # of its values
    parts: Mapping[str, Any]  # by channel, what one of its units adds; of many machines of shape (m, 1)
    scale: float  # of the errors of these channels
    origin: Any = 0.0  # what is taken off the sum
    along: complex | None = None  # the direction of a positive number, where it has one
    angle: str = ""  # the channel of the angle by which the vector turns, where that is on a body

    @property
    def channels(self) -> tuple[str, ...]:
        """The channels that it is taken from."""
        return (*self.parts, self.angle) if self.angle else (*self.parts,)

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
    known = [*_output(scene, scale), *(_forces(scene, scale) if scene.has_masses else ()), *_singular(scene, motion)]
    return [curve for curve in known if all(channel in motion for channel in curve.channels)]


def driving(scene: Scene, effort: Samples, motion: Motion) -> tuple[Samples, Samples, Samples]:
    """How large the drive's effort is, negative against its motion; its power, W; its rate; each of shape (..., n)."""
    rate = inputs_of(scene, motion["time"]).driven().rate
    with_motion = np.abs(effort) * np.sign(np.where(rate == 0, 1.0, effort * rate))  # what holds still drives
    return with_motion, effort * rate, rate


def _output(scene: Scene, scales: Mapping[str, float]) -> Iterator[CycleCurve]:
    """Yield the output's motion: numbers along its guide, vectors where it has none."""
    point, guided = scene.output, scene.guided(scene.output)
    kinds = ("displacement", "velocity", "acceleration")
    for order, (kind, both) in enumerate(zip(kinds, scene.channels.points[point], strict=True)):
        (x, y), unit = both, scene.channels[both[0]].unit
        if guided is None:
            yield CycleCurve(kind if order else "path", point, unit, {x: 1, y: 1j}, scales[x])
            continue
        slide = guided[1]
        parts = {channel: part for channel, part in zip(both, slide.along, strict=True) if np.any(part != 0)}
        origin = 0.0 if order else sum(a * t for a, t in zip(slide.along, slide.through, strict=True))
        along = slide.along[0] + 1j * slide.along[1]
        yield CycleCurve(kind, point, unit, parts, scales[x], origin, along if order else None)


def _forces(scene: Scene, scale: Mapping[str, float]) -> Iterator[CycleCurve]:
    """Yield the forces of pins, of the first body on the second, the force and moment of guides, and the drive's."""
    channels = scene.channels
    for pin, (x, y) in channels.pins.items():
        yield CycleCurve("reaction", pin, "N", {x: 1, y: 1j}, scale[x])
    for name, (force, moment) in channels.guides.items():
        guide = scene.slides[name]
        across = 1j * guide.along[0] - guide.along[1]
        angle = channels.bodies[guide.on].angle if guide.on in channels.bodies else ""
        yield CycleCurve("guide_force", name, "N", {force: across}, scale[force], angle=angle)
        yield CycleCurve("guide_moment", name, "N*m", {moment: 1}, scale[moment])
    for drive in scene.drives:
        fixed, effort = drive.slide if drive.on == GROUND else None, drive.effort_channel
        along = complex(*fixed.along) if fixed else None  # along a guide that swings it has no one direction
        yield CycleCurve("effort", drive.body, channels[effort].unit, {effort: 1}, scale[effort], along=along)


def _singular(scene: Scene, motion: Motion) -> Iterator[CycleCurve]:
    """Yield how far the groups of the analytic core are from a singular configuration."""
    for name in motion.samples:
        channel = scene.channels[name]
        if channel.quantity in LEAST_MATTERS:
            yield CycleCurve(channel.quantity, channel.subject, channel.unit, {name: 1}, 1.0)
