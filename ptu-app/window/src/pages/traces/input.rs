//! Pointer and keyboard input over the lanes.

use eframe::egui::{Event, EventFilter, Key, PointerButton, Rect, Response, Ui};

use super::bar::ZOOM;
use crate::parts::lane;
use ptu_report::trace_view::{Cursor, TracePlot};

/// Zoom for one point of wheel movement.
const WHEEL: f64 = 0.005;
/// Share of the view by which one press of an arrow key moves it.
const PAN: f64 = 0.1;
/// Least stretch to zoom to, as a share of the view; a shorter one counts as a click.
const SHORTEST: f64 = 0.01;
/// Distance from the pointer within which a cursor is dragged along, points.
const NEAR: f32 = 6.0;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Drag {
    #[default]
    View,
    Cursor(Cursor),
    /// A stretch to zoom to, which begins at this value of the axis.
    Stretch(f64),
}

/// Wheel, drag and click over the lanes, which lie in `rect`.
pub fn pointer(ui: &Ui, response: &Response, rect: Rect, scene: &mut TracePlot, drag: &mut Drag) {
    let width = f64::from(rect.width().max(1.0));
    let share = |x: f32| f64::from(x - rect.left()) / width;
    if let Some(at) = response.hover_pos().filter(|at| rect.contains(*at)) {
        let (wheel, zoom) = ui.input_mut(|input| {
            let wheel = std::mem::take(&mut input.smooth_scroll_delta);
            (wheel, f64::from(input.zoom_delta()))
        });
        let times = (-f64::from(wheel.y) * WHEEL).exp() / zoom.max(0.01);
        if times != 1.0 {
            scene.camera.zoom(share(at.x), times);
        }
        if wheel.x != 0.0 {
            scene.camera.pan(-f64::from(wheel.x) / width);
        }
    }
    let near = |scene: &TracePlot, cursor: Cursor, x: f32| {
        scene.cursor(cursor).is_some_and(|row| {
            let at = lane::x_at(rect, scene.window(), scene.axis.at(row));
            (at - x).abs() <= NEAR
        })
    };
    if response.drag_started()
        && let Some(from) = ui.input(|input| input.pointer.press_origin())
    {
        let taken = [Cursor::A, Cursor::B]
            .into_iter()
            .find(|cursor| near(scene, *cursor, from.x));
        *drag = taken.map_or(Drag::View, Drag::Cursor);
        if response.drag_started_by(PointerButton::Secondary) {
            *drag = Drag::Stretch(scene.window().at(share(from.x)));
        }
    }
    if response.drag_stopped()
        && let (Drag::Stretch(from), Some(at)) = (*drag, response.interact_pointer_pos())
    {
        *drag = Drag::View;
        let to = scene.window().at(share(at.x));
        if (to - from).abs() > scene.window().length() * SHORTEST {
            scene.zoom_to(from, to);
        }
    }
    if response.dragged() {
        match (*drag, response.interact_pointer_pos()) {
            (Drag::Cursor(cursor), Some(at)) => {
                let place = scene.window().at(share(at.x));
                scene.put(cursor, place);
            }
            (Drag::Stretch(_), _) => {}
            _ => scene
                .camera
                .pan(-f64::from(response.drag_delta().x) / width),
        }
    }
    if response.clicked() {
        response.request_focus();
        if let Some(at) = response.interact_pointer_pos() {
            let shift = ui.input(|input| input.events.iter().any(shifted_click));
            let cursor = if shift { Cursor::B } else { Cursor::A };
            let place = scene.window().at(share(at.x));
            scene.put(cursor, place);
        }
    }
}

/// Whether this is a release of the pointer's button with Shift held at that moment.
fn shifted_click(event: &Event) -> bool {
    matches!(event, Event::PointerButton { pressed: false, modifiers, .. } if modifiers.shift)
}

/// Acts on keys, unless another widget has the keyboard focus.
pub fn keys(ui: &Ui, response: &Response, rect: Rect, scene: &mut TracePlot) {
    let filter = EventFilter {
        horizontal_arrows: true,
        escape: true,
        ..EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let focused = ui.memory(|memory| memory.focused());
    if focused.is_some_and(|id| id != response.id) {
        return;
    }
    let count = |keys: &[Key]| -> usize {
        ui.input(|input| {
            let plain = !input.modifiers.command && !input.modifiers.alt;
            let all = keys.iter().map(|key| input.num_presses(*key)).sum();
            if plain { all } else { 0 }
        })
    };
    let pointer = response.hover_pos().filter(|at| rect.contains(*at));
    let share = pointer.map_or(0.5, |at| f64::from((at.x - rect.left()) / rect.width()));
    let (closer, wider) = (count(&[Key::Plus, Key::Equals]), count(&[Key::Minus]));
    if closer + wider > 0 {
        let times = ZOOM.powi(closer as i32 - wider as i32);
        scene.camera.zoom(share, times);
    }
    let (left, right) = (count(&[Key::ArrowLeft]), count(&[Key::ArrowRight]));
    if left + right > 0 {
        scene.camera.pan(PAN * (right as f64 - left as f64));
    }
    if count(&[Key::F, Key::Home]) > 0 {
        scene.remember();
        scene.camera.fit();
    }
    for _ in 0..count(&[Key::Backspace]) {
        scene.zoom_back();
    }
    let place = scene.window().at(share);
    for (key, cursor) in [(Key::A, Cursor::A), (Key::B, Cursor::B)] {
        if count(&[key]) > 0 {
            scene.put(cursor, place);
        }
    }
    let shift = ui.input(|input| input.modifiers.shift);
    let stepped = if shift { Cursor::B } else { Cursor::A };
    let (back, on) = (count(&[Key::Comma]), count(&[Key::Period]));
    if back + on > 0 {
        scene.step(stepped, on as isize - back as isize);
    }
    if count(&[Key::Escape]) > 0 {
        scene.clear_cursors();
    }
}
