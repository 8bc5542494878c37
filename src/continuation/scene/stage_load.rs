//! The load of a stage.

use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::loading::LoadPattern;
use crate::model::request::{Stage, StageControl};
use crate::resources::budget::Taken;
use std::sync::Arc;

/// A stage's load pattern over all degrees of freedom and its ends, dimensionless; of a stage whose load follows a history
/// the part up to its next turn.
#[derive(Debug, Clone)]
pub(crate) struct StageLoad {
    pub name: Arc<str>,
    pub pattern: Arc<LoadPattern>,
    /// The pattern of the whole stage, which all its parts share, and the sense in which this part goes through it, 1 or -1.
    pub of_stage: Arc<LoadPattern>,
    pub sense: f64,
    /// Load factor per load; below 0 where the load factor is to fall.
    pub load_scale: f64,
    /// Load factor at which the load begins.
    pub offset: f64,
    pub control: StageControl,
    /// Whether the load goes on from here to the next turn of the same stage's history.
    pub turns: bool,
    /// Factor by which given scales exceed the default ones; at least 1.
    pub enlarged: f64,
    pub ends: Vec<End>,
    /// The loads at which the stage may end, in the user's units, in the order of those `ends`.
    pub given_loads: Vec<f64>,
    pub _held: Arc<Taken>,
}

impl StageLoad {
    /// The parts of a stage between the turns of its load; in each of them the load rises from 0. A stage whose path is
    /// followed by arc length is one part.
    pub(super) fn between_turns(self, stage: &Stage) -> Vec<Self> {
        if self.control == StageControl::Path {
            return vec![self];
        }
        let mut reversed = self.pattern.zeroed();
        reversed.add(-1.0, &self.pattern);
        let reversed = Self { pattern: Arc::new(reversed), sense: -1.0, load_scale: -self.load_scale, ..self.clone() };
        let towards = |offset: f64, target: f64, turns: bool| {
            let part = if target < offset { &reversed } else { &self };
            let end = End::Load { bound: (target - offset) / part.load_scale, sign: 1.0 };
            let others = part.ends.iter().filter(|end| !matches!(end, End::Load { .. }));
            let ends = std::iter::once(end).chain(others.copied()).collect();
            Self { ends, given_loads: vec![target], offset, turns, ..part.clone() }
        };
        if stage.history.is_empty() {
            let until = stage.until.as_ref();
            let target = until.and_then(|until| until.load_above.or(until.load_below));
            return vec![target.map_or_else(|| self.clone(), |target| towards(0.0, target, false))];
        }
        let cycles = usize::try_from(stage.cycles.unwrap_or(1)).unwrap_or(usize::MAX);
        let count = cycles.saturating_mul(stage.history.len());
        let (mut parts, mut offset) = (Vec::new(), 0.0);
        for target in stage.history.iter().copied().cycle().take(count) {
            if target != offset {
                parts.push(towards(offset, target, true));
                offset = target;
            }
        }
        if let Some(last) = parts.last_mut() {
            last.turns = false;
        }
        parts
    }

    /// Whether the load factor falls where the load rises.
    pub fn falls(&self) -> bool {
        self.load_scale < 0.0
    }

    /// A load in the user's units. At the bound of a stage it is the given number itself: division by a scale and
    /// multiplication may not restore it.
    pub fn load_factor(&self, load: f64) -> f64 {
        let bounds =
            self.ends.iter().filter_map(|end| if let End::Load { bound, .. } = end { Some(*bound) } else { None });
        let given = bounds.zip(&self.given_loads).find(|(bound, _)| *bound == load);
        given.map_or_else(|| self.offset + load * self.load_scale, |(_, given)| *given)
    }
}
