//! HTML of the manual: a chapter's text from its Markdown, and the page around it.

use crate::manual::Chapter;
use pulldown_cmark::{CodeBlockKind, CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A chapter as HTML.
pub struct Rendered {
    html: String,
    /// The first paragraph.
    lead: String,
    sections: Vec<Section>,
}

/// A heading of the second level.
struct Section {
    anchor: String,
    title: String,
}

pub fn rendered(text: &str) -> Rendered {
    let mut events: Vec<Event> = Parser::new_ext(text, Options::ENABLE_TABLES).collect();
    let sections = name_headings(&mut events);
    let events: Vec<Event> = events.into_iter().map(with_page_links).collect();
    let is_in_lead = |event: &&Event| !matches!(event, Event::End(TagEnd::Paragraph));
    let begin = events.iter().position(|event| matches!(event, Event::Start(Tag::Paragraph)));
    let lead = begin.map(|begin| events[begin + 1..].iter().take_while(is_in_lead).cloned());
    Rendered {
        lead: lead.map(|events| written(events.collect())).unwrap_or_default(),
        html: written(events.into_iter().flat_map(with_frames).collect()),
        sections,
    }
}

fn written(events: Vec<Event>) -> String {
    let mut text = String::new();
    html::push_html(&mut text, events.into_iter());
    text
}

/// Gives each heading an anchor, as GitHub does; answers those of the second level.
fn name_headings(events: &mut [Event]) -> Vec<Section> {
    let mut sections = Vec::new();
    let mut seen = BTreeMap::new();
    for begin in 0..events.len() {
        let Event::Start(Tag::Heading { level, .. }) = events[begin] else { continue };
        let within = |event: &&Event| !matches!(event, Event::End(TagEnd::Heading(_)));
        let words = events[begin + 1..].iter().take_while(within).filter_map(|event| match event {
            Event::Text(text) | Event::Code(text) => Some(&**text),
            _ => None,
        });
        let title: String = words.collect();
        let count: &mut usize = seen.entry(anchor(&title)).or_default();
        let name = if *count == 0 { anchor(&title) } else { format!("{}-{count}", anchor(&title)) };
        *count += 1;
        if let Event::Start(Tag::Heading { id, .. }) = &mut events[begin] {
            *id = Some(CowStr::from(name.clone()));
        }
        if level == HeadingLevel::H2 {
            sections.push(Section { anchor: name, title });
        }
    }
    sections
}

/// The anchor of a heading as GitHub names it, but for a number where several have the same words.
fn anchor(title: &str) -> String {
    let kept = title.chars().filter(|letter| letter.is_alphanumeric() || matches!(letter, ' ' | '-' | '_'));
    kept.flat_map(char::to_lowercase).map(|letter| if letter == ' ' { '-' } else { letter }).collect()
}

/// Links between files of the repository lead to the pages and pictures that are served.
fn with_page_links(event: Event) -> Event {
    let last = |place: &str| place.rsplit('/').next().unwrap_or_default().to_owned();
    match event {
        Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
            let (path, anchor) =
                dest_url.split_once('#').map_or((&*dest_url, None), |(path, anchor)| (path, Some(anchor)));
            let dest_url = match (path.strip_suffix(".md"), anchor) {
                _ if path.contains(':') => dest_url,
                // The README is the page before the manual.
                (Some(name), _) if last(name) == "README" => "/manual".into(),
                (Some(name), Some(anchor)) => format!("/manual/{}#{anchor}", last(name)).into(),
                (Some(name), None) => format!("/manual/{}", last(name)).into(),
                (None, _) => dest_url,
            };
            Event::Start(Tag::Link { link_type, dest_url, title, id })
        }
        Event::Start(Tag::Image { link_type, dest_url, title, id }) => {
            let dest_url = format!("/manual/pictures/{}", last(&dest_url)).into();
            Event::Start(Tag::Image { link_type, dest_url, title, id })
        }
        event => event,
    }
}

