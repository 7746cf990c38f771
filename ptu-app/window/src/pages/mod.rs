//! The pages, one folder each.

mod bench;
mod case;
mod diagnosis;
mod drive;
mod faults;
mod procedures;
mod report;
mod signals;
mod statistics;
mod traces;

use eframe::egui::Ui;

use super::Page;
use super::page_context::{Destination, PageContext, Wanted};

pub use case::case_steps;

/// State of the pages while the window is open.
#[derive(Default)]
pub struct Pages {
    case: case::CasePage,
    bench: bench::BenchPage,
    pub procedures: procedures::ProceduresPage,
    drive: drive::DrivePage,
    traces: traces::TracesPage,
    faults: faults::FaultsPage,
    diagnosis: diagnosis::DiagnosisPage,
    report: report::ReportPage,
    statistics: statistics::StatisticsPage,
    signals: signals::SignalsPage,
}

impl Pages {
    /// Takes results that have arrived for any page, whichever is shown.
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        self.procedures.poll(context);
        self.case.poll(self.procedures.concluded(), context);
        self.faults.poll(context);
        self.report.poll(context);
    }

    pub fn show(&mut self, page: Page, ui: &mut Ui, context: &mut PageContext<'_>) {
        match page {
            Page::Case => {
                if let Some(of) = self.case.show(ui, self.procedures.has_orders(), context) {
                    self.report.show_one(of, ui, context);
                }
            }
            Page::Bench => self.bench.show(ui, context),
            Page::Procedures => self.procedures.show(ui, context),
            Page::Drive => self.drive.show(ui, context),
            Page::Traces => self.traces.show(ui, context),
            Page::Faults => self.faults.show(ui, context),
            Page::Diagnosis => self.diagnosis.show(ui, context),
            Page::Report => self.report.show(ui, context),
            Page::Statistics => self.statistics.show(ui, context),
            Page::Signals => self.signals.show(ui, context),
        }
    }

    /// Leads the person to a destination; returns the page to show.
    pub fn go_to(&mut self, to: Destination, context: &mut PageContext<'_>) -> Page {
        match to {
            Destination::Trace(id) => {
                self.traces.open(id, context);
                Page::Traces
            }
            Destination::Report(run) => {
                self.report.open(run, context);
                Page::Report
            }
            Destination::Diagnosis(run) => {
                self.diagnosis.open(run, context);
                Page::Diagnosis
            }
            Destination::Fault(id) => {
                self.faults.open(id);
                Page::Faults
            }
            Destination::Life(serial) => {
                self.statistics.life.open(&serial);
                Page::Statistics
            }
            Destination::Faults(of) => {
                self.faults.show_of(of);
                Page::Faults
            }
            Destination::Run(wanted) => {
                let page = match &wanted {
                    Wanted::Step { .. } => Page::Procedures,
                    Wanted::Part { .. } | Wanted::Prove { .. } => Page::Case,
                    Wanted::Rest => context.settings.page,
                };
                self.procedures.want(wanted, context);
                page
            }
            // The frame has opened the dialog; the page stays.
            Destination::Setup | Destination::History | Destination::About => context.settings.page,
            Destination::ChooseStep { procedure, step } => {
                self.procedures.choose_step(&procedure, &step);
                Page::Procedures
            }
        }
    }
}
