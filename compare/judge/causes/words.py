"""The words of a cause, as a page and a terminal show them: every number in them is written out."""

from collections.abc import Callable, Mapping
from math import atan2, hypot
from string import Formatter

from scenes import Scene

from ...mechanics.bodies import arms, weights
from ..verdict import plainly
from .cause import Cause

NEAR_ONE_TOL = 0.01 + 1e-9  # a factor that is no farther from one is shown in per cent
NEAR_TOL = 5e-3  # of a number: it is missing, or of the opposite sign; of a body's length: the centre of mass is there
NEAR_INERTIA_TOL = 2e-2  # of a moment of inertia: it is that of something else
# By the number of points that span a uniform body, and by how much of itself its moment of inertia is too large. A bar
# has m l^2 / 12: about its end m l^2 / 3, four times as much; as two point masses m l^2 / 4, three times. A triangular
# plate has m (a^2 + b^2 + c^2) / 36, and as three point masses four times that.
INERTIAS = {2: {3.0: "that about its end", 2.0: "that of two points"}, 3: {3.0: "that of three points"}}
MISSING = "missing"
NEAR_ZERO_TOL = 1e-3  # of a vector, or of a speed
MAX_REST_UNNAMED = 0.01  # of the error: what a cause leaves over of it is named where it is more


def words(scene: Scene, cause: Cause) -> str:
    """Return the sentence of a cause, with those that are wrong besides, or that explain as much."""
    ways = (" and ".join(_sentence(scene, part) for part in (each, *each.besides)) for each in (cause, *cause.others))
    return ", or ".join(ways) + f" (all but {100 * cause.left:.0f} % of the error)" * (cause.left > MAX_REST_UNNAMED)


def _sentence(scene: Scene, cause: Cause) -> str:
    gaps = {name: GAPS[name](scene, cause) for _, name, *_ in Formatter().parse(cause.text) if name}
    ends = " from {} to {}".format(*map(scene.where, cause.rows)) if len(cause.rows) > 1 else ""
    return cause.text.format_map(gaps) + ends


def _off(share: float) -> str:
    return f"{plainly(100 * abs(share))} % too {'large' if share > 0 else 'small'}"


def _times(_: Scene, cause: Cause) -> str:
    """Return a factor as what is wrong: `0.002 % too large`, `3 times what it should be`."""
    factor, they = cause.amounts[0], _of(cause, "it", "they")
    return _off(factor - 1) if abs(factor - 1) < NEAR_ONE_TOL else f"{plainly(factor, 4)} times what {they} should be"


def _percent(share: float) -> str:
    if abs(share + 1) < NEAR_TOL:
        return MISSING
    if abs(share + 2) < 2 * NEAR_TOL:
        return "of the opposite sign"
    return f"{plainly(share + 1, 4)} times too large" if share > 2 else _off(share)


def _stiffness(_: Scene, cause: Cause) -> str:
    how = _percent(cause.amounts[0])
    return " is missing" if how == MISSING else f"'s stiffness is {how}"


def _inertia(scene: Scene, cause: Cause) -> str:
    """Return how a moment of inertia is off, or what it is that of."""
    body, share = scene.bodies[cause.place], cause.amounts[0]
    known = {} if body.inertia is not None else INERTIAS.get(len(body.corners), {})
    return next((name for more, name in known.items() if abs(share - more) < NEAR_INERTIA_TOL), _percent(share))


def _com(scene: Scene, cause: Cause) -> str:
    body = scene.bodies[cause.place]
    com, placed = weights(scene, body).com, arms(scene, body)
    known = {f"at {point}": arm for point, arm in placed.items()}
    known |= {"mirrored": com.conjugate(), "on the opposite side": -com}
    there, hair = com + complex(*cause.amounts), NEAR_TOL * max(map(abs, placed.values()))
    distance = f"{_in_unit(scene, 'length', hypot(*cause.amounts))} off"
    return next((where for where, place in known.items() if abs(there - place) < hair), distance)


