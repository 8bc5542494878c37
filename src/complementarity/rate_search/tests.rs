//! The search against plain enumeration of every combination, which exists for this comparison only.

use crate::complementarity::rate_search::branch_and_bound::{Effort, Findings, Ray, explore, explore_without_pivoting};
use crate::complementarity::rates::cartesian_product::combinations;
use crate::complementarity::rates::rate_problem::{Entity, RateProblem, Touching};
use crate::complementarity::rates::ray_of_combination;
use crate::complementarity::rates::ray_of_combination::Line;
use crate::complementarity::rates::{lemke, p_matrix, parametric_lcp};
use crate::resources::cancel::CancelFlag;
use nalgebra::{DMatrix, DVector, RowDVector};
use std::sync::Arc;

fn effort(most_modes: u64, cancel: &CancelFlag) -> Effort<'_> {
    Effort { most_modes, certify: true, cancel }
}

/// Whether the vectors of a plane (two columns) that satisfy a combination's inequalities fill more than a line.
fn plane_is_wide(problem: &RateProblem, chosen: &[usize], basis: &DMatrix<f64>) -> bool {
    let inequalities: Vec<[f64; 2]> = problem
        .entities
        .iter()
        .zip(chosen)
        .flat_map(|(entity, choice)| &entity.options[*choice].nonnegative)
        .map(|signed| {
            let row = problem.forms.row(signed.form) * basis * signed.sign;
            [row[0], row[1]]
        })
        .filter(|row| row[0].abs().max(row[1].abs()) > 1e-9)
        .collect();
    let candidates = inequalities.iter().flat_map(|&[x, y]| [[x, y], [-y, x], [y, -x]]);
    let inside: Vec<[f64; 2]> =
        candidates.filter(|c| inequalities.iter().all(|row| row[0] * c[0] + row[1] * c[1] >= -1e-9)).collect();
    inequalities.is_empty() || inside.iter().any(|a| inside.iter().any(|b| (a[0] * b[1] - a[1] * b[0]).abs() > 1e-6))
}

/// Examines every combination in turn.
pub(crate) fn every_combination(problem: &RateProblem) -> Findings {
    let mut findings = Findings::default();
    let options: Vec<Vec<usize>> = problem.entities.iter().map(|entity| (0..entity.options.len()).collect()).collect();
    for chosen in combinations(&options, u64::MAX) {
        match ray_of_combination::line(problem, &chosen) {
            Line::Nothing => {}
            Line::Along(weights) => {
                for weights in [-&weights, weights] {
                    let along = ray_of_combination::forms_along(problem, &weights);
                    if along.violated(&chosen).is_empty() {
                        let fitting: Vec<Vec<usize>> = chosen.iter().map(|choice| vec![*choice]).collect();
                        let weak = along.is_weak(&fitting);
                        findings.rays.push(Ray { weights, in_doubt: fitting.clone(), fitting, weak });
                    }
                }
            }
            Line::Plane(basis) => {
                findings.degenerate = true;
                if basis.ncols() == 2 && plane_is_wide(problem, &chosen, &basis) {
                    findings.planes.push(basis);
                }
            }
            Line::Still | Line::NotFinite => findings.degenerate = true,
        }
    }
    findings
}

/// xorshift64*: the same problems on every machine.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// A number between -1 and 1.
    pub fn value(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(crate) fn below(&mut self, bound: u64) -> u64 {
        (self.next() >> 33) % bound
    }
}

/// The kind of coefficients of a problem.
#[derive(Clone, Copy, Debug)]
enum Numbers {
    Real,
    /// -1, 0 or 1: many inequalities hold with equality.
    Small,
    /// A symmetric positive definite stiffness plus friction coupling of this size.
    Stiffness(f64),
}

