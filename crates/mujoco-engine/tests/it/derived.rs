//! Each array that worlds give is that of a world that steps alone, and data that takes over such a step has all arrays
//! once it is resumed.

use std::sync::Arc;

use fearless_simd::Level;
use mujoco_engine::lanes::{Derived, Group, Stride, Worlds};
use mujoco_engine::physics::{rne_post_constraint, step1};
use mujoco_engine::{Data, Model, step};

use super::states::unlike;
use super::worlds::{BALL, HOPPER};

const LEN: usize = 21;

/// Each kind of array, as the field of data that it is.
type Kind = (Derived, fn(&Data) -> &[f64]);

const KINDS: [Kind; 12] = [
    (Derived::Xpos, |d| d.xpos.as_flattened()),
    (Derived::Xquat, |d| d.xquat.as_flattened()),
    (Derived::Xmat, |d| d.xmat.as_flattened()),
    (Derived::Xipos, |d| d.xipos.as_flattened()),
    (Derived::GeomXpos, |d| d.geom_xpos.as_flattened()),
    (Derived::GeomXmat, |d| d.geom_xmat.as_flattened()),
    (Derived::SiteXpos, |d| d.site_xpos.as_flattened()),
    (Derived::Cinert, |d| d.cinert.as_flattened()),
    (Derived::Cvel, |d| d.cvel.as_flattened()),
    (Derived::QfrcActuator, |d| &d.qfrc_actuator),
    (Derived::QfrcConstraint, |d| &d.qfrc_constraint),
    (Derived::CfrcExt, |d| d.cfrc_ext.as_flattened()),
];

/// A model, with a site that is turned on its last body.
fn model(text: &str) -> Arc<Model> {
    let site = r#"<site pos=".1 .2 .3" euler="10 20 30"/></body>"#;
    let text = text.replacen("</body>", site, 1);
    Arc::new(Model::from_xml(&text).unwrap())
}

/// The velocities and the controls of a world.
fn start(m: &Model, world: usize, d: &mut Data) {
    for (i, x) in d.qvel.iter_mut().chain(&mut d.ctrl).enumerate() {
        *x = (1.0 + (3 * i + 7 * world) as f64).sin();
    }
    d.time = world as f64;
    assert_eq!(d.qpos, m.qpos0);
}

#[test]
fn each_array_of_worlds_is_that_of_a_world_alone() {
    for text in [HOPPER, BALL] {
        let model = model(text);
        let m = &*model;
        let alone: Vec<Data> = (0..LEN)
            .map(|world| {
                let mut d = Data::new(m);
                start(m, world, &mut d);
                (0..60).for_each(|_| step(m, &mut d));
                rne_post_constraint(m, &mut d);
                d
            })
            .collect();
        let all = KINDS.map(|(kind, _)| kind);
        for reads in KINDS
            .map(|(kind, _)| vec![kind])
            .into_iter()
            .chain([all.to_vec()])
        {
            let mut worlds = Worlds::new(&model, LEN, &reads);
            for world in 0..LEN {
                let mut d = Data::new(m);
                start(m, world, &mut d);
                worlds.qvel[world * m.nv()..][..m.nv()].copy_from_slice(&d.qvel);
                worlds.ctrl[world * m.nu()..][..m.nu()].copy_from_slice(&d.ctrl);
                worlds.time[world] = d.time;
            }
            worlds.step(60);
            for (kind, of_data) in KINDS {
                let found = worlds.array(kind);
                assert_eq!(found.is_some(), reads.contains(&kind), "{kind:?}");
                let Some(found) = found else { continue };
                for (world, d) in alone.iter().enumerate() {
                    let expected = of_data(d);
                    let own = &found[world * expected.len()..][..expected.len()];
                    assert_eq!(own, expected, "{kind:?} of world {world}");
                    assert_eq!(worlds.time[world], d.time);
                }
            }
        }
    }
}

#[test]
fn data_that_took_over_a_step_has_all_arrays_once_it_is_resumed() {
    let model = model(HOPPER);
    let m = &*model;
    // a step that settles ends with the frames of the new state
    for (settles, kinds) in [(false, KINDS.len()), (true, 7)] {
        let stride = Stride {
            steps: 5,
            settles,
            contact_forces: !settles,
            reads: KINDS[..kinds].iter().map(|(kind, _)| *kind).collect(),
        };
        let mut group = Group::new(&model, &stride, Level::new(), LEN);
        let mut together: Vec<Data> = (0..LEN).map(|_| Data::new(m)).collect();
        for (world, d) in together.iter_mut().enumerate() {
            start(m, world, d);
        }
        let mut alone = together.clone();
        for _ in 0..20 {
            group.clear();
            for d in &mut together {
                let added = group.add(m, d, d.ctrl.iter().copied());
                assert_eq!(added.is_some(), Group::can_step(Level::new()));
            }
            group.step();
            for (world, (d, alone)) in together.iter_mut().zip(&mut alone).enumerate() {
                (0..stride.steps).for_each(|_| step(m, alone));
                if stride.contact_forces {
                    rne_post_constraint(m, alone);
                }
                if settles {
                    step1(m, alone);
                }
                if world < group.len() {
                    group.collect(world, d);
                }
                if !d.catch_up(m, &stride) {
                    d.clone_from(alone);
                    continue;
                }
                assert!(d.has_stale_arrays() && d.is_stepped() != settles);
                for (kind, of_data) in &KINDS[..kinds] {
                    assert_eq!(of_data(d), of_data(alone), "{kind:?} of world {world}");
                }
                let mut whole = d.clone();
                whole.resume(m);
                assert!(!whole.has_stale_arrays());
                assert_eq!(
                    unlike(m, &whole, alone),
                    [""; 0],
                    "world {world}, {settles}"
                );
                let text = serde_json::to_string(d).unwrap();
                let mut read: Data = serde_json::from_str(&text).unwrap();
                read.resume(m);
                assert_eq!(read.qpos, alone.qpos);
            }
        }
    }
}
