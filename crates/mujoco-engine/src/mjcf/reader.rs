//! Reads the sections of a model and the tree of its bodies into a [`Spec`].

use std::rc::Rc;

use super::attach::{Parsed, Scope};
use super::bodies::Bodies;
use super::copies::copy_references;
use super::defaults::Classes;
use super::files::Files;
use super::spec::{
    ACTUATORS, Body, EQUALITIES, Exclude, Hfield, Key, Sensor, Spec, Tendon, Texture, replace,
};
use super::xml::Element;
use super::{MOST, MOST_KEYS};
use crate::model::{Cone, Disable, Integrator, Options, SensorType, Solver};
use crate::{Result, Revision};

const SECTIONS: [&str; 15] = [
    "compiler",
    "option",
    "size",
    "visual",
    "statistic",
    "custom",
    "default",
    "asset",
    "worldbody",
    "contact",
    "equality",
    "tendon",
    "actuator",
    "sensor",
    "keyframe",
];

/// The name of a model that has none.
const NAMELESS: &str = "MuJoCo Model";

/// Reads a model. Sections may come in any order and repeat.
pub(crate) fn read(files: &Files<'_>, revision: Revision) -> Result<Spec> {
    Ok(read_model(Element::root(files, 0), revision)?.spec)
}

/// Reads a model, and recurses into those among its assets, whose number is limited.
fn read_model<'a, 'input>(
    mut root: Element<'a, 'input>,
    revision: Revision,
) -> Result<Parsed<'a, 'input>> {
    if root.name() != "mujoco" {
        return Err(root.error("not supported: the outermost element is <mujoco>"));
    }
    let mut reader = Reader {
        spec: Spec {
            name: root.text("model")?.unwrap_or_default(),
            revision,
            ..Spec::default()
        },
        scope: Scope::default(),
    };
    reader.read_sections(&root)?;
    root.finish()?;
    let Reader { spec, scope } = reader;
    Ok(Parsed { spec, scope })
}

struct Reader<'a, 'input> {
    spec: Spec,
    scope: Scope<'a, 'input>,
}

impl<'a, 'input> Reader<'a, 'input> {
    fn read_sections(&mut self, root: &Element<'a, 'input>) -> Result<()> {
        for section in root.children()? {
            match section.name() {
                "compiler" => Rc::make_mut(&mut self.spec.compiler).read(section)?,
                "option" => self.read_option(section)?,
                "size" => self.read_size(section)?,
                "statistic" => self.read_statistic(section)?,
                // only MuJoCo's own viewer uses these sections
                "visual" | "custom" => {}
                // MuJoCo takes files that are a part of a model, and makes a model without the part
                "body" | "frame" => {}
                name if SECTIONS.contains(&name) => {}
                _ => return Err(root.unsupported(&section, &SECTIONS)),
            }
        }
        self.scope.classes = Classes::with(&self.spec.compiler);
        let sections = root.children()?.into_iter();
        for section in sections.filter(|section| section.name() == "default") {
            self.scope.classes.read(section, self.spec.revision)?;
        }
        let place = root.place();
        self.spec.bodies.push(Body {
            name: Some("world".to_owned()),
            place,
            compiler: self.spec.compiler.clone(),
            ..Body::default()
        });
        for section in root.children()? {
            match section.name() {
                "asset" => self.read_asset(section)?,
                "worldbody" => self.scope.worlds.push(section),
                "contact" => self.read_contact(section)?,
                "equality" => self.read_equalities(section)?,
                "tendon" => self.read_tendons(section)?,
                "actuator" => self.read_actuators(section)?,
                "sensor" => self.read_sensors(section)?,
                "keyframe" => self.read_keys(section)?,
                _ => {}
            }
        }
        // the bodies may attach what the other sections name
        let mut bodies = Bodies::new(&mut self.spec);
        for world in &self.scope.worlds {
            bodies.read(world.again(), &self.scope)?;
        }
        if self.spec.copies {
            copy_references(&mut self.spec, &self.scope)?;
        }
        Ok(())
    }

