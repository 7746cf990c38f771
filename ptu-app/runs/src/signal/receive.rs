//! The unit's receivers on the channels of a recording: they take samples block by block, each on a core of its own, and
//! tell what they have heard.

use ato_under_test::receivers::Tones;
use protocol::config::UnitConfig;

use super::codes::{Carrier, Codes};
use super::markers::Markers;
use super::meter::{Decimator, Meter};
use super::picture::Picture;
use super::reading::{
    ASKED_EVERY_S, Clock, Level, MOST, MOST_CHANNELS, NotUnderstood, Reading, Why,
};
use super::twc::Twc;

/// How often the receivers are asked in a block.
const ASKED_IN_BLOCK: usize = 10;
/// Shortest part, s, that is told as not understood: louder than the weakest level that is decoded, and understood by no
/// receiver.
const LEAST_UNKNOWN_S: f64 = 1.0;
/// Two such parts with less than this between them, s, are told as one; of more than `MOST_UNKNOWN` parts the nearest are
/// joined.
const JOINED_S: f64 = 1.0;
const MOST_UNKNOWN: usize = 32;
/// Highest rate at which the receivers work, Hz: of faster samples some are taken together.
const MOST_HZ: f64 = 96_000.0;
/// Least ratio of the sample rate to the highest frequency of a signal.
const LEAST_RATE: f64 = 2.2;

/// The receivers of all channels of a recording.
pub struct Receivers<'a> {
    channels: Vec<Channel<'a>>,
    /// Picture of each channel; none if nobody looks at them.
    pictures: Vec<Picture>,
    sample_hz: f64,
    /// Filter of each channel whose samples are faster than the receivers work.
    slower: Vec<Decimator>,
    /// Samples between askings.
    asked_every: usize,
    /// Samples taken.
    samples: u64,
    /// What is told of the recording before its first sample is taken.
    begun: Reading,
}

impl<'a> Receivers<'a> {
    /// Receivers for so many channels with samples of this rate; with pictures of them, if somebody looks.
    pub fn new(channels: usize, sample_hz: f64, unit: &'a UnitConfig, pictures: bool) -> Self {
        let by = (sample_hz / MOST_HZ).ceil().max(1.0) as usize;
        let sample_hz = sample_hz / by as f64;
        let mut begun = Reading::default();
        if channels > MOST_CHANNELS {
            begun.tell(0.0, Why::Channels(channels));
        }
        let read = channels.min(MOST_CHANNELS);
        let (first, for_hz) = Channel::new(1, unit, sample_hz);
        if !for_hz.is_empty() {
            begun.tell(0.0, Why::Slow { sample_hz, for_hz });
        }
        let others = (2..=read).map(|number| Channel::new(number, unit, sample_hz).0);
        let channels: Vec<_> = std::iter::once(first).chain(others).collect();
        let carrier_hz = unit.codes.first().map_or(0.0, |code| code.carrier_hz);
        let rates = unit.codes.iter().map(|code| code.rate_hz);
        let fastest_hz = rates.fold(0.0, f64::max);
        let pictures = match pictures {
            true => (channels.iter())
                .map(|_| Picture::new(sample_hz, (carrier_hz, fastest_hz), Tones::of(&unit.twc)))
                .collect(),
            false => Vec::new(),
        };
        Self {
            slower: match by {
                1 => Vec::new(),
                by => vec![Decimator::new(by); channels.len()],
            },
            channels,
            pictures,
            sample_hz,
            asked_every: ((ASKED_EVERY_S * sample_hz) as usize).max(1),
            samples: 0,
            begun,
        }
    }

    /// Samples of a block; only the last may have less.
    pub fn block(&self) -> usize {
        ASKED_IN_BLOCK * self.asked_every * self.slower.first().map_or(1, |slower| slower.by)
    }

    /// Takes a block of samples, mV, of each channel.
    pub fn take(&mut self, block: &[Vec<f32>]) {
        self.take_while(block, || {});
    }

