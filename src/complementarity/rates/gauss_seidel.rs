//! Finds a likely combination by Gauss-Seidel sweeps over the entities, each solved with the others fixed.
//!
//! Nonlinear Gauss-Seidel for contact and friction (M. Jean, Comput. Methods Appl. Mech. Eng. 177 (1999) 235,
//! doi:10.1016/S0045-7825(98)00383-1), in velocities. For a stable structure the sweeps converge to the combination
//! that continues the path, however many contacts touch; the result is examined exactly like any other combination.
//! Along a chain of contacts the number of plain sweeps grows with the square of the chain's length; sweeps are
//! therefore over-relaxed (C. W. Cryer, SIAM J. Control 9 (1971) 385, doi:10.1137/0309028), and plain where
//! over-relaxation does not settle.

use crate::complementarity::rates::rate_problem::{Entity, RateProblem, Touching, own_column};
use crate::complementarity::rates::ray_of_combination;
use crate::complementarity::rates::tolerances::{DIVERGENT_GROWTH, RELATIVE_ROUND_OFF, SETTLED_CHANGE};
use crate::resources::budget;
use crate::resources::cancel::CancelFlag;
use nalgebra::{DMatrix, DVector};

/// Largest number of multiplications in the sweeps of one sign of the load rate with one relaxation factor.
const WORK: usize = 100_000_000;
/// Sweeps without a change of any option after which the combination is first examined.
const UNCHANGED: usize = 30;
/// Relaxation factors, tried in order.
const RELAXATIONS: [f64; 3] = [1.9, 1.6, 1.0];

/// The combinations on which the sweeps settle, for a rising and a falling load; none where the entities are not plain
/// contacts or the sweeps do not settle.
pub fn sweeps(problem: &RateProblem, cancel: &CancelFlag) -> Vec<Vec<usize>> {
    let Some(locals) = problem.entities.iter().map(|entity| Local::of(problem, entity)).collect::<Option<Vec<_>>>()
    else {
        return Vec::new();
    };
    let Some(rising) = rising(problem) else { return Vec::new() };
    let settled = |sign: f64| {
        let from = sign * rising;
        RELAXATIONS.iter().find_map(|relaxation| settle(problem, &locals, from, *relaxation, cancel))
    };
    [1.0, -1.0].into_iter().filter_map(settled).collect()
}

/// The sign of the last weight for which the load rises; `None` where other weights change the load as well.
pub fn rising(problem: &RateProblem) -> Option<f64> {
    let last = problem.weights() - 1;
    let load = &problem.load;
    let alone = load[last] != 0.0 && (0..last).all(|column| load[column].abs() <= 1e-9 * load[last].abs());
    alone.then(|| load[last].signum())
}

/// An entity with the columns of its velocities.
pub enum Local {
    Pair { force: usize, velocity: usize },
    Touching { forms: Touching, normal: usize, tangential: usize },
}

impl Local {
    /// `None` where the entity is not a plain contact.
    pub fn of(problem: &RateProblem, entity: &Entity) -> Option<Self> {
        let own = |form: usize| own_column(problem, form);
        match entity.touching {
            Some(forms) => Some(Self::Touching { forms, normal: own(forms.gap)?, tangential: own(forms.along)? }),
            None => {
                let [force, velocity] = entity.pair()?;
                (force.sign == 1.0 && velocity.sign == 1.0)
                    .then_some(Self::Pair { force: force.form, velocity: own(velocity.form)? })
            }
        }
    }

    /// The columns of the entity's velocities.
    fn columns(&self) -> impl Iterator<Item = usize> {
        let (first, second) = match *self {
            Self::Pair { velocity, .. } => (velocity, None),
            Self::Touching { normal, tangential, .. } => (normal, Some(tangential)),
        };
        std::iter::once(first).chain(second)
    }

