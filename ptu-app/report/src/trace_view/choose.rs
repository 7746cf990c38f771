//! Chooses the signals that are shown first.

use super::view::{Summary, TraceView};

/// Signals that are shown wherever they are recorded: speed and what ATP does about it.
const ALWAYS: [&str; 7] = [
    "speed",
    "limit",
    "eb",
    "fsb",
    "code_rate_hz",
    "doors",
    "eb_cause",
];
/// Number of signals shown at first.
const FIRST: usize = 9;
/// Time before and after the trigger in which changes count, s.
const AROUND_S: f64 = 2.0;
/// Signals that change in every trace, so that a change of them says nothing.
const NEVER: [&str; 4] = ["events", "train_position", "position", "to_stop"];

/// The signals to show at first, those that changed most around the trigger before the others.
pub fn usual(view: &TraceView) -> Vec<String> {
    let name = |place: usize| view.channel(place).name.as_str();
    let always = ALWAYS.iter().filter_map(|name| view.place(name));
    let mut chosen: Vec<usize> = always
        .filter(|place| !matches!(view.summary(*place), Summary::Unknown))
        .collect();
    let mut others: Vec<(usize, f64)> = (0..view.data().channels.len())
        .filter(|place| !chosen.contains(place) && !NEVER.contains(&name(*place)))
        .filter(|place| !matches!(view.summary(*place), Summary::Quantity(_)))
        .map(|place| (place, activity(view, place)))
        .filter(|(_, activity)| *activity > 0.0)
        .collect();
    others.sort_by(|a, b| b.1.total_cmp(&a.1));
    let room = FIRST.saturating_sub(chosen.len());
    chosen.extend(others.into_iter().take(room).map(|(place, _)| place));
    // Signals of the same activity keep their order.
    chosen.sort_by(|a, b| activity(view, *b).total_cmp(&activity(view, *a)));
    chosen
        .into_iter()
        .map(|place| name(place).to_owned())
        .collect()
}

/// Activity of a signal around the trigger: of a quantity its range there as a share of its whole range, from 0 to 1; of a
/// choice or bit 2 after one change, and nearer to 1 the more changes there were.
fn activity(view: &TraceView, place: usize) -> f64 {
    let around = (AROUND_S * 1e6 / view.data().period_us.max(1) as f64) as usize;
    let trigger = view.trigger_row();
    let from = trigger.saturating_sub(around);
    let to = (trigger + around + 1).min(view.data().rows());
    match view.summary(place) {
        Summary::Quantity(pyramid) => {
            let there = pyramid.range(view.samples(place), from, to);
            let all = view.extent(place).map_or(0.0, |(low, high)| high - low);
            let share = f64::from(there.high - there.low) / all;
            if share.is_finite() { share } else { 0.0 }
        }
        Summary::Choice(runs) | Summary::Bit(runs) => match runs.changes(from..to) {
            0 => 0.0,
            changes => 1.0 + 1.0 / changes as f64,
        },
        Summary::Unknown => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use fault_db::ChannelKind;

    use super::super::tests::trace;
    use super::*;

    #[test]
    fn signals_that_changed_near_the_trigger_come_first_and_missing_ones_are_left_out() {
        let step: Vec<f64> = (0..200).map(|row| f64::from(row >= 100)).collect();
        let ramp: Vec<f64> = (0..200).map(f64::from).collect();
        let mut data = trace(&[
            ("speed", &ramp),
            ("doors", &[0.0; 200]),
            ("eb", &step),
            ("hcr", &[1.0; 200]),
            ("alarm", &step),
            ("events", &step),
        ]);
        for place in [1, 2, 3, 4] {
            data.channels[place].kind = ChannelKind::Bit;
        }
        data.trigger_row = Some(100);
        let chosen = usual(&TraceView::new(data));
        assert_eq!(chosen, ["eb", "alarm", "speed", "doors"]);
    }
}