    fn read_option(&mut self, mut element: Element<'_, '_>) -> Result<()> {
        let place = element.place();
        self.spec.optional.get_or_insert_with(|| place.clone());
        let option = &mut self.spec.option;
        replace(&mut option.timestep, element.positive("timestep")?);
        replace(&mut option.gravity, element.numbers("gravity")?);
        replace(&mut option.wind, element.numbers("wind")?);
        element.set_non_negative("density", &mut option.density)?;
        element.set_non_negative("viscosity", &mut option.viscosity)?;
        let integrators = [
            ("Euler", Integrator::Euler),
            ("RK4", Integrator::RK4),
            ("implicit", Integrator::Implicit),
            ("implicitfast", Integrator::ImplicitFast),
        ];
        element.set_keyword("integrator", &integrators, &mut option.integrator)?;
        let solvers = [
            ("Newton", Solver::Newton),
            ("PGS", Solver::PGS),
            ("CG", Solver::CG),
        ];
        element.set_keyword("solver", &solvers, &mut option.solver)?;
        replace(&mut option.iterations, element.iterations("iterations")?);
        replace(
            &mut option.ls_iterations,
            element.iterations("ls_iterations")?,
        );
        element.set_non_negative("tolerance", &mut option.tolerance)?;
        element.set_non_negative("ls_tolerance", &mut option.ls_tolerance)?;
        let cones = [("pyramidal", Cone::Pyramidal), ("elliptic", Cone::Elliptic)];
        element.set_keyword("cone", &cones, &mut option.cone)?;
        let jacobians = [("dense", 0), ("sparse", 1), ("auto", 2)];
        element.set_keyword("jacobian", &jacobians, &mut option.jacobian)?;
        replace(&mut option.impratio, element.positive("impratio")?);
        replace(
            &mut option.noslip_iterations,
            element.iterations("noslip_iterations")?,
        );
        element.set_non_negative("noslip_tolerance", &mut option.noslip_tolerance)?;
        if let Some(iterations) = element.iterations("ccd_iterations")? {
            if iterations == 0 {
                return Err(place.attribute("ccd_iterations", "must be positive"));
            }
            option.ccd_iterations = iterations;
        }
        element.set_non_negative("sleep_tolerance", &mut option.sleep_tolerance)?;
        element.set_non_negative("ccd_tolerance", &mut option.ccd_tolerance)?;
        replace(&mut option.magnetic, element.numbers("magnetic")?);
        if let Some(groups) = element.list("actuatorgroupdisable")? {
            for group in groups {
                if !(0.0..31.0).contains(&group) {
                    return Err(place.attribute("actuatorgroupdisable", "groups are 0 to 30"));
                }
                option.disableactuator |= 1 << group as u32;
            }
        }
        // attributes of features that are unsupported, or off by default
        element.ignore("o_margin o_solref o_solimp o_friction sdf_iterations sdf_initpoints");
        for child in element.children()? {
            if child.name() != "flag" {
                return Err(element.unsupported(&child, &["flag"]));
            }
            self.read_flags(child)?;
        }
        element.finish()
    }

    fn read_flags(&mut self, mut element: Element<'_, '_>) -> Result<()> {
        const DISABLES: [(&str, Disable); 20] = [
            ("constraint", Disable::Constraint),
            ("equality", Disable::Equality),
            ("frictionloss", Disable::FrictionLoss),
            ("limit", Disable::Limit),
            ("contact", Disable::Contact),
            ("spring", Disable::Spring),
            ("damper", Disable::Damper),
            ("gravity", Disable::Gravity),
            ("clampctrl", Disable::ClampCtrl),
            ("warmstart", Disable::WarmStart),
            ("filterparent", Disable::FilterParent),
            ("actuation", Disable::Actuation),
            ("refsafe", Disable::RefSafe),
            ("sensor", Disable::Sensor),
            ("midphase", Disable::MidPhase),
            ("eulerdamp", Disable::EulerDamp),
            ("autoreset", Disable::AutoReset),
            ("nativeccd", Disable::NativeCcd),
            ("island", Disable::Island),
            ("multiccd", Disable::MultiCcd),
        ];
        const ENABLES: [(&str, u32); 3] = [
            ("energy", Options::ENERGY),
            ("fwdinv", 0), // only affects comparisons
            ("invdiscrete", Options::INVDISCRETE),
        ];
        let words = [("disable", false), ("enable", true)];
        let option = &mut self.spec.option;
        for (name, part) in DISABLES {
            match element.keyword(name, &words)? {
                Some(true) => option.disableflags &= !(part as u32),
                Some(false) => option.disableflags |= part as u32,
                None => {}
            }
        }
        for (name, part) in ENABLES {
            match element.keyword(name, &words)? {
                Some(true) => option.enableflags |= part,
                Some(false) => option.enableflags &= !part,
                None => {}
            }
        }
        if let Some(enabled) = element.keyword("sleep", &words)? {
            self.spec.sleep = enabled.then(|| element.place());
        }
        for name in ["override", "diagexact"] {
            element.keyword(name, &[("disable", ())])?;
        }
        element.finish_without_children()
    }

