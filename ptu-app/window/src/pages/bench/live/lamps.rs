//! Lamps: dark when off, lit when on, dashed while the value is unknown.

use eframe::egui::{Color32, Rect, RichText, Sense, Stroke, StrokeKind, Ui, Vec2};
use eframe::egui::{pos2, vec2};
use protocol::signal::Signal;

use super::card::{named, put_centred, write};
use crate::Palette;
use crate::pages::bench::live_copy::BenchSnapshot;
use crate::parts::dashed_outline;
use ptu_report::words::Bench;

/// Number of lamps beside each other.
const COLUMNS: usize = 2;
/// Gap between lamps, points.
const BETWEEN: f32 = 4.0;

/// State of a lamp; unknown while no unit is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LampState {
    On,
    Off,
    Unknown,
}

struct Lamp {
    name: &'static str,
    /// Texts of the lamp when it is on, and when it is off.
    says: [&'static str; 2],
    lit: LampState,
    colour: Color32,
}

/// Draws all lamps in an area of this size.
pub fn lamps(ui: &mut Ui, size: Vec2, seen: &BenchSnapshot, words: &Bench, palette: &Palette) {
    let (area, _) = ui.allocate_exact_size(size, Sense::hover());
    let lamps = of(seen, words, palette);
    let rows = lamps.len().div_ceil(COLUMNS);
    let each = vec2(
        (area.width() - BETWEEN) / COLUMNS as f32,
        (area.height() - BETWEEN * (rows - 1) as f32) / rows as f32,
    );
    for (place, lamp) in lamps.iter().enumerate() {
        let offset = vec2(
            (place % COLUMNS) as f32 * (each.x + BETWEEN),
            (place / COLUMNS) as f32 * (each.y + BETWEEN),
        );
        let rect = Rect::from_min_size(area.min + offset, each);
        let says = match lamp.lit {
            LampState::On => lamp.says[0],
            LampState::Off => lamp.says[1],
            LampState::Unknown => words.not_known,
        };
        paint(ui, rect, lamp, says, palette);
        named(ui, rect, ("lamp", place), || {
            format!("{}: {says}", lamp.name)
        });
    }
}

fn of(seen: &BenchSnapshot, words: &Bench, palette: &Palette) -> [Lamp; 10] {
    let lamp = |name, says, signal, lit_at: bool, colour| Lamp {
        name,
        says,
        lit: lit(seen.on(signal), lit_at),
        colour,
    };
    // The lamp of a side's doors is lit unless they are closed and locked.
    let side_doors = |name, signal| {
        let state = seen.value(signal);
        let open = match state {
            Some(1.0) => words.doors_unlocked,
            _ => words.doors_open,
        };
        Lamp {
            name,
            says: [open, words.doors_closed],
            lit: lit(state.map(|state| state == 2.0), false),
            colour: palette.warn,
        }
    };
    let brake = [words.applied, words.released];
    let on_off = [words.on, words.off];
    let enabled = |order| {
        let says = match seen.on(order) {
            Some(true) => words.doors_ordered_open,
            _ => words.enabled,
        };
        [says, words.not_enabled]
    };
    let (bad, warn) = (palette.armed, palette.warn);
    [
        lamp(words.eb, brake, Signal::Eb, true, bad),
        lamp(words.fsb, brake, Signal::Fsb, true, warn),
        lamp(words.overspeed_alarm, on_off, Signal::Alarm, true, bad),
        lamp(words.power_cut, on_off, Signal::PowerCut, true, warn),
        lamp(words.holding_brake, brake, Signal::HoldingBrake, true, warn),
        side_doors(words.doors_left, Signal::DoorsLeft),
        side_doors(words.doors_right, Signal::DoorsRight),
        lamp(
            words.enable_left,
            enabled(Signal::DoorOrderLeft),
            Signal::DoorEnableLeft,
            true,
            palette.good,
        ),
        lamp(
            words.enable_right,
            enabled(Signal::DoorOrderRight),
            Signal::DoorEnableRight,
            true,
            palette.good,
        ),
        lamp(
            words.doors_order_close,
            on_off,
            Signal::DoorOrderClose,
            true,
            warn,
        ),
    ]
}

fn lit(value: Option<bool>, lit_at: bool) -> LampState {
    match value {
        None => LampState::Unknown,
        Some(value) if value == lit_at => LampState::On,
        Some(_) => LampState::Off,
    }
}

fn paint(ui: &Ui, rect: Rect, lamp: &Lamp, says: &str, palette: &Palette) {
    let painter = &ui.painter_at(rect);
    let bulb = pos2(rect.left() + 20.0, rect.center().y);
    let (name, state) = match lamp.lit {
        LampState::On => {
            let ground = match lamp.colour {
                bad if bad == palette.bad => palette.bad_ground,
                warn if warn == palette.warn => palette.warn_ground,
                _ => palette.control,
            };
            let line = Stroke::new(1.0, lamp.colour);
            painter.rect(rect, 6.0, ground, line, StrokeKind::Inside);
            painter.circle_filled(bulb, 6.0, lamp.colour);
            (palette.ink, palette.ink)
        }
        LampState::Off => {
            let line = Stroke::new(1.0, palette.grid);
            painter.rect_stroke(rect, 6.0, line, StrokeKind::Inside);
            painter.circle_stroke(bulb, 6.0, Stroke::new(1.0, palette.quiet));
            (palette.ink, palette.quiet)
        }
        LampState::Unknown => {
            let line = Stroke::new(1.0, palette.quiet);
            painter.extend(dashed_outline(rect.shrink(1.0), line, 5.0));
            put_centred(painter, bulb, 18.0, palette.warn, "?");
            (palette.quiet, palette.warn)
        }
    };
    let left = rect.left() + 40.0;
    let room = rect.right() - left - BETWEEN;
    for (text, size, ink, off) in [(lamp.name, 14.0, name, -9.0), (says, 13.0, state, 9.0)] {
        let text = RichText::new(text).size(size).color(ink);
        write(ui, pos2(left, rect.center().y + off), room, text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lamp_of_unknown_state_is_neither_on_nor_off() {
        assert_eq!(lit(None, true), LampState::Unknown);
        assert_eq!(lit(None, false), LampState::Unknown);
        assert_eq!(lit(Some(true), true), LampState::On);
        assert_eq!(lit(Some(true), false), LampState::Off);
        assert_eq!(lit(Some(false), false), LampState::On);
    }
}
