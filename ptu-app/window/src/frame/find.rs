//! The search dialog: finds a fault, step, unit, page or action by a few letters. An entry is opened or chosen;
//! nothing is armed or run.

use crate::parts::{over_page, selectable};
use std::sync::Arc;

use btu_rig::procedure::Procedure;
use eframe::egui::{
    Align2, FontId, Key, Modifiers, Rect, Role, ScrollArea, TextEdit, Ui, WidgetInfo, pos2, vec2,
};
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{
    ICON_ARROW_FORWARD, ICON_CHECKLIST, ICON_MEMORY, ICON_REPORT, ICON_SHOW_CHART,
};
use fault_db::{FaultFilter, FaultSummary};

use super::{keys, rail};
use crate::parts::lane::cut_text;
use crate::request::Request;
use crate::{Density, Destination, Page, PageContext, Palette, Sizes};
use ptu_report::naming::{DOT, PartNames};
use ptu_report::words::{Language, fill};
use ptu_runs::bench_worker::Phase;

/// Width of the dialog, and height of its results, points.
const WIDE: f32 = 640.0;
const HIGH: f32 = 420.0;
/// Number of entries of a kind that are shown.
const MOST: usize = 6;
/// Number of faults that are looked through, the latest.
const FAULTS: u32 = 500;

/// Typed text, and the lists in which it is looked for.
#[derive(Default)]
pub struct Find {
    pub open: bool,
    typed: String,
    /// Index of the row that the Enter key takes.
    at: usize,
    faults: Request<(Vec<FaultSummary>, PartNames)>,
    /// Faults and steps that fit the typed text; text, whether faults are read, and language of that search.
    found: Vec<Row>,
    found_for: Option<(String, bool, Language)>,
}

/// An entry that was found, and what a click on it does.
#[derive(Clone)]
struct Row {
    kind: &'static str,
    icon: MaterialIcon,
    name: String,
    more: String,
    what: What,
}

#[derive(Clone)]
enum What {
    Open(Destination),
    Page(Page),
    Unit(usize),
    Do(fn(&mut PageContext<'_>)),
}

impl Find {
    pub fn toggle(&mut self, context: &PageContext<'_>) {
        let open = !self.open && !context.settings.is_locked();
        *self = Self {
            open,
            ..Self::default()
        };
        if open {
            self.faults = Request::Pending(context.queries.run(|paths| {
                let filter = FaultFilter {
                    limit: Some(FAULTS),
                    ..FaultFilter::default()
                };
                let faults = match paths.is_there() {
                    true => paths.read()?.faults(&filter)?,
                    false => Vec::new(),
                };
                Ok((faults, PartNames::of(&paths.scripts)))
            }));
        }
    }

    /// Draws the dialog while it is open, with the steps of these procedures; does what was chosen.
    pub fn show(&mut self, ui: &Ui, procedures: &[Arc<Procedure>], context: &mut PageContext<'_>) {
        if !self.open {
            return;
        }
        self.faults.poll();
        self.look_through(procedures, context);
        let rows = self.rows(context);
        let key = |key| {
            ui.ctx()
                .input_mut(|input| input.consume_key(Modifiers::NONE, key))
        };
        let last = rows.len().saturating_sub(1);
        let moved = match (key(Key::ArrowDown), key(Key::ArrowUp)) {
            (true, _) => Some((self.at + 1).min(last)),
            (_, true) => Some(self.at.saturating_sub(1)),
            _ => None,
        };
        self.at = moved.unwrap_or(self.at).min(last);
        let mut taken = key(Key::Enter).then_some(self.at);
        // Below the window's bar, never over it.
        let place = (Align2::CENTER_TOP, Sizes::of(ui).bar + 24.0, WIDE);
        let (open, beside, ()) = over_page(ui, "find", place, |ui| {
            let edit = TextEdit::singleline(&mut self.typed)
                .hint_text(context.words.frame.find_what)
                .desired_width(f32::INFINITY);
            let edit = ui.add(edit);
            edit.request_focus();
            let name = context.words.frame.find_what;
            edit.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, name));
            if edit.changed() {
                self.at = 0;
            }
            if rows.is_empty() {
                ui.label(context.words.common.nothing);
            }
            ScrollArea::vertical().max_height(HIGH).show(ui, |ui| {
                let mut kind = "";
                for (place, row) in rows.iter().enumerate() {
                    if std::mem::replace(&mut kind, row.kind) != row.kind {
                        ui.small(row.kind);
                    }
                    if row.show(ui, place == self.at, moved.is_some()) {
                        taken = Some(place);
                    }
                }
            });
        });
        let taken = taken.and_then(|place| rows.get(place));
        self.open = open && !beside && taken.is_none();
        match taken.map(|row| row.what.clone()) {
            Some(What::Open(to)) => context.go_to.push(to),
            Some(What::Page(page)) => context.settings.page = page,
            Some(What::Unit(place)) => context.units.choose(place),
            Some(What::Do(action)) => action(context),
            None => {}
        }
    }

