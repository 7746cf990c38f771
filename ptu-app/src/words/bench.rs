//! Live view and stimuli.

use super::wordings;

wordings! {
    /// Live view and stimuli.
    Bench {
        title: "Bench", "벤치";
    }
}
