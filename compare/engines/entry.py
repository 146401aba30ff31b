"""What is known of an engine that has not been imported."""

from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec


@dataclass(frozen=True)
class Entry:
    """Where an engine lives and what must be installed for it."""

    purpose: str
    module: str
    package: str  # what is imported
    distribution: str  # what is installed
    install: str
    everything: bool = False  # whether it gives every channel of every scene that it can model
    outside: str = ""  # name and version of the distribution that offers it, where that is not this project
    trouble: str = ""  # what keeps it from running, whatever is installed

    @property
    def missing(self) -> str | None:
        """Return what to do before the engine can run, or None when it can."""
        if self.trouble:
            return self.trouble
        return None if find_spec(self.package) else f"{self.distribution} is not installed: {self.install}"

    @property
    def version(self) -> str:
        """Return the installed version of what does the work, without importing it."""
        return self.outside or installed(self.distribution)


@cache
def installed(distribution: str) -> str:
    """Return what is installed of a distribution, with its version."""
    try:
        return f"{distribution} {version(distribution)}"
    except PackageNotFoundError:
        return "not installed"
