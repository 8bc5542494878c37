//! Block pivoting for complementarity problems: every violated pair is switched at the same time.
//!
//! ```text
//! w = q + M z,      0 <= w ⊥ z >= 0:      for each index  w_i = 0  or  z_i = 0,  switched where the other is negative
//! ```
//!
//! Block pivoting takes few rounds but may cycle (M. M. Kostreva, Optimization 9 (1978) 13). After a number of rounds
//! only the last violated condition changes, which is finite where there is one solution for each right-hand side (K. G.
//! Murty's method; J. J. Júdice, F. M. Pires, Computers Ops. Res. 21 (1994) 587, doi:10.1016/0305-0548(94)90106-6).

/// The result of one round.
pub enum RoundResult<Change, Solution> {
    /// All conditions hold.
    Solved(Solution),
    /// The changes of the violated conditions, at least one, in the order of the conditions.
    Violated(Vec<Change>),
}

/// Largest numbers of rounds.
#[derive(Clone, Copy)]
pub struct Rounds {
    /// Rounds in which every violated condition changes.
    pub in_blocks: usize,
    /// Subsequent rounds in which only the last violated condition changes; 0 where a guess suffices.
    pub one_by_one: usize,
}

/// Changes the violated conditions of a set until none is violated. `None` where a round or a change fails, or after
/// the last round.
pub fn block_pivot<Set, Change, Solution>(
    mut set: Set,
    rounds: Rounds,
    examine: impl Fn(&Set) -> Option<RoundResult<Change, Solution>>,
    change: impl Fn(&mut Set, Vec<Change>) -> Option<()>,
) -> Option<Solution> {
    for round in 0..rounds.in_blocks + rounds.one_by_one {
        match examine(&set)? {
            RoundResult::Solved(solution) => return Some(solution),
            RoundResult::Violated(all) if round < rounds.in_blocks => change(&mut set, all)?,
            RoundResult::Violated(mut all) => change(&mut set, vec![all.pop()?])?,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// `w = q + M z`, `0 <= w ⊥ z >= 0` by the indices at which `z` is positive.
    fn solve(matrix: &DMatrix<f64>, constant: &DVector<f64>, rounds: Rounds) -> Option<DVector<f64>> {
        let size = constant.len();
        let examine = |is_basic: &Vec<bool>| {
            let basic: Vec<usize> = (0..size).filter(|index| is_basic[*index]).collect();
            let reduced = DMatrix::from_fn(basic.len(), basic.len(), |row, column| matrix[(basic[row], basic[column])]);
            let right = DVector::from_fn(basic.len(), |row, _| -constant[basic[row]]);
            let mut z = DVector::zeros(size);
            let solved = if basic.is_empty() { right } else { reduced.lu().solve(&right)? };
            solved.iter().zip(&basic).for_each(|(value, index)| z[*index] = *value);
            let w = constant + matrix * &z;
            let wrong: Vec<usize> =
                (0..size).filter(|index| if is_basic[*index] { z[*index] < 0.0 } else { w[*index] < 0.0 }).collect();
            Some(if wrong.is_empty() { RoundResult::Solved(z) } else { RoundResult::Violated(wrong) })
        };
        let change = |is_basic: &mut Vec<bool>, wrong: Vec<usize>| {
            wrong.into_iter().for_each(|index| is_basic[index] ^= true);
            Some(())
        };
        block_pivot(vec![false; size], rounds, examine, change)
    }

    /// Block pivoting alone cycles with this P-matrix; the rounds one by one find the solution.
    #[test]
    fn a_cycle_of_blocks_ends_one_by_one() {
        let matrix = DMatrix::from_row_slice(3, 3, &[1.0, 3.0, -2.0, 0.0, 3.0, -3.0, 3.0, 3.0, 2.0]);
        let constant = DVector::from_column_slice(&[1.0, 4.0, -4.0]);
        assert!(solve(&matrix, &constant, Rounds { in_blocks: 60, one_by_one: 0 }).is_none());
        let z = solve(&matrix, &constant, Rounds { in_blocks: 4, one_by_one: 16 }).expect("a solution");
        assert!((z - DVector::from_column_slice(&[0.75, 0.0, 0.875])).amax() < 1e-15);
    }
}
