"""All assemblies of a linkage, as rows and a sentence."""

from scenes import Scene
from scenes.model.enclosures import Assemblies

from . import TableRows


def ways(scene: Scene, every: Assemblies) -> TableRows:
    """A row an assembly: how far the sketch is from it, its circuit, and where it meets another."""
    return [
        {"assembly": number, "off the sketch by": scene.length(one.off_sketch), "meant": "yes" if one.meant else ""}
        | {"circuit": "–" if one.circuit is None else chr(ord("A") + one.circuit)}
        | {"meets another at": ", ".join(f"{scene.position(at)} ({joint} singular)" for at, joint in one.meets)}
        for number, one in enumerate(every.found, 1)
    ]


def sentence(scene: Scene, every: Assemblies) -> str:
    """How many there are, and whether the sketch is nearest to the one that it picks."""
    count = len(every.found)
    known = "" if every.complete else ", perhaps not all"
    what = f"{count} assembl{'y' if count == 1 else 'ies'} at {scene.where(every.position)}{known}"
    return f"{what}; the sketch picks {'the nearest to it' if every.found and every.found[0].meant else 'another'}"
