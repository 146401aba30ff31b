"""Another view of one world, in which every scene and motion looks different by known rules."""

from dataclasses import dataclass, replace

import numpy as np

from scenes import Motion, Scene
from scenes.model.motion import channels, quantity
from scenes.scene import GROUND, Body, Drive, ForceTable, Load, MotionLaw, PressForce, Slide, Spring, Vector
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
        return xy(self.vector(*v) * self.length + self.shift)

    def angle(self, angle: float) -> float:
        return self.mirror * angle + float(np.angle(self.turn))

    def scene(self, scene: Scene) -> Scene:
        return replace(
            scene,
            ground={name: self.point(v) for name, v in scene.ground.items()},
            bodies={name: self.body(scene, body) for name, body in scene.bodies.items()},
            drive=self.drive(scene),
            loads=tuple(map(self.load, scene.loads)),
            springs=tuple(map(self.spring, scene.springs)),
            gravity=scene.gravity and xy(self.vector(*scene.gravity) * self.length / self.time**2),
            sketch=replace(
                scene.sketch,
                drive=self.position(scene, scene.sketch.drive),
                points={name: self.point(v) for name, v in scene.sketch.points.items()},
            ),
        )

    @property
    def force(self) -> float:
        return self.mass * self.length / self.time**2

    def position(self, scene: Scene, position: float) -> float:
        """Return a position of the drive."""
        return self.angle(position) if scene.driven_slide is None else self.length * position

    def drive(self, scene: Scene) -> Drive:
        drive, unit = scene.drive, self.mirror if scene.driven_slide is None else self.length
        if isinstance(drive, MotionLaw):
            positions = tuple(self.position(scene, position) for position in drive.positions)
            return replace(drive, times=tuple(time * self.time for time in drive.times), positions=positions)
        start, end = (None if x is None else self.position(scene, x) for x in (drive.start, drive.end))
        assert start is not None
        return replace(drive, speed=unit * drive.speed / self.time, start=start, end=end)

    def load(self, load: Load) -> Load:
        if isinstance(load, ForceTable):
            displacements, forces = load.displacements, load.forces
            return replace(
                load,
                displacements=tuple(x * self.length for x in displacements),
                forces=tuple(f * self.force for f in forces),
            )
        force = xy(self.vector(*load.force) * self.force)
        if isinstance(load, PressForce):
            return replace(load, force=force, last=load.last * self.length)
        return replace(load, force=force)

    def spring(self, spring: Spring) -> Spring:
        return replace(
            spring, stiffness=spring.stiffness * self.mass / self.time**2, length=spring.length * self.length
        )

    def body(self, scene: Scene, body: Body) -> Body:
        """Return the body; its frame turns with the world, but one that cannot turn stays parallel to the ground's."""
        view = self.within(scene, body.name)
        slide = body.slide
        if slide is not None:
            on = self.within(scene, slide.on)
            slide = Slide(slide.on, on.point(slide.through), xy(on.vector(*slide.along)))
        return replace(
            body,
            local=body.local and {name: view.point(v) for name, v in body.local.items()},
            lengths=body.lengths and {pair: length * self.length for pair, length in body.lengths.items()},
            mass=None if body.mass is None else body.mass * self.mass,
            com=body.com and view.point(body.com),
            inertia=None if body.inertia is None else body.inertia * self.mass * self.length**2,
            slide=slide,
        )

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
        for channel in channels(scene):
            stem, of = channel.rpartition(".")[0], quantity(channel)
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