/// Contacts on the cone (`false`) or touching with friction (`true`), with random reaction rates.
fn random_problem(random: &mut Random, kinds: &[bool], numbers: Numbers) -> RateProblem {
    let velocities: usize = kinds.iter().map(|touching| 1 + usize::from(*touching)).sum();
    let weights = velocities + 1;
    let number = |random: &mut Random| match numbers {
        Numbers::Small => random.below(3) as f64 - 1.0,
        Numbers::Real | Numbers::Stiffness(_) => random.value(),
    };
    let mut stiffness = DMatrix::from_fn(velocities, velocities, |_, _| number(random));
    if let Numbers::Stiffness(coupling) = numbers {
        let friction = DMatrix::from_fn(velocities, velocities, |_, _| coupling * random.value());
        stiffness = &stiffness * stiffness.transpose() + friction;
    }
    let load: Vec<f64> = (0..velocities).map(|_| number(random)).collect();
    let row = |velocity: usize| {
        let mut row = DVector::zeros(weights);
        (0..velocities).for_each(|column| row[column] = stiffness[(velocity, column)]);
        row[velocities] = -load[velocity];
        row
    };
    let unit = |column: usize| DVector::from_fn(weights, |index, _| f64::from(u8::from(index == column)));
    let (mut forms, mut is_force, mut entities, mut reactions) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut add = |form: DVector<f64>, force: bool| {
        forms.push(form);
        is_force.push(force);
        forms.len() - 1
    };
    let mut velocity = 0;
    for touching in kinds {
        if *touching {
            let friction = match numbers {
                Numbers::Small => 1.0,
                Numbers::Real | Numbers::Stiffness(_) => 0.2 + 0.5 * (random.value() + 1.0),
            };
            let (normal, tangential) = (row(velocity), row(velocity + 1));
            let gap = add(unit(velocity), false);
            let along = add(unit(velocity + 1), false);
            let pressing = add(normal.clone(), true);
            let traction = add(tangential.clone(), true);
            let up = add(&normal * friction + &tangential, true);
            let down = add(&normal * friction - &tangential, true);
            let cone = [up, down];
            entities.push(Entity::touching(Touching { gap, along, pressing, traction, cone }));
            reactions.extend([normal, tangential]);
            velocity += 2;
        } else {
            let b = add(unit(velocity), false);
            let a = add(row(velocity), true);
            entities.push(Entity::complementary(a, b));
            reactions.push(row(velocity));
            velocity += 1;
        }
    }
    let matrix = |rows: &[DVector<f64>]| DMatrix::from_fn(rows.len(), weights, |row, column| rows[row][column]);
    RateProblem {
        forms: matrix(&forms),
        is_force,
        entities,
        load: RowDVector::from_fn(weights, |_, column| f64::from(column + 1 == weights)),
        sizes: vec![1.0; weights],
        motion: Arc::new(DMatrix::<f64>::identity(weights, weights)),
        reactions: matrix(&reactions),
    }
}

/// Checks that every ray of one list is in the other; a list may contain one motion under several combinations.
fn compare(problem: &RateProblem, found: &Findings, exact: &Findings, what: &str) {
    assert_eq!(found.unexplored, 0, "{what}");
    let near = |a: &Ray, b: &Ray| (&a.weights - &b.weights).norm() <= 1e-7;
    for ray in &exact.rays {
        let is_listed = |other: &Ray| near(ray, other) && other.is_under(&ray.chosen()) && (other.weak || !ray.weak);
        assert!(found.rays.iter().any(is_listed), "{what}: missed {:?} {:?}", ray.fitting, ray.weights);
    }
    for ray in &found.rays {
        // A combination whose equations leave more than a line may still be a label of a ray.
        let is_plane = || matches!(ray_of_combination::line(problem, &ray.chosen()), Line::Plane(_));
        let known = exact.rays.iter().any(|other| near(ray, other) && ray.is_under(&other.chosen()));
        assert!(known || is_plane(), "{what}: {:?} {:?} is none", ray.fitting, ray.weights);
        for combination in combinations(&ray.fitting, u64::MAX) {
            let listed = exact.rays.iter().any(|other| near(ray, other) && other.chosen() == combination);
            let is_plane = || matches!(ray_of_combination::line(problem, &combination), Line::Plane(_));
            assert!(listed || is_plane(), "{what}: {combination:?} is no label of {:?}", ray.weights);
        }
    }
    assert!(exact.degenerate || !found.degenerate, "{what}");
    assert!(found.degenerate || exact.planes.is_empty(), "{what}");
}

