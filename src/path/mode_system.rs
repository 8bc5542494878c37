//! The equations of one contact mode, and Newton's method on them.
//!
//! ```text
//! f_int(u) - s f - f_held - Σ_i (n r_n + t r_t)_i = 0        equilibrium
//! g_i(u) = 0                                                 closed contacts
//! t_i·(x_i - x_i⁰) = 0                                       sticking contacts, unknown r_t
//! r_t = -μ r_n d                                             slipping contacts, eliminated
//! c(u, s) = 0                                                arc length, or a held load or displacement
//! ```
//!
//! Unknowns `(u, s, r)`; the matrix is square, and regular at smooth limit points because `c` borders it
//! (E. Riks, Int. J. Solids Struct. 15 (1979) 529, doi:10.1016/0020-7683(79)90081-7).

use super::state::{Rate, State};
use crate::contact::{Contact, Mode, Reaction};
use crate::linear_algebra::Factorisation;
use crate::structure::Structure;
use nalgebra::{DMatrix, DVector};

/// The structure under a load pattern, with what is held from before.
#[derive(Clone, Copy)]
pub struct Loading<'a> {
    pub structure: &'a Structure,
    pub contacts: &'a [Contact],
    /// Multiplied by the load factor; all degrees of freedom.
    pub pattern: &'a [f64],
    /// Held by earlier stages; all degrees of freedom.
    pub held: &'a [f64],
}

/// The last equation: where on the branch the point is to be.
#[derive(Debug, Clone, Copy)]
pub enum Place<'a> {
    /// `‖(Δu, Δs)‖ = step` from a state, on the side of the predictor.
    ArcLength { from: &'a State, step: f64 },
    /// `s = value`
    Load(f64),
    /// `u = value` at a degree of freedom.
    Displacement { freedom: usize, value: f64 },
}

/// A converged point and what it took.
#[derive(Debug, Clone)]
pub struct Corrected {
    pub state: State,
    pub iterations: u64,
    /// Iterations until the error was small; those after it polish, and their number is round-off's.
    pub iterations_to_small: u64,
    /// Equilibrium residual over the force scale.
    pub residual: f64,
    /// Equilibrium and contact equations left over, one a row.
    left_over: DVector<f64>,
    /// Largest force in the structure, its loads and its contacts.
    pub force_scale: f64,
}

/// Why no point was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    Singular,
    NotConverged,
}

/// Newton iterations before a step is given up.
const MOST_ITERATIONS: u64 = 16;
/// Relative residual that an accepted point must have.
pub const ACCEPTED_RESIDUAL: f64 = 1e-11;
/// Relative residual below which iterating on gains nothing.
const ROUND_OFF: f64 = 1e-15;
/// Error below which Newton's method is as good as converged.
const SMALL: f64 = 1e-6;

/// One mode's equations.
pub struct ModeSystem<'a> {
    loading: Loading<'a>,
    modes: &'a [Mode],
    /// Where sticking contacts hold their nodes.
    anchor: &'a State,
    /// First row and column of each closed contact.
    first_of: Vec<usize>,
    size: usize,
}

impl<'a> ModeSystem<'a> {
    pub fn new(loading: Loading<'a>, modes: &'a [Mode], anchor: &'a State) -> Self {
        let mut next = loading.structure.unknowns() + 1;
        let mut first_of = Vec::with_capacity(modes.len());
        for mode in modes {
            first_of.push(next);
            next += match mode {
                Mode::Free => 0,
                Mode::Slip { .. } => 1,
                Mode::Stick => loading.structure.dimension,
            };
        }
        Self { loading, modes, anchor, first_of, size: next }
    }

    /// Number of unknowns `(u, s, r)`.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Column of a closed contact's normal reaction; its tangential ones follow. Its rows are one less.
    pub fn column_of(&self, contact: usize) -> usize {
        self.first_of[contact]
    }

    /// Row of a closed contact's normal equation; its tangential ones follow.
    pub fn row_of(&self, contact: usize) -> usize {
        self.first_of[contact] - 1
    }

