//! The cone that remains when some entities are decided, as a simplex dictionary.
//!
//! Every form `x_i` is written in terms of the forms chosen as coordinates and of `t`, the sum of all forms initially
//! known to be nonnegative:
//!
//! ```text
//! x_i = Σ_j D_ij x_j + h_i t,      x_j >= 0 where known,      t = 1
//! ```
//!
//! `t` is positive on the whole cone except on its lines, so the cone contains only lines where the linear program has
//! no feasible point: a row with `h_i < 0` and no `D_ij > 0` proves this (Farkas). The dual simplex method without an
//! objective finds a point or such a row (V. Chvátal, *Linear Programming*, Freeman 1983, chapters 2 and 10). A zero
//! form becomes a coordinate and is dropped, so that the dictionary shrinks from parent to child, and a child starts
//! from its parent's point.

pub(crate) mod simplex;
pub(crate) mod tolerances;

use crate::complementarity::rates::rate_problem::{RateProblem, Signed};
use crate::complementarity::rates::simplex_dictionary::tolerances::{
    INFEASIBILITY_TOLERANCE, SMALLEST_PIVOT, VANISHING_COEFFICIENT,
};
use crate::resources::budget::{self, Taken};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Variable {
    Form(usize),
    /// A weight that is not replaced by a form known to be nonnegative: a line in the cone, as far as is known.
    Weight,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum VariablePosition {
    Row(usize),
    Column(usize),
    Zero,
}

/// The feasibility of the cone, as far as established.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feasibility {
    /// The dictionary's own point is in the cone (or the test was inconclusive).
    Feasible,
    /// The cone contains only lines.
    OnlyLines,
}

/// A simplex dictionary. Column 0 is `t`.
#[derive(Debug, Clone)]
pub struct Dictionary {
    width: usize,
    columns: Vec<Variable>,
    rows: Vec<usize>,
    /// `rows x width`, row by row; the leading `columns + 1` entries of a row are in use.
    table: Vec<f64>,
    place: Vec<VariablePosition>,
    /// Sign with which each form is stored.
    sign: Vec<f64>,
    nonnegative: Vec<bool>,
    /// The cone has been found to contain only lines: `t = 0`, and every form known to be nonnegative is zero.
    lines_only: bool,
    /// Number of entries changed since [`begin_count`](Self::begin_count).
    entries_changed: u64,
    _held: Taken,
}

impl Dictionary {
    /// The cone of the inequalities common to all options of each entity. The load rate is the last form.
    pub fn new(problem: &RateProblem, common: &[Vec<Signed>]) -> Option<Self> {
        let weights = problem.weights();
        let count = problem.forms.nrows() + 1;
        let scales = &problem.sizes;
        if scales.iter().any(|scale| !scale.is_finite() || *scale <= 0.0) {
            return None;
        }
        let width = weights + 1;
        let held = budget::take::<f64>((count + 1) * width);
        budget::spend((count + 1) * width);
        let mut table = vec![0.0; (count + 1) * width];
        for form in 0..count {
            let row = &mut table[form * width..(form + 1) * width];
            for weight in 0..weights {
                let value = if form + 1 == count { problem.load[weight] } else { problem.forms[(form, weight)] };
                row[weight + 1] = value / scales[weight];
            }
            let size = row.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
            if !size.is_finite() {
                return None;
            }
            if size > 0.0 {
                row.iter_mut().for_each(|value| *value /= size);
            }
        }
        let mut dictionary = Self {
            width,
            columns: vec![Variable::Weight; weights + 1],
            rows: (0..count).collect(),
            table,
            place: (0..count).map(VariablePosition::Row).collect(),
            sign: vec![1.0; count],
            nonnegative: vec![false; count],
            lines_only: false,
            entries_changed: 0,
            _held: held,
        };
        common.iter().flatten().for_each(|signed| dictionary.declare(*signed));
        dictionary.normalise(count);
        while dictionary.replace_weight().is_some() {}
        Some(dictionary)
    }

    /// Begins to count the entries that change, with those of a copy.
    pub fn begin_count(&mut self) {
        self.entries_changed = self.table.len() as u64;
    }

    /// Number of entries changed since [`begin_count`](Self::begin_count).
    pub fn entries_changed(&self) -> u64 {
        self.entries_changed
    }

    /// Makes `t` the first column.
    fn normalise(&mut self, count: usize) {
        let last = count * self.width;
        for row in 0..count {
            if self.nonnegative[self.rows[row]] {
                for column in 1..self.width {
                    self.table[last + column] += self.table[row * self.width + column];
                }
            }
        }
        let row = &self.table[last..last + self.width];
        let pivot = (1..self.width).max_by(|a, b| row[*a].abs().total_cmp(&row[*b].abs()));
        match pivot.filter(|pivot| row[*pivot].abs() > VANISHING_COEFFICIENT) {
            None => {
                // No form is known to be nonnegative: the cone consists of lines.
                self.table.truncate(last);
                self.lines_only = true;
            }
            Some(pivot) => {
                self.exchange(count, pivot);
                // Row `count` is the weight that left; the column is `t` and moves to the front.
                self.table.truncate(last);
                for row in 0..count {
                    let start = row * self.width;
                    self.table[start] = self.table[start + pivot];
                }
                self.drop_column(pivot);
            }
        }
    }

