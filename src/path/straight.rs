//! Straight stretches of a path, which are one increment.
//!
//! Where every element is linear, every contact in reach a plane's and no slip can turn, the tangent of a mode is constant
//! and everything that is watched is linear in the arc length: the place of the next event is known from where the path
//! stands, and nothing lies in between. It is solved for at once (`foresight`); the direction there is that of the start, and
//! so are the signs that tell of bifurcations. Along stretches of bifurcations the increments are kept, because from any of
//! them another direction can be followed.

use super::corner;
use super::foresight::Foreseen;
use super::loading::Loading;
use super::plan::LeftOut;
use super::scene::{End, Scene};
use super::tracer::Path;
use super::watch::{self, Watch};
use crate::contact::obstacle::Obstacle;
use crate::contact::{Contact, Sliding};
use crate::model::request::{Analysis, Method};
use crate::structure::Structure;
use crate::structure::element::Element;

/// How far past the event the step is tried, over the way there: the event is then seen to be passed.
const PAST: f64 = 1.0 / 64.0;
/// A quantity that changes by less than this fraction of its scale by unit arc length does not change.
const CONSTANT: f64 = 1e-10;
/// The same of the load and displacements, which are no differences of others.
const CONSTANT_BOUND: f64 = 1e-14;
/// What counts as zero, over a quantity's scale.
const ZERO: f64 = 1e-12;

/// Whether straight stretches are jumped over.
pub(super) fn jumps(analysis: &Analysis, structure: &Structure) -> bool {
    analysis.arc_length.jump
        && !analysis.keep_all
        && analysis.method != Method::Regularised
        && structure.elements.iter().all(Element::is_linear)
}

/// What the plan says of it.
pub(super) fn left_out(scene: &Scene) -> Option<LeftOut> {
    scene.jumps.then(|| LeftOut {
        what: "increments between events, but for stretches of bifurcations".to_owned(),
        why: "every element is linear: the path is straight while the obstacles in reach are planes and no slip turns; give \
              `arc_length.max` to have points in between"
            .to_owned(),
    })
}

/// Whether nothing about a contact bends a path of linear elements.
fn is_straight(contact: &Contact) -> bool {
    let plane = matches!(contact.obstacle, Obstacle::Plane { .. });
    plane && (contact.friction == 0.0 || contact.sliding != Sliding::Plane)
}

/// Whether every direction of first order holds exactly over some way: nothing bends it.
pub(super) fn is_linear(loading: Loading<'_>) -> bool {
    loading.corners.is_empty()
        && loading.contacts.iter().all(is_straight)
        && loading.structure.elements.iter().all(Element::is_linear)
}

impl Path<'_> {
    /// The next event, where the path is straight up to there and a little farther.
    pub(super) fn next_event_ahead(&mut self) -> Option<Foreseen> {
        if !self.scene.jumps || self.at.listed.as_ref().is_some_and(|listed| listed.point.bifurcation) {
            return None;
        }
        loop {
            let (watch, way) = self.straight_way()?;
            let (contacts, step) = (self.at.near.len(), way * (1.0 + PAST));
            self.look_ahead(step);
            if self.at.near.len() == contacts {
                return Some(Foreseen { watch, way, step, is_straight: true });
            }
        }
    }

    /// What falls to zero first, and the arc length up to there.
    fn straight_way(&self) -> Option<(Watch, f64)> {
        let (loading, here) = (self.loading(), &self.at.here);
        let rate = here.rate.as_ref()?;
        // The force of several obstacles in space reaches the bound of what they hold along no straight line.
        if !loading.contacts.iter().all(is_straight)
            || loading.corners.iter().any(|corner| !corner::is_in_plane(loading, corner))
        {
            return None;
        }
        let ends = &self.scene.stages[self.at.stage].ends;
        if ends.iter().any(|end| matches!(end, End::Increments(_))) {
            return None;
        }
        let mut watches = watch::of_mode(loading, &here.modes, &here.state, rate);
        watches.extend(ends.iter().map(|end| Watch::End(*end)));
        let ahead = here.state.advanced(rate, 1.0);
        let mut nearest: Option<(Watch, f64)> = None;
        for watch in watches {
            let now = watch.value(loading, &here.modes, &here.state, rate);
            let change = watch.value(loading, &here.modes, &ahead, rate) - now;
            if change >= 0.0 {
                continue;
            }
            let scale = watch.scale(loading, &here.state, self.at.totals.force_scale);
            let constant = if watch.is_of_contact() { CONSTANT } else { CONSTANT_BOUND };
            if change < -constant * scale {
                if now <= ZERO * scale {
                    return None;
                }
                let way = now / -change;
                if nearest.is_none_or(|(_, least)| way < least) {
                    nearest = Some((watch, way));
                }
            }
        }
        nearest.filter(|(_, way)| way.is_finite())
    }
}
