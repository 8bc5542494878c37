//! A step no longer than to just past the next contact change, where the rates at its start foresee one.
//!
//! A step that passes many changes is cut at the first of them: what was solved at its far end was solved for nothing,
//! and is too far from the change to help to locate it. The gaps and forces of the contacts and their rates foresee the
//! place. A step that ends just past it needs less of Newton's method, and its factorisation serves at the change. Where
//! nothing has changed by then its end is a point like others, and the next step is as long as this one was to be.

use super::advance::PASSED;
use super::at_once::may_join_at;
use super::stepping::quantised;
use super::tracer::Path;
use super::watch;

/// How far past the change the step is to end, over the way there: rates are not all that tells where it is.
const PAST: f64 = 1.25;
/// No step is cut to less than this part of what it was to be.
const LEAST: f64 = 1.0 / 256.0;

impl Path<'_> {
    /// A shorter step that ends just past the change that comes first. `may_join`: those that may be taken together are
    /// not stopped at.
    ///
    /// Only where matrices are sparse: the factorisations that are saved of a dense one cost as little as the points that
    /// come on top.
    pub(super) fn step_to_foreseen_change(&self, step: f64, may_join: bool) -> Option<f64> {
        let (loading, here) = (self.loading(), &self.at.here);
        loading.structure.layout()?;
        let rate = here.rate.as_ref()?;
        let way = |watch: &watch::Watch| {
            let slope = watch.slope(loading, &here.state, rate).filter(|slope| *slope < 0.0)?;
            let value = watch.value(loading, &here.modes, &here.state, rate);
            // What is zero here has just changed.
            let is_above = watch.is_above(loading, &here.state, value, PASSED, self.at.totals.force_scale);
            is_above.then(|| value / -slope)
        };
        let watches = watch::of_mode(loading, &here.modes, &here.state, rate);
        let ways = watches.iter().filter_map(|watch| Some((*watch, way(watch)?)));
        let (first, way) = ways.min_by(|one, other| one.1.total_cmp(&other.1))?;
        if may_join && may_join_at(loading, &here.modes, first) {
            return None;
        }
        let part = PAST * way / step;
        (part < 1.0).then(|| step * quantised(part.max(LEAST)))
    }
}
