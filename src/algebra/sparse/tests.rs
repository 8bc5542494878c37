//! The sparse factorisation against the dense factorisation, on reproducible pseudo-random systems.

use crate::algebra::dense::matrix_sink::Sink;
use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::algebra::sparse::factors::ldl::SymmetricFactor;
use crate::algebra::sparse::nodal_elimination::Friction;
use crate::algebra::sparse::preconditioned_refinement::Nearby;
use crate::algebra::sparse::*;
use crate::algebra::{Factorisation, inertia, null_space};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

struct Random(u64);

impl Random {
    /// A number between -1 and 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, most: usize) -> usize {
        (((self.next() + 1.0) * 0.5 * most as f64) as usize).min(most - 1)
    }
}

/// Features of the systems in addition to a chain of nodes with cross links.
#[derive(Clone, Copy, Default)]
struct Kind {
    contacts: bool,
    friction: bool,
    /// Obstacles move with the load.
    moved: bool,
    /// Under friction, reactions change direction with the position.
    unsymmetric: bool,
    /// The stiffness of one node is zero: only a contact constrains the node.
    loose: bool,
    /// The smallest eigenvalue is shifted to zero.
    limit: bool,
    /// A border row that belongs to no contact has a diagonal entry.
    track: bool,
}

struct System {
    sparse: Bordered,
    dense: DMatrix<f64>,
    holdings: Holdings,
}

fn system(random: &mut Random, dimension: usize, nodes: usize, kind: Kind) -> System {
    let n = dimension * nodes;
    let mut links: Vec<(usize, usize)> = (1..nodes).map(|node| (node - 1, node)).collect();
    (0..nodes / 3).for_each(|_| links.push((random.below(nodes), random.below(nodes))));
    let loose = kind.loose.then_some(nodes / 2);
    links.retain(|(a, b)| a != b && Some(*a) != loose && Some(*b) != loose);
    let block = |a: usize, b: usize| {
        (0..dimension).flat_map(move |i| (0..dimension).map(move |j| (a * dimension + i, b * dimension + j)))
    };
    let places = links.iter().flat_map(|(a, b)| block(*a, *b)).chain((0..nodes).flat_map(|node| block(node, node)));
    let pattern = Arc::new(Pattern::new(n, places).unwrap());
    let mut stiffness = DMatrix::zeros(n, n);
    for (a, b) in &links {
        let along: Vec<f64> = (0..2 * dimension).map(|_| random.next()).collect();
        let weight = random.next() + 0.3;
        let place = |k: usize| if k < dimension { a * dimension + k } else { b * dimension + k - dimension };
        for i in 0..2 * dimension {
            for j in 0..2 * dimension {
                stiffness[(place(i), place(j))] += weight * (along[i] * along[j]);
            }
        }
    }
    for unknown in (0..n).filter(|unknown| Some(unknown / dimension) != loose) {
        stiffness[(unknown, unknown)] += 0.3 + 0.1 * random.next();
    }
    let held: Vec<usize> =
        if kind.contacts { (0..nodes).filter(|node| node % 4 == 1 || Some(*node) == loose).collect() } else { vec![] };
    if kind.limit {
        // Subtracted from a diagonal entry of one node: the pattern remains, the determinant vanishes.
        let own = n - 1;
        let mut rest = stiffness.clone();
        rest[(own, own)] = 0.0;
        let mut unit = DVector::zeros(n);
        unit[own] = 1.0;
        let solved = Factorisation::new(stiffness.clone()).is_some_and(|f| f.solve(&mut unit));
        assert!(solved);
        stiffness[(own, own)] -= 1.0 / unit[own];
    }
    let mut rows_of: Vec<(usize, Vec<Vec<f64>>)> = Vec::new();
    for node in &held {
        let count = if Some(*node) == loose { dimension } else { 1 + random.below(dimension) };
        let frame = DMatrix::from_fn(dimension, dimension, |_, _| random.next()).qr().q();
        rows_of.push((*node, (0..count).map(|k| frame.column(k).iter().copied().collect()).collect()));
    }
    let contacts: usize = rows_of.iter().map(|(_, rows)| rows.len()).sum();
    let borders = 1 + contacts + usize::from(kind.track);
    let (mut sparse, mut dense) = (Bordered::new(pattern, borders), DMatrix::zeros(n + borders, n + borders));
    let mut put = |row: usize, column: usize, value: f64| {
        sparse.add(row, column, value);
        Sink::add(&mut dense, row, column, value);
    };
    for row in 0..n {
        for column in 0..n {
            put(row, column, stiffness[(row, column)]);
        }
        put(row, n, random.next());
    }
    let mut holdings = Vec::new();
    let mut next = n + 1;
    for (node, rows) in &rows_of {
        let unknowns: Vec<usize> = (node * dimension..(node + 1) * dimension).collect();
        let mut holding = Holding::new(unknowns.iter().copied());
        for direction in rows {
            for (unknown, part) in unknowns.iter().zip(direction) {
                put(next - 1, *unknown, *part);
                let drag = if kind.friction { 0.4 * random.next() } else { 0.0 };
                put(*unknown, next, drag - part);
            }
            if kind.moved {
                put(next - 1, n, random.next());
            }
            holding.rows.push(next - 1 - n);
            holding.columns.push(next - n);
            next += 1;
        }
        if kind.unsymmetric {
            for row in &unknowns {
                unknowns.iter().for_each(|column| put(*row, *column, 0.2 * random.next()));
            }
        }
        holdings.push(holding);
    }
    if kind.track {
        let row = next - 1;
        for unknown in 0..dimension {
            put(row, unknown, random.next());
            put(unknown, next, random.next());
        }
        put(row, next, random.next());
    }
    (0..=n).for_each(|column| put(n + borders - 1, column, random.next()));
    System { sparse, dense, holdings: Holdings::new(holdings) }
}

