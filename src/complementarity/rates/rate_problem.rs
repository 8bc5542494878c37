//! Data of a rate problem.

use crate::complementarity::rates::tolerances::{RELATIVE_ROUND_OFF, SMALL_VELOCITY, SMALLEST_VELOCITY_SCALE};
use crate::resources::budget;
use nalgebra::{DMatrix, DVector, RowDVector};
use std::fmt::Debug;
use std::sync::Arc;

/// Number of columns of a product that are formed at a time.
const TOGETHER: usize = 8;

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

/// One option of an entity.
#[derive(Debug, Clone, Default)]
pub struct Choice {
    /// Forms that are zero.
    pub zero: Vec<usize>,
    /// Forms that are nonnegative.
    pub nonnegative: Vec<Signed>,
    /// Forms that are nonnegative as a consequence of the others. They decide nothing; but inequalities common to all
    /// options of an entity hold before the entity is decided, and the more of these there are, the sooner a branch is
    /// found to be empty.
    pub implied: Vec<Signed>,
}

/// An entity, such as a contact, that takes exactly one of its options.
#[derive(Debug, Clone)]
pub struct Entity {
    pub options: Vec<Choice>,
    /// Present for a contact that touches without reaction, with Coulomb friction in the plane.
    pub touching: Option<Touching>,
}

/// The forms of a contact that touches without reaction: `ġ`, `v_t`, `ṙ_n`, `ṙ_t`, `μ ṙ_n + ṙ_t` and `μ ṙ_n - ṙ_t`.
#[derive(Debug, Clone, Copy)]
pub struct Touching {
    pub gap: usize,
    pub along: usize,
    pub pressing: usize,
    pub traction: usize,
    pub cone: [usize; 2],
}

/// The motion that a vector of weights stands for.
pub trait MotionOfWeights: Debug + Send + Sync {
    /// Displacement rates and the load rate, in any fixed order; not finite where they cannot be found.
    fn of(&self, weights: &DVector<f64>) -> DVector<f64>;
}

/// The motion of unit weight in each column.
impl MotionOfWeights for DMatrix<f64> {
    fn of(&self, weights: &DVector<f64>) -> DVector<f64> {
        budget::spend(self.len());
        self * weights
    }
}

/// A velocity that is a weight of its own, and the force that resists it: the forms of both, and the weight.
struct ResistedVelocity {
    velocity: usize,
    weight: usize,
    force: usize,
}

/// The scale of velocities, of unit arc length, where those that matter are about `natural`: 1 unless they are small.
pub(crate) fn velocity_scale(natural: f64) -> f64 {
    // A quotient of no force and no stiffness tells nothing.
    if natural.is_nan() { 1.0 } else { (natural / SMALL_VELOCITY).clamp(SMALLEST_VELOCITY_SCALE, 1.0) }
}

/// A rate problem: forms over the weights, and the entities.
#[derive(Debug, Clone)]
pub struct RateProblem {
    /// One form per row, one weight per column.
    pub forms: DMatrix<f64>,
    /// Whether a form is a rate of force; the others are velocities.
    pub is_force: Vec<bool>,
    pub entities: Vec<Entity>,
    /// The load rate at unit weight.
    pub load: RowDVector<f64>,
    /// The magnitude of the motion at unit weight, or an estimate.
    pub sizes: Vec<f64>,
    /// Gives the arc length of a ray.
    pub motion: Arc<dyn MotionOfWeights>,
    /// Rates of all reactions: their magnitude is the reference by which a rate of force counts as zero.
    pub reactions: DMatrix<f64>,
}

impl RateProblem {
    /// Number of weights.
    pub fn weights(&self) -> usize {
        self.forms.ncols()
    }

    fn resisted_velocities(&self) -> impl Iterator<Item = ResistedVelocity> {
        let pairs = self.entities.iter().filter_map(Entity::conjugates).flatten();
        pairs.filter_map(|[force, velocity]| {
            let is_resisted = self.is_force[force.form] && !self.is_force[velocity.form];
            let weight = own_column(self, velocity.form).filter(|_| is_resisted)?;
            Some(ResistedVelocity { velocity: velocity.form, weight, force: force.form })
        })
    }

    /// The scale of each form that is a velocity, where rates of force are at most `largest`: the velocity of a stiff
    /// contact is compared with the one that changes its force by as much.
    pub(crate) fn velocity_scales(&self, largest: f64) -> Vec<f64> {
        let mut scales = vec![1.0; self.forms.nrows()];
        for one in self.resisted_velocities() {
            scales[one.velocity] = velocity_scale(largest / self.forms[(one.force, one.weight)].abs());
        }
        scales
    }

    /// Reduces the size of the last weight, along which no contact of the others moves, to that of the velocities by which
    /// stiff contacts resist it.
    pub(crate) fn rescale_last_weight(&mut self) {
        let last = self.weights() - 1;
        let comparable = self.resisted_velocities().map(|one| {
            let [own, other] = [last, one.weight].map(|weight| self.forms[(one.force, weight)].abs());
            own * self.sizes[one.weight] / other
        });
        let largest = comparable.fold(0.0, f64::max);
        if largest > 0.0 {
            self.sizes[last] *= velocity_scale(largest / self.sizes[last]);
        }
    }

