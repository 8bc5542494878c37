//! The location of a database: a file, or a PostgreSQL server. It is displayed without the password.

use std::convert::Infallible;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

const SCHEMES: [&str; 2] = ["postgres://", "postgresql://"];

/// The location as given by `--database`.
#[derive(Clone, PartialEq, Eq)]
pub enum Location {
    File(PathBuf),
    Postgres(Url),
}

/// A URL that may hold a password; it is parsed when the database is opened, so that no error message repeats it.
#[derive(Clone, PartialEq, Eq)]
pub struct Url(String);

impl Url {
    pub(crate) fn with_password(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Location {
    fn from(text: &str) -> Self {
        if SCHEMES.iter().any(|scheme| text.starts_with(scheme)) {
            Self::Postgres(Url(text.to_owned()))
        } else {
            Self::File(text.into())
        }
    }
}

impl FromStr for Location {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(text.into())
    }
}

impl From<&Path> for Location {
    fn from(path: &Path) -> Self {
        match path.to_str() {
            Some(text) => text.into(),
            None => Self::File(path.to_owned()),
        }
    }
}

impl From<&PathBuf> for Location {
    fn from(path: &PathBuf) -> Self {
        path.as_path().into()
    }
}

impl fmt::Display for Location {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(file) => file.display().fmt(formatter),
            Self::Postgres(url) => url.fmt(formatter),
        }
    }
}

impl fmt::Debug for Location {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, formatter)
    }
}

impl fmt::Display for Url {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (scheme, rest) = self.0.split_once("://").unwrap_or_default();
        match public(rest) {
            Some(("", place)) => write!(formatter, "{scheme}://{place}"),
            Some((user, place)) => write!(formatter, "{scheme}://{user}@{place}"),
            None => write!(formatter, "{scheme}://..."),
        }
    }
}

/// User, host and database of a URL; `None` if they cannot be separated from a malformed password.
fn public(rest: &str) -> Option<(&str, &str)> {
    let (authority, after) = rest.split_at(rest.find(['/', '?', '#']).unwrap_or(rest.len()));
    let (user, host) = authority.split_once('@').unwrap_or(("", authority));
    let port = host.rsplit_once(':').map_or("", |(_, port)| port.trim_end_matches(']'));
    let is_whole = !host.contains('@') && !after.contains('@') && port.chars().all(|one| one.is_ascii_hexdigit());
    let name = user.split_once(':').map_or(user, |(name, _)| name);
    let from = rest.len() - after.len() - host.len();
    let to = rest.find(['?', '#']).unwrap_or(rest.len());
    is_whole.then(|| (name, &rest[from..to]))
}

impl fmt::Debug for Url {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, formatter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_is_never_shown() {
        for (text, shown) in [
            ("postgres://anna:secret@db.example:5433/arcslip", "postgres://anna@db.example:5433/arcslip"),
            ("postgresql://anna:se/c@r:et@db.example/arcslip", "postgresql://..."),
            ("postgresql://anna:se@c:ret@db.example/arcslip", "postgresql://..."),
            ("postgres://anna:secret/more", "postgres://..."),
            ("postgres://db.example/arcslip?user=anna&password=secret", "postgres://db.example/arcslip"),
            ("postgres://db.example/arcslip?password=sec@ret", "postgres://..."),
            ("postgres://anna:s?ecret@db.example/arcslip", "postgres://..."),
            ("postgres://anna:secret@[::1]:5432/arcslip", "postgres://anna@[::1]:5432/arcslip"),
            ("postgres:///arcslip", "postgres:///arcslip"),
        ] {
            let location = Location::from(text);
            assert_eq!((location.to_string(), format!("{location:?}")), (shown.to_owned(), shown.to_owned()));
        }
    }

    #[test]
    fn what_is_no_url_of_postgresql_is_a_file() {
        for text in ["arcslip.db", "postgres.db", "/var/lib/postgres:/x", "file://x"] {
            assert_eq!(Location::from(text), Location::File(text.into()));
        }
    }
}
