//! Elements that refer to parts that are copied, by `replicate`, or attached: MuJoCo copies them with
//! the parts.

use std::collections::HashSet;
use std::rc::Rc;

use super::attach::{Attach, Parsed, Scope};
use super::refers::Refers;
use super::spec::{Key, Mesh, Spec, Stored};
use super::xml::Element;
use super::{MOST, MOST_KEYS};
use crate::Result;
use crate::model::ObjectType;

/// The largest size in bytes of the names in all copies.
const MOST_BYTES: usize = 8 << 20;
/// The most numbers of meshes and height fields in texts, with those of attached models.
const MOST_NUMBERS: usize = 1 << 24;

/// Copies the elements of `spec` that refer to parts of its bodies that are copied or attached, and
/// adds what the attached models have besides bodies.
pub(crate) fn copy_references(spec: &mut Spec, scope: &Scope<'_, '_>) -> Result<()> {
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
    let mut open: Vec<Open<'_, '_, '_>> = Vec::new();
    for world in &scope.worlds {
        open.push(Open::new(world.again(), scope, false, &names)?);
        while let Some(around) = open.last_mut() {
            let (within, scope) = (around.within, around.scope);
            let Some(mut child) = around.children.next() else {
                if let Some(done) = open.pop() {
                    names.close(spec, done)?;
                }
                continue;
            };
            if child.name() == "attach" {
                open.push(Open::attached(child, scope, within, &mut names)?);
                continue;
            }
            if let Some(kind) = kind_of(&child) {
                names.add(kind, child.text("name")?, within);
            }
            if ["body", "frame", "replicate"].contains(&child.name()) {
                open.push(Open::new(child, scope, within, &names)?);
            }
        }
    }
    Ok(())
}

/// The kind of object that an element in bodies is, if others refer to it.
fn kind_of(element: &Element<'_, '_>) -> Option<ObjectType> {
    Some(match element.name() {
        "body" => ObjectType::Body,
        "joint" | "freejoint" => ObjectType::Joint,
        "geom" => ObjectType::Geom,
        "site" => ObjectType::Site,
        "camera" => ObjectType::Camera,
        _ => return None,
    })
}

/// An element whose children are being visited.
struct Open<'s, 'a, 'input> {
    children: std::vec::IntoIter<Element<'a, 'input>>,
    /// The number of names before the element.
    first: usize,
    /// The number of copies and the separator.
    copies: Option<(usize, String)>,
    attaches: Option<Attaching<'s, 'a, 'input>>,
    scope: &'s Scope<'a, 'input>,
    /// Whether an element `attach` is around the children.
    within: bool,
}

/// An element `attach`.
struct Attaching<'s, 'a, 'input> {
    attach: Attach<'s, 'a, 'input>,
    element: Element<'a, 'input>,
    /// Whether another one is around it.
    within: bool,
}

impl<'s, 'a, 'input> Open<'s, 'a, 'input> {
    fn new(
        mut element: Element<'a, 'input>,
        scope: &'s Scope<'a, 'input>,
        within: bool,
        names: &Names,
    ) -> Result<Self> {
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
            attaches: None,
            scope,
            within,
        })
    }

    /// What an element `attach` names.
    fn attached(
        element: Element<'a, 'input>,
        scope: &'s Scope<'a, 'input>,
        within: bool,
        names: &mut Names,
    ) -> Result<Self> {
        let attach = Attach::read(element.again(), scope)?;
        let (scope, first) = (attach.scope(scope), names.of_bodies.len());
        if let Some((part, _)) = &attach.part
            && let Some(kind) = kind_of(part)
        {
            names.add(kind, part.again().text("name")?, true);
        }
        Ok(Self {
            children: attach.children(scope)?.into_iter(),
            first,
            copies: None,
            attaches: Some(Attaching {
                attach,
                element,
                within,
            }),
            scope,
            within: true,
        })
    }
}

/// What stands before and after names.
type Ends<'s> = (&'s str, &'s str);

/// The names so far.
#[derive(Default)]
struct Names {
    /// Of the parts of bodies, in their order.
    of_bodies: Vec<(ObjectType, String)>,
    known: HashSet<(ObjectType, String)>,
    bytes: usize,
    /// How many numbers of assets are in texts.
    numbers: usize,
}

impl Names {
    /// Adds the name of a part of a body. Within an element `attach` others do not know it yet.
    fn add(&mut self, kind: ObjectType, name: Option<String>, within: bool) {
        let Some(name) = name else { return };
        if !within {
            self.known.insert((kind, name.clone()));
        }
        self.of_bodies.push((kind, name));
    }

