#!/usr/bin/env python3
"""Record models that have each part of MJCF in each of its kinds, and digests of their steps, for the test `parts`.

    python record.py --models > models.txt
    pip install mujoco==3.12.0        python record.py > 3.12.txt; repeat with 3.17.0 and 4.0.0

A line of `models.txt` is a model; its name says what is in it. `@` is the text of `world.txt`, and `@low` that of `LOW` here. A line of the others is the digest of the positions, velocities, activations and
sensors of 20 steps from random velocities under random controls; `-` if MuJoCo refuses the model.
"""
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent))
from digests import of_steps, of_texts

STEPS = 20

# two bodies that fly, with a geom, a site and a camera off their centres each, and an arm above a floor
WORLD = (FOLDER / "world.txt").read_text().strip()
LOW = WORLD.replace('pos="0 0 .5"', 'pos="0 0 .05"')
OBJECTS = {"body": "", "xbody": "", "geom": "g", "site": "s", "camera": "c"}


def model(name, world="", option="", flag="", more="", compiler="", base=WORLD):
    text = f'<mujoco model="{name}"><compiler {compiler}/><option {option}><flag {flag}/></option><worldbody>{base}{world}</worldbody>{more}</mujoco>'
    return " ".join(text.replace("\n", " ").split())


def sensors(name, *texts, **more):
    return model(name, more=f'<sensor>{"".join(texts)}</sensor>' + more.pop("and_also", ""), **more)


def frame_sensors():
    for kind in "framepos framequat framexaxis frameyaxis framezaxis framelinvel frameangvel".split():
        texts, cutoff = [], ' cutoff=".5"' if kind in ("framepos", "framelinvel", "frameangvel") else ""
        for number, (one, prefix) in enumerate(OBJECTS.items()):
            own = f'objtype="{one}" objname="{prefix}a"'
            texts.append(f"<{kind} {own}/>")
            other, first = list(OBJECTS.items())[(number + 2) % 5]
            texts.append(f'<{kind} {own} reftype="{other}" refname="{first}b"/>')
            texts.append(f'<{kind} objtype="{other}" objname="{first}b" reftype="{one}" refname="{prefix}a"{cutoff}/>')
        texts.append(f'<{kind} objtype="site" objname="s2" reftype="site" refname="fixed"/><{kind} objtype="site" objname="fixed" reftype="body" refname="hand"/>')
        yield sensors(kind, *texts)
    for kind in ("framelinacc", "frameangacc"):
        yield sensors(kind, *(f'<{kind} objtype="{one}" objname="{prefix}{k}"/>' for one, prefix in OBJECTS.items() for k in "ab"))


