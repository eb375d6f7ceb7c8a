#!/usr/bin/env python3
"""Record which fields of a model each attribute of MJCF changes, and to which numbers: `fields.json`.

    python fields.py PYTHON...        a Python with each version of mujoco, such as 3.12.0 and 4.0.0
"""
import json
import re
import subprocess
import sys
from pathlib import Path

BASE = """<mujoco><compiler @compiler/><option @option><flag @flag/></option><statistic @statistic/>
<asset><mesh name="m" vertex="0 0 0 1 0 0 0 1.5 0 0 0 2" @mesh/><hfield name="h" nrow="2" ncol="3" size="1 2 3 .5" @hfield/>
<texture name="t" @texture(type="2d" builtin="flat" width="4" height="4")/><material name="red" texture="t"/><material name="mat" @material/></asset>
<worldbody><geom name="floor" type="plane" size="5 5 .1"/><light @light/><camera name="c" @camera/><site name="w" pos="0 0 2"/>
<body name="a" pos="0 0 1"><joint name="j" @joint/><geom name="g" type="box" size=".1 .2 .3" @geom/><site name="s" @site/>
<body name="b" @body><joint name="k" type="slide" @slide/><geom name="g2" type="capsule" size=".05 .2"/><site name="s2" pos="0 .1 .2"/>
</body></body><body name="f" pos="2 0 1"><freejoint @freejoint/><inertial pos="0 0 0" mass="2" diaginertia="1 1.1 1.2" @inertial/>
<geom mesh="m" @meshgeom(type="mesh")/></body><body name="ball" pos="0 2 1"><joint name="r" type="ball" @ball/><geom @sphere(size=".1")/></body>
<body name="moved" mocap="true"/></worldbody>
<contact><pair geom1="g" geom2="floor" @pair/></contact>
<tendon><spatial name="ts" @spatial><site site="s"/><site site="s2"/></spatial>
<fixed name="tf" @fixed><joint joint="j" coef="1"/><joint joint="k" coef="2"/></fixed></tendon>
<equality><connect body1="b" anchor=".1 0 0" @connect/><weld body1="f" @weld/><joint joint1="j" @joint1/><tendon tendon1="tf" @tendon1/>
</equality>
<actuator><general joint="j" @general/><motor joint="k" @motor/><position name="p" joint="j" @position/><velocity joint="j" @velocity/>
<intvelocity joint="j" actrange="-1 1" @intvelocity/><damper joint="j" ctrlrange="0 1" @damper/><cylinder joint="j" @cylinder/>
<muscle tendon="ts" lengthrange=".1 .4" @muscle/><adhesion body="b" ctrlrange="0 1" @adhesion/></actuator>
<sensor><touch site="s" @touch/><jointpos joint="j" @jointpos/><framepos objtype="body" objname="b" @framepos/>
<distance geom1="g" geom2="g2" @distance/><contact @contact/><rangefinder site="s" @rangefinder/></sensor>
<keyframe><key @key/></keyframe></mujoco>"""

ORIENTATIONS = ["quat='1 2 3 4'", "axisangle='1 2 3 40'", "euler='10 20 30'", "xyaxes='1 1 0 0 1 1'", "zaxis='1 2 3'"]
LIMITS = ["range='-1 2'", "range='-1 2' limited='false'", "margin='0.25'", "solreflimit='0.5 2'", "solimplimit='0.5 0.6 0.7 0.8 3'",
          "solreffriction='0.25 3'", "solimpfriction='0.4 0.5 0.6 0.7 4'", "stiffness='3'", "damping='4'", "armature='5'",
          "frictionloss='6'", "actuatorfrcrange='-3 4'", "actuatorfrcrange='-3 4' actuatorfrclimited='false'"]
# (random marks of textures are the engine's own)
ACTUATOR = ["ctrlrange='-2 3'", "ctrlrange='-2 3' ctrllimited='false'", "forcerange='-4 5'", "forcerange='-4 5' forcelimited='false'",
            "group='2'", "gear='2 3 4 5 6 7'", "lengthrange='-3 4'"]
