//! ROS 2 bags in `SQLite`: a table of topics and one of messages.
//!
//! The file is opened for reading only. A database can have endless computations instead of a table (views, virtual
//! tables, generated columns), so plain tables are required; reading of a damaged, cyclic one stops when it yields more
//! rows than the file has bytes for.

use super::found::{FoundMessages, Wanted};
use super::message::MessagePlace;
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use crate::io::refused::foreign::{self, Foreign};
use rusqlite::{Connection, OpenFlags};
use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::time::Duration;

/// Magic number of zstd: messages may be compressed one by one.
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// Kind of CDR and time stamp.
const START_BYTES: u64 = 12;
/// No row of a table is smaller than this on its page.
const MIN_ROW_BYTES: u64 = 4;
/// Max examined names of tables in a database of another program.
const MAX_TABLES: u32 = 1000;
/// Those that a message has.
const MAX_NAMED_TABLES: usize = 6;

/// Finds the wanted messages of the database at `path`.
pub(super) fn find(path: &Path, wanted: Wanted) -> Result<FoundMessages, Fault> {
    find_rows(path, wanted).map_err(|error| match (error, journal_of(path)) {
        (Failure::Sql(error), Some(journal)) => Fault::header(format!("{journal} ({error})")),
        (Failure::Sql(error), None) => match table_names(path).unwrap_or_default() {
            names if names.is_empty() => Fault::header(format!(
                "the tables `topics` and `messages` of a ROS 2 bag are not readable ({error}): the file is damaged, \
                 or is another database"
            )),
            names if has_bag_tables(&names) => Fault::header(format!(
                "the tables of the bag are not readable ({error}): the file is damaged"
            )),
            names => Fault::header(format!(
                "this is an SQLite database of another program, with the tables {}: expected `topics` and `messages` \
                 of a ROS 2 bag; save its points as CSV, for example with `sqlite3 -csv FILE 'SELECT x, y, z FROM \
                 TABLE'`",
                listed(&names)
            )),
        },
        (Failure::Said(problem), _) => Fault::header(problem),
    })
}

/// The kind of the database at `path`, if its tables belong to a known program.
pub(super) fn foreign_kind(path: &Path) -> Option<&'static Foreign> {
    let names = table_names(path).unwrap_or_default();
    if has_bag_tables(&names) {
        return None;
    }
    foreign::by_tables(&names).or_else(|| foreign::by_extension(path))
}

fn has_bag_tables(names: &[String]) -> bool {
    ["topics", "messages"]
        .iter()
        .all(|wanted| names.iter().any(|name| name == wanted))
}

/// At most [`MAX_TABLES`]; the schema of a damaged file can be of any length.
fn table_names(path: &Path) -> rusqlite::Result<Vec<String>> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let database = Connection::open_with_flags(path, flags)?;
    database.execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON;")?;
    let mut statement =
        database.prepare("SELECT name FROM sqlite_master WHERE type IN ('table', 'view') ORDER BY name LIMIT ?1")?;
    let names = statement.query_map([MAX_TABLES], |row| row.get(0))?;
    names.collect()
}

/// The first of `names`, as a list in a sentence.
fn listed(names: &[String]) -> String {
    let named = names.iter().take(MAX_NAMED_TABLES).map(|name| format!("`{name}`"));
    let more = if names.len() > MAX_NAMED_TABLES { ", …" } else { "" };
    named.collect::<Vec<_>>().join(", ") + more
}

enum Failure {
    Sql(rusqlite::Error),
    Said(String),
}

impl From<rusqlite::Error> for Failure {
    fn from(error: rusqlite::Error) -> Self {
        Self::Sql(error)
    }
}

fn open(path: &Path) -> Result<Connection, Failure> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let database = Connection::open_with_flags(path, flags)?;
    database.execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON;")?;
    for table in ["topics", "messages"] {
        let sql: String = database.query_row(
            "SELECT sql FROM sqlite_master WHERE name = ?1 AND type = 'table'",
            [table],
            |row| row.get(0),
        )?;
        let mut words = sql.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        let computes = |word: &str| word.eq_ignore_ascii_case("virtual") || word.eq_ignore_ascii_case("as");
        if words.any(computes) {
            return Err(Failure::Said(format!(
                "`{table}` is computed, expected a plain table: this is not a ROS 2 bag"
            )));
        }
    }
    Ok(database)
}

