//! Bodies that rest fall asleep, and models in which MuJoCo keeps every body awake.

use mujoco_engine::{Data, Model, Revision, step};

fn model(body: &str, flag: &str) -> Result<Model, String> {
    let text = format!(
        "<mujoco>\n<option><flag sleep=\"{flag}\"/></option>\n<worldbody>\n\
         <body name=\"arm\"><joint name=\"j\"/><geom size=\".1\" pos=\".2 0 0\"/></body>\n{body}\n</worldbody>\n\
         <actuator><motor joint=\"j\"/></actuator></mujoco>"
    );
    Model::from_xml(&text).map_err(|error| error.to_string())
}

fn ball(attributes: &str) -> String {
    format!("<body name=\"ball\" {attributes}><freejoint/><geom size=\".1\"/></body>")
}

/// A box that comes to rest, a ball that falls on it later, and a box far away.
const FALL: &str = r#"<mujoco><option><flag sleep="enable"/></option><worldbody><geom type="plane" size="5 5 1"/>
    <body name="low" pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1"/><site name="s"/></body>
    <body name="high" pos="0 0 2"><freejoint/><geom size=".05"/></body>
    <body name="far" pos="2 0 .1"><freejoint/><geom type="box" size=".1 .1 .1"/></body></worldbody>
    <sensor><accelerometer site="s"/><framelinvel objtype="body" objname="high"/></sensor></mujoco>"#;

fn fall(revision: Revision, steps: usize) -> (Model, Data) {
    let m = Model::from_xml_with(FALL, revision).unwrap();
    let mut d = Data::new(&m);
    for _ in 0..steps {
        step(&m, &mut d);
    }
    (m, d)
}

#[test]
fn a_model_that_never_sleeps_is_the_one_without_the_flag() {
    let awake = ball("sleep=\"never\"");
    assert_eq!(
        *model(&awake, "enable").unwrap(),
        *model(&awake, "disable").unwrap()
    );
    model("", "enable").unwrap();
    model(&ball("sleep=\"init\""), "disable").unwrap();
    let d = Data::new(&model(&awake, "enable").unwrap());
    assert!(d.tree_asleep.is_empty());
}

#[test]
fn what_rests_falls_asleep_and_a_touch_wakes_it() {
    for revision in Revision::ALL {
        let (m, mut d) = fall(revision, 200);
        let [low, high, far] = [0, 1, 2].map(|tree| d.tree_asleep[tree]);
        assert_eq!((low, far), (0, 2), "{revision}: each sleeps alone");
        assert!(high < 0, "{revision}: the ball falls");
        let (place, felt) = (d.qpos[..7].to_vec(), d.sensordata[..3].to_vec());
        assert_eq!(d.qvel[..6], [0.0; 6], "{revision}");
        assert!(d.qvel[8] < -1.0, "{revision}");
        step(&m, &mut d);
        assert_eq!(d.qpos[..7], place, "{revision}");
        assert_eq!(d.sensordata[..3], felt, "{revision}: a sensor rests too");
        while d.contact.iter().all(|contact| contact.geom != [2, 1]) && d.time < 1.0 {
            step(&m, &mut d);
        }
        assert!(d.time < 1.0, "{revision}: the ball meets the box");
        assert!(d.tree_asleep[0] < 0 && d.tree_asleep[2] == 2, "{revision}");
    }
}

#[test]
fn a_push_a_move_and_a_velocity_wake() {
    let disturb: [fn(&mut Data); 4] = [
        |d| d.xfrc_applied[3][2] = 1e-6,
        |d| d.qfrc_applied[12] = 1e-6,
        |d| d.qvel[14] = 1e-6,
        |d| d.qpos[14] += 1e-6,
    ];
    for disturb in disturb {
        let (m, mut d) = fall(Revision::default(), 200);
        assert_eq!(d.tree_asleep[2], 2);
        disturb(&mut d);
        step(&m, &mut d);
        assert!(d.tree_asleep[2] < 0);
        assert_eq!(d.tree_asleep[0], 0, "the other box sleeps on");
    }
}

#[test]
fn data_that_sleeps_goes_on_from_a_snapshot() {
    let (m, mut d) = fall(Revision::default(), 200);
    let text = serde_json::to_string(&d).unwrap();
    let mut read: Data = serde_json::from_str(&text).unwrap();
    read.check(&m).unwrap();
    read.resume(&m);
    assert_eq!(read.sensordata, d.sensordata);
    assert_eq!(read.xpos, d.xpos);
    for number in 0..300 {
        step(&m, &mut d);
        step(&m, &mut read);
        assert_eq!(d.qpos, read.qpos, "step {number}");
        assert_eq!(d.tree_asleep, read.tree_asleep, "step {number}");
        assert_eq!(d.sensordata, read.sensordata, "step {number}");
    }
}

