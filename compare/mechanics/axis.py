"""Units that suit what is shown: prefixes, and what curves and tables run over."""

import re
from dataclasses import dataclass
from math import ceil, floor, log10, pi

from scenes import Motion, Scene
from scenes.model.motion import Samples
from scenes.scene import GROUND

THIN_SPACE = "\N{NARROW NO-BREAK SPACE}"  # at which no line ends
MIN_PLACES = 2000  # of a cycle that its positions tell apart: a tenth of a degree, of a turn


@dataclass(frozen=True)
class DriveAxis:
    """What curves run over, and where tables say that something happened."""

    quantity: str
    unit: str
    channel: str
    factor: float  # from SI
    decimals: int  # of a position

    @property
    def title(self) -> str:
        """Its title."""
        return f"{self.quantity} [{self.unit}]"

    def of(self, motion: Motion) -> Samples:
        """Where a motion's samples are on the axis, shape (n,)."""
        return self.factor * motion[self.channel]

    def text(self, *positions: float) -> str:
        """A position in SI, or a range of two: `204.7°`, `−10.00 to 10.00°`, `3.2 mm`; a place of zero as `0`."""
        shown = (fixed(position * self.factor, self.decimals) for position in positions)
        whole = " to ".join(dict.fromkeys(shown))
        return f"{whole}°" if self.unit == "deg" else f"{whole} {self.unit}"


def axis(scene: Scene) -> DriveAxis:
    """The drive's position at a constant speed; the time under a law, which may go to and fro."""
    if not scene.steady:
        factor, unit = prefixed(scene.cycle, "s")
        return DriveAxis("time", unit, "time", factor, _decimals(factor * scene.cycle))
    unit, size = ("deg", pi / 180) if scene.drive.slide is None else scene.units["length"]
    span = scene.drive.span
    return DriveAxis(position_name(scene), unit, scene.channels.drive.position, 1 / size, _decimals(span / size))


def _decimals(span: float) -> int:
    return min(max(ceil(log10(MIN_PLACES / span) - 1e-9), 0), 12)


def position_name(scene: Scene) -> str:
    """The name of the drive's position."""
    if scene.drive.slide is not None:
        return f"{scene.drive.body} displacement"
    return "crank angle" if scene.drive.on == GROUND else f"angle of {scene.drive.body} on {scene.drive.on}"


def turns_fully(scene: Scene) -> bool:
    """Whether a crank turns for ever at constant speed, so that a cycle is a turn."""
    return scene.drive.slide is None and scene.steady and scene.periodic


def cycle_name(scene: Scene) -> str:
    """The name of a cycle of the drive."""
    return "turn" if turns_fully(scene) else "cycle"


def fixed(value: float, decimals: int, sign: str = "") -> str:
    """A number to some decimals; `0` where none of them is left."""
    text = grouped(f"{value:{sign}.{decimals}f}".replace("-", "−"))
    return text if re.search("[1-9]", text) else "0"


def grouped(text: object) -> str:
    """A number's text with its thousands apart by thin spaces from 10 000 on: `1090.0`, `10 004.2`."""
    return re.sub(r"(?<![\d.])\d{5,}", lambda whole: f"{int(whole[0]):,}".replace(",", THIN_SPACE), str(text))


def prefixed(scale: float, unit: str) -> tuple[float, str]:
    """The factor from SI to the unit in which a scale reads from 1 to 10 000, and that unit; SI for no scale."""
    prefixes = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
    digits = log10(scale or 1.0)
    power = 3 * floor((digits if digits < 0 else max(digits - 1, 0)) / 3)
    power = min(max(power, min(prefixes)), max(prefixes))
    return 10.0**-power, prefixes[power] + unit.replace("*", " ").replace("^2", "²")
