"""What the page needs to solve the linkage anew: the core's formulas as a script, its numbers, and what they are of.

A scene file demands more of the numbers than the formulas ask for: sums above zero, of numbers times 1 or -1; and
triangles that are flat or not, as those drawn, by their sides, each a length or two points' coordinates: a uniform body
does not become a plate where it was drawn as a bar.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from fnmatch import fnmatch
from functools import cached_property
from itertools import combinations, pairwise, product
from typing import Any, TypeAlias

import numpy as np

from scenes import Scene
from scenes.bodies import LINE, Body
from scenes.channels import TRANSMISSION
from scenes.elements import LISTS
from scenes.file.changes import at_path
from scenes.limits import NAME
from scenes.scene import ConstantSpeed, TorsionSpring

from ...engines import registry
from ...judge.proof import channels_of
from ...measure.many.machines import draws
from ...mechanics.quantities import spelled
from ...study import Study
from ..linkage.moving import ROUND_OFF_TOL, MovingPicture
from ..numbers import units
from ..pages.html import packed
from ..plain import plain

Signs: TypeAlias = Mapping[str, int]  # by path, 1 or -1
Sides: TypeAlias = list[list[str]]

SEED, MACHINES = 0, 500  # of the machines that the page draws: as `--monte-carlo 500` does
EXACT_SAMPLES = 24  # of the run that are kept to the last digit, against which the page checks itself


class Bench:
    """A report's linkage, to be solved by the page at the samples of its moving picture."""

    def __init__(self, study: Study, moving: MovingPicture) -> None:
        self.study, self.scene, self.rows = study, study.scene, moving.rows
        self.program: Mapping[str, Any] = {}  # nothing where the page cannot solve the linkage
        if study.sampling.channels is None and self.scene.tables:
            drive = self.scene.channels.drive.position
            position, time = (study.motion[channel][self.rows] for channel in (drive, "time"))
            self.program = registry.page_program(self.scene, position, time) or {}
        self._places = {path: place for place, path in enumerate(self.program.get("numbers", ()))}

    @cached_property
    def data(self) -> str:
        """The text that the page's script unpacks."""
        scene, values = self.scene, self.program["values"]
        kept = sorted({*np.linspace(0, len(self.rows) - 1, EXACT_SAMPLES).round().astype(int).tolist()})
        samples = [self.study.motion[channel][self.rows[kept]] for channel in self.program["channels"]]
        numbers = [{"path": path, "value": value} for path, value in zip(self.program["numbers"], values, strict=True)]
        for number in numbers:
            if (entry := scene.numbers.get(number["path"])) is not None:  # rather than where a stroke ends
                number |= {"size": scene.size(entry), "zero": entry.quantity.zero}
        data = {
            **self.program,
            "numbers": numbers,
            "exact": {"rows": kept, "samples": samples},
            "peaks": [self._peak(channel) for channel in self.program["channels"]],
            "turning": [name for name in self.program["channels"] if scene.channels[name].modulo_turn],
            "paths": scene.moving_points,
            "extent": scene.drive.law.extent,
            "points": {point: [*self._moves(point)] for point in scene.owners},
            "asked": self.asked,
            "along": (guided := scene.guided(scene.output)) and guided[1].along,
            "machines": self._machines(),
            "limits": [*self._limits()],
            "law": self._law(),
            "wound": dict(self._wound()),
            "demands": [*demands(scene, self._places)],
            "height": LINE,
            "tables": self._tables() | {"name": self.edited},
        }
        return packed(json.dumps(plain(data), separators=(",", ":")).encode())

    @property
    def edited(self) -> str:
        """What the scene is named with other numbers."""
        ending = "_edited"
        return self.scene.name[: NAME - len(ending)] + ending

    def _tables(self) -> dict[str, Any]:
        """The scene's tables, by points where the lengths of a body close on one line alone."""
        tables, metre = deepcopy(dict(self.scene.tables)), self.scene.units["length"][1]
        for name, body in self.scene.bodies.items():
            if body.local is not None and tables["bodies"][name].pop("lengths", None):
                points = {point: [float(f"{q / metre:.12g}") for q in place] for point, place in body.local.items()}
                tables["bodies"][name]["points"] = points
        for key, kind in LISTS.items():
            for table, zero in product(tables.get(key, ()), kind.zeros):
                table.setdefault(zero, 0)  # as of a damper, which may get a stiffness
        return tables

    def _peak(self, channel: str) -> float:
        """What the page's difference of a channel is a part of: its peak, or where that is round-off its scale."""
        scale, peak = self.study.reference.scale.get(channel, 1.0), float(np.abs(self.study.motion[channel]).max())
        return peak if peak > ROUND_OFF_TOL * scale else scale

    def _moves(self, point: str) -> Iterator[Mapping[str, Any]]:
        """Yield by body what of it changes when a point is dragged: lengths by their other ends, coordinates, a guide.

        The driven body comes first and then one that slides, since the others follow what drive and guide leave free;
        none where a body slides with more than one point, or as its drive asks.
        """
        index, scene = self._places, self.scene
        if point in scene.ground:
            yield {"ground": [index.get(f"ground.points.{point}.{q}", -1) for q in range(2)]}
            return
        owners = [scene.bodies[name] for name in scene.owners[point]]
        if any(body.slide is not None and (len(body.points) > 1 or body.name in scene.driven) for body in owners):
            return
        for body in sorted(owners, key=lambda body: (body.name not in scene.driven, body.slide is None)):
            pairs, places = {other: _length(body, point, other) for other in body.points}, _coordinates(body, point)
            axis = body.points[:2] if body.name in scene.driven else ()  # whose angle is the drive's
            yield {
                "body": body.name,
                "pivot": next((other for other in axis if other != point), "") if point in axis else "",
                "lengths": [[index[path], other] for other, path in pairs.items() if path in index],
                "local": [index.get(path, -1) for path in places]
                if places[0] in index and len(body.points) > 1
                else [],
                "slide": body.slide,
            }

    def _machines(self) -> Mapping[str, Any]:
        """The numbers that vary from machine to machine, and by how much those of the drawn machines are off, SI.

        Left out are those on which nothing depends, as the inertia of a body that does not turn.
        """
        scene, places = self.scene, self._places
        drawn = draws(scene, SEED, 0, MACHINES) if scene.variations else {}
        varied = [(scene.numbers[at_path(scene, path)], values) for path, values in drawn.items()]
        offsets = {places[n.path]: values * scene.size(n) - n.value for n, values in varied if n.path in places}
        return {"numbers": [*offsets], "off": [*offsets.values()]}

    def _wound(self) -> Iterator[tuple[str, Sequence[str]]]:
        """Yield the torsion springs whose angles the page follows over whole turns, with those of both bodies."""
        for place, spring in self.scene.of_type(TorsionSpring).items():
            if place in self.program["given"]:
                yield place, [self._angle(spring.second), self._angle(spring.first)]

    def _angle(self, body: str) -> str:
        turning = self.scene.channels.bodies
        return turning[body].angle if body in turning else ""

    def _law(self) -> Mapping[str, Any] | None:
        """The pieces of a motion law, how long they take where they are repeated, s, and how far they lead."""
        law = self.scene.drive.law
        if isinstance(law, ConstantSpeed):
            return None
        first, last = law.after([0, 1])
        return {"pieces": law.pieces, "cycle": law.cycle if law.periodic else 0, "gain": last - first}

    def _limits(self) -> Iterator[Mapping[str, Any]]:
        """Yield the scene's limits with the channels that each is of."""
        for name, limit in self.scene.limits.items():
            channels = [*channels_of(self.scene, name, self.program["channels"])]
            if {*channels} <= {*self.program["channels"]}:
                kind = "largest" if name in self.scene.channels.magnitudes else "least"
                ends = {"least": limit.least, "most": limit.most}
                yield {"channels": channels, "kind": kind, "turns": self.scene.channels[name].modulo_turn, **ends}

    @cached_property
    def asked(self) -> Sequence[Mapping[str, Any]]:
        """What a design is asked for, of the channels that the page solves for, in the units of the page.

        That is the `largest` length of a vector, the `least` of some channels, or the `range` of the output along its
        guide. What is no more than `zero`, SI, is round-off.
        """
        scene, named, known = self.scene, units(self.study.reference), self.program["channels"]
        rows = scene.channels
        pins = {pin.channel: f"{pin.first} on {pin.second}" for pin in scene.pins}
        largest = {force: f"Pin {pin}: {pins[pin]}" for pin, force in rows.forces_of_pins.items()}
        largest |= {names.force: f"Guide on {body}: force" for body, names in rows.guides.items()}
        if scene.has_masses:
            largest |= {rows.drive.effort: f"Drive: {rows[rows.drive.effort].quantity}"}
        rates = (row for row in map(rows.__getitem__, rows.magnitudes) if row.kind == "point")
        largest |= {row.name: f"{row.subject}: {row.quantity}" for row in rates if row.subject == scene.output}
        wanted = [(name, "largest", rows[c].unit, channels_of(scene, c, known)) for c, name in largest.items()]
        if scene.guided(scene.output) is not None:
            wanted.append((f"{scene.output}: stroke", "range", "m", rows.points[scene.output].place))
        wanted.append(("Least transmission angle", "least", "rad", channels_of(scene, TRANSMISSION, known)))
        asked = list[Mapping[str, Any]]()
        for name, kind, si, channels in wanted:
            if channels and {*channels} <= {*known}:
                zero = ROUND_OFF_TOL * max(self.study.reference.scale.get(channel, 1.0) for channel in channels)
                shown = {"factor": named[si][0], "unit": named[si][1], "zero": zero}
                asked.append({"name": name, "kind": kind, "channels": channels, **shown})
        return asked

    @property
    def editable(self) -> Iterator[Mapping[str, Any]]:
        """Yield the numbers that a reader may change: their places among all, paths, and units of the file."""
        ends = set[str]()  # of periodic tables, whose values are the same
        for place, element in self.scene.elements:
            if (table := element.table) is not None and table.periodic:
                ends |= {f"{place}.table.{row}.1" for row in (0, len(table.values) - 1)}
        for path, k in self._places.items():
            number = self.scene.numbers.get(path)
            if number is not None and number.quantity.dimension != "direction" and path not in ends:
                unit, size = self.scene.all_units[number.quantity.dimension]
                most = number.quantity.largest / size
                least = -most if number.quantity.negative else 0
                if path == "drive.speed":  # of the same sign: the positions are those of the run
                    least, most = (0, most) if number.value > 0 else (least, 0)
                yield {"k": k, "path": path, "unit": spelled(unit), "least": least, "most": most}


