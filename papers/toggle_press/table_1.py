"""Toggle press: table 1 of Yang (2023), each entry by itself, and its columns against each other by virtual work.

Both presses are taken over a turn of their cranks, seen from the slider's lowest point. Without friction and inertia
the torque T on the crank and the force F on the slider do the same work: T w = F v. The direction in which the crank
turns and the strokes a minute, 40 to 60, are not given. The speeds are printed negative: y is up, and the slider goes
down while it closes.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import degrees, radians, tau

import numpy as np
from scipy.optimize import brentq

from compare.engines import registry
from scenes import Sampling, Scene, load
from scenes.model.inputs import passing
from scenes.model.motion import Samples

from ..claims import Claim, comparison, joined, limit, number, span
from .kinematics import BARS, BODIES, LENGTHS

TURN = Sampling(3600)
STEP = tau / TURN.samples
OTHERS = [f"bodies.{body}.lengths.{start}-{end}" for body, (start, end) in zip(BODIES, BARS, strict=True)][1:]
PATHS = ("bodies.crank.points.P2.0", *OTHERS)  # of the toggle press's lengths in its scene file
LENGTH_TOL = 0.5  # mm: lengths are printed without decimals
PART = 0.01  # by which one length of a member of the family is longer or shorter
DWELL_TOL = 0.01  # of the stroke: so near to its lowest point the slider dwells


@dataclass(frozen=True)
class Side:
    """One side of the lowest point, up to the highest; shape (n,)."""

    angle: Samples  # of the crank from where the slider is lowest, rad, increasing from zero
    height: Samples  # m, increasing from zero
    rate: Samples  # magnitude of the height's rate by the crank's angle, m/rad

    def at(self, height: float) -> tuple[float, float]:
        """Return angle, rad, and rate, m/rad, at a height, m."""
        return float(np.interp(height, self.height, self.angle)), float(np.interp(height, self.height, self.rate))


@dataclass(frozen=True)
class Press:
    """A press by the angle of its crank, counter-clockwise: before and after its slider is lowest."""

    before: Side
    after: Side

    @property
    def stroke(self) -> float:
        """The stroke, m."""
        return float(self.after.height[-1])

    @property
    def dwell(self) -> float:
        """Return for what part of a turn the slider is near its lowest point."""
        near = DWELL_TOL * self.stroke
        return (self.before.at(near)[0] + self.after.at(near)[0]) / tau

    @property
    def closing(self) -> Mapping[str, Side]:
        """The side on which the slider closes, by the direction in which the crank turns if they differ."""
        if abs(self.after.angle[-1] - self.before.angle[-1]) < STEP / 2:
            return {"": self.after}
        return {"clockwise": self.after, "counter-clockwise": self.before}


def press(name: str, changes: Mapping[str, float] | None = None) -> Press:
    """One turn of a press by the reference; Failure where it cannot be assembled over the whole turn."""
    scene = load(name, changes or {})
    y, vy = f"{scene.output}.y", f"{scene.output}.vy"
    solve = registry.reference(scene, frozenset((y, vy)))
    turn = lowest(scene) + STEP * np.arange(TURN.samples, dtype=float)
    motion = solve(passing(scene, turn, TURN.times(scene)[:-1]))
    # Rates by the crank's angle, vy / w, do not depend on the strokes a minute, which are not given. The side before
    # the lowest point is read backwards with negative rows: sample -k is k steps before, as the turn is periodic.
    height, rate = motion[y] - motion[y][0], np.abs(motion[vy]) / scene.pace
    highest = int(height.argmax())
    after, before = np.arange(highest + 1), -np.arange(TURN.samples - highest + 1)
    return Press(*(Side(STEP * np.abs(rows), height[rows], rate[rows]) for rows in (before, after)))


def lowest(scene: Scene) -> float:
    """The crank's angle where the slider is lowest, rad."""
    y, vy = f"{scene.output}.y", f"{scene.output}.vy"
    solve = registry.reference(scene, frozenset((y, vy)))
    # A zero of the velocity rather than a minimum of the height: the height is flat there and would give the angle to
    # the root of round-off, 1e-8, alone. The bracket is the coarse minimum with both its neighbours.
    coarse = registry.motion(scene, TURN, frozenset((y, vy)))
    near = 1 + int(coarse[y][1:-1].argmin())
    around = coarse["crank_angle"][[near - 1, near + 1]]
    return float(brentq(lambda angle: solve(passing(scene, [angle], [0.0]))[vy][0], *around, xtol=1e-13))


