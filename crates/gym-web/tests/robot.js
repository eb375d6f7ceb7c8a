// Tests of the page of the reader's own robots. `tools` are those of test.js.

const CUBE = `${[0, 1, 2, 3, 4, 5, 6, 7].map((i) => `v ${i & 1} ${(i >> 1) & 1} ${(i >> 2) & 1}`).join("\n")}
f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n`;

const ARM = `<mujoco>
  <compiler meshdir="assets"/>
  <asset><mesh name="cube" file="cube.obj" scale=".2 .2 .2"/></asset>
  <worldbody>
    <body name="upper" pos="0 0 1">
      <joint name="shoulder" axis="0 1 0" damping=".2"/>
      <geom type="capsule" fromto="0 0 0 .6 0 0" size=".04" rgba=".2 .4 .9 1"/>
      <body name="hand" pos=".6 0 0"><joint name="wrist" axis="0 1 0" damping=".05"/><geom type="mesh" mesh="cube" rgba=".9 .5 .1 1"/></body>
    </body>
    <body name="ball" pos="-.5 0 .1"><freejoint/><geom size=".1"/></body>
  </worldbody>
  <actuator>
    <position name="lift" joint="shoulder" kp="80" kv="8" ctrlrange="-1.5 1.5"/>
    <motor name="turn" joint="wrist"/>
  </actuator>
  <sensor><jointpos name="angle" joint="shoulder"/><framepos name="place of the hand" objtype="body" objname="hand"/><clock/></sensor>
  <keyframe><key name="up" qpos="-1 0 -.5 0 .1 1 0 0 0" ctrl="-1 .5"/><key name="down" qpos="1 0 -.5 0 .1 1 0 0 0"/></keyframe>
</mujoco>`;
const SCENE = `<mujoco model="arm in a room">
  <include file="arm.xml"/>
  <worldbody><geom type="plane" size="3 3 .1"/><camera name="above" pos="0 0 4"/></worldbody>
</mujoco>`;
const FILES = { "arm/scene.xml": SCENE, "arm/arm.xml": ARM, "arm/assets/cube.obj": CUBE, "arm/README.md": "# Arm\n", "arm/.git/config": "" };

const GIGABYTE = 2 ** 30;
const encoded = (content) => (typeof content === "string" ? new TextEncoder().encode(content) : content);

// The roots of a drop: folders and files as the browser gives them.
function roots(files) {
  const top = new Map();
  for (const [path, content] of Object.entries(files)) {
    const names = path.split("/");
    let folder = top;
    names.slice(0, -1).forEach((name) => {
      if (!folder.has(name)) folder.set(name, new Map());
      folder = folder.get(name);
    });
    folder.set(names.at(-1), content);
  }
  const entry = (name, content, path) => (content instanceof Map
    ? { isDirectory: true, fullPath: path, createReader: () => reader([...content].map(([name, inner]) => entry(name, inner, `${path}/${name}`))) }
    : { isDirectory: false, fullPath: path, file: (done) => done(content?.size === undefined ? new File([content], name) : content) });
  const reader = (entries) => ({ readEntries: (done) => done(entries.splice(0, 100)) });
  return [...top].map(([name, content]) => entry(name, content, `/${name}`));
}

// A ZIP archive. `claims` replaces what its list says about files by name.
async function zip(files, claims = {}) {
  const [parts, list] = [[], []];
  let offset = 0;
  const words = (...pairs) => {
    const bytes = new DataView(new ArrayBuffer(pairs.reduce((sum, [size]) => sum + size, 0)));
    let at = 0;
    for (const [size, value] of pairs) {
      if (size === 2) bytes.setUint16(at, value, true);
      else bytes.setUint32(at, value, true);
      at += size;
    }
    return new Uint8Array(bytes.buffer);
  };
  for (const [path, content] of Object.entries(files)) {
    const [name, raw] = [encoded(path), encoded(content)];
    const method = raw.length > 40 ? 8 : 0;
    const packed = method ? new Uint8Array(await new Response(new Blob([raw]).stream().pipeThrough(new CompressionStream("deflate-raw"))).arrayBuffer()) : raw;
    const about = { method, flags: 0, packed: packed.length, unpacked: raw.length, ...claims[path] };
    const common = [[2, 20], [2, about.flags], [2, about.method], [4, 0], [4, 0], [4, about.packed], [4, about.unpacked], [2, name.length], [2, 0]];
    const head = words([4, 0x04034b50], ...common);
    list.push(words([4, 0x02014b50], [2, 20], ...common, [2, 0], [2, 0], [2, 0], [4, 0], [4, offset]), name);
    parts.push(head, name, packed);
    offset += head.length + name.length + packed.length;
  }
  const count = Object.keys(files).length;
  const size = list.reduce((sum, part) => sum + part.length, 0);
  return new File([...parts, ...list, words([4, 0x06054b50], [2, 0], [2, 0], [2, count], [2, count], [4, size], [4, offset], [2, 0])], "robot.zip");
}