SENSOR = ["cutoff='0.5'", "noise='0.25'"]
SOFT = ["solref='0.5 2'", "solref='-300 -20'", "solimp='0.5 0.6 0.7 0.8 3'", "solimp='0.5 0.6'"]
ROWS = {
    "compiler": ["balanceinertia='true'", "boundmass='3'", "boundinertia='0.5'",
                 "settotalmass='10'", "inertiafromgeom='true'", "inertiafromgeom='false' boundmass='1' boundinertia='1'",
                 "inertiagrouprange='0 0'", "alignfree='true'", "fusestatic='true'"],
    "option": ["timestep='0.004'", "gravity='1 2 3'", "wind='1 2 3'", "magnetic='1 2 3'", "density='2'", "viscosity='3'",
               "integrator='RK4'", "integrator='implicit'", "integrator='implicitfast'", "solver='PGS'", "solver='CG'",
               "iterations='7'", "ls_iterations='8'", "tolerance='1e-5'", "ls_tolerance='0.1'", "cone='elliptic'", "impratio='2'",
               "noslip_iterations='3'", "noslip_tolerance='1e-3'", "jacobian='dense'", "jacobian='sparse'",
               "actuatorgroupdisable='1 4 30'"],
    "flag": [f"{name}='disable'" for name in
             "constraint equality frictionloss limit contact spring damper gravity clampctrl warmstart filterparent actuation refsafe "
             "sensor midphase eulerdamp autoreset island multiccd".split()]
    + [f"{name}='enable'" for name in "energy multiccd".split()],
    "statistic": ["meaninertia='2'", "meanmass='3'", "meansize='4'", "extent='5'", "center='1 2 3'"],
    "mesh": ["scale='1 2 3'", "scale='-1 1 1'", "refpos='1 2 3'", "refquat='1 2 3 4'", "inertia='shell'", "inertia='exact'",
             "maxhullvert='4'"],
    "hfield": ["elevation='1 2 3 4 5 6'"],
    "texture": ["type='cube' builtin='flat' width='4' height='24'",
                "type='skybox' builtin='flat' width='4' height='24'",
                "type='2d' builtin='flat' width='4' height='4' rgb1='0.2 0.4 0.6'",
                "type='2d' builtin='flat' width='8' height='4' rgb1='1 0 0'",
                "type='2d' builtin='flat' width='4' height='6'",
                "type='2d' builtin='gradient' width='4' height='4' rgb1='1 0 0' rgb2='0 0 1'",
                "type='2d' builtin='checker' width='4' height='4' rgb1='1 0 0' rgb2='0 0 1'",
                "type='2d' builtin='flat' width='4' height='4' rgb1='1 0 0' mark='edge' markrgb='0 1 0'",
                "type='2d' builtin='flat' width='5' height='5' rgb1='1 0 0' mark='cross' markrgb='0 1 0'"],
    "material": ["rgba='0.1 0.2 0.3 0.4'", "emission='0.25'", "specular='0.75'", "shininess='0.125'", "texture='t'",
                 "texture='t' texrepeat='2 3'", "texture='t' texuniform='true'"],
    "light": ["pos='1 2 3'", "dir='1 2 3'", "type='directional'", "directional='true'"],
    "camera": ["pos='1 2 3'", *ORIENTATIONS, "fovy='60'", "mode='targetbody' target='b'", "mode='track'", "mode='trackcom'",
               "mode='targetbodycom' target='f'", "projection='orthographic'", "resolution='40 30'",
               "sensorsize='0.1 0.2' focal='0.3 0.4' resolution='40 30'",
               "sensorsize='0.1 0.2' focalpixel='30 40' resolution='40 30'",
               "sensorsize='0.1 0.2' focal='0.3 0.4' principal='0.01 0.02' resolution='40 30'",
               "sensorsize='0.1 0.2' focal='0.3 0.4' principalpixel='1 2' resolution='40 30'"],
    "joint": [*LIMITS, "pos='1 2 3'", "axis='1 2 3'", "ref='30'", "springref='40'", "springdamper='0.5 2'",
              "actuatorgravcomp='true'"],
    "slide": [*LIMITS, "pos='1 2 3'", "axis='1 2 3'", "ref='0.5'", "springref='0.25'", "springdamper='0.5 2'"],
    "ball": ["range='0 50'", "stiffness='3'", "damping='4'", "pos='1 2 3'", "armature='2'", "frictionloss='3'"],
    "geom": ["pos='1 2 3'", *ORIENTATIONS, "contype='6'", "conaffinity='5'", "condim='1'", "condim='4'", "condim='6'", "group='3'",
             "priority='7'", "friction='0.5'", "friction='0.5 0.1 0.2'", "mass='3'", "density='500'",
             "shellinertia='true'", "solmix='0.5'", *SOFT, "margin='0.5'", "margin='0.5' gap='0.25'", "rgba='0.1 0.2 0.3 0.4'",
             "material='mat'", "fluidshape='ellipsoid'", "fluidshape='ellipsoid' fluidcoef='1 2 3 4 5'"],
    "sphere": ["type='ellipsoid' size='.1 .2 .3'", "type='cylinder' size='.1 .3'", "type='capsule' size='.1 .3'",
               "type='capsule' size='.1' fromto='0 0 0 1 2 3'", "type='box' size='.1' fromto='0 0 0 1 2 3'",
               "type='cylinder' size='.1' fromto='1 0 0 1 2 3'", "type='ellipsoid' size='.1' fromto='0 1 0 1 2 3'",
               "type='mesh' mesh='m'", "type='box' size='.1 .2 .3' density='2000' shellinertia='true'",
               "type='capsule' size='.1 .3' shellinertia='true'", "type='cylinder' size='.1 .3' shellinertia='true'",
               "type='ellipsoid' size='.1 .2 .3' shellinertia='true'", "size='0.2' shellinertia='true'"],
    "meshgeom": ["type='mesh' pos='1 2 3'", "type='mesh' quat='1 2 3 4'", "type='box'", "type='sphere'", "type='capsule'", "type='cylinder'",
                 "type='ellipsoid'", "type='box' fitscale='2'"],
    "site": ["pos='1 2 3'", *ORIENTATIONS, "size='1 2 3'", "type='box' size='1 2 3'", "type='capsule' size='1 2'",
             "type='cylinder' size='1 2'", "type='ellipsoid' size='1 2 3'", "type='capsule' fromto='0 0 0 1 2 3' size='0.5'",
             "rgba='0.1 0.2 0.3 0.4'", "material='mat'", "group='4'"],
    "body": ["pos='1 2 3'", *ORIENTATIONS, "gravcomp='0.5'"],
    "freejoint": ["align='true'", "align='false'"],
    "inertial": ORIENTATIONS,
    "pair": ["condim='1'", "condim='6'", "friction='1 2 3 4 5'", "friction='0.5'", *SOFT, "solreffriction='0.25 3'", "margin='0.5'",
             "margin='0.5' gap='0.25'"],
    "spatial": [*LIMITS, "springlength='0.5'", "springlength='0.5 0.75'", "width='0.5'", "rgba='0.1 0.2 0.3 0.4'"],
    "fixed": [*LIMITS, "springlength='0.5'", "springlength='0.5 0.75'"],
    "connect": [*SOFT, "active='false'", "body2='a'"],
    "weld": [*SOFT, "active='false'", "body2='b'", "anchor='1 2 3'", "relpose='1 2 3 1 0 0 0'", "relpose='1 2 3 1 2 3 4'",
             "torquescale='0.5'"],
    "joint1": [*SOFT, "active='false'", "joint2='k'", "joint2='k' polycoef='1 2 3 4 5'"],
    "tendon1": [*SOFT, "active='false'", "tendon2='ts'", "tendon2='ts' polycoef='1 2 3 4 5'"],
    "general": [*ACTUATOR, "dyntype='integrator'", "dyntype='filter' dynprm='0.5'", "dyntype='filterexact' dynprm='0.5'",
                "dyntype='muscle' dynprm='1 2 3'", "gaintype='affine' gainprm='1 2 3'", "gainprm='4'", "biastype='affine'",
                "biastype='affine' biasprm='1 2 3'", "gaintype='muscle' gainprm='0.5 1.5 3 4 0.5 2 7 8 9' lengthrange='0 1'",
                "biastype='muscle' biasprm='0.5 1.5 3 4 0.5 2 7 8 9' lengthrange='0 1'",
                "dyntype='integrator' actrange='-3 4'", "dyntype='integrator' actrange='-3 4' actlimited='false'",
                "dyntype='integrator' actearly='true'"],
    "motor": ACTUATOR,
    "position": [*ACTUATOR, "kp='20'", "kp='20' kv='3'", "dampratio='0.5'", "timeconst='0.25'"],
    "velocity": [*ACTUATOR, "kv='3'"],
    "intvelocity": [*ACTUATOR, "kp='20'", "kp='20' kv='3'", "dampratio='0.5'"],
    "damper": ["kv='3'", "forcerange='-4 5'", "group='2'", "gear='2'"],
    "cylinder": [*ACTUATOR, "area='2'", "diameter='2'", "bias='1 2 3'", "timeconst='0.5'"],
    "muscle": [*ACTUATOR[:-1], "timeconst='0.5 0.75'", "tausmooth='0.25'", "range='0.5 0.75'", "force='30'", "scale='40'", "lmin='0.25'",
               "lmax='2.5'", "vmax='3.5'", "fpmax='4.5'", "fvmax='5.5'"],
    "adhesion": ["gain='3'", "forcerange='-4 5'", "group='2'"],
    "touch": SENSOR, "jointpos": SENSOR, "framepos": [*SENSOR, "reftype='site' refname='s'", "reftype='geom' refname='g2'"],
    "distance": SENSOR,
    "contact": ["geom1='g'", "geom1='g' geom2='g2'", "body1='a' body2='b'", "subtree1='a'", "subtree1='a' subtree2='f'", "site='w'",
                "num='3'", "reduce='mindist'", "reduce='maxforce'", "reduce='netforce'", "data='found force dist'",
                "data='pos normal tangent'", "data='torque'"],
    "rangefinder": ["data='dir origin point depth'"],
    "key": ["time='2'", "qpos='" + " ".join(str(0.5 + i) for i in range(2)) + " 0 0 1 1 0 0 0 1 0 0 0'",
            "qvel='" + " ".join(str(i + 1) for i in range(11)) + "'", "ctrl='1 2 3 4 5 6 7 8 0.5'", "mpos='1 2 3'", "mquat='1 2 3 4'",
            "act='1 2 3'"],
}


