//! Branch and bound over the entities.
//!
//! At a node some entities are decided; the cone of the node is given by the forms of their options and by the
//! inequalities common to all options of every other entity. The node is closed where the cone contains only zero,
//! where it is one line (all options that fit the line are examined), or where the open entities are certified to have
//! one ray for each sign of the load rate. Otherwise an entity that does not fit the cone's current point is decided,
//! best option first. The first branching is on the sign of the load rate. Every ray is computed from the exact
//! equations of its combination: the search only selects the combinations to examine.

use crate::complementarity::rate_search::certified_rays;
use crate::complementarity::rate_search::single_combination;
use crate::complementarity::rate_search::tolerances::SEARCH_TOLERANCE;
use crate::complementarity::rates::lemke::lemke;
use crate::complementarity::rates::pressed_contacts;
use crate::complementarity::rates::rate_problem::{Choice, Entity, RateProblem, Signed};
use crate::complementarity::rates::simplex_dictionary::simplex;
use crate::complementarity::rates::simplex_dictionary::{Dictionary, Feasibility};
use crate::resources::budget::{self, Taken};
use crate::resources::cancel::CancelFlag;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;
use std::rc::Rc;

/// A feasible direction under one combination of options.
#[derive(Debug, Clone)]
pub struct Ray {
    /// Weights of unit arc length.
    pub weights: DVector<f64>,
    /// The options of each entity that hold; the ray is feasible under every combination of these options.
    pub fitting: Vec<Vec<usize>>,
    /// The fitting options and the options that nearly hold.
    pub in_doubt: Vec<Vec<usize>>,
    /// Whether some inequality holds with equality.
    pub weak: bool,
}

impl Ray {
    /// The first combination under which the ray is feasible, with held options where possible.
    pub fn chosen(&self) -> Vec<usize> {
        self.fitting.iter().map(|options| options[0]).collect()
    }

    pub(crate) fn is_under(&self, chosen: &[usize]) -> bool {
        self.fitting.iter().zip(chosen).all(|(options, choice)| options.contains(choice))
    }
}

/// The findings of a search.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    /// Each motion once, in the order of the first combinations, with the first entity varying fastest.
    pub rays: Vec<Ray>,
    /// Number of combinations that were not examined, saturating; an upper bound.
    pub unexplored: u64,
    /// Whether some combination has more than one independent vector, or a vector without motion.
    pub degenerate: bool,
    /// Bases of solution sets of more than one dimension, one vector per column.
    pub planes: Vec<DMatrix<f64>>,
    /// Whether the certificate gives one ray for each sign of the load rate, without any branching.
    pub certified: bool,
    /// Number of nodes and combinations examined, with the work of large ones.
    pub examined: u64,
}

/// The limits of a search.
#[derive(Debug, Clone, Copy)]
pub struct Effort<'a> {
    /// Largest number of nodes and combinations examined; large ones count several times.
    pub most_modes: u64,
    /// Whether the search may end where a certificate proves one ray for each sign of the load rate.
    pub certify: bool,
    pub cancel: &'a CancelFlag,
}

/// Number of matrix entries changed, in dictionaries and eliminations, that count as one more node. Nodes of some 20
/// contacts change as many. A search among hundreds of contacts, whose nodes change far more, thus ends after about as
/// much work as one among a few.
const UNIT_OF_WORK: u64 = 32_768;
/// A search that has closed less than a share of its tree (of 2: one for each sign of the load rate) after one of so many
/// parts of its effort would not close half of it with all of its effort, as closed shares grow about evenly. It ends
/// there: what is left of the tree is counted, as where all effort is spent. Searches among 16, 17, 25, 33, 41 and 129
/// touching contacts close 1.9, 0.46, 6e-3, 3e-6, 9e-10 and 2e-54 with all of their effort.
const PARTS_OF_EFFORT: u64 = 8;
const LEAST_CLOSED: f64 = 0.1;
/// Largest number of nodes inside solution sets of more than one dimension, whose edges are rays like any other.
const MOST_IN_SETS: u64 = 512;