def _of(cause: Cause, single: str, many: str) -> str:
    return many if cause.part.many else single


def _in_unit(scene: Scene, quantity: str, value: float, digits: int = 3) -> str:
    unit, size = scene.all_units[quantity]
    return f"{plainly(value / size, digits)} {unit}"


def _numbers(_: Scene, cause: Cause) -> str:
    """Return the components of a vector; one that is nothing beside the others is zero."""
    least = NEAR_ZERO_TOL * max(map(abs, cause.amounts))
    return ", ".join(plainly(number if abs(number) > least else 0.0) for number in cause.amounts)


def _late(_: Scene, cause: Cause) -> str:
    lag, *rows = cause.amounts
    many = "".join(f" ({plainly(abs(count))} samples)" for count in rows)
    return f"{plainly(1e3 * abs(lag))} ms {'late' if lag > 0 else 'early'}{many}"


def _late_rows(_: Scene, cause: Cause) -> str:
    lag = int(cause.amounts[0])
    return f"{abs(lag)} sample{'s' * (abs(lag) > 1)} {'late' if lag > 0 else 'early'}"


def _faster(_: Scene, cause: Cause) -> str:
    share = cause.amounts[0]
    return "backwards" if abs(share + 2) < NEAR_ZERO_TOL else f"{'+' * (share > 0)}{plainly(100 * share)} %"


def _frame(scene: Scene, cause: Cause) -> str:
    mirrored, angle, x, y = cause.amounts
    parts = ["mirrored"] * bool(mirrored) + [f"turned by {_in_unit(scene, 'angle', angle, 4)}"] * bool(angle)
    least = NEAR_ZERO_TOL * hypot(x, y)
    place = "({}, {})".format(
        *(_in_unit(scene, "length", coordinate if abs(coordinate) > least else 0.0) for coordinate in (x, y))
    )
    return ", ".join(parts + [f"with its origin at {place}"] * bool(x or y))


GAPS: Mapping[str, Callable[[Scene, Cause], str]] = {
    "place": lambda _, cause: cause.place,
    "one": lambda _, cause: cause.names[0],
    "two": lambda _, cause: cause.names[1],
    "part": lambda _, cause: cause.part.name or cause.place,
    "is": lambda _, cause: _of(cause, "is", "are"),
    "has": lambda _, cause: _of(cause, "has", "have"),
    "its": lambda _, cause: _of(cause, "its", "their"),
    "where": lambda scene, cause: scene.where(cause.rows[0]),
    "count": lambda _, cause: f"{cause.amounts[0]:.0f}",
    "of": lambda _, cause: f"{cause.amounts[1]:.0f}",
    "long": lambda _, cause: "long" if cause.amounts[0] > 0 else "short",
    "share": lambda _, cause: plainly(abs(cause.amounts[0])),
    "number": lambda _, cause: plainly(cause.amounts[0]),
    "numbers": _numbers,
    "stiffness": _stiffness,
    "inertia": _inertia,
    "com": _com,
    "percent": lambda _, cause: _percent(cause.amounts[0]),
    "growth": lambda _, cause: f"{plainly(100 * cause.amounts[0])} %",
    "times": _times,
    "length": lambda scene, cause: _in_unit(scene, "length", hypot(*cause.amounts)),
    "wave": lambda scene, cause: _in_unit(scene, "length", hypot(*cause.amounts[1:])),
    "signed_length": lambda scene, cause: _in_unit(scene, "length", cause.amounts[0]),
    "force": lambda scene, cause: _in_unit(scene, "force", hypot(*cause.amounts), 4),
    "way": lambda scene, cause: _in_unit(scene, "angle", atan2(*reversed(cause.amounts)), 4),
    "angle": lambda scene, cause: _in_unit(scene, "angle", cause.amounts[0], 4),
    "displacement": lambda scene, cause: _in_unit(scene, "position", cause.amounts[-1]),
    "late": _late,
    "late_rows": _late_rows,
    "faster": _faster,
    "frame": _frame,
}
