#!/usr/bin/env python3
"""Record models whose bodies fall asleep and are woken by each means, and digests of their steps, for the test `sleeping`.

    python record.py --models > models.txt
    pip install mujoco==3.12.0        python record.py > 3.12.txt; repeat with 3.17.0 and 4.0.0

A line of `models.txt` is a model, in which `@` is the text of `world.txt`; those whose steps are the plain model's were left out. A line of the others is the digest of the positions, velocities, activations and sensors of 200 steps, with
random controls in every other tenth of a second; `-` if MuJoCo refuses the model.
"""
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent))
from digests import of_lines, of_steps

STEPS = 200

# two boxes that come to rest, a ball that falls much later, a slide and a hinge that damping stops, and a pendulum that goes on
BODIES = """<geom type="plane" size="9 9 1"/>
<body name="a" pos="0 0 .1"{a}><freejoint/><geom name="a" type="box" size=".1 .1 .1"/><site name="a" pos="0 0 .1"/></body>
<body name="b" pos="1 0 .1" euler="0 0 30"{b}><freejoint/><geom name="b" type="box" size=".1 .12 .1"/><site name="b" pos="0 0 .1"/></body>
<body name="ball" pos="{x} 0 {z}"><freejoint/><geom name="ball" size=".08"/><site name="ball"/></body>
<body name="slide" pos="0 1 1"{slide}><joint name="slide" type="slide" axis="1 0 0" damping="8" stiffness="20" springref=".2" range="-.4 .4"/><geom name="slide" size=".1"/><site name="slide"/></body>
<body name="hinge" pos="1 1 1"{hinge}><joint name="hinge" axis="0 0 1" damping=".1" stiffness=".3" springref="40" frictionloss=".01"/><geom name="hinge" type="capsule" size=".05" fromto="0 0 0 .3 0 0"/><site name="hinge" pos=".3 0 0"/></body>
<body name="swing" pos="0 -1 2"><joint name="swing" axis="0 1 0"/><geom name="swing" size=".1" pos=".7 0 0"/><site name="swing" pos=".7 0 0"/></body>
<body name="hand" mocap="true" pos="5 5 5"/><site name="fixed" pos="0 0 1"/>"""
WORLD = (FOLDER / "world.txt").read_text().strip()
START = {"a": "", "b": "", "slide": "", "hinge": "", "x": "0", "z": "1.6"}


def model(name, more="", option="", flag="", world="", **changes):
    bodies = BODIES.format(**{**START, **changes})
    text = f'<mujoco model="{name}"><option timestep=".005" {option}><flag sleep="enable" {flag}/></option><worldbody>{bodies}{world}</worldbody>{more}</mujoco>'
    return " ".join(text.replace("\n", " ").split())


def path(*sites, **options):
    inner = "".join(f'<site site="{site}"/>' for site in sites)
    attributes = " ".join(f'{key}="{value}"' for key, value in options.items())
    return f"<tendon><spatial {attributes}>{inner}</spatial></tendon>"


def fixed(*joints, **options):
    inner = "".join(f'<joint joint="{joint}" coef="{k + 1}"/>' for k, joint in enumerate(joints))
    attributes = " ".join(f'{key}="{value}"' for key, value in options.items())
    return f"<tendon><fixed {attributes}>{inner}</fixed></tendon>"


