//! Elements that refer to parts of a `replicate`: MuJoCo copies them with each copy of the parts.

use std::collections::HashSet;

use super::MOST;
use super::spec::{Actuator, Equality, Exclude, Pair, Sensor, Spec, Tendon, Wrap};
use super::xml::{Element, Place};
use crate::Result;
use crate::model::{EqualityType, ObjectType};

/// The largest size in bytes of the names in all copies.
const MOST_BYTES: usize = 8 << 20;

/// An element that refers to others by their names.
trait Refers: Clone {
    /// The kind by which others refer to it; `None` if none do.
    const KIND: Option<ObjectType> = None;
    /// Whether a name stays as it is if another one has a copy.
    const ONE_IS_ENOUGH: bool = true;

    fn place(&self) -> &Place;
    /// The name of the element, if the reader keeps it.
    fn name(&mut self) -> Option<&mut String>;
    /// Visits the names of other elements, with their kinds.
    fn visit(&mut self, visit: &mut dyn FnMut(ObjectType, &mut String));
}

/// Copies the elements of `spec` that refer to copied parts of the bodies in `worlds`.
pub(crate) fn copy_references(spec: &mut Spec, worlds: Vec<Element<'_, '_>>) -> Result<()> {
    let mut names = Names::default();
    let tendons = spec.tendons.iter().filter_map(|tendon| tendon.name.clone());
    names
        .known
        .extend(tendons.map(|name| (ObjectType::Tendon, name)));
    let actuators = spec
        .actuators
        .iter()
        .filter_map(|actuator| actuator.name.clone());
    names
        .known
        .extend(actuators.map(|name| (ObjectType::Actuator, name)));
    names.known.insert((ObjectType::Body, "world".to_owned()));
    let mut open: Vec<Open<'_, '_>> = Vec::new();
    for world in worlds {
        open.push(Open::new(world, &names)?);
        while let Some(around) = open.last_mut() {
            let Some(mut child) = around.children.next() else {
                if let Some(done) = open.pop() {
                    names.copy(spec, &done)?;
                }
                continue;
            };
            let kind = match child.name() {
                "body" => ObjectType::Body,
                "joint" | "freejoint" => ObjectType::Joint,
                "geom" => ObjectType::Geom,
                "site" => ObjectType::Site,
                "camera" => ObjectType::Camera,
                _ => ObjectType::Unknown,
            };
            if kind != ObjectType::Unknown {
                names.add(kind, child.text("name")?.as_ref());
            }
            if ["body", "frame", "replicate"].contains(&child.name()) {
                open.push(Open::new(child, &names)?);
            }
        }
    }
    Ok(())
}

/// An element whose children are being visited.
struct Open<'a, 'input> {
    children: std::vec::IntoIter<Element<'a, 'input>>,
    /// The number of names before the element.
    first: usize,
    /// The number of copies and the separator.
    copies: Option<(usize, String)>,
}

impl<'a, 'input> Open<'a, 'input> {
    fn new(mut element: Element<'a, 'input>, names: &Names) -> Result<Self> {
        let copies = match element.name() {
            "replicate" => {
                let separator = element.text("sep")?.unwrap_or_default();
                Some((element.integer("count")?.unwrap_or(0), separator))
            }
            _ => None,
        };
        let mut children = element.children()?;
        // nothing is left of no copies
        if let Some((0, _)) = copies {
            children.clear();
        }
        Ok(Self {
            children: children.into_iter(),
            first: names.of_bodies.len(),
            copies,
        })
    }
}

/// The names so far.
#[derive(Default)]
struct Names {
    /// Of the parts of bodies, in their order.
    of_bodies: Vec<(ObjectType, String)>,
    known: HashSet<(ObjectType, String)>,
    bytes: usize,
}

impl Names {
    /// Adds the name of a part of a body.
    fn add(&mut self, kind: ObjectType, name: Option<&String>) {
        let Some(name) = name else { return };
        self.of_bodies.push((kind, name.clone()));
        self.known.insert((kind, name.clone()));
    }

