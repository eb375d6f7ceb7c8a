//! From text to [`Spec`]: the sections of a model and the tree of its bodies.

use roxmltree::{Document, ParsingOptions};

use super::defaults::Classes;
use super::spec::{
    Body, Camera, Exclude, Geom, Inertial, Joint, Key, Light, Material, Motor, Site, Spec, Tendon,
};
use super::xml::{Element, Lines};
use crate::model::{Integrator, Solver};
use crate::{Error, Result};

/// The longest text that is read, in bytes.
pub(super) const MAX_LEN: usize = 8 << 20;
/// The most nodes (elements, texts and comments) that are read.
const MAX_NODES: u32 = 200_000;
/// The most attributes of an element, and the most namespaces: the parser compares each with all
/// others.
const MAX_ATTRIBUTES: usize = 1000;
const MAX_NAMESPACES: usize = 10;

const SECTIONS: [&str; 13] = [
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
    "tendon",
    "actuator",
    "keyframe",
];

/// Reads a model. Sections may come in any order and repeat.
pub(super) fn read(text: &str) -> Result<Spec> {
    let not_xml = |line: u32, reason: String| Error::Mjcf {
        line,
        element: "mujoco".into(),
        attribute: None,
        reason,
    };
    if text.len() > MAX_LEN {
        return Err(not_xml(
            1,
            format!("the text is too long: the limit is {MAX_LEN} bytes"),
        ));
    }
    check_tags(text).map_err(|(line, reason)| not_xml(line, reason))?;
    let options = ParsingOptions {
        allow_dtd: false,
        nodes_limit: MAX_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options)
        .map_err(|error| not_xml(error.pos().row, format!("the text is not XML: {error}")))?;
    let lines = Lines::of(text);
    let mut root = Element::new(document.root_element(), &lines);
    if root.name() != "mujoco" {
        return Err(root.error("not supported: the outermost element is <mujoco>"));
    }
    let mut spec = Spec {
        name: root.text("model").unwrap_or_default(),
        ..Spec::default()
    };
    let mut reader = Reader {
        spec: &mut spec,
        classes: Classes::default(),
    };
    reader.read_sections(&root)?;
    root.finish()?;
    Ok(spec)
}

/// Refuses texts that the parser would read slowly; the error names the line.
fn check_tags(text: &str) -> std::result::Result<(), (u32, String)> {
    let mut rest = text;
    let mut namespaces = 0;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        if let Some(comment) = rest.strip_prefix("!--") {
            rest = comment.find("-->").map_or("", |end| &comment[end..]);
            continue;
        }
        let tag = &rest[..rest.find('<').unwrap_or(rest.len())];
        namespaces += tag.matches("xmlns").count();
        let reason = if tag.matches('=').count() > MAX_ATTRIBUTES {
            format!("an element has more than {MAX_ATTRIBUTES} attributes")
        } else if namespaces > MAX_NAMESPACES {
            format!("the text has more than {MAX_NAMESPACES} namespaces")
        } else {
            continue;
        };
        let before = &text[..text.len() - rest.len()];
        return Err((before.matches('\n').count() as u32 + 1, reason));
    }
    Ok(())
}

struct Reader<'s> {
    spec: &'s mut Spec,
    classes: Classes,
}

/// A body whose parts are being read.
struct OpenBody<'a, 'input> {
    element: Element<'a, 'input>,
    children: std::vec::IntoIter<Element<'a, 'input>>,
    id: usize,
    /// The class of the parts that name none.
    class: usize,
}

