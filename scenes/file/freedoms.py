"""Which bodies the joints leave loose, and what holds bodies twice, where the count of freedoms is wrong.

A pin or a slide is two equations of the three coordinates of each of its bodies, the drive is one; the ground has none.
Each equation is matched to a coordinate that occurs in it (Dulmage and Mendelsohn). Bodies are loose while the drive is
held whose coordinates are left over, or could be in place of one that is. Where there are too many joints, each body
and each joint is left out in turn, until the rest is determined. Only joints are counted: that a linkage moves all the
same because of its lengths, as a parallelogram with a third crank does, is not seen.
"""

from collections import Counter
from collections.abc import Collection, Iterable
from difflib import get_close_matches
from typing import NamedTuple

from ..joints import DriveJoint, Guide, Pin
from ..model.constraints import Pattern, matched
from ..scene import GROUND, Scene

ALIKE = 0.75  # by difflib: names that are likely meant to be one
LISTED, MANY = 3, 6  # things of a kind that a message names
TRIED = 40  # bodies, and joints, that are left out to see what the rest does


class Held(NamedTuple):
    """A joint between two bodies, one of which may be the ground."""

    name: str  # as messages have it
    first: str
    second: str
    equations: int = 2


def cause(scene: Scene, mobility: int) -> str:
    """What to look at in a linkage whose mobility is not 1, in words."""
    if mobility < 1:
        return _superfluous(scene)
    if meant := slips(scene, scene.owners):
        return meant
    loose = loose_bodies(scene)
    count = Counter(body for joint in _joints(scene) for body in (joint.first, joint.second))
    ends = [name for name in dict.fromkeys((*loose, scene.drive.body)) if count[name] < 2]
    held = [held for name in ends[:LISTED] if (held := _held_by_one(scene, name))]
    return "; ".join(filter(None, (", ".join(held) or _chain(loose), ", ".join(_alone(scene, loose, ends)[:LISTED]))))


def slips(scene: Scene, points: Iterable[str]) -> str:
    """Which of some points are on one body alone, and have nearly the name of a point of another; or nothing."""
    meant: dict[str, str] = {}
    # A misspelt pin shows as two points that one body each has, with names alike. A point of the sketch is taken for
    # the right one of the two, because its name was written twice.
    alone = [point for point in points if len(scene.owners[point]) == 1]
    for point in sorted(alone, key=lambda point: point in scene.drawn):  # one that is sketched is right
        (owner,) = scene.owners[point]
        others = [name for name, owners in scene.owners.items() if owner not in owners and name not in meant]
        if point not in meant.values() and (close := _alike(scene, point, others)):
            meant[point] = close
    listed = [f"point '{p}' is on {_on(scene.owners[p][0])} alone; did you mean '{q}'?" for p, q in meant.items()]
    return " ".join(listed[:LISTED])


def _alike(scene: Scene, point: str, others: Collection[str]) -> str:
    """The name of another point but for capitals and '_', or of one alone but for a slip that is not of its number."""
    same = next((name for name in others if _letters(name) == _letters(point)), "")
    if same or point in scene.drawn:
        return same
    alone = [
        name for name in others if len(scene.owners[name]) == 1 and _without_number(name) != _without_number(point)
    ]
    return next(iter(get_close_matches(point, alone, n=1, cutoff=ALIKE)), "")


def _letters(name: str) -> str:
    return name.casefold().replace("_", "")


def _without_number(name: str) -> str:
    return name.rstrip("0123456789")


def _joints(scene: Scene, without: str = "") -> list[Held]:
    """The joints of a linkage but its drive, or of what is left of it without one of its bodies."""
    found = []
    for point, owners in scene.owners.items():
        first, *others = [owner for owner in owners if owner != without] or [""]
        found += [Held(f"the pin {point} of {first} and {other}", first, other) for other in others]
    slides = [(name, slide.on) for name, slide in scene.slides.items() if without not in (name, slide.on)]
    found += [Held(f"the guide of {name}", on, name) for name, on in slides]
    more = (joint for joint in scene.joints if not isinstance(joint, Pin | Guide | DriveJoint))
    return found + [Held(each.label, *each.between, each.equations) for each in more if without not in each.between]


