// A robot to start with: a table on four legs. The sliders of its servos let it stand.

const leg = (name, x, y) => `
      <body name="${name}_thigh" pos="${x} ${y} 0">
        <joint name="${name}_hip" axis="0 1 0" range="-20 100"/>
        <geom fromto="0 0 0 .2 0 0" size=".025" rgba=".36 .24 .96 1"/>
        <body name="${name}_shank" pos=".2 0 0">
          <joint name="${name}_knee" axis="0 -1 0" range="-10 170"/>
          <geom fromto="0 0 0 -.2 0 -.03" size=".02" rgba=".65 .58 1 1"/>
          <geom type="sphere" size=".03" pos="-.2 0 -.03" rgba="1 .78 .34 1" friction="1.5"/>
          <site name="${name}_foot" type="sphere" size=".035" pos="-.2 0 -.03" rgba="0 0 0 0"/>
        </body>
      </body>`;
const both = (part, kp, kv) => ["front", "back"].map((end) => `
    <position name="${end} ${part}s" joint="${end}_left_${part}" kp="${kp}" kv="${kv}" ctrlrange="${part === "hip" ? "0 1.2" : "0 2.4"}"/>`).join("");
const same = (end, part) => `
    <joint joint1="${end}_right_${part}" joint2="${end}_left_${part}" solref=".005 1"/>`;

export const SAMPLE = `<mujoco model="table on four legs">
  <compiler angle="degree"/>
  <option timestep=".002" integrator="implicitfast"/>
  <statistic extent=".9" center="0 0 .2"/>
  <default>
    <joint damping=".3" armature=".01"/>
    <geom type="capsule" density="400"/>
  </default>
  <worldbody>
    <geom type="plane" size="0 0 .1" rgba=".9 .89 .87 1" friction="1.5"/>
    <camera name="side" pos="0 -1.6 .35" xyaxes="1 0 0 0 .15 1"/>
    <body name="table" pos="0 0 .07">
      <freejoint name="root"/>
      <geom type="box" size=".24 .13 .03" pos="0 0 .02" density="900" rgba=".98 .96 .93 1"/>
      <site name="middle" pos="0 0 .02" rgba="0 0 0 0"/>${leg("front_left", 0.14, 0.17)}${leg("front_right", 0.14, -0.17)}${leg("back_left", -0.24, 0.17)}${leg("back_right", -0.24, -0.17)}
    </body>
  </worldbody>
  <equality>${["front", "back"].map((end) => same(end, "hip") + same(end, "knee")).join("")}
  </equality>
  <actuator>${both("hip", 60, 60)}${both("knee", 60, 60)}
  </actuator>
  <sensor>
    <framepos name="height of the table" objtype="site" objname="middle"/>
    <gyro name="turning" site="middle"/>
    <touch name="front left foot" site="front_left_foot"/>
  </sensor>
  <keyframe>
    <key name="standing" qpos="0 0 .385 1 0 0 0  1 2  1 2  1 2  1 2" ctrl="1 1 2 2"/>
  </keyframe>
</mujoco>`;
