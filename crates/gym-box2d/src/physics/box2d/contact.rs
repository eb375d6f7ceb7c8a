//! Contacts: pairs of fixtures whose boxes overlap.

use serde::{Deserialize, Serialize};

use super::arena::Arena;
use super::body::{Body, Fixture};
use super::collide::{collide, order};
use super::distance::overlap;
use super::manifold::Manifold;
use super::math::max;
use crate::physics::{BodyId, ContactEvent, FixtureId};

/// A pair of fixtures that may touch.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Contact {
    pub(crate) fixture_a: u32,
    pub(crate) fixture_b: u32,
    pub(crate) body_a: u32,
    pub(crate) body_b: u32,
    /// Whether one of the fixtures is a sensor: the contact is reported but has no forces.
    pub(crate) sensor: bool,
    pub(crate) friction: f32,
    pub(crate) restitution: f32,
    pub(crate) manifold: Manifold,
    pub(crate) touching: bool,
    pub(crate) enabled: bool,
    /// Whether an island of this step already contains the contact.
    pub(crate) island: bool,
    /// The time of impact within this step, once computed.
    #[serde(deserialize_with = "Option::deserialize")]
    pub(crate) toi: Option<f32>,
    /// The number of times of impact that this contact had in this step.
    pub(crate) toi_count: u32,
    /// Whether a new joint may forbid the contact, so that the contact must be checked again.
    pub(crate) refilter: bool,
}

impl Contact {
    /// Returns the contact of fixtures `a` and `b`; `None` if shapes of their kinds cannot collide.
    pub(crate) fn new(fixtures: &Arena<Fixture>, a: u32, b: u32) -> Option<Self> {
        let swap = order(fixtures[a].shape.kind, fixtures[b].shape.kind)?;
        let (fixture_a, fixture_b) = if swap { (b, a) } else { (a, b) };
        let (a, b) = (&fixtures[fixture_a], &fixtures[fixture_b]);
        Some(Self {
            fixture_a,
            fixture_b,
            body_a: a.body,
            body_b: b.body,
            sensor: a.sensor || b.sensor,
            friction: (a.friction * b.friction).sqrt(),
            restitution: max(a.restitution, b.restitution),
            manifold: Manifold::EMPTY,
            touching: false,
            enabled: true,
            island: false,
            toi: None,
            toi_count: 0,
            refilter: false,
        })
    }

    /// Returns the other body, if the contact involves `body`.
    #[inline]
    pub(crate) fn other(&self, body: u32) -> Option<u32> {
        if self.body_a == body {
            Some(self.body_b)
        } else if self.body_b == body {
            Some(self.body_a)
        } else {
            None
        }
    }

    pub(crate) fn event(&self, begin: bool) -> ContactEvent {
        ContactEvent {
            begin,
            fixtures: [FixtureId(self.fixture_a), FixtureId(self.fixture_b)],
            bodies: [BodyId(self.body_a), BodyId(self.body_b)],
        }
    }

    /// Computes the manifold and whether the fixtures touch.
    pub(crate) fn update(
        &mut self,
        bodies: &mut Arena<Body>,
        fixtures: &Arena<Fixture>,
        events: &mut Vec<ContactEvent>,
    ) {
        let was_touching = self.touching;
        self.enabled = true;
        let (shape_a, shape_b) = (
            &fixtures[self.fixture_a].shape,
            &fixtures[self.fixture_b].shape,
        );
        let (xf_a, xf_b) = (&bodies[self.body_a].xf, &bodies[self.body_b].xf);
        if self.sensor {
            self.touching = overlap(shape_a, xf_a, shape_b, xf_b);
        } else {
            let old = self.manifold;
            self.manifold = collide(shape_a, xf_a, shape_b, xf_b);
            self.manifold.inherit(&old);
            self.touching = !self.manifold.points().is_empty();
            if self.touching != was_touching {
                bodies[self.body_a].wake();
                bodies[self.body_b].wake();
            }
        }
        if self.touching != was_touching {
            events.push(self.event(self.touching));
        }
    }
}
