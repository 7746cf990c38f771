//! Detected signals of a recording of waveforms: as text, and as a page with spectrum, envelope and eye beside
//! it.

use ptu_runs::signal::{
    Level, MOST_CHANNELS, NotUnderstood, Picture, Reading, Source, Span, Tacho, Why,
};
use ptu_runs::table::Table as TextTable;

use crate::plot::{AxisMark, Plot, Raster, Series, Style};
use crate::run::block::{self, Align, Block, Column, Row, Tone};
use crate::run::{Paper, Printed};
use crate::words::{Words, fill};

/// Greatest and least range of the levels shown, dB below the strongest.
const MOST_DB: f32 = 70.0;
const LEAST_DB: f32 = 20.0;
/// Level above the middle of all levels up to which a signal is noise, dB: noise has the darkest
/// shades.
const NOISE_DB: f32 = 6.0;
/// Most signals that are named above the spectrum over time.
const MOST_NAMED: usize = 200;
/// Columns of a sketch.
const SKETCHED: usize = 512;
/// Height of a curve, in units of the drawing.
const CURVE: f64 = 220.0;

/// A recording that was read.
pub struct Recording {
    pub file: String,
    pub unit_config: String,
    /// Voltage of full scale, mV.
    pub full_scale_mv: f64,
    /// Codes, bytes and markers that the receivers detected.
    pub reading: Reading,
    /// Picture of each channel.
    pub pictures: Vec<Picture>,
    /// Command that made the page, and time.
    pub made: String,
}

/// Headings of the table of detected signals.
pub fn heads(words: &Words) -> [&'static str; 9] {
    let said = &words.signals;
    [
        said.channel,
        said.from,
        said.to,
        said.kind,
        said.what,
        said.carrier,
        said.rate,
        said.level,
        said.snr,
    ]
}

/// A detected signal as a row of a table.
pub fn row(source: &Source, words: &Words) -> [String; 9] {
    let said = &words.signals;
    let number = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"))
    };
    let what = match (source.kind, source.what.as_str(), source.rate_hz) {
        ("code", "", rate) if rate < 1.0 => said.no_code,
        ("code", "", _) => said.unknown_code,
        (_, what, _) => what,
    };
    let what = match source.bad_bytes {
        _ if source.tacho.is_some() => source
            .tacho
            .as_ref()
            .map_or_else(String::new, |of| of_tacho(of, words)),
        Some(bad) if bad > 0 => fill(said.damaged_bytes, &[("bytes", &what), ("n", &bad)]),
        _ => what.to_owned(),
    };
    [
        source.channel.to_string(),
        format!("{:.2}", source.from_s),
        format!("{:.2}", source.to_s),
        match source.kind {
            "code" => said.code,
            "marker" => said.marker,
            "tacho" => said.tacho,
            _ => said.twc,
        }
        .to_owned(),
        what,
        number(Some(source.carrier_hz).filter(|hz| *hz > 0.0), 1),
        format!("{:.2}", source.rate_hz),
        number(source.level_mv, 0),
        number(source.snr_db, 1),
    ]
}

/// Sentence on the lines of a speed sensor.
fn of_tacho(of: &Tacho, words: &Words) -> String {
    let number = |value: f64| format!("{value:.1}");
    let [low, high] = of.kmh.map(number);
    let [a, b] = of.duty_percent.map(number);
    let (mean, phase) = (number(of.mean_kmh), format!("{:.0}", of.phase_deg));
    let values: [(&str, &dyn std::fmt::Display); 9] = [
        ("forward", &of.forward),
        ("backward", &of.backward),
        ("mean", &mean),
        ("low", &low),
        ("high", &high),
        ("phase", &phase),
        ("a", &a),
        ("b", &b),
        ("missing", &of.missing_teeth),
    ];
    fill(words.signals.of_tacho, &values)
}

/// Sentence on a signal that was not understood.
pub fn not_understood(of: &NotUnderstood, words: &Words) -> String {
    let said = &words.signals;
    let why = match &of.why {
        Why::Slow { sample_hz, for_hz } => {
            let hz: Vec<_> = for_hz.iter().map(f64::to_string).collect();
            fill(said.too_slow, &[("n", sample_hz), ("hz", &hz.join(", "))])
        }
        Why::Unknown { channel, level_mv } => {
            let level = format!("{level_mv:.0}");
            fill(said.loud, &[("n", channel), ("level", &level)])
        }
        Why::OneLine => said.one_line.to_owned(),
        Why::NoSensor(channel) => fill(said.no_sensor, &[("n", channel)]),
        Why::Clipped { channel, samples } => {
            fill(said.clipped, &[("n", channel), ("samples", samples)])
        }
        Why::Channels(n) => {
            let most = MOST_CHANNELS;
            fill(said.many_channels, &[("n", n), ("most", &most)])
        }
        Why::Broken(why) => fill(said.broken, &[("why", why)]),
    };
    let [from, to] = [of.from_s, of.to_s].map(|at| format!("{at:.2}"));
    fill(said.at, &[("from", &from), ("to", &to), ("why", &why)])
}

