"""Samples by channel that are made when they are looked up: those that take long, and those of which there are many."""

from collections.abc import Callable, Iterator, Mapping

from ..drive import Samples


class Later(Mapping[str, Samples]):
    """Samples by channel; a function in their place is called when its channel is first looked up, and only then."""

    def __init__(self, samples: Mapping[str, Samples | Callable[[], Samples]]) -> None:
        self._samples = dict(samples)
        self.late = frozenset(channel for channel, given in samples.items() if callable(given))

    def __getitem__(self, channel: str) -> Samples:
        """The samples of a channel."""
        found = self._samples[channel]
        if callable(found):
            found = self._samples[channel] = found()
        return found

    def __contains__(self, channel: object) -> bool:
        """Whether there is such a channel, which need not be found for that."""
        return channel in self._samples

    def __iter__(self) -> Iterator[str]:
        """The channels."""
        return iter(self._samples)

    def __len__(self) -> int:
        """How many channels there are."""
        return len(self._samples)

    def __reduce__(self) -> tuple[type[dict[str, Samples]], tuple[dict[str, Samples]]]:
        """What another process is sent: all samples, since it may lack what finds them."""
        return dict, ({**self},)


class Rows(Mapping[str, Samples]):
    """Samples by channel that are rows of one array; to cut out all of them would take longer than to compute them."""

    __slots__ = ("_array", "_places")

    def __init__(self, places: Mapping[str, int], array: Samples) -> None:
        self._places, self._array = places, array

    def __getitem__(self, channel: str) -> Samples:
        """The samples of a channel."""
        row: Samples = self._array[self._places[channel]]
        return row

    def __contains__(self, channel: object) -> bool:
        """Whether there is such a channel."""
        return channel in self._places

    def __iter__(self) -> Iterator[str]:
        """The channels."""
        return iter(self._places)

    def __len__(self) -> int:
        """How many channels there are."""
        return len(self._places)
