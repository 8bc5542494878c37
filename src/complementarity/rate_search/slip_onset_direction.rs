//! Onset of slip at a touching contact in space, in an unknown direction.
//!
//! With `v` the velocity and `Ṙ` the rate of the force on a node that touches without reaction,
//!
//! ```text
//! v_n = 0,    v_t = λ d,  λ >= 0,    Ṙ_t = -μ Ṙ_n d,  Ṙ_n >= 0,    |d| = 1
//! ```
//!
//! For a given angle of `d`, all conditions except `d⊥·Ṙ_t = 0` are linear forms; the rays under these conditions are
//! found like any others, and the angles at which the remaining form vanishes on a ray by scanning the circle and by
//! Chandrupatla's method. The node's own inequalities are tested only at these angles: the range of angles in which
//! they hold may be narrow (a node that approaches at grazing incidence is hardly pressed). With one such node this
//! finds every slip that the scan of the circle resolves. With several, each in turn begins to slip while the others
//! stick or separate; `simultaneous_slips` finds simultaneous onsets.

use crate::algebra::scalar_root::find_root;
use crate::complementarity::rate_search::branch_and_bound::{Effort, Findings, Ray, explore};
use crate::complementarity::rate_search::tolerances::{MISFIT_TOLERANCE, SMALLEST_RAY_COSINE};
use crate::complementarity::rates::rate_problem::{Choice, Entity, RateProblem, own_column};
use crate::resources::budget;
use nalgebra::DVector;
use std::f64::consts::TAU;

/// Number of angles at which the circle is scanned.
pub(crate) const SECTORS: usize = 64;

/// How often a sector is halved in which a ray turns too fast for its neighbour to be told.
const HALVINGS: usize = 10;

/// A ray along which entities begin to slip.
pub(crate) struct Turning {
    pub ray: Ray,
    /// The entities, with the components of their directions along their two tangents.
    pub slips: Vec<(usize, [f64; 2])>,
}

/// Forms of a touching entity, as [normal, first tangent, second tangent].
pub(crate) struct Touch {
    pub entity: usize,
    pub velocities: [usize; 3],
    pub forces: [usize; 3],
    pub friction: f64,
    /// Forms that are nonnegative while the entity slips: gaps of other obstacles of the node.
    pub opening: Vec<usize>,
}

/// The rays along which a touching entity slips while the others take one of their options.
pub(crate) struct Onsets {
    pub slips: Vec<Turning>,
    /// Whether the searches at all angles were complete.
    pub complete: bool,
}

/// The onsets of slip of a touching entity; the searches at all angles together have the effort of one search.
pub(crate) fn slips(problem: &RateProblem, touch: &Touch, effort: Effort<'_>) -> Onsets {
    let mut search = CircleSearch { problem, touch, effort, complete: true, found: Vec::new() };
    let mut before: Option<AtAngle> = None;
    for sector in 0..=SECTORS {
        let angle = TAU * sector as f64 / SECTORS as f64;
        let here = AtAngle { angle, rays: search.rays(angle) };
        if let Some(before) = &before {
            search.between(before, &here, HALVINGS);
        }
        search.keep_exact(&here);
        before = Some(here);
    }
    Onsets { slips: search.found, complete: search.complete }
}

/// The rays at an angle, each with its misfit.
struct AtAngle {
    angle: f64,
    rays: Vec<(Ray, f64)>,
}

/// The searches at the angles of one entity, and the effort that is left for them.
struct CircleSearch<'a> {
    problem: &'a RateProblem,
    touch: &'a Touch,
    effort: Effort<'a>,
    complete: bool,
    found: Vec<Turning>,
}

