//! Obstacles: normal and tangents.

/// A rigid obstacle.
#[derive(Debug, Clone)]
pub enum Obstacle {
    /// A half-space with unit `normal` into the free side.
    Plane { normal: [f64; 3] },
}

impl Obstacle {
    /// Unit normal into the free side.
    pub fn normal(&self) -> [f64; 3] {
        match self {
            Self::Plane { normal } => *normal,
        }
    }

    /// Orthonormal tangents; in 2D the first is the normal turned clockwise (along +x on a floor), the second zero.
    pub fn tangents(&self, dimension: usize) -> [[f64; 3]; 2] {
        let normal = self.normal();
        if dimension == 2 {
            return [[normal[1], -normal[0], 0.0], [0.0; 3]];
        }
        // The coordinate axis least aligned with the normal; the first of them, so that the choice is reproducible.
        let mut axis = 0;
        for k in 1..3 {
            if normal[k].abs() < normal[axis].abs() {
                axis = k;
            }
        }
        let mut first = [0.0; 3];
        first[axis] = 1.0;
        let along = normal[axis];
        (0..3).for_each(|k| first[k] -= along * normal[k]);
        let size = first.iter().map(|value| value * value).sum::<f64>().sqrt();
        first.iter_mut().for_each(|value| *value /= size);
        let second = [
            normal[1] * first[2] - normal[2] * first[1],
            normal[2] * first[0] - normal[0] * first[2],
            normal[0] * first[1] - normal[1] * first[0],
        ];
        [first, second]
    }
}
