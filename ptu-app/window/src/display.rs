//! Opens the window on the available display, or reports that there is none.

use std::sync::Arc;
use std::sync::mpsc;
use std::time::Duration;

use super::app::{App, Options};
use ptu_runs::bench_worker::Wake;
use ptu_runs::failure::{Asked, Failure};

/// Smallest window in which every page can be used, and the size of a window for which the settings have none.
const SMALLEST: [f32; 2] = [900.0, 600.0];
const USUAL: [f32; 2] = [1280.0, 800.0];
/// Repaints asked for from other threads are this far apart at least.
const REPAINT: Duration = Duration::from_millis(16);

/// Time after which a frame that was asked for is drawn.
const SOON: Duration = Duration::from_millis(1);

/// Opens the window and stays until it is closed.
///
/// # Errors
/// There is no display, or it cannot show a window.
pub fn open(options: Options) -> Result<(), Failure> {
    let named = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if cfg!(target_os = "linux") && !named("DISPLAY") && !named("WAYLAND_DISPLAY") {
        return Err(Failure::bench(Asked::NoDisplay));
    }
    let size = options.settings.window_size.unwrap_or(USUAL);
    let native = eframe::NativeOptions {
        viewport: eframe::egui::ViewportBuilder::default()
            .with_title("PTU")
            .with_app_id("ptu")
            .with_inner_size(size)
            .with_min_inner_size(SMALLEST),
        renderer: eframe::Renderer::Glow,
        // Dithering costs time at each pixel where the processor draws, and there are no gradients.
        dithering: false,
        ..Default::default()
    };
    eframe::run_native(
        "ptu",
        native,
        Box::new(|creation| {
            let wake = waker(&creation.egui_ctx)?;
            let woken = wake.clone();
            options.interrupted.listen_and(move || woken());
            Ok(Box::new(App::new(&creation.egui_ctx, options, wake)?))
        }),
    )
    .map_err(|error| Failure::bench(Asked::NotOpened(error.to_string())))
}

/// Wakes the window from other threads, which never wait for it: a thread in between takes the
/// window's lock.
fn waker(context: &eframe::egui::Context) -> std::io::Result<Wake> {
    let (sender, receiver) = mpsc::sync_channel::<()>(1);
    let context = context.clone();
    std::thread::Builder::new()
        .name("waker".into())
        .spawn(move || {
            while receiver.recv().is_ok() {
                // A repaint without a delay would draw two frames each time.
                context.request_repaint_after(SOON);
                std::thread::sleep(REPAINT);
            }
        })?;
    Ok(Arc::new(move || {
        // Full: it is about to be woken anyway.
        let _ = sender.try_send(());
    }))
}
