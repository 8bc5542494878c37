//! The dual simplex method on a dictionary, and coordinates that it forces to zero.

use crate::complementarity::rates::simplex_dictionary::{
    Dictionary, Feasibility, INFEASIBLE, NOTHING, SMALL_PIVOT, Variable, VariablePosition,
};
use crate::resources::budget;

/// Coefficients by which a coordinate is forced to zero.
const FORCING: f64 = 1e-3;

impl Dictionary {
    /// Whether a point is left; the dictionary moves to it.
    pub fn feasibility(&mut self) -> Feasibility {
        if self.lines_only {
            return Feasibility::OnlyLines;
        }
        let most = 20 + 4 * (self.rows.len() + self.columns.len());
        for iteration in 0..most {
            // First the largest infeasibility, then, against cycling, Bland's rule.
            let by_order = 2 * iteration > most;
            let mut leaving: Option<(f64, usize)> = None;
            for row in 0..self.rows.len() {
                let form = self.rows[row];
                let value = self.entry(row, 0);
                if !self.nonnegative[form] || value >= -INFEASIBLE {
                    continue;
                }
                let better = match leaving {
                    None => true,
                    Some((_, known)) if by_order => form < self.rows[known],
                    Some((least, _)) => value < least,
                };
                if better {
                    leaving = Some((value, row));
                }
            }
            let Some((value, row)) = leaving else { return Feasibility::Feasible };
            let mut entering: Option<(f64, usize)> = None;
            let mut largest_small = 0.0_f64;
            for column in 1..self.columns.len() {
                let size = self.entry(row, column);
                let Variable::Form(form) = self.columns[column] else { continue };
                if size <= SMALL_PIVOT {
                    largest_small = largest_small.max(size);
                    continue;
                }
                let better = match entering {
                    None => true,
                    Some((_, known)) if by_order => Variable::Form(form) < self.columns[known],
                    Some((largest, _)) => size > largest,
                };
                if better {
                    entering = Some((size, column));
                }
            }
            match entering {
                Some((_, column)) => self.pivot(row, column),
                // Coordinates are at most of the size of `t`: what small coefficients may add must not matter.
                None if largest_small * self.columns.len() as f64 <= -0.1 * value => return Feasibility::OnlyLines,
                None => return Feasibility::Feasible,
            }
            // What is not finite anywhere shows in the values of the point, at the latest when it enters them.
            if !(0..self.rows.len()).all(|row| self.entry(row, 0).is_finite()) {
                return Feasibility::Feasible;
            }
        }
        Feasibility::Feasible
    }

    /// Drops coordinates that some row forces to zero: a form that is not negative, with no positive coefficient.
    pub fn drop_forced(&mut self) {
        let mut row = 0;
        while row < self.rows.len() {
            let used = self.columns.len();
            budget::spend(used);
            let values = &self.table[row * self.width..row * self.width + used];
            let forces = self.nonnegative[self.rows[row]]
                && values[0].abs() <= NOTHING
                && values[1..].iter().all(|value| *value <= NOTHING)
                && (1..used).all(|column| self.columns[column] != Variable::Weight || values[column].abs() <= NOTHING);
            let forced = if forces { (1..used).rev().filter(|c| values[*c] < -FORCING).collect() } else { Vec::new() };
            if forced.is_empty() {
                row += 1;
                continue;
            }
            for column in forced {
                if let Variable::Form(form) = self.columns[column] {
                    self.drop_column(column);
                    self.place[form] = VariablePosition::Zero;
                }
            }
            row = 0;
        }
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