export async function robotTests({ test, open, find, text, until, button, check, colours, shown, sleep, frame, complaints, rate }) {
  const all = (selector) => [...frame.contentDocument.querySelectorAll(selector)];
  const drop = (entries) => {
    const event = new frame.contentWindow.DragEvent("drop", { bubbles: true, cancelable: true });
    const items = entries.map((entry) => ({ kind: "file", webkitGetAsEntry: () => (entry instanceof File ? null : entry), getAsFile: () => new frame.contentWindow.File([entry], entry.name) }));
    Object.defineProperty(event, "dataTransfer", { value: { types: ["Files"], items } });
    frame.contentDocument.body.dispatchEvent(event);
  };
  const begin = () => open("#/robot", ".robot-drop");
  const picture = () => shown(find(".robot-stage canvas"));
  const time = () => Number.parseFloat(text(".robot-clock"));
  const opened = async () => {
    await until(() => find(".robot-stage canvas") && time() >= 0 && colours(picture()) > 5, "the picture of the robot");
  };
  const failed = () => text("[role=alert]");
  const slider = (name) => find(`input[type=range][aria-label="${name}"]`);
  const slide = (name, value) => {
    slider(name).value = String(value);
    slider(name).dispatchEvent(new Event("input", { bubbles: true }));
  };
  const select = (label, value) => {
    const menu = find(`select[aria-label="${label}"]`);
    menu.value = value;
    menu.dispatchEvent(new Event("change"));
  };
  const key = (key, more = {}) => frame.contentDocument.body.dispatchEvent(new frame.contentWindow.KeyboardEvent("keydown", { key, bubbles: true, cancelable: true, ...more }));
  const differ = (a, b) => a.length !== b.length || a.some((byte, i) => byte !== b[i]);
  // the picture, when it has stopped changing
  const still = async () => {
    for (let before = picture(); ; before = picture()) {
      await sleep(150);
      if (!differ(before, picture())) return before;
    }
  };
  const changed = async (before, what) => until(() => differ(before, picture()), `another picture after ${what}`);
  const pointer = (type, [x, y], more = {}) => {
    const box = find(".robot-stage canvas").getBoundingClientRect();
    const event = new frame.contentWindow.PointerEvent(type, { pointerId: 7, bubbles: true, cancelable: true, clientX: box.left + x * box.width, clientY: box.top + y * box.height, ...more });
    find(".robot-stage canvas").dispatchEvent(event);
  };

  await test("a dropped folder with a mesh is read, drawn and stepped", async () => {
    await begin();
    frame.contentWindow.HTMLCanvasElement.prototype.setPointerCapture = () => {}; // no pointer is real here
    drop(roots(FILES));
    await opened();
    check(text("h1") === "arm in a room", text("h1"));
    check(/1 of meshes/.test(text(".play-side")), text(".play-side"));
    const before = picture();
    await until(() => time() > 0.3, "time to pass");
    await changed(before, "a while");
  });

  await test("each control of a robot does what it says", async () => {
    button("Pause").click();
    await still();
    const at = time();
    await sleep(200);
    check(time() === at, "time passes while it is paused");
    for (let i = 0; i < 10; i++) {
      button("One step").click();
      await sleep(20);
    }
    await until(() => Math.abs(time() - at - 0.02) < 0.011, `ten steps from ${at}, now ${time()}`);
    select("Keyframe", "up");
    await until(() => slider("lift").value === "-1", "the control of the keyframe");
    let before = await still();
    check(time() === 0, `it is ${time()} s`);
    select("Keyframe", "down");
    await changed(before, "another keyframe");
    before = await still();
    for (const [what, act] of [["a turn", () => key("ArrowLeft")], ["a move", () => key("ArrowUp", { shiftKey: true })], ["coming nearer", () => key("+")], ["a camera", () => select("Camera", "0")], ["the free camera", () => key("v")]]) {
      act();
      await changed(before, what);
      before = await still();
    }
    for (const [what, more] of [["a turn by the mouse", { buttons: 1 }], ["a move by the mouse", { buttons: 2 }]]) {
      pointer("pointerdown", [0.1, 0.1], more);
      pointer("pointermove", [0.2, 0.15], more);
      pointer("pointerup", [0.2, 0.15]);
      await changed(before, what);
      before = await still();
    }
    pointer("pointerdown", [0.4, 0.1], { pointerId: 1 });
    pointer("pointerdown", [0.6, 0.1], { pointerId: 2 });
    pointer("pointermove", [0.8, 0.2], { pointerId: 2 });
    for (const pointerId of [1, 2]) pointer("pointerup", [0.8, 0.2], { pointerId });
    await changed(before, "two fingers");
    before = await still();
    button("Contacts").click();
    await until(() => /^Contacts: \d+$/.test(all(".toggle")[0].textContent), "a number of contacts");
    key("c");
    await until(() => all(".toggle")[0].textContent === "Contacts", "no contacts");
    button("Play").click();
    const speeds = [];
    for (const speed of ["0.1", "4"]) {
      select("Speed", speed);
      await sleep(200);
      const [start, from] = [performance.now(), time()];
      await sleep(900);
      speeds.push((time() - from) / ((performance.now() - start) / 1000));
    }
    check(speeds[0] < 0.2 && speeds[1] > 4 * speeds[0], `the speeds are ${speeds}`);
    key("[");
    check(find("select[aria-label=Speed]").value === "2", "[ does not slow down");
    slide("lift", 1);
    await until(() => /^[01]\.?9?\d*/.test(text(".robot-sensor .bar-value")) && Number(text(".robot-sensor .bar-value")) > 0.8, "the sensor of the slider's joint");
    check(colours(shown(find(".robot-chart"))) > 3, "no line is drawn");
    slide("lift", -1);
    await until(() => Number(text(".robot-sensor .bar-value").replace("−", "-")) < -0.7, "the joint to follow the slider");
    slider("lift").dispatchEvent(new Event("dblclick"));
    await until(() => slider("lift").value === "0", "the slider's start");
    select("Add a sensor", "2");
    check(all(".robot-sensor").length === 3, "no sensor was added");
    key("?");
    check(find("dialog").open && /pull a body/.test(text("dialog")), "there is no list of keys");
    find("dialog button").click();
    key("r");
    await until(() => time() < 0.5, "a restart");
    key(" ");
    await until(() => button("Play"), "a pause by the space bar");
    return `${speeds[1].toFixed(1)} times real time at 4×`;
  });

  await test("a body is named by a click and pulled by dragging", async () => {
    await begin();
    frame.contentWindow.HTMLCanvasElement.prototype.setPointerCapture = () => {};
    const one = `<mujoco><option gravity="0 0 0"/><worldbody><body name="globe"><joint type="slide" axis="0 0 1"/><geom size=".5"/></body></worldbody>
      <sensor><framepos name="place" objtype="body" objname="globe"/></sensor></mujoco>`;
    drop(roots({ "one.xml": one }));
    await opened();
    pointer("pointerdown", [0.5, 0.5]);
    pointer("pointerup", [0.5, 0.5]);
    await until(() => text(".badge") === "globe", "the body's name");
    const height = () => Number(/z ([−\d.]+)/.exec(text(".robot-sensor .bar-value"))?.[1].replace("−", "-"));
    await until(() => Number.isFinite(height()), "the sensor");
    pointer("pointerdown", [0.5, 0.5], { ctrlKey: true });
    await sleep(200);
    pointer("pointermove", [0.5, 0.2], { ctrlKey: true });
    await until(() => height() > 0.2, `a height above 0.2, now ${text(".bar-value")}`);
    pointer("pointerup", [0.5, 0.2]);
    // by touch: a button takes the place of the key
    button("Pull").click();
    const before = height();
    pointer("pointerdown", [0.5, 0.45], { pointerType: "touch" });
    await sleep(200);
    pointer("pointermove", [0.5, 0.95], { pointerType: "touch" });
    await until(() => height() < before - 0.2, "a pull down");
    pointer("pointerup", [0.5, 0.95]);
  });

  await test("a dropped archive is read, and the reader chooses among its models", async () => {
    await begin();
    drop([await zip({ ...FILES, "arm/other.xml": ARM.replace("<mujoco>", '<mujoco model="arm alone">') })]);
    await until(() => all(".robot-models button").length === 2, "a choice of two models");
    check(all(".robot-models button")[0].textContent === "arm/scene.xml", all(".robot-models button")[0].textContent);
    all(".robot-models button")[1].click();
    await opened();
    check(text("h1") === "arm alone", text("h1"));
    select("Model", "arm/scene.xml");
    await until(() => text("h1") === "arm in a room", "the other model");
    await opened();
  });

  await test("the robot to start with stands by its sliders", async () => {
    await begin();
    find("#robot-sample").click();
    await opened();
    const height = () => Number(/z ([−\d.]+)/.exec(text(".robot-sensor .bar-value"))?.[1].replace("−", "-"));
    await until(() => height() < 0.15, "the table on the ground");
    for (const end of ["front", "back"]) slide(`${end} hips`, 1);
    for (const end of ["front", "back"]) slide(`${end} knees`, 2);
    await until(() => height() > 0.33, `a table that stands, now ${height()}`);
    await sleep(1500);
    check(height() > 0.33, `it fell to ${height()}`);
    return `its middle is ${height()} m high`;
  });

  await test("it stands too if a person moves one slider after the other, as far as it goes", async () => {
    button("Restart").click();
    const height = () => Number(/z ([−\d.]+)/.exec(text(".robot-sensor .bar-value"))?.[1].replace("−", "-"));
    await until(() => height() < 0.15, "the table on the ground");
    for (const { ariaLabel, max } of all(".robot-slider input")) {
      slide(ariaLabel, max);
      const since = time();
      await until(() => time() > since + 1, "a second");
    }
    await until(() => height() > 0.36, `a table that stands, now ${height()}`);
    await sleep(1500);
    check(height() > 0.36, `it fell to ${height()}`);
  });

  // Each is an error in words, soon, after which the page goes on.
  const refusals = [
    ["a mesh of 1 GB", () => drop(roots({ "a.xml": ARM, "assets/cube.obj": { size: GIGABYTE, name: "cube.obj" } })), /assets\/cube\.obj has 1024 MB; the limit is 64 MB/],
    ["a folder of 10,000 files", () => drop(roots(Object.fromEntries(Array.from({ length: 10_000 }, (_, i) => [`many/${i % 7}/${i}.obj`, ""])))), /more than 1000 files/],
    ["10,000 chosen files", () => {
      const list = { length: 10_000, item: () => null };
      Object.defineProperty(find("#robot-folder"), "files", { value: list });
      find("#robot-folder").dispatchEvent(new Event("change"));
    }, /more than 1000 files/],
    ["an archive that says it holds 1 GB", async () => drop([await zip({ ...FILES, "big.obj": "x".repeat(100) }, { "big.obj": { unpacked: GIGABYTE } })]), /big\.obj has 1024 MB; the limit is 64 MB/],
    ["an archive of many large files", async () => drop([await zip(Object.fromEntries(Array.from({ length: 20 }, (_, i) => [`${i}.obj`, "x".repeat(100)])), Object.fromEntries(Array.from({ length: 20 }, (_, i) => [`${i}.obj`, { unpacked: 50 << 20 }])))]), /has 1000 MB of files; the limit is 256 MB/],
    ["an archive that holds more than it says", async () => drop([await zip({ ...FILES, "bomb.obj": new Uint8Array(80 << 20) }, { "bomb.obj": { unpacked: 1000 } })]), /bomb\.obj has more than the 1000 bytes/],
    ["an archive that holds less than it says", async () => drop([await zip({ ...FILES, "less.obj": "y".repeat(99) }, { "less.obj": { unpacked: 1000 } })]), /less\.obj has 99 bytes, not the 1000/],
    ["an archive of 10,000 entries", async () => drop([await zip(Object.fromEntries(Array.from({ length: 10_000 }, (_, i) => [`${i}.obj`, ""])))]), /has 10000 entries; the limit is 4000/],
    ["an encrypted archive", async () => drop([await zip(FILES, { "arm/arm.xml": { flags: 1 } })]), /arm\/arm\.xml in robot\.zip is encrypted/],
    ["a file that is no archive", () => drop([new File(["hello"], "robot.zip")]), /is no ZIP archive/],
    ["a cycle of includes", () => drop(roots({ "c/a.xml": '<mujoco>\n<include file="b.xml"/></mujoco>', "c/b.xml": '<mujoco>\n\n<include file="a.xml"/></mujoco>' })), /c\/b\.xml: line 3: <include> attribute "file": c\/a\.xml is included already|c\/a\.xml: line 2: .*included already/],
    ["a mesh that is missing", () => drop(roots({ "arm/arm.xml": ARM })), /arm\/arm\.xml: line 3: <mesh> attribute "file": there is no file arm\/assets\/cube\.obj/],
    ["a damaged mesh", () => drop(roots({ ...FILES, "arm/assets/cube.obj": "v 1 2\n" })), /arm\/arm\.xml.*line 3.*cube\.obj/],
    ["what the engine lacks", () => drop(roots({ "a.xml": '<mujoco>\n<worldbody>\n<flexcomp name="x"/>\n</worldbody></mujoco>' })), /a\.xml: line 3: <flexcomp>/],
    ["no model", () => drop(roots({ "x/readme.md": "", "x/mesh.obj": CUBE })), /no model among 2 files/],
  ];
  for (const [name, act, words] of refusals) {
    await test(`${name}: an error, and the page goes on`, async () => {
      await begin();
      await act();
      const start = performance.now();
      await until(() => failed(), "an error");
      const took = performance.now() - start;
      check(words.test(failed()), failed());
      check(took < 1000, `after ${Math.round(took)} ms`);
      drop(roots(FILES));
      await opened();
      return `after ${Math.round(took)} ms`;
    });
  }

  await test("what takes long can be stopped", async () => {
    await begin();
    drop([{ isDirectory: true, fullPath: "/slow", createReader: () => ({ readEntries: () => {} }) }]);
    await until(() => /One moment/.test(text("h1")), "the wait");
    button("Stop").click();
    check(find(".robot-drop"), "it did not stop");
    drop(roots(FILES));
    await opened();
  });

  await test("a state that flies apart is told, and reset", async () => {
    await begin();
    drop(roots({ "wild.xml": '<mujoco><worldbody><body><joint name="j"/><geom size=".1" pos=".3 0 0"/></body></worldbody><actuator><motor name="wild" joint="j" gear="1e13" ctrlrange="-1 1"/></actuator></mujoco>' }));
    await opened();
    await until(() => time() > 0.1, "time to pass");
    slide("wild", 1);
    await until(() => /diverged at .* was reset/.test(text(".message")), "the message");
    const at = time();
    await until(() => time() !== at, "time to go on");
  });

  await test("the page of a robot fits screens of 1280 and 400 pixels", async () => {
    const { width } = frame;
    for (const wide of [1280, 400]) {
      frame.width = wide;
      await begin();
      const fits = (where) => {
        const { clientWidth, scrollWidth } = frame.contentDocument.documentElement;
        check(scrollWidth <= clientWidth, `${where} is ${scrollWidth} pixels wide, of ${clientWidth}`);
        const cut = all("button, select, .robot-slider span").find((element) => element.getBoundingClientRect().right > clientWidth + 1);
        check(!cut, `${where}: “${cut?.textContent}” is cut`);
      };
      fits("where robots are dropped");
      find("#robot-sample").click();
      await opened();
      fits("the robot");
      key("?");
      fits("the list of keys");
      find("dialog button").click();
    }
    frame.width = width;
  });

  await test("on a phone the picture stays in sight while the last slider moves", async () => {
    const [width, height] = [frame.width, frame.height];
    [frame.width, frame.height] = [400, 700];
    await begin();
    find("#robot-sample").click();
    await opened();
    const last = all(".robot-slider").at(-1);
    last.scrollIntoView({ block: "end" });
    await sleep(100);
    const [stage, row] = [find(".robot-stage"), last].map((element) => element.getBoundingClientRect());
    check(stage.top >= 0 && stage.height > 150 && stage.bottom <= row.top && row.bottom <= 701, `the picture from ${stage.top} to ${stage.bottom}, the slider from ${row.top} to ${row.bottom}`);
    const { min, max } = last.querySelector("input");
    check(/\d/.test(last.querySelector(".robot-range").textContent) && Number(min) < Number(max), "the slider's range is not told");
    [frame.width, frame.height] = [width, height];
  });

  await test("nothing of a robot leaves the page, and the page says so", async () => {
    await begin();
    check(/read, simulated and drawn on this machine. Nothing is sent/.test(text(".robot-drop")), text(".robot-drop"));
    check(/At most 1000 files, 64 MB each and 256 MB together/.test(text(".robot-drop")), "the limits are not told");
    check(complaints.length === 0, complaints.join("; "));
  });

  await test("Humanoid is drawn at 640x480 while it moves", async () => {
    const response = await fetch("/models/humanoid.xml");
    if (!response.ok) return "(its model is not served)";
    const model = await response.text();
    await begin();
    drop(roots({ "humanoid.xml": model }));
    await opened();
    // by the module alone: how often a browser without display shows them says nothing
    await open("#/robot", ".robot-drop");
    const frames = await rate(model);
    // 20 and more on a core of its own, fewer on a busy machine
    check(frames >= 8, `${frames.toFixed(1)} frames a second`);
    return `${frames.toFixed(1)} frames a second`;
  });
}
