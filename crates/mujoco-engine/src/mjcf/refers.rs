//! The names by which elements refer to others.

use super::spec::{Actuator, Equality, Exclude, Pair, Sensor, Tendon, Wrap};
use super::xml::Place;
use crate::model::{EqualityType, ObjectType};

/// An element that refers to others by their names.
pub(super) trait Refers: Clone {
    /// The kind by which others refer to it; `None` if none do.
    const KIND: Option<ObjectType> = None;
    /// Whether a name stays as it is if another one has a copy.
    const ONE_IS_ENOUGH: bool = true;

    fn place(&self) -> &Place;
    /// The name of the element, if the reader keeps it.
    fn name(&mut self) -> Option<&mut String>;
    /// Visits the names of other elements, with their kinds.
    fn visit(&mut self, visit: &mut dyn FnMut(ObjectType, &mut String));
    /// Where keyframes of an attached model have its numbers, if they have any.
    fn stored(&mut self) -> Option<&mut Option<(usize, usize)>> {
        None
    }
}

impl Refers for Pair {
    fn place(&self) -> &Place {
        &self.place
    }

    fn name(&mut self) -> Option<&mut String> {
        self.name.as_mut()
    }

    fn visit(&mut self, visit: &mut dyn FnMut(ObjectType, &mut String)) {
        let names = self.geoms.iter_mut().flatten();
        names.for_each(|name| visit(ObjectType::Geom, name));
    }
}

impl Refers for Exclude {
    fn place(&self) -> &Place {
        &self.place
    }

    fn name(&mut self) -> Option<&mut String> {
        None
    }

    fn visit(&mut self, visit: &mut dyn FnMut(ObjectType, &mut String)) {
        let names = self.bodies.iter_mut();
        names.for_each(|name| visit(ObjectType::Body, name));
    }
}

impl Refers for Tendon {
    const KIND: Option<ObjectType> = Some(ObjectType::Tendon);

    fn place(&self) -> &Place {
        &self.place
    }

    fn name(&mut self) -> Option<&mut String> {
        self.name.as_mut()
    }

    fn visit(&mut self, visit: &mut dyn FnMut(ObjectType, &mut String)) {
        for (_, wrap) in &mut self.wraps {
            match wrap {
                Wrap::Joint(name, _) => visit(ObjectType::Joint, name),
                Wrap::Site(name) => visit(ObjectType::Site, name),
                Wrap::Geom(name, side) => {
                    visit(ObjectType::Geom, name);
                    if let Some(side) = side {
                        visit(ObjectType::Site, side);
                    }
                }
                Wrap::Pulley(_) => {}
            }
        }
    }
}

impl Refers for Equality {
    const ONE_IS_ENOUGH: bool = false;

    fn place(&self) -> &Place {
        &self.place
    }

    fn name(&mut self) -> Option<&mut String> {
        self.name.as_mut()
    }

    fn visit(&mut self, visit: &mut dyn FnMut(ObjectType, &mut String)) {
        let kind = match self.kind {
            EqualityType::Joint => ObjectType::Joint,
            EqualityType::Tendon => ObjectType::Tendon,
            _ if self.sites => ObjectType::Site,
            _ => ObjectType::Body,
        };
        let names = self.names.iter_mut().flatten();
        names.for_each(|name| visit(kind, name));
    }
}

impl Refers for Actuator {
    const KIND: Option<ObjectType> = Some(ObjectType::Actuator);
    const ONE_IS_ENOUGH: bool = false;

    fn place(&self) -> &Place {
        &self.place
    }

    fn name(&mut self) -> Option<&mut String> {
        self.name.as_mut()
    }

    fn stored(&mut self) -> Option<&mut Option<(usize, usize)>> {
        Some(&mut self.stored)
    }

    fn visit(&mut self, visit: &mut dyn FnMut(ObjectType, &mut String)) {
        if let Some((attribute, name)) = &mut self.target {
            let kind = match *attribute {
                "tendon" => ObjectType::Tendon,
                "site" | "cranksite" => ObjectType::Site,
                "body" => ObjectType::Body,
                _ => ObjectType::Joint,
            };
            visit(kind, name);
        }
        let sites = [&mut self.reference_site, &mut self.slider_site];
        for site in sites.into_iter().flatten() {
            visit(ObjectType::Site, site);
        }
    }
}

impl Refers for Sensor {
    fn place(&self) -> &Place {
        &self.place
    }

    fn name(&mut self) -> Option<&mut String> {
        self.name.as_mut()
    }

    fn visit(&mut self, visit: &mut dyn FnMut(ObjectType, &mut String)) {
        for target in self.object.iter_mut().chain(&mut self.reference) {
            let kind = match target.kind {
                ObjectType::XBody => ObjectType::Body,
                kind => kind,
            };
            visit(kind, &mut target.name);
        }
    }
}
