//! A path as points in a dimensionless space.

use crate::model::Model;
use crate::result::increment::{Increment, PointKind};
use crate::result::plan::Plan;

/// Displacement components over their scale, then the load factor over its stage's.
pub(super) type ScaledPoint = Vec<f64>;

/// The scales that make points dimensionless.
#[derive(Debug, Clone)]
pub(super) struct TraceScales {
    pub displacement: f64,
    /// Stage names and load scales.
    loads: Vec<(String, f64)>,
}

/// The points of a path, stage by stage.
#[derive(Debug, Clone, Default)]
pub(super) struct StudyTrace {
    pub stages: Vec<TracedStage>,
}

#[derive(Debug, Clone)]
pub(super) struct TracedStage {
    /// Index among the stages of the model.
    pub stage: usize,
    /// The first point is the start of the stage, at zero load.
    pub points: Vec<ScaledPoint>,
    pub events: Vec<TracedEvent>,
}

/// An event at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TracedEvent {
    pub kind: PointKind,
    /// The index of the point in the stage.
    pub point: usize,
}

impl TraceScales {
    pub fn new(model: &Model, plan: &Plan) -> Self {
        let names = model.stages.iter().map(|stage| stage.name.clone());
        Self { displacement: plan.displacement_scale, loads: names.zip(plan.load_scales.iter().copied()).collect() }
    }

    pub fn load(&self, stage: usize) -> f64 {
        self.loads[stage].1
    }

    pub fn point(&self, stage: usize, displacements: impl Iterator<Item = f64>, load: f64) -> ScaledPoint {
        displacements.map(|value| value / self.displacement).chain([load / self.load(stage)]).collect()
    }
}

impl StudyTrace {
    pub fn add(&mut self, scales: &TraceScales, increment: &Increment) {
        let known = self.stages.last().map(|last| last.stage);
        let same = known.is_some_and(|stage| *scales.loads[stage].0 == *increment.stage);
        if !same {
            let Some(stage) = scales.loads.iter().position(|(name, _)| **name == *increment.stage) else { return };
            // A stage begins where the previous one ended, without an increment for its start.
            let begins = self.stages.last().and_then(|last| last.points.last()).map(|last| {
                let mut begins = last.clone();
                begins.last_mut().into_iter().for_each(|load| *load = 0.0);
                begins
            });
            self.stages.push(TracedStage { stage, points: begins.into_iter().collect(), events: Vec::new() });
        }
        let Some(stage) = self.stages.last_mut() else { return };
        let displacements = increment.displacements.values().flatten().copied();
        stage.points.push(scales.point(stage.stage, displacements, increment.load_factor));
        match increment.point.kind {
            PointKind::Start | PointKind::Regular => {}
            kind => stage.events.push(TracedEvent { kind, point: stage.points.len() - 1 }),
        }
    }

    /// Largest scaled displacement component of all stages, and largest scaled load of each.
    pub fn largest(&self) -> (f64, f64) {
        let points = self.stages.iter().flat_map(|stage| &stage.points);
        points.fold((0.0, 0.0), |(most, most_load), point| {
            let (load, displacements) = point.split_last().unwrap_or((&0.0, &[]));
            let largest = displacements.iter().fold(most, |most: f64, value| most.max(value.abs()));
            (largest, f64::max(most_load, load.abs()))
        })
    }
}

pub(super) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
