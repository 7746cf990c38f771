//! Effort from ATO to TCMS to the train, and the state of TCMS.

use eframe::egui::{Align2, Color32, FontId, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use protocol::signal::Signal;

use super::View;
use super::card::{Fact, facts, named, put_left};
use crate::Palette;
use crate::pages::bench::live_copy::BenchSnapshot;
use crate::pages::bench::scale::from_middle;
use crate::pages::bench::text::{self, UNKNOWN};
use ptu_report::words::Bench;

/// Magnitude of ATO's and TCMS's effort at full braking (−1024); full power is 1023.
const FULL_VALUE: f64 = 1024.0;
/// Full effort of the train, N (S3: BE_max).
const FULL_N: f64 = 443_000.0;
const BAR: f32 = 20.0;
/// Widths of name and value beside the bar, points.
const NAME: f32 = 92.0;
const SAID: f32 = 84.0;

/// Draws the bars and the state of TCMS.
pub fn effort(ui: &mut Ui, view: &View<'_>, palette: &Palette) {
    let (words, seen) = (&view.words.bench, view.seen);
    for (name, bar) in [
        (words.effort_ato, ato(seen)),
        (words.effort_tcms, tcms(seen, words)),
        (words.effort_train, train(seen)),
    ] {
        paint(ui, name, bar, palette);
    }
    let fact = |name, signal| Fact::new(name, text::value(words, signal, seen));
    let braking = |name, signal| {
        let on = seen.on(signal) == Some(true);
        fact(name, signal).coloured(on.then_some(palette.warn))
    };
    let link = |name, signal| {
        let lost = seen.on(signal) == Some(false);
        fact(name, signal).coloured(lost.then_some(palette.bad))
    };
    facts(
        ui,
        2,
        &[
            fact(words.tcms_mode, Signal::TcmsMode),
            link(words.tcms_link, Signal::TcmsOk),
            link(words.tcms_alive, Signal::TcmsAlive),
            braking(words.tcms_fsb, Signal::TcmsFsb),
            braking(words.tcms_holding, Signal::TcmsHolding),
            braking(words.eb_line, Signal::EbLoop),
        ],
    );
    let causes = |name, signal| Fact::new(name, text::bits(words, signal, seen));
    facts(
        ui,
        1,
        &[
            causes(words.power_cuts, Signal::PowerCutCauses),
            causes(words.eb_sources, Signal::EbSources),
            causes(words.lamps, Signal::Lamps),
        ],
    );
}

/// A bar: its length from the middle, −1 to 1, none while unknown; and the text beside it.
struct Bar {
    share: Option<f32>,
    said: String,
}

fn of_value(value: Option<f64>, letters: &str) -> Bar {
    match value {
        None => Bar {
            share: None,
            said: UNKNOWN.to_owned(),
        },
        Some(value) => Bar {
            share: Some(from_middle(value, FULL_VALUE)),
            said: format!("{letters} {value:.0}").trim_start().to_owned(),
        },
    }
}

fn ato(seen: &BenchSnapshot) -> Bar {
    of_value(
        seen.value(Signal::Effort),
        letters(seen, Signal::Power, Signal::Brake),
    )
}

fn tcms(seen: &BenchSnapshot, words: &Bench) -> Bar {
    let coasting = seen.on(Signal::TcmsCoast) == Some(true);
    let letters = if coasting {
        words.coast
    } else {
        letters(seen, Signal::TcmsPower, Signal::TcmsBrake)
    };
    of_value(seen.value(Signal::TcmsValue), letters)
}

fn letters(seen: &BenchSnapshot, power: Signal, brake: Signal) -> &'static str {
    match (seen.on(power), seen.on(brake)) {
        (Some(true), Some(true)) => "P B",
        (Some(true), _) => "P",
        (_, Some(true)) => "B",
        _ => "",
    }
}

fn train(seen: &BenchSnapshot) -> Bar {
    let given = [Signal::Traction, Signal::ElectricBrake, Signal::AirBrake];
    let [Some(traction), Some(electric), Some(air)] = given.map(|signal| seen.value(signal)) else {
        return of_value(None, "");
    };
    let effort = traction - electric - air;
    Bar {
        share: Some(from_middle(effort, FULL_N)),
        said: format!("{:.0} kN", effort / 1000.0),
    }
}

fn paint(ui: &mut Ui, name: &str, bar: Bar, palette: &Palette) {
    let size = vec2(ui.available_width(), BAR);
    let (area, _) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter();
    let left = pos2(area.left(), area.center().y);
    put_left(painter, left, 12.0, palette.quiet, name);
    let frame = Rect::from_min_max(
        pos2(area.left() + NAME, area.top() + 2.0),
        pos2(area.right() - SAID, area.bottom() - 2.0),
    );
    let line = Stroke::new(1.0, palette.grid);
    painter.rect(frame, 2.0, Color32::TRANSPARENT, line, StrokeKind::Inside);
    if let Some(share) = bar.share {
        let middle = frame.center().x;
        let tip = middle + share * frame.width() / 2.0;
        let filled = Rect::from_two_pos(pos2(middle, frame.top()), pos2(tip, frame.bottom()));
        let colour = if share < 0.0 {
            palette.warn
        } else {
            palette.good
        };
        painter.rect_filled(filled, 0.0, colour);
    }
    let middle = Stroke::new(1.0, palette.quiet);
    painter.vline(frame.center().x, frame.y_range(), middle);
    let ink = palette.ink;
    let right = pos2(area.right(), area.center().y);
    let font = FontId::proportional(14.0);
    painter.text(right, Align2::RIGHT_CENTER, &bar.said, font, ink);
    named(ui, area, ("bar", name), || format!("{name}: {}", bar.said));
}
