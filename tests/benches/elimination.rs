//! What is solved by hand beside the library's sparse LU: bordered systems as a path's equations are, of a plane lattice whose
//! lowest nodes rub on a floor. Each is factorised and solved for two right-hand sides, as an iteration of Newton's method
//! does, in three ways taken in turn: contacts eliminated at their nodes, contacts left in the borders, and the whole system by
//! the library, which takes its analysis of the pattern over from the time before. Microseconds, the least of many; the
//! largest error of a solution that is known is beside them.
//!
//! With `solves`, solutions with the lattice's symmetric factors instead: 32 right-hand sides one after another by the
//! library, and together.
//!
//! `cargo bench --bench elimination`, with numbers of unknowns `cargo bench --bench elimination -- 100 1000`, and
//! `cargo bench --bench elimination -- solves`

use arcslip::algebra::Sink;
use arcslip::algebra::sparse::factors::ldl::SymmetricFactor;
use arcslip::algebra::sparse::factors::pivoted_lu::GeneralLu;
use arcslip::algebra::sparse::{Bordered, Holding, Holdings, IndexList, Pattern, SparseFactorisation};
use faer::sparse::Triplet;
use nalgebra::DVector;
use std::sync::Arc;
use std::time::Instant;

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const SIZES: [usize; 6] = [24, 50, 100, 400, 1_000, 10_000];
const FRICTION: f64 = 0.3;
/// Seconds for one system.
const SECONDS: f64 = 2.0;

/// Entries of the whole matrix, and which borders hold which nodes.
struct System {
    unknowns: usize,
    borders: usize,
    entries: Vec<(usize, usize, f64)>,
    holdings: Holdings,
}

impl System {
    /// A lattice four times as wide as high, of springs along its edges and diagonals; one side stands on the ground, and a
    /// third of the lowest nodes is in contact.
    fn new(unknowns: usize) -> Self {
        let height = ((unknowns / 8) as f64).sqrt().round().max(2.0) as usize;
        let width = (unknowns / 2).div_ceil(height);
        let node = |x: usize, y: usize| x * height + y;
        let unknowns = 2 * width * height;
        let mut entries = Vec::new();
        let mut spring = |from: usize, to: Option<usize>, along: [f64; 2], stiffness: f64| {
            let ends = [(Some(from), 1.0), (to, -1.0)];
            for (one, sign) in ends {
                for (other, other_sign) in ends {
                    let (Some(one), Some(other)) = (one, other) else { continue };
                    for row in 0..2 {
                        for column in 0..2 {
                            let value = stiffness * sign * other_sign * along[row] * along[column];
                            entries.push((2 * one + row, 2 * other + column, value));
                        }
                    }
                }
            }
        };
        let half = 0.5_f64.sqrt();
        for x in 0..width {
            for y in 0..height {
                let stiffness = 1.0 + 0.1 * ((3 * x + 5 * y) % 7) as f64;
                if x == 0 {
                    spring(node(x, y), None, [1.0, 0.0], stiffness);
                    spring(node(x, y), None, [0.0, 1.0], stiffness);
                }
                for (step, along) in [((1, 0), [1.0, 0.0]), ((0, 1), [0.0, 1.0]), ((1, 1), [half, half])] {
                    if x + step.0 < width && y + step.1 < height {
                        spring(node(x, y), Some(node(x + step.0, y + step.1)), along, stiffness);
                    }
                }
            }
        }
        // A slipping contact holds its node along the normal; its reaction pushes along the normal and against the slip.
        let mut holdings = Vec::new();
        for (contact, x) in (1..width).step_by(3).enumerate() {
            let (along, normal) = (2 * node(x, 0), 2 * node(x, 0) + 1);
            let border = unknowns + contact;
            entries.extend([(border, normal, 1.0), (normal, border, -1.0), (along, border, FRICTION)]);
            let only = |border: usize| IndexList::from_iter([border]);
            holdings.push(Holding { rows: only(contact), columns: only(contact), ..Holding::new([along, normal]) });
        }
        // The load, and the length of the step.
        let last = unknowns + holdings.len();
        for unknown in 0..unknowns {
            let part = 0.1 + (unknown % 5) as f64 / 5.0;
            entries.extend([(unknown, last, -part), (last, unknown, 0.5 * part)]);
        }
        entries.push((last, last, 1.0));
        let borders = holdings.len() + 1;
        Self { unknowns, borders, entries, holdings: Holdings::new(holdings) }
    }

    fn pattern(&self) -> Arc<Pattern> {
        let inner = self.entries.iter().filter(|(row, column, _)| row.max(column) < &self.unknowns);
        let pattern = Pattern::new(self.unknowns, inner.map(|(row, column, _)| (*row, *column)));
        Arc::new(pattern.expect("a pattern within its size"))
    }

