//! Directions where many contacts can change, without a matrix of them.
//!
//! Let `w >= 0` be the speeds of the nodes on their cones, along the directions `d` in which they may slip, and
//! `y = μ ṙ_n + d·ṙ_t >= 0` what their forces leave of the cones, `w y = 0`. With `x` the velocities of what is free, the
//! rates obey
//!
//! ```text
//! A (x, w) - q ṡ = (0, y),      A = Rᵀ K C,      columns C of a node on its cone: d,      rows R: d + μ n
//! ```
//!
//! in the plane, where obstacles are flat. If the symmetric part of `A` is positive definite, so is that of its Schur
//! complement `M` on `w`; `M` is a P-matrix, and for each sign of `ṡ` there is exactly one solution, and none with `ṡ = 0`
//! (R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, Academic Press 1992, theorem 3.3.7).
//! A sparse Cholesky factorisation says so, and the solution is found by block pivoting: solve in a mode, change every
//! contact that violates it, and again (M. M. Kostreva, Optimization 9 (1978) 13). Time and memory go with the structure.
//!
//! If `A` has one null vector, the same on both sides, with all `w` positive, and is definite across it, that motion is one
//! direction. Another with `ṡ = ±1` stands still at a contact with `y > 0`, so that it is the only one with its sign; and
//! with the other sign `z·y = z·q ṡ < 0`, so there is none.
//!
//! Where contacts are too many for the condensed matrix and there is no such proof, what block pivoting finds is listed, and
//! the modes not examined are counted.

use super::corner::whole_rates;
use super::directions::{Alternative, Candidate, Found, WEAK, is_mechanism};
use super::loading::Loading;
use super::mode_system::{Kind, ModeSystem};
use super::rates::Effort;
use super::standing::Standing;
use super::state::{Rate, State};
use crate::contact::vector::{Vector, add, dot, scaled};
use crate::contact::{Contact, Frame, Mode};
use crate::linear_algebra::Sink;
use crate::linear_algebra::sparse::{definite::Triangle, is_positive_definite};

/// Contacts that can change up to which the search of every combination is as quick.
const FEW: usize = 16;
/// Numbers of the condensed equations (contacts that can change times what each moves) that are too many.
const MOST_CONDENSED: usize = 25_000_000;
/// Rounds of block pivoting.
const MOST_ROUNDS: usize = 32;
/// What of its diagonal a matrix can lose and still count as definite.
const MARGIN: f64 = 1e-12;

/// Lists the directions; `false` where there is no proof that they are all and the contacts are few enough for a search.
pub(super) fn directions(
    loading: Loading<'_>,
    state: &State,
    standings: &[Standing],
    incoming: Option<&Rate>,
    effort: Effort<'_>,
    found: &mut Found,
) -> bool {
    if !effort.certify {
        return false;
    }
    let Some(sole) = Sole::new(loading, state, standings) else { return false };
    let columns = sole.changing.len() * loading.structure.dimension;
    let is_huge = columns * (loading.structure.freedoms() + 4 * loading.contacts.len()) > MOST_CONDENSED;
    let all_on_cone = sole.touching == 0;
    if sole.changing.len() <= FEW || !(all_on_cone || is_huge) {
        return false;
    }
    let certain = all_on_cone && is_positive_definite(sole.size, &sole.symmetric_part(None), MARGIN);
    let sliding = if certain || !all_on_cone { None } else { sole.only_sliding(incoming) };
    if !certain && sliding.is_none() && !is_huge {
        return false;
    }
    let wanted = if sliding.is_some() { 1 } else { 2 };
    let candidates: Vec<Candidate> = [1.0, -1.0].into_iter().filter_map(|sign| sole.solve(sign, incoming)).collect();
    let at_rest = |candidate: &Candidate| sole.stands_still_for_sure(candidate);
    let complete = match &sliding {
        None => certain && candidates.len() == wanted,
        Some(_) => candidates.len() == wanted && candidates.iter().all(at_rest),
    };
    if !complete && !is_huge {
        return false;
    }
    found.candidates.extend(sliding);
    found.candidates.extend(candidates);
    if !complete {
        let modes = |ways: u64, count: usize| ways.saturating_pow(u32::try_from(count).unwrap_or(u32::MAX));
        found.unexplored = modes(2, sole.changing.len() - sole.touching).saturating_mul(modes(4, sole.touching));
    }
    true
}

