//! Bad input is refused with its place, what was found and what would do; never a panic, a hang or a silent pass.

use crate::common::bad_documents::{bad_documents, full_request, good_request};
use arcslip::check::scenes;
use arcslip::model::{InputError, InputErrors, JobRequest, read};
use proptest::prelude::*;
use serde_json::{Value, json};

#[test]
fn the_requests_that_the_others_spoil_are_accepted() {
    for request in [good_request(), full_request()] {
        let text = serde_json::to_vec(&request).unwrap();
        assert_eq!(read(&text).err().unwrap_or_default().to_string(), "");
    }
}

#[test]
fn bad_documents_are_refused_with_their_place() {
    let documents = bad_documents();
    assert!(documents.len() >= 60, "{}", documents.len());
    let mut names = std::collections::HashSet::new();
    let mut faults = Vec::new();
    for document in documents {
        assert!(names.insert(document.name), "{} stands twice", document.name);
        let errors = read(&document.text).err().unwrap_or_default();
        let named = |error: &InputError| error.pointer == document.pointer && error.detail.contains(document.detail);
        if !errors.0.iter().any(named) {
            faults.push(format!("{}: {:?} {:?}\n{errors}\n", document.name, document.pointer, document.detail));
        }
        assert!(errors.to_string().len() < 100_000, "{}", document.name);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// What a mutation does at one place of a document.
#[derive(Debug, Clone)]
enum Mutation {
    Delete,
    Duplicate,
    Replace(Value),
    Rename(String),
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let values = [
        json!(null),
        json!(true),
        json!(0),
        json!(-1),
        json!(1e-300),
        json!(1e300),
        json!(u64::MAX),
        json!(""),
        json!("tip"),
        json!("x"),
        json!([]),
        json!([0, 0]),
        json!({}),
        json!({"kind": "bar"}),
        json!([[[[]]]]),
    ];
    let replacement = proptest::sample::select(values.to_vec()).prop_map(Mutation::Replace);
    prop_oneof![
        Just(Mutation::Delete),
        Just(Mutation::Duplicate),
        replacement,
        "[a-z/~]{0,4}".prop_map(Mutation::Rename)
    ]
}

/// Number of places below a value, itself not counted.
fn places(value: &Value) -> usize {
    match value {
        Value::Array(items) => items.iter().map(|item| 1 + places(item)).sum(),
        Value::Object(members) => members.values().map(|member| 1 + places(member)).sum(),
        _ => 0,
    }
}

/// Applies the mutation to the place with that number, counted down in the order of the text.
fn mutate(value: &mut Value, place: &mut usize, mutation: &Mutation) -> bool {
    match value {
        Value::Array(items) => {
            for index in 0..items.len() {
                if *place == 0 {
                    match mutation {
                        Mutation::Delete => drop(items.remove(index)),
                        Mutation::Duplicate => items.insert(index, items[index].clone()),
                        Mutation::Replace(value) => items[index] = value.clone(),
                        Mutation::Rename(name) => items[index] = json!(name),
                    }
                    return true;
                }
                *place -= 1;
                if mutate(&mut items[index], place, mutation) {
                    return true;
                }
            }
        }
        Value::Object(members) => {
            let names: Vec<String> = members.keys().cloned().collect();
            for name in names {
                if *place == 0 {
                    let old = members.get(&name).cloned().unwrap_or_default();
                    match mutation {
                        Mutation::Delete => drop(members.shift_remove(&name)),
                        Mutation::Duplicate => drop(members.insert(format!("{name}2"), old)),
                        Mutation::Replace(value) => drop(members.insert(name, value.clone())),
                        Mutation::Rename(new) => {
                            members.shift_remove(&name);
                            members.insert(new.clone(), old);
                        }
                    }
                    return true;
                }
                *place -= 1;
                if mutate(&mut members[&name], place, mutation) {
                    return true;
                }
            }
        }
        _ => {}
    }
    false
}

/// Refusals are never empty, and their pointers lead to a place of the document.
fn judge(outcome: Result<JobRequest, InputErrors>, document: Option<&Value>) -> Result<(), TestCaseError> {
    let Err(errors) = outcome else { return Ok(()) };
    prop_assert!(!errors.0.is_empty());
    for error in &errors.0 {
        prop_assert!(!error.detail.is_empty());
        let found = document.is_none_or(|document| document.pointer(&error.pointer).is_some());
        prop_assert!(found || is_default(&error.pointer), "{error:?} leads nowhere");
        prop_assert!(document.is_some() || error.pointer.is_empty(), "{error:?} in text that is not JSON");
    }
    Ok(())
}

/// A value that was left out and follows others can contradict them.
fn is_default(pointer: &str) -> bool {
    pointer.starts_with("/analysis/arc_length/")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn mutated_scenes_are_taken_or_refused_cleanly(
        scene in 0..=scenes::ALL.len(),
        mutations in proptest::collection::vec((any::<prop::sample::Index>(), mutation()), 1..4),
    ) {
        let mut document: Value = match scenes::ALL.get(scene) {
            Some(scene) => serde_json::from_str(scene.request).unwrap(),
            None => full_request(),
        };
        for (index, mutation) in &mutations {
            let count = places(&document);
            if count > 0 {
                mutate(&mut document, &mut index.index(count), mutation);
            }
        }
        judge(read(&serde_json::to_vec(&document).unwrap()), Some(&document))?;
    }

    #[test]
    fn truncated_and_scrambled_scenes_are_refused_cleanly(
        scene in 0..scenes::ALL.len(),
        cut in any::<prop::sample::Index>(),
        scrambled in proptest::option::of((any::<prop::sample::Index>(), any::<u8>())),
    ) {
        let whole = scenes::ALL[scene].request.trim_end().as_bytes();
        let mut text = whole[..cut.index(whole.len())].to_vec();
        prop_assert!(read(&text).is_err());
        judge(read(&text), None)?;
        text = whole.to_vec();
        if let Some((index, byte)) = scrambled {
            text[index.index(whole.len())] = byte;
        }
        let outcome = read(&text);
        prop_assert!(outcome.as_ref().err().is_none_or(|errors| !errors.0.is_empty()));
    }
}
