//! The data that wayside and unit exchange by TWC.

use eframe::egui::Ui;
use protocol::signal::Signal;

use super::View;
use super::card::{Fact, facts};
use crate::Palette;
use crate::pages::bench::text::{self, UNKNOWN};
use crate::pages::bench::track::WaysideFrame;

/// Draws the data of the TWC frames in both directions.
pub fn twc(ui: &mut Ui, view: &View<'_>, sent: &WaysideFrame, palette: &Palette) {
    let (words, seen) = (&view.words.bench, view.seen);
    let fact = |name, signal| Fact::new(name, text::value(words, signal, seen));
    let link = |name, signal| {
        let lost = seen.on(signal) == Some(false);
        fact(name, signal).coloured(lost.then_some(palette.bad))
    };
    let number = |value: Option<u16>| value.map_or(UNKNOWN.to_owned(), |value| value.to_string());
    let fixed = match sent.fixed_speed_kmh {
        None => UNKNOWN.to_owned(),
        Some(None) => words.none.to_owned(),
        Some(Some(kmh)) => format!("{kmh} km/h"),
    };
    let departure = match seen.on(Signal::Departure) {
        None => UNKNOWN,
        Some(true) => words.given,
        Some(false) => words.held,
    };
    facts(
        ui,
        2,
        &[
            fact(words.wayside, Signal::Wayside),
            fact(words.station, Signal::WaysideStation),
            Fact::new(words.next_station, number(sent.next_station)),
            fact(words.loop_id, Signal::WaysideLoop),
            Fact::new(words.fixed_speed, fixed),
            fact(words.running_mode, Signal::WaysideMode),
            fact(words.door_side, Signal::WaysideDoorSide),
            Fact::new(words.departure, departure),
            link(words.twc_link, Signal::TwcOk),
            link(words.station_valid, Signal::StationValid),
            fact(words.received, Signal::TwcReceived),
            Fact::new(words.train_number, number(sent.train_number)),
            fact(words.answer_train, Signal::TwcAnswerTrain),
            fact(words.answer_station, Signal::TwcAnswerStation),
            fact(words.answers, Signal::TwcAnswers),
            fact(words.aligned, Signal::Aligned),
            fact(words.destination, Signal::Destination),
            fact(words.order_state, Signal::OrderState),
        ],
    );
}
