//! Tables as other programs write them, of any layout.

use std::sync::Arc;

use parquet::basic::Compression;
use parquet::data_type::{
    BoolType, ByteArrayType, DoubleType, FixedLenByteArrayType, FloatType, Int32Type, Int64Type,
};
use parquet::file::properties::{WriterProperties, WriterVersion};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::parser::parse_message_type;
use protocol::Random;

use super::super::series::plain;
use super::*;

/// Stored form of the whole number `n` in a table: text before and behind the column's name, and the divisor of the
/// number.
type Layout = (&'static str, &'static str, f64);
const NUMBERS: [Layout; 14] = [
    ("int32", "", 1.0),
    ("int32", "(INTEGER(32,false))", 1.0),
    ("int32", "(INTEGER(16,true))", 1.0),
    ("int32", "(DECIMAL(9,2))", 100.0),
    ("int64", "", 1.0),
    ("int64", "(INTEGER(64,false))", 1.0),
    ("int64", "(DECIMAL(18,4))", 10_000.0),
    ("fixed_len_byte_array(9)", "(DECIMAL(20,3))", 1_000.0),
    ("binary", "(DECIMAL(20,3))", 1_000.0),
    ("binary", "(STRING)", 1.0),
    ("float", "", 1.0),
    ("double", "", 1.0),
    ("fixed_len_byte_array(2)", "(FLOAT16)", 1.0),
    ("boolean", "", 1.0),
];
/// Layouts of times, each with the µs in its unit.
const TIMES: [Layout; 5] = [
    ("int32", "(TIME(MILLIS,true))", 1e-3),
    ("int64", "(TIME(MICROS,true))", 1.0),
    ("int64", "(TIMESTAMP(MILLIS,true))", 1e-3),
    ("int64", "(TIMESTAMP(MICROS,false))", 1.0),
    ("int64", "(TIMESTAMP(NANOS,true))", 1e3),
];
/// Headings of times that are plain numbers, and how many of them one µs is.
const UNITS: [(&str, f64); 5] = [
    ("time", 1e-6),
    ("time_s", 1e-6),
    ("time_ms", 1e-3),
    ("time_us", 1.0),
    ("time_ns", 1e3),
];
const COMPRESSIONS: [fn() -> Compression; 6] = [
    || Compression::UNCOMPRESSED,
    || Compression::SNAPPY,
    || Compression::GZIP(Default::default()),
    || Compression::BROTLI(Default::default()),
    || Compression::LZ4_RAW,
    || Compression::ZSTD(Default::default()),
];

/// One column: its name, how its numbers are stored, and the numbers, of which some may be missing.
struct Column {
    name: String,
    layout: Layout,
    numbers: Vec<Option<i64>>,
}

impl Column {
    /// Whole numbers that any of the layouts holds.
    fn drawn(name: String, chance: &mut Random, rows: usize) -> Self {
        let layout = NUMBERS[chance.below(NUMBERS.len())];
        let gaps = [0.0, 0.3][chance.below(2)];
        let (least, most) = match layout {
            ("boolean", ..) => (0, 2),
            (_, "(INTEGER(32,false))" | "(INTEGER(64,false))", _) => (0, 4_000_000_000),
            (_, "(FLOAT16)", _) => (-2_048, 4_097),
            (_, "(INTEGER(16,true))", _) => (-32_768, 65_536),
            ("float", ..) => (-1 << 24, 1 << 25),
            _ => (-1_000_000_000, 2_000_000_000),
        };
        let mut number = || least + chance.below(most) as i64;
        let numbers: Vec<_> = (0..rows).map(|_| number()).collect();
        let numbers = numbers
            .into_iter()
            .map(|number| (!chance.chance(gaps)).then_some(number))
            .collect();
        Self {
            name,
            layout,
            numbers,
        }
    }

