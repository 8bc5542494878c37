//! Bearer tokens (RFC 6750): read from a file that holds their hashes, never the tokens themselves.
//!
//! One line per token: `NAME SCOPES SHA-256`, such as `ann read,submit 9f86d0…`; empty lines and text after `#` are
//! ignored. A token has 256 random bits, so that its plain hash cannot be inverted. A name may have several lines: in this
//! way a token is replaced without interruption.

use sha2::{Digest, Sha256};
use std::fmt::{self, Write};
use std::path::Path;
use subtle::ConstantTimeEq;

/// The prefix of all tokens, by which readers and secret scanners recognise them.
const PREFIX: &str = "arcslip_";
const RANDOM_BYTES: usize = 32;
const HASH_BYTES: usize = 32;
/// Longer tokens (bytes) cannot be valid and are not hashed.
const LONGEST: usize = 512;
const LONGEST_NAME: usize = 64;

/// What the bearer of a token may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// Read its own jobs and studies, scenes and metrics.
    Read,
    /// Queue, follow, cancel and delete its own jobs and studies.
    Submit,
    /// All of this for the jobs and studies of every owner.
    Admin,
}

impl Scope {
    pub const ALL: [Self; 3] = [Self::Read, Self::Submit, Self::Admin];

    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Submit => "submit",
            Self::Admin => "admin",
        }
    }

    fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scope| scope.name() == name)
    }
}

/// Scopes of one token.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scopes(Vec<Scope>);

impl Scopes {
    /// Reads a list of scopes such as `read,submit`.
    ///
    /// # Errors
    /// An unknown scope, which the error names.
    pub fn read(text: &str) -> Result<Self, String> {
        let scope = |name: &str| {
            Scope::from_name(name)
                .ok_or_else(|| format!("{name:?} is no scope; the scopes are `read`, `submit` and `admin`"))
        };
        text.split(',').map(scope).collect::<Result<_, _>>().map(Self)
    }

    pub fn allow(&self, asked: Scope) -> bool {
        self.0.contains(&asked) || self.0.contains(&Scope::Admin)
    }
}

impl fmt::Display for Scopes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = self.0.iter().map(|scope| scope.name()).collect();
        f.write_str(&names.join(","))
    }
}

/// A token as it is listed in the file.
#[derive(Debug)]
pub struct Token {
    /// The name of the bearer, who owns the jobs posted with the token.
    pub name: String,
    pub scopes: Scopes,
    hash: [u8; HASH_BYTES],
}

/// All valid tokens.
#[derive(Debug)]
pub struct Tokens(Vec<Token>);

#[derive(Debug, thiserror::Error)]
pub enum TokensError {
    #[error("{file}: {error}")]
    File { file: String, error: std::io::Error },
    #[error("{file}, line {line}: {detail}")]
    Line { file: String, line: usize, detail: String },
    #[error("{file}: there is no token in it; `arcslip token NAME >> {file}` makes one")]
    None { file: String },
}

impl Tokens {
    /// # Errors
    /// The file cannot be read, has no token, or has a line that is no token.
    pub fn of_file(file: &Path) -> Result<Self, TokensError> {
        let name = file.display().to_string();
        match std::fs::read_to_string(file) {
            Ok(text) => Self::of_text(&name, &text),
            Err(error) => Err(TokensError::File { file: name, error }),
        }
    }

    /// `file` is named in errors.
    pub fn of_text(file: &str, text: &str) -> Result<Self, TokensError> {
        let mut tokens = Vec::new();
        // Some editors begin a file with a byte order mark.
        for (number, line) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
            let fields: Vec<&str> = line.split('#').next().unwrap_or_default().split_whitespace().collect();
            if fields.is_empty() {
                continue;
            }
            let wrong = |detail| TokensError::Line { file: file.to_owned(), line: number, detail };
            tokens.push(token(&fields).map_err(wrong)?);
        }
        if tokens.is_empty() {
            return Err(TokensError::None { file: file.to_owned() });
        }
        Ok(Self(tokens))
    }

    /// The entry of a presented token. Every hash is compared, in a time that does not depend on how many bytes agree.
    pub fn find(&self, shown: &str) -> Option<&Token> {
        if shown.len() > LONGEST {
            return None;
        }
        let hash = Sha256::digest(shown.as_bytes());
        let mut found = None;
        for token in &self.0 {
            if bool::from(token.hash.as_slice().ct_eq(hash.as_slice())) {
                found = Some(token);
            }
        }
        found
    }
}

