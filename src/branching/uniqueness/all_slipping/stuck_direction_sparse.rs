//! Computes, with sparse matrices, the direction along which all contacts on the cone stick.

use crate::algebra::dense::matrix_sink::Sink;
use crate::algebra::sparse::{Bordered, Holdings, SparseFactorisation};
use crate::branching::uniqueness::all_slipping::ReducedUnknowns;
use crate::branching::uniqueness::all_slipping::tolerances::{
    DEFINITENESS_TOLERANCE, SMALLEST_LOAD_RATE, STRICT_MARGIN,
};
use crate::mechanics::problem::state::Rate;
use nalgebra::DVector;

/// The equations of the unknowns, each at its place in the structure's sparsity pattern.
struct EquationsOfMany {
    place_of: Vec<usize>,
    is_slip: Vec<bool>,
    /// The symmetric part, with room for a border.
    symmetric: Bordered,
    /// The equations of the non-slipping unknowns alone.
    held: Bordered,
    load: DVector<f64>,
}

/// The same with sparse matrices: where the whole matrix is definite, or is so across the load (see
/// `sparse_uniqueness`).
pub(super) fn stuck_among_many(reduced: &ReducedUnknowns<'_>, incoming: &Rate) -> Option<Rate> {
    let EquationsOfMany { place_of, is_slip, symmetric, held, load } = equations_of_many(reduced)?;
    let size = load.len();
    let by_power = is_by_power(symmetric, &load, incoming)?;
    let others = reduced.unknowns_where(false);
    let mut values = DVector::from_fn(size, |unknown, _| if is_slip[unknown] { 0.0 } else { load[unknown] });
    if !others.is_empty() && !SparseFactorisation::new(held, &Holdings::default())?.solve(&mut values) {
        return None;
    }
    let response = DVector::from_iterator(others.len(), others.iter().map(|other| values[place_of[*other]]));
    if !by_power {
        return reduced.stuck_rate(&others, &response).filter(|stuck| stuck.load * incoming.load < 0.0);
    }
    // One direction for each sign of the power; the load alone changes where no other motion has power.
    let power = |motion: &dyn Fn(usize) -> f64, slips: bool| -> f64 {
        let unknowns = (0..reduced.unknowns.len()).filter(|unknown| slips || !reduced.unknowns[*unknown].is_slip);
        unknowns.map(|unknown| load[place_of[unknown]] * motion(unknown)).sum()
    };
    let mut columns = vec![0.0; reduced.unknowns.len()];
    for (freedom, velocity) in incoming.displacement.iter().enumerate() {
        reduced.motions().of(freedom).0.iter().for_each(|part| columns[part.unknown] += part.motion * velocity);
    }
    let largest = load.amax();
    let own = power(&|unknown| columns[unknown], true);
    if own.abs() <= STRICT_MARGIN * largest {
        return None;
    }
    if others.iter().all(|other| load[place_of[*other]] == 0.0) {
        return reduced.stuck_rate(&others, &response);
    }
    let of_stuck = power(&|unknown| values[place_of[unknown]], false);
    if of_stuck.abs() <= STRICT_MARGIN * largest * response.norm() {
        return None;
    }
    reduced.stuck_rate(&others, &response).filter(|stuck| stuck.load * own * of_stuck < 0.0)
}

/// The equations, where the structure's sparsity pattern has room for them.
fn equations_of_many(reduced: &ReducedUnknowns<'_>) -> Option<EquationsOfMany> {
    let structure = reduced.loading.structure;
    let layout = structure.layout()?;
    let pattern = &layout.pattern;
    let size = pattern.size();
    let place_of: Vec<usize> =
        reduced.unknowns.iter().map(|unknown| structure.unknown_of[unknown.freedom]).collect::<Option<_>>()?;
    let mut held = Bordered::new(pattern.clone(), 0);
    let (mut symmetric, mut load) = (Bordered::new(pattern.clone(), 1), DVector::zeros(size));
    let mut is_outside = false;
    reduced.each_entry(&mut |row, column, value| match column {
        Some(column) => {
            let (own, transposed) = (place_of[row], place_of[column]);
            match (pattern.place(own, transposed), pattern.place(transposed, own)) {
                (Some(place), Some(mirror)) => {
                    symmetric.add_at(place, 0.5 * value);
                    symmetric.add_at(mirror, 0.5 * value);
                    if !reduced.unknowns[row].is_slip && !reduced.unknowns[column].is_slip {
                        held.add_at(place, value);
                    }
                }
                _ => is_outside = true,
            }
        }
        None => load[place_of[row]] -= value,
    });
    let (mut is_used, mut is_slip) = (vec![false; size], vec![false; size]);
    for (place, unknown) in place_of.iter().zip(&reduced.unknowns) {
        (is_used[*place], is_slip[*place]) = (true, unknown.is_slip);
    }
    for unknown in 0..size {
        let place = pattern.place(unknown, unknown)?;
        if !is_used[unknown] {
            symmetric.add_at(place, 1.0);
        }
        if !is_used[unknown] || is_slip[unknown] {
            held.add_at(place, 1.0);
        }
    }
    if is_outside {
        return None;
    }
    Some(EquationsOfMany { place_of, is_slip, symmetric, held, load })
}

/// Whether uniqueness holds for each sign of the power, rather than of the load rate; `None` where it is proven for
/// neither.
fn is_by_power(mut symmetric: Bordered, load: &DVector<f64>, incoming: &Rate) -> Option<bool> {
    let size = load.len();
    let inertia = symmetric.inertia(DEFINITENESS_TOLERANCE)?;
    match (inertia.negative, inertia.zero) {
        (0, 0) if incoming.load.abs() > SMALLEST_LOAD_RATE => Some(false),
        (1, 0) => {
            for (unknown, load) in load.iter().enumerate() {
                symmetric.add(unknown, size, *load);
                symmetric.add(size, unknown, *load);
            }
            // The symmetric part has one negative eigenvalue, not two.
            let bordered = SparseFactorisation::new(symmetric, &Holdings::default())?;
            if bordered.determinant_sign() > 0.0 || bordered.pivot_ratio() <= DEFINITENESS_TOLERANCE {
                return None;
            }
            Some(true)
        }
        _ => None,
    }
}