/// All rays found within the effort; `first` gives combinations to examine before the others, where there is no
/// certificate.
pub fn explore(problem: &RateProblem, first: impl FnOnce() -> Vec<Vec<usize>>, effort: Effort<'_>) -> Findings {
    explore_by(problem, first, effort, |problem, cancel| {
        let mut further = pressed_contacts::guesses(problem, cancel);
        further.extend(lemke(problem, cancel));
        further
    })
}

#[cfg(test)]
pub(crate) fn explore_without_pivoting(problem: &RateProblem, effort: Effort<'_>) -> Findings {
    explore_by(problem, Vec::new, effort, |_, _| Vec::new())
}

/// All rays found within the effort; `further` gives combinations to examine where the search was cut short.
fn explore_by(
    problem: &RateProblem,
    first: impl FnOnce() -> Vec<Vec<usize>>,
    effort: Effort<'_>,
    further: impl Fn(&RateProblem, &CancelFlag) -> Vec<Vec<usize>>,
) -> Findings {
    let mut search = BranchAndBound {
        problem,
        findings: Findings::default(),
        seen: BTreeSet::new(),
        held: Taken::default(),
        effort,
        common: Vec::new(),
        coupling: DMatrix::zeros(0, 0),
        work: 0,
    };
    if !certified_rays::certified_at_once(&mut search) {
        for chosen in first() {
            single_combination::examine(&mut search, &chosen);
        }
        search.branch();
        if search.findings.unexplored > 0 {
            for chosen in further(problem, effort.cancel) {
                single_combination::examine(&mut search, &chosen);
            }
        }
    }
    let mut findings = search.findings;
    findings.unexplored = findings.unexplored.min(problem.combinations());
    findings.rays.sort_by_cached_key(|ray| ray.chosen().into_iter().rev().collect::<Vec<_>>());
    findings
}

/// The decided entities and the remaining cone.
pub(crate) struct SearchNode {
    pub chosen: Vec<Option<usize>>,
    pub dictionary: Dictionary,
    /// Sign of the load rate.
    pub sign: f64,
    /// Whether the node lies inside a solution set of more than one dimension.
    pub in_set: bool,
    /// The entity decided last.
    last: Option<usize>,
}

/// A child that has not been examined yet.
struct Task {
    parent: Rc<SearchNode>,
    decision: Option<(usize, usize)>,
    /// The part of the tree below a sign of the load rate that the child is, were all branchings alike.
    share: f64,
}

/// The state of the search.
pub(crate) struct BranchAndBound<'a> {
    pub problem: &'a RateProblem,
    pub findings: Findings,
    /// Combinations whose equations were solved.
    pub seen: BTreeSet<Vec<usize>>,
    /// Memory of the combinations and the rays.
    pub held: Taken,
    pub effort: Effort<'a>,
    /// The inequalities common to all options of each entity; set when branching begins.
    common: Vec<Vec<Signed>>,
    /// The strength of coupling between entities; set when branching begins.
    coupling: DMatrix<f64>,
    /// Number of matrix entries changed since the last unit of work was counted.
    work: u64,
}

