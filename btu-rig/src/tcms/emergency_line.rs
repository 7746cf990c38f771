//! The emergency brake train line: released only while energised, and anything opens it (S4).

use super::cause_bits::EbSources;

/// Contacts in the emergency brake train line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineInputs {
    /// Exactly one head control relay is energised.
    pub cab_valid: bool,
    /// The master controller of the active cab is at its emergency position.
    pub controller: bool,
    /// Push buttons of both cabs.
    pub buttons: [bool; 2],
    /// ATC's relay is energised.
    pub atc_relay: bool,
    /// Main reservoir pressure is low.
    pub main_reservoir_low: bool,
    /// The emergency brake is cut out.
    pub cut_out: bool,
}

/// The line in one scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Line {
    /// Causes that open the line, whether it is cut out or not.
    pub sources: EbSources,
    /// Emergency brake: the line is open and not cut out.
    pub applied: bool,
    /// Energised as read back on the train, cut out or not.
    pub energised: bool,
    /// Fed as far as ATC's relay: nothing else opens it.
    pub fed: bool,
}

/// State of the line in one scan, from its contacts alone.
pub fn emergency_line(inputs: &LineInputs) -> Line {
    let mut sources = EbSources::default();
    for (source, opens) in [
        (EbSources::CONTROLLER, inputs.controller),
        (EbSources::BUTTON_1, inputs.buttons[0]),
        (EbSources::BUTTON_2, inputs.buttons[1]),
        (EbSources::MAIN_RESERVOIR, inputs.main_reservoir_low),
        (EbSources::HCR, !inputs.cab_valid),
    ] {
        sources.set(source, opens);
    }
    let fed = sources.is_empty();
    sources.set(EbSources::ATC, !inputs.atc_relay);
    let energised = sources.is_empty();
    Line {
        sources,
        applied: !energised && !inputs.cut_out,
        energised,
        fed,
    }
}