fn find_rows(path: &Path, wanted: Wanted) -> Result<FoundMessages, Failure> {
    let file_bytes = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    let mut rows_left = file_bytes / MIN_ROW_BYTES;
    let mut count = || {
        rows_left = rows_left
            .checked_sub(1)
            .ok_or_else(|| Failure::Said("the tables lead in circles: the file is damaged".to_owned()))?;
        Ok::<(), Failure>(())
    };
    let database = open(path)?;
    let mut found = FoundMessages::new(wanted);
    for damage in [cut_of(path, file_bytes), journal_of(path)].into_iter().flatten() {
        found.skip(damage);
    }
    let mut statement = database.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        count()?;
        let id: i64 = row.get(0)?;
        let (topic, kind, encoding): (String, String, String) = (row.get(1)?, row.get(2)?, row.get(3)?);
        if let Ok(id) = u32::try_from(id) {
            found.add_topic(id, &topic, &kind, &encoding);
        }
    }
    if found.is_complete() {
        return Ok(found);
    }
    let mut statement = database.prepare("SELECT rowid, topic_id, timestamp FROM messages")?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        count()?;
        let (id, topic, log_time): (i64, i64, i64) = (row.get(0)?, row.get(1)?, row.get(2)?);
        let Some(topic) = u32::try_from(topic).ok() else {
            continue;
        };
        found.count(topic, 1);
        if !found.has_topic(topic) {
            continue;
        }
        let start = match start_of(&database, id) {
            Ok(start) => start,
            Err(problem) => {
                found.skip(format!("message {id} is skipped: {problem}"));
                continue;
            }
        };
        if start.starts_with(&ZSTD_MAGIC) {
            return Err(Failure::Said(
                "the messages are packed one by one with zstd, which is not read: convert the bag with `ros2 bag \
                 convert` to one without compression, or to MCAP"
                    .to_owned(),
            ));
        }
        let log_time = Duration::from_nanos(log_time.max(0).unsigned_abs());
        found.add(topic, log_time, &start, MessagePlace::Row(id));
    }
    Ok(found)
}

/// Describes the missing part of the pages that the header counts. (<https://www.sqlite.org/fileformat2.html>)
fn cut_of(path: &Path, file_bytes: u64) -> Option<String> {
    const HEADER_BYTES: usize = 100;
    let mut header = [0; HEADER_BYTES];
    File::open(path).ok()?.read_exact(&mut header).ok()?;
    let number = |at: usize| u32::from_be_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
    let page_bytes = match u16::from_be_bytes([header[16], header[17]]) {
        1 => 1 << 16,
        bytes => u64::from(bytes),
    };
    // Old programs do not maintain the page count; then the two change counters differ.
    let is_counted = number(24) == number(92);
    let claimed = page_bytes * u64::from(number(28));
    (is_counted && claimed > file_bytes)
        .then(|| format!("the file has {file_bytes} of {claimed} bytes: it was cut, and messages in the rest are lost"))
}

/// A journal next to the database: its writer did not end cleanly.
fn journal_of(path: &Path) -> Option<String> {
    let mut journal = path.as_os_str().to_owned();
    journal.push("-journal");
    let is_there = std::fs::metadata(&journal).is_ok_and(|there| there.is_file() && there.len() > 0);
    is_there.then(|| {
        format!(
            "{} is next to it: the recording was not closed, and its last messages may be missing; open both once with \
             `sqlite3` on a disk that can be written",
            Path::new(&journal).display()
        )
    })
}

/// The first bytes of message `id` alone, not all that a query would read of it.
fn start_of(database: &Connection, id: i64) -> Result<Vec<u8>, String> {
    let mut start = Vec::with_capacity(START_BYTES as usize);
    let message = database.blob_open("main", "messages", "data", id, true);
    let message = message.map_err(|error| format!("it is not readable ({error})"))?;
    let read = message.take(START_BYTES).read_to_end(&mut start);
    read.map_err(|error| format!("it is not readable ({error})"))?;
    Ok(start)
}

/// The messages of a database that was opened.
pub(super) struct Messages(Connection);

impl Messages {
    /// Opens the messages of the database at `path`; the error is a sentence without its location.
    pub(super) fn open(path: &Path) -> Result<Self, String> {
        open(path).map(Self).map_err(said)
    }

    /// The bytes of a message; the error is a sentence without its place.
    pub(super) fn read(&self, row: i64, options: &ReadOptions) -> Result<Vec<u8>, String> {
        let read = || -> Result<Vec<u8>, Failure> {
            let mut message = self.0.blob_open("main", "messages", "data", row, true)?;
            if message.len() as u64 > options.left_bytes() {
                return Err(Failure::Said(
                    Fault::too_large("the message", message.len() as u64, options).problem,
                ));
            }
            let mut bytes = Vec::with_capacity(message.len());
            message.read_to_end(&mut bytes).map_err(|error| {
                Failure::Said(format!("the message is not readable ({error}): the file is damaged"))
            })?;
            Ok(bytes)
        };
        read().map_err(said)
    }
}

/// Returns the error message of a failure, as a sentence.
fn said(failure: Failure) -> String {
    match failure {
        Failure::Sql(error) => {
            format!("the message is not readable ({error}): the file is damaged")
        }
        Failure::Said(problem) => problem,
    }
}