def _pattern(scene: Scene, bodies: Iterable[str], joints: Iterable[Held]) -> Pattern:
    """By equation the coordinates that occur in it: three a body, in order; the equation of the drive is the last."""
    first = {body: 3 * number for number, body in enumerate(bodies)}
    ends = [(joint.first, joint.second) for joint in joints for _ in range(joint.equations)] + [
        (scene.drive.on, scene.drive.body)
    ]
    return [[first[body] + k for body in pair if body in first for k in range(3)] for pair in ends]


def loose_bodies(scene: Scene) -> list[str]:
    """The bodies that can move while the drive is held, in the order of the file."""
    pattern = _pattern(scene, scene.bodies, _joints(scene))
    equation = matched(pattern)
    coordinate = {row: column for column, row in equation.items()}
    # The under-determined part of Dulmage and Mendelsohn's decomposition: from a coordinate without an equation, to
    # every matched equation that has it, to the coordinate that is matched there, which could be left over in its
    # place. By a theorem of theirs the part does not depend on which maximum matching was found.
    reached = [column for column in range(3 * len(scene.bodies)) if column not in equation]
    for column in reached:
        freed = (coordinate[row] for row, columns in enumerate(pattern) if column in columns and row in coordinate)
        reached += [other for other in dict.fromkeys(freed) if other not in reached]
    return [body for number, body in enumerate(scene.bodies) if any(column // 3 == number for column in reached)]


def _held_by_one(scene: Scene, name: str) -> str:
    """Where a body that has one joint alone may lack another; of a crank without a further point nothing."""
    points = scene.bodies[name].points
    if free := [point for point in points if len(scene.owners[point]) == 1]:
        return f"nothing holds {name} at {' or '.join(free[:LISTED])}"
    expected = f"nothing but its pin at {points[0]} holds {name}, expected its 'slides' or another pin"
    return expected if name != scene.drive.body else ""


def _chain(loose: Iterable[str]) -> str:
    listed = ", ".join([*loose][:MANY])
    return f"while the drive is held, {listed} can still move; a bar between two of their points takes one freedom"


def _alone(scene: Scene, loose: Collection[str], ends: Collection[str]) -> list[str]:
    """The points that one body alone has, and no load or spring: of loose bodies all, of others those not sketched."""
    used = {scene.output, *(point for _, element in scene.elements for _, point in element.ends)}
    alone = {point: owners[0] for point, owners in scene.owners.items() if len(owners) == 1 and point not in used}
    may_hold = {point: body for point, body in alone.items() if body not in ends}
    found = [(p, body) for p, body in may_hold.items() if body in (GROUND, *loose) or p not in scene.drawn]
    return [f"'{point}' is on {_on(body)} alone" for point, body in found]


def _on(body: str) -> str:
    return "the ground" if body == GROUND else body


def _superfluous(scene: Scene) -> str:
    """Without which body or joint the rest is determined; where there is none, which bodies are held twice."""
    joints, bodies, driven = _joints(scene), [*scene.bodies], {scene.drive.body, scene.drive.on}
    # Brute force over the bodies and the joints, one left out at a time, with a matching for each: quadratic in their
    # number, hence the limit. An answer of one joint says more to a reader than the whole over-determined part, which
    # is named only where no single thing is superfluous.
    fewer = {name: ([body for body in bodies if body != name], _joints(scene, name)) for name in bodies[:TRIED]}
    fewer |= {joint.name: (bodies, [other for other in joints if other != joint]) for joint in joints[:TRIED]}
    kept = {*driven, *(joint.name for joint in joints if {joint.first, joint.second} == driven)}
    without = [name for name, rest in fewer.items() if name not in kept and _determined(_pattern(scene, *rest), *rest)]
    if without:
        return f"without {', or without '.join(without[:MANY])} it would move"
    pattern = _pattern(scene, bodies, joints)
    equation = matched(pattern)
    # The over-determined part: from an equation without a coordinate, to every coordinate in it, to the equation that
    # has taken this. Every coordinate on the way is taken: a free one would end an augmenting path, and the matching is
    # a largest.
    reached = [row for row in range(len(pattern)) if row not in equation.values()]
    for row in reached:
        reached += [other for other in (equation[column] for column in pattern[row]) if other not in reached]
    held = {bodies[column // 3] for row in reached for column in pattern[row]} - driven
    return f"more joints than freedoms hold {', '.join([body for body in bodies if body in held][:MANY])}"


def _determined(pattern: Pattern, bodies: Collection[str], _: Collection[Held]) -> bool:
    """Whether there are as many equations as coordinates, and each has one of its own."""
    return len(pattern) == 3 * len(bodies) == len(matched(pattern))
