//! The dual simplex method on a dictionary, and the removal of coordinates that a row forces to zero.

use crate::complementarity::rates::simplex_dictionary::tolerances::{
    FORCING_COEFFICIENT, INFEASIBILITY_TOLERANCE, SMALLEST_PIVOT, VANISHING_COEFFICIENT,
};
use crate::complementarity::rates::simplex_dictionary::{Dictionary, Feasibility, Variable, VariablePosition};
use crate::resources::budget;

/// Whether the cone contains more than lines; the dictionary moves to a point of the cone.
pub fn feasibility(dictionary: &mut Dictionary) -> Feasibility {
    if dictionary.lines_only {
        return Feasibility::OnlyLines;
    }
    let most = 20 + 4 * (dictionary.rows.len() + dictionary.columns.len());
    for iteration in 0..most {
        // First the largest infeasibility, then, against cycling, Bland's rule.
        let by_order = 2 * iteration > most;
        let mut leaving: Option<(f64, usize)> = None;
        for row in 0..dictionary.rows.len() {
            let form = dictionary.rows[row];
            let value = dictionary.entry(row, 0);
            if !dictionary.nonnegative[form] || value >= -INFEASIBILITY_TOLERANCE {
                continue;
            }
            let better = match leaving {
                None => true,
                Some((_, known)) if by_order => form < dictionary.rows[known],
                Some((least, _)) => value < least,
            };
            if better {
                leaving = Some((value, row));
            }
        }
        let Some((value, row)) = leaving else { return Feasibility::Feasible };
        let mut entering: Option<(f64, usize)> = None;
        let mut largest_small = 0.0_f64;
        for column in 1..dictionary.columns.len() {
            let size = dictionary.entry(row, column);
            let Variable::Form(form) = dictionary.columns[column] else { continue };
            if size <= SMALLEST_PIVOT {
                largest_small = largest_small.max(size);
                continue;
            }
            let better = match entering {
                None => true,
                Some((_, known)) if by_order => Variable::Form(form) < dictionary.columns[known],
                Some((largest, _)) => size > largest,
            };
            if better {
                entering = Some((size, column));
            }
        }
        match entering {
            Some((_, column)) => dictionary.pivot(row, column),
            // Coordinates are at most of the magnitude of `t`: the contribution of small coefficients has to be
            // negligible.
            None if largest_small * dictionary.columns.len() as f64 <= -0.1 * value => return Feasibility::OnlyLines,
            None => return Feasibility::Feasible,
        }
        // An entry that is not finite shows in the values of the point, at the latest when it enters them.
        if !(0..dictionary.rows.len()).all(|row| dictionary.entry(row, 0).is_finite()) {
            return Feasibility::Feasible;
        }
    }
    Feasibility::Feasible
}

/// Drops coordinates that some row forces to zero: a nonnegative form without positive coefficients.
pub fn drop_forced(dictionary: &mut Dictionary) {
    let mut row = 0;
    while row < dictionary.rows.len() {
        let used = dictionary.columns.len();
        budget::spend(used);
        let values = &dictionary.table[row * dictionary.width..row * dictionary.width + used];
        let forces = dictionary.nonnegative[dictionary.rows[row]]
            && values[0].abs() <= VANISHING_COEFFICIENT
            && values[1..].iter().all(|value| *value <= VANISHING_COEFFICIENT)
            && (1..used).all(|column| {
                dictionary.columns[column] != Variable::Weight || values[column].abs() <= VANISHING_COEFFICIENT
            });
        let forced =
            if forces { (1..used).rev().filter(|c| values[*c] < -FORCING_COEFFICIENT).collect() } else { Vec::new() };
        if forced.is_empty() {
            row += 1;
            continue;
        }
        for column in forced {
            if let Variable::Form(form) = dictionary.columns[column] {
                dictionary.drop_column(column);
                dictionary.place[form] = VariablePosition::Zero;
            }
        }
        row = 0;
    }
}

impl PartialOrd for Variable {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Variable {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let key = |variable: &Self| match variable {
            Self::Form(form) => *form,
            Self::Weight => usize::MAX,
        };
        key(self).cmp(&key(other))
    }
}