    fn declare(&mut self, signed: Signed) {
        let form = signed.form;
        if self.nonnegative[form] && self.sign[form] == signed.sign {
            return;
        }
        if self.nonnegative[form] {
            // Nonnegative with either sign, hence zero: left to the options that contain this equation.
            return;
        }
        if self.sign[form] != signed.sign {
            self.sign[form] = signed.sign;
            match self.place[form] {
                VariablePosition::Row(row) => {
                    let start = row * self.width;
                    self.table[start..start + self.columns.len()].iter_mut().for_each(|value| *value = -*value);
                }
                VariablePosition::Column(column) => {
                    for row in 0..self.rows.len() {
                        let value = &mut self.table[row * self.width + column];
                        *value = -*value;
                    }
                }
                VariablePosition::Zero => {}
            }
        }
        self.nonnegative[form] = true;
    }

    /// Exchanges a row's variable for a column's, in the table only.
    fn exchange(&mut self, row: usize, column: usize) {
        let width = self.width;
        let used = self.columns.len();
        let entries = self.table.len() / width * used;
        budget::spend(entries);
        self.entries_changed += entries as u64;
        let start = row * width;
        let inverse = 1.0 / self.table[start + column];
        for k in 0..used {
            self.table[start + k] *= -inverse;
        }
        self.table[start + column] = inverse;
        let pivot_row: Vec<f64> = self.table[start..start + used].to_vec();
        let rows = self.table.len() / width;
        for other in 0..rows {
            if other == row {
                continue;
            }
            let values = &mut self.table[other * width..other * width + used];
            let factor = values[column];
            if factor == 0.0 {
                continue;
            }
            values[column] = 0.0;
            for (value, pivot) in values.iter_mut().zip(&pivot_row) {
                *value += factor * pivot;
            }
        }
    }

    /// Makes a row's form a coordinate in place of a column's variable.
    fn pivot(&mut self, row: usize, column: usize) {
        self.exchange(row, column);
        let form = self.rows[row];
        self.place[form] = VariablePosition::Column(column);
        match std::mem::replace(&mut self.columns[column], Variable::Form(form)) {
            Variable::Form(other) => {
                self.rows[row] = other;
                self.place[other] = VariablePosition::Row(row);
            }
            Variable::Weight => self.drop_row(row),
        }
    }

    fn drop_row(&mut self, row: usize) {
        let last = self.rows.len() - 1;
        if row != last {
            self.table.copy_within(last * self.width..(last + 1) * self.width, row * self.width);
            self.rows[row] = self.rows[last];
            self.place[self.rows[row]] = VariablePosition::Row(row);
        }
        self.rows.pop();
        self.table.truncate(last * self.width);
    }

    fn drop_column(&mut self, column: usize) {
        let last = self.columns.len() - 1;
        if column != last {
            for row in 0..self.table.len() / self.width {
                self.table[row * self.width + column] = self.table[row * self.width + last];
            }
            self.columns[column] = self.columns[last];
            if let Variable::Form(form) = self.columns[column] {
                self.place[form] = VariablePosition::Column(column);
            }
        }
        self.columns.pop();
    }

    fn entry(&self, row: usize, column: usize) -> f64 {
        self.table[row * self.width + column]
    }

    /// Replaces a free weight by a form known to be nonnegative, with the largest pivot; returns the column replaced,
    /// if any.
    fn replace_weight(&mut self) -> Option<usize> {
        budget::spend(self.rows.len() * self.columns.len());
        let mut best = (VANISHING_COEFFICIENT, 0, 0);
        for column in 1..self.columns.len() {
            if self.columns[column] != Variable::Weight {
                continue;
            }
            for row in 0..self.rows.len() {
                if self.nonnegative[self.rows[row]] && self.entry(row, column).abs() > best.0 {
                    best = (self.entry(row, column).abs(), row, column);
                }
            }
        }
        if best.2 == 0 {
            return None;
        }
        self.pivot(best.1, best.2);
        Some(best.2)
    }

    /// Makes `t` positive on lines that have become rays.
    fn count_rays_in(&mut self) {
        while let Some(column) = self.replace_weight() {
            let Variable::Form(form) = self.columns[column] else { return };
            if self.lines_only {
                // The form itself becomes `t`.
                self.lines_only = false;
                for row in 0..self.rows.len() {
                    self.table[row * self.width] = self.entry(row, column);
                }
                self.drop_column(column);
                self.place[form] = VariablePosition::Row(self.rows.len());
                self.rows.push(form);
                let start = self.table.len();
                self.table.resize(start + self.width, 0.0);
                self.table[start] = 1.0;
            } else {
                // t' = t + x_c
                for row in 0..self.rows.len() {
                    let start = row * self.width;
                    self.table[start + column] -= self.table[start];
                }
            }
        }
    }