impl BranchAndBound<'_> {
    /// Counts one node or combination and the number of matrix entries changed for it.
    pub fn count(&mut self, entries: u64) {
        self.work = self.work.saturating_add(entries);
        self.findings.examined += 1 + self.work / UNIT_OF_WORK;
        self.work %= UNIT_OF_WORK;
    }

    fn branch(&mut self) {
        self.common = self.problem.entities.iter().map(Entity::common).collect();
        let Some(dictionary) = Dictionary::new(self.problem, &self.common) else {
            self.findings.degenerate = true;
            return;
        };
        self.coupling = self.problem.coupling();
        let root = |sign: f64| {
            let mut dictionary = dictionary.clone();
            dictionary.require(None, sign);
            let chosen = vec![None; self.problem.entities.len()];
            let parent = SearchNode { chosen, dictionary, sign, in_set: false, last: None };
            Task { parent: Rc::new(parent), decision: None, share: 1.0 }
        };
        let settled = certified_rays::settled_signs(self);
        let mut tasks: Vec<Task> = [-1.0, 1.0].into_iter().filter(|sign| !settled.contains(sign)).map(root).collect();
        if tasks.is_empty() {
            // Only rays with zero load rate remain.
            let mut dictionary = dictionary.clone();
            if dictionary.rest_load() {
                let chosen = vec![None; self.problem.entities.len()];
                let node = SearchNode { chosen, dictionary, sign: 1.0, in_set: false, last: None };
                tasks.push(Task { parent: Rc::new(node), decision: None, share: 1.0 });
            }
        }
        let mut in_sets = Vec::new();
        let mut left_in_sets = MOST_IN_SETS;
        let mut closed = 0.0;
        loop {
            let task = match tasks.pop() {
                Some(task) => task,
                None if left_in_sets > 0 => match in_sets.pop() {
                    Some(task) => task,
                    None => return,
                },
                None => break,
            };
            let before = self.findings.examined;
            let in_set = task.parent.in_set;
            // Closed shares grow about evenly, so that the rest of the effort would not end the search, either.
            let is_hopeless = before >= self.effort.most_modes / PARTS_OF_EFFORT && closed < LEAST_CLOSED && !in_set;
            if self.effort.cancel.is_cancelled() || before >= self.effort.most_modes || is_hopeless {
                tasks.push(task);
                break;
            }
            budget::spend(self.problem.weights());
            let share = task.share;
            let children = self.look_at(task);
            if children.is_empty() {
                closed += share;
            }
            for child in children {
                if child.parent.in_set { in_sets.push(child) } else { tasks.push(child) }
            }
            if in_set {
                left_in_sets = left_in_sets.saturating_sub(self.findings.examined - before);
            }
        }
        for task in tasks.iter().chain(&in_sets) {
            let left = self.combinations_of(task);
            self.findings.unexplored = self.findings.unexplored.saturating_add(left);
        }
    }

    /// Number of combinations under a task.
    fn combinations_of(&self, task: &Task) -> u64 {
        let decided = task.decision.map(|(entity, _)| entity);
        self.problem
            .entities
            .iter()
            .enumerate()
            .filter(|(index, _)| task.parent.chosen[*index].is_none() && decided != Some(*index))
            .fold(1, |total, (_, entity)| total.saturating_mul(entity.options.len() as u64))
    }

    /// Closes a node or returns its children, the most promising last.
    fn look_at(&mut self, task: Task) -> Vec<Task> {
        let share = task.share;
        let Some(mut node) = decide(self.problem, task) else {
            self.count(0);
            return Vec::new();
        };
        let is_empty = simplex::feasibility(&mut node.dictionary) == Feasibility::OnlyLines
            && !node.dictionary.is_lines_only()
            && !node.dictionary.leave_lines();
        self.count(node.dictionary.entries_changed());
        if is_empty {
            return Vec::new();
        }
        let open: Vec<usize> = (0..node.chosen.len()).filter(|&index| node.chosen[index].is_none()).collect();
        if open.is_empty() {
            let chosen: Vec<usize> = node.chosen.iter().flatten().copied().collect();
            single_combination::examine(self, &chosen);
            return Vec::new();
        }
        simplex::drop_forced(&mut node.dictionary);
        let dictionary = &node.dictionary;
        let dimension = dictionary.dimension() + usize::from(!dictionary.is_lines_only());
        if dimension == 0 {
            return Vec::new();
        }
        if dimension == 1 {
            let mut options: Vec<Vec<usize>> =
                node.chosen.iter().map(|choice| choice.iter().copied().collect()).collect();
            for &entity in &open {
                let choices = &self.problem.entities[entity].options;
                options[entity] = (0..choices.len()).filter(|&index| fits(dictionary, &choices[index])).collect();
            }
            if options.iter().all(|options| !options.is_empty()) {
                single_combination::examine_all(self, &options);
            }
            return Vec::new();
        }
        if certified_rays::certified_below(self, &node, &open) {
            return Vec::new();
        }
        if !node.in_set
            && let Some(filled) = self.filled(&node)
        {
            // The whole remaining cone solves the problem: a solution set of more than one dimension.
            single_combination::examine(self, &filled);
            node.in_set = true;
        }
        let entity = self.next(&node, &open);
        let choices = &self.problem.entities[entity].options;
        let mut order: Vec<(f64, usize)> =
            choices.iter().enumerate().map(|(index, choice)| (misfit(dictionary, choice), index)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        let parent = Rc::new(node);
        let share = share / order.len() as f64;
        order
            .into_iter()
            .map(|(_, choice)| Task { parent: Rc::clone(&parent), decision: Some((entity, choice)), share })
            .collect()
    }

    /// The entity to decide next. Among the entities that do not fit the node's point, the one most strongly coupled to
    /// the last decision: an impossible decision is then refuted by its neighbours, in a few nodes. Where all entities
    /// fit, the first whose options still restrict the cone.
    fn next(&self, node: &SearchNode, open: &[usize]) -> usize {
        let mut next: Option<((f64, f64), usize)> = None;
        for &entity in open {
            let fit = self.problem.entities[entity]
                .options
                .iter()
                .map(|choice| misfit(&node.dictionary, choice))
                .fold(f64::INFINITY, f64::min);
            if fit <= SEARCH_TOLERANCE {
                continue;
            }
            let score = (node.last.map_or(0.0, |last| self.coupling[(last, entity)]), fit);
            if next.is_none_or(|(best, _)| score > best) {
                next = Some((score, entity));
            }
        }
        let decides = |entity: &&usize| {
            let choices = &self.problem.entities[**entity].options;
            choices.iter().any(|choice| choice.zero.iter().any(|form| !node.dictionary.vanishes(*form)))
        };
        next.map(|(_, entity)| entity).or_else(|| open.iter().find(decides).copied()).unwrap_or(open[0])
    }

    /// A combination under which the whole remaining cone is a solution, if there is one.
    fn filled(&self, node: &SearchNode) -> Option<Vec<usize>> {
        node.chosen
            .iter()
            .zip(self.problem.entities.iter().zip(&self.common))
            .map(|(chosen, (entity, common))| {
                chosen.or_else(|| {
                    entity.options.iter().position(|choice| {
                        choice.zero.iter().all(|form| node.dictionary.vanishes(*form))
                            && choice.nonnegative.iter().all(|signed| common.contains(signed))
                    })
                })
            })
            .collect()
    }
}

