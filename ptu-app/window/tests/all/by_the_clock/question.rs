//! A question of a script at the pace of the clock.

use crate::common::Place;
use crate::common::window::{Window, own_scripts, settings};
use ptu_options::Page;

#[test]
fn a_question_is_seen_on_every_page_and_waits_by_the_clock() {
    let place = Place::new();
    let scripts = own_scripts(
        &place,
        "procedure(title = \"Lamp\", suspect = \"-\")\n\
         step(\"the lamp lights\", do = [prompt(\"Does the lamp light?\", within = s(600))])\n",
    );
    let mut window = Window::with(Place::new(), scripts, settings(Page::Procedures));
    window.connect_simulated();
    window.click_for("Run", "Does the lamp light?");
    window.page(Page::Faults);
    window.wait_for("a script asks");
    let now = |window: &Window| window.app().units.chosen().bench.live().now;
    let (began, before) = (std::time::Instant::now(), now(&window));
    for _ in 0..100 {
        window.step();
    }
    let bench_s = now(&window).since(before).as_secs();
    let clock_s = began.elapsed().as_secs_f64();
    // A bench that was held up makes up for the scans it missed, and is faster than the clock then.
    assert!(
        bench_s < clock_s + 0.5,
        "{bench_s} s on the bench in {clock_s} s"
    );
    window.click("a script asks");
    window.click_for_part("Yes", "Run over: passed");
}