fn check(seeds: std::ops::Range<u64>, contacts: u64, numbers: Numbers, touching: bool) -> (usize, usize) {
    let (mut certified, mut rays) = (0, 0);
    for seed in seeds {
        let mut random = Random::new(seed);
        let count = 1 + random.below(contacts) as usize;
        let kinds: Vec<bool> = (0..count).map(|_| touching && random.below(2) == 0).collect();
        let problem = random_problem(&mut random, &kinds, numbers);
        let exact = every_combination(&problem);
        let found = explore(&problem, Vec::new, effort(1_000_000, &CancelFlag::default()));
        certified += usize::from(found.certified);
        rays += exact.rays.len();
        compare(&problem, &found, &exact, &format!("seed {seed}, {kinds:?}, {numbers:?}"));
    }
    (certified, rays)
}

#[test]
fn contacts_on_the_cone_as_by_enumeration() {
    let (_, rays) = check(0..600, 8, Numbers::Real, false);
    assert!(rays > 600);
    let (certified, _) = check(0..400, 8, Numbers::Stiffness(0.3), false);
    assert!(certified > 50, "{certified}");
}

#[test]
fn touching_contacts_as_by_enumeration() {
    check(0..200, 5, Numbers::Real, true);
    check(0..150, 5, Numbers::Stiffness(0.3), true);
}

#[test]
fn inequalities_that_hold_with_equality_as_by_enumeration() {
    check(0..1000, 5, Numbers::Small, false);
    check(0..400, 3, Numbers::Small, true);
}

/// Where the search is cut short, Lemke's method continues: all its results are rays by plain enumeration, and it finds
/// most rays.
#[test]
fn what_complementary_pivoting_names_is_among_all_rays() {
    let (mut named, mut missed, mut both) = (0, 0, 0);
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let count = 1 + random.below(6) as usize;
        let kinds: Vec<bool> = (0..count).map(|_| random.below(3) == 0).collect();
        let numbers = if seed % 2 == 0 { Numbers::Real } else { Numbers::Stiffness(1.0) };
        let problem = random_problem(&mut random, &kinds, numbers);
        let exact = every_combination(&problem);
        let found = lemke::lemke(&problem, &CancelFlag::default());
        for chosen in &found {
            assert!(exact.rays.iter().any(|ray| ray.is_under(chosen)), "seed {seed}: {chosen:?} is no ray");
        }
        named += found.len();
        missed += exact.rays.len().saturating_sub(found.len());
        let loads = |sign: f64| {
            found.iter().any(|chosen| {
                exact.rays.iter().any(|ray| ray.is_under(chosen) && sign * ray.weights[ray.weights.len() - 1] > 0.0)
            })
        };
        both += usize::from(loads(1.0) && loads(-1.0));
    }
    // For general matrices many runs end on a secondary ray.
    assert!(named > 700 && 10 * named > 9 * missed, "{named} named, {missed} missed");
    assert!(both > 100, "{both}");
}

/// Many contacts, and a search limited to so few nodes that it finds little.
#[test]
fn complementary_pivoting_finds_what_a_cut_search_misses() {
    let (mut beyond, mut before) = (0, 0);
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let kinds = vec![false; 24];
        let problem = random_problem(&mut random, &kinds, Numbers::Stiffness(4.0));
        let cut = explore_without_pivoting(&problem, effort(40, &CancelFlag::default()));
        let found = explore(&problem, Vec::new, effort(40, &CancelFlag::default()));
        if cut.unexplored > 0 {
            before += cut.rays.len();
            beyond += found.rays.len() - cut.rays.len();
        }
    }
    assert!(beyond > 0 && beyond > before, "{beyond} beyond {before}");
}