    /// Ignores the sizes of MuJoCo's buffers; `nkey` adds keyframes.
    fn read_size(&mut self, mut element: Element<'_, '_>) -> Result<()> {
        if let Some(nkey) = element.integer("nkey")? {
            if nkey > MOST_KEYS {
                let reason = format!("more than {MOST_KEYS}");
                return Err(element.place().attribute("nkey", reason));
            }
            self.spec.nkey = self.spec.nkey.max(nkey);
        }
        Ok(())
    }

    fn read_statistic(&mut self, mut element: Element<'_, '_>) -> Result<()> {
        let statistic = &mut self.spec.statistic;
        for (name, value) in [
            ("meaninertia", &mut statistic.meaninertia),
            ("meanmass", &mut statistic.meanmass),
            ("meansize", &mut statistic.meansize),
            ("extent", &mut statistic.extent),
        ] {
            *value = element.positive(name)?.or(*value);
        }
        statistic.center = element.numbers("center")?.or(statistic.center);
        element.finish()
    }

    /// Stores materials, textures, meshes and height fields, and ignores other assets.
    fn read_asset(&mut self, section: Element<'a, 'input>) -> Result<()> {
        for mut child in section.children()? {
            match child.name() {
                "material" => {
                    let mut material = self.scope.classes.of(&mut child)?.material.clone();
                    material.name = child.required_text("name")?;
                    material.read(&mut child)?;
                    fits(&self.spec.materials, "materials", &child)?;
                    child.finish()?;
                    self.spec.materials.push(material);
                }
                "mesh" => {
                    let mut mesh = self.scope.classes.of(&mut child)?.mesh.clone();
                    let compiler = &self.spec.compiler;
                    mesh.read(&mut child, &compiler.mesh_folder, compiler.strip_path)?;
                    child.finish_without_children()?;
                    fits(&self.spec.meshes, "meshes", &section)?;
                    self.spec.meshes.push(mesh);
                }
                "hfield" => {
                    let compiler = &self.spec.compiler;
                    let (folder, strip) = (&compiler.mesh_folder, compiler.strip_path);
                    let field = Hfield::read(&mut child, folder, strip)?;
                    child.finish_without_children()?;
                    fits(&self.spec.hfields, "height fields", &section)?;
                    self.spec.hfields.push(field);
                }
                "texture" => {
                    fits(&self.spec.textures, "textures", &child)?;
                    let compiler = &self.spec.compiler;
                    let folder = &compiler.texture_folder;
                    let texture = Texture::read(child, folder, compiler.strip_path)?;
                    self.spec.textures.push(texture);
                }
                "model" => {
                    let (name, root) = (child.text("name")?, child.model());
                    let root = root.ok_or_else(|| child.missing("file"))?;
                    let model = read_model(root, self.spec.revision)?;
                    let own = Some(&model.spec.name).filter(|name| !name.is_empty());
                    let name = name.or(own.cloned()).unwrap_or(NAMELESS.to_owned());
                    self.scope.models.push((name, model));
                }
                "skin" => {}
                _ => {
                    let known = ["material", "mesh", "texture", "model", "skin", "hfield"];
                    return Err(section.unsupported(&child, &known));
                }
            }
        }
        section.finish()
    }