/// Sentence on the level of a channel.
pub fn level(of: &Level, words: &Words) -> String {
    let said = &words.signals;
    let strongest = of.strongest_hz.zip(of.strongest_mv);
    let strongest = strongest.map_or_else(String::new, |(hz, mv)| {
        let [hz, mv] = [hz, mv].map(|value| format!("{value:.0}"));
        fill(said.strongest, &[("hz", &hz), ("mv", &mv)])
    });
    let [level, most] = [of.level_mv, of.most_mv].map(|mv| format!("{mv:.0}"));
    let values: [(&str, &dyn std::fmt::Display); 4] = [
        ("n", &of.channel),
        ("level", &level),
        ("most", &most),
        ("strongest", &strongest),
    ];
    fill(said.meter, &values)
}

/// Detected signals as text for a terminal.
pub fn text(reading: &Reading, words: &Words) -> String {
    let mut lines = vec![format!("{:.2} s", reading.duration_s)];
    if reading.sources.is_empty() {
        lines.push(words.signals.nothing.to_owned());
    } else {
        let mut table = TextTable::new(&heads(words));
        for source in &reading.sources {
            table.row(row(source, words));
        }
        lines.push(table.render());
    }
    lines.extend(reading.levels.iter().map(|of| level(of, words)));
    lines.extend((reading.not_understood.iter()).map(|of| not_understood(of, words)));
    lines.join("\n")
}

impl Printed for Recording {
    fn paper(&self, words: &Words) -> Paper {
        let said = &words.signals;
        let facts = [
            (said.file, self.file.clone()),
            (said.length, format!("{:.2} s", self.reading.duration_s)),
            (words.report.unit_config, self.unit_config.clone()),
            (said.full_scale, format!("{} mV", self.full_scale_mv)),
        ];
        let facts = facts.map(|(name, value)| (block::sentence(name), value));
        let mut blocks = vec![
            Block::Title(said.report.into(), self.file.clone()),
            Block::Facts(facts.into()),
            Block::Heading(said.heard.into()),
        ];
        blocks.push(match self.reading.sources.is_empty() {
            true => Block::Text(Tone::Plain, said.nothing.into()),
            false => Block::Table(table(&self.reading.sources, words)),
        });
        let levels = self.reading.levels.iter();
        blocks.extend(levels.map(|of| Block::Text(Tone::Plain, level(of, words))));
        if !self.reading.not_understood.is_empty() {
            blocks.push(Block::Heading(said.not_understood.into()));
            let of = self.reading.not_understood.iter();
            blocks.extend(of.map(|of| Block::Text(Tone::Plain, not_understood(of, words))));
        }
        for (place, picture) in self.pictures.iter().enumerate() {
            blocks.push(Block::Heading(fill(
                said.of_channel,
                &[("n", &(place + 1))],
            )));
            let plots = plots(picture, (&self.reading, place), words).into_iter();
            blocks.extend(plots.map(|plot| Block::Plot(Box::new(plot))));
        }
        blocks.push(Block::Text(Tone::Soft, self.made.clone()));
        Paper {
            name: said.report,
            short: self.file.clone(),
            number: self.file.clone(),
            program: format!("ptu {}", env!("CARGO_PKG_VERSION")),
            blocks,
            ..Paper::default()
        }
    }
}

fn table(sources: &[Source], words: &Words) -> block::Table {
    let shares = [0.08, 0.09, 0.09, 0.1, 0.24, 0.12, 0.1, 0.1, 0.08];
    let columns = heads(words).into_iter().zip(shares).enumerate();
    let columns = columns.map(|(place, (name, share))| {
        let align = if matches!(place, 3 | 4) {
            Align::Left
        } else {
            Align::Right
        };
        Column::new(name, share, align)
    });
    let rows = sources.iter();
    block::Table {
        columns: columns.collect(),
        rows: rows.map(|source| Row::words(row(source, words))).collect(),
    }
}

/// Plots of a channel, with the beginnings of its detected signals.
pub fn plots(picture: &Picture, of: (&Reading, usize), words: &Words) -> Vec<Plot> {
    let said = &words.signals;
    let over_time = |title: &str, unit, (columns, each_s): (&[Span], f64)| {
        let ends = (said.time, unit, of.0.duration_s);
        curve(title, ends, spans(columns, each_s))
    };
    let (levels, row_hz) = picture.mean_spectrum();
    let points = levels.iter().enumerate();
    let points = points.map(|(place, level)| (place as f64 * row_hz, f64::from(*level)));
    let ends = (said.frequency, said.decibels, row_hz * levels.len() as f64);
    let mut plots = vec![over_time(said.waveform, said.millivolts, picture.wave())];
    // A short recording has no spectrum.
    let has_spectrum = !picture.spectra().0.is_empty();
    if has_spectrum {
        plots.push(spectrogram(picture, of, words));
    }
    let envelope = fill(said.envelope, &[("hz", &picture.carrier_hz)]);
    plots.push(over_time(
        &envelope,
        said.millivolts_rms,
        picture.envelope(),
    ));
    if has_spectrum {
        plots.push(curve(said.spectrum, ends, points.collect()));
    }
    plots.extend(eye(picture, words));
    plots
}

