//! Totals that a path accumulates from increment to increment, with either method.

use crate::continuation::path_state::tolerances::{ENERGY_DIGITS, ENERGY_ROUND_OFF};
use crate::resources::budget::Breach;
use crate::result::increment::{Energy, Increment, PointKind, Tangential};
use crate::result::report::Report;
use crate::result::stop_reason::StopReason;
use crate::step::corrector::cost_counters::Work;
use serde::{Deserialize, Serialize};
use smallvec::smallvec;
use std::collections::BTreeMap;

/// Sums and maxima from the start of the path, dimensionless.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Totals {
    /// Index of the present increment.
    pub index: u64,
    pub arc_length: f64,
    pub energy: Energy,
    /// Largest of the energies at any increment.
    pub largest_energy: f64,
    /// Largest force so far.
    pub force_scale: f64,
    pub work: Work,
    /// Relaxation at the end of the last program solved.
    #[serde(default)]
    pub last_relaxation: Option<f64>,
    /// Sums of the slips of the request's contacts that have slipped, by their place in the request; in the user's units,
    /// as increments report them.
    pub slips: BTreeMap<usize, Tangential>,
    pub report: Report,
}

/// Contribution of one increment.
pub(crate) struct Added {
    pub step: f64,
    pub external_work: f64,
    /// The largest part of the external work, where parts may cancel.
    pub largest_work: f64,
    /// The work of the stage's forces alone, and that of its supports and obstacles.
    pub work_of_pattern: [f64; 2],
    pub dissipated: f64,
    /// Total at the end of the increment.
    pub strain: f64,
    /// Largest force at the end of the increment.
    pub force_scale: f64,
}

impl Totals {
    /// Totals of a path without increments so far.
    pub fn begun() -> Self {
        Self {
            index: 0,
            arc_length: 0.0,
            energy: Energy::default(),
            largest_energy: 0.0,
            force_scale: 0.0,
            work: Work::default(),
            last_relaxation: None,
            slips: BTreeMap::new(),
            report: Report::begun(),
        }
    }

    pub fn add(&mut self, added: &Added) {
        self.index += 1;
        self.arc_length += added.step;
        self.force_scale = self.force_scale.max(added.force_scale);
        let energy = &mut self.energy;
        energy.external_work += added.external_work;
        energy.dissipated += added.dissipated;
        energy.strain = added.strain;
        self.note_largest_energy();
    }

    /// Adds the energies of a time step of a jump.
    pub fn add_motion(&mut self, external_work: f64, dissipated: f64, damped: f64, strain: f64) {
        let energy = &mut self.energy;
        energy.external_work += external_work;
        energy.dissipated += dissipated;
        energy.released += damped;
        energy.strain = strain;
        self.note_largest_energy();
    }

    fn note_largest_energy(&mut self) {
        let Energy { external_work, strain, dissipated, released } = self.energy;
        for value in [external_work, strain, dissipated, released] {
            self.largest_energy = self.largest_energy.max(value.abs());
        }
    }

    /// `|external work - strain - dissipated - released|` over the largest energy so far; `rounding` is that of the forces.
    pub fn energy_error(&self, rounding: f64) -> f64 {
        let Energy { external_work, strain, dissipated, released } = self.energy;
        let imbalance = (external_work - strain - dissipated - released).abs();
        let of_rounding = ENERGY_DIGITS * rounding * self.arc_length;
        let size = self.largest_energy.max(ENERGY_ROUND_OFF * self.force_scale).max(of_rounding);
        if size > 0.0 { imbalance / size } else { 0.0 }
    }

    /// The sum of the slips of a contact of the request, with so many components.
    pub fn slip_of(&self, contact: usize, tangents: usize) -> Tangential {
        self.slips.get(&contact).cloned().unwrap_or_else(|| smallvec![0.0; tangents])
    }

    /// Enters an emitted row into the report and the sums; `contacts`: places in the request of the contacts in the row.
    pub fn note(&mut self, row: &Increment, contacts: &[usize]) {
        for (state, place) in row.contacts.iter().zip(contacts) {
            if state.slip.iter().any(|slip| *slip != 0.0) {
                self.slips.insert(*place, state.slip_total.clone());
            }
        }
        let (report, diagnostics) = (&mut self.report, &row.diagnostics);
        report.increments = row.index;
        // What is out of balance in a motion is the force of damping and inertia.
        if row.point.kind != PointKind::Motion {
            report.largest_residual = report.largest_residual.max(diagnostics.residual);
        }
        report.largest_complementarity = report.largest_complementarity.max(diagnostics.complementarity);
        report.largest_energy_error = report.largest_energy_error.max(diagnostics.energy_error);
    }

    /// Completes the report of a path that was interrupted within an increment.
    pub fn break_off(&mut self, breach: Breach, elapsed_s: f64) {
        match breach {
            Breach::Cancelled => self.end(StopReason::Cancelled, elapsed_s),
            Breach::Memory { .. } | Breach::FactorEntries { .. } | Breach::FactorWork { .. } => {
                self.end(StopReason::MemoryLimit, elapsed_s);
                self.report.sentence = format!("{}: {breach}", StopReason::MemoryLimit.sentence());
            }
        }
    }

    /// Completes the report.
    pub fn end(&mut self, reason: StopReason, elapsed_s: f64) {
        self.report.stop_reason = reason;
        self.report.sentence = reason.sentence().to_owned();
        self.report.elapsed_s = elapsed_s;
        self.report.factorisations = self.work.factorisations;
        self.report.bifurcation_factorisations = self.work.bifurcation_factorisations;
        self.report.newton_iterations = self.work.newton_iterations;
        self.report.qp_solves = self.work.qp_solves;
        self.report.mpec_solves = self.work.mpec_solves;
        self.report.sqp_iterations = self.work.sqp_iterations;
        self.report.certificates = self.work.certificates;
        self.report.mpec_fallbacks = self.work.mpec_fallbacks;
    }
}
