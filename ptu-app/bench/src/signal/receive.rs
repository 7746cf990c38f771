//! The unit's receivers on the channels of a recording: they take samples block by block, each on a core of its own, and
//! tell what they have heard.

use ato_under_test::receivers::{
    CodeReceiver, FskReceiver, Heard, MarkerReceiver, Passed, Received, Reception, Tones,
};
use protocol::config::{SpeedCode, UnitConfig};

use super::picture::Picture;
use super::read::{NotUnderstood, Reading, Source, Why};

/// How often the receivers of codes are asked, s: it is most of their work.
const ASKED_EVERY_S: f64 = 0.1;
/// Askings in a block.
const ASKED_IN_BLOCK: usize = 10;
/// A code that is not heard for so long has ended, s.
const ENDS_AFTER_S: f64 = 0.3;
/// Bytes of TWC that are farther apart are two messages, s.
const APART_S: f64 = 0.2;
/// Bytes after which a message that does not end is told as the next one.
const LONGEST: usize = 4_096;
/// What is louder than the weakest level that is decoded, and understood by no receiver, is told from this length on, s.
const LEAST_UNKNOWN_S: f64 = 1.0;
/// Least sample rate, times the highest frequency of a signal.
const LEAST_RATE: f64 = 2.2;
/// Most entries of each kind in an answer.
const MOST: usize = 100_000;

/// The receivers of all channels of a recording.
pub struct Receivers<'a> {
    channels: Vec<Channel<'a>>,
    /// Of each channel, if somebody looks at it.
    pictures: Vec<Picture>,
    sample_hz: f64,
    /// Samples between askings.
    asked_every: usize,
    /// Samples taken.
    samples: u64,
    not_understood: Vec<NotUnderstood>,
}

impl<'a> Receivers<'a> {
    /// Channels that are read at most.
    pub const MOST_CHANNELS: usize = 8;

    /// For so many channels with samples of this rate; with pictures of them, if somebody looks.
    pub fn new(channels: usize, sample_hz: f64, unit: &'a UnitConfig, pictures: bool) -> Self {
        let mut not_understood = Vec::new();
        let mut said = |why| {
            not_understood.push(NotUnderstood {
                from_s: 0.0,
                to_s: 0.0,
                why,
            });
        };
        if channels > Self::MOST_CHANNELS {
            said(Why::Channels(channels));
        }
        let read = channels.min(Self::MOST_CHANNELS);
        let (first, too_high) = Channel::new(1, unit, sample_hz);
        if !too_high.is_empty() {
            said(Why::Slow {
                sample_hz,
                for_hz: too_high,
            });
        }
        let others = (2..=read).map(|number| Channel::new(number, unit, sample_hz).0);
        let channels: Vec<_> = std::iter::once(first).chain(others).collect();
        let carrier_hz = unit.codes.first().map_or(0.0, |code| code.carrier_hz);
        let pictures = match pictures {
            true => (channels.iter())
                .map(|_| Picture::new(sample_hz, carrier_hz, Tones::of(&unit.twc)))
                .collect(),
            false => Vec::new(),
        };
        Self {
            channels,
            pictures,
            sample_hz,
            asked_every: ((ASKED_EVERY_S * sample_hz) as usize).max(1),
            samples: 0,
            not_understood,
        }
    }

    /// Samples of a block; only the last may have less.
    pub fn block(&self) -> usize {
        ASKED_IN_BLOCK * self.asked_every
    }

    /// Takes a block of samples, mV, of each channel.
    pub fn take(&mut self, block: &[Vec<f32>]) {
        self.take_while(block, || {});
    }

    /// Takes a block while something else is done.
    pub fn take_while<T>(&mut self, block: &[Vec<f32>], meanwhile: impl FnOnce() -> T) -> T {
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
                    ..
                } = channel;
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

