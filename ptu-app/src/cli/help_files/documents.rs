//! The manuals and all that they link to, as pages for a browser.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use ptu_runs::failure::{Failure, FileTrouble};
use ptu_runs::whole_file::write_text;
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};

/// Documents from which a reader begins, by their path in the sources.
const MANUALS: [&str; 2] = ["docs/manual.md", "docs/manual.ko.md"];
const STYLE: &str = "body{max-width:60em;margin:2em auto;padding:0 1em;font-family:sans-serif;line-height:1.5}\
    table{border-collapse:collapse}td,th{border:1px solid #bbb;padding:.2em .5em;text-align:left;vertical-align:top}\
    code{background:#eee}pre{background:#eee;padding:.5em;overflow-x:auto}pre code{background:none}img{max-width:100%}";

/// Writes both manuals, every document that can be reached from them, and their pictures and files, below `folder`,
/// each at the path that it has in the sources.
pub(super) fn write(sources: &Path, folder: &Path) -> Result<(), Failure> {
    let mut due: Vec<PathBuf> = MANUALS.map(PathBuf::from).into();
    let mut written = BTreeSet::new();
    while let Some(name) = due.pop() {
        if !written.insert(name.clone()) {
            continue;
        }
        let (from, to) = (sources.join(&name), folder.join(page_name(&name)));
        let cannot_read = |error| Failure::usage(FileTrouble::unread(&from, error));
        if !is_document(&name) {
            write_text(&to, fs::read(&from).map_err(cannot_read)?)?;
            continue;
        }
        let text = fs::read_to_string(&from).map_err(cannot_read)?;
        let (page, linked) = page(&name, &text, sources);
        write_text(&to, page)?;
        due.extend(linked);
    }
    Ok(())
}

fn is_document(name: &Path) -> bool {
    name.extension().is_some_and(|ending| ending == "md")
}

fn page_name(name: &Path) -> PathBuf {
    match is_document(name) {
        true => name.with_extension("html"),
        false => name.to_owned(),
    }
}

/// The HTML page of a document, and the files of the sources that the document links to.
fn page(name: &Path, text: &str, sources: &Path) -> (String, Vec<PathBuf>) {
    let mut linked = Vec::new();
    // A link to something other than a file, as a folder of the sources, becomes plain text.
    let mut led = Vec::new();
    let mut events: Vec<Event<'_>> = Vec::new();
    for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::Link { ref dest_url, .. })
            | Event::Start(Tag::Image { ref dest_url, .. }) => {
                let target = target(name, dest_url, sources);
                led.push(target.is_some());
                let Some((url, file)) = target else { continue };
                linked.extend(file);
                events.push(with_url(event, url));
            }
            Event::End(TagEnd::Link | TagEnd::Image) => {
                if led.pop() == Some(true) {
                    events.push(event);
                }
            }
            other => events.push(other),
        }
    }
    name_headings(&mut events);
    let mut body = String::new();
    html::push_html(&mut body, events.into_iter());
    let title = text.lines().next().unwrap_or_default();
    let title = title.trim_start_matches('#').trim();
    let language = match name.to_string_lossy().contains(".ko.") {
        true => "ko",
        false => "en",
    };
    let page = format!(
        "<!DOCTYPE html>\n<html lang=\"{language}\">\n<head><meta charset=\"utf-8\"><title>{title}</title>\
         <style>{STYLE}</style></head>\n<body>\n{body}</body>\n</html>\n"
    );
    (page, linked)
}

/// Address of a link on the pages, and the file of the sources it leads to; `None` for a link to no file.
fn target(name: &Path, url: &str, sources: &Path) -> Option<(String, Option<PathBuf>)> {
    let (path, anchor) = url.split_once('#').unwrap_or((url, ""));
    if url.contains("://") || path.is_empty() {
        return Some((url.to_owned(), None));
    }
    let mut file = name.parent().unwrap_or(Path::new("")).to_owned();
    for part in Path::new(path).components() {
        match part {
            Component::ParentDir => drop(file.pop()),
            part => file.push(part),
        }
    }
    if !sources.join(&file).is_file() {
        return None;
    }
    let mut url = page_name(Path::new(path)).display().to_string();
    if !anchor.is_empty() {
        url = format!("{url}#{anchor}");
    }
    Some((url, Some(file)))
}

fn with_url(event: Event<'_>, url: String) -> Event<'_> {
    let mut event = event;
    if let Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) = &mut event {
        *dest_url = CowStr::from(url);
    }
    event
}

/// Gives each heading the anchor by which links name it, made as code hosts make it.
fn name_headings(events: &mut [Event<'_>]) {
    let mut times: BTreeMap<String, u32> = BTreeMap::new();
    for at in 0..events.len() {
        if !matches!(events[at], Event::Start(Tag::Heading { .. })) {
            continue;
        }
        let within = events[at..]
            .iter()
            .take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_))));
        let text: String = within
            .filter_map(|event| match event {
                Event::Text(text) | Event::Code(text) => Some(&**text),
                _ => None,
            })
            .collect();
        let kept = text.to_lowercase().replace(' ', "-");
        let is_kept = |c: &char| c.is_alphanumeric() || matches!(c, '-' | '_');
        let name: String = kept.chars().filter(is_kept).collect();
        let before = times.entry(name.clone()).or_default();
        *before += 1;
        let name = match *before {
            1 => name,
            again => format!("{name}-{}", again - 1),
        };
        if let Event::Start(Tag::Heading { id, .. }) = &mut events[at] {
            *id = Some(CowStr::from(name));
        }
    }
}
