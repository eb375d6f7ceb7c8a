"""Record models of several files, and of shapes and surfaces without files, into language.json.

    pip install mujoco==3.12.0        (or 4.0.0: the installed version is added)
    python language.py

Each model is stepped 20 times, or until its parts have touched for long; the control of actuator k is 0.1 (k + 1).
"""
import json
import os
import tempfile

import mujoco

KID = """<mujoco model="kid">
<compiler angle="radian" eulerseq="zyx"/>
<default><geom density="700"/><default class="blue"><geom rgba="0 0 1 1" size=".07"/><joint damping=".3"/></default></default>
<asset><material name="mat" rgba="1 0 0 1"/><mesh name="tet" vertex="0 0 0 .2 0 0 0 .2 0 0 0 .2"/></asset>
<worldbody>
<frame name="outer" pos=".1 .2 .3" euler=".1 .2 .3"><frame name="inner" pos="0 0 .1" euler="0 .4 0">
<body name="b" pos=".3 0 .5" euler=".3 .1 0" childclass="blue"><joint name="j" axis="0 1 0" range="-1 1" ref=".1"/>
<geom name="g" pos=".1 0 0"/><site name="s" pos=".1 .1 0" euler=".2 0 .1"/>
<body name="c" pos=".2 0 0"><joint name="k" axis="1 0 0"/><geom type="mesh" mesh="tet" material="mat"/>
<geom class="blue" pos="0 .1 .1"/><site name="t"/></body></body>
<geom name="loose" size=".05" pos="0 0 -.5"/><body name="free" pos="-.5 0 .5"><freejoint/><geom size=".1"/></body></frame></frame>
<body name="m" mocap="true" pos="1 1 1"><geom size=".01" contype="0" conaffinity="0"/></body></worldbody>
<contact><exclude body1="b" body2="c"/></contact>
<tendon><fixed name="fx"><joint joint="j" coef="1"/><joint joint="k" coef="-.5"/></fixed>
<spatial name="sp" stiffness="3"><site site="s"/><site site="t"/></spatial></tendon>
<equality><joint joint1="j" joint2="k" polycoef="0 .4 0 0 0"/></equality>
<actuator><position name="p" joint="j" kp="4"/><general name="gen" joint="k" dyntype="filter" dynprm=".3" gainprm="2"/>
<motor name="mt" tendon="fx"/></actuator>
<sensor><jointpos joint="j"/><framepos objtype="site" objname="t"/><framepos objtype="body" objname="free" reftype="site" refname="s"/>
<tendonpos tendon="sp"/><clock name="ck"/></sensor>
KEY</mujoco>"""
KEY = '<keyframe><key name="home" time="2" qpos=".2 .3 0 0 1 1 0 0 0" qvel=".1 .2 0 0 0 0 0 .4" act=".3" ctrl=".1 .2 .3" mpos="2 2 2"/></keyframe>'
FLOOR = '<geom type="plane" size="5 5 .1"/>'
BELT = """<mujoco><option cone="CONE"/><worldbody>
<frame euler="0 10 0"><geom type="box" size="1 .5 .1" pos="0 0 .1" surfacevel=".7 0 0 0 0 .3"/>
<geom type="cylinder" size=".1 .5" pos="1.1 0 .1" euler="90 0 0" surfacevel="0 0 0 0 0 -7" friction=".4"/></frame>
<body pos="0 .1 .4"><freejoint/><geom type="box" size=".1 .15 .1" surfacevel="0 .1 0 0 0 0"/></body>
<body pos="-.5 0 .5"><freejoint/><geom size=".1" condim="6"/></body>
<body pos="1 .2 .3"><freejoint/><geom type="capsule" size=".05 .1" condim="4" euler="90 0 0"/></body>
<body pos=".5 -.2 .4"><freejoint/><geom size=".1" condim="1"/></body></worldbody></mujoco>"""
SHAPES = """<mujoco><asset><mesh name="a" builtin="sphere" params="2" scale=".2 .1 .1"/><mesh name="b" builtin="hemisphere" params="3" scale=".2 .2 .1"/>
<mesh name="c" builtin="supersphere" params="9 .3 .4" scale=".1 .2 .1"/><mesh name="d" builtin="supertorus" params="8 .3 .4 1.2" scale=".1 .1 .2"/>
<mesh name="e" builtin="cone" params="7 .4" scale=".1 .1 .1"/><mesh name="f" builtin="cone" params="5 0" scale=".1 .1 .1"/></asset><worldbody>
<geom type="plane" size="5 5 .1"/>%s</worldbody></mujoco>""" % "".join(
    f'<body pos="{i % 3 * .3} {i // 3 * .3} .25" euler="{20 * i} 10 0"><freejoint/><geom type="mesh" mesh="{name}"/></body>'
    for i, name in enumerate("abcdef")
)
FILES = {
    "kid.xml": KID.replace("KEY", KEY),
    "keyless.xml": KID.replace("KEY", ""),
    "mid.xml": """<mujoco model="mid"><asset><model name="kid" file="keyless.xml"/></asset><worldbody>
<body name="carrier" pos="0 0 1"><joint name="cj" axis="0 1 0"/><geom size=".2"/><attach model="kid" body="b" prefix="in_"/></body></worldbody>
<actuator><motor joint="cj" gear="3"/></actuator></mujoco>""",
    "parts.xml": f"""<mujoco model="parts"><option timestep=".004"/><asset><model name="kid" file="kid.xml"/></asset><worldbody>{FLOOR}
<frame pos="2 0 0" euler="0 0 45"><attach model="kid" frame="outer" prefix="y_"/></frame>
<body name="own" pos="0 0 2"><joint name="oj" axis="0 0 1"/><geom size=".1"/>
<frame pos=".3 0 0" euler="20 0 0"><attach model="kid" body="b" prefix="x_"/></frame></body></worldbody>
<actuator><motor joint="oj"/></actuator><sensor><jointvel joint="oj"/></sensor><keyframe><key name="mine" qpos=".3 .1 0 0 0 1 1 0 0 0 .2 .1"/></keyframe></mujoco>""",
    "copies.xml": f"""<mujoco><asset><model file="kid.xml"/></asset><worldbody>{FLOOR}<attach model="kid" prefix="w/"/>
<replicate count="3" offset="0 2 0" euler="0 0 30" sep="-"><frame pos="3 0 1"><attach model="kid" frame="inner" prefix="r_"/></frame></replicate>
</worldbody></mujoco>""",
    "nested.xml": """<mujoco><asset><model name="mid" file="mid.xml"/></asset><worldbody><attach model="mid" body="carrier" prefix="a_"/>
<frame pos="0 3 0"><attach model="mid" prefix="b_"/></frame></worldbody><sensor><framepos objtype="body" objname="a_in_c"/></sensor></mujoco>""",
    "itself.xml": f"""<mujoco><worldbody>{FLOOR}<frame name="f" pos="0 0 1" euler="0 30 0">
<body name="q"><joint name="qj" axis="0 1 0"/><geom name="qg" size=".1" pos=".3 0 0"/><site name="qs"/></body><geom name="fg" size=".05"/></frame>
<frame pos="1 0 0"><attach frame="f" prefix="u_"/></frame><attach body="q" prefix="v_"/></worldbody>
<actuator><motor name="am" joint="qj"/></actuator>
<sensor><jointpos joint="qj"/><framepos objtype="site" objname="qs"/></sensor></mujoco>""",
    "belt.xml": BELT.replace("CONE", "pyramidal"),
    "belt_cones.xml": BELT.replace("CONE", "elliptic"),
    "shapes.xml": SHAPES,
}
HFIELD = '<hfield name="h" nrow="4" ncol="4" size="1 1 .3 .1" elevation="0 1 0 1 1 0 1 0 0 .5 0 1 1 0 1 0"/>'
FALLING = """<body pos=".1 .2 SPHERE"><freejoint/><geom size=".2"/></body><body pos=".5 .2 BOX"><freejoint/><geom type="box" size=".1 .2 .1"/></body>
<body pos="2 .2 .3"><freejoint/><geom type="capsule" size=".1 .2"/></body>"""
FILES["moving_field.xml"] = f"""<mujoco><asset>{HFIELD}</asset><worldbody><body mocap="true" euler="5 10 0"><geom type="plane" size="3 3 .1"/></body>
<body pos="0 0 .3" euler="10 20 0"><freejoint/><geom type="hfield" hfield="h"/><geom size=".2" pos="0 0 -.1"/></body>
{FALLING.replace("SPHERE", ".5").replace("BOX", ".45")}</worldbody></mujoco>"""
FILES["mocap_field.xml"] = f"""<mujoco><asset>{HFIELD}</asset><worldbody><body mocap="true" euler="5 10 0" pos="0 0 .3"><geom type="hfield" hfield="h"/></body>
<body><geom type="plane" size="3 3 .1"/><geom type="box" size=".3 .3 .3" pos="2 0 -.1"/></body>
{FALLING.replace("SPHERE", ".5").replace("BOX", ".45")}</worldbody></mujoco>"""
MODELS = ["parts", "copies", "nested", "itself", "belt", "belt_cones", "shapes", "moving_field", "mocap_field"]
STEPS = {"belt": 150, "belt_cones": 150}
KINDS = "body joint geom site tendon actuator sensor equality key".split()


