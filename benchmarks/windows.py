"""How many windows of parallelograms, one beside the other, are proven, in what time and memory.

Window after window hangs on the one before, as in the IFToMM's benchmark A02, so that bounds grow from group to group:
`python -m benchmarks.windows 4 10 14` prints a line each, of a process of its own.
"""

import argparse
import resource
import subprocess
import sys
from collections.abc import Iterator
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import analytic
import scenes

END = 0.6  # rad, from upright on, where nothing is near a singular configuration


def text(count: int) -> str:
    """A scene file with so many windows, of bars of 1 m and 1 kg."""

    def lines() -> Iterator[str]:
        yield 'format = 1\nname = "windows"\ngravity = [0, -9.81]'
        yield f"ground.points = {{ {', '.join(f'A{n} = [{n}, 0]' for n in range(count + 1))} }}"
        names = [(f"l{n}", f"A{n}-B{n}") for n in range(count + 1)]
        names += [(f"c{n}", f"B{n}-B{n + 1}") for n in range(count)]
        yield from (f'bodies.{name} = {{ lengths = {{ "{pair}" = 1 }}, mass = 1 }}' for name, pair in names)
        yield f'drive = {{ body = "l0", speed = -1, start = {pi / 2}, end = {END} }}'
        yield f"sketch = {{ angle = {pi / 2}, {', '.join(f'B{n} = [{n}, 1]' for n in range(count + 1))} }}"
        yield f'output = {{ point = "B{count}" }}'

    return "\n".join(lines())


def measured(count: int) -> str:
    """A line on the scene with so many windows."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "windows.toml"
        file.write_text(text(count), encoding="utf-8")
        scene = scenes.load(file)
    begun = process_time()
    found = analytic.enclose(scene)
    seconds, memory = process_time() - begun, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    proven = (
        f"not proven ({found.why})"
        if found.open_at
        else "proven" + f" but for some bounds ({found.why})" * bool(found.why)
    )
    return f"{count} windows, {len(scene.bodies)} bodies: {proven}, {seconds:.1f} s, {memory:.0f} MB"


def main() -> None:
    """Print a line for each count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("counts", nargs="+", type=int, help="of windows")
    counts = parser.parse_args().counts
    if len(counts) == 1:
        print(measured(counts[0]), flush=True)
        return
    for count in counts:
        subprocess.run([sys.executable, "-m", "benchmarks.windows", str(count)], check=True)


if __name__ == "__main__":
    main()