/// Among thirty touching contacts a search cannot decide all combinations: it ends long before its effort is spent, and
/// counts what is left.
#[test]
fn a_hopeless_search_ends_early() {
    const MOST: u64 = 16_384;
    let mut cut = 0;
    for seed in 0..4 {
        let mut random = Random::new(seed);
        let problem = random_problem(&mut random, &[true; 30], Numbers::Stiffness(4.0));
        let found = explore_without_pivoting(&problem, effort(MOST, &CancelFlag::default()));
        assert!(found.unexplored == 0 || found.examined < MOST / 4, "{} {}", found.examined, found.unexplored);
        cut += usize::from(found.unexplored > 0);
    }
    assert!(cut > 0);
}

/// Matrices that are definite except in one direction: most are solved without branching, and no ray is missed.
#[test]
fn one_pair_in_the_way_of_a_p_matrix_as_by_enumeration() {
    let mut settled = 0;
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let count = 1 + random.below(8) as usize;
        let kinds = vec![false; count];
        let mut problem = random_problem(&mut random, &kinds, Numbers::Stiffness(0.2));
        // Softened along one direction by more than the stiffness.
        let along = DVector::from_fn(count, |_, _| random.value());
        let softer = DMatrix::from_fn(count, count, |row, column| {
            // Force forms have odd places: see `random_problem`.
            3.0 * along[row] * along[column] - if row == column { 0.3 } else { 0.0 }
        });
        for row in 0..count {
            for column in 0..count {
                problem.forms[(2 * row + 1, column)] -= softer[(row, column)];
                problem.reactions[(row, column)] = problem.forms[(2 * row + 1, column)];
            }
        }
        let matrix = DMatrix::from_fn(count, count, |row, column| problem.forms[(2 * row + 1, column)]);
        let load = DVector::from_fn(count, |row, _| problem.forms[(2 * row + 1, count)]);
        let is_settled = p_matrix::Certified::new(matrix.clone(), load.clone()).is_none()
            && parametric_lcp::solutions(&matrix, &load).is_some();
        settled += usize::from(is_settled);
        let exact = every_combination(&problem);
        let found = explore(&problem, Vec::new, effort(1_000_000, &CancelFlag::default()));
        assert!(!is_settled || !found.certified && found.examined <= 8 * (1 + count as u64), "seed {seed}");
        compare(&problem, &found, &exact, &format!("seed {seed}, {count} contacts"));
    }
    assert!(settled > 150, "{settled}");
}

/// Equal contacts, so that many pairs change at once along the function whose zeros are sought.
#[test]
fn equal_contacts_with_one_soft_direction_as_by_enumeration() {
    let mut settled = 0;
    for count in 2..8 {
        for softness in [0.05, 0.3, 0.6] {
            let matrix = DMatrix::from_fn(count, count, |row, column| {
                (if row == column { 1.0 } else { 0.0 }) - (1.0 + softness) / count as f64
            });
            let load = DVector::from_element(count, -1.0);
            settled += usize::from(parametric_lcp::solutions(&matrix, &load).is_some());
            let mut problem = random_problem(&mut Random::new(1), &vec![false; count], Numbers::Real);
            for row in 0..count {
                for column in 0..count {
                    problem.forms[(2 * row + 1, column)] = matrix[(row, column)];
                }
                problem.forms[(2 * row + 1, count)] = load[row];
                problem.reactions.row_mut(row).copy_from(&problem.forms.row(2 * row + 1).into_owned());
            }
            let exact = every_combination(&problem);
            let found = explore(&problem, Vec::new, effort(1_000_000, &CancelFlag::default()));
            compare(&problem, &found, &exact, &format!("{count} contacts, {softness}"));
        }
    }
    assert!(settled > 5, "{settled}");
}