/// A contact that can change.
struct Changing {
    contact: usize,
    /// The slip that it would begin with; `None` where it touches without reaction.
    direction: Option<Vector>,
    frame: Frame,
}

struct Sole<'a> {
    loading: Loading<'a>,
    state: &'a State,
    /// Modes of those that cannot change; of the others that they stick.
    held: Vec<Mode>,
    changing: Vec<Changing>,
    /// How many of them touch without reaction.
    touching: usize,
    /// For each degree of freedom its column in `A`, with what it has in the row and in the column.
    places: Vec<Option<(usize, f64, f64)>>,
    /// Columns of `A` that are the changing contacts', in their order.
    own: Vec<usize>,
    size: usize,
}

impl<'a> Sole<'a> {
    /// `None` where the equations are not of the kind described.
    fn new(loading: Loading<'a>, state: &'a State, standings: &[Standing]) -> Option<Self> {
        let structure = loading.structure;
        let few = standings.iter().filter(|standing| !matches!(standing, Standing::Settled(_))).count() <= FEW;
        let shares = loading.corners.iter().any(|corner| {
            corner.contacts.iter().filter(|contact| standings[**contact] != Standing::Settled(Mode::Free)).count() > 1
        });
        if few || structure.dimension != 2 || shares {
            return None;
        }
        let mut places = vec![None; structure.freedoms()];
        let mut is_held = vec![false; structure.freedoms() / 2];
        let (mut changing, mut held, mut touching) = (Vec::new(), Vec::with_capacity(standings.len()), 0);
        let (mut size, mut own) = (0, Vec::new());
        for (contact, (standing, data)) in standings.iter().zip(loading.contacts).enumerate() {
            if *standing == Standing::Settled(Mode::Free) {
                held.push(Mode::Free);
                continue;
            }
            let frame = loading.frame(contact, state);
            let first = 2 * data.node;
            let is_free = (first..first + 2).all(|freedom| structure.unknown_of[freedom].is_some());
            if frame.curvature != 0.0 {
                return None;
            }
            is_held[data.node] = true;
            let sticks = matches!(standing, Standing::Settled(Mode::Stick));
            if !sticks && !is_free {
                return None;
            }
            let along = match standing {
                Standing::Settled(Mode::Slip { .. }) => Some(frame.tangents[0]),
                Standing::OnCone { direction } => Some(*direction),
                Standing::Settled(Mode::Stick | Mode::Free) | Standing::Touching => None,
                Standing::Cornered { .. } => return None,
            };
            if let Some(along) = along {
                let across = add(&along, data.friction, &frame.normal);
                (0..2).for_each(|part| places[first + part] = Some((size, across[part], along[part])));
                size += 1;
            }
            held.push(match standing {
                Standing::Settled(mode) => *mode,
                _ if data.tangents() > 0 => Mode::Stick,
                _ => Mode::Slip { direction: [0.0; 3] },
            });
            match standing {
                Standing::OnCone { direction } => {
                    own.push(size - 1);
                    changing.push(Changing { contact, direction: Some(*direction), frame });
                }
                Standing::Touching => {
                    touching += 1;
                    changing.push(Changing { contact, direction: None, frame });
                }
                Standing::Settled(_) | Standing::Cornered { .. } => {}
            }
        }
        for freedom in &structure.freedom_of {
            if !is_held[freedom / 2] {
                places[*freedom] = Some((size, 1.0, 1.0));
                size += 1;
            }
        }
        Some(Self { loading, state, held, changing, touching, places, own, size })
    }

