//! The mistakes in the runs of a sweep, and what may be one; what several runs share is reported once.

use crate::model::input::limits::MAX_LISTED_MISTAKES;
use crate::model::{InputError, InputErrors, Sweep};
use crate::result::plan::Warning;

/// Mistakes in the checked runs, as mistakes in the sweep.
#[derive(Debug, Default)]
pub struct RunMistakes {
    checked: u64,
    told: Vec<Told>,
    warned: Vec<Told>,
}

#[derive(Debug)]
struct Told {
    error: InputError,
    /// The first run with the mistake.
    first: u64,
    runs: u64,
}

impl RunMistakes {
    /// Notes the result of checking a run; runs come in order.
    pub fn note(&mut self, run: u64, mistakes: Option<InputErrors>) {
        self.checked += 1;
        for error in mistakes.into_iter().flat_map(|errors| errors.0) {
            note(&mut self.told, run, error);
        }
    }

    /// Notes the warnings of a checked run.
    pub fn warn(&mut self, sweep: &Sweep, run: u64, warnings: Vec<Warning>) {
        let errors = warnings.into_iter().map(|Warning { pointer, detail }| InputError::new(pointer, detail)).collect();
        for warning in sweep.located(run, InputErrors(errors)).0 {
            note(&mut self.warned, run, warning);
        }
    }

    /// Whether as many mistakes have been found as are reported, so that further runs need not be checked.
    pub fn are_enough(&self) -> bool {
        self.told.len() >= MAX_LISTED_MISTAKES
    }

    /// The warnings of the runs. A mistake or a warning that only some runs have and that is not at a varied value names the run.
    ///
    /// # Errors
    /// All mistakes in the runs of the sweep, where there are any.
    pub fn result(self, sweep: &Sweep) -> Result<Vec<Warning>, InputErrors> {
        let Self { checked, told, warned } = self;
        let told = of_runs(told, checked, sweep);
        if told.is_empty() {
            let warning = |InputError { pointer, detail }| Warning { pointer, detail };
            Ok(of_runs(warned, checked, sweep).into_iter().map(warning).collect())
        } else {
            Err(InputErrors(told))
        }
    }
}

fn note(told: &mut Vec<Told>, run: u64, error: InputError) {
    if let Some(told) = told.iter_mut().find(|told| told.error == error) {
        told.runs += 1;
    } else if told.len() < MAX_LISTED_MISTAKES {
        told.push(Told { error, first: run, runs: 1 });
    }
}

/// What is told of `checked` runs, with the run where only some have it.
fn of_runs(told: Vec<Told>, checked: u64, sweep: &Sweep) -> Vec<InputError> {
    let located = told.into_iter().map(|Told { error, first, runs }| {
        // At a varied value, or in all runs.
        if runs == sweep.runs_at(&error.pointer, checked).unwrap_or(checked) {
            return error;
        }
        let values = sweep.variation.parameters.iter().zip(sweep.variation.values(first));
        let values: Vec<String> = values.map(|(parameter, value)| format!("{} = {value}", parameter.pointer)).collect();
        let detail =
            format!("{} (so it is in {runs} of {checked} runs; the first has {})", error.detail, values.join(", "));
        InputError::new(error.pointer, detail)
    });
    located.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::scenes;
    use serde_json::{Value, json};

    #[test]
    fn a_mistake_of_some_runs_says_of_which() {
        let mut document: Value = serde_json::from_str(scenes::find("one-bar-truss").unwrap().request).unwrap();
        document["sweep"] = json!({"replace": {"/analysis/max_modes": [5, 6, 7]}});
        let sweep = Sweep::read(document.to_string().as_bytes()).unwrap();
        let mistake = |pointer: &str| Some(InputErrors(vec![InputError::new(pointer, "wrong")]));
        let mut mistakes = RunMistakes::default();
        mistakes.note(0, None);
        mistakes.note(1, mistake("/model/nodes"));
        mistakes.note(2, mistake("/model/nodes"));
        let told = mistakes.result(&sweep).unwrap_err().0;
        assert_eq!(told.len(), 1);
        assert_eq!(told[0].detail, "wrong (so it is in 2 of 3 runs; the first has /analysis/max_modes = 6)");
        // Of a value that is wrong by itself, and of one that is wrong beside some others.
        document["sweep"] = json!({"replace": {"/analysis/max_modes": [5, 0], "/analysis/arc_length/max": [1, 0.01]}});
        let grid = Sweep::read(document.to_string().as_bytes()).unwrap();
        let at = "/sweep/replace/~1analysis~1max_modes/1";
        let told = |wrong: &[u64]| {
            let mut mistakes = RunMistakes::default();
            (0..4).for_each(|run| mistakes.note(run, mistake(at).filter(|_| wrong.contains(&run))));
            mistakes.result(&grid).unwrap_err().0.remove(0).detail
        };
        assert_eq!(told(&[2, 3]), "wrong");
        let expected =
            "wrong (so it is in 1 of 4 runs; the first has /analysis/max_modes = 0, /analysis/arc_length/max = 0.01)";
        assert_eq!(told(&[3]), expected);
        let mut all = RunMistakes::default();
        (0..3).for_each(|run| all.note(run, mistake("/model/nodes")));
        assert_eq!(all.result(&sweep).unwrap_err().0[0].detail, "wrong");
        assert!(RunMistakes::default().result(&sweep).is_ok());
        let mut warned = RunMistakes::default();
        let warning = |pointer: &str| vec![Warning { pointer: pointer.to_owned(), detail: "odd".to_owned() }];
        (0..3).for_each(|run| warned.note(run, None));
        warned.warn(&sweep, 1, warning("/analysis/max_modes"));
        warned.warn(&sweep, 2, warning("/model/nodes"));
        let told: Vec<String> =
            warned.result(&sweep).unwrap().iter().map(|told| format!("{}: {}", told.pointer, told.detail)).collect();
        let expected = [
            "/sweep/replace/~1analysis~1max_modes/1: analysis.max_modes: odd",
            "/model/nodes: odd (so it is in 1 of 3 runs; the first has /analysis/max_modes = 7)",
        ];
        assert_eq!(told, expected);
    }
}