    /// What was heard up to now, and how it looks.
    pub fn so_far(&self) -> (Reading, Vec<Picture>) {
        let mut reading = Reading {
            duration_s: self.samples as f64 / self.sample_hz,
            sources: Vec::new(),
            not_understood: self.not_understood.clone(),
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
            channel.loud.close(at_s);
        }
        let (mut reading, _) = self.so_far();
        reading
            .not_understood
            .extend(broken.map(|why| NotUnderstood {
                from_s: at_s,
                to_s: at_s,
                why: Why::Broken(why),
            }));
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

/// When the samples of a block are.
#[derive(Clone, Copy)]
struct Clock {
    /// Samples before the block.
    before: u64,
    sample_hz: f64,
    asked_every: usize,
}

impl Clock {
    /// When the sample of this place is over, s.
    fn at_s(self, place: usize) -> f64 {
        (self.before + place as u64 + 1) as f64 / self.sample_hz
    }
}

/// One channel of a recording with its receivers.
struct Channel<'a> {
    number: usize,
    unit: &'a UnitConfig,
    codes: Codes<'a>,
    twc: Option<Twc>,
    markers: Option<Markers>,
    loud: Loud,
}

impl<'a> Channel<'a> {
    /// The channel, and the frequencies that samples of this rate do not have.
    fn new(number: usize, unit: &'a UnitConfig, sample_hz: f64) -> (Self, Vec<f64>) {
        let mut carriers: Vec<Carrier<'_>> = Vec::new();
        let mut too_high = Vec::new();
        for code in &unit.codes {
            if let Some(known) = (carriers.iter_mut()).find(|of| of.carrier_hz == code.carrier_hz) {
                known.codes.push(code);
                known.rates_hz.push(code.rate_hz as f32);
            } else if sample_hz >= LEAST_RATE * code.carrier_hz {
                carriers.push(Carrier::new(code, unit, sample_hz));
            } else if !too_high.contains(&code.carrier_hz) {
                too_high.push(code.carrier_hz);
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
            loud: Loud::default(),
        };
        (channel, too_high)
    }

    /// What of the block is loud although nobody understood it.
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
            let square: f64 = (part.iter())
                .map(|sample| f64::from(*sample) * f64::from(*sample))
                .sum();
            let at_s = clock.at_s((place + 1) * clock.asked_every - 1);
            let square = square / part.len() as f64;
            self.loud.ask(square, understood, at_s, level_min);
        }
    }

    fn tell(&self, reading: &mut Reading) {
        let twc = self.twc.iter();
        let of_twc = twc.flat_map(|twc| twc.done.iter().chain(&twc.under_way));
        let under_way = (self.codes.carriers.iter()).flat_map(|of| of.under_way.as_ref());
        let of_markers = self.markers.iter().flat_map(|markers| &markers.done);
        let all = self
            .codes
            .done
            .iter()
            .chain(under_way)
            .chain(of_twc)
            .chain(of_markers);
        let room = MOST.saturating_sub(reading.sources.len());
        reading.sources.extend(all.take(room).cloned());
        let number = self.number;
        let unknown = (self.loud.found.iter()).map(|&(from_s, to_s, level_mv)| NotUnderstood {
            from_s,
            to_s,
            why: Why::Unknown {
                channel: number,
                level_mv,
            },
        });
        let room = MOST.saturating_sub(reading.not_understood.len());
        reading.not_understood.extend(unknown.take(room));
    }
}

/// The receivers of codes.
struct Codes<'a> {
    carriers: Vec<Carrier<'a>>,
    done: Vec<Source>,
    /// Of the last block: whether something was heard at each asking.
    understood: Vec<bool>,
}

impl Codes<'_> {
    fn take_block(&mut self, samples: &[f32], clock: Clock, (channel, unit): (usize, &UnitConfig)) {
        self.understood.clear();
        for (place, part) in samples.chunks(clock.asked_every).enumerate() {
            let mut understood = false;
            let at_s = clock.at_s((place + 1) * clock.asked_every - 1);
            for carrier in &mut self.carriers {
                part.iter()
                    .for_each(|sample| carrier.receiver.take(*sample));
                if part.len() == clock.asked_every {
                    understood |= carrier.ask(unit, at_s, channel, &mut self.done);
                }
            }
            self.understood.push(understood);
        }
        self.done.truncate(MOST);
    }
}