    /// Searches the thousands of faults and steps, only when the text, the faults read or the language have changed.
    fn look_through(&mut self, procedures: &[Arc<Procedure>], context: &PageContext<'_>) {
        let is_read = self.faults.value().is_some();
        let wanted = (
            self.typed.to_lowercase(),
            is_read,
            context.settings.language,
        );
        if self.found_for.as_ref() == Some(&wanted) {
            return;
        }
        let (faults, steps) = (self.faults(context), steps(procedures, context));
        // Among hundreds of entries nobody looks for one without typing a letter.
        let most = if wanted.0.trim().is_empty() { 0 } else { MOST };
        let faults = faults.filter(|row| row.fits(&wanted.0)).take(most);
        let steps = steps.filter(|row| row.fits(&wanted.0)).take(most);
        self.found = faults.chain(steps).collect();
        self.found_for = Some(wanted);
    }

    fn rows(&self, context: &PageContext<'_>) -> Vec<Row> {
        let typed = self.typed.to_lowercase();
        let others = units(context)
            .take(MOST)
            .chain(pages(context))
            .chain(actions(context));
        let found = self.found.iter().cloned();
        found.chain(others.filter(|row| row.fits(&typed))).collect()
    }

    fn faults<'a>(&'a self, context: &'a PageContext<'_>) -> impl Iterator<Item = Row> + 'a {
        let words = context.words;
        let known = self.faults.value();
        known.into_iter().flat_map(move |(faults, parts)| {
            let row = move |fault: &FaultSummary| Row {
                kind: words.frame.faults,
                icon: ICON_REPORT,
                name: parts.fault(&fault.lru, (&fault.findings, &fault.message), words),
                more: [&*fault.unit_serial, words.fault_state(fault.state)].join(DOT),
                what: What::Open(Destination::Fault(fault.id)),
            };
            let mut serials: Vec<&str> = faults.iter().map(|of| of.unit_serial.as_str()).collect();
            serials.sort_unstable();
            serials.dedup();
            let life = move |serial: &str| Row {
                kind: words.frame.faults,
                icon: ICON_SHOW_CHART,
                name: fill(words.frame.life_of, &[("serial", &serial)]),
                more: String::new(),
                what: What::Open(Destination::Life(serial.to_owned())),
            };
            faults.iter().map(row).chain(serials.into_iter().map(life))
        })
    }
}

fn steps<'a>(
    procedures: &'a [Arc<Procedure>],
    context: &PageContext<'_>,
) -> impl Iterator<Item = Row> + 'a {
    let words = context.words;
    procedures.iter().flat_map(move |procedure| {
        let title = words.title(procedure);
        procedure.steps.iter().map(move |step| Row {
            kind: words.frame.steps,
            icon: ICON_CHECKLIST,
            name: words.content(&step.name).into_owned(),
            more: title.to_owned(),
            what: What::Open(Destination::ChooseStep {
                procedure: procedure.id.clone(),
                step: step.name.clone(),
            }),
        })
    })
}

fn units<'a>(context: &'a PageContext<'_>) -> impl Iterator<Item = Row> + 'a {
    let units = context.units.iter().enumerate();
    units.map(|(place, unit)| Row {
        kind: context.words.frame.units,
        icon: ICON_MEMORY,
        name: unit.name(),
        more: unit.choice.line.clone(),
        what: What::Unit(place),
    })
}