def other_sensors():
    shapes = {"sphere": ".2", "capsule": ".1 .1", "ellipsoid": ".2 .3 .25", "cylinder": ".2 .15", "box": ".2 .15 .3"}
    sites = "".join(f'<site name="{kind}" type="{kind}" size="{size}" pos=".05 .05 .45" euler="20 10 5"/>' for kind, size in shapes.items())
    inside = (f'<insidesite site="{kind}" objtype="{one}" objname="{prefix}a"/>' for kind in shapes for one, prefix in OBJECTS.items())
    yield sensors("insidesite", *inside, world=sites)
    feet = "".join(
        f'<body pos="{k / 2 - 1} 1 .09"><freejoint/><geom type="box" size=".2 .1 .1"/><site name="{kind}" type="{kind}" size="{size}" pos="{x} 0 -.1"/></body>'
        for k, (kind, size) in enumerate(shapes.items())
        for x in [0.1]
    )
    yield sensors("touch", *(f'<touch site="{kind}"/>' for kind in shapes), '<touch site="box" cutoff="20"/>', base=feet + '<geom type="plane" size="3 3 1"/>')
    site = "accelerometer velocimeter gyro magnetometer force torque touch".split()
    yield sensors("sites", *(f'<{kind} site="{s}"/>' for kind in site for s in ("fixed", "sa", "s2")))
    yield sensors("cutoffs", *(f'<{kind} site="s2" cutoff=".3"/>' for kind in site))
    rays = '<site name="down" pos=".3 .2 2" euler="180 0 0"/><site name="away" pos="0 0 3"/>'
    yield sensors("rangefinder", *(f'<rangefinder site="{s}"/>' for s in ("down", "away", "sa", "s2")), '<rangefinder site="down" cutoff="1"/>', world=rays)
    cameras = """<camera name="wide" pos="0 -1 1" euler="60 0 0" fovy="70" resolution="64 48"/>
<camera name="long" pos="0 -1 1" euler="70 5 0" focal=".02 .03" sensorsize=".02 .03" resolution="100 50"/>"""
    yield sensors("camprojection", *(f'<camprojection site="{s}" camera="{c}"/>' for s in ("sa", "s2", "fixed") for c in ("wide", "long")), world=cameras)
    for flag in ("", 'energy="enable"'):
        yield sensors(f"energies {flag[:6]}", "<e_potential/><e_kinetic/><clock/>", '<subtreelinvel body="arm"/><subtreeangmom body="arm"/><subtreecom body="hand"/>',
                      '<subtreelinvel body="world"/><subtreeangmom body="hand"/>', flag=flag)
    tendon = '<tendon><fixed name="t" range="-.02 .02" limited="true"><joint joint="slide" coef="1"/><joint joint="hinge" coef="-.3"/></fixed><spatial name="u" range="0 .2"><site site="s0"/><site site="s1"/></spatial></tendon>'
    motors = '<actuator><motor name="m" tendon="t" gear="3"/><motor tendon="t" gear="-1"/><motor joint="hinge" gear="2"/><motor name="free" joint="ball" gear=".1 .2 .3"/></actuator>'
    joints = "".join(f'<{kind} joint="{j}"/>' for kind in "jointpos jointvel jointactuatorfrc jointlimitpos jointlimitvel jointlimitfrc".split() for j in ("slide", "hinge"))
    tendons = "".join(f'<{kind} tendon="{t}"/>' for kind in "tendonpos tendonvel tendonactuatorfrc tendonlimitpos tendonlimitvel tendonlimitfrc".split() for t in "tu")
    actuators = "".join(f'<{kind} actuator="{a}"/>' for kind in "actuatorpos actuatorvel actuatorfrc".split() for a in ("m", "free"))
    ball = '<ballquat joint="ball"/><ballangvel joint="ball"/>'
    yield sensors("joints and tendons", joints, tendons, actuators, ball, and_also=tendon + motors)
    near = '<body name="c" pos=".1 .05 .55"><freejoint/><geom name="gc" size=".06"/></body>'
    for kind in ("distance", "normal", "fromto"):
        yield sensors(f"between {kind}", *(f'<{kind} geom1="ga" geom2="{g}" cutoff="{far}"/>' for g in ("gb", "gc", "gt", "floor") for far in ("0", ".2", "2")),
                      f'<{kind} body1="arm" body2="a" cutoff="3"/><{kind} geom1="gc" body2="hand" cutoff="3"/>', world=near)
    pile = """<geom name="floor" type="plane" size="3 3 1"/><body name="a" pos="0 0 .09"><freejoint/><geom name="ga" type="box" size=".2 .2 .1"/><site name="sa" type="box" size=".1 .1 .3"/></body>
<body name="b" pos=".05 0 .28"><freejoint/><geom name="gb" type="box" size=".1 .15 .1"/></body><body name="c" pos=".6 0 .05"><freejoint/><geom name="gc" size=".06"/></body>"""
    of = ['geom1="ga"', 'geom1="ga" geom2="gb"', 'body1="b"', 'body1="b" body2="a"', 'geom1="floor" body2="a"', 'site="sa"', 'site="sa" geom2="gb"', 'subtree1="b"', ""]
    for reduce in ("none", "mindist", "maxforce", "netforce"):
        for data in ("found", "force torque", "dist pos", "normal tangent", "found force torque dist pos normal tangent"):
            if data in ("found", "force torque") or reduce in ("mindist", "netforce"):
                yield sensors(f"contact {reduce} {data}", *(f'<contact {what} reduce="{reduce}" data="{data}" num="{num}"/>' for what in of for num in (1, 3)), base=pile)


