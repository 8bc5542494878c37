//! Data of a rate problem.

use nalgebra::DMatrix;

/// A form with a sign: `sign F_form w`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signed {
    pub form: usize,
    pub sign: f64,
}

impl Signed {
    pub fn plus(form: usize) -> Self {
        Self { form, sign: 1.0 }
    }

    pub fn minus(form: usize) -> Self {
        Self { form, sign: -1.0 }
    }
}

/// One way in which an entity may go on.
#[derive(Debug, Clone, Default)]
pub struct Choice {
    /// Forms that are zero.
    pub zero: Vec<usize>,
    /// Forms that are not negative.
    pub nonnegative: Vec<Signed>,
    /// Forms that are not negative as a consequence of the others. They decide nothing; what all options of an entity
    /// have in common holds before the entity is decided, and the more that is, the sooner a branch is seen to be empty.
    pub implied: Vec<Signed>,
}

/// Something that takes exactly one of its options.
#[derive(Debug, Clone)]
pub struct Entity {
    pub options: Vec<Choice>,
}

/// Forms over the weights, and the entities.
#[derive(Debug, Clone)]
pub struct RateProblem {
    /// One form a row, one weight a column.
    pub forms: DMatrix<f64>,
    /// Whether a form is a rate of force; the others are velocities.
    pub is_force: Vec<bool>,
    pub entities: Vec<Entity>,
    /// Displacement rates and, in the last row, the load rate; one weight a column. Gives the arc length of a ray.
    pub motion: DMatrix<f64>,
    /// Rates of all reactions: the size against which a rate of force is zero.
    pub reactions: DMatrix<f64>,
}

impl RateProblem {
    /// Number of weights.
    pub fn weights(&self) -> usize {
        self.forms.ncols()
    }

    /// Number of combinations of options, saturating.
    pub fn combinations(&self) -> u64 {
        self.entities.iter().fold(1, |total: u64, entity| total.saturating_mul(entity.options.len() as u64))
    }
}

impl Entity {
    /// `0 <= a ⊥ b >= 0`; `b` is zero in the first option.
    pub fn complementary(a: usize, b: usize) -> Self {
        let option = |zero: usize, other: usize| Choice {
            zero: vec![zero],
            nonnegative: vec![Signed::plus(other)],
            implied: vec![],
        };
        Self { options: vec![option(b, a), option(a, b)] }
    }

    /// A complementary pair `0 <= a ⊥ b >= 0`, if that is what the entity is: `b` vanishes in the first option (held),
    /// `a` in the second.
    pub fn pair(&self) -> Option<[Signed; 2]> {
        let [first, second] = &self.options[..] else { return None };
        let ([b], [a]) = (&first.zero[..], &second.zero[..]) else { return None };
        let ([a_sign], [b_sign]) = (&first.nonnegative[..], &second.nonnegative[..]) else { return None };
        (a_sign.form == *a && b_sign.form == *b).then_some([*a_sign, *b_sign])
    }
}

impl Choice {
    /// Whether the option makes a signed form not negative.
    pub fn gives(&self, signed: Signed) -> bool {
        self.zero.contains(&signed.form) || self.nonnegative.contains(&signed) || self.implied.contains(&signed)
    }
}

impl Entity {
    /// The signed forms that are not negative whatever the option.
    pub fn common(&self) -> Vec<Signed> {
        let mut common = Vec::new();
        for choice in &self.options {
            for signed in choice
                .zero
                .iter()
                .flat_map(|form| [Signed::plus(*form), Signed::minus(*form)])
                .chain(choice.nonnegative.iter().copied().chain(choice.implied.iter().copied()))
            {
                if !common.contains(&signed) && self.options.iter().all(|other| other.gives(signed)) {
                    common.push(signed);
                }
            }
        }
        common
    }
}
