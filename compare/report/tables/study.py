"""The report's tables, as rows, and its sentences: for `summary.json`, the page and the terminal."""

from collections.abc import Iterable, Iterator, Mapping
from enum import Enum
from json import dumps
from math import inf, isnan, nan
from typing import get_type_hints

import numpy as np

from scenes import Scene, Status
from scenes.channels import Role
from scenes.drive import Drive
from scenes.scene import ConstantSpeed

from ...engines import registry
from ...judge.errors import by_group as grouped
from ...judge.errors import shown_groups, worst_of
from ...judge.sketch import off_sketch
from ...mechanics.axis import axis, cycle_name, turns_fully
from ...mechanics.bodies import first_point, rule, weights
from ...mechanics.quantities import named, spelled
from ...mechanics.reference import Floor
from ...study import Study
from ..numbers import capital, units
from . import TableRows

# Figures of an error that the table by group has, as `ChannelError` names them.
FIGURES = ("max", "rms", "last_turn_max", "toggle_max", "commanded_max", "commanded_rms", "explained")
GATE = ("engine", "group", "tolerance", "error", "met", "worst")  # what the table of tolerances has of each


def overview(study: Study, *, timed: bool = True) -> TableRows:
    """Yield a row per engine: status, largest error by group, times if asked. Failed engines keep their row."""
    for run, worst in ((m.run, m.worst()) for m in study.measurements):
        label, promise = (run.settings.label, f"{run.settings.promise:.0e}") if run.settings else ("", "")
        named = {"engine": run.engine, "status": run.status.name, "setting": label, "promise": promise}
        seconds = {"build": run.build_s, "solve": run.solve_s, "read": run.read_s} if timed else {}
        errors = {group: worst.get(group, nan) for group in ("drive", *shown_groups(study.scene))}
        yield {**named, **errors, **{f"{stage} [ms]": 1e3 * time for stage, time in seconds.items()}}


def errors(study: Study) -> TableRows:
    """The errors of every engine and channel."""
    return [row._asdict() for row in study.channel_errors]


def errors_shown(study: Study) -> TableRows:
    """Yield the same with the scales in the units of the page."""
    shown = units(study.reference)
    for row in study.channel_errors:
        factor, unit = shown.get(row.unit, (1.0, spelled(row.unit)))
        yield row._replace(scale=factor * row.scale, unit=unit)._asdict()


def gates(study: Study) -> TableRows:
    """Every tolerance of the scene, the error measured, and whether it was met."""
    return [{column: getattr(gate, column) for column in GATE} for gate in study.held]


def by_group(study: Study) -> TableRows:
    """Yield the largest errors of every engine and group: whole run, last turn, toggle windows, commanded position."""
    for measured in study.measurements:
        largest = {figure: measured.worst(figure) for figure in FIGURES}
        for group, errors in grouped(measured.errors).items():
            worst, figures = worst_of(errors), {figure: sizes[group] for figure, sizes in largest.items()}
            place = {"worst_channel": worst.channel, f"max_at [{axis(study.scene).unit}]": worst.max_at}
            yield {"engine": measured.run.engine, "group": group} | figures | place


def checks(study: Study) -> TableRows:
    """Yield the worst violation of each reference-free check by engine, and the body with it."""
    places = [abs(check.max_at) for m in study.measurements for check in m.checks if not isnan(check.max_at)]
    for m in study.measurements:
        for kind in dict.fromkeys(check.check for check in m.checks):
            of_kind = (check for check in m.checks if check.check == kind)
            check = max(of_kind, key=lambda c: inf if isnan(c.worst) else c.worst)
            named = {"engine": m.run.engine, "check": kind, "of": check.of, "worst": check.worst}
            place = check.max_at if abs(check.max_at) > 1e-6 * max(places, default=0) else 0.0  # round-off of 0
            yield {**named, f"max_at [{axis(study.scene).unit}]": place, "relative to": check.relative_to}


def peaks(study: Study) -> TableRows:
    """Yield a row per number of the designer's, in SI, and by how much each engine differs on it."""
    place = f"at [{study.scene.channels[axis(study.scene).channel].unit}]"
    engines = dict.fromkeys(engine for peak in study.peaks for engine in peak.differs)
    for peak in study.peaks:
        named = {"name": peak.name, "of": peak.of, "value": peak.value, "unit": peak.unit, place: peak.position}
        differ = {f"{engine} differs by": peak.differs.get(engine, nan) for engine in engines}
        yield {**named, "direction [rad]": peak.direction, "channel": peak.channel, **differ}


def residuals(study: Study) -> TableRows:
    """Yield every engine's own convergence checks and counters."""
    for run in (m.run for m in study.measurements):
        for name, value in (*run.residuals.items(), *run.counters.items()):
            yield {"engine": run.engine, "quantity": name, "value": value}