def model(place="", text=""):
    """Return the model with the attributes `text` at `@place`; others have what is in parentheses."""
    return re.sub(r"@(\w+)(?:\((.*?)\))?", lambda found: text if found[1] == place else found[2] or "", BASE)


def fields(model):
    """Return the numbers of each field of a model."""
    import mujoco
    import numpy as np

    source = Path(__file__).parents[2] / "src/model"
    text = "".join((source / name).read_text() for name in ("mod.rs", "meshes.rs", "hfields.rs", "textures.rs", "types.rs"))
    names = set(re.findall(r"pub (\w+): ", text)) | {"dof_M0"}
    names.remove("eq_objtype")  # with kinds of its own
    found = {}
    for of, prefix in ((model, ""), (model.opt, "opt."), (model.stat, "stat.")):
        for name in names:
            value = getattr(of, name, None)
            if isinstance(value, (int, float, np.ndarray)):
                found[prefix + name] = [x.item() for x in np.ravel(value)]
    # what the engine keeps: 11 numbers of a constraint, the texture of a material's colours, and the lenses of cameras with sensors
    found["eq_data"] = [x.item() for x in np.ravel(model.eq_data[:, :11])]
    found["mat_texid"] = [x.item() for x in model.mat_texid[:, int(mujoco.mjtTextureRole.mjTEXROLE_RGB)]]
    found["cam_intrinsic"] = [x.item() for x in np.ravel(model.cam_intrinsic * (model.cam_sensorsize[:, :1] > 0))]
    return found


