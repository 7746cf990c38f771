//! Faults for each 10 000 km by month, and the file of odometer readings from which they are computed.

use std::collections::BTreeMap;

use eframe::egui::{RichText, Ui};

use super::counted::Counted;
use super::{of_month, shown_months};
use crate::page_context::Destination;
use crate::parts::bars::{Bar, Chart};
use crate::parts::{Face, Look, UnitFilter, caption, file_place};
use crate::{PageContext, Palette};
use ptu_report::fault_months::{Month, OnTheWay};
use ptu_report::words::{Words, fill};

/// Path of the file, as typed.
#[derive(Default)]
pub struct DistancesFile {
    typed: Option<String>,
}

impl DistancesFile {
    /// Draws the chart, and below it the field for the file; true when the file is to be read again.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        (counted, units): (&Counted, &UnitFilter),
        context: &mut PageContext<'_>,
    ) -> bool {
        let words = context.words;
        let said = &words.statistics;
        match &counted.on_the_way {
            Some(Ok(months)) => {
                let month = chart(ui, words, counted, months);
                let month = month.map(|month| of_month(month, units));
                context.go_to.extend(month.map(Destination::Faults));
            }
            Some(Err(why)) => {
                let why = words.trouble(why);
                ui.label(RichText::new(&*why).color(Palette::of(ui).bad));
            }
            None if counted.asked.unit.is_some() => drop(caption(ui, said.distances_of_all)),
            None => drop(caption(ui, said.no_distances)),
        }
        let kept = &mut context.settings.distances;
        let typed = self.typed.get_or_insert_with(|| kept.clone());
        let mut again = false;
        ui.horizontal(|ui| {
            let read = Face::new(Look::Secondary, said.read_odometers);
            again = read.show(ui).clicked();
            file_place(ui, typed, (said.odometers, said.odometers_hint));
        });
        if again {
            typed.trim().clone_into(kept);
        }
        again
    }
}

/// Draws the chart; returns the month whose bar was clicked.
fn chart<'a>(
    ui: &mut Ui,
    words: &Words,
    counted: &'a Counted,
    known: &BTreeMap<String, OnTheWay>,
) -> Option<&'a Month> {
    let said = &words.statistics;
    let with_rate = shown_months(counted).iter().filter_map(|month| {
        let of = known.get(&month.name)?;
        let rate = of.per_10000_km()?;
        let km = format!("{:.0}", of.km);
        let numbers = [
            ("n", &of.faults as &dyn std::fmt::Display),
            ("km", &km),
            ("trains", &of.trains),
        ];
        let bar = Bar {
            name: month.name.clone(),
            value: (100.0 * rate).round() / 100.0,
            more: fill(said.rate_is, &numbers),
        };
        Some((month, bar))
    });
    let (months, bars): (Vec<_>, Vec<_>) = with_rate.unzip();
    if bars.is_empty() {
        caption(ui, said.no_distance_known);
        return None;
    }
    let chart = Chart {
        title: said.per_10000_km,
        sums: false,
    };
    let clicked = chart.in_time(ui, &bars);
    caption(ui, said.rate_of);
    months.get(clicked?).copied()
}
