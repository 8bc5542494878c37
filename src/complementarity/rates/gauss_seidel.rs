//! A likely combination by sweeps over the entities, each solved by itself with the others as they are.
//!
//! Nonlinear Gauss-Seidel for contact and friction (M. Jean, Comput. Methods Appl. Mech. Eng. 177 (1999) 235,
//! doi:10.1016/S0045-7825(98)00383-1), in velocities. Where the structure is stable it comes to the combination that
//! goes on, however many contacts touch; what it gives is examined exactly like any other combination. Along a chain of
//! contacts plain sweeps take a number that grows with the square of its length; they are over-relaxed (C. W. Cryer,
//! SIAM J. Control 9 (1971) 385, doi:10.1137/0309028), and plain again where that does not settle.

use crate::complementarity::rates::rate_problem::{Entity, RateProblem, Touching};
use crate::complementarity::rates::ray;
use crate::resources::budget;
use crate::resources::cancel::CancelFlag;
use nalgebra::{DMatrix, DVector};

/// Products that the sweeps of one sign of the load rate may take with one factor of relaxation.
const WORK: usize = 100_000_000;
/// Sweeps without a change of any option after which the combination is looked at, the first time.
const UNCHANGED: usize = 30;
/// Velocities this much larger than at first do not settle any more.
const GROWN: f64 = 1e9;
/// Change of the largest velocity in a sweep, over that velocity, below which the sweeps have settled.
const SETTLED: f64 = 1e-12;
/// Factors of relaxation, tried one after another.
const RELAXATIONS: [f64; 3] = [1.9, 1.6, 1.0];

/// A coefficient this small is none.
const ROUND_OFF: f64 = 1e-12;

/// The combinations that the sweeps settle on, for a rising and a falling load; none where the entities are not plain
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
    let load = problem.motion.row(problem.motion.nrows() - 1);
    let alone = load[last] != 0.0 && (0..last).all(|column| load[column].abs() <= 1e-9 * load[last].abs());
    alone.then(|| load[last].signum())
}

/// An entity with the columns of its velocities.
pub enum Local {
    Pair { force: usize, velocity: usize },
    Touching { forms: Touching, normal: usize, tangential: usize },
}

impl Local {
    /// `None` where the entity is no plain contact.
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

    /// Puts the entity's velocities where its own conditions hold; its option.
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
                    let rounding = ROUND_OFF * (traction.abs() + pressing.abs());
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

/// The weight that a velocity is.
pub fn own_column(problem: &RateProblem, form: usize) -> Option<usize> {
    let row = problem.forms.row(form);
    // One up to the rounding of a frame that is not along the axes.
    let mut filled = (0..row.len()).filter(|column| row[*column].abs() > ROUND_OFF);
    match (filled.next(), filled.next()) {
        (Some(column), None) if (row[column] - 1.0).abs() < ROUND_OFF => Some(column),
        _ => None,
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
                // What its own conditions hold at zero stays there, and nothing turns round.
                let relaxed = before + relaxation * (own - before);
                weights[column] = if own == 0.0 || relaxed * own <= 0.0 { own } else { relaxed };
                change = change.max((own - before).abs());
                largest = largest.max(own.abs());
            }
        }
        let most = GROWN * *first.get_or_insert(largest.max(f64::MIN_POSITIVE));
        if !largest.is_finite() || largest > most {
            return None;
        }
        unchanged = if same { unchanged + 1 } else { 0 };
        if same && change <= SETTLED * largest || unchanged >= enough && ray::is_feasible(problem, &chosen) {
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