def actuators():
    def acting(name, text, tendon="", **more):
        read = '<sensor><framepos objtype="site" objname="s2"/></sensor>'
        return model(f"actuator {name}", more=f"{tendon}<actuator>{text}</actuator>{read}", **more)

    spatial = '<tendon><spatial name="t"><site site="s0"/><site site="s1"/></spatial></tendon>'
    targets = ['joint="slide" gear="3"', 'joint="hinge"', 'joint="ball" gear=".1 .2 .3"', 'jointinparent="ball" gear=".1 .2 .3"', 'site="s2" gear="1 2 3 .1 .2 .3"',
               'site="s2" refsite="fixed" gear="1 2 3"', 'site="s2" refsite="s0" gear="0 0 0 .1 .2 .3"', 'site="s1" refsite="s2" gear="1 0 2 .1 0 .3"', 'tendon="t" gear="-2"']
    for number, target in enumerate(targets):
        for kind in ('motor ctrlrange="-.5 .3"', 'position kp="3" kv=".2" forcerange="-.5 .4"'):
            yield acting(f"on {number} {kind[:5]}", f"<{kind} {target}/>", spatial)
    cranks = '<site name="rail" pos="-.7 .1 .8" euler="0 80 0"/>'
    for rod in (".5", ".05"):
        yield acting(f"crank {rod}", f'<motor cranksite="s1" slidersite="rail" cranklength="{rod}" gear="2"/><velocity cranksite="s2" slidersite="s0" cranklength="{rod}" kv="1"/><position cranksite="s1" slidersite="rail" cranklength="{rod}" kp="9"/>', world=cranks)
    for text in ('timeconst=".02 .05"', 'tausmooth=".3" range=".8 1.1"', 'force="20" scale="100"', 'lmin=".6" lmax="1.5" vmax="1.2" fpmax="1.1" fvmax="1.3"'):
        yield acting(f"muscle {text[:5]}", f'<muscle joint="hinge" {text}/><muscle tendon="t" lengthrange=".1 .4" {text}/>', spatial)
    for text in ('mode="all"', 'mode="muscleuser" useexisting="false"', 'mode="all" uselimit="true"', 'mode="all" accel="10" maxforce="5" timeconst=".5" timestep=".005" inttotal="4" tolrange=".2"'):
        name = f"length {text[5:16]}{len(text)}".replace('"', "")
        yield acting(name, '<muscle joint="hinge"/><general joint="slide" gear="2" gainprm="2"/>').replace("<compiler />", f"<compiler><lengthrange {text}/></compiler>")
    for text in ('dyntype="filter" dynprm=".05"', 'dyntype="filterexact" dynprm=".05"', 'dyntype="integrator" actrange="-.01 .01" actlimited="true"', 'dyntype="muscle" dynprm=".02 .05 .1"',
                 'dyntype="filter" dynprm=".05" actearly="true" actrange="-.2 .1"', 'gaintype="affine" gainprm="1 2 3"', 'biastype="affine" biasprm=".1 -2 -.3"',
                 'gaintype="muscle" gainprm=".75 1.05 9 200 .5 1.6 1.5 1.3 1.2" lengthrange="-1 1"', 'biastype="muscle" biasprm=".75 1.05 9 200 .5 1.6 1.5 1.3 1.2" lengthrange="-1 1"',
                 'ctrlrange="-.1 .2" ctrllimited="false"', 'forcerange="-.1 .2" forcelimited="true"'):
        for integrator in ("Euler", "RK4", "implicitfast"):
            if integrator == "Euler" or text[:7] in ("dyntype", "gaintyp"):
                yield acting(f"{integrator} {text[:30]}".replace('"', ""), f'<general joint="hinge" {text}/>', option=f'integrator="{integrator}"')
    for text in ('position joint="hinge" kp="5" dampratio="1"', 'position joint="hinge" inheritrange="1"', 'intvelocity joint="hinge" kp="4" inheritrange=".7"', 'position tendon="t" kp="9" dampratio=".5"',
                 'velocity joint="slide" kv="3"', 'damper joint="hinge" kv="3" ctrlrange="0 2"', 'cylinder joint="slide" timeconst=".1" diameter=".4" bias="1 2 3"', 'position joint="slide" kp="20" timeconst=".02"',
                 'adhesion body="a" ctrlrange="0 3" gain="10"', 'adhesion body="tip" ctrlrange="0 1" gain="2"'):
        for integrator in ("Euler", "implicit"):
            yield acting(f"{integrator} {text[:24]}".replace('"', ""), f"<{text}/>", spatial, option=f'integrator="{integrator}"', world='<geom type="box" size=".2 .2 .1" pos="0 0 .36"/>')


