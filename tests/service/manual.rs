//! The manual as it is served.

use crate::common::server::TestServer;
use arcslip::manual::CHAPTERS;
use arcslip::service::jobs::PathSolver;
use reqwest::{Method, StatusCode};
use std::path::Path;

async fn server() -> (tempfile::TempDir, TestServer) {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    (folder, server)
}

/// The values of an attribute in a page.
fn values(page: &str, attribute: &str) -> Vec<String> {
    let before = format!(" {attribute}=\"");
    page.split(&before).skip(1).filter_map(|rest| rest.split('"').next()).map(str::to_owned).collect()
}

#[test]
fn every_chapter_of_the_folder_is_listed_by_its_title() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/manual");
    let files = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").file_name());
    let mut files: Vec<_> = files.map(|name| name.into_string().expect("text")).collect();
    let mut listed: Vec<_> = CHAPTERS.iter().map(|chapter| format!("{}.md", chapter.name)).collect();
    files.sort();
    listed.sort();
    assert_eq!(files, listed);
    for chapter in CHAPTERS {
        assert_eq!(chapter.text.lines().next(), Some(&*format!("# {}", chapter.title)), "{}", chapter.name);
    }
}

#[tokio::test]
async fn every_page_is_served_and_all_that_it_links_to() {
    let (_folder, server) = server().await;
    let mut pages = vec![("/manual".to_owned(), String::new())];
    pages.extend(CHAPTERS.iter().map(|chapter| (format!("/manual/{}", chapter.name), String::new())));
    for (address, page) in &mut pages {
        let answer = server.get(address).await;
        assert_eq!(answer.status(), StatusCode::OK, "{address}");
        assert_eq!(answer.headers()["content-type"], "text/html; charset=utf-8", "{address}");
        let policy = answer.headers()["content-security-policy"].to_str().expect("text");
        assert!(policy.contains("default-src 'self'"), "{policy}");
        let tag = answer.headers()["etag"].to_str().expect("text").to_owned();
        let known = server.ask(Method::GET, address).header("if-none-match", tag).send().await.expect("an answer");
        assert_eq!(known.status(), StatusCode::NOT_MODIFIED, "{address}");
        *page = answer.text().await.expect("a page");
        assert!(!page.contains("<script"), "{address}");
        for chapter in CHAPTERS {
            assert!(page.contains(&format!("<a href=\"/manual/{}\"", chapter.name)), "{address}: {}", chapter.name);
        }
    }
    for (address, page) in &pages {
        for link in values(page, "href").iter().chain(&values(page, "src")) {
            let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
            let path = if path.is_empty() { address } else { path };
            if let Some((_, other)) = pages.iter().find(|(address, _)| address == path) {
                assert!(anchor.is_empty() || values(other, "id").iter().any(|id| id == anchor), "{address}: {link}");
            } else if path.starts_with('/') {
                let answer = server.get(path).await;
                assert_eq!(answer.status(), StatusCode::OK, "{address}: {link}");
            } else {
                assert!(path.starts_with("http"), "{address}: {link}");
            }
        }
    }
    assert_eq!(server.get("/manual/").await.text().await.expect("a page"), pages[0].1);
}

#[tokio::test]
async fn style_and_pictures_are_served_with_their_types() {
    let (_folder, server) = server().await;
    for (name, expected) in [
        ("style.css", "text/css; charset=utf-8"),
        ("pictures/one-bar-truss.svg", "image/svg+xml"),
        ("pictures/branch.png", "image/png"),
    ] {
        let answer = server.get(&format!("/manual/{name}")).await;
        assert_eq!(answer.status(), StatusCode::OK, "{name}");
        assert_eq!(answer.headers()["content-type"], expected, "{name}");
        assert!(answer.headers().contains_key("etag"), "{name}");
    }
    for nothing in ["nothing", "model.md", "pictures/nothing.svg", "pictures/..%2fmod.rs", "model/", "pictures"] {
        let answer = server.get(&format!("/manual/{nothing}")).await;
        assert_eq!(answer.status(), StatusCode::NOT_FOUND, "{nothing}");
        assert_eq!(answer.headers()["content-type"], "application/problem+json", "{nothing}");
    }
}

#[tokio::test]
async fn the_dashboard_and_the_description_link_to_it() {
    let (_folder, server) = server().await;
    let index = server.get("/").await.text().await.expect("a page");
    assert!(index.contains("<a href=\"/manual\">"), "{index}");
    assert_eq!(server.get_json("/openapi.json").await["externalDocs"]["url"], "/manual");
}