impl CircleSearch<'_> {
    /// Keeps the rays without misfit.
    fn keep_exact(&mut self, here: &AtAngle) {
        for (ray, _) in here.rays.iter().filter(|(_, misfit)| misfit.abs() <= MISFIT_TOLERANCE) {
            self.touch.keep(&mut self.found, self.problem, ray.clone(), here.angle);
        }
    }

    /// Keeps the slips between two angles. Where a ray turns too fast for its neighbour to be told, the sector is halved, so
    /// often at most.
    fn between(&mut self, before: &AtAngle, here: &AtAngle, halvings: usize) {
        let problem = self.problem;
        let goes_on = |(ray, _): &(Ray, f64)| {
            let same = before.rays.iter().filter(|(other, _)| other.chosen() == ray.chosen());
            let mut cosines = same.map(|(other, _)| cosine(problem, other, ray)).peekable();
            cosines.peek().is_none() || cosines.any(|cosine| cosine > SMALLEST_RAY_COSINE)
        };
        if halvings > 0 && !here.rays.iter().all(goes_on) {
            let angle = 0.5 * (before.angle + here.angle);
            let middle = AtAngle { angle, rays: self.rays(angle) };
            self.keep_exact(&middle);
            self.between(before, &middle, halvings - 1);
            self.between(&middle, here, halvings - 1);
            return;
        }
        for (ray, misfit) in here.rays.iter().filter(|(_, misfit)| misfit.abs() > MISFIT_TOLERANCE) {
            let partner = before.rays.iter().find(|(other, other_misfit)| {
                other.chosen() == ray.chosen()
                    && misfit * other_misfit < 0.0
                    && other_misfit.abs() > MISFIT_TOLERANCE
                    && cosine(problem, other, ray) > SMALLEST_RAY_COSINE
            });
            let Some((other, other_misfit)) = partner else { continue };
            let mut last_ray = other.clone();
            let evaluate = |angle: f64| {
                let near = self.rays(angle).into_iter().filter(|(one, _)| one.chosen() == ray.chosen());
                let (one, value) =
                    near.max_by(|a, b| cosine(problem, &a.0, ray).total_cmp(&cosine(problem, &b.0, ray)))?;
                last_ray = one;
                Some(value)
            };
            if let Some(root) = find_root(evaluate, (before.angle, *other_misfit), (here.angle, *misfit), 1e-15) {
                self.touch.keep(&mut self.found, problem, last_ray, root);
            }
        }
    }

    /// The rays at an angle, each with its misfit; none where no effort is left.
    fn rays(&mut self, angle: f64) -> Vec<(Ray, f64)> {
        if self.effort.most_modes == 0 || self.effort.cancel.is_cancelled() {
            self.complete = false;
            return Vec::new();
        }
        let (rays, findings) = self.touch.rays(self.problem, angle, self.effort);
        self.effort.most_modes = self.effort.most_modes.saturating_sub(findings.examined);
        self.complete &= findings.unexplored == 0;
        rays
    }
}

fn cosine(problem: &RateProblem, first: &Ray, second: &Ray) -> f64 {
    problem.motion.of(&first.weights).dot(&problem.motion.of(&second.weights))
}

impl Touch {
    /// The forms of an entity with the options stick and free; `None` for other entities.
    pub fn of(problem: &RateProblem, entity: usize, friction: f64) -> Option<Self> {
        let [stick, free] = &problem.entities[entity].options[..] else { return None };
        let three = |forms: &[usize]| <[usize; 3]>::try_from(forms).ok();
        Some(Self {
            entity,
            velocities: three(&stick.zero)?,
            forces: three(&free.zero)?,
            friction,
            opening: Vec::new(),
        })
    }

