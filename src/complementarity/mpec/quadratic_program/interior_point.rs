//! Convex quadratic programs, by the interior-point method of Clarabel. No other file uses this library.
//!
//! ```text
//! min ½ dᵀ H d + q·d    s.t.   e + E d = 0,   c + C d >= 0,   v_i + V_i d ∈ K,   lower <= d <= upper
//! ```
//!
//! Lagrangian `½ dᵀHd + q·d - λ·(e + E d) - κ·(c + C d) - Σ ζ_i·(v_i + V_i d) - ν_l·(d - lower) - ν_u·(upper - d)`,
//! `κ, ν_l, ν_u >= 0`, `ζ_i ∈ K`: this fixes the signs of the multipliers everywhere in `mpec`. `K` is the second-order
//! cone (`program::cone`).
//!
//! Source: P. J. Goulart and Y. Chen, *Clarabel: An interior-point solver for conic programs with quadratic objectives*,
//! arXiv:2405.12762.
//!
//! With data that are not finite, the interior-point method returns a wrong status instead of an error, so the data are
//! checked first. Its status "infeasible" is reported as a suspicion only, which the elastic program confirms or
//! refutes.

use crate::complementarity::mpec::quadratic_program::tolerances::INTERIOR_POINT_TOLERANCE;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nalgebra::{DMatrix, DVector};

use crate::algebra::sparse;
use crate::complementarity::mpec::program::sparse_rows::SparseRows;
use crate::resources::budget;
use crate::resources::cancel::CancelFlag;

/// Largest number of iterations of the interior-point method; 8 to 15 are usual.
const ITERATIONS: u32 = 100;
/// Largest number of multiplications of a factorisation that cannot be interrupted: of the order of a second.
const MOST_IN_ONE_PIECE: u64 = 2_000_000_000;

/// Data of one convex quadratic program in `d` (n entries, dimensionless).
#[derive(Debug, Clone)]
pub struct QuadraticProgram {
    /// `H`, n x n, symmetric positive semidefinite.
    pub hessian: SparseRows,
    /// `q`, n.
    pub gradient: DVector<f64>,
    /// `E`, one row per equality.
    pub equality: SparseRows,
    /// `e`.
    pub equality_values: DVector<f64>,
    /// `C`, one row per inequality.
    pub inequality: SparseRows,
    /// `c`.
    pub inequality_values: DVector<f64>,
    /// Bounds on `d`; infinite where there is no bound.
    pub lower: DVector<f64>,
    pub upper: DVector<f64>,
    /// Rows that have to lie in second-order cones.
    pub cones: Vec<ConeRows>,
}

/// The constraint `v + V d ∈ K`.
#[derive(Debug, Clone)]
pub struct ConeRows {
    /// `V`, one row per component of the cone.
    pub rows: DMatrix<f64>,
    /// `v`.
    pub values: DVector<f64>,
}

impl ConeRows {
    /// `v + V d`
    pub fn at(&self, step: &DVector<f64>) -> DVector<f64> {
        &self.values + &self.rows * step
    }
}

/// Minimiser and multipliers of a [`QuadraticProgram`].
#[derive(Debug, Clone)]
pub struct QuadraticSolution {
    pub step: DVector<f64>,
    /// Free in sign.
    pub equality_multipliers: DVector<f64>,
    /// Nonnegative.
    pub inequality_multipliers: DVector<f64>,
    /// Nonnegative; zero where there is no bound.
    pub lower_multipliers: DVector<f64>,
    pub upper_multipliers: DVector<f64>,
    /// One per cone, each in its cone.
    pub cone_multipliers: Vec<DVector<f64>>,
}

/// The reason why a quadratic program gave no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QuadraticFailure {
    /// The data contain a NaN, or an infinity where none is allowed.
    NotFinite,
    /// The interior-point method finds the constraints contradictory.
    SuspectedInfeasible,
    /// The interior-point method finds the objective unbounded.
    SuspectedUnbounded,
    /// The interior-point method ran out of iterations or precision.
    Inaccurate,
    /// Stopped by the cancel flag.
    Cancelled,
}

