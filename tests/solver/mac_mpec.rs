//! Sixteen problems of the MacMPEC collection (S. Leyffer), from their published starts.
//!
//! Statements rewritten from the public models, optima confirmed by enumeration of all branches. Each test holds the
//! solver to the listed objective, feasibility, complementarity, and the kind of stationarity it reports.

use arcslip::complementarity::mpec::{
    self, Problem, ProgramSolution, Settings, SolveStatus, SparseRows, StationarityKind,
};
use arcslip::resources::cancel::CancelFlag;
use nalgebra::DVector;

const INF: f64 = f64::INFINITY;

type Scalar = fn(&[f64]) -> f64;
type Vector = fn(&[f64]) -> Vec<f64>;
type Pairs = fn(&[f64]) -> Vec<(f64, f64)>;

/// A problem given by its values; derivatives by Richardson-extrapolated central differences, exact to about 1e-11 and
/// for polynomials up to degree four to round-off.
struct Listed {
    objective: Scalar,
    lower: Vec<f64>,
    upper: Vec<f64>,
    pairs: Pairs,
    equalities: Vector,
    inequalities: Vector,
}

fn none(_: &[f64]) -> Vec<f64> {
    Vec::new()
}

impl Listed {
    fn differences(
        &self,
        x: &DVector<f64>,
        values: &dyn Fn(&[f64]) -> Vec<f64>,
        mut put: impl FnMut(usize, usize, f64),
    ) {
        let mut at = x.as_slice().to_vec();
        for j in 0..at.len() {
            let step = 1e-3 * (1.0 + at[j].abs());
            let centre = at[j];
            let mut sample = |offset: f64| {
                at[j] = centre + offset;
                let result = values(&at);
                at[j] = centre;
                result
            };
            let (near_up, near_down) = (sample(step), sample(-step));
            let (far_up, far_down) = (sample(2.0 * step), sample(-2.0 * step));
            for i in 0..near_up.len() {
                let slope = (8.0 * (near_up[i] - near_down[i]) - (far_up[i] - far_down[i])) / (12.0 * step);
                put(i, j, slope);
            }
        }
    }
}

impl Problem for Listed {
    fn variables(&self) -> usize {
        self.lower.len()
    }
    fn equalities(&self) -> usize {
        (self.equalities)(&vec![0.0; self.lower.len()]).len()
    }
    fn inequalities(&self) -> usize {
        (self.inequalities)(&vec![0.0; self.lower.len()]).len()
    }
    fn pairs(&self) -> usize {
        (self.pairs)(&vec![0.0; self.lower.len()]).len()
    }
    fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
        (DVector::from_column_slice(&self.lower), DVector::from_column_slice(&self.upper))
    }
    fn objective(&self, x: &DVector<f64>) -> f64 {
        (self.objective)(x.as_slice())
    }
    fn objective_gradient(&self, x: &DVector<f64>, gradient: &mut DVector<f64>) {
        self.differences(x, &|v| vec![(self.objective)(v)], |_, j, slope| gradient[j] = slope);
    }
    fn equality_values(&self, x: &DVector<f64>, values: &mut DVector<f64>) {
        values.copy_from_slice(&(self.equalities)(x.as_slice()));
    }
    fn equality_jacobian(&self, x: &DVector<f64>, jacobian: &mut SparseRows) {
        self.differences(x, &|v| (self.equalities)(v), |i, j, slope| jacobian[(i, j)] = slope);
    }
    fn inequality_values(&self, x: &DVector<f64>, values: &mut DVector<f64>) {
        values.copy_from_slice(&(self.inequalities)(x.as_slice()));
    }
    fn inequality_jacobian(&self, x: &DVector<f64>, jacobian: &mut SparseRows) {
        self.differences(x, &|v| (self.inequalities)(v), |i, j, slope| jacobian[(i, j)] = slope);
    }
    fn pair_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        for (i, (a, b)) in (self.pairs)(x.as_slice()).into_iter().enumerate() {
            (first[i], second[i]) = (a, b);
        }
    }
    fn pair_jacobians(&self, x: &DVector<f64>, first: &mut SparseRows, second: &mut SparseRows) {
        let members = |v: &[f64]| (self.pairs)(v).into_iter().flat_map(|(a, b)| [a, b]).collect();
        self.differences(x, &members, |i, j, slope| {
            let jacobian = if i % 2 == 0 { &mut *first } else { &mut *second };
            jacobian[(i / 2, j)] = slope;
        });
    }
}

