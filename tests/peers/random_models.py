"""Compares random models with libmujoco: `random_models.py [SEED [NUMBER]]`.

Each model has bodies with every kind of joint and shape (meshes too, with vertices in the text), sites, tendons, actuators, equality constraints, contact pairs and sensors. Chance
decides which attributes an element has. For each model, libmujoco and the engine here take the same steps with random controls, in the
versions that the installed MuJoCo and the engine have in common. Prints the models that the engine refuses, by reason, and those whose states
differ, with the largest difference of a velocity or position; fails if there are any. The exceptions are in docs/reproducibility.md.
Needs mujoco; run it at the top of the project, where `cargo xtask replay` plays the models.
"""

import collections
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import warnings

import mujoco
import numpy as np

warnings.filterwarnings("ignore")

MARKS = (1, 2, 5, 10, 20, 40)
SITE_SENSORS = "touch accelerometer velocimeter gyro magnetometer rangefinder".split()
JOINT_SENSORS = "jointpos jointvel jointactuatorfrc".split()
FRAME_SENSORS = "framepos framelinvel frameangvel framelinacc frameangacc framequat framexaxis".split()
BODY_SENSORS = "subtreecom subtreelinvel subtreeangmom".split()
SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}


class Writer:
    """Writes the text of a random model."""

    def __init__(self, rng):
        self.rng = rng
        self.joints, self.geoms, self.bodies, self.tendons, self.meshes = [], [], 0, 0, 0

    def number(self, low, high):
        return f"{self.rng.uniform(low, high):.4g}"

    def numbers(self, count, low, high):
        return " ".join(self.number(low, high) for _ in range(count))

    def polynomial(self, most):
        """A factor, in some cases with those of higher powers."""
        higher = f" {self.numbers(self.one_of(1, 2), -1, 2)}" if self.chance(0.2) else ""
        return self.number(0, most) + higher

    def one_of(self, *choices):
        return choices[self.rng.randint(len(choices))]

    def chance(self, probability=0.35):
        return self.rng.rand() < probability

    def some(self, **attributes):
        """A random selection of the attributes. Each value is a text, or a function that draws a text."""
        chosen = [(name, value) for name, value in attributes.items() if self.chance()]
        return "".join(f' {name}="{value() if callable(value) else value}"' for name, value in chosen)

    def softness(self, suffix=""):
        refs = lambda: self.one_of(f"{self.number(0.01, 0.05)} {self.number(0.5, 1.5)}", "-80 -3")
        imps = lambda: self.one_of(self.number(0.5, 0.9), ".8 .9 .01", ".8 .9 .01 .4 3")
        return {f"solref{suffix}": refs, f"solimp{suffix}": imps}

    def orientation(self):
        ways = {
            "quat": lambda: self.numbers(4, -1, 1),
            "euler": lambda: self.numbers(3, -90, 90),
            "axisangle": lambda: f"{self.numbers(3, -1, 1)} {self.number(-90, 90)}",
            "xyaxes": lambda: f"1 0 .1 0 1 {self.number(-0.5, 0.5)}",
            "zaxis": lambda: self.numbers(3, -1, 1),
        }
        name = self.one_of(*ways)
        return {name: ways[name]}

    def mesh(self):
        """A mesh from points: anywhere, of a lattice (with large faces), or around a cylinder."""
        count, kind = self.rng.randint(4, 30), self.rng.randint(3)
        points = self.rng.uniform(-0.2, 0.2, (count, 3))
        if kind == 1:
            corners = [[x, y, z] for x in (-0.1, 0.1) for y in (-0.15, 0.15) for z in (-0.05, 0.2)]
            points = np.concatenate([corners, np.round(points * 10) / 20])
        if kind == 2:
            angles = np.arange(count) * 2 * np.pi / count
            points = np.concatenate([np.stack([np.cos(angles), np.sin(angles), 0 * angles + z], 1) for z in (-1, 1)]) * 0.15
        attributes = self.some(
            scale=lambda: self.numbers(3, 0.5, 1.5),
            refpos=lambda: self.numbers(3, -0.1, 0.1),
            refquat=lambda: self.numbers(4, -1, 1),
            inertia=lambda: self.one_of("convex", "legacy", "exact", "shell"),
            maxhullvert=lambda: self.one_of("4", "8"),
            smoothnormal="true",
        )
        self.meshes += 1
        vertices = " ".join(f"{x:.4g}" for x in points.ravel())
        return f'<mesh name="m{self.meshes - 1}" vertex="{vertices}"{attributes}/>'

    def geom(self, name):
        shape = self.one_of(*SIZES)
        if self.meshes and self.chance(0.6):
            mesh = f' mesh="m{self.rng.randint(self.meshes)}"'
            # a shape is fitted to the mesh
            shape = f'"{shape}" fitscale="{self.number(0.5, 1)}"{mesh}' if self.chance(0.2) else f'"mesh"{mesh}'
        else:
            shape = f'"{shape}" size="{self.numbers(SIZES[shape], 0.03, 0.2)}"'
        attributes = self.some(
            pos=lambda: self.numbers(3, -0.2, 0.2),
            density=lambda: self.number(100, 2000),
            friction=lambda: self.numbers(self.one_of(1, 2, 3), 0.1, 1),
            condim=lambda: self.one_of(1, 3, 4, 6),
            contype=lambda: self.one_of(0, 1, 2, 3),
            conaffinity=lambda: self.one_of(0, 1, 2, 3),
            priority=lambda: self.one_of(0, 1),
            margin=lambda: self.number(0, 0.1),
            gap=lambda: self.number(0, 0.05),
            adhesion=lambda: self.one_of("0", "0", self.number(0, 5)),
            solmix=lambda: self.number(0, 3),
            fluidshape=lambda: self.one_of("none", "ellipsoid"),
            **self.softness(),
            **self.orientation(),
        )
        return f'<geom name="{name}" type={shape}{attributes}/>'

    def joint(self):
        kind = self.one_of("hinge", "slide", "hinge", "slide", "ball")
        name = f"j{len(self.joints)}"
        self.joints.append((name, kind))
        attributes = dict(
            pos=lambda: self.numbers(3, -0.1, 0.1),
            stiffness=lambda: self.polynomial(5),
            damping=lambda: self.polynomial(5),
            armature=lambda: self.number(0, 1),
            frictionloss=lambda: self.number(0, 1),
            margin=lambda: self.number(0, 0.1),
            actuatorgravcomp=lambda: self.one_of("true", "false"),
            **self.softness("limit"),
            **self.softness("friction"),
        )
        if kind != "ball":
            angle = lambda: self.number(-1, 1)
            attributes |= {"axis": lambda: self.numbers(3, -1, 1), "ref": angle, "springref": angle}
        text = f'<joint name="{name}" type="{kind}"{self.some(**attributes)}'
        if self.chance():
            low = "0" if kind == "ball" else self.number(-60, -1)
            text += f' range="{low} {self.number(1, 60)}"'
        if kind != "ball" and self.chance():
            text += f' actuatorfrcrange="{self.number(-9, -1)} {self.number(1, 9)}"'
        return text + "/>", kind

    def body(self, depth=0):
        number = self.bodies
        self.bodies += 1
        attributes = self.some(gravcomp=lambda: self.number(0, 1), **self.orientation())
        text = f'<body name="b{number}" pos="{self.numbers(3, -0.5, 0.5)}"{attributes}>'
        if depth == 0 and self.chance():
            text += "<freejoint/>"
        else:
            for _ in range(self.rng.randint(3)):
                joint, kind = self.joint()
                text += joint
                if kind == "ball":
                    break
        for _ in range(self.rng.randint(1, 3)):
            self.geoms.append((f"g{len(self.geoms)}", number))
            text += self.geom(self.geoms[-1][0])
        if number < 2:
            site = self.some(pos=lambda: self.numbers(3, -0.2, 0.2), size=lambda: self.numbers(3, 0.01, 0.1), **self.orientation())
            text += f'<site name="s{number}"{site}/>'
        for _ in range(self.rng.randint(3)):
            if depth < 2 and self.bodies < 5:
                text += self.body(depth + 1)
        return text + "</body>"

    def scalar_joints(self):
        return [name for name, kind in self.joints if kind != "ball"]

    def tendon(self):
        attributes = self.some(
            stiffness=lambda: self.polynomial(5),
            damping=lambda: self.polynomial(3),
            frictionloss=lambda: self.number(0, 1),
            margin=lambda: self.number(0, 0.1),
            springlength=lambda: self.one_of(self.number(0, 1), f"{self.number(0, 0.2)} {self.number(0.3, 0.5)}"),
            **self.softness("limit"),
            **self.softness("friction"),
        )
        if self.chance():
            attributes += f' range="{self.number(0, 0.1)} {self.number(0.2, 0.9)}"'
        if self.chance():
            attributes += f' actuatorfrcrange="{self.number(-9, -1)} {self.number(1, 9)}"'
            attributes += self.some(actuatorfrclimited=lambda: self.one_of("true", "false", "auto"))
        name = f't{self.tendons}"'
        self.tendons += 1
        joints = self.scalar_joints()
        if joints and self.chance(0.5):
            terms = "".join(f'<joint joint="{joint}" coef="{self.number(-2, 2)}"/>' for joint in sorted(set(joints[:2])))
            return f'<fixed name="{name}{attributes}>{terms}</fixed>'
        return f'<spatial name="{name}{attributes}><site site="s0"/><site site="s1"/></spatial>'

    def actuator(self, number):
        kinds = {
            "motor": {},
            "position": {"kp": lambda: self.number(1, 50), "kv": lambda: self.number(0, 5), "timeconst": lambda: self.number(0, 0.1)},
            "velocity": {"kv": lambda: self.number(0, 5)},
            "damper": {"kv": lambda: self.number(0, 5)},
            "cylinder": {"timeconst": lambda: self.number(0.1, 2), "area": lambda: self.number(0.1, 2)},
            "general": {
                "dyntype": lambda: self.one_of("none", "integrator", "filter", "filterexact"),
                "gaintype": lambda: self.one_of("fixed", "affine"),
                "biastype": lambda: self.one_of("none", "affine"),
                "gainprm": lambda: self.numbers(3, -1, 1),
                "biasprm": lambda: self.numbers(3, -1, 1),
                "actearly": lambda: self.one_of("true", "false"),
            },
        }
        kind = self.one_of(*kinds)
        targets = ['site="s0"', 'site="s0" refsite="s1"']
        targets += [f'joint="{joint}"' for joint in self.scalar_joints()] + [f'tendon="t{k}"' for k in range(self.tendons)]
        own = self.some(gear=lambda: self.numbers(self.one_of(1, 6), -3, 3), **kinds[kind])
        low = "0" if kind == "damper" else self.number(-3, -1)
        limits = f' ctrlrange="{low} {self.number(1, 3)}"' if kind == "damper" or self.chance() else ""
        if self.chance():
            limits += f' forcerange="{self.number(-3, -1)} {self.number(1, 3)}"'
        return f'<{kind} name="a{number}" {self.one_of(*targets)}{own}{limits}/>'

    def equality(self):
        joints = self.scalar_joints()
        attributes = self.some(active=lambda: self.one_of("true", "false"), **self.softness())
        kinds = [
            f'<connect body1="b0" body2="b1" anchor="{self.numbers(3, -0.2, 0.2)}"{attributes}/>',
            f'<connect site1="s0" site2="s1"{attributes}/>',
            f'<weld site1="s0" site2="s1"{attributes}/>',
            f'<weld body1="b0" body2="b1"{self.some(relpose=lambda: self.numbers(7, -1, 1), torquescale=lambda: self.number(0, 2))}{attributes}/>',
        ]
        if len(joints) > 1:
            kinds.append(f'<joint joint1="{joints[0]}" joint2="{joints[1]}"{self.some(polycoef=lambda: self.numbers(5, -1, 1))}{attributes}/>')
        return self.one_of(*kinds)

    def pair(self):
        (first, of), (second, other) = (self.geoms[self.rng.randint(len(self.geoms))] for _ in range(2))
        attributes = self.some(
            condim=lambda: self.one_of(1, 3, 4, 6),
            friction=lambda: self.numbers(self.one_of(1, 3, 5), 0.1, 1),
            margin=lambda: self.number(0, 0.1),
            gap=lambda: self.number(0, 0.1),
            adhesion=lambda: self.one_of("0", self.number(0, 5)),
            **self.softness(),
        )
        return "" if of == other else f'<pair geom1="{first}" geom2="{second}"{attributes}/>'

    def sensor(self, actuators):
        cutoff = self.some(cutoff=lambda: self.number(0, 1))
        body, geom = f"b{self.rng.randint(self.bodies)}", self.geoms[self.rng.randint(len(self.geoms))][0]
        frame = self.one_of(*FRAME_SENSORS)
        kinds = [
            f'<{self.one_of(*SITE_SENSORS)} site="s{self.rng.randint(2)}"{cutoff}/>',
            f'<{frame} objtype="geom" objname="{geom}"/>',
            f'<{frame} objtype="body" objname="{body}"/>',
            f'<{self.one_of(*BODY_SENSORS)} body="{body}"{cutoff}/>',
        ]
        kinds += [f'<{self.one_of(*JOINT_SENSORS)} joint="{joint}"{cutoff}/>' for joint in self.scalar_joints()[:1]]
        if actuators:
            kinds.append(f'<{self.one_of("actuatorpos", "actuatorvel", "actuatorfrc")} actuator="a0"{cutoff}/>')
        return self.one_of(*kinds)

    def defaults(self):
        if self.chance(0.5):
            return ""
        geom = self.some(margin=lambda: self.number(0, 0.1), condim=lambda: self.one_of(1, 3, 4), **self.softness())
        joint = self.some(damping=lambda: self.number(0, 2), armature=lambda: self.number(0, 1))
        actuator = self.one_of("<motor/>", f'<position kp="{self.number(1, 5)}"/>', f'<velocity kv="{self.number(1, 5)}"/>', "<general dynprm='.1'/>")
        return f"<default><geom{geom}/><joint{joint}/>{actuator}</default>"

    def model(self):
        option = self.some(
            timestep=lambda: self.number(0.001, 0.01),
            impratio=lambda: self.number(1, 5),
            gravity=lambda: self.numbers(3, -9, 9),
            viscosity=lambda: self.number(0, 2),
            cone=lambda: self.one_of("elliptic", "pyramidal"),
            integrator=lambda: self.one_of("Euler", "RK4", "implicit"),
            solver=lambda: self.one_of("Newton", "CG", "PGS"),
            ccd_iterations=lambda: self.one_of(5, 20, 50),
            ccd_tolerance=lambda: self.one_of("1e-7", "1e-9"),
            sleep_tolerance=lambda: self.one_of("1e-2", "1"),
        )
        flags = ("frictionloss", "limit", "contact", "spring", "damper", "gravity", "clampctrl", "filterparent", "actuation", "multiccd", "sleep")
        flag = self.some(**{name: lambda: self.one_of("enable", "disable") for name in flags}) if self.chance(0.2) else ""
        compiler = self.some(boundmass=lambda: self.number(0, 0.5), eulerseq=lambda: self.one_of("zyx", "XYZ"), angle="radian")
        compiler += self.some(fitaabb="true")
        assets = "".join(self.mesh() for _ in range(self.one_of(0, 1, 3)))
        defaults, world = self.defaults(), self.body() + self.body()
        tendons = "".join(self.tendon() for _ in range(self.rng.randint(3)))
        number = self.rng.randint(4)
        actuators = "".join(self.actuator(k) for k in range(number))
        equalities = "".join(self.equality() for _ in range(self.rng.randint(3)))
        pairs = "".join(self.pair() for _ in range(self.rng.randint(3)))
        sensors = "".join(self.sensor(number) for _ in range(self.rng.randint(5)))
        return (
            f"<mujoco><compiler{compiler}/><option{option}><flag{flag}/></option>{defaults}<asset>{assets}</asset>"
            f'<worldbody>{self.geom("w")}{world}</worldbody><tendon>{tendons}</tendon><actuator>{actuators}</actuator>'
            f"<equality>{equalities}</equality><contact>{pairs}</contact><sensor>{sensors}</sensor></mujoco>"
        )