def draw():
    yield model("plain")
    yield model("miss", x="2")
    yield model("side", x=".15")
    for integrator in ("implicit", "implicitfast"):
        yield model(integrator, option=f'integrator="{integrator}"')
    for solver in ("PGS", "CG"):
        yield model(solver, option=f'solver="{solver}"')
    yield model("elliptic", option='cone="elliptic" noslip_iterations="2"')
    yield model("sparse", option='jacobian="sparse"')
    for flag in "island warmstart eulerdamp contact gravity damper spring limit frictionloss refsafe filterparent energy".split():
        yield model(flag, flag=f'{flag}="{"enable" if flag == "energy" else "disable"}"')
    for tolerance in ("0", "1e-3", ".1"):
        yield model(f"tolerance {tolerance}", option=f'sleep_tolerance="{tolerance}"')
    yield model("fluid", option='density="1.2" viscosity=".1" wind=".1 0 0"')
    # tendons: of one tree, of two, of three, with a limit that is reached and one that is not
    for name, sites in {"a fixed": ("a", "fixed"), "a b": ("a", "b"), "b a": ("b", "a"), "a ball": ("a", "ball"), "ball b": ("ball", "b"), "a swing": ("a", "swing"), "swing b": ("swing", "b"), "hinge slide": ("hinge", "slide"), "swing slide": ("swing", "slide"), "a b ball": ("a", "b", "ball")}.items():
        for limit in ("0 2.2", "0 1.3", "1.02 4", "0 9"):
            yield model(f"tendon {name} {limit}", path(*sites, range=limit))
        yield model(f"tendon {name} free", path(*sites, margin=".1", armature="0"))
        yield model(f"tendon {name} friction", path(*sites, frictionloss=".02"))
    yield model("tendon spring", path("swing", "ball", stiffness="2", damping=".1"))
    yield model("tendon own spring", path("a", "fixed", stiffness="2", damping=".1"))
    for joints in (("slide",), ("slide", "hinge"), ("hinge", "swing"), ("swing", "slide"), ("slide", "hinge", "swing")):
        yield model("fixed " + " ".join(joints), fixed(*joints, range="-.5 .5"))
        yield model("fixed wide " + " ".join(joints), fixed(*joints, range="-9 9", margin=".1"))
        yield model("fixed friction " + " ".join(joints), fixed(*joints, frictionloss=".1"))
    # equalities: of sleepers, of a sleeper and one that moves, with the world, and switched off
    for one, other in (("a", "b"), ("a", "ball"), ("ball", "a"), ("a", "world"), ("a", "hand"), ("hinge", "slide"), ("slide", "swing"), ("swing", "b")):
        for active in ("true", "false"):
            second = "" if other == "world" else f'body2="{other}"'
            yield model(f"connect {one} {other} {active}", f'<equality><connect body1="{one}" {second} anchor=".1 0 0" active="{active}"/></equality>')
        yield model(f"weld {one} {other}", f'<equality><weld body1="{one}" {second}/></equality>')
    for one, other in (("a", "b"), ("ball", "b"), ("a", "swing"), ("a", "fixed"), ("fixed", "b")):
        yield model(f"sites {one} {other}", f'<equality><connect site1="{one}" site2="{other}"/></equality>')
    for one, other in (("slide", "hinge"), ("swing", "slide"), ("hinge", "swing"), ("slide", "")):
        second = f'joint2="{other}"' if other else ""
        yield model(f"joint {one} {other}", f'<equality><joint joint1="{one}" {second} polycoef="0 .5"/></equality>')
    yield model("two welds", '<equality><weld body1="a" body2="b"/><weld body1="b" body2="slide"/></equality>')
    # actuators of what may sleep, and of what may not
    may = {"a": ' sleep="allowed"', "slide": ' sleep="allowed"', "hinge": ' sleep="allowed"'}
    for target in ('joint="slide"', 'joint="hinge"', 'jointinparent="hinge"', 'site="a"', 'site="a" refsite="fixed"', 'cranksite="hinge" slidersite="fixed" cranklength="2"', 'tendon="t"'):
        tendon = fixed("slide", name="t")
        for sleep in ({}, may):
            yield model(f"motor {target[:9]} {len(sleep)}".replace('"', ""), f"{tendon}<actuator><motor {target} gear='.1 0 0 0 0 .1'/></actuator>", **sleep)
    yield model("position", '<actuator><position joint="slide" kp="3"/><velocity joint="hinge" kv=".1"/></actuator>', **may)
    yield model("adhesion", '<actuator><adhesion body="a" ctrlrange="0 1" gain="2"/></actuator>', **may)
    yield model("integrator", '<actuator><intvelocity joint="swing" kp="1" actrange="-1 1"/></actuator>')
    yield model("damper", '<actuator><damper joint="slide" kv="2" ctrlrange="0 1"/></actuator>', **may)
    # what sleeps from the start, and what never does
    for sleep in ("init", "never", "allowed"):
        for body in ("a", "slide", "hinge"):
            yield model(f"{sleep} {body}", **{body: f' sleep="{sleep}"'})
    yield model("init both", a=' sleep="init"', slide=' sleep="init"', hinge=' sleep="init"')
    # sensors of what sleeps
    sensors = "".join(f'<accelerometer site="{s}"/><velocimeter site="{s}"/><gyro site="{s}"/><force site="{s}"/><torque site="{s}"/><touch site="{s}"/><magnetometer site="{s}"/><rangefinder site="{s}"/>' for s in ("a", "ball", "hinge"))
    yield model("sensors of sites", f"<sensor>{sensors}</sensor>")
    kinds = "framepos framequat framexaxis framezaxis framelinvel frameangvel framelinacc frameangacc".split()
    frames = "".join(f'<{kind} objtype="{one}" objname="{name}"/>' for kind in kinds for one in ("body", "xbody", "geom", "site") for name in ("a", "slide", "ball"))
    yield model("sensors of frames", f"<sensor>{frames}</sensor>")
    relative = "".join(f'<{kind} objtype="body" objname="{one}" reftype="body" reftype="body" refname="{other}"/>'.replace('reftype="body" reftype="body"', 'reftype="body"') for kind in kinds[:6] for one, other in (("a", "b"), ("a", "swing"), ("swing", "a"), ("hand", "a")))
    yield model("sensors of two", f"<sensor>{relative}</sensor>")
    joints = "".join(f'<jointpos joint="{j}"/><jointvel joint="{j}"/><jointactuatorfrc joint="{j}"/>' for j in ("slide", "hinge", "swing")) + '<jointlimitpos joint="slide"/><jointlimitvel joint="slide"/><jointlimitfrc joint="slide"/>'
    yield model("sensors of joints", f"<sensor>{joints}</sensor>")
    for kind in ("subtreecom", "subtreelinvel", "subtreeangmom"):
        trees = "".join(f'<{kind} body="{b}"/>' for b in ("a", "ball", "world"))
        yield model(f"sensors {kind}", f"<sensor>{trees}</sensor>")
    yield model("sensors of energy", "<sensor><e_potential/><e_kinetic/><clock/></sensor>")
    yield model("energy of tendons", path("a", "fixed", stiffness="2", springlength=".1") + "<sensor><e_potential/><e_kinetic/></sensor>")
    tendons = path("a", "ball", name="t", range="0 2") + "<sensor><tendonpos tendon='t'/><tendonvel tendon='t'/><tendonlimitpos tendon='t'/><tendonlimitvel tendon='t'/><tendonlimitfrc tendon='t'/><tendonactuatorfrc tendon='t'/></sensor>"
    yield model("sensors of tendons", tendons)
    actuators = "<actuator><motor name='m' joint='slide'/><motor name='n' joint='swing'/></actuator><sensor>" + "".join(f"<actuatorpos actuator='{n}'/><actuatorvel actuator='{n}'/><actuatorfrc actuator='{n}'/>" for n in "mn") + "</sensor>"
    yield model("sensors of actuators", actuators, **may)
    yield model("sensors of pairs", '<sensor><distance geom1="a" geom2="b" cutoff="3"/><normal geom1="a" geom2="ball" cutoff="3"/><fromto body1="slide" body2="hinge" cutoff="3"/><contact geom1="a"/><contact geom1="ball" data="found force dist pos"/><contact body1="b" body2="world" num="4" reduce="maxforce"/><insidesite site="a" objtype="body" objname="ball"/></sensor>')


def drive(model, data, random):
    for i in range(model.nu):
        data.ctrl[i] = random.uniform(0, 1) if int(data.time / 0.1) % 2 else 0


def main():
    if "--models" in sys.argv:
        print(*(text.replace(WORLD, "@") for text in draw()), sep="\n")
    else:
        of_lines(FOLDER / "models.txt", lambda text: of_steps(text.replace("@", WORLD), STEPS, lambda *_: None, drive))


if __name__ == "__main__":
    main()