impl QuadraticProgram {
    /// True where every number is finite, bounds excepted, and no lower bound lies above its upper bound.
    pub fn is_well_formed(&self) -> bool {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        self.hessian.is_finite()
            && finite(self.gradient.as_slice())
            && self.equality.is_finite()
            && finite(self.equality_values.as_slice())
            && self.inequality.is_finite()
            && finite(self.inequality_values.as_slice())
            && self.cones.iter().all(|cone| finite(cone.rows.as_slice()) && finite(cone.values.as_slice()))
            && self.lower.iter().zip(self.upper.iter()).all(|(lower, upper)| lower <= upper)
    }

    /// `½ dᵀHd + q·d`.
    pub fn objective(&self, step: &DVector<f64>) -> f64 {
        0.5 * self.curvature(step) + self.gradient.dot(step)
    }

    /// `dᵀHd`.
    pub fn curvature(&self, step: &DVector<f64>) -> f64 {
        step.dot(&(&self.hessian * step))
    }

    /// `Σ V_iᵀ ζ_i`
    pub fn cone_force(&self, solution: &QuadraticSolution) -> DVector<f64> {
        let mut force = DVector::zeros(self.gradient.len());
        for (cone, multiplier) in self.cones.iter().zip(&solution.cone_multipliers) {
            force += cone.rows.tr_mul(multiplier);
        }
        force
    }
}

/// Solves by the interior-point method.
///
/// # Errors
/// Any [`QuadraticFailure`]; none proves that the program has no solution.
pub fn solve_interior(program: &QuadraticProgram, cancel: &CancelFlag) -> Result<QuadraticSolution, QuadraticFailure> {
    InteriorSolver::default().solve(program, cancel)
}

/// The interior-point method, which reuses its elimination order and its memory as long as programs have the same
/// pattern: only their data are replaced.
#[derive(Default)]
pub struct InteriorSolver {
    held: Option<ReusableSolver>,
    /// Number of programs solved by replacing the data of a previous program.
    #[cfg(test)]
    pub updates: usize,
}

/// A solver and the shape of the data it was made for.
struct ReusableSolver {
    solver: DefaultSolver<f64>,
    shape: ProgramShape,
}

/// The properties that have to agree for data to be replaced: the rows' kinds and the patterns of both matrices.
#[derive(PartialEq)]
struct ProgramShape {
    cones: Vec<SupportedConeT<f64>>,
    hessian: (Vec<usize>, Vec<usize>),
    rows: (Vec<usize>, Vec<usize>),
}

impl InteriorSolver {
    /// Solves a program.
    ///
    /// # Errors
    /// Any [`QuadraticFailure`]; none proves that the program has no solution.
    pub fn solve(
        &mut self,
        program: &QuadraticProgram,
        cancel: &CancelFlag,
    ) -> Result<QuadraticSolution, QuadraticFailure> {
        if !program.is_well_formed() {
            return Err(QuadraticFailure::NotFinite);
        }
        budget::spend(program.gradient.len() * (1 + program.cones.len()));
        let data = Data::new(program);
        let gradient = program.gradient.as_slice().to_vec();
        let shape = ProgramShape {
            cones: data.cones.clone(),
            hessian: (data.hessian.colptr.clone(), data.hessian.rowval.clone()),
            rows: (data.rows.colptr.clone(), data.rows.rowval.clone()),
        };
        let updated = self.held.as_mut().is_some_and(|held| {
            held.shape == shape
                && held.solver.update_data(&data.hessian.nzval, &gradient, &data.rows.nzval, &data.right).is_ok()
        });
        #[cfg(test)]
        {
            self.updates += usize::from(updated);
        }
        if !updated {
            self.held = None;
            allow(&data);
            let made =
                DefaultSolver::new(&data.hessian, &gradient, &data.rows, &data.right, &data.cones, interior_settings());
            let mut solver = made.map_err(|_| QuadraticFailure::Inaccurate)?;
            let flag = cancel.clone();
            solver.set_termination_callback(move |_| flag.is_cancelled());
            self.held = Some(ReusableSolver { solver, shape });
        }
        let Some(held) = &mut self.held else { return Err(QuadraticFailure::Inaccurate) };
        held.solver.solve();
        data.read(program, &held.solver)
    }
}