fn kinds() -> Vec<Kind> {
    let plain = Kind::default();
    let contacts = Kind { contacts: true, ..plain };
    vec![
        plain,
        Kind { limit: true, ..plain },
        contacts,
        Kind { friction: true, ..contacts },
        Kind { moved: true, ..contacts },
        Kind { friction: true, moved: true, unsymmetric: true, ..contacts },
        Kind { loose: true, ..contacts },
        Kind { loose: true, limit: false, friction: true, moved: true, unsymmetric: true, track: true, ..contacts },
        Kind { limit: true, friction: true, track: true, ..contacts },
    ]
}

#[test]
fn solutions_and_signs_are_those_of_the_dense_one() {
    let mut random = Random(3);
    let mut compared = 0;
    for (number, kind) in kinds().into_iter().enumerate() {
        for dimension in [2, 3] {
            for nodes in [2, 3, 5, 12, 40] {
                let System { sparse, dense, holdings } = system(&mut random, dimension, nodes, kind);
                let Some(known) = Factorisation::new(dense.clone()) else { continue };
                if known.pivot_ratio() < 1e-5 {
                    continue;
                }
                let (ways, none) = ([Friction::Bordered, Friction::Eliminated], Holdings::default());
                for (holdings, friction) in ways.iter().flat_map(|way| [(&holdings, *way), (&none, *way)]) {
                    let found = SparseFactorisation::with(sparse.clone(), holdings, friction).expect("regular");
                    assert_eq!(found.determinant_sign(), known.determinant_sign(), "{dimension} {nodes}");
                    let ratio = found.pivot_ratio();
                    assert!(ratio > 1e-9, "kind {number}, {dimension}, {nodes}: {ratio} for {}", known.pivot_ratio());
                    let right = DVector::from_fn(dense.nrows(), |_, _| random.next());
                    let (mut expected, mut solution) = (right.clone(), right);
                    assert!(known.solve(&mut expected) && found.solve(&mut solution));
                    let scale = expected.amax();
                    assert!((&solution - &expected).amax() <= 1e-12 * scale / known.pivot_ratio().min(1e-2) * 1e-2);
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 70, "{compared}");
}

/// What solutions are at the borders, by half solutions and by the dense factorisation.
#[test]
fn values_at_borders_are_those_of_the_solutions() {
    let mut random = Random(17);
    let (mut compared, mut refused) = (0, 0);
    for (number, kind) in kinds().into_iter().enumerate() {
        for (dimension, nodes) in [(2, 3), (2, 12), (2, 40), (3, 5), (3, 40)] {
            let System { sparse, dense, holdings } = system(&mut random, dimension, nodes, kind);
            let Some(known) = Factorisation::new(dense.clone()).filter(|known| known.pivot_ratio() >= 1e-5) else {
                continue;
            };
            let (unknowns, borders) = (dimension * nodes, sparse.lower.len());
            let rights: Vec<SparseEntries> = (0..borders + 5)
                .map(|row| [(row % borders, random.next()), (row * 3 % borders, random.next())].into_iter().collect())
                .collect();
            let (ways, none) = ([Friction::Bordered, Friction::Eliminated], Holdings::default());
            for (holdings, friction) in ways.iter().flat_map(|way| [(&holdings, *way), (&none, *way)]) {
                let found = SparseFactorisation::with(sparse.clone(), holdings, friction).expect("regular");
                let Some(values) = found.border_values(&rights) else {
                    refused += 1;
                    continue;
                };
                assert_eq!(values.shape(), (borders, rights.len()));
                for (right, values) in rights.iter().zip(values.column_iter()) {
                    let mut expected = DVector::zeros(dense.nrows());
                    right.iter().for_each(|(row, value)| expected[unknowns + row] += value);
                    assert!(known.solve(&mut expected));
                    let (scale, expected) = (expected.amax(), expected.rows(unknowns, borders));
                    let error = (values - expected).amax() / scale;
                    assert!(error <= 1e-8, "kind {number}, {dimension}, {nodes}: {error}");
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 150, "{compared} compared, {refused} refused");
}

#[test]
fn eigenvalues_of_what_is_held_are_counted() {
    let mut random = Random(11);
    let mut negatives = 0;
    for kind in [Kind::default(), Kind { contacts: true, ..Kind::default() }] {
        for nodes in [3, 7, 30] {
            for _ in 0..4 {
                let System { sparse, dense, holdings } = system(&mut random, 2, nodes, kind);
                let n = 2 * nodes;
                let held = dense.nrows() - n - 1;
                let tangent = dense.view((0, 0), (n, n));
                let basis = null_space(&dense.view((n, 0), (held, n)).into_owned(), 1e-11).unwrap();
                let reduced = basis.transpose() * tangent * &basis;
                let expected = inertia(reduced, 1e-13).unwrap();
                assert_eq!(held_inertia(&sparse, &holdings, 1e-13), Some(expected));
                negatives += expected.negative;
            }
        }
    }
    assert!(negatives > 20);
}

/// A matrix with many zero eigenvalues: its pivots are raised, and the eigenvalues counted are its own.
#[test]
fn zero_eigenvalues_are_raised_and_counted() {
    let pattern = Arc::new(Pattern::new(6, (0..6).flat_map(|i| (0..6).map(move |j| (i, j)))).unwrap());
    let mut sparse = Bordered::new(pattern, 1);
    let (first, second) = ([1.0, 2.0, -1.0, 0.5, 0.0, 1.0], [0.0, 1.0, 1.0, 0.0, 0.0, -3.0]);
    for i in 0..6 {
        for j in 0..6 {
            sparse.add(i, j, first[i] * first[j] - second[i] * second[j]);
        }
    }
    let found = held_inertia(&sparse, &Holdings::default(), 1e-13).unwrap();
    assert_eq!((found.negative, found.zero, found.positive), (1, 4, 1));
    let factor = SymmetricFactor::new(sparse.pattern.clone(), &sparse.values).unwrap();
    let vectors = factor.null_vectors(1e-10).unwrap();
    assert_eq!(vectors.len(), 4);
    for vector in vectors {
        let along = |row: &[f64; 6]| row.iter().zip(vector.iter()).map(|(a, b)| a * b).sum::<f64>().abs();
        assert!(along(&first) < 1e-13 && along(&second) < 1e-13);
    }
}

/// One set of holdings for several matrices, with equal and with different borders: each solution equals that with a
/// separate set.
#[test]
fn nodes_serve_on_only_while_borders_are_the_same() {
    let mut random = Random(11);
    let mut compared = 0;
    for kind in kinds() {
        let System { mut sparse, holdings, .. } = system(&mut random, 2, 12, kind);
        for friction in [Friction::Bordered, Friction::Eliminated] {
            for change in 0..4 {
                match change {
                    1 => sparse.values.iter_mut().for_each(|value| *value *= 1.5),
                    2 => {
                        for row in holdings.iter().flat_map(|holding| holding.rows.iter()) {
                            sparse.lower[*row].iter_mut().for_each(|(_, value)| *value *= 1.25);
                        }
                    }
                    _ => {}
                }
                let alone = Holdings::new(holdings.iter().cloned().collect());
                let solve = |holdings: &Holdings| {
                    let found = SparseFactorisation::with(sparse.clone(), holdings, friction)?;
                    let mut right = DVector::from_fn(sparse.size(), |row, _| 1.0 + (row % 5) as f64);
                    found.solve(&mut right).then_some(right)
                };
                assert_eq!(solve(&holdings), solve(&alone), "{friction:?} {change}");
                compared += usize::from(solve(&alone).is_some());
            }
        }
    }
    assert!(compared > 20, "{compared}");
}

#[test]
fn singular_systems_are_refused() {
    let mut random = Random(5);
    let mut refused = 0;
    for kind in kinds() {
        for nodes in [2, 12] {
            let System { mut sparse, holdings, .. } = system(&mut random, 2, nodes, kind);
            // The last row is a copy of the first equilibrium row.
            let last = sparse.lower.len() - 1;
            let n = sparse.pattern.size();
            let mut twin = SparseEntries::new();
            for column in 0..n {
                twin.extend(sparse.pattern.place(0, column).map(|place| (column, sparse.values[place])));
            }
            for (border, column) in sparse.right.iter().enumerate() {
                twin.extend(column.iter().filter(|(row, _)| *row == 0).map(|(_, value)| (n + border, *value)));
            }
            sparse.lower[last] = twin;
            let none = Holdings::default();
            for (holdings, friction) in
                [Friction::Bordered, Friction::Eliminated].iter().flat_map(|way| [(&holdings, *way), (&none, *way)])
            {
                let found = SparseFactorisation::with(sparse.clone(), holdings, friction);
                assert!(
                    found.is_none(),
                    "{friction:?} {} {nodes} {:?}",
                    holdings.iter().len(),
                    found.map(|found| found.pivot_ratio())
                );
                refused += 1;
            }
        }
    }
    assert_eq!(refused, 8 * kinds().len());
    let mut wrong = system(&mut random, 2, 4, Kind::default()).sparse;
    wrong.add(0, 0, f64::NAN);
    assert!(SparseFactorisation::new(wrong, &Holdings::default()).is_none());
}

/// LU of the whole matrix gives the solution of the dense factorisation.
#[test]
fn the_whole_may_be_factorised() {
    let mut random = Random(17);
    for kind in kinds() {
        let System { sparse, dense, .. } = system(&mut random, 3, 9, kind);
        let Some(known) = Factorisation::new(dense) else { continue };
        let right = DVector::from_fn(sparse.size(), |_, _| random.next());
        let (mut expected, mut solution) = (right.clone(), right);
        let whole = crate::algebra::sparse::fallback_lu::WholeLu::new(&sparse).expect("regular");
        assert!(known.solve(&mut expected) && whole.solve(solution.as_mut_slice()));
        assert!((&solution - &expected).amax() <= 1e-10 * expected.amax());
    }
}

#[test]
fn a_nearby_factorisation_gives_the_solution_to_rounding() {
    let random = &mut Random(41);
    let kind = Kind { contacts: true, friction: true, moved: true, ..Kind::default() };
    for _ in 0..10 {
        let System { sparse, dense, holdings } = system(random, 2, 20, kind);
        let Some(factorisation) = SparseFactorisation::new(sparse.clone(), &holdings) else { continue };
        let solved = |change: f64| {
            let (mut nearby, mut whole) = (sparse.clone(), dense.clone());
            for unknown in 0..40 {
                let value = change * (1.0 + unknown as f64 / 40.0);
                nearby.add(unknown, unknown, value);
                Sink::add(&mut whole, unknown, unknown, value);
            }
            let right = DVector::from_fn(whole.nrows(), |row, _| if row + 1 == whole.nrows() { 1.0 } else { 0.0 });
            let mut exact = right.clone();
            assert!(Factorisation::new(whole).unwrap().solve(&mut exact));
            Nearby::new(&factorisation, nearby)
                .and_then(|nearby| nearby.solve(&right))
                .map(|found| (found - &exact).amax() / exact.amax())
        };
        assert!(solved(1e-7).unwrap() < 1e-10);
        assert!(solved(10.0).is_none());
    }
}

/// The solution has no component along the eigenvector whose eigenvalue differs in sign between the two matrices.
#[test]
fn a_matrix_of_another_sign_is_not_nearby() {
    let pattern = Arc::new(Pattern::new(3, (0..3).map(|unknown| (unknown, unknown))).unwrap());
    let matrix = |last: f64| {
        let mut matrix = Bordered::new(pattern.clone(), 1);
        [1.0, 1.0, last].iter().enumerate().for_each(|(unknown, value)| matrix.add(unknown, unknown, *value));
        matrix.add(0, 3, -1.0);
        matrix.add(3, 0, 1.0);
        matrix
    };
    let factorisation = SparseFactorisation::new(matrix(1e-3), &Holdings::default()).unwrap();
    let right = DVector::from_vec(vec![0.0, 0.0, 0.0, 1.0]);
    let comes_out =
        |last: f64| Nearby::new(&factorisation, matrix(last)).is_some_and(|nearby| nearby.solve(&right).is_some());
    assert!(comes_out(1e-3 * (1.0 + 1e-6)));
    assert!(!comes_out(-1e-3));
}

/// A factorisation with its last row replaced equals a new factorisation of the matrix with this row, to the last bit.
#[test]
fn the_last_row_may_be_another() {
    let random = &mut Random(53);
    let mut compared = 0;
    for kind in kinds() {
        for dimension in [2, 3] {
            let System { sparse, holdings, .. } = system(random, dimension, 12, kind);
            let last = sparse.size() - 1;
            let mut other = sparse.clone();
            other.lower[last - sparse.pattern.size()].clear();
            let row: Vec<f64> = (0..=sparse.pattern.size()).map(|_| random.next()).collect();
            let put = |matrix: &mut dyn Sink| {
                row.iter().enumerate().for_each(|(column, value)| matrix.add(last, column, *value));
            };
            put(&mut other);
            for friction in [Friction::Bordered, Friction::Eliminated] {
                let anew = SparseFactorisation::with(other.clone(), &holdings, friction).expect("regular");
                let first = SparseFactorisation::with(sparse.clone(), &holdings, friction).expect("regular");
                let Some(second) = first.with_last_row(put) else { continue };
                let right = DVector::from_fn(last + 1, |_, _| random.next());
                let (mut expected, mut solution) = (right.clone(), right);
                assert!(anew.solve(&mut expected) && second.solve(&mut solution));
                assert_eq!(solution, expected);
                assert_eq!(second.determinant_sign(), anew.determinant_sign());
                assert_eq!(second.pivot_ratio(), anew.pivot_ratio());
                compared += 1;
            }
        }
    }
    assert!(compared > 30, "{compared}");
}