    /// Line of the column in the table's schema.
    fn declared(&self) -> String {
        let (before, behind, _) = self.layout;
        let is_whole = self.numbers.iter().all(Option::is_some);
        let how = if is_whole { "required" } else { "optional" };
        format!("{how} {before} {} {behind};", self.name)
    }

    fn write(&self, column: &mut SerializedColumnWriter<'_>, rows: Range<usize>) {
        let numbers = &self.numbers[rows];
        let levels: Vec<_> = numbers.iter().map(|n| i16::from(n.is_some())).collect();
        let levels = (self.numbers.iter().any(Option::is_none)).then_some(&*levels);
        let known = || numbers.iter().copied().flatten();
        macro_rules! put {
            ($kind:ty, $of:expr) => {
                column
                    .typed::<$kind>()
                    .write_batch(&known().map($of).collect::<Vec<_>>(), levels, None)
                    .expect("written")
            };
        }
        match self.layout {
            ("int32", ..) => put!(Int32Type, |n| n as i32),
            ("int64", ..) => put!(Int64Type, |n| n),
            ("float", ..) => put!(FloatType, |n| n as f32),
            ("double", ..) => put!(DoubleType, |n| n as f64),
            ("boolean", ..) => put!(BoolType, |n| n == 1),
            ("binary", "(STRING)", _) => {
                put!(ByteArrayType, |n| n.to_string().into_bytes().into())
            }
            ("binary", ..) => put!(ByteArrayType, |n| n.to_be_bytes().to_vec().into()),
            (_, "(FLOAT16)", _) => put!(FixedLenByteArrayType, |n| half(n).to_vec().into()),
            _ => put!(FixedLenByteArrayType, |n| {
                i128::from(n).to_be_bytes()[7..].to_vec().into()
            }),
        };
    }
}

/// A whole number up to 2^12 as IEEE 754 of 16 bits.
fn half(number: i64) -> [u8; 2] {
    let size = number.unsigned_abs() as u16;
    let exponent = size.checked_ilog2();
    let bits = exponent.map_or(0, |exponent| {
        let fraction = (u32::from(size) << 10 >> exponent) as u16 & 0x3ff;
        (exponent as u16 + 15) << 10 | fraction
    });
    let sign = if number < 0 { 0x8000 } else { 0 };
    (sign | bits).to_le_bytes()
}

/// Goal: values of a table of another program are right. Method: 200 tables of random columns, time columns, groups of rows,
/// compressions, pages and gaps; each value and time is held against the number that was written.
#[test]
fn tables_of_any_layout_keep_their_values() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("t.parquet");
    for seed in 0..200 {
        let chance = &mut Random::new(seed);
        let rows = 1 + chance.below(40);
        let mut columns: Vec<_> = (0..1 + chance.below(5))
            .map(|n| Column::drawn(format!("signal_{n}"), chance, rows))
            .collect();
        let (time, one_us) = times(chance, rows);
        let place = chance.below(columns.len() + 1);
        columns.insert(place, time);
        write(&path, &columns, chance);
        let time = columns.remove(place);
        let known: Vec<_> = columns.iter().map(|column| plain(&column.name)).collect();
        let read = read(&path, &known, &Columns::default());
        let read = read.unwrap_or_else(|refused| panic!("seed {seed}: {refused}"));
        let (table, (_, meaning, parts)) = (&read.tables[0], time.layout);
        assert_eq!(read.is_utc, meaning.contains("STAMP"), "seed {seed}");
        let at_us = |row: usize| time.numbers[row].expect("a time") as f64 / parts / one_us;
        let mut order: Vec<_> = (0..rows).collect();
        order.sort_by_key(|row| at_us(*row).round() as i64);
        for (to, row) in order.into_iter().enumerate() {
            let off = table.times_us[to] as f64 - at_us(row);
            assert!(
                off.abs() <= 0.5 + at_us(row) * 1e-15,
                "seed {seed}: {off} µs"
            );
            for (column, read) in columns.iter().zip(&table.columns) {
                let (name, number) = (&column.name, column.numbers[row]);
                let value = number.map_or(f64::NAN, |number| number as f64 / column.layout.2);
                let same = value == read[to] || value.is_nan() && read[to].is_nan();
                assert!(same, "seed {seed}, {name}: {value} is {}", read[to]);
            }
        }
    }
}