/// A program in the solver's form, `A d + s = b`: equalities, inequalities, lower bounds, upper bounds, cones.
struct Data {
    hessian: CscMatrix<f64>,
    rows: CscMatrix<f64>,
    right: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
    /// Variables with lower bounds, and variables with upper bounds.
    below: Vec<usize>,
    above: Vec<usize>,
    /// Index of the first cone row.
    cones_start: usize,
}

/// Number of entries of a program's matrices up to which its factors are small in any case.
const FEW_ENTRIES: usize = 2_000;

/// Refuses a program whose `[[H, Aᵀ], [A, -1]]` is too expensive to factorise: each iteration factorises it, in one
/// piece.
fn allow(data: &Data) {
    if data.hessian.nzval.len() + data.rows.nzval.len() <= FEW_ENTRIES {
        return;
    }
    let variables = data.hessian.n;
    let entries = |matrix: &CscMatrix<f64>, first: usize| -> Vec<(usize, usize)> {
        let columns = (0..matrix.n)
            .flat_map(|column| (matrix.colptr[column]..matrix.colptr[column + 1]).map(move |place| (place, column)));
        columns.map(|(place, column)| (first + matrix.rowval[place], column)).collect()
    };
    let whole = entries(&data.hessian, 0).into_iter().chain(entries(&data.rows, variables));
    sparse::allow_factor(variables + data.right.len(), whole, MOST_IN_ONE_PIECE);
}

impl Data {
    fn new(program: &QuadraticProgram) -> Self {
        let variables = program.gradient.len();
        let bounded =
            |bounds: &DVector<f64>| -> Vec<usize> { (0..variables).filter(|&j| bounds[j].is_finite()).collect() };
        let (below, above) = (bounded(&program.lower), bounded(&program.upper));
        let equalities = program.equality_values.len();
        let mut right: Vec<f64> = program.equality_values.iter().map(|value| -value).collect();
        right.extend(program.inequality_values.iter());
        right.extend(below.iter().map(|&j| -program.lower[j]));
        right.extend(above.iter().map(|&j| program.upper[j]));
        let mut cones =
            vec![SupportedConeT::ZeroConeT(equalities), SupportedConeT::NonnegativeConeT(right.len() - equalities)];
        let cones_start = right.len();
        for cone in &program.cones {
            right.extend(cone.values.iter());
            cones.push(SupportedConeT::SecondOrderConeT(cone.values.len()));
        }
        let upper = program.hessian.entries().filter(|(row, column, _)| row <= column);
        let hessian = compressed(variables, variables, upper);
        let inequalities_end = equalities + program.inequality_values.len();
        let entries = program
            .equality
            .entries()
            .chain(program.inequality.entries().map(|(i, j, value)| (equalities + i, j, -value)))
            .chain(below.iter().enumerate().map(|(i, &j)| (inequalities_end + i, j, -1.0)))
            .chain(above.iter().enumerate().map(|(i, &j)| (inequalities_end + below.len() + i, j, 1.0)));
        let mut first = cones_start;
        let of_cones = program.cones.iter().flat_map(|cone| {
            let start = first;
            first += cone.values.len();
            let places = (0..variables).flat_map(move |j| (0..cone.values.len()).map(move |i| (i, j)));
            places.filter(move |&place| cone.rows[place] != 0.0).map(move |(i, j)| (start + i, j, -cone.rows[(i, j)]))
        });
        let rows = compressed(right.len(), variables, entries.chain(of_cones));
        Self { hessian, rows, right, cones, below, above, cones_start }
    }