    /// Takes a block while something else is done.
    pub fn take_while<T>(&mut self, block: &[Vec<f32>], meanwhile: impl FnOnce() -> T) -> T {
        let slower = self.slower.iter_mut().zip(block);
        let slower: Vec<_> = slower.map(|(of, samples)| of.take(samples)).collect();
        let block = match slower.is_empty() {
            true => block,
            false => &slower,
        };
        let clock = Clock {
            before: self.samples,
            sample_hz: self.sample_hz,
            asked_every: self.asked_every,
        };
        let meanwhile = std::thread::scope(|scope| {
            for (channel, samples) in self.channels.iter_mut().zip(block) {
                let Channel {
                    number,
                    unit,
                    codes,
                    twc,
                    markers,
                    meter,
                    ..
                } = channel;
                scope.spawn(move || meter.take(samples, clock.asked_every));
                let number = *number;
                if let Some(markers) = markers {
                    scope.spawn(move || markers.take_block(samples, clock, number));
                }
                if let Some(twc) = twc {
                    scope.spawn(move || twc.take_block(samples, clock, number));
                }
                scope.spawn(move || codes.take_block(samples, clock, (number, *unit)));
            }
            for (picture, samples) in self.pictures.iter_mut().zip(block) {
                scope.spawn(move || picture.take(samples));
            }
            meanwhile()
        });
        for (channel, samples) in self.channels.iter_mut().zip(block) {
            channel.judge(samples, clock);
        }
        self.samples += block.first().map_or(0, |samples| samples.len() as u64);
        meanwhile
    }

    /// What was heard up to now, and pictures of it.
    pub fn so_far(&self) -> (Reading, Vec<Picture>) {
        let mut reading = Reading {
            duration_s: self.samples as f64 / self.sample_hz,
            levels: (self.channels.iter())
                .map(|channel| Level::of(&channel.meter, channel.number))
                .collect(),
            ..self.begun.clone()
        };
        for channel in &self.channels {
            channel.tell(&mut reading);
        }
        reading.in_order();
        (reading, self.pictures.clone())
    }

    /// What was heard in all; `broken` says why there is no more.
    pub fn end(mut self, broken: Option<String>) -> (Reading, Vec<Picture>) {
        let at_s = self.samples as f64 / self.sample_hz;
        for channel in &mut self.channels {
            channel.loud.close();
        }
        let (mut reading, _) = self.so_far();
        if let Some(why) = broken {
            reading.tell(at_s, Why::Broken(why));
        }
        (reading, self.pictures)
    }
}

impl Reading {
    fn in_order(&mut self) {
        let by_time = |a: f64, b: f64| a.total_cmp(&b);
        (self.sources).sort_by(|a, b| by_time(a.from_s, b.from_s).then(a.channel.cmp(&b.channel)));
        (self.not_understood).sort_by(|a, b| by_time(a.from_s, b.from_s));
    }
}

/// One channel of a recording with its receivers.
struct Channel<'a> {
    number: usize,
    unit: &'a UnitConfig,
    codes: Codes<'a>,
    twc: Option<Twc>,
    markers: Option<Markers>,
    meter: Meter,
    loud: Loud,
}

impl<'a> Channel<'a> {
    /// The channel, and the frequencies, Hz, for which samples of this rate are too slow.
    fn new(number: usize, unit: &'a UnitConfig, sample_hz: f64) -> (Self, Vec<f64>) {
        let mut carriers: Vec<Carrier<'_>> = Vec::new();
        let mut too_high = Vec::new();
        for carrier_hz in unit.carriers_hz() {
            match sample_hz >= LEAST_RATE * carrier_hz {
                true => carriers.push(Carrier::new(carrier_hz, unit, sample_hz)),
                false => too_high.push(carrier_hz),
            }
        }
        let highest = unit.twc.middle_hz + unit.twc.apart_hz;
        let twc = (sample_hz >= LEAST_RATE * highest).then(|| Twc::new(unit, sample_hz));
        if twc.is_none() {
            too_high.push(highest);
        }
        let highest = unit.marker.tones_hz.into_iter().fold(0.0, f64::max);
        let markers = (sample_hz >= LEAST_RATE * highest).then(|| Markers::new(unit, sample_hz));
        if markers.is_none() {
            too_high.push(highest);
        }
        let channel = Self {
            number,
            unit,
            codes: Codes {
                carriers,
                done: Vec::new(),
                understood: Vec::new(),
            },
            twc,
            markers,
            meter: Meter::new(sample_hz),
            loud: Loud::default(),
        };
        (channel, too_high)
    }

