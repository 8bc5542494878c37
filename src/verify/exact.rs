//! Exact solutions of built-in scenes.

/// The curving slip (formulation, section 4): pin at (0, b, h), tip from (x0, 0, 0), EA = 1, floor z = 0. With `c = μ h`
/// and `w = b - y` slip runs along `(sqrt(c² - w²), -w)/c`.
pub struct Tractrix {
    pub friction: f64,
    pub offset: f64,
    pub height: f64,
    pub start: f64,
}

impl Tractrix {
    /// As in the scene `curving-slip`.
    pub const BUILT_IN: Self = Self { friction: 0.8, offset: 0.1, height: 1.0, start: -1.4 };

    fn cone(&self) -> f64 {
        self.friction * self.height
    }

    pub fn rest_length(&self) -> f64 {
        self.start.hypot(self.offset).hypot(self.height)
    }

    /// `x` of the track at `w`: `x0 + [sqrt(c² - w²) - c arcosh(c/w)]` from `b` to `w`, with differences of the two
    /// ends taken so that nothing cancels near the start.
    pub fn track(&self, w: f64) -> f64 {
        let (c, b) = (self.cone(), self.offset);
        let leg = |w: f64| ((c - w) * (c + w)).sqrt();
        let change = (b - w) * (b + w) / (leg(w) + leg(b));
        self.start + change + c * (((w - b) / b).ln_1p() + ((leg(b) - leg(w)) / (c + leg(w))).ln_1p())
    }

    /// Distance of a place from the track, to first order in it: the track's slope there is `dw/dx = w/sqrt(c² - w²)`.
    pub fn distance(&self, x: f64, y: f64) -> f64 {
        let w = self.offset - y;
        (x - self.track(w)).abs() * w / self.cone()
    }

    /// Axial compression over the length, `P/L`.
    fn compression_by_length(&self, x: f64, y: f64) -> f64 {
        let length = x.hypot(self.offset - y).hypot(self.height);
        1.0 / length - 1.0 / self.rest_length()
    }

    /// Load of a tip that slides at this place: `s = -F_x + sqrt((μ r_n)² - F_y²)`.
    pub fn load(&self, x: f64, y: f64) -> f64 {
        let (c, w) = (self.cone(), self.offset - y);
        self.compression_by_length(x, y) * (((c - w) * (c + w)).sqrt() - x)
    }

    pub fn normal_reaction(&self, x: f64, y: f64) -> f64 {
        self.compression_by_length(x, y) * self.height
    }

    /// Traction in space, `-μ r_n` along the slip.
    pub fn traction(&self, x: f64, y: f64) -> [f64; 2] {
        let (c, w) = (self.cone(), self.offset - y);
        let size = self.compression_by_length(x, y);
        [-size * ((c - w) * (c + w)).sqrt(), size * w]
    }
}

/// The one-bar truss over a hump: pin at (0, H), tip on the circle of radius 1 about the origin at the angle `φ` from
/// the top, positive to the right; EA = 1. With the normal `(sin φ, cos φ)` and the tangent `(cos φ, -sin φ)`:
///
/// ```text
/// P (1 - H cos φ)/L + s sin φ + r_n = 0,     P H sin φ/L + s cos φ = μ r_n
/// ```
pub struct Hump {
    pub friction: f64,
    pub pin: f64,
    pub start: f64,
}

impl Hump {
    /// As in the scene `hump`.
    pub const BUILT_IN: Self = Self { friction: 0.3, pin: 2.5, start: -0.9 };

    /// Axial compression over the length, `P/L`.
    fn compression_by_length(&self, angle: f64) -> f64 {
        let length = |angle: f64| angle.sin().hypot(self.pin - angle.cos());
        1.0 / length(angle) - 1.0 / length(self.start)
    }

    pub fn load(&self, angle: f64) -> f64 {
        let (sine, cosine) = angle.sin_cos();
        -self.compression_by_length(angle) * (self.pin * sine + self.friction * (1.0 - self.pin * cosine))
            / (cosine + self.friction * sine)
    }

    pub fn normal_reaction(&self, angle: f64) -> f64 {
        let (sine, cosine) = angle.sin_cos();
        self.compression_by_length(angle) * (self.pin * cosine - 1.0) - self.load(angle) * sine
    }
}

/// A node in a bowl of radius 1, held by a spring `k` in all directions, pressed down by 1 and pushed sideways: it
/// slides up where the force on it leans from the normal by the angle of friction. At the angle `φ` from the bottom
/// `s = k sin φ + (1 + k (1 - cos φ)) tan(φ + arctan μ)`.
pub fn bowl_load(stiffness: f64, friction: f64, angle: f64) -> f64 {
    let (sine, cosine) = angle.sin_cos();
    stiffness * sine + (1.0 + stiffness * (1.0 - cosine)) * (angle + friction.atan()).tan()
}

/// Displacement of a block on a spring `k = 1`, pressed by 1 on a floor that has dragged it to `(ρ, 0)`, `ρ = μ/k`, and
/// goes on by `s` along the unit vector `(cos ψ0, sin ψ0)`. The block slips all the time, so the spring's force stays
/// `k ρ` against the slip `u̇ - e = -λ u`: `u` turns towards `e`, the angle between them obeys `ρ ψ̇ = -sin ψ`, and
/// `tan(ψ/2) = tan(ψ0/2) exp(-s/ρ)`.
pub fn turning_drag(radius: f64, turn: f64, s: f64) -> [f64; 2] {
    let between = 2.0 * ((0.5 * turn).tan() * (-s / radius).exp()).atan();
    let (sine, cosine) = (turn - between).sin_cos();
    [radius * cosine, radius * sine]
}
