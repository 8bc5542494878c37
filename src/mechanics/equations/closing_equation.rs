//! The closing equation of a mode: it selects the point on the branch.
//!
//! ```text
//! c(u, s) = 0        arc length: ‖(Δu, Δs)‖ - S    prescribed load: s - value    prescribed displacement: u_i - value
//! ```
//!
//! Arc length after E. Riks, Int. J. Solids Struct. 15 (1979) 529, doi:10.1016/0020-7683(79)90081-7. An event function
//! is another closing equation (`step::event_functions`).

use crate::algebra::dense::matrix_sink::Sink;
use crate::mechanics::equations::{ModeSystem, matrix};
use crate::mechanics::problem::state::{Rate, State};

/// The closing equation of a point; all quantities are dimensionless.
pub trait ClosingEquation {
    /// The value of `c` at a state.
    fn value(&self, system: &ModeSystem<'_>, state: &State) -> f64;

    /// Writes the gradient of `c` at a state into the last row of the matrix of a mode.
    fn write_gradient(&self, system: &ModeSystem<'_>, state: &State, matrix: &mut dyn Sink);

    /// Whether a zero of `c` may be the required point.
    fn accepts(&self, _state: &State) -> bool {
        true
    }

    /// The derivative of `c` along a rate, where the last row does not give it: the gradient may have entries at forces
    /// that the factorisation eliminates.
    fn slope_beside_row(&self, _system: &ModeSystem<'_>, _state: &State, _rate: &Rate) -> Option<f64> {
        None
    }

    /// Whether [`slope_beside_row`](Self::slope_beside_row) replaces the last row.
    fn has_slope_beside_row(&self) -> bool {
        false
    }

    /// The arc length of the point, where it is known.
    fn arc_length(&self) -> Option<f64> {
        None
    }

    /// The arc length of the straight line from a state along a rate to the zero of `c`, where it is known.
    fn straight_way(&self, _state: &State, _rate: &Rate) -> Option<f64> {
        None
    }
}

/// The arc-length equation `‖(Δu, Δs)‖ = step` from a state, on the side of the predictor.
#[derive(Debug, Clone, Copy)]
pub struct ArcLengthEquation<'a> {
    pub from: &'a State,
    pub step: f64,
}

impl ClosingEquation for ArcLengthEquation<'_> {
    fn value(&self, _system: &ModeSystem<'_>, state: &State) -> f64 {
        state.distance(self.from) - self.step
    }

    fn write_gradient(&self, system: &ModeSystem<'_>, state: &State, matrix: &mut dyn Sink) {
        let (from, size) = (self.from, state.distance(self.from));
        let factor = if size > 0.0 { 1.0 / size } else { 1.0 };
        let along = |freedom: usize| factor * (state.displacement[freedom] - from.displacement[freedom]);
        matrix::border_along(system, matrix, along, factor * (state.load - from.load));
    }

    fn accepts(&self, state: &State) -> bool {
        state.distance(self.from) >= 0.5 * self.step
    }

    fn arc_length(&self) -> Option<f64> {
        Some(self.step)
    }

    fn straight_way(&self, _state: &State, _rate: &Rate) -> Option<f64> {
        Some(self.step)
    }
}

/// The hyperplane `(u̇, ṡ)·(Δu, Δs) = step` from a state, across a rate of unit arc length.
#[derive(Debug, Clone, Copy)]
pub struct HyperplaneEquation<'a> {
    pub from: &'a State,
    pub rate: &'a Rate,
    pub step: f64,
}

impl ClosingEquation for HyperplaneEquation<'_> {
    fn value(&self, _system: &ModeSystem<'_>, state: &State) -> f64 {
        self.from.product_of_chord(state, self.rate) - self.step
    }

    fn write_gradient(&self, system: &ModeSystem<'_>, _state: &State, matrix: &mut dyn Sink) {
        matrix::border_along(system, matrix, |freedom| self.rate.displacement[freedom], self.rate.load);
    }

    fn straight_way(&self, _state: &State, _rate: &Rate) -> Option<f64> {
        Some(self.step)
    }
}

/// A prescribed load factor or displacement.
#[derive(Debug, Clone, Copy)]
pub enum PrescribedValue {
    /// `s = value`
    Load(f64),
    /// `u = value` at a degree of freedom.
    Displacement { freedom: usize, value: f64 },
}

impl ClosingEquation for PrescribedValue {
    fn value(&self, _system: &ModeSystem<'_>, state: &State) -> f64 {
        match *self {
            Self::Load(value) => state.load - value,
            Self::Displacement { freedom, value } => state.displacement[freedom] - value,
        }
    }

    fn write_gradient(&self, system: &ModeSystem<'_>, _state: &State, matrix: &mut dyn Sink) {
        let structure = system.loading.structure;
        let (last, load) = (system.size - 1, structure.unknowns());
        match *self {
            Self::Load(_) => matrix.add(last, load, 1.0),
            Self::Displacement { freedom, .. } => match structure.unknown_of[freedom] {
                Some(unknown) => matrix.add(last, unknown, 1.0),
                None => matrix.add(last, load, system.loading.support_rate(freedom)),
            },
        }
    }

    fn straight_way(&self, state: &State, rate: &Rate) -> Option<f64> {
        Some(match *self {
            Self::Load(value) => (value - state.load) / rate.load,
            Self::Displacement { freedom, value } => (value - state.displacement[freedom]) / rate.displacement[freedom],
        })
    }
}
