//! A file that a background thread writes and syncs, so that the disk never blocks the caller.
//!
//! The thread passes data to the operating system at once, so a killed program loses nothing that reached the thread.
//! It syncs the file a tenth of a second after the first unsynced write, which limits the loss in a power cut.

use std::fs::File;
use std::io::{self, Write};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time from an unsynced write to its sync.
const DELAY: Duration = Duration::from_millis(100);
/// Maximum number of pending writes; the caller blocks on further ones.
const BACKLOG: usize = 65_536;
/// Longest wait without a deadline.
const LONG: Duration = Duration::from_secs(3600);

enum Message {
    Write(Vec<u8>),
    /// Request for a reply once all earlier writes are synced.
    Sync(SyncSender<()>),
}

/// A file written in the background; see the module.
pub struct SyncedFile {
    /// `None` once closed.
    sender: Option<SyncSender<Message>>,
    thread: Option<JoinHandle<io::Result<()>>>,
}

impl SyncedFile {
    /// Starts the thread.
    pub fn new(file: File) -> io::Result<Self> {
        let (sender, receiver) = mpsc::sync_channel(BACKLOG);
        let thread = std::thread::Builder::new()
            .name("log".to_owned())
            .spawn(move || serve(file, &receiver))?;
        Ok(Self {
            sender: Some(sender),
            thread: Some(thread),
        })
    }

    /// Sends `bytes` to the thread.
    pub fn write(&mut self, bytes: Vec<u8>) -> io::Result<()> {
        self.send(Message::Write(bytes))
    }

    /// Waits until everything written so far is on disk.
    pub fn sync(&mut self) -> io::Result<()> {
        let (done, wait) = mpsc::sync_channel(1);
        self.send(Message::Sync(done))?;
        match wait.recv() {
            Ok(()) => Ok(()),
            Err(_) => self.close(),
        }
    }

    fn send(&mut self, message: Message) -> io::Result<()> {
        let sender = self.sender.as_ref();
        match sender.map(|s| s.send(message)) {
            Some(Ok(())) => Ok(()),
            // The thread has ended, which only happens after an error.
            _ => self.close().and(Err(io::ErrorKind::BrokenPipe.into())),
        }
    }

    /// Writes and syncs pending data, and ends the thread.
    fn close(&mut self) -> io::Result<()> {
        drop(self.sender.take());
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            // A panic of the thread was printed there.
            Some(Err(_)) => Err(io::Error::other("the log thread has ended")),
            None => Ok(()),
        }
    }
}

impl Drop for SyncedFile {
    fn drop(&mut self) {
        // Callers that need the error call `sync` first.
        let _ = self.close();
    }
}

fn serve(mut file: File, receiver: &Receiver<Message>) -> io::Result<()> {
    let mut due: Option<Instant> = None;
    loop {
        let now = Instant::now();
        if due.take_if(|at| *at <= now).is_some() {
            file.sync_data()?;
        }
        match receiver.recv_timeout(due.map_or(LONG, |at| at - now)) {
            Ok(Message::Write(bytes)) => {
                file.write_all(&bytes)?;
                due.get_or_insert_with(|| Instant::now() + DELAY);
            }
            Ok(Message::Sync(done)) => {
                file.sync_data()?;
                due = None;
                // The caller may no longer wait.
                let _ = done.send(());
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return file.sync_data(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_in_the_file_soon_and_at_the_latest_when_closed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        let mut file = SyncedFile::new(File::create(&path).expect("writable")).expect("a thread");
        let read = || std::fs::read_to_string(&path).expect("readable");
        file.write(b"one ".to_vec()).expect("running");
        let started = Instant::now();
        while read() != "one " {
            // Not synced and not closed, as in a killed program.
            assert!(started.elapsed() < Duration::from_secs(10));
            std::thread::yield_now();
        }
        file.write(b"two ".to_vec()).expect("running");
        file.sync().expect("on disk");
        assert_eq!(read(), "one two ");
        for _ in 0..1000 {
            file.write(b"x".to_vec()).expect("running");
        }
        drop(file);
        assert_eq!(read().len(), 1008);
    }

    /// An error of a file that cannot be written reaches the caller, at the latest with the sync.
    #[test]
    fn an_error_reaches_the_caller() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        std::fs::write(&path, "").expect("writable");
        let read_only = File::open(&path).expect("readable");
        let mut file = SyncedFile::new(read_only).expect("a thread");
        let written = file.write(b"x".to_vec());
        assert!(written.and_then(|()| file.sync()).is_err());
        assert!(file.write(b"y".to_vec()).is_err());
    }
}
