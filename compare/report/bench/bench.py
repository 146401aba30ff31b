"""What the page needs to solve the linkage anew: the core's formulas as a script, its numbers, and what they are of."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import numpy as np

from scenes.file.changes import at_path
from scenes.file.reader import tables_of
from scenes.model.motion import TRANSMISSION, UNITS, magnitudes, quantity
from scenes.scene import GROUND, ConstantSpeed

from ...engines import registry
from ...judge.proof import channels_of
from ...measure.many.machines import draws
from ...study import Study
from ..linkage.moving import MovingPicture
from ..linkage.svg import outlines
from ..numbers import units
from ..pages.html import packed
from ..plain import plain

ROUNDING = 1e-9  # of a channel's scale: what is less is none of its values
SEED, MACHINES = 0, 500  # of the machines that the page draws: as `--monte-carlo 500` does
EXACT = 24  # samples of the run that are kept to the last digit, against which the page checks itself


@dataclass(frozen=True)
class DesignNumber:
    """A number that is asked of a design: the largest or least of some channels, or how far one goes."""

    name: str
    kind: str  # `largest` length of a vector, `least`, or `range` along a direction
    channels: list[str]
    factor: float
    unit: str
    along: tuple[float, float] = (1.0, 0.0)


class Bench:
    """A report's linkage, to be solved by the page at the samples of its moving picture."""

    def __init__(self, study: Study, moving: MovingPicture) -> None:
        self.study, self.scene, self.moving, self.rows = study, study.scene, moving, moving.rows
        motion = study.motion
        position, time = (motion[channel][self.rows] for channel in (self.scene.drive_channel, "time"))
        every = study.sampling.channels is None
        self.program = registry.page_program(self.scene, position, time) if every else None

    @cached_property
    def data(self) -> str:
        """The text that the page's script unpacks."""
        assert self.program is not None
        scene, values = self.scene, self.program["values"]
        kept = sorted({*np.linspace(0, len(self.rows) - 1, EXACT).round().astype(int).tolist()})
        samples = [self.study.motion[channel][self.rows[kept]] for channel in self.program["channels"]]
        of = [scene.numbers.get(path) for path in self.program["numbers"]]  # None: where a stroke ends
        numbers = [
            {"path": path, "value": value, "free": own is not None}
            | ({"size": scene.size(own), "zero": own.quantity.zero} if own is not None else {})
            for path, value, own in zip(self.program["numbers"], values, of, strict=True)
        ]
        several = (body.name for body in scene.bodies.values() if len(body.points) > 1)
        data = {
            **self.program,
            "numbers": numbers,
            "exact": {"rows": kept, "samples": samples},
            "peaks": [self._peak(channel) for channel in self.program["channels"]],
            "paths": scene.moving_points,
            "extent": scene.drive.extent,
            "steady": isinstance(scene.drive, ConstantSpeed),
            "points": {point: [*self._moves(point)] for point in scene.owners},
            "pushes": [*self._pushes()],
            "shapes": dict(zip(several, outlines(self.moving.drawing), strict=True)),
            "asked": [asdict(one) for one in self.asked],
            "machines": self._machines(),
            "limits": [*self._limits()],
            "tables": tables_of(scene.file),
            "name": scene.name,
        }
        return packed(json.dumps(plain(data), separators=(",", ":")).encode())

    def _peak(self, channel: str) -> float:
        """What the page's difference of a channel is a part of: its peak, or where that is round-off its scale."""
        scale, peak = self.study.reference.scale.get(channel, 1.0), float(np.abs(self.study.motion[channel]).max())
        return peak if peak > ROUNDING * scale else scale

    def _moves(self, point: str) -> Iterator[Mapping[str, Any]]:
        """Yield by body what of it changes when a point is dragged: lengths by their other ends, coordinates, a guide.

        The driven body comes first, since the others follow what its drive leaves free; none where a body slides with
        more than one point.
        """
        assert self.program is not None
        at, scene = {path: n for n, path in enumerate(self.program["numbers"])}, self.scene
        if point in scene.ground:
            yield {"ground": [at.get(f"ground.points.{point}.{q}", -1) for q in range(2)]}
            return
        owners = [scene.bodies[name] for name in scene.owners[point]]
        if any(body.slide is not None and len(body.points) > 1 for body in owners):
            return
        for body in sorted(owners, key=lambda body: body.name != scene.drive.body):
            pairs = {other: f"bodies.{body.name}.lengths.{'-'.join(sorted((point, other)))}" for other in body.points}
            places = [f"bodies.{body.name}.points.{point}.{q}" for q in range(2)]
            axis = body.points[:2] if body.name == scene.drive.body else ()  # whose angle is the drive's
            yield {
                "body": body.name,
                "pivot": next((other for other in axis if other != point), "") if point in axis else "",
                "lengths": [[at[path], other] for other, path in pairs.items() if path in at],
                "local": [at.get(path, -1) for path in places] if places[0] in at and len(body.points) > 1 else [],
                "slide": asdict(body.slide) if body.slide is not None else None,
            }

    def _pushes(self) -> Iterator[Mapping[str, Any]]:
        """Yield what the arrows at guides are of: a channel, along the guide or across it, on the ground or a body."""
        for name, slide in self.scene.slides.items():
            on, along = "" if slide.on == GROUND else slide.on, complex(*slide.along)
            for channel, way, label in (
                (f"{name}.guide_force", 1j * along, f"guide on {name}"),
                ("drive.force", along, f"drive on {name}"),
            ):
                yield {
                    "channel": channel,
                    "on": on,
                    "way": [way.real, way.imag],
                    "names": [f"{label} {q}" for q in "xy"],
                }

    def _machines(self) -> Mapping[str, Any]:
        """The numbers that vary from machine to machine, and by how much those of the drawn machines are off, SI."""
        scene, at = self.scene, {path: n for n, path in enumerate(self.program["numbers"])} if self.program else {}
        drawn = draws(scene, SEED, 0, MACHINES) if scene.variations else {}
        off = {at_path(scene, path): values for path, values in drawn.items()}
        sizes = {path: scene.size(scene.numbers[path]) for path in off}
        return {
            "numbers": [at[path] for path in off],
            "off": [values * sizes[path] - scene.numbers[path].value for path, values in off.items()],
        }

    def _limits(self) -> Iterator[Mapping[str, Any]]:
        """Yield the scene's limits with the channels that each is of."""
        assert self.program is not None
        for name, limit in self.scene.limits.items():
            channels = [*channels_of(self.scene, name, self.program["channels"])]
            if {*channels} <= {*self.program["channels"]}:
                kind = "largest" if name in magnitudes(self.scene) else "least"
                yield {"channels": channels, "kind": kind, "least": limit.least, "most": limit.most}

    @cached_property
    def asked(self) -> list[DesignNumber]:
        """What a design is asked for, of the channels that the page solves for."""
        return [*self._asked()]

    @property
    def editable(self) -> Iterator[Mapping[str, Any]]:
        """Yield the numbers that a reader may change: their places among all, paths, and units of the file."""
        assert self.program is not None
        for k, path in enumerate(self.program["numbers"]):
            number = self.scene.numbers.get(path)
            if number is not None and number.quantity.dimension != "direction":
                least = "" if number.quantity.negative else 0
                yield {"k": k, "path": path, "unit": self.scene.all_units[number.quantity.dimension][0], "least": least}

    def _asked(self) -> Iterator[DesignNumber]:
        assert self.program is not None
        scene, named, known = self.scene, units(self.study.reference), set(self.program["channels"])
        pins = {f"{pin.channel}.force": f"Pin {pin.channel}: {pin.first} on {pin.second}" for pin in scene.pins}
        rates = {f"{scene.output}.{of}": f"{scene.output}: {of}" for of in ("speed", "acceleration")}
        vectors = {name: both for name, both in magnitudes(scene).items() if known.issuperset(both)}
        for name in [name for name in pins if name in vectors]:
            yield DesignNumber(pins[name], "largest", [*vectors[name]], *named["N"])
        singles = {f"{body}.guide_force": f"Guide on {body}: force" for body in scene.slides}
        singles |= {scene.effort_channel: f"Drive: {quantity(scene.effort_channel)}"}
        for channel, name in singles.items():
            if channel in known:
                yield DesignNumber(name, "largest", [channel], *named[UNITS[quantity(channel)]])
        for name in [name for name in rates if name in vectors]:
            yield DesignNumber(rates[name], "largest", [*vectors[name]], *named[UNITS[quantity(vectors[name][0])]])
        guided = scene.guided(scene.output)
        along = (1.0, 0.0) if guided is None else guided[1].along
        output = [f"{scene.output}.{q}" for q in "xy"]
        if known.issuperset(output) and guided is not None and guided[1].on == GROUND:
            yield DesignNumber(
                f"{scene.output}: stroke", "range", output, *named["m"], (float(along[0]), float(along[1]))
            )
        if angles := [channel for channel in self.program["channels"] if quantity(channel) == TRANSMISSION]:
            yield DesignNumber("Least transmission angle", "least", angles, 180 / np.pi, "°")