fn pages<'a>(context: &'a PageContext<'_>) -> impl Iterator<Item = Row> + 'a {
    Page::ALL.into_iter().map(|page| Row {
        kind: context.words.frame.pages,
        icon: rail::icon(page),
        name: page.name(context.words).to_owned(),
        more: page.key().to_owned(),
        what: What::Page(page),
    })
}

fn actions<'a>(context: &'a PageContext<'_>) -> impl Iterator<Item = Row> + 'a {
    type Act = fn(&mut PageContext<'_>);
    let (words, frame) = (context.words, &context.words.frame);
    let phase = context.units.chosen().phase();
    let connect = match phase == Phase::Offline {
        true => frame.connect,
        false => frame.disconnect,
    };
    let theme = match context.settings.dark {
        Some(false) => frame.dark,
        _ => frame.light,
    };
    let view = match context.settings.density {
        Density::Engineer => frame.operator,
        Density::Operator => frame.engineer,
    };
    let other = |language: &Language| *language != context.settings.language;
    let language = Language::ALL.into_iter().find(other);
    let actions: [(&str, &str, Act); 8] = [
        (connect, "F9", |context| keys::connect(context)),
        (frame.setup, "", |context| {
            context.go_to.push(Destination::Setup)
        }),
        (words.care.title, "", |context| {
            context.go_to.push(Destination::History)
        }),
        (
            language.map_or("", Language::name),
            frame.language,
            |context| {
                let now = context.settings.language;
                let mut other = Language::ALL.into_iter().filter(|other| *other != now);
                context.settings.language = other.next().unwrap_or(now);
            },
        ),
        (theme, frame.theme, |context| {
            context.settings.dark = Some(context.settings.dark == Some(false));
        }),
        (view, frame.view, |context| {
            context.settings.density = match context.settings.density {
                Density::Engineer => Density::Operator,
                Density::Operator => Density::Engineer,
            };
        }),
        (frame.lock, "", |context| context.settings.lock()),
        (frame.about, "", |context| {
            context.go_to.push(Destination::About)
        }),
    ];
    // During a run only the unit's own menu disconnects it.
    let has_run = usize::from(phase == Phase::Running);
    (actions.into_iter().skip(has_run)).map(|(name, more, act)| Row {
        kind: frame.actions,
        icon: ICON_ARROW_FORWARD,
        name: name.to_owned(),
        more: more.to_owned(),
        what: What::Do(act),
    })
}

impl Row {
    /// Whether the row contains every word of `typed`, which is in lower case.
    fn fits(&self, typed: &str) -> bool {
        let said = format!("{} {}", self.name, self.more).to_lowercase();
        typed.split_whitespace().all(|part| said.contains(part))
    }

    fn show(&self, ui: &mut Ui, chosen: bool, moved: bool) -> bool {
        let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
        let size = vec2(ui.available_width(), sizes.target);
        let name = [&*self.name, &*self.more].join(DOT);
        let (rect, response) = selectable(ui, size, (&name, chosen));
        if chosen && moved {
            response.scroll_to_me(None);
        }
        let font = FontId::new(sizes.icon, self.icon.font_family());
        let at = pos2(rect.left() + 8.0, rect.center().y);
        let sign = self.icon.codepoint;
        let icon = ui
            .painter()
            .text(at, Align2::LEFT_CENTER, sign, font, palette.second);
        let part = |from: f32| Rect::from_x_y_ranges(from..=rect.right() - 8.0, rect.y_range());
        let body = FontId::proportional(sizes.body);
        let of_name = part(icon.right() + 12.0);
        let wide = cut_text(
            ui.painter(),
            of_name,
            self.name.clone(),
            body.clone(),
            palette.ink,
        );
        let of_more = part(of_name.left() + wide + 12.0);
        if of_more.width() > sizes.body {
            cut_text(
                ui.painter(),
                of_more,
                self.more.clone(),
                body,
                palette.quiet,
            );
        }
        response.clicked()
    }
}