    /// The solution, or the reason for its failure.
    fn read(
        &self,
        program: &QuadraticProgram,
        solver: &DefaultSolver<f64>,
    ) -> Result<QuadraticSolution, QuadraticFailure> {
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {}
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                return Err(QuadraticFailure::SuspectedInfeasible);
            }
            SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => {
                return Err(QuadraticFailure::SuspectedUnbounded);
            }
            SolverStatus::CallbackTerminated => return Err(QuadraticFailure::Cancelled),
            SolverStatus::Unsolved
            | SolverStatus::MaxIterations
            | SolverStatus::MaxTime
            | SolverStatus::NumericalError
            | SolverStatus::InsufficientProgress => return Err(QuadraticFailure::Inaccurate),
        }
        let (x, z) = (&solver.solution.x, &solver.solution.z);
        if x.iter().chain(z).any(|value| !value.is_finite()) {
            return Err(QuadraticFailure::Inaccurate);
        }
        let (variables, equalities) = (program.gradient.len(), program.equality_values.len());
        let inequalities = program.inequality_values.len();
        let (below, above) = (&self.below, &self.above);
        let mut lower_multipliers = DVector::zeros(variables);
        let mut upper_multipliers = DVector::zeros(variables);
        let bounds_start = equalities + inequalities;
        for (row, &j) in below.iter().enumerate() {
            lower_multipliers[j] = z[bounds_start + row].max(0.0);
        }
        for (row, &j) in above.iter().enumerate() {
            upper_multipliers[j] = z[bounds_start + below.len() + row].max(0.0);
        }
        let mut cone_start = self.cones_start;
        let cone_multipliers = program.cones.iter().map(|cone| {
            let place = cone_start..cone_start + cone.values.len();
            cone_start = place.end;
            crate::complementarity::mpec::program::cone::projection(&z[place])
        });
        let cone_multipliers = cone_multipliers.collect();
        Ok(QuadraticSolution {
            step: DVector::from_column_slice(x),
            equality_multipliers: DVector::from_iterator(equalities, z[..equalities].iter().map(|value| -value)),
            inequality_multipliers: DVector::from_iterator(
                inequalities,
                z[equalities..bounds_start].iter().map(|value| value.max(0.0)),
            ),
            lower_multipliers,
            upper_multipliers,
            cone_multipliers,
        })
    }
}

/// Presolve is off: it would drop rows with an infinite right-hand side, which never occur here, at a cost. Iterative
/// refinement is off: it took a third of the time (7 variables), and the active-set step replaces it. Equilibration is
/// on for the elastic programs, whose weights are large; without it, the same tests pass as well.
fn interior_settings() -> DefaultSettings<f64> {
    DefaultSettings {
        verbose: false,
        presolve_enable: false,
        max_iter: ITERATIONS,
        max_threads: 1,
        direct_solve_method: "qdldl".to_string(),
        tol_gap_abs: INTERIOR_POINT_TOLERANCE,
        tol_gap_rel: INTERIOR_POINT_TOLERANCE,
        tol_feas: INTERIOR_POINT_TOLERANCE,
        iterative_refinement_enable: false,
        ..DefaultSettings::default()
    }
}

/// A compressed-column matrix; entries have to be given row by row, each place once.
fn compressed(rows: usize, columns: usize, entries: impl Iterator<Item = (usize, usize, f64)>) -> CscMatrix<f64> {
    let mut by_column: Vec<Vec<(usize, f64)>> = vec![Vec::new(); columns];
    entries.for_each(|(row, column, value)| by_column[column].push((row, value)));
    let mut starts = vec![0];
    let (mut places, mut values) = (Vec::new(), Vec::new());
    for column in by_column {
        places.extend(column.iter().map(|(row, _)| *row));
        values.extend(column.iter().map(|(_, value)| *value));
        starts.push(places.len());
    }
    CscMatrix::new(rows, columns, starts, places, values)
}
