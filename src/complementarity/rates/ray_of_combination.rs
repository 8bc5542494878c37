//! The exact ray of one combination of options: the null vector of its equations, in both senses.

use crate::algebra::null_space;
use crate::complementarity::rates::rate_problem::{Choice, Entity, RateProblem};
use crate::complementarity::rates::tolerances::{
    DOUBTFUL_RATE, RANK_TOLERANCE, RATE_TOLERANCE, RAY_FORCES, SUM_ROUND_OFF,
};
use crate::resources::budget;
use nalgebra::{DMatrix, DVector};

/// The solution set of the equations of one combination.
pub enum Line {
    /// Zero only.
    Nothing,
    /// A vector of unit arc length and its multiples.
    Along(DVector<f64>),
    /// More than one independent vector, one per column.
    Plane(DMatrix<f64>),
    /// A vector along which reactions change without motion.
    Still,
    /// The equations contain a number that is not finite.
    NotFinite,
}

/// Magnitudes of the rates of force along a vector of weights.
struct Forces {
    largest: f64,
    /// Rounding error of the sums.
    rounding: f64,
}

impl Forces {
    /// The tolerance below which forces of an entity count as zero. A touching contact is judged by its own forces:
    /// along a chain close to jamming, forces fall by orders of magnitude from node to node.
    fn tolerance(&self, entity: &Entity, values: &DVector<f64>, tolerance: f64) -> f64 {
        let own = entity
            .touching
            .map_or(self.largest, |forms| values[forms.pressing].abs().max(values[forms.traction].abs()));
        (tolerance * own).max(tolerance / RATE_TOLERANCE * self.rounding)
    }
}

/// Arc length of a vector of weights.
pub(crate) fn size(problem: &RateProblem, weights: &DVector<f64>) -> f64 {
    problem.motion.of(weights).norm()
}

pub(crate) fn line(problem: &RateProblem, chosen: &[usize]) -> Line {
    let choices = || problem.entities.iter().zip(chosen).map(|(entity, &choice)| &entity.options[choice]);
    let rows: Vec<usize> = choices().flat_map(|choice| choice.zero.iter().copied()).collect();
    // The scaled copy of the equations, and the basis.
    let _held = budget::take::<f64>(3 * rows.len() * problem.weights());
    budget::spend(rows.len() * problem.weights());
    let equations = problem.forms.select_rows(&rows);
    let Some(basis) = null_space(&equations, RANK_TOLERANCE) else { return Line::NotFinite };
    if basis.ncols() > 1 {
        return Line::Plane(basis);
    }
    if basis.ncols() == 0 {
        return Line::Nothing;
    }
    let weights: DVector<f64> = basis.column(0).into_owned();
    let size = size(problem, &weights);
    let largest = (&problem.reactions * &weights).amax();
    if size.is_nan() || size <= RATE_TOLERANCE * largest {
        return Line::Still;
    }
    let weights = weights / size;
    if weights.iter().all(|weight| weight.is_finite()) { Line::Along(weights) } else { Line::NotFinite }
}

/// Whether a combination has a ray, or a solution set of more than one dimension.
pub(crate) fn is_feasible(problem: &RateProblem, chosen: &[usize]) -> bool {
    match line(problem, chosen) {
        Line::Along(weights) => {
            let along = forms_along(problem, &weights);
            along.violated(chosen).is_empty() || along.reversed().violated(chosen).is_empty()
        }
        Line::Plane(_) => true,
        Line::Nothing | Line::Still | Line::NotFinite => false,
    }
}

fn forces(problem: &RateProblem, weights: &DVector<f64>) -> Forces {
    let largest = (&problem.reactions * weights).amax();
    // Where no force changes, the sums contain rounding errors only.
    let mut terms = vec![0.0; problem.reactions.nrows()];
    for (column, weight) in problem.reactions.column_iter().zip(weights.iter()) {
        terms.iter_mut().zip(column.iter()).for_each(|(sum, value)| *sum += (value * weight).abs());
    }
    let rounding = SUM_ROUND_OFF * terms.into_iter().fold(0.0, f64::max);
    Forces { largest, rounding: rounding.max(f64::MIN_POSITIVE) }
}

/// The edges, of unit arc length, of the feasible part of a combination's plane: along each edge some inequality holds
/// with equality. No edges where the dimension of the plane is not two.
pub(crate) fn edges(problem: &RateProblem, chosen: &[usize], basis: &DMatrix<f64>) -> Vec<DVector<f64>> {
    if basis.ncols() != 2 {
        return Vec::new();
    }
    let choices = problem.entities.iter().zip(chosen).map(|(entity, &choice)| &entity.options[choice]);
    let mut edges: Vec<DVector<f64>> = Vec::new();
    for signed in choices.flat_map(|choice| &choice.nonnegative) {
        budget::spend(problem.reactions.nrows() * problem.weights());
        let row = problem.forms.row(signed.form);
        let parts = [0, 1].map(|column| row.transpose().dot(&basis.column(column)));
        if parts[0].abs().max(parts[1].abs()) <= RATE_TOLERANCE * row.amax() * basis.amax() {
            continue;
        }
        let along = basis.column(0) * parts[1] - basis.column(1) * parts[0];
        let size = size(problem, &along);
        if !(size.is_finite() && size > RATE_TOLERANCE * (&problem.reactions * &along).amax()) {
            continue;
        }
        for weights in [-&along / size, &along / size] {
            let is_new = |known: &DVector<f64>| (known - &weights).amax() > RATE_TOLERANCE * weights.amax();
            if edges.iter().all(is_new) && forms_along(problem, &weights).violated(chosen).is_empty() {
                edges.push(weights);
            }
        }
    }
    edges
}

