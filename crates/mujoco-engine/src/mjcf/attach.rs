//! Models within models: what an element `attach` names.

use super::defaults::Classes;
use super::spec::Spec;
use super::xml::Element;
use crate::Result;

/// A model as its texts give it, and what others need to attach it.
pub(crate) struct Parsed<'a, 'input> {
    pub(crate) spec: Spec,
    pub(crate) scope: Scope<'a, 'input>,
}

/// What the names in the bodies of a model refer to.
#[derive(Default)]
pub(crate) struct Scope<'a, 'input> {
    pub(crate) classes: Classes,
    /// The elements `worldbody`.
    pub(crate) worlds: Vec<Element<'a, 'input>>,
    /// The models among the assets.
    pub(crate) models: Vec<(String, Parsed<'a, 'input>)>,
}

/// What an element `attach` names.
pub(crate) struct Attach<'s, 'a, 'input> {
    pub(crate) prefix: String,
    /// The model; none for a part of the same one.
    pub(crate) model: Option<&'s Parsed<'a, 'input>>,
    /// The body or frame, and the class of elements around it; none for all that is in the world.
    pub(crate) part: Option<(Element<'a, 'input>, usize)>,
}

impl<'s, 'a, 'input> Attach<'s, 'a, 'input> {
    pub(crate) fn read(
        mut element: Element<'a, 'input>,
        scope: &'s Scope<'a, 'input>,
    ) -> Result<Self> {
        let (place, itself) = (element.place(), element.again());
        let model = element.text("model")?;
        let (body, frame) = (element.text("body")?, element.text("frame")?);
        if !element.has("prefix") {
            return Err(element.missing("prefix"));
        }
        let prefix = element.text("prefix")?.unwrap_or_default();
        element.finish_without_children()?;
        let part = match (body, frame) {
            (Some(_), Some(_)) => return Err(place.attribute("frame", "does not go with body")),
            (Some(name), None) => Some(("body", name)),
            (None, Some(name)) => Some(("frame", name)),
            (None, None) if model.is_some() => None,
            (None, None) => {
                let reason = "missing: without model, it must be given (or frame)";
                return Err(place.attribute("body", reason));
            }
        };
        let model = match model {
            None => None,
            Some(name) => match scope.models.iter().find(|(of, _)| *of == name) {
                Some((_, model)) => Some(model),
                None => {
                    let reason = format!("there is no model {name:?} among the assets");
                    return Err(place.attribute("model", reason));
                }
            },
        };
        let Some((kind, name)) = part else {
            return Ok(Self {
                prefix,
                model,
                part: None,
            });
        };
        let (within, before) = match model {
            Some(model) => (&model.scope, None),
            None => (scope, Some(&itself)),
        };
        let Some(part) = within.find(kind, &name, before)? else {
            let reason = match model {
                Some(_) => format!("the model has no {kind} {name:?}"),
                None => format!("there is no {kind} {name:?} before this element"),
            };
            return Err(place.attribute(kind, reason));
        };
        if model.is_none() && part.0.contains(&itself)? {
            let reason = format!("{name:?} would be a part of itself");
            return Err(place.attribute(kind, reason));
        }
        Ok(Self {
            prefix,
            model,
            part: Some(part),
        })
    }

    /// The elements in the attached part; `scope` is that of the part.
    pub(crate) fn children(&self, scope: &Scope<'a, 'input>) -> Result<Vec<Element<'a, 'input>>> {
        if let Some((part, _)) = &self.part {
            return part.children();
        }
        let mut children = Vec::new();
        for world in &scope.worlds {
            children.extend(world.children()?);
        }
        Ok(children)
    }

    /// What the names in the attached part refer to; `scope` is that of the element.
    pub(crate) fn scope(&self, scope: &'s Scope<'a, 'input>) -> &'s Scope<'a, 'input> {
        self.model.map_or(scope, |model| &model.scope)
    }
}

impl<'a, 'input> Scope<'a, 'input> {
    /// The body or frame of that name, and the class of elements around it; of those before an
    /// element, if that is given. Parts of a `replicate` or of an attached model are none.
    fn find(
        &self,
        kind: &str,
        name: &str,
        before: Option<&Element<'_, '_>>,
    ) -> Result<Option<(Element<'a, 'input>, usize)>> {
        let worlds = self.worlds.iter().rev();
        let mut waiting: Vec<_> = worlds.map(|world| (world.again(), 0)).collect();
        while let Some((mut element, class)) = waiting.pop() {
            if before.is_some_and(|before| before.identity() == element.identity()) {
                return Ok(None);
            }
            if element.name() == kind && element.text("name")?.as_deref() == Some(name) {
                return Ok(Some((element.again(), class)));
            }
            if ["worldbody", "body", "frame"].contains(&element.name()) {
                let class = self.classes.named(&mut element, "childclass", class)?;
                let children = element.children()?.into_iter().rev();
                waiting.extend(children.map(|child| (child, class)));
            }
        }
        Ok(None)
    }
}
