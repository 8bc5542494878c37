//! The errors of an increment, and their maxima over a path.

#![warn(missing_docs)]

use serde::{Deserialize, Serialize};

/// How far a point is from the equations that it should satisfy, as the measure that stands apart from the solver finds
/// it from the model and the increments alone. All figures are dimensionless and 0 or more; 1.7976931348623157e308
/// stands for an error without bound, where an increment holds something that is not a number.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = Measure))]
pub struct Errors {
    /// Largest unbalanced force on a free component over the largest force so far.
    pub equilibrium: f64,
    /// Largest deviation of a supported component from what is prescribed, over the displacement scale.
    pub support: f64,
    /// Natural map of `0 <= gap ⊥ normal reaction >= 0`: the smaller of gap over the displacement scale and reaction over
    /// the largest force so far, its size.
    pub contact: f64,
    /// Natural map of Coulomb's law over the increment: traction against its projection, moved by the slip, onto the disc
    /// of radius friction times normal reaction.
    pub friction: f64,
    /// Traction beyond the friction cone over the largest force so far.
    pub cone: f64,
    /// Gaps, slips, statuses and forces as reported against those of the displacements and reactions.
    pub reported: f64,
    /// Sum of the forces, and of their moments, that supports, loads, contacts and springs exert on the bars: largest
    /// component over the largest force so far, moments also over the extent of the structure.
    #[serde(default)]
    pub global_equilibrium: f64,
    /// The chord of the increment in the scaled norm against `step`, and `arc_length` against the sum of the steps.
    pub arc_length: f64,
    /// `|external work - strain - dissipated|` over the largest energy so far.
    pub energy: f64,
    /// Reported strain energy against that of the displacements, over the largest energy so far.
    pub strain_energy: f64,
    /// In 3D: angle (radians) between a slip and the mean of its directions at both ends. It falls with the step and is
    /// not an error of the state.
    pub slip_direction: f64,
}

/// Number of errors of an increment.
const FIGURES: usize = 11;

impl Errors {
    /// The names of the errors, as in the results.
    pub const NAMES: [&'static str; FIGURES] = [
        "equilibrium",
        "support",
        "contact",
        "friction",
        "cone",
        "reported",
        "global_equilibrium",
        "arc_length",
        "energy",
        "strain_energy",
        "slip_direction",
    ];

    /// The errors in the order of [`Errors::NAMES`].
    pub fn values(&self) -> [f64; FIGURES] {
        [
            self.equilibrium,
            self.support,
            self.contact,
            self.friction,
            self.cone,
            self.reported,
            self.global_equilibrium,
            self.arc_length,
            self.energy,
            self.strain_energy,
            self.slip_direction,
        ]
    }

    /// The largest error of equilibrium, support, contact, friction, cone, reported, global equilibrium and arc length: the
    /// conditions that a point of the path must satisfy for any step.
    pub fn largest_of_state(&self) -> f64 {
        self.values()[..8].iter().copied().fold(0.0, worse)
    }
}

/// The larger error; an error that is NaN or infinite becomes the largest finite number.
pub(super) fn worse(error: f64, other: f64) -> f64 {
    if other.is_nan() { f64::MAX } else { error.max(other).min(f64::MAX) }
}

/// The largest value of a figure and where it occurs.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = LargestError))]
#[serde(deny_unknown_fields)]
pub struct Largest {
    /// Dimensionless (`slip_direction`: radians), 0 or more.
    pub value: f64,
    /// Index of the first increment with this value; null where the figure is 0 everywhere.
    pub index: Option<u64>,
}

/// The largest value of each figure of the measure over a path.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Maxima {
    /// Of [`Errors::equilibrium`].
    pub equilibrium: Largest,
    /// Of [`Errors::support`].
    pub support: Largest,
    /// Of [`Errors::contact`].
    pub contact: Largest,
    /// Of [`Errors::friction`].
    pub friction: Largest,
    /// Of [`Errors::cone`].
    pub cone: Largest,
    /// Of [`Errors::reported`].
    pub reported: Largest,
    /// Of [`Errors::global_equilibrium`].
    #[serde(default)]
    pub global_equilibrium: Largest,
    /// Of [`Errors::arc_length`].
    pub arc_length: Largest,
    /// Of [`Errors::energy`].
    pub energy: Largest,
    /// Of [`Errors::strain_energy`].
    pub strain_energy: Largest,
    /// Of [`Errors::slip_direction`].
    pub slip_direction: Largest,
}

impl Maxima {
    /// Includes the errors of an increment.
    pub fn include(&mut self, index: u64, errors: &Errors) {
        let figures = [
            &mut self.equilibrium,
            &mut self.support,
            &mut self.contact,
            &mut self.friction,
            &mut self.cone,
            &mut self.reported,
            &mut self.global_equilibrium,
            &mut self.arc_length,
            &mut self.energy,
            &mut self.strain_energy,
            &mut self.slip_direction,
        ];
        for (largest, value) in figures.into_iter().zip(errors.values()) {
            if value > largest.value {
                *largest = Largest { value, index: Some(index) };
            }
        }
    }
}
