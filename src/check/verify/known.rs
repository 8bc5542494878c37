//! Scenes with solutions in closed form, for any stiffness, friction and units.

use crate::check::verify::compare::{bisected, changes, moved, of_stage, points, relative, worse, worst};
use crate::check::verify::make::{Make, displacement, load_above, plane_model};
use crate::model::JobRequest;
use crate::model::request::Component;
use crate::result::increment::{Increment, PointKind, Status};

/// Klarbring's node (formulation, section 4): `K = [[a, -b], [-b, c]]` on the floor, pressed by `p`, pulled by
/// `S = s f`. Sticking up to `S = μ p`; slipping at `u_x = x`: `r_n = p - b x`, `S = a x + μ r_n`; free from `x = p/b`
/// on: `K u = (S, -p)`.
#[derive(Debug, Clone, Copy)]
pub struct KlarbringSolution {
    pub along: f64,
    pub coupling: f64,
    pub across: f64,
    pub friction: f64,
    pub press: f64,
    /// Pulling force at a load factor of 1.
    pub pull: f64,
}

impl KlarbringSolution {
    pub const PUBLISHED: Self = Self { along: 1.0, coupling: 0.8, across: 1.0, friction: 1.5, press: 1.0, pull: 1.0 };

    /// The same node with lengths and forces in other units.
    pub fn in_units(self, length: f64, force: f64) -> Self {
        let stiffness = force / length;
        Self {
            along: self.along * stiffness,
            coupling: self.coupling * stiffness,
            across: self.across * stiffness,
            press: self.press * force,
            pull: self.pull * force,
            ..self
        }
    }

    pub fn stiffness(&self) -> [[f64; 2]; 2] {
        [[self.along, -self.coupling], [-self.coupling, self.across]]
    }

    /// Pulling force at which the node leaves the floor.
    fn lift(&self) -> f64 {
        self.along * self.press / self.coupling
    }

    /// The largest of the pressing force and of the pulling forces at both corners.
    fn force(&self) -> f64 {
        (self.friction * self.press).max(self.lift()).max(self.press)
    }

    /// The request without the contact; the pull ends at twice the larger of the loads at both corners.
    pub fn make(&self) -> Make {
        let last = 2.0 * (self.friction * self.press).max(self.lift()) / self.pull;
        plane_model()
            .node("node", &[0.0, 0.0])
            .spring(&["node"], self.stiffness())
            .floor()
            .stage("press", &[("node", [0.0, -self.press])], load_above(1.0))
            .stage("pull", &[("node", [self.pull, 0.0])], load_above(last))
    }

    pub fn request(&self) -> JobRequest {
        self.make().contact("node", "floor", self.friction).request()
    }

    /// Error of one increment of the pull, relative to characteristic forces and lengths; `among` are the contacts of
    /// the node.
    pub fn error_at(&self, increment: &Increment, node: &str, among: std::ops::Range<usize>) -> f64 {
        let (x, y) = (moved(increment, node, 0), moved(increment, node, 1));
        let load = increment.load_factor * self.pull;
        let contacts = &increment.contacts[among];
        let normal: f64 = contacts.iter().map(|contact| contact.normal_reaction).sum();
        let is = |status: Status| contacts.iter().any(|contact| contact.status == status);
        let (force, length) = (self.force(), self.press / self.coupling);
        let Self { along, coupling, across, friction, press, .. } = *self;
        if is(Status::Stick) {
            worse(x.abs().max(y.abs()) / length, relative(normal, press, force))
        } else if is(Status::Slip) {
            let exact = along * x + friction * (press - coupling * x);
            worse(relative(load, exact, force), relative(normal, press - coupling * x, force))
        } else {
            let size = force.max(load.abs()) * across.max(along) / along;
            worse((along * x - coupling * y - load).abs(), (across * y - coupling * x + press).abs()) / size
        }
    }

    /// Error of a whole path, including the loads at the corners.
    pub fn error(&self, increments: &[Increment]) -> f64 {
        let states = of_stage(increments, "pull").map(|increment| {
            let contacts = 0..increment.contacts.len();
            self.error_at(increment, "node", contacts)
        });
        let found: Vec<&Increment> = changes(increments).collect();
        let mut corners = vec![self.lift()];
        if self.friction > 0.0 {
            corners.insert(0, self.friction * self.press);
        }
        if found.len() != corners.len() {
            return f64::INFINITY;
        }
        let loads =
            found.iter().zip(corners).map(|(point, load)| relative(point.load_factor * self.pull, load, self.press));
        worse(worst(states), worst(loads))
    }
}

/// The one-bar truss (formulation, section 4): pin at (0, h), tip on the floor, initially at (-a, 0), force `S = s f`
/// along x. Slipping at x: `S = P (μ h - x)/L`, `P = EA (1 - L/L0)`; the limit points are the zeros of `dS/dx`.
#[derive(Debug, Clone, Copy)]
pub struct OneBarSolution {
    pub stiffness: f64,
    pub height: f64,
    pub start: f64,
    pub friction: f64,
    pub pull: f64,
}

