//! The treatment of cone pairs in the smooth program.
//!
//! ```text
//! Product(ε):    a ∈ K,   b ∈ K,   ε - a·b >= 0                          the regularisation, ε falling to 0
//! FirstZero:     a = 0,   b ∈ K                                          a branch
//! SecondZero:    a ∈ K,   b = 0                                          another
//! AlongFirst:    a_0 = |a_t|,   b_t + b_0 a_t/|a_t| = 0,   b_0 >= 0      the third: both on the boundary, opposed
//! AlongSecond:   b_0 = |b_t|,   a_t + a_0 b_t/|b_t| = 0,   a_0 >= 0      the same, where a_t may vanish and b_t may not
//! ```
//!
//! Membership of the cone is a convex constraint on the members and enters the quadratic program as a second-order
//! cone; only the product is relaxed. Each branch is a smooth manifold of the correct dimension, even where the member
//! that does not define its direction vanishes, so a branch program satisfies the usual constraint qualifications at a
//! biactive pair.
//!
//! Sources: H. Kato and M. Fukushima, *An SQP-type algorithm for nonlinear second-order cone programs*, Optim. Lett. 1
//! (2007), doi:10.1007/s11590-006-0009-2 (unrelaxed cones in the quadratic program); Y. Kanno and J. A. C. Martins, J.
//! Optim. Theory Appl. 131 (2006), doi:10.1007/s10957-006-9137-4 (friction as such a pair).

use nalgebra::DVector;

use crate::complementarity::mpec::program::cone;
use crate::complementarity::mpec::program::evaluation::ConeMembers;

/// The treatment of one cone pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ConeTreatment {
    /// Both members in the cone, their product at most this bound.
    Product(f64),
    FirstZero,
    SecondZero,
    AlongFirst,
    AlongSecond,
}

/// One of a cone pair's members.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConeMember {
    First,
    Second,
}

/// The constraint that a row imposes on its pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConeRow {
    /// A component of a member vanishes.
    Vanishes(ConeMember, usize),
    /// The leading member lies on the boundary.
    Boundary(ConeMember),
    /// A tangential component of the other member is opposed to the leading member.
    Opposed(ConeMember, usize),
    /// The other member's first component is nonnegative.
    Sign(ConeMember),
    /// `ε - a·b`
    Product,
}

impl ConeTreatment {
    /// The branch nearest to a pair of members, by the case of the projection of their difference on the cone.
    pub fn nearest(a: &[f64], b: &[f64]) -> Self {
        let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        let size = cone::tangential_size(&difference);
        let first = difference.first().copied().unwrap_or(0.0);
        if first >= size && cone::slack(a) > 0.0 {
            Self::SecondZero
        } else if first <= -size {
            Self::FirstZero
        } else {
            Self::along(a, b)
        }
    }

    /// The branch on the boundary, along the member with the better defined direction.
    pub fn along(a: &[f64], b: &[f64]) -> Self {
        if cone::tangential_size(a) >= cone::tangential_size(b) { Self::AlongFirst } else { Self::AlongSecond }
    }

    /// The branches other than this one, for a pair with these members.
    pub fn others(self, a: &[f64], b: &[f64]) -> Vec<Self> {
        let along = Self::along(a, b);
        match self {
            Self::FirstZero => vec![Self::SecondZero, along],
            Self::SecondZero => vec![Self::FirstZero, along],
            Self::Product(_) | Self::AlongFirst | Self::AlongSecond => vec![Self::FirstZero, Self::SecondZero],
        }
    }

    /// Rows that have to vanish.
    pub fn equalities(self, size: usize) -> Vec<ConeRow> {
        let along =
            |lead| std::iter::once(ConeRow::Boundary(lead)).chain((1..size).map(move |c| ConeRow::Opposed(lead, c)));
        match self {
            Self::Product(_) => Vec::new(),
            Self::FirstZero => (0..size).map(|c| ConeRow::Vanishes(ConeMember::First, c)).collect(),
            Self::SecondZero => (0..size).map(|c| ConeRow::Vanishes(ConeMember::Second, c)).collect(),
            Self::AlongFirst => along(ConeMember::First).collect(),
            Self::AlongSecond => along(ConeMember::Second).collect(),
        }
    }

    /// Rows that must not be negative.
    pub fn inequality(self) -> Option<ConeRow> {
        match self {
            Self::Product(_) => Some(ConeRow::Product),
            Self::FirstZero | Self::SecondZero => None,
            Self::AlongFirst => Some(ConeRow::Sign(ConeMember::First)),
            Self::AlongSecond => Some(ConeRow::Sign(ConeMember::Second)),
        }
    }