def steps(model, data, seed, number):
    """Takes steps under random controls within their ranges, and yields the number of each after it."""
    rng, (low, high) = np.random.RandomState(seed), model.actuator_ctrlrange.T
    limited = model.actuator_ctrllimited.astype(bool)
    for step in range(1, number + 1):
        control = rng.uniform(-1, 1, model.nu)
        data.ctrl[:] = np.where(limited, low + (control + 1) / 2 * (high - low), control)
        mujoco.mj_step(model, data)
        yield step


def is_calm(data):
    """Whether the motion does not diverge: that would amplify differences in the last bit."""
    return not any(warning.number for warning in data.warning) and np.abs(data.qvel).max(initial=0) < 1e4


def episode(text, seed):
    """The states after certain steps by libmujoco; None if it refuses the model, or if the motion diverges."""
    try:
        model = mujoco.MjModel.from_xml_string(text)
        data, states = mujoco.MjData(model), {}
        for step in steps(model, data, seed, MARKS[-1]):
            if step in MARKS:
                states[str(step)] = {name: getattr(data, name).tolist() for name in ("qpos", "qvel", "act", "sensordata")}
    except (ValueError, mujoco.FatalError):
        return None
    return states if is_calm(data) else None


def difference(expected, found):
    """The first step at which states differ, and the largest difference at that step; None for equal states."""
    for mark, state in expected.items():
        pairs = [(np.array(state[name], float), np.array(found[mark][name], float)) for name in state]
        if any(a.tobytes() != b.tobytes() for a, b in pairs):
            return int(mark), max(np.abs(a - b).max(initial=0) for a, b in pairs)
    return None


