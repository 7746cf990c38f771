//! Protection against unintended clicks: a double click acts once, and a button that has just appeared under the
//! pointer takes no click.

use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher, Hash};

use eframe::egui::{Context, Event, Id, Key, Modifiers, Response, Ui};

/// Time after a change or an action at a place in which clicks are ignored, as meant for the previous button, s.
const MOMENT_S: f64 = 0.6;
/// Time for which a button that arms has to be held down, s.
const HOLD_S: f64 = 1.0;

/// Whether this key was pressed just now; repeats of a key that is held down do not count.
pub fn key_pressed(context: &Context, modifiers: Modifiers, key: Key) -> bool {
    context.input_mut(|input| {
        let is_held = input
            .events
            .iter()
            .any(|event| matches!(event, Event::Key { key: of, repeat: true, .. } if *of == key));
        input.consume_key(modifiers, key) && !is_held
    })
}

/// A place on the screen where one action follows another: buttons that a click replaces by others.
pub struct ActionPlace {
    id: Id,
    now_s: f64,
    remembered: Remembered,
}

#[derive(Clone, Copy)]
struct Remembered {
    state: u64,
    /// When the place appeared, its state changed, or an action began, s.
    at_s: f64,
    /// Frame in which the place was shown last.
    frame: u64,
}

impl ActionPlace {
    /// The place named `name`; `state` is what its actions depend on.
    pub fn new(ui: &Ui, name: &str, state: impl Hash) -> Self {
        let id = Id::unique("action place").with(name);
        let state = BuildHasherDefault::<DefaultHasher>::default().hash_one(state);
        let now_s = ui.input(|input| input.time);
        let frame = ui.ctx().cumulative_frame_nr();
        let known = ui.data(|data| data.get_temp::<Remembered>(id));
        let same = |known: &Remembered| known.state == state && known.frame + 1 >= frame;
        let at_s = known.filter(same).map_or(now_s, |known| known.at_s);
        let remembered = Remembered { state, at_s, frame };
        ui.data_mut(|data| data.insert_temp(id, remembered));
        Self {
            id,
            now_s,
            remembered,
        }
    }

    /// Whether nothing has changed or acted here for a moment.
    fn is_ready(&self) -> bool {
        self.now_s - self.remembered.at_s >= MOMENT_S
    }

    /// Whether a button of this place was clicked on purpose. After that the place takes no click for [`MOMENT_S`].
    pub fn clicked(&self, response: &Response) -> bool {
        let meant = response.clicked() && self.is_ready();
        if meant {
            self.acted(response);
        }
        meant
    }

    /// Progress of a button that has to be held down, by pointer or by key: 0 to 1; 1 = it was held for [`HOLD_S`].
    pub fn held(&self, ui: &Ui, response: &Response) -> f32 {
        let id = self.id.with("held since");
        let by_key = response.has_focus()
            && ui.input(|input| input.key_down(Key::Space) || input.key_down(Key::Enter));
        if !(response.enabled()
            && self.is_ready()
            && (response.is_pointer_button_down_on() || by_key))
        {
            ui.data_mut(|data| data.remove_temp::<f64>(id));
            return 0.0;
        }
        let since_s = ui.data_mut(|data| *data.get_temp_mut_or(id, self.now_s));
        let share = ((self.now_s - since_s) / HOLD_S).min(1.0) as f32;
        ui.ctx().request_repaint();
        if share >= 1.0 {
            ui.data_mut(|data| data.remove_temp::<f64>(id));
            self.acted(response);
        }
        share
    }

    fn acted(&self, response: &Response) {
        let acted = Remembered {
            at_s: self.now_s,
            ..self.remembered
        };
        (response.ctx).data_mut(|data| data.insert_temp(self.id, acted));
    }
}
