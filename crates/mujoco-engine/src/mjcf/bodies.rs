//! The tree of bodies: their parts, frames and copies.

use std::rc::Rc;

use super::MOST;
use super::defaults::Classes;
use super::orientation::{Orientation, unit, within};
use super::spec::{Body, Frame, Inertial, Joint, Sleep, Spec};
use super::xml::Element;
use crate::Result;
use crate::math::spatial::{InTurn, Order, add, rotate};

/// The largest number of elements in bodies, with the copies that `replicate` makes.
const MOST_ELEMENTS: usize = 200_000;
/// The largest size in bytes of all names of elements in bodies, with the suffixes of copies.
const MOST_BYTES: usize = 8 << 20;

/// Reads the bodies of the world.
pub(crate) struct Bodies<'s> {
    spec: &'s mut Spec,
    classes: &'s Classes,
    elements: usize,
    geoms: usize,
    joints: usize,
    bytes: Bytes,
}

/// The size in bytes of all names so far.
#[derive(Default)]
struct Bytes(usize);

impl Bytes {
    /// Counts a text before it is copied, which is or goes into an attribute of an element.
    fn add(&mut self, count: usize, element: &Element<'_, '_>, attribute: &str) -> Result<()> {
        self.0 = self.0.saturating_add(count);
        if self.0 > MOST_BYTES {
            let reason = format!(
                "the names of all elements, with their copies, have more than {MOST_BYTES} bytes: use shorter names or fewer copies"
            );
            return Err(element.place().attribute(attribute, reason));
        }
        Ok(())
    }
}

/// A `body`, `frame` or `replicate` whose child elements are being read.
struct Open<'a, 'input> {
    element: Element<'a, 'input>,
    children: std::vec::IntoIter<Element<'a, 'input>>,
    /// The body that the child elements belong to.
    id: usize,
    /// The default class of child elements that name no class.
    class: usize,
    /// The frame that positions of child elements refer to.
    frame: Option<Frame>,
    /// The suffix of names, with the number of the copy.
    suffix: Rc<str>,
    copies: Option<Copies>,
}

/// The copies that an element `replicate` makes.
struct Copies {
    count: usize,
    next: usize,
    offset: [f64; 3],
    euler: [f64; 3],
    separator: String,
    /// The position of the next copy, relative to the parent of the `replicate`.
    pos: [f64; 3],
    /// The frame and the suffix of the parent of the `replicate`.
    outer: (Option<Frame>, Rc<str>),
}

impl<'a, 'input> Open<'a, 'input> {
    fn new(element: Element<'a, 'input>, id: usize, class: usize) -> Result<Self> {
        Ok(Self {
            children: element.children()?.into_iter(),
            element,
            id,
            class,
            frame: None,
            suffix: Rc::default(),
            copies: None,
        })
    }
}

impl<'s> Bodies<'s> {
    pub(crate) fn new(spec: &'s mut Spec, classes: &'s Classes) -> Self {
        Self {
            spec,
            classes,
            elements: 0,
            geoms: 0,
            joints: 0,
            bytes: Bytes::default(),
        }
    }

    /// Reads the bodies of the world, each after its parent and before its children. The function
    /// does not recurse, because deep nesting would overflow the stack.
    pub(crate) fn read(mut self, world: Element<'_, '_>) -> Result<()> {
        let mut open = vec![Open::new(world, 0, 0)?];
        while let Some(around) = open.last_mut() {
            let Some(child) = around.children.next() else {
                if self.next_copy(around)? {
                    self.count(&around.element)?;
                    continue;
                }
                if let Some(done) = open.pop() {
                    done.element.finish()?;
                }
                continue;
            };
            self.count(&child)?;
            match child.name() {
                "body" => {
                    let body = self.open_body(child, around)?;
                    open.push(body);
                }
                "frame" => {
                    let frame = self.open_frame(child, around)?;
                    open.push(frame);
                }
                "replicate" => {
                    let copies = self.open_copies(child, around)?;
                    open.push(copies);
                }
                _ => self.read_part(child, around)?,
            }
        }
        Ok(())
    }

