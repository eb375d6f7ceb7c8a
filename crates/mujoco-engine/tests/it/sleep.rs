//! The flag `sleep` in models in which MuJoCo keeps every body awake, and in others.

use mujoco_engine::Model;

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

#[test]
fn a_model_that_never_sleeps_is_the_one_without_the_flag() {
    let awake = ball("sleep=\"never\"");
    assert_eq!(
        *model(&awake, "enable").unwrap(),
        *model(&awake, "disable").unwrap()
    );
    model("", "enable").unwrap();
    model(&ball("sleep=\"init\""), "disable").unwrap();
}

#[test]
fn a_model_that_may_sleep_is_refused_with_the_body() {
    let error = model(&ball(""), "enable").unwrap_err();
    assert!(
        error.starts_with("line 2: <flag> attribute \"sleep\": body \"ball\" may fall asleep"),
        "{error}"
    );
    let error = model(&ball("sleep=\"allowed\""), "enable").unwrap_err();
    assert!(
        error.starts_with("line 5: <body> attribute \"sleep\""),
        "{error}"
    );
}