def tendons():
    balls = '<geom name="post" type="{}" size=".05 .2" pos="-.45 .1 .5" euler="10 5 0" contype="0" conaffinity="0"/><site name="out" pos="-.45 .25 .5"/><site name="in" pos="-.45 .11 .51"/><site name="low" pos="-.45 .1 .3"/>'
    for shape in ("sphere", "cylinder"):
        for side in ("", "out", "in", "low"):
            around = f'<geom geom="post"{f" sidesite={chr(34)}{side}{chr(34)}" if side else ""}/>'
            text = f'<tendon><spatial name="t" range="0 .35" stiffness="5" damping=".3"><site site="s0"/>{around}<site site="s1"/></spatial><spatial name="u"><site site="s0"/>{around}<site site="s2"/><pulley divisor="2"/><site site="s1"/><site site="fixed"/></spatial></tendon>'
            yield model(f"wrap {shape} {side}", world=balls.format(shape), more=text + '<actuator><motor tendon="t"/></actuator><sensor><tendonpos tendon="t"/><tendonvel tendon="u"/></sensor>')
    # the tendon bends within the geom, whichever way it is from the sites
    for shape in ("sphere", "cylinder"):
        for size, place in ((0.05, "-.5 .3 .5"), (0.15, "-.2 .4 .5"), (0.1, "-.4 -.1 .6"), (0.05, "-.5 .1 .8")):
            post = f'<geom name="post" type="{shape}" size="{size} .3" pos="{place}" euler="10 5 0" contype="0" conaffinity="0"/><site name="within" pos="{place}"/>'
            around = '<geom geom="post" sidesite="within"/>'
            text = f'<tendon><spatial name="t" stiffness="5"><site site="s0"/>{around}<site site="s1"/></spatial><spatial name="u"><site site="s0"/>{around}<site site="s2"/></spatial></tendon>'
            yield model(f"wrap within {shape} {size}", world=post, more=text + '<actuator><motor tendon="u"/></actuator><sensor><tendonpos tendon="u"/><tendonvel tendon="t"/></sensor>')
    for attributes in ('stiffness="9" springlength=".1"', 'stiffness="9" springlength=".1 .3"', 'damping="2"', 'frictionloss=".3"', 'range=".1 .2" solreflimit=".01 1" margin=".01"', 'armature=".1"', 'stiffness="3 1 2" damping="1 .5"', 'stiffness="0 1 2"', 'damping="0 .5"'):
        for integrator in ("Euler", "implicit"):
            text = f'<tendon><spatial name="t" {attributes}><site site="s0"/><site site="s2"/></spatial><fixed name="f" {attributes}><joint joint="slide" coef="2"/><joint joint="hinge" coef="-1"/></fixed></tendon>'
            yield model(f"tendon {integrator} {attributes[:20]}".replace('"', ""), option=f'integrator="{integrator}"', more=text)
    text = '<tendon><spatial name="t"><site site="s0"/><site site="s2"/></spatial><fixed name="f"><joint joint="slide" coef="2"/></fixed></tendon>'
    for equality in ('<tendon tendon1="t" polycoef=".01 .5"/>', '<tendon tendon1="t" tendon2="f" polycoef="0 1 .2 .1 .3"/>', '<joint joint1="slide" joint2="hinge" polycoef=".01 .5 .2 .1 .3"/>', '<joint joint1="hinge"/>',
                     '<connect body1="a" body2="b" anchor=".1 .05 .2"/>', '<connect body1="a" anchor=".1 .05 .2"/>', '<connect site1="sa" site2="s2"/>', '<weld body1="a" body2="b" torquescale=".3" anchor=".1 0 .1"/>',
                     '<weld body1="b" relpose=".1 0 .5 1 .2 .1 0"/>', '<weld site1="sa" site2="sb"/>', '<weld body1="tip" body2="a" active="false"/>'):
        yield model(f"equality {equality[1:-2]}".replace('"', "").replace("<", "")[:60], more=text + f"<equality>{equality}</equality>")