/// Solves from `start` and checks everything that a listed problem promises.
fn check(name: &str, problem: &Listed, start: &[f64], optima: &[f64], kind: StationarityKind) -> ProgramSolution {
    let start = DVector::from_column_slice(start);
    let solution = mpec::solve(problem, &start, &Settings::default(), &CancelFlag::default()).expect("valid input");
    println!(
        "{name:14} {:?} f = {:.9e} {:?} violation {:.1e} product {:.1e} x = {:.6?} {:?}",
        solution.status,
        solution.objective,
        solution.stationarity,
        solution.largest_violation,
        solution.largest_product,
        solution.x.as_slice(),
        solution.counts
    );
    assert_eq!(solution.status, SolveStatus::Solved, "{name}");
    assert!(solution.largest_violation <= 1e-8, "{name}: violation {}", solution.largest_violation);
    assert!(solution.largest_product <= 1e-8, "{name}: product {}", solution.largest_product);
    let reached = optima.iter().any(|optimum| {
        let scale = if *optimum == 0.0 { 1.0 } else { optimum.abs() };
        (solution.objective - optimum).abs() <= 1e-5 * scale
    });
    assert!(reached, "{name}: objective {} is none of {optima:?}", solution.objective);
    assert_eq!(solution.stationarity, kind, "{name}");
    solution
}

#[test]
fn kth1_has_a_biactive_optimum() {
    let problem = Listed {
        objective: |v| v[0] + v[1],
        lower: vec![0.0; 2],
        upper: vec![INF; 2],
        pairs: |v| vec![(v[0], v[1])],
        equalities: none,
        inequalities: none,
    };
    check("kth1", &problem, &[0.0, 1.0], &[0.0], StationarityKind::Strong);
}

#[test]
fn kth2() {
    let problem = Listed {
        objective: |v| v[0] + (v[1] - 1.0).powi(2),
        lower: vec![0.0; 2],
        upper: vec![INF; 2],
        pairs: |v| vec![(v[0], v[1])],
        equalities: none,
        inequalities: none,
    };
    check("kth2", &problem, &[1.0, 0.0], &[0.0], StationarityKind::Strong);
}

#[test]
fn jr1() {
    let problem = Listed {
        objective: |v| (v[0] - 1.0).powi(2) + v[1].powi(2),
        lower: vec![-INF, 0.0],
        upper: vec![INF; 2],
        pairs: |v| vec![(v[1], v[1] - v[0])],
        equalities: none,
        inequalities: none,
    };
    check("jr1", &problem, &[0.0, 0.0], &[0.5], StationarityKind::Strong);
}

/// Two local minimisers: (0, 1) with 1, and (0.01, 0) with 1.
#[test]
fn scale1() {
    let problem = Listed {
        objective: |v| (100.0 * v[0] - 1.0).powi(2) + (v[1] - 1.0).powi(2),
        lower: vec![-INF; 2],
        upper: vec![INF; 2],
        pairs: |v| vec![(v[0], v[1])],
        equalities: none,
        inequalities: none,
    };
    check("scale1", &problem, &[0.0, 0.0], &[1.0], StationarityKind::Strong);
}

/// Two local minimisers: (0, 1) and (1, 0), both with 100.
#[test]
fn scale5() {
    let problem = Listed {
        objective: |v| 100.0 * ((v[0] - 1.0).powi(2) + (v[1] - 1.0).powi(2)),
        lower: vec![-INF; 2],
        upper: vec![INF; 2],
        pairs: |v| vec![(v[0], v[1])],
        equalities: none,
        inequalities: none,
    };
    check("scale5", &problem, &[0.0, 0.0], &[100.0], StationarityKind::Strong);
}

#[test]
fn df1() {
    let problem = Listed {
        objective: |v| (v[0] - 1.0 - v[1]).powi(2),
        lower: vec![-1.0, 0.0],
        upper: vec![2.0, INF],
        pairs: |v| vec![(v[1] - v[0].powi(2) + 1.0, v[1])],
        equalities: none,
        inequalities: |v| vec![2.0 - v[0].powi(2), 3.0 - (v[0] - 1.0).powi(2) - (v[1] - 1.0).powi(2)],
    };
    check("df1", &problem, &[0.0, 0.0], &[0.0], StationarityKind::Strong);
}

