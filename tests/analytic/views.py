"""Another view of one world, in which every scene and motion looks different by known rules."""

from dataclasses import dataclass, replace

import numpy as np

from scenes import Motion, Scene
from scenes.channels import named
from scenes.fields import put, walk
from scenes.scene import GROUND, Body, ConstantSpeed, DriveLaw, Force, Load, MotionLaw, PressForce, Slide, Vector
from tests.agreement import Channels
from tests.linkages import xy


@dataclass(frozen=True)
class Change:
    """Another view of one world: mirrored in the x axis, then turned and shifted, or measured in other units."""

    mirror: int = 1  # -1 for y -> -y
    turn: complex = 1
    shift: complex = 0
    length: float = 1
    mass: float = 1
    time: float = 1

    def vector(self, x: float, y: float) -> complex:
        """Return a direction as it is seen now."""
        return self.turn * complex(x, self.mirror * y)

    def point(self, v: Vector) -> Vector:
        return xy(self.vector(*v) + self.shift)

    def angle(self, angle: float) -> float:
        return self.mirror * angle + float(np.angle(self.turn))

    @property
    def force(self) -> float:
        return self.mass * self.length / self.time**2

    def scene(self, scene: Scene) -> Scene:
        """Return the scene with all its numbers in the other units, and then seen from the other frame."""
        length, mass, time, driven = self.length, self.mass, self.time, self.length if scene.drive.slide else 1.0
        many = {"length": length, "mass": mass, "time": time, "force": self.force, "inertia": mass * length**2}
        many |= {"stiffness": mass / time**2, "gravity": length / time**2, "direction": 1.0}
        many |= {"position": driven, "speed": driven / time}
        scene = put(scene, {number.at: many[number.quantity.dimension] * number.value for number in walk(scene)})
        sketch = replace(scene.sketch, points={name: self.point(v) for name, v in scene.sketch.points.items()})
        return replace(
            scene,
            ground={name: self.point(v) for name, v in scene.ground.items()},
            bodies={name: self.body(scene, body) for name, body in scene.bodies.items()},
            drives=(scene.drive if scene.drive.slide else replace(scene.drive, law=self.law(scene.drive.law)),),
            loads=tuple(map(self.load, scene.loads)),
            gravity=scene.gravity and xy(self.vector(*scene.gravity)),
            sketch=sketch if scene.drive.slide else replace(sketch, drive=self.angle(sketch.drive)),
        )

    def law(self, law: DriveLaw) -> DriveLaw:
        if isinstance(law, MotionLaw):
            return replace(law, positions=tuple(map(self.angle, law.positions)))
        assert isinstance(law, ConstantSpeed)
        end = None if law.end is None else self.angle(law.end)
        return replace(law, speed=self.mirror * law.speed, start=self.angle(law.start), end=end)

    def load(self, load: Load) -> Load:
        if load.kind == "force tables":
            return load
        assert isinstance(load, Force | PressForce)
        return replace(load, force=xy(self.vector(*load.force)))

    def body(self, scene: Scene, body: Body) -> Body:
        """Return the body; its frame turns with the world, but one that cannot turn stays parallel to the ground's."""
        view, slide = self.within(scene, body.name), body.slide
        if slide is not None:
            on = self.within(scene, slide.on)
            slide = Slide(slide.on, on.point(slide.through), xy(on.vector(*slide.along)))
        local = body.local and {name: view.point(v) for name, v in body.local.items()}
        return replace(body, local=local, com=body.com and view.point(body.com), slide=slide)

    def within(self, scene: Scene, name: str) -> "Change":
        """Return the change as it is seen in the frame of a body or the ground."""
        if name == GROUND:
            return self
        return replace(self, shift=0, turn=1 if name in scene.turning else self.turn)

    def channels(self, scene: Scene, motion: Motion) -> Channels:
        """Return what the scene's motion looks like now."""
        omega = self.mirror / self.time
        force, moment = self.force, self.mirror * self.force * self.length
        scalar = {"time": self.time, "displacement": self.length, "omega": omega, "alpha": omega / self.time}
        scalar |= {"force": force, "guide_force": self.mirror * force, "guide_moment": moment, "torque": moment}
        vector = {"": self.length, "v": self.length / self.time, "a": self.length / self.time**2, "f": force}
        seen = {}
        for channel in scene.channels.names():
            stem, of = channel.rpartition(".")[0], named(channel).name
            if of in scalar:
                seen[channel] = scalar[of] * motion[channel]
            elif of in ("angle", "crank_angle"):
                seen[channel] = self.mirror * motion[channel] + np.angle(self.turn)
            elif of.endswith("x"):
                y = f"{channel[:-1]}y"
                v = self.turn * (motion[channel] + 1j * self.mirror * motion[y]) * vector[of[:-1]]
                v = v + self.shift if of == "x" else v
                seen |= {f"{stem}.{of}": v.real, y: v.imag}
        return seen
