"""The sources that are audited, which scenes are theirs, and all claims of each."""

from collections.abc import Mapping, Sequence

from .claims import Claim

TOGGLE_PRESS, CLAMP = "toggle press", "double-toggle clamp"
SCENES: Mapping[str, Sequence[str]] = {
    TOGGLE_PRESS: ("toggle_press", "crank_press"),
    CLAMP: ("double_toggle_clamp", "double_toggle_clamp_scheme4"),
}  # as they are shipped


def claims_of(source: str) -> list[Claim]:
    """Return every claim of a source, against the reference."""
    from .clamp import claims as clamp
    from .toggle_press import claims as toggle_press  # late: most reports need none of them

    return list({TOGGLE_PRESS: toggle_press, CLAMP: clamp}[source].claims())
