//! Where `--json` writes: stdout, a device or pipe that is written to, or a file that is replaced whole.

use std::cell::RefCell;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::print;
use crate::error::shown;
use crate::output::{Disk, Staged};
use crate::{Error, Result};

/// Links that are followed before a path is called a loop, as Linux does.
const HOPS: usize = 40;

/// What a path leads to.
#[derive(Debug, PartialEq, Eq)]
enum Place {
    Stdout,
    Stderr,
    /// A device, a FIFO or an open handle: written to.
    Stream(PathBuf),
    /// A regular file, or nothing yet: replaced by a rename in its own folder.
    File(PathBuf),
}

/// Text on its way to a path: [`Sink::deliver`] does what cannot be undone with what cannot be replaced,
/// and makes a file ready; [`Sink::publish`] gives the file its name.
#[derive(Debug)]
pub(super) struct Sink {
    place: Place,
    text: String,
    staged: RefCell<Option<Staged<'static>>>,
}

impl Sink {
    /// A sink for `text` at `path`, where `-` is stdout.
    ///
    /// # Errors
    /// [`Error::Write`] where the path leads nowhere.
    pub(super) fn new(path: &Path, text: String) -> Result<Self> {
        let place = match path == Path::new("-") {
            true => Place::Stdout,
            false => place(path).map_err(|e| Error::write(path, e))?,
        };
        Ok(Self { place, text, staged: RefCell::new(None) })
    }

    /// Writes to a stream; writes a file under a temporary name.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub(super) fn deliver(&self) -> Result<()> {
        let bytes = self.text.as_bytes();
        match &self.place {
            Place::Stdout => print(&self.text),
            Place::Stderr => quiet(io::stderr().lock().write_all(bytes), Path::new("stderr")),
            Place::Stream(path) => {
                let written = File::options().append(true).open(path);
                quiet(written.and_then(|mut stream| stream.write_all(bytes)), path)
            }
            Place::File(path) => {
                let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
                let parent = parent.unwrap_or(Path::new("."));
                fs::create_dir_all(parent).map_err(|e| Error::write(path, e))?;
                *self.staged.borrow_mut() = Some(Staged::new(&Disk, path, bytes)?);
                Ok(())
            }
        }
    }

    /// Gives a file its name; everything else has been done.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub(super) fn publish(&self) -> Result<()> {
        self.staged.borrow_mut().take().map_or(Ok(()), Staged::publish)
    }
}

/// A reader that has gone away has had enough.
fn quiet(written: io::Result<()>, path: &Path) -> Result<()> {
    match written {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|e| Error::write(path, e)),
    }
}

/// Follows the links of a path to what stands at its end. The handles under /proc are links too, but
/// what they name may be no path at all, or a file that a shell has open: they are streams.
fn place(path: &Path) -> io::Result<Place> {
    let mut path = path.to_path_buf();
    for _ in 0..HOPS {
        let meta = match fs::symlink_metadata(&path) {
            Ok(meta) => meta,
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Place::File(path)),
            Err(e) => return Err(e),
        };
        if meta.is_file() {
            return Ok(Place::File(path));
        }
        if meta.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        if !meta.is_symlink() {
            return Ok(Place::Stream(path));
        }
        let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
        let parent = parent.unwrap_or(Path::new("."));
        let real = fs::canonicalize(parent)?;
        if real.starts_with("/proc") {
            return Ok(handle(&real, path));
        }
        path = parent.join(fs::read_link(&path)?);
    }
    Err(io::Error::other(format!("{} leads in a circle", shown(&path))))
}

/// A link of a process's handles; our own stdout and stderr keep their place in the stream.
fn handle(folder: &Path, path: PathBuf) -> Place {
    let own = folder.starts_with(format!("/proc/{}", std::process::id()));
    match path.file_name().and_then(|name| name.to_str()) {
        Some("1") if own => Place::Stdout,
        Some("2") if own => Place::Stderr,
        _ => Place::Stream(path),
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn paths_lead_to_what_they_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("file"), "x").unwrap();
        symlink("file", at("link")).unwrap();
        symlink(at("link"), at("far")).unwrap();
        symlink("absent", at("dangling")).unwrap();
        symlink("loop", at("loop")).unwrap();
        assert_eq!(place(&at("file")).unwrap(), Place::File(at("file")));
        assert_eq!(place(&at("far")).unwrap(), Place::File(at("file")));
        assert_eq!(place(&at("dangling")).unwrap(), Place::File(at("absent")));
        assert_eq!(place(Path::new("/dev/null")).unwrap(), Place::Stream("/dev/null".into()));
        assert_eq!(place(Path::new("/dev/stdout")).unwrap(), Place::Stdout);
        assert_eq!(place(Path::new("/dev/fd/2")).unwrap(), Place::Stderr);
        assert!(place(&at("loop")).unwrap_err().to_string().contains("circle"));
        assert!(place(folder.path()).is_err());
        let open = File::open(at("file")).unwrap();
        let fd = std::os::fd::AsRawFd::as_raw_fd(&open);
        let path = PathBuf::from(format!("/dev/fd/{fd}"));
        assert_eq!(place(&path).unwrap(), Place::Stream(path));
    }
}