def sketch(study: Study) -> TableRows:
    """Yield how far the linkage's points are from where the sketch shows them, the farthest first."""
    (factor, unit), largest = units(study.reference)["m"], study.reference.mechanics.size
    for point, distance in sorted(off_sketch(study.reference).items(), key=lambda item: -item[1]):
        yield {"point": point, f"distance [{unit}]": factor * distance, "of the largest length": distance / largest}


def masses(study: Study, in_units: Mapping[str, tuple[str, float]] | None = None) -> TableRows:
    """Yield what mass, centre of mass and inertia each body was taken to have, and by which rule; of no kinematic one.

    In units of length and mass, name and size in SI: the page's and the file's where none are given.
    """
    scene, (factor, metre) = study.scene, units(study.reference)["m"]
    known = in_units or {**scene.units, "length": (metre, 1 / factor)}
    (length, m), (mass, kg) = (known[name] for name in ("length", "mass"))
    for name, body in scene.bodies.items() if scene.has_masses else ():
        weight = weights(scene, body)
        com = (weight.com + first_point(body)) / m
        placed = {f"mass [{mass}]": weight.mass / kg, f"com x [{length}]": com.real, f"com y [{length}]": com.imag}
        turned = {f"inertia [{mass}*{length}^2]": weight.inertia / (kg * m**2), "taken as": rule(scene, body)}
        yield {"body": name, **placed, **turned}


def settings(study: Study) -> TableRows:
    """Yield the settings of every engine's run, their values and meanings, but for texts that are empty."""
    for run in (m.run for m in study.measurements if m.run.settings):
        meanings = get_type_hints(type(run.settings), include_extras=True)
        for name, value in vars(run.settings).items():
            if value != "":
                shown = {"setting": name.replace("_", " "), "value": _value(value)}
                yield {"engine": run.engine, **shown, "meaning": meanings[name].__metadata__[0]}


def _value(value: object) -> object:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Mapping):
        return dumps(value, ensure_ascii=False)
    return value.value if isinstance(value, Enum) else value


# --- sentences -------------------------------------------------------------------------------------------------------


def setup(study: Study) -> str:
    """What was run, in one sentence."""
    scene, sampling, cycle = study.scene, study.sampling, cycle_name(study.scene)
    cycles = f"one {cycle}" if sampling.turns == 1 else f"{sampling.turns} {cycle}s"
    motions = (f"{drive.body} {_motion_of(scene, drive)}" for drive in scene.drives)
    run = f"The {' and '.join(motions)}, {cycles}, {sampling.samples} samples per {cycle}"
    return f"{run}. Reference, group by group (R: pin, P: slide): {registry.route(scene)}."


def _motion_of(scene: Scene, drive: Drive) -> str:
    law = drive.law
    if not isinstance(law, ConstantSpeed):
        return f"by a motion law of {law.cycle:g} s{', again and again' * law.periodic}"
    unit, size = scene.units["speed"]
    speed = f"at {law.speed / size:g} {named(unit)}".replace("-", "−")
    return speed if turns_fully(scene) else f"{speed} from {axis(scene).text(law.start, float(law.after(1)))}"


def scales(scene: Scene) -> str:
    """The scales of errors where the drive is more than a crank at constant speed."""
    if any(drive.slide for drive in scene.drives):
        return " ω is the drive's peak speed over its travel."
    return "" if scene.steady else " ω is the drive's peak rate."


def notes(study: Study) -> list[str]:
    """What a reader must know: how the floor was found, why runs failed, which channels are missing and why."""
    sentences = [*floors([study.reference.floor])]
    if study.sampling.channels is not None:
        given = study.scene.channels.names(Role.time, Role.input)
        asked = ", ".join(name for name in study.sampling.wanted(study.scene) if name not in given)
        sentences.append(f"Asked for: {asked}; checks and tolerances of other channels are left out.")
    sentences += [f"{capital(reason)}." for reason in study.reasons]
    for run in (m.run for m in study.measurements):
        if run.status is not Status.ok:
            sentences.append(f"{run.engine}: {run.status.name}. {run.status.value} Here: {run.reason}.")
        if run.motion is not None:
            sentences += [f"{run.engine} gives no {c}: {why}." for c, why in run.motion.unsupported.items()]
    return sentences + [f"Likely cause: {cause}." for cause in study.causes.values()]


def floors(given: Iterable[Floor]) -> Iterator[str]:
    """Yield a sentence for each way by which floors of the reference were found, with the largest of them."""
    by_way: dict[str, list[float]] = {}
    for floor in given:
        by_way.setdefault(floor.by, []).extend(floor.by_channel.values())
    for way, errors in by_way.items():
        size = f"off by {np.max(errors):.1e} at most, relative, by a calculation with 50 digits: " if errors else ""
        yield f"The reference is {size}{way}."
