//! Parses sizes in bytes on the command line.

/// `1048576`, `1024KiB`, `1MiB`, `1GiB`.
pub(crate) fn bytes(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|letter: char| !letter.is_ascii_digit());
    let unit = match text[digits.len()..].trim() {
        "" | "B" => 1,
        "KiB" => 1_u64 << 10,
        "MiB" => 1 << 20,
        "GiB" => 1 << 30,
        "TiB" => 1 << 40,
        other => return Err(format!("{other:?} is no unit; the units are B, KiB, MiB, GiB and TiB")),
    };
    let found = digits.parse::<u64>().ok().and_then(|number| number.checked_mul(unit)).filter(|found| *found > 0);
    found.ok_or_else(|| format!("{text:?} is no size; examples are 1048576, 512MiB and 8GiB"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read() {
        for (text, size) in [("1", 1), ("10B", 10), ("2KiB", 2048), ("512 MiB", 512 << 20), ("8GiB", 8 << 30)] {
            assert_eq!(bytes(text), Ok(size), "{text}");
        }
        for refused in ["", "0", "-1", "1MB", "GiB", "1.5GiB", "99999999999TiB"] {
            assert!(bytes(refused).is_err(), "{refused}");
        }
    }
}
