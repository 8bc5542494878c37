//! The smooth program in place of the program with complementarity constraints, and its linearisation.
//!
//! Each pair `0 <= a ⊥ b >= 0` is treated in one of these ways (`smooth_program::pair_treatment`):
//!
//! ```text
//! Product(ε):   a >= 0,  b >= 0,  ε - a b >= 0          the regularisation, ε falling to 0
//! FirstZero:    a  = 0,  b >= 0                         one branch
//! SecondZero:   a >= 0,  b  = 0                         the other
//! BothFree:     a >= 0,  b >= 0                         relaxed: multipliers here decide strong stationarity
//! BothZero:     a  = 0,  b  = 0                         tightened
//! ```
//!
//! Linearised at `x`, with the step `d`: `a + ∇a·d`, and `ε - a b - (b ∇a + a ∇b)·d >= 0` for the product.
//!
//! Cone pairs are treated likewise (`smooth_program::cone_rows`).
//!
//! Source: S. Scholtes, *Convergence properties of a regularization scheme for mathematical programs with
//! complementarity constraints*, SIAM J. Optim. 11 (2001), doi:10.1137/S1052623499361233. With multipliers `λ_a, λ_b, π`
//! of the three rows of a product, the pair's own multipliers are `ν_a = λ_a - π b` and `ν_b = λ_b - π a`.

use nalgebra::DVector;

use crate::complementarity::mpec::program::cone;
use crate::complementarity::mpec::program::evaluation::{ConeMembers, ProgramEvaluation};
use crate::complementarity::mpec::program::sparse_rows::SparseRows;
use crate::complementarity::mpec::quadratic_program::interior_point::{ConeRows, QuadraticProgram, QuadraticSolution};
use crate::complementarity::mpec::smooth_program::cone_rows::{ConeMember, ConeRow, ConeTreatment};
use crate::complementarity::mpec::smooth_program::pair_treatment::{PairTreatment, TreatmentPattern};

/// The constraint to which a row of the smooth program belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SmoothProgramRow {
    Equality(usize),
    Inequality(usize),
    First(usize),
    Second(usize),
    Product(usize),
    /// A row of a cone pair.
    Cone(usize, ConeRow),
}

/// Multipliers of the problem's own constraints; signs as in `quadratic_program::interior_point`.
#[warn(missing_docs)]
#[derive(Debug, Clone, PartialEq)]
pub struct Multipliers {
    /// One per equality, free in sign.
    pub equality: DVector<f64>,
    /// One per inequality, nonnegative.
    pub inequality: DVector<f64>,
    /// One per pair: `ν_a`, free in sign where `b > 0`.
    pub first: DVector<f64>,
    /// One per pair: `ν_b`.
    pub second: DVector<f64>,
    /// Multipliers of the cone pairs' first members, stacked as in
    /// [`crate::complementarity::mpec::Problem::cone_values`].
    pub cone_first: DVector<f64>,
    /// Multipliers of the cone pairs' second members.
    pub cone_second: DVector<f64>,
    /// One per variable, nonnegative.
    pub lower: DVector<f64>,
    /// One per variable, nonnegative.
    pub upper: DVector<f64>,
}

/// The rows of the smooth program for one choice of treatments.
#[derive(Debug, Clone)]
pub struct SmoothProgramRows {
    pattern: TreatmentPattern,
    equality: Vec<SmoothProgramRow>,
    inequality: Vec<SmoothProgramRow>,
    /// Members of cone pairs that have to lie in the cone.
    in_cone: Vec<(usize, ConeMember)>,
}

impl SmoothProgramRows {
    pub fn new(equalities: usize, inequalities: usize, cone_sizes: &[usize], pattern: TreatmentPattern) -> Self {
        let mut equality: Vec<SmoothProgramRow> = (0..equalities).map(SmoothProgramRow::Equality).collect();
        let mut inequality: Vec<SmoothProgramRow> = (0..inequalities).map(SmoothProgramRow::Inequality).collect();
        for (i, treatment) in pattern.pairs.iter().enumerate() {
            if treatment.first_is_zero() { &mut equality } else { &mut inequality }.push(SmoothProgramRow::First(i));
            if treatment.second_is_zero() { &mut equality } else { &mut inequality }.push(SmoothProgramRow::Second(i));
            if matches!(treatment, PairTreatment::Product(_)) {
                inequality.push(SmoothProgramRow::Product(i));
            }
        }
        let mut in_cone = Vec::new();
        for (i, (treatment, &size)) in pattern.cones.iter().zip(cone_sizes).enumerate() {
            equality.extend(treatment.equalities(size).into_iter().map(|row| SmoothProgramRow::Cone(i, row)));
            inequality.extend(treatment.inequality().map(|row| SmoothProgramRow::Cone(i, row)));
            in_cone.extend(treatment.in_cone().iter().map(|&member| (i, member)));
        }
        Self { pattern, equality, inequality, in_cone }
    }