    fn bordered(&self, pattern: &Arc<Pattern>) -> Bordered {
        let mut matrix = Bordered::new(pattern.clone(), self.borders);
        for (row, column, value) in &self.entries {
            match pattern.place(*row, *column).filter(|_| row.max(column) < &self.unknowns) {
                Some(place) => matrix.add_at(place, *value),
                None => matrix.add(*row, *column, *value),
            }
        }
        matrix
    }

    fn triplets(&self) -> Vec<Triplet<usize, usize, f64>> {
        self.entries.iter().map(|(row, column, value)| Triplet::new(*row, *column, *value)).collect()
    }

    /// Two solutions and what they make.
    fn known(&self, matrix: &Bordered) -> [(DVector<f64>, DVector<f64>); 2] {
        [3, 11].map(|step| {
            let solution = DVector::from_fn(matrix.size(), |row, _| 1.0 + (row * step % 7) as f64);
            let right = matrix.times(&solution);
            (solution, right)
        })
    }
}

/// The least time of a way, in microseconds, and the largest error of its solutions.
#[derive(Clone, Copy)]
struct Found {
    least: f64,
    error: f64,
}

impl Default for Found {
    fn default() -> Self {
        Self { least: f64::INFINITY, error: 0.0 }
    }
}

impl Found {
    fn take(&mut self, solve: impl FnOnce() -> Option<f64>) {
        let began = Instant::now();
        let error = solve();
        self.least = self.least.min(1e6 * began.elapsed().as_secs_f64());
        self.error = self.error.max(error.unwrap_or(f64::INFINITY));
    }
}

/// Solutions with the symmetric factors of each lattice, one after another and together.
fn solves(sizes: &[usize]) {
    const TOGETHER: usize = 32;
    println!("unknowns one by one    together       ratio  difference");
    for size in sizes {
        let system = System::new(*size);
        let pattern = system.pattern();
        let mut values = vec![0.0; pattern.entries()];
        for (row, column, value) in &system.entries {
            let place = pattern.place(*row, *column).filter(|_| row.max(column) < &system.unknowns);
            place.into_iter().for_each(|place| values[place] += value);
        }
        let Ok(factor) = SymmetricFactor::new(pattern.clone(), &values) else { continue };
        // As at contacts: a force at one unknown each.
        let mut rights = vec![0.0; TOGETHER * system.unknowns];
        for (number, right) in rights.chunks_exact_mut(system.unknowns).enumerate() {
            right[number * system.unknowns / TOGETHER] = 1.0;
        }
        let (mut apart, mut joint) = (Found::default(), Found::default());
        let began = Instant::now();
        while began.elapsed().as_secs_f64() < SECONDS {
            let (mut one_by_one, mut together) = (rights.clone(), rights.clone());
            apart.take(|| one_by_one.chunks_exact_mut(system.unknowns).all(|one| factor.solve(one, 1)).then_some(0.0));
            joint.take(|| factor.solve(&mut together, TOGETHER).then_some(0.0));
            let pairs = one_by_one.iter().zip(&together);
            let largest = one_by_one.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            joint.error = pairs.fold(joint.error, |most, (a, b)| most.max((a - b).abs() / largest));
        }
        let ratio = apart.least / joint.least;
        println!("{:8} {:10.1} {:11.1} {ratio:11.2} {:11.1e}", system.unknowns, apart.least, joint.least, joint.error);
    }
}

fn main() {
    let asked: Vec<usize> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let sizes = if asked.is_empty() { SIZES.to_vec() } else { asked };
    if std::env::args().any(|word| word == "solves") {
        solves(&sizes);
        return;
    }
    println!("unknowns  borders    at nodes       error  in borders       error     library       error");
    for size in sizes {
        let system = System::new(size);
        let pattern = system.pattern();
        let matrix = system.bordered(&pattern);
        let known = system.known(&matrix);
        let by_hand = |holdings: &Holdings| {
            let factors = SparseFactorisation::new(matrix.clone(), holdings)?;
            let mut largest = 0.0_f64;
            for (solution, right) in &known {
                let mut values = right.clone();
                if !factors.solve(&mut values) {
                    return None;
                }
                largest = largest.max((values - solution).amax());
            }
            Some(largest)
        };
        let mut before = GeneralLu::new(matrix.size(), system.triplets(), None);
        let mut found = [Found::default(); 3];
        let began = Instant::now();
        while began.elapsed().as_secs_f64() < SECONDS {
            found[0].take(|| by_hand(&system.holdings));
            found[1].take(|| by_hand(&Holdings::default()));
            let triplets = system.triplets();
            found[2].take(|| {
                let factors = GeneralLu::new(matrix.size(), triplets, before.as_ref())?;
                let mut largest = 0.0_f64;
                for (solution, right) in &known {
                    let mut values = right.clone();
                    if !factors.solve(values.as_mut_slice()) {
                        return None;
                    }
                    largest = largest.max((values - solution).amax());
                }
                before = Some(factors);
                Some(largest)
            });
        }
        let columns = found.map(|found| format!("{:11.1} {:11.1e}", found.least, found.error)).join(" ");
        println!("{:8} {:8} {columns}", system.unknowns, system.borders);
    }
}