def main():
    seed, number = (int(word) for word in (sys.argv[1:] + ["1", "200"][len(sys.argv) - 1 :])[:2])
    rng, version, root = np.random.RandomState(seed), mujoco.__version__, pathlib.Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        files, out = [], pathlib.Path(folder) / "out"
        os.chdir(folder)  # MuJoCo writes its warnings to the current folder
        while len(files) < number:
            text = Writer(rng).model()
            if states := episode(text, seed):
                files.append(pathlib.Path(folder) / f"model{len(files)}.json")
                recording = {"kind": "features", "name": files[-1].stem, "feature": "random", "xml": text, "seed": seed}
                files[-1].write_text(json.dumps(recording | {"versions": {version: {"steps": [], "episode": states}}}))
        command = ["cargo", "xtask", "replay", "--out", str(out), *map(str, files)]
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False, cwd=root)
        os.chdir(root)
        refused, differ = collections.Counter(), 0
        for file in files:
            recording, answer = json.loads(file.read_text()), json.loads((out / file.name).read_text())
            if "error" in answer:
                refused[answer["error"]] += 1
            elif moved := difference(recording["versions"][version]["episode"], answer["versions"][version]["episode"]):
                differ += 1
                print(f"{file.stem} differs by {moved[1]:.2g} after {moved[0]} steps: {recording['xml']}\n")
    for reason, count in refused.most_common():
        print(f"{count} refused: {reason}")
    print(f"mujoco {version}: {number - differ - refused.total()} of {number} models equal, {differ} differ, {refused.total()} refused")
    return 1 if differ or refused else 0


if __name__ == "__main__":
    sys.exit(main())