    /// The lower triangle of `(A + Aᵀ)/2`, without one of its columns if so asked.
    fn symmetric_part(&self, without: Option<usize>) -> Triangle {
        let mut lower = Triangle::new();
        self.loading.structure.each_stiffness(&self.state.displacement, &mut |row, column, value| {
            if let (Some((row, left, _)), Some((column, _, right))) = (self.places[row], self.places[column]) {
                let value = left * value * right;
                if without.is_some_and(|without| without == row || without == column) || value == 0.0 {
                    return;
                }
                let half = if row == column { value } else { 0.5 * value };
                lower.push((row.max(column), row.min(column), half));
            }
        });
        if let Some(without) = without {
            // Keeps its place, apart from the others.
            lower.push((without, without, 1.0));
        }
        lower
    }

    /// The motion of all contacts together that no element resists, where it is the only one.
    fn only_sliding(&self, incoming: Option<&Rate>) -> Option<Candidate> {
        let mut modes = self.held.clone();
        for one in &self.changing {
            modes[one.contact] = Mode::Slip { direction: one.direction? };
        }
        let system = ModeSystem::new(self.loading, &modes, self.state);
        let iterate = system.iterate(self.state.clone());
        let mut rate = system.tangent_by(&system.bordered(&iterate, incoming?)?, &iterate)?;
        let speeds = |rate: &Rate| -> Option<Vec<f64>> {
            self.changing.iter().map(|one| Some(self.speed(one, &one.direction?, rate))).collect()
        };
        if speeds(&rate)?.iter().sum::<f64>() < 0.0 {
            rate.scale(-1.0);
        }
        let speeds = speeds(&rate)?;
        if !is_mechanism(self.loading, self.state, &rate) || speeds.iter().any(|speed| *speed <= WEAK) {
            return None;
        }
        // The motion as columns of `A`, and what the symmetric part makes of it.
        let mut motion = vec![0.0; self.size];
        for (freedom, place) in self.places.iter().enumerate() {
            if let Some((place, _, right)) = place {
                motion[*place] += right * rate.displacement[freedom];
            }
        }
        let (mut image, mut sizes) = (vec![0.0; self.size], vec![0.0_f64; self.size]);
        for (row, column, value) in self.symmetric_part(None) {
            image[row] += value * motion[column];
            sizes[row] = sizes[row].max(value.abs());
            if row != column {
                image[column] += value * motion[row];
                sizes[column] = sizes[column].max(value.abs());
            }
        }
        let is_null = image.iter().zip(&sizes).all(|(image, size)| image.abs() <= WEAK * size);
        let fastest = speeds.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map(|(place, _)| self.own[place]);
        let is_only = is_null && is_positive_definite(self.size, &self.symmetric_part(fastest), MARGIN);
        is_only.then(|| self.candidate(rate, modes, Vec::new()))
    }

    /// A direction with this sign of the load rate, by block pivoting.
    fn solve(&self, sign: f64, incoming: Option<&Rate>) -> Option<Candidate> {
        let mut modes = self.held.clone();
        if incoming.is_some_and(|rate| rate.load * sign > 0.0) {
            for one in &self.changing {
                modes[one.contact] = one.direction.map_or(modes[one.contact], |direction| Mode::Slip { direction });
            }
        }
        for _ in 0..MOST_ROUNDS {
            let system = ModeSystem::new(self.loading, &modes, self.state);
            let iterate = system.iterate(self.state.clone());
            let by_load = |matrix: &mut dyn Sink| matrix.add(system.size() - 1, self.loading.structure.unknowns(), 1.0);
            let mut rate = system.tangent_by(&system.factorise(&iterate, Kind::Rates, by_load)?, &iterate)?;
            rate.scale(sign * rate.load.signum());
            let force = WEAK * rate.largest_reaction().max(f64::MIN_POSITIVE);
            let (mut next, mut weak) = (modes.clone(), Vec::new());
            let mut changed = false;
            for one in &self.changing {
                let (mode, data) = (modes[one.contact], &self.loading.contacts[one.contact]);
                let (margin, other) = self.margin(one, data, mode, &rate);
                let tolerance = if matches!(mode, Mode::Stick) || data.tangents() == 0 { force } else { WEAK };
                if margin < -tolerance {
                    next[one.contact] = other;
                    changed = true;
                } else if margin <= tolerance {
                    weak.push(one.contact);
                }
            }
            if !changed {
                return Some(self.candidate(rate, modes, weak));
            }
            modes = next;
        }
        None
    }