    /// Notes the parts of the block that are loud although no receiver understood them.
    fn judge(&mut self, samples: &[f32], clock: Clock) {
        let level_min = self.unit.receiver.level_min_mv;
        let in_message = self.twc.as_ref().map(|twc| twc.understood.as_slice());
        let in_message = in_message.unwrap_or_default();
        for (place, part) in samples.chunks_exact(clock.asked_every).enumerate() {
            let heard = |by: &[bool]| by.get(place).copied().unwrap_or(false);
            let passed = self
                .markers
                .as_ref()
                .is_some_and(|of| heard(&of.understood));
            let understood = heard(&self.codes.understood) || heard(in_message) || passed;
            let square: f64 = (part.iter()).map(|sample| f64::from(*sample).powi(2)).sum();
            let at_s = clock.at_s((place + 1) * clock.asked_every - 1);
            let square = square / part.len() as f64;
            self.loud.ask(square, understood, at_s, level_min);
        }
    }

    fn tell(&self, reading: &mut Reading) {
        let twc = self.twc.iter();
        let of_twc = twc.flat_map(|twc| twc.done.iter().chain(&twc.under_way));
        let under_way: Vec<_> = (self.codes.carriers.iter())
            .filter_map(Carrier::under_way)
            .collect();
        let of_markers = self.markers.iter().flat_map(|markers| &markers.done);
        let all = self
            .codes
            .done
            .iter()
            .chain(&under_way)
            .chain(of_twc)
            .chain(of_markers);
        let room = MOST.saturating_sub(reading.sources.len());
        reading.sources.extend(all.take(room).cloned());
        let number = self.number;
        let unknown = (self.loud.found.iter()).map(|part| NotUnderstood {
            from_s: part.from_s,
            to_s: part.to_s,
            why: Why::Unknown {
                channel: number,
                level_mv: part.level_mv(),
            },
        });
        let room = MOST.saturating_sub(reading.not_understood.len());
        reading.not_understood.extend(unknown.take(room));
    }
}

/// Parts that are loud and not understood.
#[derive(Default)]
struct Loud {
    under_way: Option<Part>,
    found: Vec<Part>,
    /// Parts with less between them are one, s.
    joined_s: f64,
}

/// Beginning and end, s, sum of squared levels, mV², and how many levels.
#[derive(Clone, Copy)]
struct Part {
    from_s: f64,
    to_s: f64,
    sum: f64,
    count: u32,
}

impl Part {
    fn join(&mut self, other: Self) {
        self.to_s = other.to_s;
        self.sum += other.sum;
        self.count += other.count;
    }

    fn level_mv(&self) -> f64 {
        (self.sum / f64::from(self.count)).sqrt()
    }
}

impl Loud {
    fn ask(&mut self, square: f64, is_understood: bool, at_s: f64, level_min_mv: f64) {
        if is_understood || square.sqrt() < level_min_mv {
            if self
                .under_way
                .is_some_and(|part| at_s - part.to_s > JOINED_S)
            {
                self.close();
            }
            return;
        }
        let now = Part {
            from_s: (at_s - ASKED_EVERY_S).max(0.0),
            to_s: at_s,
            sum: square,
            count: 1,
        };
        match &mut self.under_way {
            Some(part) => part.join(now),
            none => *none = Some(now),
        }
    }

    fn close(&mut self) {
        let is_long = |part: &Part| f64::from(part.count) * ASKED_EVERY_S >= LEAST_UNKNOWN_S - 1e-9;
        let Some(part) = self.under_way.take().filter(is_long) else {
            return;
        };
        match self.found.last_mut() {
            Some(last) if part.from_s - last.to_s < self.joined_s => last.join(part),
            _ => self.found.push(part),
        }
        while self.found.len() > MOST_UNKNOWN {
            self.joined_s = (2.0 * self.joined_s).max(JOINED_S);
            let joined_s = self.joined_s;
            self.found.dedup_by(|part, last| {
                let is_near = part.from_s - last.to_s < joined_s;
                if is_near {
                    last.join(*part);
                }
                is_near
            });
        }
    }
}