    /// Replaces the names within a `replicate` by those of its copies, and copies the elements that
    /// refer to them.
    fn copy(&mut self, spec: &mut Spec, done: &Open<'_, '_>) -> Result<()> {
        let Some((count, separator)) = &done.copies else {
            return Ok(());
        };
        let original = self.of_bodies.split_off(done.first);
        let digits = count.to_string().len();
        for number in 0..*count {
            let suffix = format!("{separator}{number:0digits$}");
            for (kind, name) in &original {
                self.add(*kind, Some(&format!("{name}{suffix}")));
            }
            self.copy_list(&mut spec.pairs, &suffix)?;
            self.copy_list(&mut spec.excludes, &suffix)?;
            self.copy_list(&mut spec.tendons, &suffix)?;
            let parts: usize = spec.tendons.iter().map(|tendon| tendon.wraps.len()).sum();
            if let Some(last) = spec.tendons.last().filter(|_| parts > MOST) {
                let reason = format!("more than {MOST} parts of tendons are not supported");
                return Err(last.place.error(reason));
            }
            self.copy_list(&mut spec.equalities, &suffix)?;
            self.copy_list(&mut spec.actuators, &suffix)?;
            self.copy_list(&mut spec.sensors, &suffix)?;
        }
        for name in &original {
            self.known.remove(name);
        }
        let mut gone: HashSet<(ObjectType, String)> = original.into_iter().collect();
        remove(&mut spec.pairs, &self.known, &mut gone);
        remove(&mut spec.excludes, &self.known, &mut gone);
        remove(&mut spec.tendons, &self.known, &mut gone);
        remove(&mut spec.equalities, &self.known, &mut gone);
        remove(&mut spec.actuators, &self.known, &mut gone);
        remove(&mut spec.sensors, &self.known, &mut gone);
        for name in &gone {
            self.known.remove(name);
        }
        Ok(())
    }

    /// Adds a copy of each element whose references exist with the suffix.
    fn copy_list<T: Refers>(&mut self, list: &mut Vec<T>, suffix: &str) -> Result<()> {
        for i in 0..list.len() {
            let (mut copy, mut bytes) = (list[i].clone(), 0);
            // the numbers of names with a copy, without, and of those that do not exist at all
            let (mut copied, mut kept, mut missing) = (0, 0, 0);
            copy.visit(&mut |kind, name| {
                let length = name.len();
                name.push_str(suffix);
                bytes += name.len();
                if self.known.contains(&(kind, name.clone())) {
                    copied += 1;
                    return;
                }
                name.truncate(length);
                match self.known.contains(&(kind, name.clone())) {
                    true => kept += 1,
                    false => missing += 1,
                }
            });
            let stays = kept > 0 && (copied == 0 || !T::ONE_IS_ENOUGH);
            if missing > 0 || stays {
                continue;
            }
            self.bytes += bytes;
            if list.len() == MOST || self.bytes > MOST_BYTES {
                let reason = format!(
                    "with the copies that replicate makes, there are more than {MOST} of these, or more than {MOST_BYTES} bytes of names"
                );
                return Err(copy.place().error(reason));
            }
            if let Some(name) = copy.name() {
                name.push_str(suffix);
                if let Some(kind) = T::KIND {
                    self.known.insert((kind, name.clone()));
                }
            }
            list.push(copy);
        }
        Ok(())
    }
}

/// Removes the elements that refer to what is gone; the names by which others refer to them are gone too. An
/// element that also refers to what does not exist yet stays, and is an error, as in MuJoCo.
fn remove<T: Refers>(
    list: &mut Vec<T>,
    known: &HashSet<(ObjectType, String)>,
    gone: &mut HashSet<(ObjectType, String)>,
) {
    list.retain_mut(|element| {
        let (mut lost, mut unknown) = (false, false);
        element.visit(&mut |kind, name| {
            let name = (kind, name.clone());
            match gone.contains(&name) {
                true => lost = true,
                false => unknown |= !known.contains(&name),
            }
        });
        let stays = !lost || unknown;
        if let (false, Some(kind), Some(name)) = (stays, T::KIND, element.name()) {
            gone.insert((kind, name.clone()));
        }
        stays
    });
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