    /// Ends an element.
    fn close(&mut self, spec: &mut Spec, done: Open<'_, '_, '_>) -> Result<()> {
        let (first, within) = (done.first, done.within);
        if let Some((count, separator)) = done.copies {
            self.copy(spec, (first, within), count, &separator)?;
        }
        match done.attaches {
            Some(done) => self.attach(spec, first, &done),
            None => Ok(()),
        }
    }

    /// Puts the prefix of an element `attach` before the names within it, and adds the elements that
    /// refer to them, and what the model has besides.
    fn attach(
        &mut self,
        spec: &mut Spec,
        first: usize,
        done: &Attaching<'_, '_, '_>,
    ) -> Result<()> {
        let Attaching {
            attach,
            element,
            within,
        } = done;
        for (kind, name) in self.of_bodies.split_off(first) {
            self.add(kind, Some(format!("{}{name}", attach.prefix)), *within);
        }
        // what refers to parts of a model within another is in the other one's lists
        if *within {
            return Ok(());
        }
        let (ends, identity) = ((&*attach.prefix, ""), element.identity());
        let Some(Parsed { spec: model, .. }) = attach.model else {
            return self.copy_lists(spec, None, ends);
        };
        if let (false, Some(option)) = (spec.compiler.keeps_options, &model.optional) {
            let reason =
                "not supported in an attached model, unless this one has conflict=\"warning\"";
            return Err(option.error(reason));
        }
        let all = spec.attached.iter();
        let number = all
            .take_while(|attached| attached.element != identity)
            .count();
        self.add_assets(spec, model, ends, element)?;
        self.copy_lists(spec, Some((model, number)), ends)?;
        if model.keys.is_empty() && model.attached_keys.is_empty() {
            return Ok(());
        }
        if !model.attached_keys.is_empty() {
            let reason = "not supported: the model attaches another one that has keyframes";
            return Err(element.error(reason));
        }
        let start = match &attach.part {
            None => Some(1),
            Some((part, _)) => first_body(part)?.and_then(|first| {
                let mut bodies = model.bodies.iter();
                bodies.position(|body| body.element == first)
            }),
        };
        add_keys(spec, model, (number, start), ends, element)
    }