/// The largest violation of an option's conditions at a node's point.
fn misfit(dictionary: &Dictionary, choice: &Choice) -> f64 {
    let zero = choice
        .zero
        .iter()
        .map(|form| dictionary.value(crate::complementarity::rates::rate_problem::Signed::plus(*form)).abs());
    let negative = choice.nonnegative.iter().map(|signed| -dictionary.value(*signed));
    zero.chain(negative).fold(0.0, f64::max)
}

/// Whether an option holds on the one remaining line or ray.
fn fits(dictionary: &Dictionary, choice: &Choice) -> bool {
    misfit(dictionary, choice) <= SEARCH_TOLERANCE
        && (!dictionary.is_lines_only() || choice.zero.iter().all(|form| dictionary.vanishes(*form)))
}

/// The node of a task; `None` where only zero remains.
fn decide(problem: &RateProblem, task: Task) -> Option<SearchNode> {
    let parent = &task.parent;
    let mut node = SearchNode {
        chosen: parent.chosen.clone(),
        dictionary: parent.dictionary.clone(),
        sign: parent.sign,
        in_set: parent.in_set,
        last: task.decision.map(|(entity, _)| entity),
    };
    node.dictionary.begin_count();
    let Some((entity, choice)) = task.decision else { return Some(node) };
    node.chosen[entity] = Some(choice);
    let choice = &problem.entities[entity].options[choice];
    for form in &choice.zero {
        if !node.dictionary.make_zero(*form) {
            return None;
        }
    }
    for signed in choice.nonnegative.iter().chain(&choice.implied) {
        node.dictionary.require(Some(signed.form), signed.sign);
    }
    Some(node)
}