    /// The bound on products; `None` where there is none.
    pub fn relaxation(&self) -> Option<f64> {
        self.pattern.relaxation()
    }

    fn value(&self, at: &ProgramEvaluation, row: SmoothProgramRow) -> f64 {
        match row {
            SmoothProgramRow::Equality(i) => at.equality[i],
            SmoothProgramRow::Inequality(i) => at.inequality[i],
            SmoothProgramRow::First(i) => at.first[i],
            SmoothProgramRow::Second(i) => at.second[i],
            SmoothProgramRow::Product(i) => match self.pattern.pairs[i] {
                PairTreatment::Product(relaxation) => relaxation - at.first[i] * at.second[i],
                PairTreatment::FirstZero
                | PairTreatment::SecondZero
                | PairTreatment::BothFree
                | PairTreatment::BothZero => 0.0,
            },
            SmoothProgramRow::Cone(i, row) => self.pattern.cones[i].value(&at.cones, i, row),
        }
    }

    /// Sum of the absolute violations of all rows.
    pub fn violation(&self, at: &ProgramEvaluation) -> f64 {
        let equalities: f64 = self.equality.iter().map(|&row| self.value(at, row).abs()).sum();
        let inequalities: f64 = self.inequality.iter().map(|&row| (-self.value(at, row)).max(0.0)).sum();
        let outside = |&(i, member): &(usize, ConeMember)| (-cone::slack(member_of(&at.cones, i, member))).max(0.0);
        let cones: f64 = self.in_cone.iter().map(outside).sum();
        equalities + inequalities + cones
    }

    /// The quadratic program at `x`; the caller supplies its Hessian.
    pub fn linearise(
        &self,
        at: &ProgramEvaluation,
        x: &DVector<f64>,
        bounds: &(DVector<f64>, DVector<f64>),
        hessian: SparseRows,
    ) -> QuadraticProgram {
        let n = x.len();
        let mut program = QuadraticProgram {
            hessian,
            gradient: at.gradient.clone(),
            equality: SparseRows::zeros(self.equality.len(), n),
            equality_values: DVector::zeros(self.equality.len()),
            inequality: SparseRows::zeros(self.inequality.len(), n),
            inequality_values: DVector::zeros(self.inequality.len()),
            lower: &bounds.0 - x,
            upper: &bounds.1 - x,
            cones: self.in_cone.iter().map(|&(i, member)| cone_rows(&at.cones, i, member)).collect(),
        };
        for (place, &row) in self.equality.iter().enumerate() {
            program.equality_values[place] = self.value(at, row);
            self.put_gradient(at, row, &mut program.equality, place);
        }
        for (place, &row) in self.inequality.iter().enumerate() {
            program.inequality_values[place] = self.value(at, row);
            self.put_gradient(at, row, &mut program.inequality, place);
        }
        self.drop_implied_bounds(&mut program);
        program
    }

    fn put_gradient(&self, at: &ProgramEvaluation, row: SmoothProgramRow, into: &mut SparseRows, place: usize) {
        if let SmoothProgramRow::Cone(i, row) = row {
            let (by_first, by_second) = ConeTreatment::derivatives(&at.cones, i, row);
            let range = at.cones.range(i);
            let gradient = at.cones.first_jacobian.rows(range.start, range.len()).tr_mul(&by_first)
                + at.cones.second_jacobian.rows(range.start, range.len()).tr_mul(&by_second);
            into.set_row(place, gradient.iter().copied().enumerate().filter(|(_, value)| *value != 0.0));
            return;
        }
        match row {
            SmoothProgramRow::Equality(i) => into.set_row(place, at.equality_jacobian.row(i).iter().copied()),
            SmoothProgramRow::Inequality(i) => into.set_row(place, at.inequality_jacobian.row(i).iter().copied()),
            SmoothProgramRow::First(i) => into.set_row(place, at.first_jacobian.row(i).iter().copied()),
            SmoothProgramRow::Second(i) => into.set_row(place, at.second_jacobian.row(i).iter().copied()),
            SmoothProgramRow::Product(i) => {
                into.add_to_row(place, -at.second[i], at.first_jacobian.row(i));
                into.add_to_row(place, -at.first[i], at.second_jacobian.row(i));
            }
            SmoothProgramRow::Cone(..) => {}
        }
    }

