//! The findings of a study: all of its rows.

use crate::model::request::Method;
use crate::model::request::study::Parameter;
use crate::studies::error_against_time::plan::StudyPlan;
use crate::studies::error_against_time::reference::Reference;
use crate::studies::error_against_time::row::{StudyRow, StudyRun, slope};
use serde::{Deserialize, Serialize};

/// What a study has found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = StudyReport))]
pub struct StudyReport {
    /// The model's own name.
    pub name: Option<String>,
    pub parameter: Parameter,
    pub reference: Reference,
    pub rows: Vec<StudyRow>,
    pub orders: Vec<MethodOrder>,
    /// Every path was traced as often as was asked for.
    pub complete: bool,
}

/// The slope of a method's errors over all rungs, by least squares; null where fewer than two are resolved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct MethodOrder {
    pub method: Method,
    pub order: Option<f64>,
}

impl StudyReport {
    /// The findings of a study, given its last runs so far, as many as there are rows, or all. `None` before the first run.
    pub fn of_runs(name: Option<String>, plan: &StudyPlan, runs: &[StudyRun]) -> Option<Self> {
        let last = runs.last()?;
        let mut rows: Vec<StudyRow> = Vec::new();
        for run in runs.iter().rev() {
            if rows.iter().all(|known| known.row != run.row.row) {
                rows.push(run.row.clone());
            }
        }
        rows.sort_by_key(|row| row.row);
        let complete = last.index + 1 == plan.runs;
        Some(Self::new(name, plan.parameter, last.reference.clone(), rows, complete))
    }

    pub(super) fn new(
        name: Option<String>,
        parameter: Parameter,
        reference: Reference,
        rows: Vec<StudyRow>,
        complete: bool,
    ) -> Self {
        let mut methods: Vec<Method> = rows.iter().map(|row| row.method).collect();
        methods.dedup();
        let orders = methods
            .into_iter()
            .map(|method| {
                let its: Vec<&StudyRow> = rows.iter().filter(|row| row.method == method).collect();
                MethodOrder { method, order: slope(&its, parameter == Parameter::ArcLength) }
            })
            .collect();
        Self { name, parameter, reference, rows, orders, complete }
    }

    /// Methods in the table's order, each with its rows.
    pub fn by_method(&self) -> impl Iterator<Item = (&MethodOrder, Vec<&StudyRow>)> {
        self.orders.iter().map(|order| (order, self.rows.iter().filter(|row| row.method == order.method).collect()))
    }
}