    /// Replaces the names within a `replicate` by those of its copies, and copies the elements that
    /// refer to them.
    fn copy(
        &mut self,
        spec: &mut Spec,
        (first, within): (usize, bool),
        count: usize,
        separator: &str,
    ) -> Result<()> {
        let original = self.of_bodies.split_off(first);
        let digits = count.to_string().len();
        for number in 0..count {
            let suffix = format!("{separator}{number:0digits$}");
            for (kind, name) in &original {
                self.add(*kind, Some(format!("{name}{suffix}")), within);
            }
            if !within {
                self.copy_lists(spec, None, ("", &suffix))?;
            }
        }
        if within {
            return Ok(());
        }
        if !spec.revision.keeps_attached_controls() {
            spec.actuators.iter_mut().for_each(|of| of.stored = None);
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

    /// Copies the elements that refer to others: of the model itself, or of one that it attaches, with
    /// the number of the attachment.
    fn copy_lists(
        &mut self,
        spec: &mut Spec,
        from: Option<(&Spec, usize)>,
        ends: Ends<'_>,
    ) -> Result<()> {
        macro_rules! copy {
            ($list: ident) => {
                let of = from.map(|(model, number)| (&model.$list[..], number));
                self.copy_list(&mut spec.$list, of, ends)?;
            };
        }
        copy!(pairs);
        copy!(excludes);
        copy!(tendons);
        let parts: usize = spec.tendons.iter().map(|tendon| tendon.wraps.len()).sum();
        if let Some(last) = spec.tendons.last().filter(|_| parts > MOST) {
            let reason = format!("more than {MOST} parts of tendons are not supported");
            return Err(last.place.error(reason));
        }
        copy!(equalities);
        copy!(actuators);
        copy!(sensors);
        Ok(())
    }

    /// Adds a copy of each element whose references exist with the prefix and suffix.
    fn copy_list<T: Refers>(
        &mut self,
        list: &mut Vec<T>,
        from: Option<(&[T], usize)>,
        (prefix, suffix): Ends<'_>,
    ) -> Result<()> {
        let count = from.map_or(list.len(), |(from, _)| from.len());
        for i in 0..count {
            let original = match from {
                Some((from, _)) => &from[i],
                None => &list[i],
            };
            let (mut copy, mut bytes) = (original.clone(), 0);
            // the numbers of names with a copy, without, and of those that do not exist at all
            let (mut copied, mut kept, mut missing) = (0, 0, 0);
            copy.visit(&mut |kind, name| {
                let complete = format!("{prefix}{name}{suffix}");
                bytes += complete.len();
                if self.known.contains(&(kind, complete.clone())) {
                    copied += 1;
                    *name = complete;
                    return;
                }
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
                    "with the copies that replicate and attach make, there are more than {MOST} of these, or more than {MOST_BYTES} bytes of names"
                );
                return Err(copy.place().error(reason));
            }
            if let Some(name) = copy.name() {
                *name = format!("{prefix}{name}{suffix}");
                if let Some(kind) = T::KIND {
                    self.known.insert((kind, name.clone()));
                }
            }
            match (from, copy.stored()) {
                (Some((_, number)), Some(stored)) => *stored = Some((number, i)),
                // the numbers of a key go on to the first copy
                (None, Some(_)) => drop(list[i].stored().map(Option::take)),
                (_, None) => {}
            }
            list.push(copy);
        }
        Ok(())
    }

    /// Adds the assets of an attached model.
    fn add_assets(
        &mut self,
        spec: &mut Spec,
        model: &Spec,
        (prefix, _): Ends<'_>,
        element: &Element<'_, '_>,
    ) -> Result<()> {
        let numbers = |mesh: &Mesh| {
            mesh.vertices.len() + mesh.normals.len() + mesh.texture.len() + mesh.faces.len()
        };
        let numbers: usize = model.meshes.iter().map(numbers).sum();
        let elevations = model.hfields.iter().map(|field| field.elevations.len());
        self.numbers += numbers + elevations.sum::<usize>();
        if self.numbers > MOST_NUMBERS {
            let reason = format!(
                "with all attached models, meshes and height fields have more than {MOST_NUMBERS} numbers in texts: use files"
            );
            return Err(element.error(reason));
        }
        macro_rules! add {
            ($list: ident) => {
                for asset in &model.$list {
                    if spec.$list.len() == MOST {
                        let reason = format!("more than {MOST} {}", stringify!($list));
                        return Err(element.error(reason));
                    }
                    let mut asset = asset.clone();
                    self.bytes += prefix.len() + asset.name.len();
                    asset.name.insert_str(0, prefix);
                    spec.$list.push(asset);
                }
            };
        }
        add!(meshes);
        add!(hfields);
        add!(textures);
        let first = spec.materials.len();
        add!(materials);
        for texture in spec.materials[first..]
            .iter_mut()
            .filter_map(|of| of.texture.as_mut())
        {
            texture.insert_str(0, prefix);
        }
        Ok(())
    }
}

/// Which element the first body in a part is. In a model with keyframes, joints of a frame belong to
/// a body.
fn first_body(part: &Element<'_, '_>) -> Result<Option<(usize, usize)>> {
    let mut waiting = vec![part.again()];
    while let Some(element) = waiting.pop() {
        match element.name() {
            "body" => return Ok(Some(element.identity())),
            "frame" | "replicate" => waiting.extend(element.children()?.into_iter().rev()),
            "joint" | "freejoint" => {
                let reason = "not supported in a frame that is attached from a model with keyframes: attach its body";
                return Err(element.error(reason));
            }
            _ => {}
        }
    }
    Ok(None)
}

/// Adds the keyframes of an attached model.
fn add_keys(
    spec: &mut Spec,
    model: &Spec,
    (number, start): (usize, Option<usize>),
    (prefix, _): Ends<'_>,
    element: &Element<'_, '_>,
) -> Result<()> {
    let Some(attached) = spec.attached.get(number) else {
        return Ok(());
    };
    let stored = Stored::of(spec, model, attached, start.unwrap_or(0), number);
    let stored = Rc::new(stored);
    for key in &model.keys {
        if spec.keys.len() + spec.attached_keys.len() >= MOST_KEYS {
            return Err(element.error(format!("more than {MOST_KEYS} keys are not supported")));
        }
        stored.check(key)?;
        let name = format!("{prefix}{}", key.name.as_deref().unwrap_or_default());
        spec.attached_keys.push(Key {
            name: Some(name).filter(|name| !name.is_empty()),
            stored: Some(stored.clone()),
            ..key.clone()
        });
    }
    Ok(())
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