    /// Removes bounds implied by rows: where a pair's member is a single variable, its row and the variable's bound are
    /// equivalent, and with both the multipliers would not be unique.
    fn drop_implied_bounds(&self, program: &mut QuadraticProgram) {
        for (place, row) in self.equality.iter().enumerate() {
            if let (SmoothProgramRow::First(_) | SmoothProgramRow::Second(_), Some((j, slope))) =
                (row, only_entry(&program.equality, place))
            {
                let target = -program.equality_values[place] / slope;
                let margin = 1e-12 * (1.0 + target.abs());
                if program.lower[j] <= target + margin && target - margin <= program.upper[j] {
                    program.lower[j] = f64::NEG_INFINITY;
                    program.upper[j] = f64::INFINITY;
                }
            }
        }
        for (place, row) in self.inequality.iter().enumerate() {
            if let (SmoothProgramRow::First(_) | SmoothProgramRow::Second(_), Some((j, slope))) =
                (row, only_entry(&program.inequality, place))
            {
                let target = -program.inequality_values[place] / slope;
                let margin = 1e-12 * (1.0 + target.abs());
                if slope > 0.0 && program.lower[j] <= target + margin {
                    program.lower[j] = f64::NEG_INFINITY;
                } else if slope < 0.0 && program.upper[j] >= target - margin {
                    program.upper[j] = f64::INFINITY;
                }
            }
        }
    }

    /// Replaces the row values of `program` by those of a second-order correction: the functions at the trial point
    /// minus their linear part.
    pub fn correct(&self, program: &mut QuadraticProgram, trial: &ProgramEvaluation, step: &DVector<f64>) {
        for (place, &row) in self.equality.iter().enumerate() {
            program.equality_values[place] = self.value(trial, row);
        }
        for (place, &row) in self.inequality.iter().enumerate() {
            program.inequality_values[place] = self.value(trial, row);
        }
        program.equality_values -= &program.equality * step;
        program.inequality_values -= &program.inequality * step;
        for (cone, &(i, member)) in program.cones.iter_mut().zip(&self.in_cone) {
            cone.values.copy_from_slice(member_of(&trial.cones, i, member));
            cone.values -= &cone.rows * step;
        }
    }

    /// The multipliers of a quadratic program's rows, assigned to the problem's constraints.
    pub fn multipliers(&self, at: &ProgramEvaluation, solution: &QuadraticSolution) -> Multipliers {
        let pairs = self.pattern.pairs.len();
        let mut multipliers = Multipliers {
            equality: DVector::zeros(at.equality.len()),
            inequality: DVector::zeros(at.inequality.len()),
            first: DVector::zeros(pairs),
            second: DVector::zeros(pairs),
            cone_first: DVector::zeros(at.cones.first.len()),
            cone_second: DVector::zeros(at.cones.second.len()),
            lower: solution.lower_multipliers.clone(),
            upper: solution.upper_multipliers.clone(),
        };
        let equalities = self.equality.iter().zip(solution.equality_multipliers.iter());
        let inequalities = self.inequality.iter().zip(solution.inequality_multipliers.iter());
        for (&row, &value) in equalities.chain(inequalities) {
            match row {
                SmoothProgramRow::Equality(i) => multipliers.equality[i] += value,
                SmoothProgramRow::Inequality(i) => multipliers.inequality[i] += value,
                SmoothProgramRow::First(i) => multipliers.first[i] += value,
                SmoothProgramRow::Second(i) => multipliers.second[i] += value,
                SmoothProgramRow::Product(i) => {
                    multipliers.first[i] -= value * at.second[i];
                    multipliers.second[i] -= value * at.first[i];
                }
                SmoothProgramRow::Cone(i, row) => {
                    let (by_first, by_second) = ConeTreatment::derivatives(&at.cones, i, row);
                    let range = at.cones.range(i);
                    multipliers.cone_first.rows_mut(range.start, range.len()).axpy(value, &by_first, 1.0);
                    multipliers.cone_second.rows_mut(range.start, range.len()).axpy(value, &by_second, 1.0);
                }
            }
        }
        for (&(i, member), value) in self.in_cone.iter().zip(&solution.cone_multipliers) {
            let range = at.cones.range(i);
            let target = match member {
                ConeMember::First => &mut multipliers.cone_first,
                ConeMember::Second => &mut multipliers.cone_second,
            };
            let mut target = target.rows_mut(range.start, range.len());
            target += value;
        }
        multipliers
    }
}

fn member_of(cones: &ConeMembers, pair: usize, member: ConeMember) -> &[f64] {
    match member {
        ConeMember::First => cones.first_of(pair),
        ConeMember::Second => cones.second_of(pair),
    }
}

/// The linearised rows of a member that has to lie in the cone.
fn cone_rows(cones: &ConeMembers, pair: usize, member: ConeMember) -> ConeRows {
    let range = cones.range(pair);
    let jacobian = match member {
        ConeMember::First => &cones.first_jacobian,
        ConeMember::Second => &cones.second_jacobian,
    };
    ConeRows {
        rows: jacobian.rows(range.start, range.len()).into_owned(),
        values: DVector::from_column_slice(member_of(cones, pair, member)),
    }
}

/// Column and value of a row's only entry; `None` for rows with none or several.
fn only_entry(matrix: &SparseRows, row: usize) -> Option<(usize, f64)> {
    let mut entries = matrix.row(row).iter().filter(|(_, value)| *value != 0.0);
    match (entries.next(), entries.next()) {
        (Some(&entry), None) => Some(entry),
        _ => None,
    }
}
