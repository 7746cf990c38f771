//! What is wanted next is where one looks: injected faults, written files, the connected unit's own history.

use eframe::egui::{Color32, Shape};

use crate::common::window::{Window, settings};
use crate::common::{Place, scripts};
use ptu_options::Page;

#[test]
fn an_injected_fault_is_taken_out_where_it_is_listed() {
    let mut settings = settings(Page::Bench);
    settings.unit.faults = vec!["eb_relay.slow".into(), "tra.dead".into()];
    let mut window = Window::with(Place::new(), scripts(), settings);
    window.set_up();
    window.click("Practice");
    // Most of the list is in view at once.
    window.wait_for("atp_receiver.dead");
    window.click("Remove: eb_relay.slow");
    window.until("one fault less", |window| {
        window.app().units.chosen().choice.faults == ["tra.dead"]
    });
    assert!(!window.shows("Remove: eb_relay.slow"));
}

#[test]
fn a_sheet_is_white_in_a_dark_window_and_can_be_opened_once_written() {
    let place = Place::with_bad_unit();
    let mut window = Window::with(place, scripts(), settings(Page::Report));
    window.wait_for_part("Unit BAD-1, run");
    let shapes = &window.harness().output().shapes;
    let paper = shapes.iter().filter_map(|clipped| match &clipped.shape {
        Shape::Rect(rect) if rect.rect.width() > 600.0 => Some(rect.fill),
        _ => None,
    });
    assert!(paper.into_iter().any(|fill| fill == Color32::WHITE));
    assert!(!window.shows("Open, print"));
    let file = window.place.text_path("mine.pdf");
    window.name_file("file", &file);
    window.click_for("PDF", "Open, print");
    window.wait_for(&file);
}

/// Goal: nobody takes another unit's history for that of the unit at hand. Method: a unit with faults and traces on record,
/// and another that is connected.
#[test]
fn faults_and_traces_are_those_of_the_connected_unit_until_all_are_asked_for() {
    let place = Place::with_bad_unit();
    let mut window = Window::with(place, scripts(), settings(Page::Faults));
    window.wait_for_part(" · BAD-1 · ");
    window.connect();
    window.until("only the connected unit", |window| {
        !window.shows_part(" · BAD-1 · ")
    });
    window.click_in("unit", "all units");
    window.wait_for_part(" · BAD-1 · ");
    window.page(Page::Traces);
    window.wait_for("no trace fits the filter");
    window.click_in("unit", "all units");
    window.wait_for("BAD-1");
}
