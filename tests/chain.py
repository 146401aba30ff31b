"""Linkages of any number of bodies: four-bars in a row, each of which drives the next, less and less far."""

from math import sqrt
from pathlib import Path


def chain(dyads: int, folder: Path) -> Path:
    """Write a scene file of four-bars in a row, each rocker's middle drives the next coupler, and return its path."""
    file = folder / f"chain{dyads}.toml"
    foot, pivot = 1 + 0j, 0j
    ground, bodies, sketch = ["O = [0, 0]"], ['[bodies.crank]\nlengths = { "O-T0" = 1 }\nmass = 1'], ["T0 = [1, 0]"]
    for n in range(1, dyads + 1):
        pivot += 4
        d = abs(pivot - foot)
        x = (d**2 + 4.0**2 - 2.5**2) / (2 * d)
        tip = foot + complex(x, sqrt(4.0**2 - x**2)) * (pivot - foot) / d  # the upper meeting point of both bars
        ground.append(f"C{n} = [{pivot.real}, 0]")
        bodies.append(f'[bodies.coupler{n}]\nlengths = {{ "T{n - 1}-B{n}" = 4 }}\nmass = 1')
        bodies.append(f"[bodies.rocker{n}]\npoints = {{ C{n} = [0, 0], T{n} = [1.25, 0], B{n} = [2.5, 0] }}\nmass = 1")
        foot = (pivot + tip) / 2
        sketch += [f"B{n} = [{tip.real}, {tip.imag}]", f"T{n} = [{foot.real}, {foot.imag}]"]
        bodies[-1] += "\ncom = [1.25, 0]\ninertia = 1"
    head, drive = f'format = 1\nname = "{file.stem}"\n[ground.points]', '[drive]\nbody = "crank"\nspeed = 1\n[sketch]'
    lines = [head, *ground, *bodies, drive, *sketch, f'[output]\npoint = "B{dyads}"\n']
    file.write_text("\n".join(lines), encoding="utf-8")
    return file