/// What is wider than the page scrolls, by keyboard as well; a heading links to itself.
fn with_frames(event: Event) -> Vec<Event> {
    let tags = |text: &str| Event::Html(CowStr::from(text.to_owned()));
    match event {
        Event::Start(Tag::Table(_)) => vec![tags("<div class=\"wide\" tabindex=\"0\">"), event],
        Event::End(TagEnd::Table) => vec![event, tags("</div>\n")],
        Event::Start(Tag::CodeBlock(kind)) => {
            let language = match &kind {
                CodeBlockKind::Fenced(mark) => mark.split(' ').next().unwrap_or_default().to_owned(),
                CodeBlockKind::Indented => String::new(),
            };
            vec![tags(&format!("<pre tabindex=\"0\"><code class=\"language-{}\">", escaped(&language)))]
        }
        Event::End(TagEnd::CodeBlock) => vec![tags("</code></pre>\n")],
        Event::Start(Tag::Heading { level, id: Some(ref id), .. }) if level != HeadingLevel::H1 => {
            let link = tags(&format!("<a class=\"anchor\" href=\"#{id}\" aria-label=\"Link to this section\">#</a>"));
            vec![event, link]
        }
        event => vec![event],
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The page of the chapter at this place, or of the contents.
pub fn page(chapters: &[(&Chapter, Rendered)], place: Option<usize>) -> String {
    let shown = place.map(|place| &chapters[place]);
    let title = shown.map_or_else(|| "Manual".to_owned(), |(chapter, _)| escaped(chapter.title));
    let body = match (shown, place) {
        (Some((_, rendered)), Some(place)) => format!("{}{}", rendered.html, neighbours(chapters, place)),
        _ => contents(chapters),
    };
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title} – arcslip</title>\n\
         <link rel=\"icon\" href=\"/assets/icon.svg\">\n<link rel=\"stylesheet\" href=\"/manual/style.css\">\n</head>\n\
         <body>\n<a class=\"skip\" href=\"#text\">Skip to the text</a>\n\
         <header><a class=\"name\" href=\"/\">arcslip</a>\n<nav aria-label=\"Pages\"><a class=\"narrow\" href=\"#chapters\">Chapters</a>\n\
         <a href=\"/manual\">Manual</a>\n<a href=\"/docs/\">Calls</a>\n<a href=\"/\">Dashboard</a></nav></header>\n\
         <div class=\"columns\">\n<main id=\"text\" tabindex=\"-1\">\n{body}</main>\n{}</div>\n</body>\n</html>\n",
        list(chapters, place)
    )
}

/// The list of chapters at the side, with the sections of the one that is shown.
fn list(chapters: &[(&Chapter, Rendered)], shown: Option<usize>) -> String {
    let mut text = "<nav id=\"chapters\" aria-label=\"Chapters\">\n<ul>\n".to_owned();
    for (place, (chapter, rendered)) in chapters.iter().enumerate() {
        let is_shown = shown == Some(place);
        let mark = if is_shown { " aria-current=\"page\"" } else { "" };
        // Writing to a string does not fail.
        let _ = write!(text, "<li><a href=\"/manual/{}\"{mark}>{}</a>", chapter.name, escaped(chapter.title));
        if is_shown && !rendered.sections.is_empty() {
            text.push_str("\n<ul>\n");
            for section in &rendered.sections {
                let _ = writeln!(text, "<li><a href=\"#{}\">{}</a></li>", section.anchor, escaped(&section.title));
            }
            text.push_str("</ul>");
        }
        text.push_str("</li>\n");
    }
    text + "</ul>\n</nav>\n"
}

fn contents(chapters: &[(&Chapter, Rendered)]) -> String {
    let mut text = "<h1>Manual</h1>\n<dl class=\"contents\">\n".to_owned();
    for (chapter, rendered) in chapters {
        let _ = writeln!(
            text,
            "<dt><a href=\"/manual/{}\">{}</a></dt>\n<dd>{}</dd>",
            chapter.name,
            escaped(chapter.title),
            rendered.lead
        );
    }
    text + "</dl>\n"
}