def rounded() -> list[Press]:
    """The toggle press as printed, and with its lengths at the ends of their rounding, in all combinations."""
    # The 64 corners of the rounding hold the range of a stroke that is monotone in each length over half a millimetre.
    ends = product(*((length - LENGTH_TOL, length + LENGTH_TOL) for length in LENGTHS))
    return [press("toggle_press", dict(zip(PATHS, lengths, strict=True))) for lengths in (LENGTHS, *ends)]


def family() -> Iterator[tuple[str, Press]]:
    """The toggle press with one length after the other changed, and what was changed."""
    for path, length, digit in zip(PATHS, LENGTHS, "₀₁₂₃₄₅", strict=True):
        for part in (1 - PART, 1 + PART):
            yield f"l{digit} = {part * length:g} mm", press("toggle_press", {path: part * length})


HEIGHT, FORCE = 6e-3, 1600e3  # m above the lowest point, N
HEIGHTS = (5.5e-3, HEIGHT, 6.5e-3)  # "6 mm" and the ends of its rounding
MIN_STROKES, MAX_STROKES = 40, 60  # strokes a minute
UNIFORM_TOL = 0.1  # of the largest speed: where it varies by more it is not uniform
TOGGLE, CRANK = "toggle press", "crank press"
PRINTED: Mapping[str, Mapping[str, str]] = {
    TOGGLE: {"angle": "36.0", "from": "135", "speed": "-112.6", "torque": "1563"},
    CRANK: {"angle": "20.6", "from": "153", "speed": "-228.2", "torque": "3615"},
}
SIGN = "printed negative: the slider goes down"


def speed(rate: float, strokes: float = MAX_STROKES) -> float:
    """The slider's speed, mm/s, by its rate, m/rad, and the strokes a minute."""
    return 1e3 * rate * tau * strokes / 60


def entries(toggle: Press, crank: Press, corners: Sequence[Press]) -> Iterator[Claim]:
    """Every row; `corners` are the toggle press within the rounding of its lengths."""
    yield from _column(TOGGLE, toggle, corners)
    yield from _column(CRANK, crank, [crank])
    yield from _virtual_work(toggle, corners)


def _column(name: str, press: Press, corners: Sequence[Press]) -> Iterator[Claim]:
    printed = PRINTED[name]

    def entry(label: str, value: Callable[[float, float], float], place: str = "", least: float = 1.0) -> Claim:
        """A row of a value by angle and rate; `place` is what it goes with, `least` the smallest possible share."""
        text = next(text for kind, text in printed.items() if kind in label)
        face = {way: value(*side.at(HEIGHT)) for way, side in press.closing.items()}
        ranges = [[value(*p.closing[way].at(height)) for p in corners for height in HEIGHTS] for way in face]
        there = " or ".join(f"{v:.5g} {way}".strip() for way, v in face.items())
        nearest = min(face.values(), key=lambda v: abs(v - float(text)))
        if place:
            level = float(place.partition(" ")[0])
            takes = " or ".join(f"{level * float(text) / v:.3g} {way}".strip() for way, v in face.items())
            there = f"{there} at {place}; the printed one takes {takes}"
        allowed = [span([*values, *(least * v for v in values)]) for values in ranges]
        note = joined(f"6 mm above the end, 5.5 to 6.5 mm for the range: {there}", SIGN if text.startswith("-") else "")
        return number(f"table 1 {label}, {name}", text, nearest, allowed=allowed, note=note)

    yield entry("pressure angle [deg]", lambda angle, _: degrees(angle))
    yield _uniform(name, printed["from"], press)
    yield _unit(name, printed["speed"], press)
    yield entry(
        "speed [mm/s]", lambda _, rate: -speed(rate), f"{MAX_STROKES} strokes a minute", MIN_STROKES / MAX_STROKES
    )
    yield entry("torque [N m]", lambda _, rate: FORCE * rate, f"{FORCE / 1e3:g} kN")


