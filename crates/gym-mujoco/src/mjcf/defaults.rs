//! Classes of default values.

use super::spec::{Geom, Joint, Motor, Site};
use super::xml::Element;
use crate::Result;

/// The values that an element of a class starts from.
#[derive(Clone, Debug, Default)]
pub(super) struct Class {
    name: String,
    pub(super) joint: Joint,
    pub(super) geom: Geom,
    pub(super) site: Site,
    pub(super) motor: Motor,
}

/// All classes; the first is the one that holds where no class is named.
#[derive(Debug)]
pub(super) struct Classes(Vec<Class>);

const MAIN: &str = "main";

impl Default for Classes {
    fn default() -> Self {
        Self(vec![Class { name: MAIN.to_owned(), ..Class::default() }])
    }
}

impl Classes {
    /// Reads a `default` section. A later section changes what the classes are from there on.
    pub(super) fn read(&mut self, mut section: Element<'_, '_>) -> Result<()> {
        match section.text("class") {
            Some(name) if name != MAIN => Err(section
                .place()
                .attribute("class", format!("the outermost class is {MAIN:?}, not {name:?}"))),
            _ => self.read_class(section, 0),
        }
    }

    /// Reads what a class changes, then the classes within it, which start from it.
    fn read_class(&mut self, section: Element<'_, '_>, class: usize) -> Result<()> {
        let (within, own): (Vec<_>, Vec<_>) =
            section.children()?.into_iter().partition(|child| child.name() == "default");
        for mut child in own {
            let values = &mut self.0[class];
            match child.name() {
                "joint" => values.joint.read(&mut child)?,
                "geom" => values.geom.read(&mut child)?,
                "site" => values.site.read(&mut child)?,
                "motor" => values.motor.read(&mut child)?,
                _ => return Err(section.unsupported(&child, &["joint", "geom", "site", "motor", "default"])),
            }
            child.finish_without_children()?;
        }
        for mut child in within {
            let name = child.required_text("class")?;
            if self.0.iter().any(|class| class.name == name) {
                return Err(child.place().attribute("class", format!("there is a class {name:?} already")));
            }
            self.0.push(Class { name, ..self.0[class].clone() });
            self.read_class(child, self.0.len() - 1)?;
        }
        section.finish()
    }

    /// The class that an attribute names, else `inherited`.
    pub(super) fn named(
        &self,
        element: &mut Element<'_, '_>,
        attribute: &'static str,
        inherited: usize,
    ) -> Result<usize> {
        let Some(name) = element.text(attribute) else { return Ok(inherited) };
        self.0.iter().position(|class| class.name == name).ok_or_else(|| {
            let names: Vec<&str> = self.0.iter().map(|class| &*class.name).collect();
            let reason = format!("there is no class {name:?}: the classes are {}", names.join(", "));
            element.place().attribute(attribute, reason)
        })
    }

    /// A class by its number.
    pub(super) fn get(&self, class: usize) -> &Class {
        &self.0[class]
    }
}