def demands(scene: Scene, places: Mapping[str, int]) -> Iterator[Mapping[str, Any]]:
    """Yield what is wrong where a demand is not met, with the places of its numbers among all of the page."""
    for text, signs in _sums(scene):
        if signs.keys() <= places.keys():
            yield {"text": text, "terms": [[places[path], sign] for path, sign in signs.items()]}
    for body in scene.bodies.values():
        flat = len(body.corners) == 2
        text = f"{body.name} has a mass as a {'bar' if flat else 'plate'}, and needs 'com' and 'inertia'"
        for sides in _triangles(body):
            if all(path in places for side in sides for path in side):
                yield {"text": text, "flat": flat, "sides": [[places[path] for path in side] for side in sides]}


def _sums(scene: Scene) -> Iterator[tuple[str, Signs]]:
    for body in scene.bodies.values():
        for point, bases in body.bases.items():
            # Which side is the longest depends on the numbers that the reader types, so all three triangle inequalities
            # are demanded.
            sides = [_length(body, *pair) for pair in combinations((*bases, point), 2) if len(bases) == 2]
            text = f"the triangle of {', '.join((*bases, point))} cannot close"
            yield from ((text, {side: -1 if side == longest else 1 for side in sides}) for longest in sides)
    for place, element in scene.elements:
        for name, lack in element.least_above_zero.items():
            yield f"{place} {lack}", {f"{place}.{name}": 1}
        rows = [path for path in scene.numbers if fnmatch(path, f"{place}.table.*.0")]
        yield from ((f"the rows of {place}.table are out of order", {a: -1, b: 1}) for a, b in pairwise(rows))


def _triangles(body: Body) -> Iterator[Sides]:
    """Yield those of two corners and another point of a uniform body, by the paths of their sides."""
    if body.mass is not None and body.com is None and len(body.points) > 2:
        p, q, *_ = body.corners
        for r in (point for point in body.points if point not in (p, q)):
            pairs = (p, q), (q, r), (r, p)
            yield [_coordinates(body, *ends) if body.lengths is None else [_length(body, *ends)] for ends in pairs]


def _length(body: Body, first: str, second: str) -> str:
    return f"bodies.{body.name}.lengths.{'-'.join(sorted((first, second)))}"


def _coordinates(body: Body, *points: str) -> list[str]:
    return [f"bodies.{body.name}.points.{point}.{q}" for point in points for q in range(2)]
