//! Equilibrium of a structure under its loads: the out-of-balance force.
//!
//! ```text
//! G(u, s, r) = f_int(u) - s p - h - Σ_c B_cᵀ r_c
//! ```
//!
//! `p`: the load pattern; `h`: the constant loads of earlier stages; `r_c`: the force of a contact, whose part
//! `contact_jacobian` adds. Newton's method, the increment's program, the penalty method and the energy take `G` from here;
//! the tangent `K = ∂f_int/∂u` comes from `Structure::each_stiffness`, by unknowns through `Structure::over_unknowns`.

use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;

/// Sizes of the forces that meet in equilibrium: the largest of each kind.
#[derive(Clone, Copy)]
pub struct ForceSizes {
    /// Forces that elements carry.
    pub carried: f64,
    /// Loads, one component each.
    pub applied: f64,
    /// Internal forces at degrees of freedom, summed over the elements.
    pub internal: f64,
}

/// Writes `f_int(u) - s p - h` over all degrees of freedom: the out-of-balance force `G` without contacts.
pub fn write_unbalanced(loading: Loading<'_>, state: &State, force: &mut [f64]) -> ForceSizes {
    let carried = loading.structure.internal_force_beyond(&state.displacement, &state.remainder, force);
    let mut sizes = ForceSizes { carried, applied: 0.0, internal: 0.0 };
    let loads = loading.pattern.forces.iter().zip(&loading.held.forces);
    for (value, (pattern, held)) in force.iter_mut().zip(loads) {
        let load = state.load * pattern + held;
        sizes.applied = sizes.applied.max(load.abs());
        sizes.internal = sizes.internal.max(value.abs());
        *value -= load;
    }
    sizes
}
