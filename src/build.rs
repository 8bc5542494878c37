//! Tells the program the commit that it is built from (`ARCSLIP_COMMIT`), and prepares the manual for the crate's
//! documentation.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

const MANUAL: &str = "src/manual";
/// Characters of a commit's name that are shown.
const SHOWN: usize = 12;

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=src/build.rs");
    println!("cargo::rerun-if-changed={MANUAL}");
    println!("cargo::rerun-if-env-changed=ARCSLIP_COMMIT");
    println!("cargo::rustc-env=ARCSLIP_COMMIT={}", commit().unwrap_or_else(|| "unknown commit".to_owned()));
    let target = PathBuf::from(env::var_os("OUT_DIR").expect("Cargo sets it")).join("manual");
    fs::create_dir_all(&target)?;
    for entry in fs::read_dir(MANUAL)? {
        let path = entry?.path();
        if let (Some("md"), Some(name)) = (path.extension().and_then(|ending| ending.to_str()), path.file_name()) {
            fs::write(target.join(name), for_rustdoc(&fs::read_to_string(&path)?))?;
        }
    }
    Ok(())
}

/// From the environment, as where the sources come without their repository; else from the repository.
fn commit() -> Option<String> {
    let given = env::var("ARCSLIP_COMMIT").ok().filter(|given| !given.is_empty());
    // A development build is not made anew after every commit.
    let is_release = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let commit = match given {
        Some(given) => given,
        None if is_release => checked_out(Path::new(".git"))?,
        None => return Some("development build".to_owned()),
    };
    Some(commit.trim().chars().take(SHOWN).collect())
}

/// The commit that is checked out in a repository; the build script runs again when another one is.
fn checked_out(place: &Path) -> Option<String> {
    // In a further work tree `.git` is a file that names the folder, and that names the folder of all work trees.
    let own = match fs::read_to_string(place) {
        Ok(text) => PathBuf::from(text.strip_prefix("gitdir:")?.trim()),
        Err(_) => place.to_owned(),
    };
    let head = fs::read_to_string(watched(own.join("HEAD"))?).ok()?;
    let Some(name) = head.strip_prefix("ref:").map(str::trim) else { return Some(head) };
    let common = fs::read_to_string(own.join("commondir")).map_or(own.clone(), |text| own.join(text.trim()));
    if let Some(loose) = watched(common.join(name)) {
        return fs::read_to_string(loose).ok();
    }
    let packed = fs::read_to_string(watched(common.join("packed-refs"))?).ok()?;
    // The next commit makes a file of its own for the branch.
    watched(common.join(name).parent()?.to_owned());
    packed.lines().find_map(|line| line.strip_suffix(name)?.strip_suffix(' ').map(str::to_owned))
}

/// The file, if it is there; the build script runs again when it changes.
fn watched(path: PathBuf) -> Option<PathBuf> {
    let path = path.exists().then_some(path)?;
    println!("cargo::rerun-if-changed={}", path.display());
    Some(path)
}

/// A chapter whose links lead to the modules of the other chapters, whose pictures, which are not part of the crate's
/// documentation, are named, and whose blocks have no marks but their language.
fn for_rustdoc(text: &str) -> String {
    let mut lines = Vec::new();
    let mut is_code = false;
    for line in text.lines() {
        let is_fence = line.starts_with("```");
        lines.push(match line.strip_prefix("![").and_then(|rest| rest.split_once("](")) {
            _ if is_fence => line.split(' ').next().unwrap_or_default().to_owned(),
            _ if is_code => line.to_owned(),
            Some((words, _)) => format!("*Picture: {words}*"),
            None => with_links(line),
        });
        is_code ^= is_fence;
    }
    lines.join("\n") + "\n"
}

fn with_links(line: &str) -> String {
    let mut parts = line.split("](");
    let mut made = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        made.push_str("](");
        let chapter = part.split_once(".md").filter(|(name, rest)| {
            rest.starts_with([')', '#']) && name.chars().all(|letter| letter.is_ascii_lowercase() || letter == '_')
        });
        match chapter {
            Some((name, rest)) => made.extend(["../", name, "/index.html", rest]),
            None => made.push_str(part),
        }
    }
    made
}
