//! The tree of bodies: their parts, frames and copies.

use std::rc::Rc;

use super::MOST;
use super::attach::{Attach, Scope};
use super::orientation::{IDENTITY, Orientation, unit, within};
use super::spec::{Attached, Body, Frame, Inertial, Joint, Sleep, Spec};
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

/// What elements inherit from those around them.
#[derive(Clone)]
struct Around<'s, 'a, 'input> {
    /// The body that the elements belong to.
    id: usize,
    /// The default class of elements that name no class.
    class: usize,
    /// The frame that positions refer to.
    frame: Option<Frame>,
    /// What stands before names, if the elements are attached.
    prefix: Rc<str>,
    /// What stands before the names of assets: attached parts of the same model share them.
    assets: Rc<str>,
    /// The suffix of names, with the number of the copy.
    suffix: Rc<str>,
    /// The model that has the elements.
    scope: &'s Scope<'a, 'input>,
    /// Whether an element `attach` is around.
    attached: bool,
}

/// A `body`, `frame`, `replicate` or `attach` whose child elements are being read.
struct Open<'s, 'a, 'input> {
    element: Element<'a, 'input>,
    children: std::vec::IntoIter<Element<'a, 'input>>,
    around: Around<'s, 'a, 'input>,
    copies: Option<Copies>,
    /// The number of what is attached, if the element is.
    attached: Option<usize>,
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

impl<'s, 'a, 'input> Open<'s, 'a, 'input> {
    fn new(element: Element<'a, 'input>, around: Around<'s, 'a, 'input>) -> Result<Self> {
        Ok(Self {
            children: element.children()?.into_iter(),
            element,
            around,
            copies: None,
            attached: None,
        })
    }
}

impl<'s> Bodies<'s> {
    pub(crate) fn new(spec: &'s mut Spec) -> Self {
        Self {
            spec,
            elements: 0,
            geoms: 0,
            joints: 0,
            bytes: Bytes::default(),
        }
    }

    /// Reads the bodies of the world, each after its parent and before its children. The function
    /// does not recurse, because deep nesting would overflow the stack.
    pub(crate) fn read(&mut self, world: Element<'_, '_>, scope: &Scope<'_, '_>) -> Result<()> {
        let around = Around {
            id: 0,
            class: 0,
            frame: None,
            prefix: Rc::default(),
            assets: Rc::default(),
            suffix: Rc::default(),
            scope,
            attached: false,
        };
        let mut open = vec![Open::new(world, around)?];
        while let Some(outer) = open.last_mut() {
            let Some(child) = outer.children.next() else {
                if self.next_copy(outer)? {
                    self.count(&outer.element)?;
                    continue;
                }
                if let Some(done) = open.pop() {
                    if let Some(number) = done.attached {
                        let attached = &mut self.spec.attached[number];
                        attached.count = self.spec.bodies.len() - attached.first;
                    }
                    done.element.finish()?;
                }
                continue;
            };
            let around = &outer.around;
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
                "attach" => {
                    let attached = self.open_attached(child, around)?;
                    open.push(attached);
                }
                _ => self.read_part(child, &outer.element, around)?,
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
    fn open_body<'o, 'a, 'input>(
        &mut self,
        mut element: Element<'a, 'input>,
        around: &Around<'o, 'a, 'input>,
    ) -> Result<Open<'o, 'a, 'input>> {
        let classes = &around.scope.classes;
        let mut body = Body {
            place: element.place(),
            element: element.identity(),
            name: self.named(&mut element, around)?,
            compiler: classes.get(0).joint.compiler.clone(),
            parent: around.id,
            frame: around.frame,
            ..Body::default()
        };
        body.pos = element.numbers("pos")?.unwrap_or_default();
        body.orientation.read(&mut element)?;
        body.mocap = element.flag("mocap")?.unwrap_or(false);
        body.gravcomp = element.number("gravcomp")?.unwrap_or(0.0);
        let class = classes.named(&mut element, "childclass", around.class)?;
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
        let within = Around {
            id: self.spec.bodies.len() - 1,
            class,
            frame: None,
            ..around.clone()
        };
        Open::new(element, within)
    }

