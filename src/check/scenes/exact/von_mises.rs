//! The von Mises truss: two equal bars from supports at `±b` to an apex at the height `h`, which is pushed down.
//!
//! After the displacement `v`, with `y = h - v`, `L² = b² + y²`, `λ = L/L0` and the bar force `N(λ)`: `s p = -2 N y/L`.

use crate::check::scenes::exact::curve::{CurvePlace, CurveStage, Reach};
use crate::check::scenes::exact::pattern;
use crate::check::scenes::exact::solution::ExactSolution;
use crate::model::Model;
use crate::model::request::{Element, Strain};

/// A von Mises truss.
#[derive(Debug, Clone)]
pub struct VonMisesScene {
    pub axial_stiffness: f64,
    pub half_span: f64,
    pub height: f64,
    pub strain: Strain,
    /// Absolute value of the force at a load factor of 1.
    pub force: f64,
    stage: String,
    freedoms: usize,
    apex: usize,
}

impl VonMisesScene {
    pub fn recognise(model: &Model) -> Option<Self> {
        let [first, second] = &model.elements[..] else { return None };
        let bar = |element: &Element| match element {
            Element::Bar { nodes, axial_stiffness, rest_length: None, prestress, strain, .. } if *prestress == 0.0 => {
                Some((nodes.clone(), *axial_stiffness, *strain))
            }
            _ => None,
        };
        let ((ends, stiffness, strain), (others, other_stiffness, other_strain)) = (bar(first)?, bar(second)?);
        let apex = model.nodes.keys().find(|node| ends.contains(node) && others.contains(node))?;
        let held = |nodes: &[String]| nodes.iter().find(|node| *node != apex).cloned();
        let (left, right) = (held(&ends)?, held(&others)?);
        let [stage] = &model.stages[..] else { return None };
        let force = pattern::only_force(stage, apex)?;
        let [top, left_place, right_place] = [apex, &left, &right].map(|node| &model.nodes[node]);
        let (half_span, height) = ((right_place[0] - left_place[0]).abs() / 2.0, top[1] - left_place[1]);
        let symmetric = top[0] - left_place[0] == right_place[0] - top[0] && left_place[1] == right_place[1];
        let fits = model.dimension == 2
            && model.nodes.len() == 3
            && model.contacts.is_empty()
            && pattern::is_held(model, &left)
            && pattern::is_held(model, &right)
            && pattern::is_free(model, apex)
            && (stiffness, strain) == (other_stiffness, other_strain)
            && symmetric
            && half_span > 0.0
            && height > 0.0;
        (fits && force[0] == 0.0 && force[1] < 0.0).then(|| Self {
            axial_stiffness: stiffness,
            half_span,
            height,
            strain,
            force: -force[1],
            stage: stage.name.clone(),
            freedoms: 6,
            apex: pattern::freedom(model, apex),
        })
    }

    /// `λ - 1`, without cancellation.
    fn elongation(&self, travel: f64) -> f64 {
        let rest = self.half_span.hypot(self.height);
        let length = self.half_span.hypot(self.height - travel);
        travel * (travel - 2.0 * self.height) / ((length + rest) * rest)
    }

    /// `N/EA` and its derivative with respect to `λ`.
    fn response(&self, elongation: f64) -> (f64, f64) {
        let stretch = 1.0 + elongation;
        match self.strain {
            Strain::Engineering => (elongation, 1.0),
            Strain::Green => (elongation * (1.0 + 0.5 * elongation) * stretch, (3.0 * stretch * stretch - 1.0) / 2.0),
            Strain::Log => {
                let strain = elongation.ln_1p();
                (strain / stretch, (1.0 - strain) / (stretch * stretch))
            }
        }
    }

    /// The load factor at a downward displacement of the apex.
    pub fn load(&self, travel: f64) -> f64 {
        let y = self.height - travel;
        let (force, _) = self.response(self.elongation(travel));
        -2.0 * self.axial_stiffness * force * y / self.half_span.hypot(y) / self.force
    }

    /// The derivative of the load factor with respect to the displacement.
    fn slope(&self, travel: f64) -> f64 {
        let y = self.height - travel;
        let (length, rest) = (self.half_span.hypot(y), self.half_span.hypot(self.height));
        let (force, change) = self.response(self.elongation(travel));
        let by_height = change * y * y / (length * length * rest) + force * (self.half_span / length).powi(2) / length;
        2.0 * self.axial_stiffness * by_height / self.force
    }
}

impl ExactSolution for VonMisesScene {
    fn name(&self) -> &'static str {
        "von Mises truss"
    }

    fn formula(&self) -> &'static str {
        "s p = -2 N (h - v)/L"
    }

    fn stages(&self, reach: Reach) -> Vec<CurveStage> {
        let truss = self.clone();
        let at = move |travel: f64| {
            let mut displacements = vec![0.0; truss.freedoms];
            displacements[truss.apex + 1] = -travel;
            CurvePlace { displacements, load: truss.load(travel) }
        };
        // Beyond both limit points in any case.
        let far = (2.0 * reach.displacement).max(3.0 * self.height);
        vec![CurveStage::turning(&self.stage, (0.0, far), |travel| self.slope(travel), at)]
    }
}