def forces():
    shapes = {"sphere": ".1", "capsule": ".05 .1", "ellipsoid": ".1 .05 .2", "cylinder": ".06 .1", "box": ".1 .06 .2"}
    bodies = "".join(f'<body pos="{k} 0 1" euler="20 {k}0 5"><freejoint/><geom type="{kind}" size="{size}" {{}}/></body>' for k, (kind, size) in enumerate(shapes.items()))
    for integrator in ("Euler", "RK4", "implicit", "implicitfast"):
        for fluid in ("", 'fluidshape="ellipsoid"', 'fluidshape="ellipsoid" fluidcoef="1 .5 2 .3 .7"'):
            yield model(f"fluid {integrator} {len(fluid)}", option=f'integrator="{integrator}" density="800" viscosity=".5" wind="1 .3 -.2"', base=bodies.format(*[fluid] * 5))
    for integrator in ("Euler", "RK4", "implicit", "implicitfast"):
        for solver in ("Newton", "CG", "PGS"):
            for cone in ("pyramidal", "elliptic"):
                yield model(f"{integrator} {solver} {cone}", option=f'integrator="{integrator}" solver="{solver}" cone="{cone}" impratio="2"', base=LOW)
    for option in ('iterations="2"', 'tolerance="1e-2"', 'ls_iterations="2"', 'ls_tolerance=".5"', 'noslip_iterations="4" noslip_tolerance="1e-3"', 'noslip_iterations="3" cone="elliptic"', 'solver="PGS" iterations="3"', 'jacobian="sparse"',
                   'magnetic="1 2 3"', 'gravity="1 2 -3"', 'o_margin=".1"', 'impratio="9" cone="elliptic"', 'integrator="implicit" timestep=".01"', 'sdf_iterations="5"'):
        yield model(option.replace('"', ""), option=option, base=LOW, more='<sensor><magnetometer site="sa"/></sensor>')
    for flag in "constraint equality frictionloss limit contact spring damper gravity clampctrl warmstart filterparent actuation refsafe sensor midphase eulerdamp autoreset island".split():
        yield model(f"without {flag}", flag=f'{flag}="disable"', base=LOW.replace('range="-20 30"', 'range="-20 30" frictionloss=".1" solreflimit=".001 1"'),
                    more='<equality><joint joint1="slide" joint2="hinge"/></equality><actuator><motor joint="hinge" ctrlrange="-.1 .2"/></actuator><sensor><gyro site="s2"/></sensor>')
    for flag in ('fwdinv="enable"', 'invdiscrete="enable"', 'multiccd="enable"', 'energy="enable"', 'sleep="enable"'):
        yield model(f"with {flag}".replace('"', ""), flag=flag, option='o_margin=".02" o_solref=".03 .8" o_solimp=".8 .9 .01 .5 2" o_friction=".5 .4 .01 .02 .03"', base=LOW)
    for joint in ('stiffness="3" springref="20" ref="10"', 'stiffness="3 1 2"', 'stiffness="0 0 2"', 'damping=".3 .1 .2"', 'damping="0 .1"', 'springdamper=".1 .8"', 'frictionloss=".2" solreffriction=".05 1" solimpfriction=".5 .6 .1"', 'range="-9 9" margin=".1" solimplimit=".5 .9 .05 .3 3"',
                  'actuatorfrcrange="-.1 .2"', 'actuatorgravcomp="true"', 'limited="false" range="-1 1"', 'pos=".1 .2 .3" axis="1 2 3"'):
        for kind in ("hinge", "slide", "ball"):
            own = joint if kind != "ball" else joint.replace(' ref="10"', "").replace("-9", "0").replace("-1 1", "0 1")
            body = f'<body pos="1 0 1" gravcomp=".7"><joint name="j" type="{kind}" {own}/><geom type="box" size=".1 .2 .05" pos=".1 0 0"/></body>'
            yield model(f"{kind} {joint[:24]}".replace('"', ""), base=body, more='<actuator><motor joint="j" gear="2"/></actuator>')
    field = '<asset><hfield name="h" nrow="3" ncol="3" size=".2 .3 .1 .1" elevation="0 1 0 2 3 1 0 1 0"/><mesh name="m" vertex="-.1 -.1 -.1 .1 -.1 -.1 0 .1 -.1 0 0 .1"/></asset>'
    eyes = "".join(f'<site name="e{k}" pos="{pos}" zaxis="{axis}"/>' for k, (pos, axis) in enumerate((
        (".5 0 -.05", "-1 0 0"), ("-.5 .1 -.05", "1 0 0"), ("0 .6 -.05", "0 -1 0"), (".05 -.6 -.05", "0 1 0"), ("0 .1 -.5", "0 0 1"), (".05 .1 .5", "0 0 -1"), (".5 .05 .03", "-1 0 0"), ("0 .5 .02", "0 -1 0"),
        ("1 0 .12", "0 0 -1"), ("1.02 .01 -.15", "0 0 1"), ("1.3 0 0", "-1 0 0"), ("1 -.12 0", "0 1 0"), ("1 0 0", "0 0 1"))))
    world = f'<body name="turned" euler="{{}}"><geom type="hfield" hfield="h"/><geom type="mesh" mesh="m" pos="1 0 0"/>{eyes}</body><body pos="3 0 0"><freejoint/><geom size=".1"/></body>'
    rays = "".join(f'<rangefinder site="e{k}" data="dist point normal"/>' for k in range(13))
    for turn in ("0 0 0", "20 30 40"):
        yield model(f"normals {turn}", base=world.format(turn), more=f"{field}<sensor>{rays}</sensor>")
    for vmax in (".001", ".02", ".3"):
        for fvmax in ("1.1", "1.7"):
            yield model(f"muscle {vmax} {fvmax}", more=f'<actuator><muscle joint="slide" lengthrange="-.2 .2" vmax="{vmax}" fvmax="{fvmax}" force="3"/><muscle joint="hinge" lengthrange="-1 1" vmax="{vmax}" fvmax="{fvmax}" force="3"/></actuator>')
    for step in ("1.5", "1.8", "2.5", "4", "7"):
        spun = '<body><freejoint/><inertial pos=".1 .02 .03" quat=".9 .1 .3 .2" mass="1" diaginertia="1 2 2.5"/><geom size=".1"/></body>'
        for integrator in ("implicitfast", "Euler"):
            yield model(f"spin {integrator} {step}", option=f'timestep="{step}" gravity="0 0 0" integrator="{integrator}"', base=spun)
    for kind, turn in (("hinge", "30"), ("slide", ".2"), ("ball", "")):
        for stiffness in ("3", "0 2", "0 0 2"):
            own = f'stiffness="{stiffness}"' + (f' springref="{turn}"' if turn else "")
            body = f'<body pos="1 0 1"><joint name="j" type="{kind}" {own}/><geom type="box" size=".1 .2 .05" pos=".1 0 0"/></body>'
            yield model(f"energy {kind} {stiffness}", base=body, more="<sensor><e_potential/><e_kinetic/></sensor>")
    for stiffness in ("9", "0 2", "0 0 2"):
        text = f'<tendon><spatial stiffness="{stiffness}" springlength=".1 .2"><site site="s0"/><site site="s2"/></spatial></tendon>'
        yield model(f"energy tendon {stiffness}", more=text + "<sensor><e_potential/><e_kinetic/></sensor>")
    yield model("free joint", base='<body pos="0 0 .1"><joint type="free" damping=".3" armature=".2" frictionloss=".1" stiffness="2"/><geom type="box" size=".1 .2 .05"/></body><geom type="plane" size="1 1 1"/>')
    mocap = '<body name="hold" mocap="true" pos=".3 0 .6" euler="10 20 30"><geom size=".05" contype="0" conaffinity="0"/></body>'
    yield model("mocap", world=mocap, more='<equality><weld body1="hold" body2="a" solref=".05 1"/><connect body1="hold" body2="tip" anchor="0 0 .1"/></equality>')