    /// Reads the attributes of a `frame`. Its child elements belong to the body that contains it.
    fn open_frame<'o, 'a, 'input>(
        &mut self,
        mut element: Element<'a, 'input>,
        around: &Around<'o, 'a, 'input>,
    ) -> Result<Open<'o, 'a, 'input>> {
        let classes = &around.scope.classes;
        let pos = element.numbers("pos")?.unwrap_or_default();
        let mut orientation = Orientation::default();
        orientation.read(&mut element)?;
        let own = (pos, orientation.resolve(&classes.get(0).joint.compiler));
        let (pos, quat) = within(around.frame, own);
        let class = classes.named(&mut element, "childclass", around.class)?;
        element.ignore("name");
        let around = Around {
            class,
            frame: Some((pos, unit(quat).0)),
            ..around.clone()
        };
        Open::new(element, around)
    }

    /// Opens what an element `attach` names: a body, a frame, or the world of a model.
    fn open_attached<'o, 'a, 'input>(
        &mut self,
        element: Element<'a, 'input>,
        around: &Around<'o, 'a, 'input>,
    ) -> Result<Open<'o, 'a, 'input>> {
        let (itself, identity) = (element.again(), element.identity());
        let attach = Attach::read(element, around.scope)?;
        let prefix = format!("{}{}", around.prefix, attach.prefix);
        self.bytes.add(prefix.len(), &itself, "prefix")?;
        let mut within = Around {
            class: 0,
            frame: Some(around.frame.unwrap_or(([0.0; 3], IDENTITY))),
            prefix: prefix.into(),
            scope: attach.scope(around.scope),
            attached: true,
            ..around.clone()
        };
        if attach.model.is_some() {
            within.assets = within.prefix.clone();
        }
        self.spec.copies = true;
        let is_new = |of: &Attached| of.element != identity;
        let number = self.spec.attached.len();
        // keyframes of the model hold for the first of several copies
        let records = !around.attached && self.spec.attached.iter().all(is_new);
        if records {
            self.spec.attached.push(Attached {
                element: identity,
                first: self.spec.bodies.len(),
                count: 0,
            });
        }
        let mut open = match attach.part {
            Some((ref part, class)) => {
                let part = part.again();
                within.class = class;
                match part.name() {
                    "body" => self.open_body(part, &within)?,
                    _ => self.open_frame(part, &within)?,
                }
            }
            None => {
                let children = attach.children(within.scope)?;
                let mut open = Open::new(itself, within)?;
                open.children = children.into_iter();
                // its attributes are read
                open.element.ignore("model prefix");
                open
            }
        };
        open.attached = records.then_some(number);
        Ok(open)
    }

    /// Reads the attributes of a `replicate`.
    fn open_copies<'o, 'a, 'input>(
        &mut self,
        mut element: Element<'a, 'input>,
        around: &Around<'o, 'a, 'input>,
    ) -> Result<Open<'o, 'a, 'input>> {
        let count = element
            .integer("count")?
            .ok_or_else(|| element.missing("count"))?;
        if count > MOST {
            let reason = format!("more than {MOST} copies");
            return Err(element.place().attribute("count", reason));
        }
        let (offset, euler) = (element.numbers("offset")?, element.numbers("euler")?);
        let classes = &around.scope.classes;
        let class = classes.named(&mut element, "childclass", around.class)?;
        let separator = element.text("sep")?.unwrap_or_default();
        // MuJoCo takes this attribute and does nothing with it
        element.ignore("prefix");
        self.spec.copies = true;
        let inner = Around {
            class,
            ..around.clone()
        };
        let mut open = Open::new(element, inner)?;
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
    fn next_copy(&mut self, open: &mut Open<'_, '_, '_>) -> Result<bool> {
        let Some(copies) = &mut open.copies else {
            return Ok(false);
        };
        if copies.next == copies.count {
            return Ok(false);
        }
        let number = copies.next;
        copies.next += 1;
        let euler = copies.euler.map(|angle| number as f64 * angle);
        let compiler = &open.around.scope.classes.get(0).joint.compiler;
        let quat = Orientation::of_euler(euler).resolve(compiler);
        let own = (copies.pos, quat);
        // MuJoCo turns the offset to the next copy by this copy's Euler angles
        copies.pos = add(
            copies.pos,
            rotate(&InTurn::quat_to_mat(quat), copies.offset),
        );
        let (pos, quat) = within(copies.outer.0, own);
        open.around.frame = Some((pos, unit(quat).0));
        let digits = copies.count.to_string().len();
        let (separator, outer) = (&copies.separator, &copies.outer.1);
        let length = separator.len() + digits + outer.len();
        self.bytes.add(length, &open.element, "sep")?;
        open.around.suffix = format!("{separator}{number:0digits$}{outer}").into();
        open.children = open.element.children()?.into_iter();
        Ok(true)
    }

    /// The name of an element, with the prefix of its model and the suffix of its copy.
    fn named(
        &mut self,
        element: &mut Element<'_, '_>,
        around: &Around<'_, '_, '_>,
    ) -> Result<Option<String>> {
        let mut name = element.text("name")?;
        self.complete(&mut name, element, "name", (&around.prefix, &around.suffix))?;
        Ok(name)
    }

    /// Adds a prefix and a suffix to a name, if there is one.
    fn complete(
        &mut self,
        name: &mut Option<String>,
        element: &Element<'_, '_>,
        attribute: &str,
        (prefix, suffix): (&str, &str),
    ) -> Result<()> {
        if let Some(name) = name {
            let length = prefix.len() + name.len() + suffix.len();
            self.bytes.add(length, element, attribute)?;
            name.insert_str(0, prefix);
            name.push_str(suffix);
        }
        Ok(())
    }

    /// Reads an element of a body that contains no bodies.
    fn read_part(
        &mut self,
        mut child: Element<'_, '_>,
        outer: &Element<'_, '_>,
        around: &Around<'_, '_, '_>,
    ) -> Result<()> {
        const IN_BODIES: [&str; 11] = [
            "body",
            "frame",
            "replicate",
            "attach",
            "geom",
            "site",
            "camera",
            "light",
            "joint",
            "freejoint",
            "inertial",
        ];
        let (id, frame, classes) = (around.id, around.frame, &around.scope.classes);
        // the last three are not allowed in the world
        let supported = &IN_BODIES[..if id == 0 { 8 } else { 11 }];
        if !supported.contains(&child.name()) {
            return Err(outer.unsupported(&child, supported));
        }
        let class = match child.name() {
            "freejoint" | "inertial" => around.class,
            _ => classes.named(&mut child, "class", around.class)?,
        };
        let class = classes.get(class);
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
                for (attribute, asset) in [
                    ("material", &mut geom.material),
                    ("mesh", &mut geom.mesh),
                    ("hfield", &mut geom.hfield),
                ] {
                    self.complete(asset, &child, attribute, (&around.assets, ""))?;
                }
                self.spec.bodies[id].geoms.push(geom);
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
                let ends = (&*around.prefix, &*around.suffix);
                self.complete(&mut camera.target, &child, "target", ends)?;
                let parts = &mut self.spec.bodies[id];
                parts.cameras.push(camera);
            }
            _ => {
                let mut light = class.light.clone();
                (light.name, light.frame) = (name, frame);
                light.read(&mut child)?;
                let ends = (&*around.prefix, &*around.suffix);
                self.complete(&mut light.target, &child, "target", ends)?;
                let parts = &mut self.spec.bodies[id];
                parts.lights.push(light);
            }
        }
        child.finish_without_children()
    }
}
