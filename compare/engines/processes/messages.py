"""What another process sends, taken as it comes: half a message holds nobody up, and none imports anything here."""

import io
import os
import pickle
import sys
from collections.abc import Mapping
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from types import MappingProxyType
from typing import Any

CHUNK, HEAD = 2**20, 4  # bytes of a message that are taken at a time, and that its size has


def _read_only(mapping: Mapping[Any, Any]) -> MappingProxyType[Any, Any]:
    return MappingProxyType(mapping)


ForkingPickler.register(MappingProxyType, lambda mapping: (_read_only, (dict(mapping),)))  # scenes hold them


def packed(message: object) -> memoryview:
    """Return a message as it is sent."""
    return ForkingPickler.dumps(message)


class Messages:
    """Reads the messages of a connection."""

    def __init__(self, connection: "Connection[bytes, bytes]") -> None:
        self._connection, self._come = connection, bytearray()

    def next(self, most: int) -> Any:
        """Return the next message of `most` bytes at most once it is whole, None before that, and wait for nothing.

        Raises:
            EOFError: there will be none.
            Exception: it cannot be read.
        """
        if self._connection.poll():
            if sys.platform == "win32":
                return _Reader(io.BytesIO(self._connection.recv_bytes())).load()
            if not (more := os.read(self._connection.fileno(), CHUNK)):
                raise EOFError
            self._come += more
        end = HEAD + int.from_bytes(self._come[:HEAD], "big", signed=True)  # as `multiprocessing` sends it
        if not HEAD <= end <= HEAD + most:
            raise ValueError("it is too large")
        if len(self._come) < end:
            return None
        message = bytes(self._come[HEAD:end])
        del self._come[:end]
        return _Reader(io.BytesIO(message)).load()


class _Reader(pickle.Unpickler):
    """Imports nothing for what it reads: an engine's own code stays where it is."""

    def find_class(self, module: str, name: str) -> Any:
        """Return a class or function of what is imported here.

        Raises:
            UnpicklingError: it is of anything else.
        """
        if module not in sys.modules:
            raise pickle.UnpicklingError(f"{name} of {module} is not known outside of it")
        return super().find_class(module, name)
