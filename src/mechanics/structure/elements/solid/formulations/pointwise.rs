//! No mend: the material's energy at each quadrature point, `W_e = Σ_q V_q W(F_q)`.

use crate::mechanics::structure::elements::solid::formulations::nodal_sums::{
    Nodal, add_forces, add_stiffness, gradient,
};
use crate::mechanics::structure::elements::solid::formulations::{Body, Formulation, PointStress, add_force_sizes};
use crate::mechanics::structure::elements::solid::shapes::geometry::PointGeometry;

/// The formulation without a mend.
#[derive(Debug, Clone, Copy)]
pub struct Pointwise;

impl<const N: usize, const D: usize, const S: usize> Formulation<N, D, S> for Pointwise {
    fn energy(&self, body: &Body<N, D>, displacement: &Nodal<N, D>) -> Option<f64> {
        body.shape.iter().try_fold(0.0, |energy, shape| {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            let gradient = body.law.gradient(&gradient(displacement, &at.slots))?;
            Some(energy + at.volume * body.material().energy_density(&gradient))
        })
    }

    fn add_forces(&self, body: &Body<N, D>, displacement: &Nodal<N, D>, forces: &mut Nodal<N, D>) -> Option<()> {
        for shape in body.shape {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            let gradient = body.law.gradient(&gradient(displacement, &at.slots))?;
            add_forces(&body.law.stress::<D, S>(&gradient), at.volume, &at.slots, forces);
        }
        Some(())
    }

    fn add_stiffness(&self, body: &Body<N, D>, displacement: &Nodal<N, D>, stiffness: &mut [f64]) -> Option<()> {
        for shape in body.shape {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            let gradient = body.law.gradient(&gradient(displacement, &at.slots))?;
            add_stiffness(&body.law.tangent::<D, S>(&gradient), at.volume, &at.slots, stiffness);
        }
        Some(())
    }

    fn add_force_sizes(
        &self,
        body: &Body<N, D>,
        displacement: &Nodal<N, D>,
        motions: &Nodal<N, D>,
        sizes: &mut Nodal<N, D>,
    ) -> Option<()> {
        for shape in body.shape {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            let gradient = body.law.gradient(&gradient(displacement, &at.slots))?;
            let stress = body.law.stress::<D, S>(&gradient);
            add_force_sizes(&stress, &body.law.tangent(&gradient), &at, motions, sizes);
        }
        Some(())
    }

    fn each_stress(
        &self,
        body: &Body<N, D>,
        displacement: &Nodal<N, D>,
        visit: &mut dyn FnMut(PointStress<D>),
    ) -> Option<()> {
        for shape in body.shape {
            let at: PointGeometry<N, S> = body.geometry.at(shape);
            let gradient = body.law.gradient(&gradient(displacement, &at.slots))?;
            let position = body.geometry.position_at(shape);
            visit(body.point_stress(position, at.volume, &gradient, &body.material().stress(&gradient)));
        }
        Some(())
    }
}
