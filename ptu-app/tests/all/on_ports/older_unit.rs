//! A unit of before a message that the tester knows.

use crate::common::proxy::{frames, proxy, unchanged};
use crate::common::served::Unit;
use crate::common::{Place, list, text};
use protocol::message::{Channel, Message};

/// Goal: a unit of before orders of the wayside is not blamed for what it never knew. Method: orders do not reach it.
#[test]
fn an_older_unit_that_knows_no_orders_is_passed_with_their_steps_skipped() {
    let unit = Unit::on_tcp(&[]);
    let no_orders = frames(Channel::Twc, |message, out| match message {
        Message::TwcOrders(_) => {}
        other => out.push(other),
    });
    let address = proxy(&unit, no_orders, unchanged());
    let (said, report) = Place::new().run(&["ato/turn_back", "tcms/link", "--unit", &address]);
    said.exits(0);
    let skipped = list(&report["steps"])
        .iter()
        .filter(|step| step["verdict"] == "skipped");
    let skipped: Vec<_> = skipped.map(|step| text(&step["procedure"])).collect();
    assert_eq!(skipped, ["ato/turn_back"; 8]);
    assert!(skipped.len() < list(&report["steps"]).len(), "{report}");
    assert!(list(&report["faults"]).is_empty(), "{report}");
}