    fn speed(&self, one: &Changing, direction: &Vector, rate: &Rate) -> f64 {
        dot(direction, &self.loading.relative_rate(one.contact, rate))
    }

    /// The least of what must not be negative in a mode, and the mode to try where it is.
    fn margin(&self, one: &Changing, data: &Contact, mode: Mode, rate: &Rate) -> (f64, Mode) {
        let reaction = &rate.reactions[one.contact];
        match (mode, one.direction) {
            (Mode::Stick, Some(direction)) => {
                let left = data.friction * reaction.normal + dot(&direction, &reaction.tangential);
                (left, Mode::Slip { direction })
            }
            (Mode::Slip { .. }, Some(direction)) => (self.speed(one, &direction, rate), Mode::Stick),
            (Mode::Stick, None) => {
                let traction = dot(&reaction.tangential, &one.frame.tangents[0]);
                let against = scaled(&one.frame.tangents[0], if traction > 0.0 { -1.0 } else { 1.0 });
                let other = if reaction.normal < 0.0 { Mode::Free } else { Mode::Slip { direction: against } };
                (data.friction * reaction.normal - traction.abs(), other)
            }
            (Mode::Slip { .. }, None) if data.tangents() == 0 => (reaction.normal, Mode::Free),
            (Mode::Slip { direction }, None) => {
                let speed = self.speed(one, &direction, rate);
                let other = if reaction.normal < 0.0 { Mode::Free } else { Mode::Stick };
                (speed.min(reaction.normal), other)
            }
            (Mode::Free, _) => {
                let closed = if data.tangents() > 0 { Mode::Stick } else { Mode::Slip { direction: [0.0; 3] } };
                (self.speed(one, &one.frame.normal, rate), closed)
            }
        }
    }

    /// Whether some contact of a direction along which none moves leaves its cone, beyond round-off.
    fn stands_still_for_sure(&self, candidate: &Candidate) -> bool {
        let force = WEAK * candidate.rate.largest_reaction().max(f64::MIN_POSITIVE);
        let sticks = self.changing.iter().all(|one| candidate.modes[one.contact] == Mode::Stick);
        let leaves = |one: &Changing| {
            let data = &self.loading.contacts[one.contact];
            self.margin(one, data, Mode::Stick, &candidate.rate).0 > force
        };
        sticks && self.changing.iter().any(leaves)
    }

