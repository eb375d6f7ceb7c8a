//! Families: the environments that one crate registers, under one heading.

use std::collections::BTreeMap;

use super::{Need, Registration};

/// The heading of environments that no crate registers.
const AT_RUN_TIME: &str = "registered at run time";

/// A family of environments: those that one crate registers. A crate declares its family with
/// [`family!`](crate::family!); lists, books and galleries show families in their
/// [order](Self::order).
///
/// Each method sets the field of its name.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Family {
    /// The heading, such as "Classic control".
    pub name: &'static str,
    /// The position among families, from small to large; families with equal positions are ordered
    /// by name. A crate that declares no family has the position 0.
    pub order: u32,
    /// The book's page about the family, in the folder `docs`.
    pub page: Option<&'static str>,
    /// A requirement of all its environments outside the crates, such as ROMs.
    pub needs: Option<Need>,
    /// The name of the package; empty for environments that are registered at run time.
    pub package: &'static str,
}

impl Family {
    /// A family with its name and its position.
    pub const fn new(name: &'static str, order: u32) -> Self {
        Self {
            name,
            order,
            page: None,
            needs: None,
            package: "",
        }
    }

    /// The book's page about the family, in the folder `docs`.
    #[must_use]
    pub const fn page(mut self, page: &'static str) -> Self {
        self.page = Some(page);
        self
    }

    /// Declares [an external requirement](Registration::needs) of all its environments.
    #[must_use]
    pub const fn needs(mut self, what: &'static str, is_met: fn() -> bool) -> Self {
        self.needs = Some(Need::new(what, is_met));
        self
    }

    /// The package; [`family!`](crate::family!) fills it in.
    #[must_use]
    pub const fn package(mut self, package: &'static str) -> Self {
        self.package = package;
        self
    }

    /// The family of a package: the declared one, or one with the package's name.
    pub(super) fn of(package: &'static str) -> Self {
        let mut declared = inventory::iter::<Self>.into_iter();
        let declared = declared.find(|family| family.package == package);
        declared.copied().unwrap_or_else(|| {
            let name = if package.is_empty() {
                AT_RUN_TIME
            } else {
                package
            };
            Self::new(name, 0).package(package)
        })
    }
}

inventory::collect!(Family);

/// Groups registrations by family, in the order of the families. Within a family, the order of
/// `registrations` remains.
pub fn by_family(
    registrations: impl IntoIterator<Item = Registration>,
) -> Vec<(Family, Vec<Registration>)> {
    let mut groups = BTreeMap::new();
    for registration in registrations {
        let family = registration.family();
        let key = (family.order, family.name, family.package);
        let (_, group) = groups.entry(key).or_insert_with(|| (family, Vec::new()));
        group.push(registration);
    }
    groups.into_values().collect()
}

/// Groups registrations by page, in the order of the paths of modules: the ids that one module
/// registers share a page of the book, and a card of the gallery. Within a group, the order of
/// `registrations` remains.
///
/// Environments that have no page, because they have an external requirement or were registered at
/// run time, form a group for each name.
pub fn by_page(registrations: impl IntoIterator<Item = Registration>) -> Vec<Vec<Registration>> {
    let mut groups = BTreeMap::<_, Vec<_>>::new();
    for registration in registrations {
        let module = registration.source.module;
        let has_page = registration.needs.is_none() && !module.is_empty();
        let name = (!has_page).then(|| registration.unversioned());
        groups.entry((module, name)).or_default().push(registration);
    }
    groups.into_values().collect()
}

/// Returns the registration that stands for a group of [`by_page`]: the first with a
/// [clip](super::Page::clip), else the newest version of the first name; `None` without
/// registrations.
pub fn shown(group: &[Registration]) -> Option<&Registration> {
    let first = group.first()?.unversioned();
    let mut versions = group.iter().rev();
    let newest = versions.find(|registration| registration.unversioned() == first);
    let mut clips = group.iter();
    clips
        .find(|registration| registration.page.clip.is_some())
        .or(newest)
}