def compiled():
    body = '<body name="p" pos="0 0 1"><joint axis="1 2 3"/>{}<geom type="box" size=".1 .2 .05" pos=".1 0 0" euler="10 20 30"/><geom type="capsule" size=".04 .1" pos="-.1 .05 0" group="3" contype="0" conaffinity="0"/><body pos=".1 0 .1" euler="40 0 0"><geom type="cylinder" size=".05 .1"/><site name="in" pos=".01 0 0"/></body><body pos=".2 0 0"><joint axis="0 1 0"/><geom size=".1"/></body></body>'
    given = '<inertial pos=".02 .01 0" quat="1 .1 .2 .3" mass="2" diaginertia=".02 .03 .04"/>'
    full = '<inertial pos=".02 .01 0" mass="2" fullinertia=".02 .03 .04 .001 .002 .003"/>'
    bad = '<inertial pos=".02 .01 0" mass="2" diaginertia=".02 .03 .09"/>'
    for compiler in ('inertiafromgeom="true"', 'inertiafromgeom="false"', 'inertiafromgeom="auto"', 'balanceinertia="true"', 'boundmass="3" boundinertia=".1"', 'settotalmass="7"', 'inertiagrouprange="0 2" inertiafromgeom="true"', 'fusestatic="true"',
                     'discardvisual="true"', 'autolimits="false"', 'angle="radian"', 'eulerseq="zyx"', 'coordinate="local" alignfree="true"', 'usethread="false"'):
        for own in (given, full, bad, ""):
            if own == given or compiler[:7] in ("balance", "inertia", "fusesta"):
                yield model(f"{compiler} {own[:20]}{len(own)}".replace('"', "").replace("<", ""), compiler=compiler, base=body.format(own), more='<sensor><framelinacc objtype="site" objname="in"/></sensor>')
    free = '<body pos="0 0 1" euler="10 20 30"><freejoint align="{}"/><geom type="box" size=".1 .2 .05" pos=".1 0 0" euler="10 20 30"/><geom size=".1" mass="2" pos="-.2 0 0"/></body>'
    for align in ("true", "false", "auto"):
        yield model(f"align {align}", base=free.format(align), compiler='alignfree="true"')
    for orientation in ('quat="1 .2 .3 .4"', 'axisangle="1 2 3 40"', 'euler="10 20 30"', 'xyaxes="1 .1 0 .1 1 .3"', 'zaxis="1 .2 .3"', 'zaxis="0 0 -1"'):
        yield model(f"turned {orientation[:12]}".replace('"', ""), base=f'<frame pos=".1 0 1" {orientation}><body {orientation}><joint axis="1 2 3"/><geom type="box" size=".1 .2 .05" pos=".1 0 0" {orientation}/><site name="s" {orientation}/></body></frame>', more='<sensor><framequat objtype="site" objname="s"/></sensor>')
    copies = ['<replicate count="3" offset=".3 0 .1" euler="0 0 20">{}</replicate>', '<replicate count="2" offset="0 .5 0"><replicate count="2" offset=".4 0 0" sep="_" euler="30 0 0">{}</replicate></replicate>', '<frame pos="0 0 .2" euler="0 30 0" childclass="own">{}</frame>']
    for number, copy in enumerate(copies):
        inner = '<body name="r" pos=".1 0 1"><joint name="rj" axis="0 1 0"/><geom type="box" size=".1 .05 .02" pos=".1 0 0"/></body>'
        yield model(f"copies {number}", base=copy.format(inner), more='<default><default class="own"><joint damping=".3"/><geom density="500"/></default></default>')
    for text in ('builtin="sphere" params="2"', 'builtin="hemisphere" params="3"', 'builtin="cone" params="6 .3"', 'builtin="supersphere" params="9 .7 .5"', 'builtin="supertorus" params="9 .3 .7 .9"', 'vertex="0 0 0 1 0 0 0 1 0 0 0 1 .6 .6 .6"'):
        for inertia in ("convex", "exact", "legacy", "shell"):
            scale = ".2 .1 .15"
            body = '<geom type="plane" size="2 2 1"/><body pos="0 0 .08" euler="5 10 0"><freejoint/><geom type="mesh" mesh="m"/></body><body pos="1 0 .3"><freejoint/><geom type="box" mesh="m"/></body>'
            yield model(f"mesh {text[:20]} {inertia}".replace('"', ""), base=body, more=f'<asset><mesh name="m" scale="{scale}" inertia="{inertia}" {text}/></asset>')
    field = '<asset><hfield name="h" nrow="3" ncol="4" size="1 1 .3 .1" elevation="0 1 2 0 3 1 0 2 1 1 0 2"/></asset>'
    shapes = {"sphere": ".1", "capsule": ".05 .1", "ellipsoid": ".1 .05 .2", "cylinder": ".06 .1", "box": ".1 .06 .2"}
    bodies = "".join(f'<body pos="{k / 3 - .8} {.2 * k - .3} .33" euler="20 {k}0 5"><freejoint/><geom type="{kind}" size="{size}"/></body>' for k, (kind, size) in enumerate(shapes.items()))
    yield model("height field", base='<geom type="hfield" hfield="h"/>' + bodies, more=field)