/// Plot of a waveform that the generator makes and nobody recorded.
pub fn sketch(samples: &[f32], sample_hz: f64, words: &Words) -> Plot {
    let said = &words.signals;
    let together = samples.len().div_ceil(SKETCHED).max(1);
    let columns = samples.chunks(together).map(|some| Span {
        low: some.iter().copied().fold(f32::INFINITY, f32::min),
        high: some.iter().copied().fold(f32::NEG_INFINITY, f32::max),
    });
    let columns: Vec<_> = columns.collect();
    let ends = (said.time, said.millivolts, samples.len() as f64 / sample_hz);
    curve(
        said.made,
        ends,
        spans(&columns, together as f64 / sample_hz),
    )
}

/// Plot of one curve: its title, the names of both axes, and the end of the horizontal axis, which begins at 0.
fn curve(title: &str, (x_label, y_label, to): (&str, &str, f64), points: Vec<(f64, f64)>) -> Plot {
    Plot {
        title: title.into(),
        x_label: x_label.into(),
        y_label: y_label.into(),
        x_range: Some((0.0, to)),
        series: vec![line(points)],
        height: Some(CURVE),
        ..Plot::default()
    }
}

fn line(points: Vec<(f64, f64)>) -> Series {
    Series {
        name: String::new(),
        colour: 0,
        style: Style::Line,
        points,
    }
}

/// Columns as one line that goes through the least and the greatest value of each.
fn spans(columns: &[Span], each_s: f64) -> Vec<(f64, f64)> {
    let ends = columns.iter().enumerate().flat_map(|(place, span)| {
        let at = (place as f64 + 0.5) * each_s;
        [(at, f64::from(span.low)), (at, f64::from(span.high))]
    });
    ends.collect()
}

/// The spectrum over time, and the levels of its least and greatest shade.
fn shades(picture: &Picture) -> (usize, Vec<u8>, (f32, f32)) {
    let (spectra, _) = picture.spectra();
    let rows = spectra.first().map_or(0, Vec::len);
    let mut levels: Vec<f32> = spectra.iter().flatten().copied().collect();
    levels.sort_unstable_by(f32::total_cmp);
    let middle = levels.get(levels.len() / 2).copied().unwrap_or_default();
    let low = middle + NOISE_DB;
    let high = levels.last().copied().unwrap_or_default();
    let high = high.max(low + LEAST_DB);
    let low = low.max(high - MOST_DB);
    let shade = |level: f32| (255.0 * ((level - low) / (high - low)).clamp(0.0, 1.0)) as u8;
    let from_top = (0..rows).rev();
    let shades = from_top.flat_map(|row| spectra.iter().map(move |levels| shade(levels[row])));
    (spectra.len(), shades.collect(), (low, high))
}

fn spectrogram(picture: &Picture, (reading, channel): (&Reading, usize), words: &Words) -> Plot {
    let (said, duration_s) = (&words.signals, reading.duration_s);
    let (columns, shades, (low, high)) = shades(picture);
    let (spectra, _) = picture.spectra();
    let rows = spectra.first().map_or(0, Vec::len);
    let (from_s, to_s) = picture.spectra_s();
    let highest = rows as f64 * picture.row_hz();
    let [low, high] = [low, high].map(|level| format!("{level:.0}"));
    let heard = reading.sources.iter();
    let heard = heard.filter(|source| source.channel == channel + 1);
    let places = heard.take(MOST_NAMED).map(|source| {
        let [.., name, _, _, _, _] = row(source, words);
        AxisMark {
            x: source.from_s,
            name,
        }
    });
    Plot {
        title: fill(said.spectrogram, &[("low", &low), ("high", &high)]),
        x_label: said.time.into(),
        y_label: said.frequency.into(),
        x_range: Some((0.0, duration_s)),
        y_reach: Some((0.0, highest)),
        raster: Some(Raster {
            x: (from_s.min(duration_s), to_s.min(duration_s)),
            y: (0.0, highest),
            columns,
            shades,
        }),
        places: places.collect(),
        ..Plot::default()
    }
}

fn eye(picture: &Picture, words: &Words) -> Option<Plot> {
    let curves = picture.eye();
    let steps = curves.first()?.len().saturating_sub(1).max(1);
    let points = curves.iter().flat_map(|curve| {
        let at = |place: usize| 2.0 * place as f64 / steps as f64;
        let points = curve.iter().enumerate();
        points
            .map(move |(place, lean)| (at(place), f64::from(*lean)))
            .chain([(0.0, f64::NAN)])
    });
    Some(Plot {
        title: words.signals.eye.into(),
        x_label: words.signals.bits.into(),
        y_label: words.signals.lean.into(),
        x_range: Some((0.0, 2.0)),
        y_reach: Some((-1.0, 1.0)),
        series: vec![line(points.collect())],
        ..Plot::default()
    })
}
