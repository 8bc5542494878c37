//! Names in error messages: shortened, listed, and the nearest known one to an unknown one.

/// The most names listed in a message; the others are counted.
const LISTED: usize = 12;
/// The most candidates that are compared, and their longest names: the time of a comparison grows with the product of the
/// lengths, and a malicious document has many long names.
const COMPARED: usize = 2_000;
const COMPARED_CHARACTERS: usize = 32;
/// At most one letter in two may differ.
const LIKENESS: f64 = 0.5;
/// The most characters of a text that are shown.
const SHOWN: usize = 60;

/// The text in quotes, cut where it is long, control characters escaped.
pub(crate) fn quoted(text: &str) -> String {
    let mut shown: String = text.chars().take(SHOWN).flat_map(char::escape_debug).collect();
    if text.chars().nth(SHOWN).is_some() {
        shown.push('…');
    }
    format!("`{shown}`")
}

/// `; did you mean `tip`? Known: `pin`, `tip``, or what there is to say of that.
pub(crate) fn suggestion<'a>(unknown: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    suggestion_among(unknown, known, LISTED)
}

/// The same with all names, for lists of the program itself.
#[cfg(feature = "server")]
pub(crate) fn suggestion_of_all<'a>(unknown: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    suggestion_among(unknown, known, usize::MAX)
}

fn suggestion_among<'a>(unknown: &str, known: impl Iterator<Item = &'a str> + Clone, most: usize) -> String {
    let known_list = listed_up_to(known.clone(), most);
    match synonym(unknown, known.clone()).or_else(|| nearest(unknown, known)) {
        Some(name) => format!("; did you mean {}? Known: {known_list}", quoted(name)),
        None => format!("; known: {known_list}"),
    }
}

/// The names in quotes with commas between; `none` where there are none.
pub(crate) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    listed_up_to(names, LISTED)
}

fn listed_up_to<'a>(names: impl Iterator<Item = &'a str>, most: usize) -> String {
    let mut shown = Vec::new();
    let mut more = 0;
    for name in names {
        if shown.len() < most {
            shown.push(quoted(name));
        } else {
            more += 1;
        }
    }
    match (shown.is_empty(), more) {
        (true, _) => "none".to_owned(),
        (false, 0) => shown.join(", "),
        (false, more) => format!("{} and {more} more", shown.join(", ")),
    }
}

/// Words of other programs and books, and the names that they have here.
const SYNONYMS: [(&str, &str); 14] = [
    ("mu", "friction"),
    ("coefficient", "friction"),
    ("friction_coefficient", "friction"),
    ("type", "kind"),
    ("ea", "axial_stiffness"),
    ("axial_rigidity", "axial_stiffness"),
    ("k", "stiffness"),
    ("truss", "bar"),
    ("rod", "bar"),
    ("sphere", "ball"),
    ("circle", "ball"),
    ("fixed", "supports"),
    ("constraints", "supports"),
    ("loads", "forces"),
];

/// The known name for which another program or book has this word.
fn synonym<'a>(unknown: &str, mut known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let (_, name) = SYNONYMS.iter().find(|(word, _)| unknown.eq_ignore_ascii_case(word))?;
    known.find(|known| known == name)
}

/// The most similar name, ignoring case, the first among equals; `None` if no name is similar.
pub(crate) fn nearest<'a>(unknown: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let short = |text: &str| text.chars().nth(COMPARED_CHARACTERS).is_none();
    if !short(unknown) {
        return None;
    }
    let unknown = unknown.to_lowercase();
    let mut best: Option<(&str, f64)> = None;
    for name in known.take(COMPARED).filter(|name| short(name)) {
        let likeness = strsim::normalized_damerau_levenshtein(&unknown, &name.to_lowercase());
        if likeness >= LIKENESS && best.is_none_or(|(_, found)| likeness > found) {
            best = Some((name, likeness));
        }
    }
    best.map(|(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_suggested() {
        let known = ["ball", "plane", "box"];
        assert_eq!(nearest("plain", known.into_iter()), Some("plane"));
        assert_eq!(nearest("PLANE", known.into_iter()), Some("plane"));
        assert_eq!(nearest("wedge", known.into_iter()), None);
        assert_eq!(suggestion("x", [].into_iter()), "; known: none");
        let fields = ["node", "obstacle", "friction"];
        assert!(suggestion("mu", fields.into_iter()).starts_with("; did you mean `friction`?"));
        assert!(suggestion("Mu", known.into_iter()).starts_with("; known: "));
    }

    #[test]
    fn long_texts_are_cut_and_control_characters_escaped() {
        assert_eq!(quoted("a\nb"), "`a\\nb`");
        assert!(quoted(&"long".repeat(1000)).chars().count() < SHOWN + 4);
        let many: Vec<String> = (0..100).map(|index| format!("n{index}")).collect();
        assert!(listed(many.iter().map(String::as_str)).ends_with("and 88 more"));
    }
}