def discrete():
    dampers = '<actuator><position joint="hinge" kp="3" kv=".2"/><intvelocity joint="slide" kp="5" kv=".3" actrange="-1 1"/></actuator>'
    low = LOW.replace('damping=".3"', 'damping=".3 .1 .2"')
    for option in ('integrator="Euler"', 'integrator="implicit" density="800"', 'integrator="implicitfast" density="800"'):
        for flag in ("", 'eulerdamp="disable"', 'damper="disable"'):
            yield model(f"discrete {option[12:-1]} {flag}".replace('"', ""), option=option, flag=f'invdiscrete="enable" {flag}', base=low, more=dampers + '<sensor><accelerometer site="sa"/></sensor>')
    paths = '<spatial name="t" armature=".13" {}><site site="s0"/><site site="s2"/><pulley divisor="2"/><site site="sa"/><site site="s1"/></spatial><fixed name="f" armature=".2"><joint joint="slide" coef="2"/></fixed>'
    for own in ("", 'stiffness="9" springlength=".1" damping="2" frictionloss=".3" range=".1 .2"'):
        for more in ("", '<equality><tendon tendon1="t" tendon2="f" polycoef=".1 1 .2 .1 .3"/></equality><actuator><motor tendon="t"/><position tendon="t" kp="3" kv=".1"/></actuator>'):
            yield model(f"inertia of a tendon {len(own)} {len(more)}", more=f"<tendon>{paths.format(own)}</tendon>{more}")


def draw():
    for part in (frame_sensors, other_sensors, actuators, tendons, forces, compiled, discrete):
        yield from part()


def models(*others):
    """The models of ``models.txt``, and of the files of this name in other folders."""
    files = [FOLDER.parent / name / "models.txt" for name in (FOLDER.name, *others)]
    lines = [line for file in files for line in file.read_text().splitlines()]
    return [line.replace("@low", LOW).replace("@", WORLD) for line in lines]


def start(model, data, random):
    data.qvel[:] = random.uniform(-1, 1, model.nv)


def drive(model, data, random):
    data.ctrl[:] = random.uniform(-1, 1, model.nu)


def main():
    if "--models" in sys.argv:
        print(*(text.replace(WORLD, "@").replace(LOW, "@low") for text in draw()), sep="\n")
    else:
        of_texts(models(), lambda text: of_steps(text, STEPS, start, drive))


if __name__ == "__main__":
    main()