    /// The strength of coupling between entities: products of the magnitudes of their forms' coefficients, with forms
    /// of unit maximum norm.
    pub(crate) fn coupling(&self) -> DMatrix<f64> {
        let (count, weights) = (self.entities.len(), self.weights());
        let _held = budget::take::<f64>(2 * count * weights + count * count);
        let mut footprints: DMatrix<f64> = DMatrix::zeros(count, weights);
        for (row, entity) in self.entities.iter().enumerate() {
            for form in entity.options.iter().flat_map(|choice| &choice.zero) {
                budget::spend(2 * weights);
                let values = self.forms.row(*form);
                let size = values.amax().max(f64::MIN_POSITIVE);
                // The last weight, that of the held structure itself, couples all entities.
                for column in 0..weights.saturating_sub(1) {
                    footprints[(row, column)] += values[column].abs() / size;
                }
            }
        }
        let transposed = footprints.transpose();
        let mut coupling = DMatrix::zeros(count, count);
        for first in (0..count).step_by(TOGETHER) {
            let columns = TOGETHER.min(count - first);
            budget::spend(count * weights * columns);
            footprints.mul_to(&transposed.columns(first, columns), &mut coupling.columns_mut(first, columns));
        }
        coupling
    }

    /// Number of combinations of options, saturating.
    pub fn combinations(&self) -> u64 {
        self.entities.iter().fold(1, |total: u64, entity| total.saturating_mul(entity.options.len() as u64))
    }
}

/// The weight equal to a velocity form; `None` where there is no such weight.
pub fn own_column(problem: &RateProblem, form: usize) -> Option<usize> {
    let row = problem.forms.row(form);
    // The coefficient is 1 up to the rounding of a frame that is not aligned with the axes.
    let mut filled = (0..row.len()).filter(|column| row[*column].abs() > RELATIVE_ROUND_OFF);
    match (filled.next(), filled.next()) {
        (Some(column), None) if (row[column] - 1.0).abs() < RELATIVE_ROUND_OFF => Some(column),
        _ => None,
    }
}

impl Entity {
    /// The complementary pair `0 <= a ⊥ b >= 0`; `b` is zero in the first option.
    pub fn complementary(a: usize, b: usize) -> Self {
        let option = |zero: usize, other: usize| Choice {
            zero: vec![zero],
            nonnegative: vec![Signed::plus(other)],
            implied: vec![],
        };
        Self { options: vec![option(b, a), option(a, b)], touching: None }
    }

    /// A touching contact, with the options stick, slip forward, slip backward and free.
    pub fn touching(forms: Touching) -> Self {
        let plus = Signed::plus;
        let both = |form: usize| [plus(form), Signed::minus(form)];
        let Touching { gap, along, pressing, traction, cone: [forward, backward] } = forms;
        let stick = Choice {
            zero: vec![gap, along],
            nonnegative: vec![plus(forward), plus(backward)],
            implied: vec![plus(pressing)],
        };
        let slip = |along: Signed, cone: usize, other: usize| Choice {
            zero: vec![gap, cone],
            nonnegative: vec![along, plus(pressing)],
            implied: vec![plus(other)],
        };
        let free = Choice {
            zero: vec![pressing, traction],
            nonnegative: vec![plus(gap)],
            implied: [both(forward), both(backward)].concat(),
        };
        let options =
            vec![stick, slip(plus(along), forward, backward), slip(Signed::minus(along), backward, forward), free];
        Self { options, touching: Some(forms) }
    }

    /// The work-conjugate pairs `(force, velocity)` of the entity; `None` where the entity is of neither kind above.
    pub(crate) fn conjugates(&self) -> Option<Vec<[Signed; 2]>> {
        match self.touching {
            Some(forms) => Some(vec![
                [Signed::plus(forms.pressing), Signed::plus(forms.gap)],
                [Signed::plus(forms.traction), Signed::plus(forms.along)],
            ]),
            None => self.pair().map(|pair| vec![pair]),
        }
    }

    /// The complementary pair `0 <= a ⊥ b >= 0`, if the entity is such a pair: `b` vanishes in the first option (held),
    /// `a` in the second.
    pub fn pair(&self) -> Option<[Signed; 2]> {
        let [first, second] = &self.options[..] else { return None };
        let ([b], [a]) = (&first.zero[..], &second.zero[..]) else { return None };
        let ([a_sign], [b_sign]) = (&first.nonnegative[..], &second.nonnegative[..]) else { return None };
        (a_sign.form == *a && b_sign.form == *b).then_some([*a_sign, *b_sign])
    }
}

impl Choice {
    /// Whether the option makes a signed form nonnegative.
    pub fn gives(&self, signed: Signed) -> bool {
        self.zero.contains(&signed.form) || self.nonnegative.contains(&signed) || self.implied.contains(&signed)
    }
}

impl Entity {
    /// The signed forms that are nonnegative under every option.
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