impl OneBarSolution {
    pub const fn with_friction(friction: f64) -> Self {
        Self { stiffness: 1.0, height: 1.0, start: 1.5, friction, pull: 1.0 }
    }

    pub fn in_units(self, length: f64, force: f64) -> Self {
        Self {
            stiffness: self.stiffness * force,
            height: self.height * length,
            start: self.start * length,
            pull: self.pull * force,
            ..self
        }
    }

    pub fn make(&self) -> Make {
        plane_model()
            .node("pin", &[0.0, self.height])
            .node("tip", &[-self.start, 0.0])
            .support("pin", &[Component::X, Component::Y])
            .bar("pin", "tip", self.stiffness)
            .floor()
            .contact("tip", "floor", self.friction)
            .stage("push", &[("tip", [self.pull, 0.0])], None)
    }

    /// `S` at a displacement of the tip; `1/L - 1/L0` is computed without cancellation.
    pub fn load(&self, moved: f64) -> f64 {
        let x = moved - self.start;
        let (length, rest) = (x.hypot(self.height), self.start.hypot(self.height));
        let by_length = moved * (2.0 * self.start - moved) / (length * rest * (length + rest));
        self.stiffness * by_length * (self.friction * self.height - x)
    }

    /// `dS/dx` over EA.
    fn slope(&self, moved: f64) -> f64 {
        let x = moved - self.start;
        let (length, rest) = (x.hypot(self.height), self.start.hypot(self.height));
        let by_length = moved * (2.0 * self.start - moved) / (length * rest * (length + rest));
        -x / length.powi(3) * (self.friction * self.height - x) - by_length
    }

    /// Displacements of the tip at the limit points, up to the end at twice `start`.
    pub fn limits(&self) -> Vec<f64> {
        let cells = 4096;
        let place = |cell: i32| 2.0 * self.start * f64::from(cell) / f64::from(cells);
        (0..cells)
            .map(|cell| (place(cell), place(cell + 1)))
            .filter(|(low, high)| (self.slope(*low) < 0.0) != (self.slope(*high) < 0.0))
            .map(|(low, high)| bisected(|moved| self.slope(moved), low, high))
            .collect()
    }

    /// The larger of two errors of a path: the error of the loads, over the larger of the exact load and 1e-5 of the
    /// largest load, and a hundredth of the error of the places of the limit points. The places are accurate only to
    /// the square root of the accuracy of the loads.
    pub fn error(&self, increments: &[Increment]) -> f64 {
        let limits = self.limits();
        let largest = limits.iter().map(|moved| self.load(*moved).abs()).fold(0.0, f64::max);
        let found: Vec<&Increment> = points(increments, PointKind::SmoothLimit).collect();
        if found.len() != limits.len() {
            return f64::INFINITY;
        }
        let places = found.iter().zip(limits);
        let places = worst(places.map(|(point, exact)| 1e-2 * relative(moved(point, "tip", 0), exact, self.start)));
        let loads = increments.iter().skip(1).map(|increment| {
            let exact = self.load(moved(increment, "tip", 0));
            relative(increment.load_factor * self.pull, exact, 1e-5 * largest)
        });
        worse(places, worst(loads))
    }
}

/// The von Mises truss: pins at (±1, 0), apex initially at (0, h), EA = 1. The force `P` pushes the apex down by `v`:
/// `P = 2 y (1/L - 1/L0)`, `y = h - v`, `L² = 1 + y²`. The load is largest where `cos³ θ = cos α` (angles of the bars
/// with and without load): `y = sqrt(cos^(-2/3) α - 1)`.
#[derive(Debug, Clone, Copy)]
pub struct VonMisesSolution {
    pub height: f64,
}

impl VonMisesSolution {
    pub fn make(&self) -> Make {
        plane_model()
            .node("left", &[-1.0, 0.0])
            .node("apex", &[0.0, self.height])
            .node("right", &[1.0, 0.0])
            .support("left", &[Component::X, Component::Y])
            .support("right", &[Component::X, Component::Y])
            .bar("left", "apex", 1.0)
            .bar("apex", "right", 1.0)
    }

    pub fn down(drop: f64) -> Option<crate::model::request::Until> {
        displacement("apex", Component::Y, -drop, -1.0)
    }

    /// `P` at a downward displacement, without cancellation.
    pub fn load(&self, drop: f64) -> f64 {
        let y = self.height - drop;
        let (length, rest) = (y.hypot(1.0), self.height.hypot(1.0));
        2.0 * y * drop * (2.0 * self.height - drop) / (length * rest * (length + rest))
    }

    /// `dP/dv`
    pub fn slope(&self, drop: f64) -> f64 {
        let y = self.height - drop;
        let (length, rest) = (y.hypot(1.0), self.height.hypot(1.0));
        let by_length = drop * (2.0 * self.height - drop) / (length * rest * (length + rest));
        2.0 * (y * y / length.powi(3) - by_length)
    }

    /// Height of the apex above its pins at the largest load.
    pub fn height_at_limit(&self) -> f64 {
        (self.height.hypot(1.0).powf(2.0 / 3.0) - 1.0).sqrt()
    }
}
