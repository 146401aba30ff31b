"""What is installed, known without an import: an engine's home and version, and what figures were obtained on."""

import os
import platform
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

PACKAGES = ("linkage-crosscheck", "numpy", "scipy", "pandas", "plotly")  # the engines name their own


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
        """The step to take before the engine can run, or None when it can."""
        if self.trouble:
            return self.trouble
        return None if find_spec(self.package) else f"{self.distribution} is not installed: {self.install}"

    @cached_property
    def version(self) -> str:
        """Return the installed version of what does the work, without importing it."""
        try:
            return self.outside or f"{self.distribution} {version(self.distribution)}"
        except PackageNotFoundError:
            return "not installed"


@cache
def environment() -> dict[str, str]:
    """Return the machine's and the packages' versions."""
    return {
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
    } | {package: version(package) for package in PACKAGES}
