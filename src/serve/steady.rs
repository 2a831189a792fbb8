//! Sends to a client that has to take it at a least rate.

use crate::deadlines::MinRate;
use std::io::{self, ErrorKind, Write as _};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Bytes handed to the system at a time: the granularity of progress.
const PIECE_BYTES: usize = 1 << 16;

/// The output to a client, for one answer or message.
pub(super) struct SteadyWriter<'a> {
    stream: &'a TcpStream,
    min: MinRate,
    begun: Instant,
    sent_bytes: u64,
}

impl<'a> SteadyWriter<'a> {
    /// Creates the output; the minimum rate counts from now on.
    pub(super) fn new(stream: &'a TcpStream, min: MinRate) -> Self {
        Self {
            stream,
            min,
            begun: Instant::now(),
            sent_bytes: 0,
        }
    }

    /// Sends all of `bytes`; `note` hears how many were taken each time.
    ///
    /// # Errors
    /// The system's; [`ErrorKind::TimedOut`] for a client that takes them too slowly.
    pub(super) fn write(&mut self, mut bytes: &[u8], mut note: impl FnMut(usize)) -> io::Result<()> {
        while !bytes.is_empty() {
            let elapsed = self.begun.elapsed();
            let Some(left) = self.min.time_left(self.sent_bytes, elapsed) else {
                return Err(self.too_slow(elapsed));
            };
            // Zero would mean forever.
            self.stream
                .set_write_timeout(Some(left.max(Duration::from_millis(1))))?;
            match self.stream.write(&bytes[..bytes.len().min(PIECE_BYTES)]) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => {
                    bytes = &bytes[count..];
                    self.sent_bytes += count as u64;
                    note(count);
                }
                Err(error)
                    if matches!(
                        error.kind(),
                        ErrorKind::Interrupted | ErrorKind::WouldBlock | ErrorKind::TimedOut
                    ) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    fn too_slow(&self, elapsed: Duration) -> io::Error {
        let text = format!(
            "it has taken {} bytes in {:.0} seconds, expected {:.0} per second",
            self.sent_bytes,
            elapsed.as_secs_f64(),
            self.min.bytes_per_s
        );
        io::Error::new(ErrorKind::TimedOut, text)
    }
}
