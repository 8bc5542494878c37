//! A node in contact with several obstacles at once, free in space or guided by supports.
//!
//! Equilibrium determines only the sum `R` of the obstacles' forces. Let `V = {v : n_k·v >= 0}` be the motions that the
//! obstacles admit, `v₀` the projection of `-R` on `V`, and let the sums be over the obstacles along which the motion
//! `v₀` slides:
//!
//! ```text
//! R = Σ N_i n_i - v₀,     N_i >= 0,     N_i n_i·v₀ = 0
//! ```
//!
//! (J. J. Moreau, C. R. Acad. Sci. 255 (1962) 238). Without friction the node moves along `v₀`. With friction the node
//! slides in this direction, along one obstacle or along the edge of two, where `R = Σ N_i (n_i - μ_i d)`, `d` along
//! `v₀`. The node is therefore held as long as
//!
//! ```text
//! |v₀| <= Σ μ_i N_i
//! ```
//!
//! At this bound the node slides, although obstacles between which it is wedged could hold a larger force: such a force
//! requires wedging reactions, which the loading has not produced. A node that arrives from one obstacle with a force
//! beyond this bound, and within the sum of the friction cones, is held, since no slide has such a force: where the
//! force returns to the bound, the node may slide again, and where the force leaves the sum, no motion is compatible
//! with it. Where the sum of the cones is all of space, the node is jammed and does not move, as in the plane. The
//! supported components of the node are left out of `R` and of the normals.
//!
//! `cone_sum` treats the sum of the cones, `sliding` the node while it slides, and `rate_options::spatial` the options
//! of the node in the rate problem.

pub(crate) mod cone_sum;
pub(crate) mod sliding;
pub(crate) mod tolerances;

use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::multi_contact::spatial::tolerances::{
    BOUND_TOLERANCE, CONE_TOLERANCE, INDEPENDENCE_SINE, MEETING_FORCE_ROUNDING, NEGLIGIBLE_COMPONENT,
    PERPENDICULAR_COSINE,
};
use crate::mechanics::problem::node_contact_forces::free_directions;
pub use sliding::{Edge, beside, taken_over};

use crate::mechanics::contact::Frame;
use crate::mechanics::contact::least_norm_projection::{Cone, least_reactions};
use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled, size, unit};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces::{is_driven, reaction_in_space, total_force};
use crate::mechanics::problem::state::{Rate, State};
use crate::resources::budget;

/// The closed obstacles of a node.
pub struct ContactGroup {
    pub contacts: Vec<usize>,
    pub frames: Vec<Frame>,
    pub frictions: Vec<CoulombFriction>,
    /// The normals, projected on the free directions of the node.
    normals: Vec<Vector>,
    /// Orthonormal directions in which the node is free.
    pub free: Vec<Vector>,
    /// Whether the current stage drives the node against the obstacles, or the obstacles against each other.
    pub is_driven: bool,
}

/// A slide of the node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slide {
    /// Along the edge of two obstacles; `places` are their indices in the [`ContactGroup`].
    Edge { places: [usize; 2], direction: Vector },
    /// Along one obstacle, the others opening.
    Face { place: usize },
}

/// The action of a force on the node along a slide.
#[derive(Debug, Clone, Copy)]
pub struct Drive {
    pub direction: Vector,
    /// Normal reactions of the obstacles along which the node slides; the second is 0 for a face.
    pub normals: [f64; 2],
    /// The driving force less the friction.
    pub excess: f64,
}

impl ContactGroup {
    pub fn new(loading: Loading<'_>, contacts: &[usize], state: &State) -> Self {
        let free = free_directions(loading, contacts[0]);
        let frames: Vec<Frame> = contacts.iter().map(|contact| loading.frame(*contact, state)).collect();
        let friction = |contact: &usize| {
            let data = &loading.contacts[*contact];
            if data.tangents() > 0 { data.friction } else { CoulombFriction::SMOOTH }
        };
        let frictions = contacts.iter().map(friction).collect();
        let normals = frames.iter().map(|frame| along(&free, &frame.normal)).collect();
        let is_driven = is_driven(loading, contacts);
        Self { contacts: contacts.to_vec(), frames, frictions, normals, free, is_driven }
    }