/// The codes of one carrier.
struct Carrier<'a> {
    carrier_hz: f64,
    receiver: CodeReceiver,
    codes: Vec<&'a SpeedCode>,
    rates_hz: Vec<f32>,
    under_way: Option<Source>,
    /// Askings whose mean it tells.
    askings: f64,
    heard_s: f64,
}

impl<'a> Carrier<'a> {
    fn new(code: &'a SpeedCode, unit: &UnitConfig, sample_hz: f64) -> Self {
        Self {
            carrier_hz: code.carrier_hz,
            receiver: CodeReceiver::new(
                Reception::of(&unit.receiver, code.carrier_hz),
                sample_hz as f32,
            ),
            codes: vec![code],
            rates_hz: vec![code.rate_hz as f32],
            under_way: None,
            askings: 0.0,
            heard_s: 0.0,
        }
    }

    /// Whether something is heard now.
    fn ask(
        &mut self,
        unit: &UnitConfig,
        at_s: f64,
        channel: usize,
        done: &mut Vec<Source>,
    ) -> bool {
        let Some(heard) = self.receiver.heard(&self.rates_hz) else {
            if at_s - self.heard_s > ENDS_AFTER_S {
                done.extend(self.under_way.take());
            }
            return false;
        };
        self.heard_s = at_s;
        let what = self.name(&heard, unit);
        let began_s = (at_s - f64::from(self.receiver.window_s())).max(0.0);
        match &mut self.under_way {
            Some(source) if source.what == what => {
                source.to_s = at_s;
                self.askings += 1.0;
                let mean = |mean: &mut f64, value: f32| {
                    *mean += (f64::from(value) - *mean) / self.askings;
                };
                mean(&mut source.carrier_hz, heard.carrier_hz);
                mean(&mut source.rate_hz, heard.rate_hz);
                if let Some(level_mv) = &mut source.level_mv {
                    mean(level_mv, heard.level_mv);
                }
                if let (Some(snr_db), Some(now)) = (&mut source.snr_db, heard.snr_db) {
                    mean(snr_db, now);
                }
            }
            under_way => {
                self.askings = 1.0;
                let source = Source {
                    kind: "code",
                    channel,
                    from_s: began_s,
                    to_s: at_s,
                    what,
                    carrier_hz: f64::from(heard.carrier_hz),
                    rate_hz: f64::from(heard.rate_hz),
                    level_mv: Some(f64::from(heard.level_mv)),
                    snr_db: heard.snr_db.map(f64::from),
                    bad_bytes: None,
                };
                done.extend(under_way.replace(source));
            }
        }
        true
    }

    /// The code's name, as the unit decodes it.
    fn name(&self, heard: &Heard, unit: &UnitConfig) -> String {
        let receiver = &unit.receiver;
        let is_carrier =
            (f64::from(heard.carrier_hz) - self.carrier_hz).abs() <= receiver.carrier_tolerance_hz;
        let code = self.codes.iter().find(|code| {
            (f64::from(heard.rate_hz) - code.rate_hz).abs() <= receiver.rate_tolerance_hz
        });
        match code {
            Some(code) if is_carrier => code.name.clone(),
            _ => String::new(),
        }
    }
}

/// The receiver of TWC, and the bytes that belong together.
struct Twc {
    receiver: FskReceiver,
    tones: Tones,
    under_way: Option<Source>,
    done: Vec<Source>,
    /// Of the last block: whether it was within a message at each asking of the codes.
    understood: Vec<bool>,
}

impl Twc {
    fn new(unit: &UnitConfig, sample_hz: f64) -> Self {
        let level_min = unit.receiver.level_min_mv as f32;
        let tones = Tones::of(&unit.twc);
        Self {
            receiver: FskReceiver::new(tones, sample_hz as f32, level_min),
            tones,
            under_way: None,
            done: Vec::new(),
            understood: Vec::new(),
        }
    }

    fn take_block(&mut self, samples: &[f32], clock: Clock, channel: usize) {
        self.understood.clear();
        for (place, sample) in samples.iter().enumerate() {
            if let Some(received) = self.receiver.take(*sample) {
                self.receive(received, clock.at_s(place), channel);
            }
            if (place + 1) % clock.asked_every == 0 {
                self.understood.push(self.is_in_message(clock.at_s(place)));
            }
        }
    }

