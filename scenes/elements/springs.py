"""Linear springs and dampers between points of two bodies, either of which may be the ground."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field, Strict

from ..bodies import GROUND
from ..errors import InputError
from ..fields import BodyPoint, Damping, FileTable, RestLength, Stiffness
from .attack import problems_of_attack

if TYPE_CHECKING:
    from ..scene import Scene


@dataclass(frozen=True)
class Spring:
    """It pulls with stiffness (distance - length) + damping d(distance)/dt along the line of its ends."""

    first: tuple[str, str]  # body, point
    second: tuple[str, str]
    stiffness: Stiffness  # N/m
    length: RestLength  # m, without force
    damping: Damping | None = None  # N s/m

    @property
    def kind(self) -> str:
        """What it is, as an engine names what it knows."""
        return "springs" if self.damping is None else "dampers"

    @property
    def needs_direction(self) -> bool:
        """Whether it has no force where its ends meet: of a spring without length that is zero."""
        return bool(np.any(self.length)) or self.damping is not None

    def problems(self, scene: "Scene", place: str) -> Iterator[str]:
        """Yield what does not fit together with the rest of the scene."""
        for body, point in (self.first, self.second):
            yield from problems_of_attack(scene, f"{place}.between", f"{place}.between", body, point, GROUND)
        if self.first[0] == self.second[0]:
            yield f"{place}.between: expected points of two bodies, found both on {self.first[0]}"
        if self.first[1] == self.second[1]:
            yield f"{place}.between: {self.first[1]} is the same point of both bodies"


class SpringTable(FileTable):
    """A linear spring, a damper, or both, between two points."""

    between: Annotated[tuple[BodyPoint, BodyPoint], Strict(False)] = Field(
        description='Each as "body.point", or "ground.S".'
    )
    stiffness: Stiffness | None = Field(None, description="Force by length; none of a damper alone.")
    length: RestLength | None = Field(None, description="Its length without force; 0 for one that always pulls.")
    damping: Damping | None = Field(None, description="Force by rate of the length, as N s/m.")

    def element(self, place: str) -> Spring:
        """The spring, its numbers as they are; InputError where the keys do not go together."""
        if not self.stiffness and self.damping is None:
            found = "missing" if self.stiffness is None else "zero"
            raise InputError(f"{place}.stiffness: {found}; expected more than zero, or a 'damping'")
        if self.stiffness and self.length is None:
            raise InputError(f"{place}.length: missing; a spring needs its length without force, which may be 0")
        first, second = ((body, point) for body, _, point in (text.partition(".") for text in self.between))
        return Spring(first, second, self.stiffness or 0.0, self.length or 0.0, self.damping)
