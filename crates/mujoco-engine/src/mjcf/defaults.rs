//! Classes of default values.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::MOST;
use super::spec::{
    ACTUATORS, Actuator, Camera, Compiler, Equality, Geom, Joint, Light, Material, Mesh, Pair,
    Site, Tendon,
};
use super::xml::Element;
use crate::{Result, Revision};

/// The initial values of the elements of a class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Class {
    name: String,
    parent: Option<usize>,
    pub(crate) joint: Joint,
    pub(crate) geom: Geom,
    pub(crate) site: Site,
    pub(crate) camera: Camera,
    pub(crate) light: Light,
    pub(crate) material: Material,
    pub(crate) mesh: Mesh,
    pub(crate) pair: Pair,
    pub(crate) equality: Equality,
    pub(crate) tendon: Tendon,
    pub(crate) actuator: Actuator,
}

/// All classes; the first applies to elements without a class.
#[derive(Debug)]
pub(crate) struct Classes {
    all: Vec<Class>,
    numbers: BTreeMap<String, usize>,
}

const MAIN: &str = "main";

impl Default for Classes {
    fn default() -> Self {
        Self::with(&Rc::default())
    }
}

impl Classes {
    /// The first class, of a model with these settings.
    pub(crate) fn with(compiler: &Rc<Compiler>) -> Self {
        let mut main = Class {
            name: MAIN.to_owned(),
            ..Class::default()
        };
        for of in [
            &mut main.joint.compiler,
            &mut main.geom.compiler,
            &mut main.site.compiler,
            &mut main.camera.compiler,
            &mut main.tendon.compiler,
            &mut main.actuator.compiler,
        ] {
            of.clone_from(compiler);
        }
        Self {
            all: vec![main],
            numbers: BTreeMap::from([(MAIN.to_owned(), 0)]),
        }
    }

    /// Reads a `default` section, which changes the classes for the elements after the section.
    pub(crate) fn read(&mut self, mut section: Element<'_, '_>, revision: Revision) -> Result<()> {
        match section.text("class")? {
            Some(name) if name != MAIN => Err(section.place().attribute(
                "class",
                format!("the outermost class is {MAIN:?}, not {name:?}"),
            )),
            _ => self.read_classes(section, revision),
        }
    }

    /// Reads the values of each class, then its subclasses, which inherit them. The function does
    /// not recurse, because deep nesting would overflow the stack.
    fn read_classes(&mut self, main: Element<'_, '_>, revision: Revision) -> Result<()> {
        let mut waiting = vec![(main, None)];
        while let Some((mut section, parent)) = waiting.pop() {
            let class = match parent {
                None => 0,
                Some(parent) => self.add(&mut section, parent)?,
            };
            let within = self.read_class(section, class, revision)?;
            waiting.extend(within.into_iter().rev().map(|child| (child, Some(class))));
        }
        Ok(())
    }

    /// Adds a subclass of `parent`.
    fn add(&mut self, section: &mut Element<'_, '_>, parent: usize) -> Result<usize> {
        let name = section.required_text("class")?;
        if self.numbers.contains_key(&name) {
            let reason = format!("there is a class {name:?} already");
            return Err(section.place().attribute("class", reason));
        }
        if self.all.len() == MOST {
            return Err(section.error(format!("more than {MOST} classes are not supported")));
        }
        self.numbers.insert(name.clone(), self.all.len());
        self.all.push(Class {
            name,
            parent: Some(parent),
            ..self.all[parent].clone()
        });
        Ok(self.all.len() - 1)
    }

    /// Reads the values that a class changes; returns the elements of its subclasses.
    fn read_class<'a, 'input>(
        &mut self,
        section: Element<'a, 'input>,
        class: usize,
        revision: Revision,
    ) -> Result<Vec<Element<'a, 'input>>> {
        let children = section.children()?.into_iter();
        let (within, own): (Vec<_>, Vec<_>) = children.partition(|child| child.name() == "default");
        for mut child in own {
            let values = &mut self.all[class];
            match child.name() {
                "joint" => values.joint.read(&mut child)?,
                "geom" => values.geom.read(&mut child)?,
                "site" => values.site.read(&mut child)?,
                "camera" => values.camera.read(&mut child)?,
                "light" => values.light.read(&mut child)?,
                "material" => {
                    values.material.read(&mut child)?;
                    child.finish()?;
                    continue;
                }
                "pair" => values.pair.read(&mut child)?,
                "equality" => values.equality.read_common(&mut child)?,
                "tendon" => values.tendon.read(&mut child)?,
                "mesh" => values.mesh.read_class(&mut child)?,
                name if ACTUATORS.contains(&name) => {
                    let mut actuator = self.actuator(class, name, revision);
                    actuator.read(&mut child)?;
                    self.all[class].actuator = actuator;
                }
                _ => {
                    let mut known = vec!["joint", "geom", "site", "camera", "light", "material"];
                    known.extend(["pair", "equality", "tendon", "mesh", "default"]);
                    known.extend(ACTUATORS);
                    return Err(section.unsupported(&child, &known));
                }
            }
            child.finish_without_children()?;
        }
        section.finish()?;
        Ok(within)
    }

    /// The class that an attribute names; `inherited` without the attribute.
    pub(crate) fn named(
        &self,
        element: &mut Element<'_, '_>,
        attribute: &'static str,
        inherited: usize,
    ) -> Result<usize> {
        let Some(name) = element.text(attribute)? else {
            return Ok(inherited);
        };
        self.numbers.get(&name).copied().ok_or_else(|| {
            /// The most classes that a message names.
            const MOST: usize = 10;
            let names: Vec<&str> = self.all.iter().map(|class| &*class.name).collect();
            let named = &names[..names.len().min(MOST)];
            let more = match names.len() - named.len() {
                0 => String::new(),
                more => format!(", and {more} more"),
            };
            let reason = format!(
                "there is no class {name:?}: the classes are {}{more}",
                named.join(", ")
            );
            element.place().attribute(attribute, reason)
        })
    }

    /// The initial values of the actuator element `kind` of a class. In 4.0, its parameters are those
    /// of the nearest class, from this one outwards, that was set by an element of the same kind or
    /// by a fitting `general`; in 3.12 an element takes the parameters of every other kind.
    pub(crate) fn actuator(&self, class: usize, kind: &str, revision: Revision) -> Actuator {
        let mut actuator = self.all[class].actuator.clone();
        if revision.classes_by_kind() && kind != "general" {
            let outwards = std::iter::successors(Some(class), |&class| self.all[class].parent);
            let mut classes = outwards.map(|class| &self.all[class].actuator);
            let fitting = classes.find(|actuator| actuator.fits(kind));
            actuator.take(kind, fitting.unwrap_or(&Actuator::default()));
        }
        actuator
    }

    /// The class that the attribute `class` names; the first class without the attribute.
    pub(crate) fn of(&self, element: &mut Element<'_, '_>) -> Result<&Class> {
        Ok(&self.all[self.named(element, "class", 0)?])
    }

    /// A class by its number.
    pub(crate) fn get(&self, class: usize) -> &Class {
        &self.all[class]
    }
}