    /// The rays for one angle, each with the deviation of the traction from the direction, relative to the force rates;
    /// and what the search for them found otherwise.
    fn rays(&self, problem: &RateProblem, angle: f64, effort: Effort<'_>) -> (Vec<(Ray, f64)>, Findings) {
        let copied = problem.forms.len() + problem.reactions.len();
        let _held = budget::take::<f64>(copied);
        budget::spend(copied);
        let (sine, cosine) = angle.sin_cos();
        let row = |forms: [usize; 3], parts: [f64; 3]| {
            (0..3).fold(DVector::zeros(problem.weights()), |sum, k| {
                sum + problem.forms.row(forms[k]).transpose() * parts[k]
            })
        };
        let along = row(self.velocities, [0.0, cosine, sine]);
        let across = row(self.velocities, [0.0, -sine, cosine]);
        let cone = row(self.forces, [self.friction, cosine, sine]);
        let misfit = row(self.forces, [0.0, -sine, cosine]);
        let base = problem.forms.nrows();
        let mut forms = problem.forms.clone().resize_vertically(base + 3, 0.0);
        for (place, values) in [along, across, cone].iter().enumerate() {
            forms.set_row(base + place, &values.transpose());
        }
        let mut is_force = problem.is_force.clone();
        is_force.extend([false, false, true]);
        let mut entities = problem.entities.clone();
        let slip =
            Choice { zero: vec![self.velocities[0], base + 1, base + 2], nonnegative: Vec::new(), implied: Vec::new() };
        entities[self.entity] = Entity { options: vec![slip], touching: None };
        let turned = RateProblem {
            forms,
            is_force,
            entities,
            load: problem.load.clone(),
            sizes: problem.sizes.clone(),
            motion: problem.motion.clone(),
            reactions: problem.reactions.clone(),
        };
        let mut findings = explore(&turned, Vec::new, effort);
        let with_misfit = |ray: Ray| {
            let size = (&problem.reactions * &ray.weights).amax().max(f64::MIN_POSITIVE);
            let misfit = misfit.dot(&ray.weights) / size;
            (ray, misfit)
        };
        (std::mem::take(&mut findings.rays).into_iter().map(with_misfit).collect(), findings)
    }

    /// Whether the node moves along the direction (otherwise it sticks) and is pressed (otherwise it is free).
    fn is_slip(&self, problem: &RateProblem, ray: &Ray, angle: f64) -> bool {
        let value = |form: usize| problem.forms.row(form).transpose().dot(&ray.weights);
        let size = (&problem.reactions * &ray.weights).amax().max(f64::MIN_POSITIVE);
        let opens = self.opening.iter().all(|gap| value(*gap) >= -MISFIT_TOLERANCE);
        self.motion(problem, &ray.weights, angle) > MISFIT_TOLERANCE
            && value(self.forces[0]) > MISFIT_TOLERANCE * size
            && opens
    }

    /// A dimensionless measure of the node's motion along a direction: its velocity, or, for a slow node on stiff
    /// supports, the change of its own forces by this velocity.
    pub(crate) fn motion(&self, problem: &RateProblem, weights: &DVector<f64>, angle: f64) -> f64 {
        let value = |form: usize| problem.forms.row(form).transpose().dot(weights);
        let parts = [angle.cos(), angle.sin()];
        let along = value(self.velocities[1]) * parts[0] + value(self.velocities[2]) * parts[1];
        let columns = [1, 2].map(|tangent| own_column(problem, self.velocities[tangent]));
        let [Some(first), Some(second)] = columns else { return along };
        let largest = |values: [f64; 3]| values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let stiffness = largest(
            self.forces
                .map(|force| problem.forms[(force, first)] * parts[0] + problem.forms[(force, second)] * parts[1]),
        );
        let forces = largest(self.forces.map(value)).max(f64::MIN_POSITIVE);
        along * (stiffness / forces).max(1.0)
    }

    fn keep(&self, found: &mut Vec<Turning>, problem: &RateProblem, ray: Ray, angle: f64) {
        let known = |one: &Turning| one.ray.chosen() == ray.chosen() && cosine(problem, &one.ray, &ray) > 1.0 - 1e-12;
        if self.is_slip(problem, &ray, angle) && !found.iter().any(known) {
            found.push(Turning { ray, slips: vec![(self.entity, [angle.cos(), angle.sin()])] });
        }
    }
}