#[test]
fn scholtes1() {
    let problem = Listed {
        objective: |v| (v[0] + 1.0).powi(2) + (v[1] - 2.5).powi(2) + (v[2] + 1.0).powi(2),
        lower: vec![0.0, -INF, 0.0],
        upper: vec![INF; 3],
        pairs: |v| vec![(-v[0].exp() + v[1] - v[2].exp(), v[0])],
        equalities: none,
        inequalities: none,
    };
    check("scholtes1", &problem, &[1.0, 1.0, 1.0], &[2.0], StationarityKind::Strong);
}

/// The optimum, the origin, is stationary in each of its two branches but not strongly: with both members free to grow
/// the objective falls.
#[test]
fn scholtes4_is_stationary_by_branches_only() {
    let problem = Listed {
        objective: |v| v[0] + v[1] - v[2],
        lower: vec![0.0, 0.0, -INF],
        upper: vec![INF; 3],
        pairs: |v| vec![(v[0], v[1])],
        equalities: none,
        inequalities: |v| vec![4.0 * v[0] - v[2], 4.0 * v[1] - v[2]],
    };
    check("scholtes4", &problem, &[0.0, 1.0, 0.0], &[0.0], StationarityKind::Branch);
}

#[test]
fn stackelberg1() {
    let problem = Listed {
        objective: |v| 0.5 * v[0].powi(2) + 0.5 * v[0] * v[1] - 95.0 * v[0],
        lower: vec![0.0; 3],
        upper: vec![200.0, INF, INF],
        pairs: |v| vec![(v[1], v[2])],
        equalities: |v| vec![2.0 * v[1] + 0.5 * v[0] - 100.0 - v[2]],
        inequalities: none,
    };
    check("stackelberg1", &problem, &[0.0; 3], &[-9800.0 / 3.0], StationarityKind::Strong);
}

#[test]
fn bard1() {
    let problem = Listed {
        objective: |v| (v[0] - 5.0).powi(2) + (2.0 * v[1] + 1.0).powi(2),
        lower: vec![0.0, 0.0, -INF, -INF, -INF],
        upper: vec![INF; 5],
        pairs: |v| vec![(3.0 * v[0] - v[1] - 3.0, v[2]), (-v[0] + 0.5 * v[1] + 4.0, v[3]), (7.0 - v[0] - v[1], v[4])],
        equalities: |v| vec![2.0 * (v[1] - 1.0) - 1.5 * v[0] + v[2] - 0.5 * v[3] + v[4]],
        inequalities: none,
    };
    check("bard1", &problem, &[0.0; 5], &[17.0], StationarityKind::Strong);
}

#[test]
fn desilva() {
    let problem = Listed {
        objective: |v| v[0].powi(2) - 2.0 * v[0] + v[1].powi(2) - 2.0 * v[1] + v[2].powi(2) + v[3].powi(2),
        lower: vec![0.0, 0.0, -INF, -INF, 0.0, 0.0],
        upper: vec![2.0, 2.0, INF, INF, INF, INF],
        pairs: |v| vec![(0.25 - (v[2] - 1.0).powi(2), v[4]), (0.25 - (v[3] - 1.0).powi(2), v[5])],
        equalities: |v| {
            vec![
                2.0 * v[2] - 2.0 * v[0] + 2.0 * (v[2] - 1.0) * v[4],
                2.0 * v[3] - 2.0 * v[1] + 2.0 * (v[3] - 1.0) * v[5],
            ]
        },
        inequalities: none,
    };
    check("desilva", &problem, &[0.0; 6], &[-1.0], StationarityKind::Strong);
}