/// The values of the forms along a vector of weights of unit arc length.
pub(crate) fn forms_along<'a>(problem: &'a RateProblem, weights: &DVector<f64>) -> Along<'a> {
    budget::spend((problem.forms.nrows() + 2 * problem.reactions.nrows()) * problem.weights());
    let forces = forces(problem, weights);
    let velocity_scales = problem.velocity_scales(forces.largest);
    Along { problem, values: &problem.forms * weights, forces, velocity_scales }
}

/// The forms and forces along a vector of weights of unit arc length.
pub(crate) struct Along<'a> {
    problem: &'a RateProblem,
    /// Value of each form.
    values: DVector<f64>,
    forces: Forces,
    /// The scale of each form that is a velocity.
    velocity_scales: Vec<f64>,
}

impl Along<'_> {
    /// The values along the reversed weights.
    pub fn reversed(mut self) -> Self {
        self.values.neg_mut();
        self
    }

    /// The tolerance below which rates of force count as zero.
    pub fn force_tolerance(&self) -> f64 {
        (RATE_TOLERANCE * self.forces.largest).max(self.forces.rounding)
    }

    /// Whether two rays change the same forces.
    pub fn has_forces_of(&self, other: &Self) -> bool {
        let least = RAY_FORCES * self.forces.largest.max(other.forces.largest);
        let is_force = self.problem.is_force.iter();
        let mut values = self.values.iter().zip(other.values.iter()).zip(is_force);
        values.all(|((one, other), is_force)| !is_force || (one - other).abs() <= least)
    }

    /// The tolerance below which the velocity of a form counts as zero.
    pub fn velocity_tolerance(&self, form: usize) -> f64 {
        RATE_TOLERANCE * self.velocity_scales[form]
    }

    /// The options of each entity under which a ray, found under the chosen options, is feasible. As each option
    /// concerns its own entity only, the ray is feasible under every combination of these options.
    pub fn fitting(&self, chosen: &[usize]) -> Vec<Vec<usize>> {
        self.within(RATE_TOLERANCE, chosen)
    }

    /// The options of each entity under which the ray is feasible if small values count as zero.
    pub fn in_doubt(&self, chosen: &[usize]) -> Vec<Vec<usize>> {
        self.within(DOUBTFUL_RATE, chosen)
    }

    fn within(&self, tolerance: f64, chosen: &[usize]) -> Vec<Vec<usize>> {
        let (values, is_force) = (&self.values, &self.problem.is_force);
        let fits = |entity: &Entity, choice: &Choice| {
            let force = self.forces.tolerance(entity, values, tolerance);
            let velocity = |form: usize| tolerance * self.velocity_scales[form];
            let tolerance = |form: usize| if is_force[form] { force } else { velocity(form) };
            choice.zero.iter().all(|&form| values[form].abs() <= tolerance(form))
                && choice.nonnegative.iter().all(|signed| signed.sign * values[signed.form] >= -tolerance(signed.form))
        };
        let of_entity = |(entity, &chosen): (&Entity, &usize)| {
            (0..entity.options.len()).filter(|&index| index == chosen || fits(entity, &entity.options[index])).collect()
        };
        self.problem.entities.iter().zip(chosen).map(of_entity).collect()
    }

    /// The entities whose inequalities are violated under a combination: below zero by more than the weak tolerance.
    pub fn violated(&self, chosen: &[usize]) -> Vec<usize> {
        let is_violated = |(index, choice): &(usize, &usize)| {
            self.some_inequality(*index, **choice, |value, tolerance| value < -tolerance)
        };
        chosen.iter().enumerate().filter(is_violated).map(|(index, _)| index).collect()
    }

    /// Whether some inequality of a ray holds with equality under the first fitting option of each entity.
    pub fn is_weak(&self, fitting: &[Vec<usize>]) -> bool {
        let equals = |(index, options): (usize, &Vec<usize>)| {
            self.some_inequality(index, options[0], |value, tolerance| value <= tolerance)
        };
        fitting.iter().enumerate().any(equals)
    }

    /// Whether `is_so` holds for the value and the weak tolerance of some inequality of an entity's option.
    fn some_inequality(&self, entity: usize, choice: usize, is_so: impl Fn(f64, f64) -> bool) -> bool {
        let entity = &self.problem.entities[entity];
        let force = self.forces.tolerance(entity, &self.values, RATE_TOLERANCE);
        entity.options[choice].nonnegative.iter().any(|signed| {
            let form = signed.form;
            let tolerance = if self.problem.is_force[form] { force } else { self.velocity_tolerance(form) };
            is_so(signed.sign * self.values[form], tolerance)
        })
    }
}
