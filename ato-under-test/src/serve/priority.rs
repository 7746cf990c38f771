//! Priority of a thread that exchanges frames by the clock.

use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// Above all that goes by no clock, and low among what does: the system's own time-keeping threads stand higher
/// \[default\].
const PRIORITY: u8 = 10;

/// The present thread keeps time from now on: it is asked of the system to let nothing else delay it. Returns whether
/// the system lets it; where it does not, the thread goes on as it is. Needs the right to real-time priorities
/// (on Linux `RLIMIT_RTPRIO` or root).
pub fn keep_time() -> bool {
    let Ok(priority) = ThreadPriorityValue::try_from(PRIORITY) else {
        return false;
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let id = thread_native_id();
    set_thread_priority_and_policy(id, ThreadPriority::Crossplatform(priority), policy).is_ok()
}