/// The minimisers, all with objective 0, are not isolated: (5, 9) is reached here, (9, 6) is the listed one.
#[test]
fn nash1_from_all_five_starts() {
    let problem = Listed {
        objective: |v| ((v[0] - v[2]).powi(2) + (v[1] - v[3]).powi(2)) / 2.0,
        lower: vec![0.0, 0.0, -INF, -INF, 0.0, 0.0],
        upper: vec![10.0, 10.0, INF, INF, INF, INF],
        pairs: |v| vec![(15.0 - v[1] - v[2], v[4]), (15.0 - v[0] - v[3], v[5])],
        equalities: |v| vec![-34.0 + 2.0 * v[2] + 8.0 / 3.0 * v[3] + v[4], -24.25 + 1.25 * v[2] + 2.0 * v[3] + v[5]],
        inequalities: none,
    };
    for (x1, x2) in [(0.0, 0.0), (5.0, 5.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0)] {
        let name = format!("nash1 ({x1},{x2})");
        check(&name, &problem, &[x1, x2, 0.0, 0.0, 0.0, 0.0], &[0.0], StationarityKind::Strong);
    }
}

fn outrata_pairs(v: &[f64]) -> Vec<(f64, f64)> {
    let y = v[4];
    vec![
        ((1.0 + 0.2 * y) * v[0] - (3.0 + 1.333 * y) - 0.333 * v[2] + 2.0 * v[0] * v[3], v[0]),
        ((1.0 + 0.1 * y) * v[1] - y + v[2] + 2.0 * v[1] * v[3], v[1]),
        (0.333 * v[0] - v[1] + 1.0 - 0.1 * y, v[2]),
        (9.0 + 0.1 * y - v[0].powi(2) - v[1].powi(2), v[3]),
    ]
}

#[test]
fn outrata31() {
    let problem = Listed {
        objective: |v| ((v[0] - 3.0).powi(2) + (v[1] - 4.0).powi(2)) / 2.0,
        lower: vec![0.0; 5],
        upper: vec![INF, INF, INF, INF, 10.0],
        pairs: outrata_pairs,
        equalities: none,
        inequalities: none,
    };
    let solution = check("outrata31", &problem, &[0.0; 5], &[3.2077], StationarityKind::Strong);
    assert!((solution.x[4] - 4.06041).abs() < 1e-4);
}

#[test]
fn outrata33() {
    let problem = Listed {
        objective: |v| ((v[0] - 3.0).powi(2) + (v[1] - 4.0).powi(2) + 10.0 * v[3].powi(2)) / 2.0,
        lower: vec![0.0; 5],
        upper: vec![INF, INF, INF, INF, 10.0],
        pairs: outrata_pairs,
        equalities: none,
        inequalities: none,
    };
    check("outrata33", &problem, &[0.0; 5], &[4.60425], StationarityKind::Strong);
}

/// Not strongly stationary: with the first pair's members both free to grow, `20 = 2 λ + κ - ν_a`, `κ = 4 λ - ν_a` and
/// `ν_b = -λ` have no solution with `κ, ν_a, ν_b >= 0`. Each of the two branches is stationary.
#[test]
fn ex_9_2_2_is_stationary_by_branches_only() {
    let problem = Listed {
        objective: |v| v[0].powi(2) + (v[1] - 10.0).powi(2),
        lower: vec![0.0; 5],
        upper: vec![15.0, INF, INF, INF, INF],
        pairs: |v| vec![(20.0 - v[0] - v[1], v[2]), (v[1], v[3]), (20.0 - v[1], v[4])],
        equalities: |v| vec![2.0 * (v[0] + 2.0 * v[1] - 30.0) + v[2] - v[3] + v[4]],
        inequalities: |v| vec![v[0] - v[1]],
    };
    check("ex9.2.2", &problem, &[0.0; 5], &[100.0], StationarityKind::Branch);
}

#[test]
fn sl1() {
    let problem = Listed {
        objective: |v| (v[0] - 2.0).powi(2) + v[1].powi(2),
        lower: vec![-INF, -INF, 10.0, 0.01, 0.0, 0.0, 0.0, 0.0],
        upper: vec![INF, INF, 1e10, 10.0, 1.0, INF, INF, INF],
        pairs: |v| {
            vec![(10.0 * v[0] + v[1] - 10.0 - v[2], v[5]), (v[0] - 2.0 - v[3], v[6]), (v[1] - 50.0 * v[4], v[7])]
        },
        equalities: |v| vec![0.02 * v[0] - 10.0 * v[5] - v[6], 2.0 * v[1] - v[5] - v[7]],
        inequalities: none,
    };
    check("sl1", &problem, &[0.0; 8], &[1e-4], StationarityKind::Strong);
}