/// Times, no two alike, and how many of their unit one µs is.
fn times(chance: &mut Random, rows: usize) -> (Column, f64) {
    let mut numbers: Vec<_> = (0..rows).map(|row| Some(row as i64 * 9_001)).collect();
    (1..rows).for_each(|row| numbers.swap(row, chance.below(row + 1)));
    let of = |name: &str, layout| Column {
        name: name.to_owned(),
        layout,
        numbers,
    };
    if chance.chance(0.4) {
        let (before, behind, one_us) = TIMES[chance.below(TIMES.len())];
        return (of("seen_at_time", (before, behind, 1.0)), one_us);
    }
    let numbers = NUMBERS.map(|layout| match layout {
        ("float" | "boolean", ..) | (_, "(INTEGER(16,true))" | "(FLOAT16)" | "(STRING)", _) => {
            NUMBERS[0]
        }
        other => other,
    });
    let (name, one_us) = UNITS[chance.below(UNITS.len())];
    (of(name, numbers[chance.below(numbers.len())]), one_us)
}

/// Writes a table in one to three groups of rows.
fn write(path: &Path, columns: &[Column], chance: &mut Random) {
    let lines: String = columns.iter().map(Column::declared).collect();
    let schema = parse_message_type(&format!("message t {{ {lines} }}")).expect("a schema");
    let version = [WriterVersion::PARQUET_1_0, WriterVersion::PARQUET_2_0][chance.below(2)];
    let properties = WriterProperties::builder()
        .set_compression(COMPRESSIONS[chance.below(COMPRESSIONS.len())]())
        .set_dictionary_enabled(chance.chance(0.5))
        .set_data_page_row_count_limit(1 + chance.below(20))
        .set_write_batch_size(1 + chance.below(20))
        .set_writer_version(version);
    let file = File::create(path).expect("a file");
    let mut writer =
        SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties.build()))
            .expect("a writer");
    let rows = columns[0].numbers.len();
    let at_once = rows.div_ceil(1 + chance.below(3));
    for begin in (0..rows).step_by(at_once) {
        let mut group = writer.next_row_group().expect("a group");
        for column in columns {
            let mut writer = group.next_column().expect("a column").expect("one more");
            column.write(&mut writer, begin..rows.min(begin + at_once));
            writer.close().expect("closed");
        }
        group.close().expect("closed");
    }
    writer.close().expect("closed");
}

/// Goal: a row is named by its number in the file. Method: the second row of the second group has no time.
#[test]
fn a_wrong_row_is_counted_from_the_beginning_of_the_file() {
    let schema = "message t { required double time_s; required double speed; }";
    let schema = Arc::new(parse_message_type(schema).expect("a schema"));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("t.parquet");
    let file = File::create(&path).expect("a file");
    let mut writer = SerializedFileWriter::new(file, schema, Default::default());
    let writer = writer.as_mut().expect("a writer");
    for numbers in [[0.0, 1.0], [2.0, f64::NAN]] {
        let mut group = writer.next_row_group().expect("a group");
        while let Some(mut column) = group.next_column().expect("a column") {
            let written = column
                .typed::<DoubleType>()
                .write_batch(&numbers, None, None);
            written.expect("written");
            column.close().expect("closed");
        }
        group.close().expect("closed");
    }
    writer.finish().expect("closed");
    let wrong = read(&path, &[plain("speed")], &Columns::default());
    let wrong = wrong.expect_err("no time").to_string();
    assert!(wrong.ends_with("row 4: NaN is no time"), "{wrong}");
}