    /// Members that have to lie in the cone.
    pub fn in_cone(self) -> &'static [ConeMember] {
        match self {
            Self::Product(_) => &[ConeMember::First, ConeMember::Second],
            Self::FirstZero => &[ConeMember::Second],
            Self::SecondZero => &[ConeMember::First],
            Self::AlongFirst | Self::AlongSecond => &[],
        }
    }

    /// Value of a row.
    pub fn value(self, at: &ConeMembers, pair: usize, row: ConeRow) -> f64 {
        let member = |member| match member {
            ConeMember::First => at.first_of(pair),
            ConeMember::Second => at.second_of(pair),
        };
        match row {
            ConeRow::Vanishes(which, c) => member(which)[c],
            ConeRow::Boundary(lead) => cone::slack(member(lead)),
            ConeRow::Opposed(lead, c) => {
                let other = member(lead.other());
                other[c] + other[0] * cone::direction(member(lead))[c]
            }
            ConeRow::Sign(lead) => member(lead.other())[0],
            ConeRow::Product => match self {
                Self::Product(relaxation) => relaxation - cone::product(at.first_of(pair), at.second_of(pair)),
                Self::FirstZero | Self::SecondZero | Self::AlongFirst | Self::AlongSecond => 0.0,
            },
        }
    }

    /// Derivatives of a row with respect to the first and to the second member.
    pub fn derivatives(at: &ConeMembers, pair: usize, row: ConeRow) -> (DVector<f64>, DVector<f64>) {
        let (a, b) = (at.first_of(pair), at.second_of(pair));
        let size = a.len();
        let unit = |c: usize| DVector::from_fn(size, |k, _| f64::from(u8::from(k == c)));
        // With respect to the leading member, then to the other member.
        let (lead, by_lead, by_other) = match row {
            ConeRow::Product => return (-DVector::from_column_slice(b), -DVector::from_column_slice(a)),
            ConeRow::Vanishes(which, c) => (which, unit(c), DVector::zeros(size)),
            ConeRow::Boundary(lead) => {
                let leading = if lead == ConeMember::First { a } else { b };
                (lead, unit(0) - cone::direction(leading), DVector::zeros(size))
            }
            ConeRow::Opposed(lead, c) => {
                let (leading, other) = if lead == ConeMember::First { (a, b) } else { (b, a) };
                let (e, length) = (cone::direction(leading), cone::tangential_size(leading));
                let turning = if length >= f64::MIN_POSITIVE {
                    let mut across = unit(c) - &e * e[c];
                    across *= other[0] / length;
                    across
                } else {
                    DVector::zeros(size)
                };
                (lead, turning, unit(c) + unit(0) * e[c])
            }
            ConeRow::Sign(lead) => (lead, DVector::zeros(size), unit(0)),
        };
        if lead == ConeMember::First { (by_lead, by_other) } else { (by_other, by_lead) }
    }
}

impl ConeMember {
    fn other(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complementarity::mpec::program::evaluation::ProgramEvaluation;
    use crate::complementarity::mpec::program::problem::Problem;
    use crate::complementarity::mpec::program::sparse_rows::SparseRows;

    /// Six variables, the two members of one pair.
    struct Members;

    impl Problem for Members {
        fn variables(&self) -> usize {
            6
        }
        fn equalities(&self) -> usize {
            0
        }
        fn inequalities(&self) -> usize {
            0
        }
        fn pairs(&self) -> usize {
            0
        }
        fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
            (DVector::repeat(6, f64::NEG_INFINITY), DVector::repeat(6, f64::INFINITY))
        }
        fn objective(&self, _x: &DVector<f64>) -> f64 {
            0.0
        }
        fn objective_gradient(&self, _x: &DVector<f64>, _gradient: &mut DVector<f64>) {}
        fn pair_values(&self, _x: &DVector<f64>, _first: &mut DVector<f64>, _second: &mut DVector<f64>) {}
        fn pair_jacobians(&self, _x: &DVector<f64>, _first: &mut SparseRows, _second: &mut SparseRows) {}
        fn cone_sizes(&self) -> Vec<usize> {
            vec![3]
        }
        fn cone_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
            first.copy_from(&x.rows(0, 3));
            second.copy_from(&x.rows(3, 3));
        }
    }

    #[test]
    fn derivatives_of_the_rows_are_those_of_differences() {
        let x = DVector::from_column_slice(&[0.7, 0.4, -0.3, 0.9, -0.2, 0.6]);
        let at = |x: &DVector<f64>| {
            let mut at = ProgramEvaluation::new(&Members);
            at.update_values(&Members, x).expect("finite");
            at.cones
        };
        for treatment in [
            ConeTreatment::Product(0.1),
            ConeTreatment::FirstZero,
            ConeTreatment::SecondZero,
            ConeTreatment::AlongFirst,
            ConeTreatment::AlongSecond,
        ] {
            for row in treatment.equalities(3).into_iter().chain(treatment.inequality()) {
                let (by_first, by_second) = ConeTreatment::derivatives(&at(&x), 0, row);
                for j in 0..6 {
                    let moved = |h: f64| {
                        let mut moved = x.clone();
                        moved[j] += h;
                        treatment.value(&at(&moved), 0, row)
                    };
                    let difference = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                    let exact = if j < 3 { by_first[j] } else { by_second[j - 3] };
                    assert!((difference - exact).abs() < 1e-9, "{treatment:?} {row:?} {j}: {difference} {exact}");
                }
            }
        }
    }

    #[test]
    fn the_nearest_branch_is_the_one_that_a_complementary_pair_lies_in() {
        let nearest = |a: [f64; 3], b: [f64; 3]| ConeTreatment::nearest(&a, &b);
        assert_eq!(nearest([0.0; 3], [1.0, 0.5, 0.0]), ConeTreatment::FirstZero);
        assert_eq!(nearest([1.0, 0.5, 0.0], [0.0; 3]), ConeTreatment::SecondZero);
        assert_eq!(nearest([1.0, 0.6, 0.8], [0.5, -0.3, -0.4]), ConeTreatment::AlongFirst);
        assert_eq!(nearest([0.5, 0.3, 0.4], [1.0, -0.6, -0.8]), ConeTreatment::AlongSecond);
    }
}