    fn read_contact(&mut self, section: Element<'_, '_>) -> Result<()> {
        for mut child in section.children()? {
            match child.name() {
                "exclude" => {
                    fits(&self.spec.excludes, "excludes", &child)?;
                    self.spec.excludes.push(Exclude::read(child)?);
                }
                "pair" => {
                    fits(&self.spec.pairs, "pairs", &child)?;
                    let mut pair = self.scope.classes.of(&mut child)?.pair.clone();
                    pair.name = child.text("name")?;
                    pair.read(&mut child)?;
                    child.finish_without_children()?;
                    self.spec.pairs.push(pair);
                }
                _ => return Err(section.unsupported(&child, &["exclude", "pair"])),
            }
        }
        section.finish()
    }

    fn read_equalities(&mut self, section: Element<'_, '_>) -> Result<()> {
        for mut child in section.children()? {
            let kinds = EQUALITIES.map(|(name, ..)| name);
            let Some((_, kind, names)) = EQUALITIES.iter().find(|(name, ..)| *name == child.name())
            else {
                return Err(section.unsupported(&child, &kinds));
            };
            fits(&self.spec.equalities, "equalities", &child)?;
            let mut equality = self.scope.classes.of(&mut child)?.equality.clone();
            equality.name = child.text("name")?;
            equality.read(&mut child, *kind, *names)?;
            child.finish_without_children()?;
            self.spec.equalities.push(equality);
        }
        section.finish()
    }

    fn read_tendons(&mut self, section: Element<'_, '_>) -> Result<()> {
        let parts = |tendon: &Tendon| tendon.wraps.len();
        let mut count: usize = self.spec.tendons.iter().map(parts).sum();
        for mut child in section.children()? {
            if !["fixed", "spatial"].contains(&child.name()) {
                return Err(section.unsupported(&child, &["fixed", "spatial"]));
            }
            let mut tendon = self.scope.classes.of(&mut child)?.tendon.clone();
            tendon.name = child.text("name")?;
            tendon.read(&mut child)?;
            fits(&self.spec.tendons, "tendons", &child)?;
            tendon.read_path(&child)?;
            count += tendon.wraps.len();
            if count > MOST {
                let reason = format!("more than {MOST} parts of tendons are not supported");
                return Err(child.error(reason));
            }
            child.finish()?;
            self.spec.tendons.push(tendon);
        }
        section.finish()
    }

    fn read_actuators(&mut self, section: Element<'_, '_>) -> Result<()> {
        for mut child in section.children()? {
            if !ACTUATORS.contains(&child.name()) {
                return Err(section.unsupported(&child, &ACTUATORS));
            }
            fits(&self.spec.actuators, "actuators", &child)?;
            let class = self.scope.classes.named(&mut child, "class", 0)?;
            let revision = self.spec.revision;
            let mut actuator = self.scope.classes.actuator(class, child.name(), revision);
            actuator.name = child.text("name")?;
            actuator.read(&mut child)?;
            child.finish_without_children()?;
            self.spec.actuators.push(actuator);
        }
        section.finish()
    }

    fn read_sensors(&mut self, section: Element<'_, '_>) -> Result<()> {
        for child in section.children()? {
            let kinds = SensorType::ALL;
            let Some((_, kind)) = kinds.iter().find(|(name, _)| *name == child.name()) else {
                let known: Vec<&str> = kinds.iter().map(|(name, _)| *name).collect();
                return Err(section.unsupported(&child, &known));
            };
            fits(&self.spec.sensors, "sensors", &child)?;
            self.spec.sensors.push(Sensor::read(child, *kind)?);
        }
        section.finish()
    }

    fn read_keys(&mut self, section: Element<'_, '_>) -> Result<()> {
        for child in section.children()? {
            match child.name() {
                "key" => {
                    fewer_than(MOST_KEYS, &self.spec.keys, "keys", &child)?;
                    self.spec.keys.push(Key::read(child)?);
                }
                _ => return Err(section.unsupported(&child, &["key"])),
            }
        }
        section.finish()
    }
}

/// Refuses another object of a kind after [`MOST`]: look-ups by name would take too long.
fn fits<T>(objects: &[T], kind: &str, element: &Element<'_, '_>) -> Result<()> {
    fewer_than(MOST, objects, kind, element)
}

fn fewer_than<T>(most: usize, objects: &[T], kind: &str, element: &Element<'_, '_>) -> Result<()> {
    if objects.len() < most {
        return Ok(());
    }
    Err(element.error(format!("more than {most} {kind} are not supported")))
}
