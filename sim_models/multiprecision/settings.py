"""Settings of the arbitrary-precision model: its number of digits."""

from dataclasses import dataclass

from scenes import Settings


@dataclass(frozen=True)
class MultiprecisionSettings(Settings):
    """The precision of the arithmetic."""

    digits: int = 50  # significant decimal digits of every number


FAST = DEFAULT = EXACT = MultiprecisionSettings("50 digits", promise=1e-12)
WORK_PRECISION = (DEFAULT,)
LONG_WORK_PRECISION: tuple[MultiprecisionSettings, ...] = ()  # more digits change no double
ABLATIONS: tuple[MultiprecisionSettings, ...] = ()