    /// The sum of the forces of the obstacles, projected on the free directions of the node.
    pub fn force(&self, loading: Loading<'_>, state: &State) -> Vector {
        along(&self.free, &total_force(loading, self.contacts.iter().copied(), state))
    }

    /// A vector, projected on the free directions of the node.
    pub fn free_part(&self, vector: &Vector) -> Vector {
        along(&self.free, vector)
    }

    /// Whether every slide determines the reactions: no two normals are parallel, and no edge with friction is shared
    /// by three obstacles.
    pub fn is_determinate_when_sliding(&self) -> bool {
        if self.is_driven {
            return self.free.len() == 1;
        }
        if self.free.len() < 2 {
            return true;
        }
        self.pairs().all(|[first, second]| {
            let across = cross(&unit(&self.normals[first]), &unit(&self.normals[second]));
            let edge = unit(&across);
            let on_edge = |place: &usize| dot(&unit(&self.normals[*place]), &edge).abs() <= INDEPENDENCE_SINE;
            let of_edge = || (0..self.contacts.len()).filter(on_edge);
            let rough = of_edge().any(|place| self.frictions[place].is_rough());
            size(&across) > INDEPENDENCE_SINE && (self.free.len() < 3 || !rough || of_edge().count() == 2)
        })
    }

    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let count = self.contacts.len();
        let all = (0..count).flat_map(move |first| (first + 1..count).map(move |second| [first, second]));
        // The user of a pair visits all obstacles of the node.
        all.inspect(move |_| budget::spend(count))
    }

    /// All slides; along edges only those that lead away from the other obstacles.
    pub fn slides(&self) -> Vec<Slide> {
        let mut slides = Vec::new();
        if self.free.len() == 3 {
            for places in self.pairs() {
                let edge = unit(&cross(&self.normals[places[0]], &self.normals[places[1]]));
                for direction in [edge, scaled(&edge, -1.0)] {
                    if self.opens(&direction, &places) {
                        slides.push(Slide::Edge { places, direction });
                    }
                }
            }
        }
        if self.free.len() > 1 {
            slides.extend((0..self.contacts.len()).map(|place| Slide::Face { place }));
        }
        slides
    }

    /// Whether a direction leads into no obstacle, those at the indices `but` excepted.
    pub fn opens(&self, direction: &Vector, but: &[usize]) -> bool {
        (0..self.contacts.len())
            .all(|place| but.contains(&place) || dot(&self.frames[place].normal, direction) >= -PERPENDICULAR_COSINE)
    }

    /// The linear forms of a force that give the two normal reactions at an edge.
    pub fn edge_forms(&self, places: [usize; 2], direction: &Vector) -> [Vector; 2] {
        let [first, second] = places.map(|place| self.normals[place]);
        let of = |normal: &Vector, other: &Vector| {
            let across = cross(other, direction);
            scaled(&across, 1.0 / dot(normal, &across))
        };
        [of(&first, &second), of(&second, &first)]
    }

    /// The linear form of a force that gives the driving force along an edge less the friction.
    pub fn edge_drive(&self, places: [usize; 2], direction: &Vector) -> Vector {
        let forms = self.edge_forms(places, direction);
        let [first, second] = places.map(|place| self.frictions[place].coefficient);
        let drag = add(&scaled(&forms[0], first), second, &forms[1]);
        scaled(&add(direction, 1.0, &drag), -1.0)
    }

    /// The linear form that gives the normal reaction of one obstacle alone.
    pub fn face_form(&self, place: usize) -> Vector {
        let normal = &self.normals[place];
        scaled(normal, 1.0 / dot(normal, normal))
    }

    /// The action of a force along a slide; `None` where the force does not press the node against the obstacles of the
    /// slide, or drives it into another.
    pub fn drive(&self, slide: &Slide, force: &Vector) -> Option<Drive> {
        let zero = NEGLIGIBLE_COMPONENT * size(force);
        match *slide {
            Slide::Edge { places, direction } => {
                let normals = self.edge_forms(places, &direction).map(|form| dot(&form, force));
                let excess = dot(&self.edge_drive(places, &direction), force);
                normals.iter().all(|normal| *normal >= -zero).then_some(Drive { direction, normals, excess })
            }
            Slide::Face { place } => {
                let normal = dot(&self.face_form(place), force);
                let across = add(force, -normal, &self.normals[place]);
                let driving = size(&across);
                let excess = driving - self.frictions[place].bound(normal);
                let direction = if driving > zero { scaled(&across, -1.0 / driving) } else { [0.0; 3] };
                let fits = normal >= -zero && self.opens(&direction, &[place]);
                fits.then_some(Drive { direction, normals: [normal, 0.0], excess })
            }
        }
    }

    /// The margin of a force against sliding or leaving; negative where the node would slide or leave.
    pub fn margin(&self, force: &Vector) -> f64 {
        if cone_sum::is_jammed(self) {
            return f64::INFINITY;
        }
        if self.opens(&scaled(&unit(force), -1.0), &[]) {
            return -size(force);
        }
        let drives = self.slides().into_iter().filter_map(|slide| self.drive(&slide, force));
        drives.map(|drive| -drive.excess).fold(size(force), f64::min)
    }

    /// The derivative of the margin along a rate of the force.
    pub fn margin_slope(&self, force: &Vector, rate: &Vector) -> f64 {
        if cone_sum::is_jammed(self) {
            return 0.0;
        }
        if self.opens(&scaled(&unit(force), -1.0), &[]) {
            return -dot(&unit(force), rate);
        }
        let drives = self.slides().into_iter().filter_map(|slide| Some((slide, self.drive(&slide, force)?)));
        let nearest = drives.max_by(|a, b| a.1.excess.total_cmp(&b.1.excess));
        match nearest {
            Some((_, drive)) if -drive.excess > size(force) => dot(&unit(force), rate),
            Some((Slide::Edge { places, direction }, _)) => -dot(&self.edge_drive(places, &direction), rate),
            Some((Slide::Face { place }, drive)) => {
                dot(&self.frictions[place].slack_form(&self.face_form(place), &drive.direction), rate)
            }
            None => dot(&unit(force), rate),
        }
    }

    /// The rate of the total force, projected on the free directions of the node.
    pub fn force_rate(&self, loading: Loading<'_>, state: &State, rate: &Rate) -> Vector {
        let parts = self.contacts.iter().map(|contact| reaction_in_space(loading, *contact, (state, rate)).1);
        self.free_part(&parts.fold([0.0; 3], |sum, part| add(&sum, 1.0, &part)))
    }

    /// Whether the force on the node stays within the bound for holding without wedging, so that the node slides where
    /// the force reaches this bound. A node that arrives from one obstacle may be held beyond the bound: no slide can
    /// begin there.
    pub fn keeps(&self, loading: Loading<'_>, state: &State, rate: &Rate) -> bool {
        let (force, change) = (self.force(loading, state), self.force_rate(loading, state, rate));
        let meeting = self.contacts.iter().map(|contact| loading.forces_meeting_at(*contact, state));
        let round_off = MEETING_FORCE_ROUNDING * meeting.fold(0.0, f64::max);
        let zero = round_off.max(BOUND_TOLERANCE * size(&force));
        let unloaded = size(&force) <= round_off;
        let margin = self.margin(&force);
        if !unloaded && margin.abs() > zero {
            return margin > 0.0;
        }
        let slides = if unloaded { Vec::new() } else { self.ready(&force, zero) };
        self.margin_of_slides(&slides, unloaded, zero, &change) >= -BOUND_TOLERANCE * size(&change)
    }

    /// The slides at whose friction bound a force lies.
    pub fn ready(&self, force: &Vector, zero: f64) -> Vec<(Slide, Drive)> {
        if cone_sum::is_jammed(self) {
            return Vec::new();
        }
        let pressed = |drive: &Drive| drive.normals[0].max(drive.normals[1]) > zero;
        let ready = |slide: Slide| {
            // The remainder from the location of a zero is no normal reaction.
            let drive = self.drive(&slide, force).or_else(|| self.drive_within(&slide, force, zero))?;
            (drive.excess.abs() <= zero && pressed(&drive)).then_some((slide, drive))
        };
        self.slides().into_iter().filter_map(ready).collect()
    }

    /// As [`drive`](Self::drive), where normal reactions or driving forces are zero within a tolerance.
    fn drive_within(&self, slide: &Slide, force: &Vector, zero: f64) -> Option<Drive> {
        match *slide {
            Slide::Edge { places, direction } => {
                let normals = self.edge_forms(places, &direction).map(|form| dot(&form, force));
                let excess = dot(&self.edge_drive(places, &direction), force);
                normals.iter().all(|normal| *normal >= -zero).then_some(Drive { direction, normals, excess })
            }
            Slide::Face { place } => {
                let normal = dot(&self.face_form(place), force);
                let driving = size(&add(force, -normal, &self.normals[place]));
                let excess = driving - self.frictions[place].bound(normal);
                (driving <= zero).then_some(Drive { direction: [0.0; 3], normals: [normal, 0.0], excess })
            }
        }
    }

    /// The margin of a rate of the force against sliding or leaving, and against leaving the sum of the cones.
    pub fn margin_of_rate(&self, force: &Vector, unloaded: bool, zero: f64, rate: &Vector) -> f64 {
        let slides = if unloaded { Vec::new() } else { self.ready(force, zero) };
        let margin = self.margin_of_slides(&slides, unloaded, zero, rate);
        if unloaded { margin } else { margin.min(cone_sum::slope_at_bound(self, force, zero, rate)) }
    }

    /// The margin of a rate of the force against sliding or leaving, where the slides `ready` are at their friction
    /// bound; without a force all slides are.
    fn margin_of_slides(&self, ready: &[(Slide, Drive)], unloaded: bool, zero: f64, rate: &Vector) -> f64 {
        if unloaded {
            return self.margin(rate);
        }
        let small = NEGLIGIBLE_COMPONENT * size(rate);
        let drives = |(slide, drive): &(Slide, Drive)| match *slide {
            Slide::Edge { places, direction } => {
                let forms = self.edge_forms(places, &direction);
                let lifts = (0..2).any(|k| drive.normals[k] <= zero && dot(&forms[k], rate) < -small);
                (!lifts).then(|| dot(&self.edge_drive(places, &direction), rate))
            }
            Slide::Face { place } => {
                let normal = dot(&self.face_form(place), rate);
                let across = add(rate, -normal, &self.normals[place]);
                if !self.frictions[place].is_rough() {
                    let direction = scaled(&unit(&across), -1.0);
                    return self.opens(&direction, &[place]).then(|| size(&across));
                }
                let fits = self.turns_off(place, &drive.direction).iter().all(|form| dot(form, rate) >= -small);
                fits.then(|| -self.frictions[place].bound(normal) - dot(&drive.direction, rate))
            }
        };
        ready.iter().filter_map(drives).map(|excess| -excess).fold(size(rate), f64::min)
    }

    /// Forms of the rate of force that are not negative where a slide that begins tangent to other obstacles turns away
    /// from them.
    pub fn turns_off(&self, place: usize, direction: &Vector) -> Vec<Vector> {
        let across = cross(&self.frames[place].normal, direction);
        let grazes = |other: &usize| {
            *other != place
                && self.free.len() == 3
                && dot(&self.frames[*other].normal, direction).abs() <= PERPENDICULAR_COSINE
        };
        let form = |other: usize| scaled(&across, -dot(&self.frames[other].normal, &across));
        (0..self.contacts.len()).filter(grazes).map(form).collect()
    }

    /// The friction cones of the obstacles, for the reactions of least norm.
    fn cones(&self) -> Vec<Cone> {
        let of = |(frame, friction): (&Frame, &CoulombFriction)| Cone {
            normal: frame.normal,
            friction: *friction,
            line: (self.free.len() == 2).then_some(frame.tangents[0]),
        };
        self.frames.iter().zip(&self.frictions).map(of).collect()
    }

    /// The reactions of least norm whose sum is a force; where they are not found, on the bound of the sum of the cones
    /// or at a slide, the only reactions possible there.
    pub fn share(&self, force: &Vector) -> Option<Vec<Vector>> {
        least_reactions(&self.cones(), &self.free, force)
            .or_else(|| cone_sum::at_bound(self, force))
            .or_else(|| self.resting(force))
            .or_else(|| self.parts(force))
    }

    /// The normal reactions of three obstacles whose sum is a force in space.
    fn resting(&self, force: &Vector) -> Option<Vec<Vector>> {
        let count = if self.free.len() == 3 { self.contacts.len() } else { 0 };
        let triples = (0..count).flat_map(|a| (a + 1..count).flat_map(move |b| (b + 1..count).map(move |c| [a, b, c])));
        triples.into_iter().find_map(|places| {
            let [a, b, c] = places.map(|place| self.normals[place]);
            let across = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
            let determinant = dot(&a, &across[0]);
            let normals = across.map(|across| dot(&across, force) / determinant);
            let fits = determinant.abs() > INDEPENDENCE_SINE
                && normals.iter().all(|normal| *normal >= -NEGLIGIBLE_COMPONENT * size(force));
            fits.then(|| {
                let mut parts = vec![[0.0; 3]; count];
                for (place, normal) in places.into_iter().zip(normals) {
                    parts[place] = scaled(&self.normals[place], normal.max(0.0));
                }
                parts
            })
        })
    }

    /// The reactions to a force without wedging.
    fn parts(&self, force: &Vector) -> Option<Vec<Vector>> {
        let drives = |slide: Slide| Some((slide, self.drive(&slide, force)?));
        let driven = |(_, drive): &(Slide, Drive)| dot(&drive.direction, force) <= 0.0;
        let (slide, drive) = self
            .slides()
            .into_iter()
            .filter_map(drives)
            .filter(driven)
            .max_by(|a, b| a.1.excess.total_cmp(&b.1.excess))?;
        let places = match slide {
            Slide::Edge { places, .. } => places.to_vec(),
            Slide::Face { place } => vec![place],
        };
        let drag: f64 =
            places.iter().zip(drive.normals).map(|(place, normal)| self.frictions[*place].bound(normal)).sum();
        let driving = -dot(&drive.direction, force);
        if driving > drag + CONE_TOLERANCE * size(force) {
            return None;
        }
        let part = if drag > 0.0 { (driving / drag).min(1.0) } else { 0.0 };
        let mut parts = vec![[0.0; 3]; self.contacts.len()];
        for (place, normal) in places.into_iter().zip(drive.normals) {
            let ray = add(&self.frames[place].normal, -part * self.frictions[place].coefficient, &drive.direction);
            parts[place] = scaled(&ray, normal.max(0.0));
        }
        Some(parts)
    }
}

/// The projection of a vector on the span of orthonormal directions.
fn along(directions: &[Vector], vector: &Vector) -> Vector {
    if directions.len() == 3 {
        return *vector;
    }
    directions.iter().fold([0.0; 3], |sum, direction| add(&sum, dot(direction, vector), direction))
}