    /// All rows but the last, which is left zero for the bordering equation.
    pub fn matrix(&self, state: &State) -> DMatrix<f64> {
        let structure = self.loading.structure;
        let (dimension, unknowns) = (structure.dimension, structure.unknowns());
        let mut matrix = DMatrix::zeros(self.size, self.size);
        structure.add_tangent(&state.displacement, &mut matrix);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            matrix[(unknown, unknowns)] = -self.loading.pattern[*freedom];
        }
        for (index, (contact, mode)) in self.loading.contacts.iter().zip(self.modes).enumerate() {
            if !mode.is_active() {
                continue;
            }
            let normal = contact.obstacle.normal();
            let tangents = contact.obstacle.tangents(dimension);
            let column = self.column_of(index);
            let row = self.row_of(index);
            for component in 0..dimension {
                let Some(unknown) = structure.unknown_of[contact.node * dimension + component] else { continue };
                matrix[(row, unknown)] = normal[component];
                match mode {
                    Mode::Free => {}
                    Mode::Slip { direction } => {
                        let drag = direction[0] * tangents[0][component] + direction[1] * tangents[1][component];
                        matrix[(unknown, column)] = -(normal[component] - contact.friction * drag);
                    }
                    Mode::Stick => {
                        matrix[(unknown, column)] = -normal[component];
                        for k in 0..dimension - 1 {
                            matrix[(unknown, column + 1 + k)] = -tangents[k][component];
                            matrix[(row + 1 + k, unknown)] = tangents[k][component];
                        }
                    }
                }
            }
        }
        matrix
    }

    /// Puts the bordering row of a rate into a matrix.
    pub fn border(&self, matrix: &mut DMatrix<f64>, rate: &Rate) {
        let structure = self.loading.structure;
        let last = self.size - 1;
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            matrix[(last, unknown)] = rate.displacement[*freedom];
        }
        matrix[(last, structure.unknowns())] = rate.load;
    }

    /// Equilibrium and contact equations; returns the largest equilibrium residual and the force scale.
    fn residual(&self, state: &State, values: &mut DVector<f64>, force: &mut [f64]) -> (f64, f64) {
        let structure = self.loading.structure;
        let dimension = structure.dimension;
        let mut scale = structure.internal_force(&state.displacement, force);
        for (freedom, value) in force.iter_mut().enumerate() {
            let load = state.load * self.loading.pattern[freedom] + self.loading.held[freedom];
            scale = scale.max(load.abs()).max(value.abs());
            *value -= load;
        }
        values.fill(0.0);
        for (index, (contact, mode)) in self.loading.contacts.iter().zip(self.modes).enumerate() {
            if !mode.is_active() {
                continue;
            }
            let reaction = &state.reactions[index];
            scale = scale.max(reaction.size());
            let normal = contact.obstacle.normal();
            let tangents = contact.obstacle.tangents(dimension);
            let first = contact.node * dimension;
            for component in 0..dimension {
                force[first + component] -= reaction.normal * normal[component]
                    + reaction.tangential[0] * tangents[0][component]
                    + reaction.tangential[1] * tangents[1][component];
            }
            let row = self.row_of(index);
            values[row] = contact.gap(dimension, &state.displacement);
            if *mode == Mode::Stick {
                for (k, tangent) in tangents.iter().enumerate().take(dimension - 1) {
                    values[row + 1 + k] = (0..dimension)
                        .map(|c| (state.displacement[first + c] - self.anchor.displacement[first + c]) * tangent[c])
                        .sum();
                }
            }
        }
        let mut largest = 0.0_f64;
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            values[unknown] = force[*freedom];
            largest = largest.max(force[*freedom].abs());
        }
        (largest, scale)
    }

    /// Value of the last equation, and its row.
    fn place(&self, state: &State, place: Place<'_>, matrix: Option<&mut DMatrix<f64>>) -> f64 {
        let structure = self.loading.structure;
        let (last, unknowns) = (self.size - 1, structure.unknowns());
        match place {
            Place::ArcLength { from, step } => {
                let mut chord = Rate {
                    displacement: state.displacement.iter().zip(&from.displacement).map(|(a, b)| a - b).collect(),
                    load: state.load - from.load,
                    reactions: Vec::new(),
                };
                let size = chord.size();
                if let Some(matrix) = matrix {
                    if size > 0.0 {
                        chord.scale(1.0 / size);
                    }
                    self.border(matrix, &chord);
                }
                size - step
            }
            Place::Load(value) => {
                if let Some(matrix) = matrix {
                    matrix[(last, unknowns)] = 1.0;
                }
                state.load - value
            }
            Place::Displacement { freedom, value } => {
                if let (Some(matrix), Some(unknown)) = (matrix, structure.unknown_of[freedom]) {
                    matrix[(last, unknown)] = 1.0;
                }
                state.displacement[freedom] - value
            }
        }
    }

    /// Takes a vector of unknowns apart.
    pub fn rate_from(&self, values: &DVector<f64>) -> Rate {
        let structure = self.loading.structure;
        let mut displacement = vec![0.0; structure.freedoms()];
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            displacement[*freedom] = values[unknown];
        }
        let reactions = self.modes.iter().zip(self.loading.contacts).enumerate().map(|(index, (mode, contact))| {
            let column = self.column_of(index);
            match mode {
                Mode::Free => Reaction::default(),
                Mode::Slip { direction } => {
                    let normal = values[column];
                    let drag = -contact.friction * normal;
                    Reaction { normal, tangential: [drag * direction[0], drag * direction[1]] }
                }
                Mode::Stick => {
                    let mut tangential = [0.0; 2];
                    for (k, value) in tangential.iter_mut().enumerate().take(structure.dimension - 1) {
                        *value = values[column + 1 + k];
                    }
                    Reaction { normal: values[column], tangential }
                }
            }
        });
        Rate { displacement, load: values[structure.unknowns()], reactions: reactions.collect() }
    }

    /// Newton's method from a guess, to round-off.
    ///
    /// `force_scale` is the largest force met so far on the path; residuals are relative to it or to the present
    /// forces, whichever is larger.
    pub fn correct(&self, guess: State, place: Place<'_>, force_scale: f64) -> Result<Corrected, Failure> {
        let mut state = self.consistent(guess);
        let mut values = DVector::zeros(self.size);
        let mut force = vec![0.0; self.loading.structure.freedoms()];
        let mut iterations = 0;
        let mut iterations_to_small = None;
        let mut best: Option<(f64, Corrected)> = None;
        loop {
            let (largest, forces) = self.residual(&state, &mut values, &mut force);
            let scale = forces.max(force_scale).max(f64::MIN_POSITIVE);
            let residual = largest / scale;
            let last = self.size - 1;
            values[last] = self.place(&state, place, None);
            let geometric = values.iter().skip(self.loading.structure.unknowns()).fold(0.0_f64, |m, v| m.max(v.abs()));
            let error = residual.max(geometric);
            if !error.is_finite() {
                return Err(Failure::NotConverged);
            }
            if error <= SMALL {
                iterations_to_small.get_or_insert(iterations);
            }
            let improved = best.as_ref().is_none_or(|(least, _)| error < 0.5 * least);
            if best.as_ref().is_none_or(|(least, _)| error <= *least) {
                let state = state.clone();
                let iterations_to_small = iterations_to_small.unwrap_or(iterations);
                let corrected = Corrected {
                    state,
                    iterations,
                    iterations_to_small,
                    residual,
                    left_over: values.clone(),
                    force_scale: forces,
                };
                best = Some((error, corrected));
            }
            let least = best.as_ref().map_or(f64::INFINITY, |(least, _)| *least);
            let settled = least <= ROUND_OFF || (!improved && least <= ACCEPTED_RESIDUAL);
            if settled && iterations > 0 {
                break;
            }
            if iterations == MOST_ITERATIONS {
                if least <= ACCEPTED_RESIDUAL {
                    break;
                }
                return Err(Failure::NotConverged);
            }
            let mut matrix = self.matrix(&state);
            self.place(&state, place, Some(&mut matrix));
            let factorisation = Factorisation::new(matrix).ok_or(Failure::Singular)?;
            if !factorisation.solve(&mut values) {
                return Err(Failure::Singular);
            }
            let correction = self.rate_from(&values);
            state = self.consistent(state.advanced(&correction, -1.0));
            iterations += 1;
        }
        let Some((_, corrected)) = best else { return Err(Failure::NotConverged) };
        let wrong_side = match place {
            Place::ArcLength { from, step } => corrected.state.distance(from) < 0.5 * step,
            Place::Load(_) | Place::Displacement { .. } => false,
        };
        if wrong_side { Err(Failure::NotConverged) } else { Ok(corrected) }
    }

    /// A point as it is, with its residual.
    pub fn judged(&self, state: State, force_scale: f64) -> Corrected {
        let state = self.consistent(state);
        let mut left_over = DVector::zeros(self.size);
        let mut force = vec![0.0; self.loading.structure.freedoms()];
        let (largest, forces) = self.residual(&state, &mut left_over, &mut force);
        let geometric = left_over.iter().skip(self.loading.structure.unknowns()).fold(0.0_f64, |m, v| m.max(v.abs()));
        let residual = (largest / forces.max(force_scale).max(f64::MIN_POSITIVE)).max(geometric);
        Corrected { state, iterations: 0, iterations_to_small: 0, residual, left_over, force_scale: forces }
    }

    /// Makes complementarity exact: no reaction on a free contact, no motion of a sticking node, friction of a slipping
    /// contact on its cone.
    fn consistent(&self, mut state: State) -> State {
        let dimension = self.loading.structure.dimension;
        for (index, (mode, contact)) in self.modes.iter().zip(self.loading.contacts).enumerate() {
            match mode {
                Mode::Free => state.reactions[index] = Reaction::default(),
                Mode::Slip { direction } => {
                    let drag = -contact.friction * state.reactions[index].normal;
                    state.reactions[index].tangential = [drag * direction[0], drag * direction[1]];
                }
                Mode::Stick => {
                    let nodes = contact.node * dimension..(contact.node + 1) * dimension;
                    state.displacement[nodes.clone()].copy_from_slice(&self.anchor.displacement[nodes]);
                }
            }
        }
        state
    }

    /// The path's direction in this mode: the null vector of the equations, of unit arc length, on the side of
    /// `towards`. `None` where the equations have no such vector or more than one.
    pub fn tangent(&self, state: &State, towards: &Rate) -> Option<Rate> {
        self.tangent_by(&self.bordered(state, towards)?)
    }

    /// The path's direction at a converged point, and an estimate of the point's error: the size of one more Newton
    /// correction across the path.
    /// With them the sign of the bordered determinant, where it is certain.
    pub fn tangent_and_error(&self, corrected: &Corrected, towards: &Rate) -> Option<(Rate, f64, Option<f64>)> {
        let factorisation = self.bordered(&corrected.state, towards)?;
        let rate = self.tangent_by(&factorisation)?;
        let mut values = corrected.left_over.clone();
        values[self.size - 1] = 0.0;
        let error = if factorisation.solve(&mut values) { self.rate_from(&values).size() } else { return None };
        let certain = factorisation.pivot_ratio() > super::singular::UNCERTAIN;
        Some((rate, error, certain.then(|| factorisation.determinant_sign())))
    }

    fn bordered(&self, state: &State, towards: &Rate) -> Option<Factorisation> {
        let mut matrix = self.matrix(state);
        self.border(&mut matrix, towards);
        Factorisation::new(matrix)
    }

    fn tangent_by(&self, factorisation: &Factorisation) -> Option<Rate> {
        let mut values = DVector::zeros(self.size);
        values[self.size - 1] = 1.0;
        if !factorisation.solve(&mut values) {
            return None;
        }
        let mut rate = self.rate_from(&values);
        let size = rate.size();
        if size <= 0.0 || !size.is_finite() {
            return None;
        }
        rate.scale(1.0 / size);
        Some(rate)
    }
}