#[test]
fn a_snapshot_with_trees_that_sleep_in_no_cycle_is_refused() {
    let (m, d) = fall(Revision::default(), 200);
    let text = serde_json::to_value(&d).unwrap();
    for asleep in [
        vec![1, -11, 2],
        vec![2, -11, 2],
        vec![0, -12, 2],
        vec![3, 0, 2],
        vec![0, -11],
    ] {
        let mut text = text.clone();
        text["state"]["tree_asleep"] = serde_json::json!(asleep);
        let read: Data = serde_json::from_value(text).unwrap();
        let error = read.check(&m).unwrap_err().to_string();
        assert!(error.contains("tree_asleep"), "{asleep:?}: {error}");
    }
}

#[test]
fn trees_sleep_from_the_start_if_they_rest() {
    let resting = r#"<body sleep="init" pos="3 0 0"><joint type="slide"/><geom size=".1"/></body>"#;
    let m = model(resting, "enable").unwrap();
    let d = Data::new(&m);
    assert_eq!(d.tree_asleep, [-11, 1]);
    // the balls touch, and one of them may not sleep; from 3.17 on both are awake
    let text = format!(
        "<mujoco><option><flag sleep=\"enable\"/></option><worldbody>{}\
         <body pos=\".15 0 0\" sleep=\"never\"><freejoint/><geom size=\".1\"/></body></worldbody></mujoco>",
        ball("sleep=\"init\"")
    );
    for revision in Revision::ALL {
        match Model::from_xml_with(&text, revision) {
            Ok(m) => {
                assert!(revision >= Revision::V3_17);
                assert_eq!(Data::new(&m).tree_asleep, [-11, -11]);
            }
            Err(error) => {
                let error = error.to_string();
                assert_eq!(revision, Revision::V3_12, "{error}");
                assert!(
                    error.contains("<flag> attribute \"sleep\": body \"ball\" cannot sleep"),
                    "{error}"
                );
            }
        }
    }
}

#[test]
fn what_cannot_sleep_is_refused() {
    let error = model(
        r#"<body><joint/><geom size=".1"/><body sleep="allowed"><joint/><geom size=".1"/></body></body>"#,
        "enable",
    );
    let error = error.unwrap_err();
    assert!(
        error.starts_with("line 5: <body> attribute \"sleep\""),
        "{error}"
    );
    for (option, rest, said) in [
        ("integrator=\"RK4\"", "", "integrator RK4"),
        (
            "",
            r#"<tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon><equality><tendon tendon1="t"/></equality>"#,
            "constraints of tendons",
        ),
        (
            "",
            r#"<actuator><intvelocity joint="j" actrange="-1 1"/></actuator>"#,
            "an activation",
        ),
        (
            "",
            r#"<tendon><fixed stiffness="1"><joint joint="j" coef="1"/><joint joint="k" coef="1"/></fixed></tendon>"#,
            "a tendon",
        ),
    ] {
        let text = format!(
            "<mujoco><option {option}><flag sleep=\"enable\"/></option><worldbody>\
             <body sleep=\"allowed\"><joint name=\"j\"/><geom size=\".1\" pos=\"1 0 0\"/></body>\
             <body><joint name=\"k\"/><geom size=\".1\" pos=\"-1 0 0\"/></body></worldbody>{rest}</mujoco>"
        );
        let error = Model::from_xml(&text).unwrap_err().to_string();
        assert!(error.contains("sleep") && error.contains(said), "{error}");
    }
}

#[test]
fn a_change_cannot_turn_sleep_on_without_its_arrays() {
    let mut m = model(&ball(""), "disable").unwrap();
    let error = m.change(|c| c.opt.enableflags |= 1 << 4).unwrap_err();
    assert!(error.to_string().contains("tree_sleep_policy"), "{error}");
    let mut m = model(&ball(""), "enable").unwrap();
    assert_eq!(m.tree_sleep_policy, [1, 2]);
    let error = m.change(|c| c.tree_sleep_policy[1] = 6).unwrap_err();
    assert!(
        error.to_string().contains("tree_sleep_policy[1]"),
        "{error}"
    );
    m.change(|c| c.opt.enableflags = 0).unwrap();
    assert!(Data::new(&m).tree_asleep.is_empty());
}