    fn is_in_message(&self, at_s: f64) -> bool {
        (self.under_way.as_ref()).is_some_and(|source| at_s - source.to_s < APART_S)
    }

    fn receive(&mut self, received: Received, at_s: f64, channel: usize) {
        let goes_on = self.is_in_message(at_s)
            && (self.under_way.as_ref()).is_some_and(|source| source.what.len() < 3 * LONGEST);
        if !goes_on {
            self.done.extend(self.under_way.take());
            self.done.truncate(MOST);
        }
        let tones = self.tones;
        let byte_s = 11.0 / f64::from(tones.bit_rate);
        let source = self.under_way.get_or_insert_with(|| Source {
            kind: "twc",
            channel,
            from_s: at_s - byte_s,
            to_s: at_s,
            what: String::new(),
            carrier_hz: f64::from(tones.middle_hz),
            rate_hz: f64::from(tones.bit_rate),
            level_mv: None,
            snr_db: None,
            bad_bytes: Some(0),
        });
        source.to_s = at_s;
        match received {
            Received::Byte(byte) => {
                let blank = if source.what.is_empty() { "" } else { " " };
                source.what.push_str(&format!("{blank}{byte:02x}"));
            }
            Received::Parity | Received::Framing => {
                source.bad_bytes = source.bad_bytes.map(|bad| bad + 1);
            }
        }
    }
}

/// The receiver of markers.
struct Markers {
    receiver: MarkerReceiver,
    tones_hz: [f64; 4],
    done: Vec<Source>,
    /// Of the last block: whether a marker was being passed at each asking of the codes.
    understood: Vec<bool>,
}

impl Markers {
    fn new(unit: &UnitConfig, sample_hz: f64) -> Self {
        let tones_hz = unit.marker.tones_hz;
        let level_min = unit.receiver.level_min_mv as f32;
        Self {
            receiver: MarkerReceiver::new(tones_hz, sample_hz as f32, level_min),
            tones_hz,
            done: Vec::new(),
            understood: Vec::new(),
        }
    }

    fn take_block(&mut self, samples: &[f32], clock: Clock, channel: usize) {
        self.understood.clear();
        let mut passed_now = false;
        for (place, sample) in samples.iter().enumerate() {
            if let Some(passed) = self.receiver.take(*sample) {
                passed_now = true;
                self.pass(passed, clock.at_s(place), channel);
            }
            if (place + 1) % clock.asked_every == 0 {
                self.understood
                    .push(passed_now || self.receiver.is_passing());
                passed_now = false;
            }
        }
        self.done.truncate(MOST);
    }

    fn pass(&mut self, passed: Passed, at_s: f64, channel: usize) {
        let at_s = at_s - f64::from(passed.ago_s);
        self.done.push(Source {
            kind: "marker",
            channel,
            from_s: at_s,
            to_s: at_s,
            what: format!("PSM{}", passed.marker),
            carrier_hz: self.tones_hz[usize::from(passed.marker) - 1],
            rate_hz: 0.0,
            level_mv: Some(f64::from(passed.level_mv)),
            snr_db: None,
            bad_bytes: None,
        });
    }
}

/// What is loud and not understood.
#[derive(Default)]
struct Loud {
    /// Since when, the sum of squared levels, and how many.
    under_way: Option<(f64, f64, u32)>,
    found: Vec<(f64, f64, f64)>,
}

impl Loud {
    fn ask(&mut self, square: f64, is_understood: bool, at_s: f64, level_min_mv: f64) {
        if is_understood || square.sqrt() < level_min_mv {
            return self.close(at_s);
        }
        let (_, sum, count) = self.under_way.get_or_insert((at_s - ASKED_EVERY_S, 0.0, 0));
        *sum += square;
        *count += 1;
    }

    fn close(&mut self, at_s: f64) {
        if let Some((from_s, sum, count)) = self.under_way.take()
            && at_s - from_s >= LEAST_UNKNOWN_S
            && self.found.len() < MOST
        {
            let level = (sum / f64::from(count)).sqrt();
            self.found.push((from_s.max(0.0), at_s, level));
        }
    }
}
