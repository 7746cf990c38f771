//! Counts of frames that one end of the wire has accepted and rejected, by channel and by reason.

use crate::frame::{Reject, Rejected};
use crate::message::Channel;

/// Counts of frames that one end has accepted and rejected since it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    pub(super) accepted: [u64; CHANNELS],
    pub(super) gaps: [u64; CHANNELS],
    pub(super) out_of_place: [u64; CHANNELS],
    /// Counts by reason, then by channel; the last place counts frames of no channel that this end hears.
    pub(super) rejected: [[u64; CHANNELS + 1]; Reject::ALL.len()],
    pub(super) garbage: u64,
}

pub(super) const CHANNELS: usize = Channel::ALL.len();

impl Counters {
    /// Frames accepted on a channel.
    pub const fn accepted(&self, channel: Channel) -> u64 {
        self.accepted[channel as usize]
    }

    /// Sequence numbers on a channel that were passed over: frames lost or rejected.
    pub const fn gaps(&self, channel: Channel) -> u64 {
        self.gaps[channel as usize]
    }

    /// Frames accepted on all channels.
    pub fn accepted_total(&self) -> u64 {
        self.accepted.iter().sum()
    }

    /// Frames rejected on a channel for their sequence number or time stamp although the frames before and
    /// after them are consecutive: repeated, delayed or reordered by the line. Frames of a restarted sender
    /// are not counted.
    pub const fn out_of_place(&self, channel: Channel) -> u64 {
        self.out_of_place[channel as usize]
    }

    /// Frames rejected for a reason.
    pub fn rejected(&self, reason: Reject) -> u64 {
        self.rejected[reason as usize].iter().sum()
    }

    /// Frames rejected on a channel, for any reason; those with a wrong FCS count for the channel
    /// they claim to be of.
    pub fn rejected_on(&self, channel: Channel) -> u64 {
        self.rejected
            .iter()
            .map(|by_channel| by_channel[channel as usize])
            .sum()
    }

    /// Frames rejected on a channel (`None` = no known channel, or none that this end hears) for a reason.
    pub fn rejected_for(&self, reason: Reject, channel: Option<Channel>) -> u64 {
        self.rejected[reason as usize][channel.map_or(CHANNELS, |c| c as usize)]
    }

    /// Frames rejected on all channels, for any reason.
    pub fn rejected_total(&self) -> u64 {
        self.rejected.iter().flatten().sum()
    }

    /// Bytes outside frames.
    pub const fn garbage(&self) -> u64 {
        self.garbage
    }

    pub(super) fn reject(&mut self, Rejected { reason, channel }: Rejected) {
        self.rejected[reason as usize][channel.map_or(CHANNELS, |c| c as usize)] += 1;
    }
}
