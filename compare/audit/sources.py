"""The sources that are audited, which scenes are theirs, and all claims of each."""

from collections.abc import Mapping, Sequence

from scenes import Scene

from .claims import Claim

TOGGLE_PRESS, CLAMP = "toggle press", "double-toggle clamp"
SCENES: Mapping[str, Sequence[str]] = {
    TOGGLE_PRESS: ("toggle_press", "crank_press"),
    CLAMP: ("double_toggle_clamp", "double_toggle_clamp_scheme4"),
}  # as they are shipped


def source_of(scene: Scene) -> str | None:
    """Return the source of a shipped scene; None for any other file, changed numbers, or only some of its channels."""
    sources = (source for source, names in SCENES.items() if scene.file in names)
    return next(sources, None)


def claims_of(source: str) -> list[Claim]:
    """Return every claim of a source, against the reference."""
    from . import clamp, toggle_press  # late: most reports need none of them

    return list({TOGGLE_PRESS: toggle_press, CLAMP: clamp}[source].claims())
