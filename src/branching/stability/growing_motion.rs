//! Admissible growing motions.

use crate::branching::stability::AssessedState;
use crate::branching::stability::mode_eigenvalues::ModeEigenvalues;
use crate::branching::stability::tolerances::{ADMISSIBLE, MOST_MODES, MOST_OPERATIONS};
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::{dot, scaled, size};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::state::Rate;
use crate::resources::cancel::CancelFlag;
use crate::step::corrector::cost_counters::Work;
use smallvec::{SmallVec, smallvec};

/// What a search found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GrowthVerdict {
    Found,
    /// No admissible motion grows, in any mode.
    None,
    /// None was found, but not every mode was examined, or an eigenvalue is zero.
    NotDecided,
}

/// The modes of one contact that its standing allows.
type ContactModes = SmallVec<[Mode; 4]>;

/// Searches the modes of all contacts: every combination where there are few, otherwise the present one and those in which
/// all contacts stick, slip or open.
pub(super) fn search(at: AssessedState<'_>, cancel: &CancelFlag, work: &mut Work) -> GrowthVerdict {
    let of_contacts: Vec<ContactModes> = (0..at.standings.len()).map(|contact| modes_of(at, contact)).collect();
    let combinations = of_contacts.iter().fold(1.0_f64, |count, modes| count * modes.len() as f64);
    let cube = (at.loading.structure.unknowns() as f64).powi(3);
    let is_whole = combinations <= MOST_MODES as f64 && combinations * cube <= MOST_OPERATIONS;
    let mut is_complete = is_whole && at.standings.iter().enumerate().all(|(contact, _)| knows_all_modes(at, contact));
    let mut examine = |modes: &[Mode]| {
        let Some(eigenvalues) = ModeEigenvalues::in_modes(at, modes, work) else {
            is_complete = false;
            return false;
        };
        is_complete &= !eigenvalues.is_neutral();
        eigenvalues.growing().any(|motion| match motion {
            // A motion of several that grow alike: each is admissible where no contact can change.
            None if !at.can_change() => true,
            None => {
                is_complete = false;
                false
            }
            Some(mut motion) => {
                is_admissible(at, modes, &motion) || {
                    motion.scale(-1.0);
                    is_admissible(at, modes, &motion)
                }
            }
        })
    };
    if is_whole {
        let mut places = vec![0; of_contacts.len()];
        loop {
            let modes: Vec<Mode> = of_contacts.iter().zip(&places).map(|(modes, place)| modes[*place]).collect();
            if examine(&modes) {
                return GrowthVerdict::Found;
            }
            if cancel.is_cancelled() {
                return GrowthVerdict::NotDecided;
            }
            let Some(next) = (0..places.len()).find(|contact| places[*contact] + 1 < of_contacts[*contact].len())
            else {
                break;
            };
            places[next] += 1;
            places[..next].fill(0);
        }
    } else {
        let first: Vec<Mode> = of_contacts.iter().map(|modes| modes[0]).collect();
        let last: Vec<Mode> = of_contacts.iter().map(|modes| modes[modes.len() - 1]).collect();
        if examine(at.modes) || examine(&first) || examine(&last) {
            return GrowthVerdict::Found;
        }
    }
    if is_complete { GrowthVerdict::None } else { GrowthVerdict::NotDecided }
}

/// The modes that a contact can take, sticking or open first.
fn modes_of(at: AssessedState<'_>, contact: usize) -> ContactModes {
    match at.standings[contact] {
        Standing::Settled(mode) => smallvec![mode],
        Standing::OnCone { direction } => smallvec![Mode::Stick, Mode::Slip { direction }],
        Standing::Touching if at.loading.contacts[contact].tangents() == 0 => {
            smallvec![Mode::Free, Mode::Slip { direction: [0.0; 3] }]
        }
        Standing::Touching if at.loading.contacts[contact].tangents() == 1 => {
            let tangent = at.loading.frame(contact, at.state).tangents[0];
            let slip = |sign: f64| Mode::Slip { direction: scaled(&tangent, sign) };
            smallvec![Mode::Free, Mode::Stick, slip(1.0), slip(-1.0)]
        }
        Standing::Touching => smallvec![Mode::Free, Mode::Stick],
        Standing::Cornered { .. } => smallvec![at.modes[contact]],
    }
}

/// Whether these are all the modes that the contact can take.
fn knows_all_modes(at: AssessedState<'_>, contact: usize) -> bool {
    match at.standings[contact] {
        Standing::Settled(_) | Standing::OnCone { .. } => true,
        Standing::Touching => at.loading.contacts[contact].tangents() < 2,
        Standing::Cornered { .. } => false,
    }
}

/// Whether a motion and its reactions obey the laws of contact and friction in rates.
fn is_admissible(at: AssessedState<'_>, modes: &[Mode], rate: &Rate) -> bool {
    let zero = ADMISSIBLE * (rate.size() + rate.largest_reaction());
    (0..modes.len()).all(|contact| {
        let reaction = &rate.reactions[contact];
        let bound = at.loading.contacts[contact].friction.bound(reaction.normal);
        let motion = || at.loading.relative_rate(contact, at.state, rate);
        let normal = || at.loading.frame(contact, at.state).normal;
        match (at.standings[contact], modes[contact]) {
            (Standing::Settled(_) | Standing::Cornered { .. }, _) => true,
            (Standing::OnCone { direction }, Mode::Stick) => -dot(&direction, &reaction.tangential) - bound <= zero,
            (Standing::OnCone { direction }, _) => dot(&direction, &motion()) >= -zero,
            (Standing::Touching, Mode::Free) => dot(&normal(), &motion()) >= -zero,
            (Standing::Touching, Mode::Stick) => reaction.normal >= -zero && size(&reaction.tangential) - bound <= zero,
            (Standing::Touching, Mode::Slip { direction }) => {
                reaction.normal >= -zero && dot(&direction, &motion()) >= -zero
            }
        }
    })
}
