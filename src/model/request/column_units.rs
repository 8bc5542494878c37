//! The label of the unit of a column of `path.csv`, where a model names its units.

use crate::model::request::Units;

/// The label of a column's unit, such as `kN m` of a moment; `None` where it has none, or the model does not name it.
pub(crate) fn unit_of(column: &str, units: &Units) -> Option<String> {
    let (length, force) = (units.length.as_deref(), units.force.as_deref());
    let both = |between: &str, after: &str| Some(format!("{}{between}{}{after}", force?, length?));
    let last = column.rsplit('/').next().unwrap_or(column);
    let steps: Vec<&str> = last.split('.').collect();
    let has = |names: &[&str]| steps.iter().any(|step| names.contains(step));
    let what = steps.last().copied().unwrap_or_default();
    let is_turning = ["rx", "ry", "rz"].contains(&what);
    let forces = ["axial_force", "shear_force", "normal_reaction", "tangential_reaction", "reaction", "force"];
    if last.contains("moment")
        || ["external_work", "strain_energy", "dissipated", "released"].contains(&column)
        || has(&["reaction"]) && is_turning
    {
        return both(" ", "");
    }
    if has(&forces) || column.starts_with("applied_force") {
        return force.map(str::to_owned);
    }
    if has(&["stress", "von_mises"]) {
        return both("/", "^2");
    }
    let is_displacement = ["x", "y", "z"].contains(&what) && !column.contains('/');
    let is_length = is_displacement || has(&["gap", "slip", "slip_total"]);
    is_length.then(|| length.map(str::to_owned)).flatten()
}

#[cfg(test)]
mod tests {
    use super::{Units, unit_of};

    #[test]
    fn columns_have_the_labels_of_their_units() {
        let units = Units { length: Some("m".to_owned()), force: Some("kN".to_owned()) };
        for (column, unit) in [
            ("tip.x", Some("m")),
            ("tip.rz", None),
            ("tip/floor.gap", Some("m")),
            ("tip/floor.slip_total.1", Some("m")),
            ("tip/floor.reaction.y", Some("kN")),
            ("tip/floor.status", None),
            ("pin.reaction.x", Some("kN")),
            ("pin.reaction.rz", Some("kN m")),
            ("elements/3.axial_force", Some("kN")),
            ("elements/3.start.bending_moment", Some("kN m")),
            ("elements/3.stress.xx", Some("kN/m^2")),
            ("elements/3.von_mises", Some("kN/m^2")),
            ("applied_force_x", Some("kN")),
            ("dissipated", Some("kN m")),
            ("load_factor", None),
            ("measure.equilibrium", None),
        ] {
            assert_eq!(unit_of(column, &units).as_deref(), unit, "{column}");
        }
        assert_eq!(unit_of("dissipated", &Units { length: None, ..units }), None);
    }
}