def record():
    """Print the fields of the plain model, and those that each row changes."""
    import mujoco

    read = mujoco.MjModel.from_xml_string
    plain = fields(read(model()))
    rows = []
    for place, texts in ROWS.items():
        for text in texts:
            new = fields(read(model(place, text)))
            rows.append({name: value for name, value in new.items() if value != plain[name]})
    print(json.dumps([mujoco.__version__, plain, rows]))


def compare():
    """Write the fields that all of the Pythons record."""
    versions, before, first = {}, None, {}
    for python in sys.argv[1:]:
        said = subprocess.run([python, __file__], stdout=subprocess.PIPE, check=True).stdout
        version, plain, rows = json.loads(said)
        # what is as in the version before is left out: a row is null
        kept = [None if before and row == old else row for row, old in zip(rows, before or rows)]
        changed = {name: value for name, value in plain.items() if value != first.get(name)}
        versions[version], before, first = {"plain": changed, "rows": kept}, rows, plain
    rows = [[place, text] for place, texts in ROWS.items() for text in texts]
    out = {"base": BASE, "rows": rows, "versions": versions}
    Path(__file__).with_suffix(".json").write_text(json.dumps(out, separators=(",", ":")))


if __name__ == "__main__":
    record() if len(sys.argv) == 1 else compare()