impl Reader<'_> {
    fn read_sections(&mut self, root: &Element<'_, '_>) -> Result<()> {
        for section in root.children()? {
            match section.name() {
                "compiler" => self.spec.compiler.read(section)?,
                "option" => self.read_option(section)?,
                "size" => self.read_size(section)?,
                "statistic" => self.read_statistic(section)?,
                // read and ignored: only MuJoCo's own viewer shows it
                "visual" | "custom" => {}
                name if SECTIONS.contains(&name) => {}
                _ => return Err(root.unsupported(&section, &SECTIONS)),
            }
        }
        for section in root
            .children()?
            .into_iter()
            .filter(|section| section.name() == "default")
        {
            self.classes.read(section)?;
        }
        let place = root.place();
        self.spec.bodies.push(Body {
            name: Some("world".to_owned()),
            place,
            ..Body::default()
        });
        for section in root.children()? {
            match section.name() {
                "asset" => self.read_asset(section)?,
                "worldbody" => self.read_bodies(section)?,
                "contact" => self.read_contact(section)?,
                "tendon" => self.read_tendons(section)?,
                "actuator" => self.read_actuators(section)?,
                "keyframe" => self.read_keys(section)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn read_option(&mut self, mut element: Element<'_, '_>) -> Result<()> {
        let place = element.place();
        let option = &mut self.spec.option;
        if let Some(timestep) = element.number("timestep")? {
            if timestep <= 0.0 {
                return Err(place.attribute("timestep", "must be positive"));
            }
            option.timestep = timestep;
        }
        if let Some(gravity) = element.numbers("gravity")? {
            option.gravity = gravity;
        }
        if let Some(wind) = element.numbers("wind")? {
            option.wind = wind;
        }
        if let Some(density) = element.non_negative("density")? {
            option.density = density;
        }
        if let Some(viscosity) = element.non_negative("viscosity")? {
            option.viscosity = viscosity;
        }
        let integrators = [("Euler", Integrator::Euler), ("RK4", Integrator::RK4)];
        if let Some(integrator) = element.keyword("integrator", &integrators)? {
            option.integrator = integrator;
        }
        if let Some(solver) = element.keyword(
            "solver",
            &[("Newton", Solver::Newton), ("PGS", Solver::PGS)],
        )? {
            option.solver = solver;
        }
        if let Some(iterations) = element.integer("iterations")? {
            option.iterations = iterations;
        }
        if let Some(iterations) = element.integer("ls_iterations")? {
            option.ls_iterations = iterations;
        }
        if let Some(tolerance) = element.non_negative("tolerance")? {
            option.tolerance = tolerance;
        }
        element.keyword("cone", &[("pyramidal", ())])?;
        // how the Jacobian is stored in MuJoCo; the results are the same
        if let Some(jacobian) =
            element.keyword("jacobian", &[("dense", 0), ("sparse", 1), ("auto", 2)])?
        {
            option.jacobian = jacobian;
        }
        if element
            .number("impratio")?
            .is_some_and(|ratio| ratio != 1.0)
        {
            return Err(place.attribute("impratio", "only 1 is supported"));
        }
        element.finish_without_children()
    }

    /// Sizes of MuJoCo's buffers are of no use here; `nkey` makes keyframes.
    fn read_size(&mut self, mut element: Element<'_, '_>) -> Result<()> {
        const MAX_KEYS: usize = 1000;
        if let Some(nkey) = element.integer("nkey")? {
            if nkey > MAX_KEYS {
                return Err(element
                    .place()
                    .attribute("nkey", format!("more than {MAX_KEYS}")));
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
            let number = element.number(name)?;
            if number.is_some_and(|x| x <= 0.0) {
                return Err(element.place().attribute(name, "must be positive"));
            }
            *value = number.or(*value);
        }
        statistic.center = element.numbers("center")?.or(statistic.center);
        Ok(())
    }

    /// Keeps the colours of materials, and ignores everything else that is only looked at.
    fn read_asset(&mut self, section: Element<'_, '_>) -> Result<()> {
        for mut child in section.children()? {
            match child.name() {
                "material" => {
                    let name = child.required_text("name")?;
                    let rgba = child.numbers("rgba")?.unwrap_or([1.0; 4]);
                    self.spec.materials.push(Material { name, rgba });
                }
                "texture" => {}
                _ => return Err(section.unsupported(&child, &["material", "texture"])),
            }
        }
        section.finish()
    }

    /// Reads the bodies of the world, each after its parent and before its children. Not by
    /// recursion, which deep nesting would lead beyond the end of the stack.
    fn read_bodies(&mut self, world: Element<'_, '_>) -> Result<()> {
        let children = world.children()?.into_iter();
        let mut open = vec![OpenBody {
            element: world,
            children,
            id: 0,
            class: 0,
        }];
        while let Some(body) = open.last_mut() {
            match body.children.next() {
                Some(child) if child.name() == "body" => {
                    let (parent, class) = (body.id, body.class);
                    open.push(self.open_body(child, parent, class)?);
                }
                Some(child) => self.read_part(child, body)?,
                None => {
                    if let Some(body) = open.pop() {
                        body.element.finish()?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Reads the attributes of a body.
    fn open_body<'a, 'input>(
        &mut self,
        mut element: Element<'a, 'input>,
        parent: usize,
        class: usize,
    ) -> Result<OpenBody<'a, 'input>> {
        let mut body = Body {
            place: element.place(),
            name: element.text("name"),
            parent,
            ..Body::default()
        };
        if let Some(pos) = element.numbers("pos")? {
            body.pos = pos;
        }
        body.orientation.read(&mut element)?;
        let class = self.classes.named(&mut element, "childclass", class)?;
        element.ignore(&["user"]);
        self.spec.bodies.push(body);
        Ok(OpenBody {
            children: element.children()?.into_iter(),
            element,
            id: self.spec.bodies.len() - 1,
            class,
        })
    }

    /// Reads an element of a body that is not a body.
    fn read_part(&mut self, mut child: Element<'_, '_>, body: &OpenBody<'_, '_>) -> Result<()> {
        const IN_BODIES: [&str; 8] = [
            "body",
            "geom",
            "joint",
            "freejoint",
            "inertial",
            "site",
            "camera",
            "light",
        ];
        const IN_THE_WORLD: [&str; 5] = ["body", "geom", "site", "camera", "light"];
        let OpenBody {
            ref element,
            id,
            class,
            ..
        } = *body;
        let supported = if id == 0 {
            &IN_THE_WORLD[..]
        } else {
            &IN_BODIES
        };
        if !supported.contains(&child.name()) {
            return Err(element.unsupported(&child, supported));
        }
        let parts = &mut self.spec.bodies[id];
        match child.name() {
            "geom" => {
                let class = self.classes.named(&mut child, "class", class)?;
                let mut geom = Geom {
                    name: child.text("name"),
                    ..self.classes.get(class).geom.clone()
                };
                geom.read(&mut child)?;
                child.finish_without_children()?;
                parts.geoms.push(geom);
            }
            "joint" => {
                let class = self.classes.named(&mut child, "class", class)?;
                let mut joint = Joint {
                    name: child.text("name"),
                    ..self.classes.get(class).joint.clone()
                };
                joint.read(&mut child)?;
                child.finish_without_children()?;
                parts.joints.push(joint);
            }
            "freejoint" => parts.joints.push(Joint::read_free(child)?),
            "inertial" if parts.inertial.is_some() => {
                return Err(child.error("the body has one already"));
            }
            "inertial" => parts.inertial = Some(Inertial::read(child)?),
            "site" => {
                let class = self.classes.named(&mut child, "class", class)?;
                let mut site = Site {
                    name: child.text("name"),
                    ..self.classes.get(class).site.clone()
                };
                site.read(&mut child)?;
                child.finish_without_children()?;
                parts.sites.push(site);
            }
            "camera" => parts.cameras.push(Camera::read(child)?),
            _ => parts.lights.push(Light::read(child)?),
        }
        Ok(())
    }

    fn read_contact(&mut self, section: Element<'_, '_>) -> Result<()> {
        for child in section.children()? {
            match child.name() {
                "exclude" => self.spec.excludes.push(Exclude::read(child)?),
                _ => return Err(section.unsupported(&child, &["exclude"])),
            }
        }
        section.finish()
    }

    fn read_tendons(&mut self, section: Element<'_, '_>) -> Result<()> {
        for child in section.children()? {
            match child.name() {
                "fixed" => self.spec.tendons.push(Tendon::read(child)?),
                _ => return Err(section.unsupported(&child, &["fixed"])),
            }
        }
        section.finish()
    }

    fn read_actuators(&mut self, section: Element<'_, '_>) -> Result<()> {
        for mut child in section.children()? {
            if child.name() != "motor" {
                return Err(section.unsupported(&child, &["motor"]));
            }
            let class = self.classes.named(&mut child, "class", 0)?;
            let mut motor = Motor {
                name: child.text("name"),
                ..self.classes.get(class).motor.clone()
            };
            motor.read(&mut child)?;
            child.finish_without_children()?;
            self.spec.motors.push(motor);
        }
        section.finish()
    }

    fn read_keys(&mut self, section: Element<'_, '_>) -> Result<()> {
        for child in section.children()? {
            match child.name() {
                "key" => self.spec.keys.push(Key::read(child)?),
                _ => return Err(section.unsupported(&child, &["key"])),
            }
        }
        section.finish()
    }
}