def _uniform(name: str, start: str, press: Press) -> Claim:
    parts = [side.rate[side.angle <= radians(180 - float(start))] for side in press.closing.values()]
    fastest = " or ".join(f"{speed(rates.max()):.0f}" for rates in parts)
    return comparison(
        f"table 1 uniform speed, {name}",
        f"from {start} to 180°",
        [rates.min() >= (1 - UNIFORM_TOL) * rates.max() for rates in parts],
        f"falls from {fastest} mm/s to {speed(max(rates.min() for rates in parts)):.0f}, at {MAX_STROKES} a minute",
        f"within 10 % of that 6 mm above {' or '.join(_steady(*way) for way in press.closing.items())}",
    )


def _steady(way: str, side: Side) -> str:
    """Return from where to where the speed is nearly that at the nominal height, in words."""
    angle, rate = side.at(HEIGHT)
    unlike = side.angle[np.abs(side.rate - rate) > UNIFORM_TOL * rate]
    ends = 180 - np.degrees((unlike[unlike > angle].min(), unlike[unlike < angle].max()))
    return f"from {ends[0]:.0f} to {ends[1]:.0f}° {way}".strip()


def _unit(name: str, printed: str, press: Press) -> Claim:
    """The row of the speed's unit: no speed of the slider can be above its peak over the whole turn."""
    peak = speed(max(side.rate.max() for side in press.closing.values())) / 1e3
    size = abs(float(printed))
    return limit(
        f"table 1 unit of the speed, {name}",
        f"{printed} m/s",
        size - peak,
        (size - peak, size - peak),
        scale=peak,
        computed=f"at most {peak:.3f} m/s over the whole turn, at {MAX_STROKES} a minute",
        corrected=("mm/s", size / 1e3 - peak),
        note=SIGN,
    )


def _virtual_work(toggle: Press, corners: Sequence[Press]) -> Iterator[Claim]:
    """Yield rows on entries of table 1 together: its speeds, torques and force, and its speed and a conclusion."""
    for name, printed in PRINTED.items():
        v, torque = abs(float(printed["speed"])) / 1e3, float(printed["torque"])
        low, high = (torque * tau * strokes / 60 / v / 1e3 for strokes in (MIN_STROKES, MAX_STROKES))
        yield number(
            f"table 1 virtual work, {name}: nominal force [kN]",
            "1600",
            high,
            allowed=[(low, high)],
            among_printed=True,
            note="torque times the crank's speed over the slider's speed, both as printed, but for the sign",
        )
    torques, speeds = ([float(PRINTED[name][column]) for name in PRINTED] for column in ("torque", "speed"))
    share = speeds[0] / speeds[1]
    yield number(
        "table 1 virtual work, ratio of the torques",
        f"{torques[0] / torques[1]:.3f}",
        share,
        allowed=[(share * MIN_STROKES / MAX_STROKES, share * MAX_STROKES / MIN_STROKES)],
        among_printed=True,
        note="the ratio of the speeds, at the same force and as many strokes a minute",
    )
    quick = {way: side for way, side in toggle.closing.items() if side.angle[-1] > tau / 2}
    for way, side in quick.items():
        rates = [p.closing[way].at(height)[1] for p in corners for height in HEIGHTS]
        yield number(
            f"table 1 speed, {TOGGLE}, with the quick return of conclusion 2 [mm/s]",
            PRINTED[TOGGLE]["speed"],
            -speed(side.at(HEIGHT)[1]),
            allowed=[span(-speed(rate, strokes) for rate in rates for strokes in (MIN_STROKES, MAX_STROKES))],
            among_printed=True,
            note=f"it returns quickly only {way}; {SIGN}",
        )
