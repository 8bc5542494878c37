//! Checks of the input, which separate misuse from numerical failure before any computation.

use nalgebra::DVector;

use crate::complementarity::mpec::program::problem::Problem;
use crate::complementarity::mpec::result::ProgramInputError;
use crate::complementarity::mpec::settings::Settings;

/// Checks lengths, bounds and settings.
///
/// # Errors
/// The first inconsistency found.
pub fn check_input<P: Problem + ?Sized>(
    problem: &P,
    start: &DVector<f64>,
    bounds: &(DVector<f64>, DVector<f64>),
    settings: &Settings,
) -> Result<(), ProgramInputError> {
    let expected = problem.variables();
    if start.len() != expected {
        return Err(ProgramInputError::StartLength { expected, found: start.len() });
    }
    let (lower, upper) = (bounds.0.len(), bounds.1.len());
    if lower != expected || upper != expected {
        return Err(ProgramInputError::BoundsLength { expected, lower, upper });
    }
    for variable in 0..expected {
        let (lower, upper) = (bounds.0[variable], bounds.1[variable]);
        if lower.is_nan() || upper.is_nan() || lower > upper || lower == f64::INFINITY || upper == f64::NEG_INFINITY {
            return Err(ProgramInputError::Bounds { variable, lower, upper });
        }
    }
    if let Some((pair, &size)) = problem.cone_sizes().iter().enumerate().find(|(_, size)| **size < 2) {
        return Err(ProgramInputError::ConeSize { pair, size });
    }
    let positive = |name, value: f64| {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(ProgramInputError::Setting { name, value, wanted: "positive" })
        }
    };
    positive("first_relaxation", settings.first_relaxation)?;
    positive("last_relaxation", settings.last_relaxation)?;
    positive("tolerance", settings.tolerance)?;
    positive("biactive_tolerance", settings.biactive_tolerance)?;
    let factor = settings.relaxation_factor;
    if !(factor > 0.0 && factor < 1.0) {
        return Err(ProgramInputError::Setting { name: "relaxation_factor", value: factor, wanted: "between 0 and 1" });
    }
    Ok(())
}