    /// Number of columns without `t`: the dimension of the remaining cone, minus one unless the cone consists of lines.
    pub fn dimension(&self) -> usize {
        self.columns.len() - 1
    }

    pub fn lines(&self) -> usize {
        self.columns[1..].iter().filter(|variable| **variable == Variable::Weight).count()
    }

    pub fn is_lines_only(&self) -> bool {
        self.lines_only
    }

    /// Adds an inequality, on a form or on the load rate (`None`).
    pub fn require(&mut self, form: Option<usize>, sign: f64) {
        let form = form.unwrap_or(self.place.len() - 1);
        self.declare(Signed { form, sign });
        self.count_rays_in();
    }

    /// Makes the load rate zero; `false` where only zero remains.
    pub fn rest_load(&mut self) -> bool {
        self.make_zero(self.place.len() - 1)
    }

    /// Makes a form zero; `false` where only zero remains.
    pub fn make_zero(&mut self, form: usize) -> bool {
        let column = match self.place[form] {
            VariablePosition::Zero => return true,
            VariablePosition::Column(column) => column,
            VariablePosition::Row(row) => {
                // A free weight is replaced first, so that nonnegative forms remain coordinates.
                let best = (1..self.columns.len())
                    .map(|column| {
                        let size = self.entry(row, column).abs();
                        (size, self.columns[column] == Variable::Weight && size > SMALLEST_PIVOT, column)
                    })
                    .filter(|(size, _, _)| *size > VANISHING_COEFFICIENT)
                    .max_by(|a, b| a.1.cmp(&b.1).then(a.0.total_cmp(&b.0)).then(b.2.cmp(&a.2)));
                match best {
                    Some((size, _, column)) if size > SMALLEST_PIVOT => {
                        self.pivot(row, column);
                        column
                    }
                    None if !self.lines_only && self.entry(row, 0).abs() > INFEASIBILITY_TOLERANCE => {
                        return self.leave_lines();
                    }
                    // Already zero, or too close to zero to decide: the condition is omitted, which enlarges the cone,
                    // never reduces it.
                    _ => {
                        self.drop_row(row);
                        self.place[form] = VariablePosition::Zero;
                        return true;
                    }
                }
            }
        };
        self.drop_column(column);
        self.place[form] = VariablePosition::Zero;
        !(self.lines_only && self.columns.len() == 1)
    }

    /// Reduces the cone to its lines: `t` and every nonnegative coordinate are zero. `false` where there are no lines.
    pub fn leave_lines(&mut self) -> bool {
        self.lines_only = true;
        self.forget_pointed();
        self.columns.len() > 1
    }

    fn forget_pointed(&mut self) {
        let mut column = 1;
        while column < self.columns.len() {
            match self.columns[column] {
                Variable::Form(form) => {
                    self.drop_column(column);
                    self.place[form] = VariablePosition::Zero;
                }
                Variable::Weight => column += 1,
            }
        }
        for row in 0..self.rows.len() {
            self.table[row * self.width] = 0.0;
        }
    }

    /// The form's value at the dictionary's point.
    pub fn value(&self, signed: Signed) -> f64 {
        match self.place[signed.form] {
            VariablePosition::Row(row) => signed.sign * self.sign[signed.form] * self.entry(row, 0),
            VariablePosition::Column(_) | VariablePosition::Zero => 0.0,
        }
    }

    /// Whether the form is zero on the whole remaining cone.
    pub fn vanishes(&self, form: usize) -> bool {
        match self.place[form] {
            VariablePosition::Zero => true,
            VariablePosition::Column(_) => false,
            VariablePosition::Row(row) => {
                self.entry(row, 0).abs() <= INFEASIBILITY_TOLERANCE
                    && (1..self.columns.len()).all(|column| self.entry(row, column).abs() <= INFEASIBILITY_TOLERANCE)
            }
        }
    }

    /// The form's coefficients over `t` and the coordinates, with the given sign.
    pub fn coefficients(&self, form: Option<usize>, sign: f64) -> Vec<f64> {
        let form = form.unwrap_or(self.place.len() - 1);
        let mut coefficients = vec![0.0; self.columns.len()];
        match self.place[form] {
            VariablePosition::Zero => {}
            VariablePosition::Column(column) => coefficients[column] = 1.0,
            VariablePosition::Row(row) => {
                coefficients.copy_from_slice(&self.table[row * self.width..row * self.width + self.columns.len()]);
            }
        }
        let sign = sign * self.sign[form];
        coefficients.iter_mut().for_each(|value| *value *= sign);
        coefficients
    }
}
