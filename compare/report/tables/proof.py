"""What is proven, as rows and sentences: between the samples, and that these are all assemblies of a linkage."""

from collections.abc import Iterator, Sequence
from math import ceil, floor, inf, isinf, log10

from scenes import Scene
from scenes.channels import TRANSMISSION
from scenes.model.enclosures import Assemblies, Enclosure
from scenes.scene import ConstantSpeed

from ...engines import registry
from ...judge.agreement import Judgement
from ...judge.proof import place
from ...mechanics.axis import cycle_name, turns_fully
from ...mechanics.quantities import DIGITS, named, number, units, with_unit
from . import TableRows

UNKNOWN = "not known"
MAX_NAMED = 5  # channels in a sentence
WIDE = "bounds that grow from group to group are wider than these are ever large"
ZERO_TOL = 2e-6  # of the largest value of a unit: bounds on zero are known no better than this


def bounds(study: Judgement) -> TableRows:
    """A row a channel or magnitude: what it is never below and never above, and where it comes nearest to that."""
    rows: dict[str, dict[str, object]] = {}
    for row, shown in zip(study.proof.rows, _bounds(study, study.proof.rows), strict=True):
        never, where = ("never below", "least") if row.extreme == "least" else ("never above", "most")
        entry = rows.setdefault(row.channel, {"channel": row.channel})
        entry |= {never: shown, where: place(study.scene, row[4:])}
    return rows.values()


def _bounds(study: Judgement, rows: Sequence[Enclosure]) -> Iterator[str]:
    """Yield what each extreme is not beyond; of a bound that is farther off than the channel is ever large, nothing."""
    shown, sizes, largest = units(study.reference), dict(study.reference.scale), dict[str, float]()
    for row in study.proof.rows:
        unit, size = study.scene.channels[row.channel].unit, abs(_ends(row)[1])
        if not isinf(size):
            sizes[row.channel] = max(sizes.get(row.channel, 0.0), size)
            largest[unit] = max(largest.get(unit, 0.0), size)
    for row in rows:
        unit, sign = study.scene.channels[row.channel].unit, 1 if row.extreme == "most" else -1
        value, attained = _ends(row)
        if abs(value) <= ZERO_TOL * largest.get(unit, 0.0):
            yield "≈ 0" if value else "0"
        elif not abs(value - attained) <= sizes.get(row.channel, 0.0):
            yield UNKNOWN
        else:
            factor, name = shown.get(unit, (1.0, named(unit)))
            yield with_unit(_outwards(factor * value, factor * attained, sign), name)


def _outwards(value: float, attained: float, sign: int) -> str:
    """A bound as its extreme is written where both read alike, and otherwise rounded away from it."""
    # What is printed has to be true as a bound: a lower bound is rounded down, an upper one up.
    text = number(value)
    if text == number(attained):
        return text
    place = 10.0 ** (DIGITS - 1 - floor(log10(abs(value))))
    return number(sign * ceil(sign * value * place) / place)


def _ends(row: Enclosure) -> tuple[float, float]:
    """What an extreme is not beyond, and what it is beyond, at least up to rounding."""
    return (row.high, row.low) if row.extreme == "most" else (row.low, row.high)


def sentences(study: Judgement) -> Iterator[str]:
    """Yield what is proven, or where it is not, how many limits of the scene are met, and those that are not."""
    scene, proof = study.scene, study.proof
    extent = f"over the whole {'turn' if turns_fully(scene) else 'range of the drive'}"
    if proof.cycles is not None:  # forces go on from cycle to cycle
        cycle, count = cycle_name(scene), proof.turns
        known = f"{proof.cycles} of {count} {cycle}s" if proof.cycles < count else f"{count} {cycle}s"
        extent = f"over the first {cycle if count == 1 else known}"
    if proof.open_at is not None:
        claim = "that the linkage assembles" + " and friction leaves one set of forces" * bool(scene.friction)
        yield f"Not proven {extent}: {claim}, {place(scene, proof.open_at)}: {proof.why}."
    else:
        proofs = ["it assembles"]
        pins = {force: pin for pin, force in scene.channels.forces_of_pins.items()}
        forces = [row for row in proof.rows if row.extreme == "most" and row.channel in pins]
        largest = max(forces, key=lambda row: row.high, default=None)
        if largest is not None and (most := next(_bounds(study, [largest]))) != UNKNOWN:
            joint, where = pins[largest.channel], place(scene, largest[4:])
            proofs.append(f"no pin carries more than {most} ({joint} {where})")
        if registry.in_closed_form(scene):
            angles = [row for row in proof.rows if row[:2] == (TRANSMISSION, "least") and row.low > 0]
            proofs += [f"no transmission angle of a dyad is below {least}" for least in _bounds(study, angles)]
        else:
            proofs += _advantage(study)
        yield f"Proven {extent}: {', '.join(proofs)}."
        unknown = [row for row, shown in zip(proof.rows, _bounds(study, proof.rows), strict=True) if shown == UNKNOWN]
        if unknown:
            names, why = list(dict.fromkeys(row.channel for row in unknown)), proof.why or WIDE
            more = f" and {len(names) - MAX_NAMED} more" * (len(names) > MAX_NAMED)
            yield f"No bound is known of {', '.join(names[:MAX_NAMED])}{more}, {place(scene, unknown[0][4:])}: {why}."
    if (verdict := study.limits_verdict) is not None:
        yield verdict.sentence


def _advantage(study: Judgement) -> Iterator[str]:
    """Yield the least mechanical advantage of a linkage with a larger group, whose joints have no transmission angle.

    It is the output's force along its motion over the drive's effort, without friction and weights: by power, the rate
    of a steady drive over the output's speed, whose largest value is proven. Where the output rests it has no bound.
    """
    scene, shown = study.scene, units(study.reference)
    speed = scene.channels.find("point", scene.output, "speed")
    row = next((row for row in study.proof.rows if row[:2] == (speed and speed.name, "most")), None)
    law = scene.drives[0].law  # whose position stands for the time
    if row is None or not scene.steady or not isinstance(law, ConstantSpeed) or not 0 < row.low <= row.high < inf:
        return
    (newton, force), (per_effort, effort) = shown["N"], shown[scene.channels[scene.channels.drive.effort].unit]
    least, attained = (abs(law.speed) / speed * newton / per_effort for speed in (row.high, row.low))
    amount = _outwards(least, attained, -1)
    yield f"the output {scene.output} has at least {amount} {force} for each {effort} of the drive, without friction"


def assemblies(scene: Scene, every: Assemblies) -> TableRows:
    """A row an assembly: how far the sketch is from it, its circuit, and where it meets another."""
    return [
        {
            "assembly": number,
            "off the sketch by": scene.length(assembly.off_sketch),
            "meant": "yes" if assembly.meant else "",
        }
        | {"circuit": "–" if assembly.circuit is None else chr(ord("A") + assembly.circuit)}
        | {
            "meets another at": ", ".join(
                f"{scene.position(position)} ({joint} singular)" for position, joint in assembly.meets
            )
        }
        for number, assembly in enumerate(every.found, 1)
    ]


def how_many(scene: Scene, every: Assemblies) -> str:
    """How many assemblies there are, and whether the sketch is nearest to the one that it picks."""
    count = len(every.found)
    known = "" if every.complete else ", perhaps not all"
    counted = f"{count} assembl{'y' if count == 1 else 'ies'} at {scene.where(every.position)}{known}"
    return f"{counted}; the sketch picks {'the nearest to it' if every.found and every.found[0].meant else 'another'}"
