"""Folders as distributions with engines are installed in, for tests of engines from outside."""

from collections.abc import Mapping
from pathlib import Path

GOOD = "from analytic.engine import DEFAULT, build\n"  # a module of an engine, with the least that it needs


def install(
    site: Path,
    name: str,
    points: Mapping[str, str],
    modules: Mapping[str, str] | None = None,
    metadata: str = "",
    group: str = "linkage_crosscheck.engines",
) -> None:
    """Install a distribution with entry points of engines: by name their modules; and by name the text of modules."""
    info = site / f"{name}-1.0.dist-info"
    info.mkdir(parents=True)
    head = f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n{metadata}"
    lines = "".join(f"{engine} = {module}\n" for engine, module in points.items())
    (info / "METADATA").write_text(head, encoding="utf-8")
    (info / "entry_points.txt").write_text(f"[{group}]\n{lines}", encoding="utf-8")
    for module, text in (modules or {}).items():
        (site / f"{module}.py").write_text(text, encoding="utf-8")
