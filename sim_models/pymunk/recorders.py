"""Records of the poses and rates of all bodies, shape (records, bodies, 6): x, y, angle and their rates."""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from .constraints import Poses

if TYPE_CHECKING:
    import pymunk


class BatchRecorder:
    """Record by one call for all bodies into a growing buffer in C, which is faster than copying each time."""

    def __init__(self, space: "pymunk.Space", bodies: "Iterable[pymunk.Body]") -> None:
        from pymunk.batch import BodyFields, Buffer, get_space_bodies

        fields = BodyFields.POSITION | BodyFields.ANGLE | BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY
        order, self._buffer = Buffer(), Buffer()
        get_space_bodies(space, BodyFields.BODY_ID, order)
        listed = [*memoryview(order.int_buf()).cast("P")]  # the static body too
        self._columns = [listed.index(body.id) for body in bodies]
        self._listed = len(listed)
        self._append: Callable[[], None] = lambda: get_space_bodies(space, fields, self._buffer)

    def append(self) -> None:
        """Record the present poses and rates."""
        self._append()

    def rows(self) -> Poses:
        """Return all records."""
        return np.frombuffer(self._buffer.float_buf()).reshape(-1, self._listed, 6)[:, self._columns]


class PropertyRecorder:
    """Record by the properties of each body."""

    def __init__(self, bodies: "Iterable[pymunk.Body]") -> None:
        self._bodies = [*bodies]
        self._rows: list[list[tuple[float, ...]]] = []

    def append(self) -> None:
        """Record the present poses and rates."""
        self._rows.append(
            [(*body.position, body.angle, *body.velocity, body.angular_velocity) for body in self._bodies]
        )

    def rows(self) -> Poses:
        """Return all records."""
        return np.array(self._rows)


Recorder: TypeAlias = BatchRecorder | PropertyRecorder