    /// Sets the entity's velocities such that its own conditions hold; returns its option.
    pub fn solve(&self, forms: &DMatrix<f64>, weights: &mut DVector<f64>) -> Option<usize> {
        let value = |form: usize, weights: &DVector<f64>| -> f64 {
            (0..weights.len()).map(|column| forms[(form, column)] * weights[column]).sum()
        };
        match *self {
            Self::Pair { force, velocity } => {
                weights[velocity] = 0.0;
                let held = value(force, weights);
                let stiffness = forms[(force, velocity)];
                if held >= 0.0 {
                    return Some(0);
                }
                (stiffness > 0.0).then(|| {
                    weights[velocity] = -held / stiffness;
                    1
                })
            }
            Self::Touching { forms: own, normal, tangential } => {
                (weights[normal], weights[tangential]) = (0.0, 0.0);
                let cone = own.cone.map(|form| value(form, weights));
                if cone[0] >= 0.0 && cone[1] >= 0.0 {
                    return Some(0);
                }
                let (pressing, traction) = (value(own.pressing, weights), value(own.traction, weights));
                for (side, sense) in [(0, 1.0), (1, -1.0)] {
                    let stiffness = forms[(own.cone[side], tangential)];
                    let motion = -cone[side] / stiffness;
                    let pressed = pressing + forms[(own.pressing, tangential)] * motion;
                    let rounding = RELATIVE_ROUND_OFF * (traction.abs() + pressing.abs());
                    if sense * motion > 0.0 && pressed >= -rounding {
                        weights[tangential] = motion;
                        return Some(1 + side);
                    }
                }
                let entry = |form: usize, column: usize| forms[(form, column)];
                let (a, b) = (entry(own.pressing, normal), entry(own.pressing, tangential));
                let (c, d) = (entry(own.traction, normal), entry(own.traction, tangential));
                let determinant = a * d - b * c;
                let opening = -(d * pressing - b * traction) / determinant;
                (determinant > 0.0).then(|| {
                    weights[normal] = opening.max(0.0);
                    weights[tangential] = -(a * traction - c * pressing) / determinant;
                    3
                })
            }
        }
    }
}

fn settle(
    problem: &RateProblem,
    locals: &[Local],
    load: f64,
    relaxation: f64,
    cancel: &CancelFlag,
) -> Option<Vec<usize>> {
    let forms = &problem.forms;
    let mut weights = DVector::zeros(problem.weights());
    weights[problem.weights() - 1] = load;
    let mut chosen = vec![usize::MAX; locals.len()];
    let (mut worked, mut unchanged, mut enough) = (0, 0, UNCHANGED);
    let mut first: Option<f64> = None;
    loop {
        budget::spend(forms.len());
        if cancel.is_cancelled() || worked > WORK {
            return None;
        }
        worked += 5 * locals.len() * weights.len();
        let mut same = true;
        let (mut change, mut largest) = (0.0_f64, 0.0_f64);
        for (local, chosen) in locals.iter().zip(&mut chosen) {
            let before: [f64; 2] = pick(local, &weights);
            let option = local.solve(forms, &mut weights)?;
            same &= option == *chosen;
            *chosen = option;
            for (column, before) in local.columns().zip(before) {
                let own = weights[column];
                // A velocity that its own conditions set to zero remains zero, and relaxation reverses no velocity.
                let relaxed = before + relaxation * (own - before);
                weights[column] = if own == 0.0 || relaxed * own <= 0.0 { own } else { relaxed };
                change = change.max((own - before).abs());
                largest = largest.max(own.abs());
            }
        }
        let most = DIVERGENT_GROWTH * *first.get_or_insert(largest.max(f64::MIN_POSITIVE));
        if !largest.is_finite() || largest > most {
            return None;
        }
        unchanged = if same { unchanged + 1 } else { 0 };
        if same && change <= SETTLED_CHANGE * largest
            || unchanged >= enough && ray_of_combination::is_feasible(problem, &chosen)
        {
            return Some(chosen);
        }
        if unchanged >= enough {
            enough *= 2;
        }
    }
}

fn pick(local: &Local, weights: &DVector<f64>) -> [f64; 2] {
    let mut values = [0.0; 2];
    values.iter_mut().zip(local.columns()).for_each(|(value, column)| *value = weights[column]);
    values
}
