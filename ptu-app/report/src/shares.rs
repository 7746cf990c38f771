//! Shares of a campaign, as JSON and in per cent.

use ptu_runs::campaign::Share;
use serde_json::{Value, json};

pub(crate) fn share_json(share: Share) -> Value {
    json!({ "of": share.of, "all": share.all, "share": share.value() })
}

pub(crate) fn percent(part: f64, of: f64) -> f64 {
    if of > 0.0 { 100.0 * part / of } else { 0.0 }
}
