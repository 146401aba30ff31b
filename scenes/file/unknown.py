"""Why a key of a file is unknown: a slip, a word of another program, or what is beyond these models."""

from collections.abc import Iterator, Sequence
from typing import get_origin, get_type_hints

from pydantic import BaseModel

from ..errors import nearest, path_in_file
from ..fields import parts

PAGE = "docs/limits.md"
PLACES = 3  # tables that a message names
BEYOND = {  # what these models have instead, by words for what they have not; the page has these words too
    "gear gearbox rack pinion cam follower belt chain pulley rope": (
        "no such joint here, bodies are joined by pins and straight slides"
    ),
    "mimic": "no motion copies another one here; one that is known is the drive's, by its 'law'",
    "joint constraint revolute prismatic hinge weld": (
        "no list of joints here: a point that two bodies name is a pin, a guide is the 'slides' of a body"
    ),
    "clearance backlash play": "no clearance here, joints are without play",
    "contact collision stop bumper": "nothing touches here but in joints, which never open",
    "bushing compliance": "no joint gives way here; springs are in [[springs]] and [[torsion_springs]]",
    "flexible elastic youngs_modulus material section": "nothing bends here, bodies are rigid",
    "motor actuator motor_torque drive.torque drive.force": (
        "a drive is not pushed, expected its motion, by which this is found"
    ),
    "initial_velocity initial_position initial_condition": (
        "nothing moves by itself here, expected the drive's motion, from which all other motions follow"
    ),
    "static_coefficient stiction": "no joint sticks here, friction is of joints that move",
    "drives": "one drive alone moves a linkage, expected [drive]",
    "spherical universal": "no motion in space here, the axes of all pins are parallel",
}
OTHER_WORDS = {  # for keys, by the words that others have for them
    "max maximum upper": "most",
    "min minimum lower": "least",
    "weight": "mass",
    "force torque": "moment loads",
    "moment": "loads",
    "link part member": "bodies",
    "rpm omega velocity rate": "speed",
    "stop finish": "end",
    "point": "at",
    "mu": "coefficient",
    "center centre cog": "com",
    "rest_length free_length": "length",
    "moment_of_inertia": "inertia",
    "k": "stiffness",
    "c": "damping",
    "damper": "damping springs",
    "guide": "slides",
    "direction axis": "along",
    "origin": "through",
    "node coordinate coord": "points",
    "initial_angle": "start",
}


def unknown(file: type[BaseModel], table: type[BaseModel], location: Sequence[int | str], given: object) -> str:
    """Why the last key of a place in a file is unknown to its table, and what is expected instead."""
    key, known = str(location[-1]), table.model_fields
    word, beyond = key.lower(), {word: why for words, why in BEYOND.items() for word in words.split()}
    names = ".".join(map(str, location)), word, word.removesuffix("s")
    meant = (keys.split() for words, keys in OTHER_WORDS.items() if not {*names}.isdisjoint(words.split()))
    if mine := next((name for keys in meant for name in keys if name in known), None):
        return f"unknown key; did you mean '{mine}'?"
    if why := next((beyond[name] for name in names if name in beyond), None):
        return f"{why}; see {PAGE}"
    if location[0] == "limits" and "." not in str(location[1]) and isinstance(given, dict | float | int):
        channel = path_in_file(location[1:])
        return f'expected [limits."{channel}"], since a name with a point in it needs quotation marks'
    if "points" in known and isinstance(given, list):
        return f"unknown key; expected points in [{path_in_file(location[:-1])}.points]"
    if len(location) == 1 and isinstance(given, dict) and not {"points", "lengths"}.isdisjoint(given):
        return f"unknown key; expected a body as [bodies.{path_in_file(location)}]"
    if close := nearest(key, known, or_all=False):
        return f"unknown key{close}"
    if why := next((beyond[name] for name in word.split("_") if name in beyond), None):
        return f"{why}; see {PAGE}"
    headings = [heading for heading, other in tables(file) if key in other.model_fields]
    if headings := [heading for heading in headings if not heading.startswith(("units", "tolerances"))]:
        top = "the top of the file, above its first [table]"
        places = " or ".join(f"[{heading}]" if heading else top for heading in headings[:PLACES])
        return f"unknown key here; '{key}' belongs to {places}"
    return f"unknown key{nearest(key, known)}"


def tables(file: type[BaseModel], heading: str = "") -> Iterator[tuple[str, type[BaseModel]]]:
    """Yield all tables that a file may have, each with its heading, as `bodies.NAME.slides`."""
    yield heading, file
    for key, hint in get_type_hints(file, include_extras=True).items():
        inner = [*parts(hint)] if key in file.model_fields else []
        name = ".NAME" if any(get_origin(part) is dict for part in inner) else ""
        for part in inner:
            if isinstance(part, type) and issubclass(part, BaseModel):
                yield from tables(part, f"{heading}.{key}{name}".strip("."))