    /// Counts an element.
    fn count(&mut self, element: &Element<'_, '_>) -> Result<()> {
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            let reason = format!("more than {MOST_ELEMENTS} elements are not supported");
            return Err(element.error(reason));
        }
        Ok(())
    }

    /// Reads the attributes of a body.
    fn open_body<'a, 'input>(
        &mut self,
        mut element: Element<'a, 'input>,
        around: &Open<'_, '_>,
    ) -> Result<Open<'a, 'input>> {
        let mut body = Body {
            place: element.place(),
            name: self.named(&mut element, around)?,
            parent: around.id,
            frame: around.frame,
            ..Body::default()
        };
        body.pos = element.numbers("pos")?.unwrap_or_default();
        body.orientation.read(&mut element)?;
        body.mocap = element.flag("mocap")?.unwrap_or(false);
        body.gravcomp = element.number("gravcomp")?.unwrap_or(0.0);
        let class = self
            .classes
            .named(&mut element, "childclass", around.class)?;
        let policies = [
            ("auto", Sleep::Auto),
            ("never", Sleep::Never),
            ("allowed", Sleep::Allowed),
            ("init", Sleep::Init),
        ];
        element.set_keyword("sleep", &policies, &mut body.sleep)?;
        element.ignore("user");
        self.spec.bodies.push(body);
        if self.spec.bodies.len() > MOST {
            return Err(element.error(format!("more than {MOST} bodies are not supported")));
        }
        let mut open = Open::new(element, self.spec.bodies.len() - 1, class)?;
        open.suffix = around.suffix.clone();
        Ok(open)
    }

    /// Reads the attributes of a `frame`. Its child elements belong to the body that contains it.
    fn open_frame<'a, 'input>(
        &mut self,
        mut element: Element<'a, 'input>,
        around: &Open<'_, '_>,
    ) -> Result<Open<'a, 'input>> {
        let pos = element.numbers("pos")?.unwrap_or_default();
        let mut orientation = Orientation::default();
        orientation.read(&mut element)?;
        let own = (pos, orientation.resolve(&self.spec.compiler));
        let (pos, quat) = within(around.frame, own);
        let class = self
            .classes
            .named(&mut element, "childclass", around.class)?;
        element.ignore("name");
        let mut open = Open::new(element, around.id, class)?;
        open.frame = Some((pos, unit(quat).0));
        open.suffix = around.suffix.clone();
        Ok(open)
    }

    /// Reads the attributes of a `replicate`.
    fn open_copies<'a, 'input>(
        &mut self,
        mut element: Element<'a, 'input>,
        around: &Open<'_, '_>,
    ) -> Result<Open<'a, 'input>> {
        let count = element
            .integer("count")?
            .ok_or_else(|| element.missing("count"))?;
        if count > MOST {
            let reason = format!("more than {MOST} copies");
            return Err(element.place().attribute("count", reason));
        }
        let (offset, euler) = (element.numbers("offset")?, element.numbers("euler")?);
        let class = self
            .classes
            .named(&mut element, "childclass", around.class)?;
        let separator = element.text("sep")?.unwrap_or_default();
        // MuJoCo takes this attribute and does nothing with it
        element.ignore("prefix");
        self.spec.replicates = true;
        let mut open = Open::new(element, around.id, class)?;
        open.children = Vec::new().into_iter();
        open.copies = Some(Copies {
            count,
            next: 0,
            offset: offset.unwrap_or_default(),
            euler: euler.unwrap_or_default(),
            separator,
            pos: [0.0; 3],
            outer: (around.frame, around.suffix.clone()),
        });
        Ok(open)
    }

    /// Begins the next copy; returns whether there is one.
    fn next_copy(&mut self, open: &mut Open<'_, '_>) -> Result<bool> {
        let Some(copies) = &mut open.copies else {
            return Ok(false);
        };
        if copies.next == copies.count {
            return Ok(false);
        }
        let number = copies.next;
        copies.next += 1;
        let euler = copies.euler.map(|angle| number as f64 * angle);
        let quat = Orientation::of_euler(euler).resolve(&self.spec.compiler);
        let own = (copies.pos, quat);
        // MuJoCo turns the offset to the next copy by this copy's Euler angles
        copies.pos = add(
            copies.pos,
            rotate(&InTurn::quat_to_mat(quat), copies.offset),
        );
        let (pos, quat) = within(copies.outer.0, own);
        open.frame = Some((pos, unit(quat).0));
        let digits = copies.count.to_string().len();
        let (separator, outer) = (&copies.separator, &copies.outer.1);
        let length = separator.len() + digits + outer.len();
        self.bytes.add(length, &open.element, "sep")?;
        open.suffix = format!("{separator}{number:0digits$}{outer}").into();
        open.children = open.element.children()?.into_iter();
        Ok(true)
    }

    /// The name of an element, with the suffix of its copy.
    fn named(
        &mut self,
        element: &mut Element<'_, '_>,
        around: &Open<'_, '_>,
    ) -> Result<Option<String>> {
        let Some(name) = element.text("name")? else {
            return Ok(None);
        };
        let length = name.len() + around.suffix.len();
        self.bytes.add(length, element, "name")?;
        Ok(Some(name + &around.suffix))
    }

    /// Adds the suffix of the copy to the target of a camera or light.
    fn suffix_target(
        &mut self,
        target: &mut Option<String>,
        element: &Element<'_, '_>,
        around: &Open<'_, '_>,
    ) -> Result<()> {
        if let Some(name) = target {
            let length = name.len() + around.suffix.len();
            self.bytes.add(length, element, "target")?;
            name.push_str(&around.suffix);
        }
        Ok(())
    }

    /// Reads an element of a body that contains no bodies.
    fn read_part(&mut self, mut child: Element<'_, '_>, around: &Open<'_, '_>) -> Result<()> {
        const IN_BODIES: [&str; 10] = [
            "body",
            "frame",
            "replicate",
            "geom",
            "site",
            "camera",
            "light",
            "joint",
            "freejoint",
            "inertial",
        ];
        let (id, frame) = (around.id, around.frame);
        // the last three are not allowed in the world
        let supported = &IN_BODIES[..if id == 0 { 7 } else { 10 }];
        if !supported.contains(&child.name()) {
            return Err(around.element.unsupported(&child, supported));
        }
        let class = match child.name() {
            "freejoint" | "inertial" => around.class,
            _ => self.classes.named(&mut child, "class", around.class)?,
        };
        let class = self.classes.get(class);
        let name = match child.name() {
            "inertial" => None,
            _ => self.named(&mut child, around)?,
        };
        match child.name() {
            "geom" => self.geoms += 1,
            "joint" | "freejoint" => self.joints += 1,
            _ => {}
        }
        if self.geoms.max(self.joints) > MOST {
            let reason =
                format!("more than {MOST} bodies, geoms or degrees of freedom are not supported");
            return Err(child.error(reason));
        }
        let parts = &mut self.spec.bodies[id];
        match child.name() {
            "geom" => {
                let mut geom = class.geom.clone();
                (geom.name, geom.frame) = (name, frame);
                geom.read(&mut child)?;
                parts.geoms.push(geom);
            }
            "joint" => {
                let mut joint = class.joint.clone();
                (joint.name, joint.frame) = (name, frame);
                joint.read(&mut child)?;
                parts.joints.push(joint);
            }
            "freejoint" => {
                let joint = Joint::read_free(child)?;
                parts.joints.push(Joint { name, ..joint });
                return Ok(());
            }
            "inertial" if parts.inertial.is_some() => {
                return Err(child.error("the body has one already"));
            }
            "inertial" => {
                parts.inertial = Some(Inertial::read(child)?);
                return Ok(());
            }
            "site" => {
                let mut site = class.site.clone();
                (site.name, site.frame) = (name, frame);
                site.read(&mut child)?;
                parts.sites.push(site);
            }
            "camera" => {
                let mut camera = class.camera.clone();
                (camera.name, camera.frame) = (name, frame);
                camera.read(&mut child)?;
                self.suffix_target(&mut camera.target, &child, around)?;
                let parts = &mut self.spec.bodies[id];
                parts.cameras.push(camera);
            }
            _ => {
                let mut light = class.light.clone();
                (light.name, light.frame) = (name, frame);
                light.read(&mut child)?;
                self.suffix_target(&mut light.target, &child, around)?;
                let parts = &mut self.spec.bodies[id];
                parts.lights.push(light);
            }
        }
        child.finish_without_children()
    }
}