fn token(fields: &[&str]) -> Result<Token, String> {
    let [name, scopes, hash] = fields else {
        return Err(format!("{} words; `NAME SCOPES SHA-256` is expected", fields.len()));
    };
    check_name(name)?;
    let hash = unhexed(hash).ok_or(
        "the third word has to be the SHA-256 of a token, 64 hexadecimal digits (never the token itself): \
         `arcslip token NAME` makes both",
    )?;
    Ok(Token { name: (*name).to_owned(), scopes: Scopes::read(scopes)?, hash })
}

/// # Errors
/// What is expected instead.
pub fn check_name(name: &str) -> Result<(), String> {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'_' | b'-');
    if (1..=LONGEST_NAME).contains(&name.len()) && name.bytes().all(plain) {
        return Ok(());
    }
    Err(format!("{name:?} is no name: 1 to {LONGEST_NAME} letters, digits, dots, dashes and underscores are expected"))
}

/// A new token and its hash as it is listed in the file.
///
/// # Errors
/// The system provides no random numbers.
pub fn make() -> Result<(String, String), getrandom::Error> {
    let mut random = [0; RANDOM_BYTES];
    getrandom::fill(&mut random)?;
    let token = format!("{PREFIX}{}", hexed(&random));
    let hash = hexed(&Sha256::digest(token.as_bytes()));
    Ok((token, hash))
}

fn hexed(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a string does not fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

fn unhexed(text: &str) -> Option<[u8; HASH_BYTES]> {
    if text.len() != 2 * HASH_BYTES || !text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let mut bytes = [0; HASH_BYTES];
    for (place, byte) in bytes.iter_mut().enumerate() {
        *byte = u8::from_str_radix(&text[2 * place..2 * place + 2], 16).ok()?;
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_made_token_is_found_by_its_hash_and_no_other_is() {
        let (token, hash) = make().unwrap();
        let text = format!("# who may\n\nann read,submit {hash} # since spring\nops admin {}\n", "0".repeat(64));
        let tokens = Tokens::of_text("tokens", &text).unwrap();
        let found = tokens.find(&token).unwrap();
        assert_eq!(found.name, "ann");
        assert!(found.scopes.allow(Scope::Read) && found.scopes.allow(Scope::Submit));
        assert!(!found.scopes.allow(Scope::Admin));
        assert!(tokens.0[1].scopes.allow(Scope::Submit), "admin may all");
        for other in ["", &hash, &token[1..], &make().unwrap().0, &"x".repeat(10_000)] {
            assert!(tokens.find(other).is_none(), "{other}");
        }
        assert_ne!(make().unwrap().0, make().unwrap().0);
    }

    #[test]
    fn hashes_are_those_of_sha_256() {
        // FIPS 180-4's example for "abc".
        let text = "\u{feff}ann read ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert!(Tokens::of_text("tokens", text).unwrap().find("abc").is_some());
    }

    #[test]
    fn a_line_that_is_no_token_is_told_with_its_place() {
        let hash = "0".repeat(64);
        for (text, told) in [
            (format!("ann read {hash}\nbob rad {hash}"), "tokens, line 2: \"rad\" is no scope"),
            ("ann read secret".to_owned(), "64 hexadecimal digits"),
            (format!("ann read {}é{}", "0".repeat(31), "0".repeat(31)), "64 hexadecimal digits"),
            (format!("ann {hash}"), "2 words"),
            (format!("a/b read {hash}"), "is no name"),
            (format!("ann read, {hash}"), "\"\" is no scope"),
            (" # nothing\n".to_owned(), "there is no token"),
        ] {
            let refused = Tokens::of_text("tokens", &text).unwrap_err().to_string();
            assert!(refused.contains(told), "{refused}");
        }
    }
}