def names(model, kind):
    counts = {"body": "nbody", "joint": "njnt", "actuator": "nactuator", "equality": "neq"}
    count = getattr(model, counts.get(kind, "n" + kind), model.nu)
    of = getattr(mujoco.mjtObj, "mjOBJ_" + kind.upper())
    return [mujoco.mj_id2name(model, of, i) for i in range(count)]


def record(folder, name):
    model = mujoco.MjModel.from_xml_path(os.path.join(folder, name + ".xml"))
    data = mujoco.MjData(model)
    steps = STEPS.get(name, 20)
    for _ in range(steps):
        data.ctrl[:] = [0.1 * (k + 1) for k in range(model.nu)]
        mujoco.mj_step(model, data)
    keys = {key: getattr(model, "key_" + key).tolist() for key in ("time", "qpos", "qvel", "act", "ctrl", "mpos")}
    known = {kind: names(model, kind) for kind in KINDS}
    assert data.ncon or name not in ("moving_field", "mocap_field", *STEPS)
    return {"steps": steps, "qpos": data.qpos.tolist(), "sensordata": data.sensordata.tolist(), "names": known, "keys": keys if model.nkey else None}


def main():
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "language.json")
    old = json.load(open(path))["versions"] if os.path.exists(path) else {}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in FILES.items():
            open(os.path.join(folder, name), "w").write(text)
        old[mujoco.__version__] = {name: record(folder, name) for name in MODELS}
    with open(path, "w") as file:
        rows = [f'"{version}": {{\n' + ",\n".join(f'"{k}": {json.dumps(v)}' for k, v in of.items()) + "\n}" for version, of in sorted(old.items())]
        files = ",\n".join(f'"{k}": {json.dumps(v)}' for k, v in FILES.items())
        file.write('{"files": {\n' + files + '\n},\n"versions": {\n' + ",\n".join(rows) + "\n}}\n")


if __name__ == "__main__":
    main()