    /// `weak`: the contacts that might as well be in the other mode, at first order; where they can stick they do.
    fn candidate(&self, rate: Rate, mut modes: Vec<Mode>, weak: Vec<usize>) -> Candidate {
        let mut in_doubt = weak.iter().peekable();
        let mut alternatives: Vec<Vec<Alternative>> = Vec::with_capacity(self.changing.len());
        for one in &self.changing {
            let mode = modes[one.contact];
            let is_weak = in_doubt.next_if_eq(&&one.contact).is_some();
            alternatives.push(match (is_weak, one.direction) {
                (true, Some(direction)) => {
                    modes[one.contact] = Mode::Stick;
                    vec![vec![(one.contact, Mode::Stick)], vec![(one.contact, Mode::Slip { direction })]]
                }
                _ => vec![vec![(one.contact, mode)]],
            });
        }
        let dissipation = self.changing.iter().map(|one| {
            let slips = matches!(modes[one.contact], Mode::Slip { .. });
            let traction = &self.state.reactions[one.contact].tangential;
            if slips { -dot(traction, &self.loading.relative_rate(one.contact, &rate)) } else { 0.0 }
        });
        let dissipation = dissipation.sum();
        let forces = whole_rates(self.loading, self.state, &rate);
        Candidate { rate, forces, modes, alternatives, weak: !weak.is_empty(), dissipation }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancel::CancelFlag;
    use crate::path::condensed::Condensed;
    use crate::path::{Path, Scene};
    use serde_json::{Map, json};

    /// A chain of blocks on a floor, joined by springs that press or lift them as they are drawn out.
    fn chain(blocks: usize, coupling: f64) -> Scene {
        let (mut nodes, mut weights) = (Map::new(), Map::new());
        let (mut elements, mut contacts) = (Vec::new(), Vec::new());
        for block in 0..blocks {
            let name = format!("block{block}");
            nodes.insert(name.clone(), json!([-(block as f64), 0]));
            weights.insert(name.clone(), json!([0, -1.0 - 0.1 * (block % 3) as f64]));
            contacts.push(json!({"node": &name, "obstacle": "floor", "friction": 0.3}));
            if block > 0 {
                let stiffness = json!([[1, coupling], [coupling, 0.5]]);
                elements.push(
                    json!({"kind": "spring", "nodes": [format!("block{}", block - 1), name], "stiffness": stiffness}),
                );
            }
        }
        let request = json!({
            "model": {
                "dimension": 2, "nodes": nodes, "elements": elements, "contacts": contacts,
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
                "stages": [
                    {"name": "weigh", "forces": weights, "until": {"load_above": 1}},
                    {"name": "pull", "forces": {"block0": [1, 0.02]}, "until": {"contact_change": blocks}},
                ],
            },
        });
        Scene::new(&serde_json::from_value(request).expect("a request")).expect("a scene")
    }

    #[test]
    fn the_directions_are_those_of_the_condensed_equations() {
        for coupling in [0.0, -0.05] {
            let scene = chain(20, coupling);
            let mut path = Path::new(&scene, CancelFlag::default());
            let mut compared = 0;
            while path.next().is_some() {
                let (loading, state) = (path.loading(), &path.at.here.state);
                let (standings, effort) = (path.standings(state), path.rules().effort);
                let Some(incoming) = &path.at.here.rate else { continue };
                let (mut own, mut others) = (Found::default(), Found::default());
                if !directions(loading, state, &standings, Some(incoming), effort, &mut own) {
                    continue;
                }
                let held: Vec<Mode> = standings
                    .iter()
                    .map(|standing| match standing {
                        Standing::Settled(mode) => *mode,
                        _ => Mode::Stick,
                    })
                    .collect();
                let system = ModeSystem::new(loading, &held, state);
                let condensed =
                    Condensed::new(&system, loading, state, &standings, Some(incoming)).expect("a regular point");
                condensed.enumerate(&held, state, Some(incoming), effort, &mut others);
                assert_eq!((own.candidates.len(), own.unexplored), (others.candidates.len(), 0));
                for one in &own.candidates {
                    let alike = |other: &&Candidate| other.rate.product(&one.rate) > 1.0 - 1e-12;
                    let other = others.candidates.iter().find(alike).expect("the same direction");
                    assert_eq!((&one.modes, one.weak), (&other.modes, other.weak), "coupling {coupling}");
                    assert!((one.dissipation - other.dissipation).abs() < 1e-12);
                    assert_eq!(one.alternatives, other.alternatives);
                }
                compared += 1;
            }
            assert!(compared >= 3, "coupling {coupling}: {compared}");
        }
    }
}