/// Links to the chapters before and after.
fn neighbours(chapters: &[(&Chapter, Rendered)], place: usize) -> String {
    let link = |place: Option<usize>, relation: &str, words: &str| {
        let (chapter, _) = place.and_then(|place| chapters.get(place))?;
        let (name, title) = (chapter.name, escaped(chapter.title));
        Some(format!("<a rel=\"{relation}\" href=\"/manual/{name}\"><small>{words}</small> {title}</a>\n"))
    };
    let before = link(place.checked_sub(1), "prev", "Before").unwrap_or_default();
    let after = link(Some(place + 1), "next", "Next").unwrap_or_default();
    format!("<nav class=\"neighbours\" aria-label=\"Neighbouring chapters\">\n{before}{after}</nav>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_are_named_as_github_names_them() {
        assert_eq!(anchor("Why a path ends"), "why-a-path-ends");
        assert_eq!(anchor("`--keep`, and what it drops (SQLite)"), "--keep-and-what-it-drops-sqlite");
        assert_eq!(anchor("Größe μ_s"), "größe-μ_s");
        let twice = rendered("# T\n\n## Again\n\n## Again\n").sections;
        let anchors: Vec<_> = twice.iter().map(|section| section.anchor.as_str()).collect();
        assert_eq!(anchors, ["again", "again-1"]);
    }

    #[test]
    fn links_lead_to_pages_and_pictures() {
        let made = rendered(
            "# T\n\nSee [the method](method.md#mode) and [more](limits.md), [README](../../README.md), \
             [this](#here), <https://example.org/a.md>.\n\n![A path](../check/scenes/pictures/klarbring.svg)\n",
        );
        for expected in [
            "href=\"/manual/method#mode\"",
            "href=\"/manual/limits\"",
            "href=\"/manual\"",
            "href=\"#here\"",
            "href=\"https://example.org/a.md\"",
            "src=\"/manual/pictures/klarbring.svg\" alt=\"A path\"",
        ] {
            assert!(made.html.contains(expected), "{expected} in {}", made.html);
        }
        assert!(made.lead.starts_with("See <a href=") && made.lead.ends_with('.'), "{}", made.lead);
    }

    #[test]
    fn tables_and_code_scroll() {
        let made = rendered("# T\n\n| a |\n|---|\n| b |\n\n```sh server\necho \"<&>\"\n```\n").html;
        assert!(
            made.contains("<div class=\"wide\" tabindex=\"0\"><table>") && made.contains("</table>\n</div>"),
            "{made}"
        );
        assert!(
            made.contains("<pre tabindex=\"0\"><code class=\"language-sh\">echo \"&lt;&amp;&gt;\"\n</code></pre>"),
            "{made}"
        );
    }

    #[test]
    fn the_page_names_the_chapter_and_its_neighbours() {
        let chapter = |name, title| Chapter { name, title, text: "" };
        let all = [chapter("a", "A & B"), chapter("b", "Two"), chapter("c", "Three")];
        let chapters: Vec<_> = all.iter().map(|chapter| (chapter, rendered("# T\n\nLead.\n\n## Part\n"))).collect();
        let shown = page(&chapters, Some(1));
        for expected in [
            "<title>Two – arcslip</title>",
            "<a href=\"/manual/b\" aria-current=\"page\">Two</a>",
            "<li><a href=\"#part\">Part</a></li>",
            "<a rel=\"prev\" href=\"/manual/a\"><small>Before</small> A &amp; B</a>",
            "<a rel=\"next\" href=\"/manual/c\">",
        ] {
            assert!(shown.contains(expected), "{expected} in {shown}");
        }
        let contents = page(&chapters, None);
        assert!(contents.contains("<dt><a href=\"/manual/a\">A &amp; B</a></dt>\n<dd>Lead.</dd>"), "{contents}");
    }
}
