//! The file of a moving picture: a GIF, or a film that ffmpeg makes.
use crate::files::write_error::WriteError;

use std::fs;
use std::io;
use std::path::Path;
use std::time::Duration;

use diagnostic::{Failure, Kind};
use figures::Animation;
use foreign_program::{ForeignProgram, Limits, ProgramError, Stream, named};
use whole_file::{TemporaryFolder, write_whole};

/// Names ffmpeg, where it is not `ffmpeg`.
const FFMPEG: &str = "FLEXFRAME_FFMPEG";
/// The most time, and the most bytes of pictures and film, of anything that anybody waits for.
const LIMITS: Limits = Limits { time: Some(Duration::from_secs(6 * 3600)), bytes: Some(64 << 30), memory: None };

/// Kind of a moving picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    /// It needs no other program.
    Gif,
    /// H.264.
    Mp4,
    /// VP9.
    WebM,
}

impl Format {
    /// The kind that the ending of a name asks for, with what makes it at hand.
    ///
    /// # Errors
    /// [`Failure`] of another ending, and without an encoder.
    pub(super) fn of(path: &Path) -> Result<Self, Failure> {
        let is = |ending: &str| path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending));
        let kinds = [("gif", Self::Gif), ("mp4", Self::Mp4), ("webm", Self::WebM)];
        let format = kinds.into_iter().find(|(ending, _)| is(ending)).map(|(_, format)| format);
        let format = format.ok_or_else(|| {
            let help = "give its file a name that ends in .gif, .mp4 or .webm";
            Kind::Usage.of(path).help(help).says("the animation is a GIF or a film")
        })?;
        format.require_encoder(path)?;
        Ok(format)
    }

    /// ffmpeg's encoder, with its settings.
    fn encoder(self) -> Option<(&'static str, &'static [&'static str])> {
        match self {
            Self::Gif => None,
            Self::Mp4 => Some(("libx264", &["-crf", "18", "-preset", "medium", "-movflags", "+faststart"])),
            Self::WebM => Some((
                "libvpx-vp9",
                &["-crf", "28", "-b:v", "0", "-row-mt", "1", "-deadline", "good", "-cpu-used", "4"],
            )),
        }
    }

    fn require_encoder(self, path: &Path) -> Result<(), Failure> {
        let Some((encoder, _)) = self.encoder() else { return Ok(()) };
        let folder = temporary(path)?;
        let said = ffmpeg(path, folder.path(), &["-hide_banner".to_owned(), "-encoders".to_owned()])?;
        // Such as " V....D libx264  libx264 H.264 …".
        if said.is_done && said.output.iter().any(|line| line.split_whitespace().nth(1) == Some(encoder)) {
            return Ok(());
        }
        let other = if self == Self::Mp4 { ".webm" } else { ".mp4" };
        let help =
            format!("name an ffmpeg that has it in {FFMPEG}, or give the file a name that ends in {other} or .gif");
        Err(Kind::Io.of(path).help(help).says(format!("`{}` has no encoder {encoder}", program())))
    }

    /// Draws the frames and writes the file, whole or not at all. Tells the part that is done, 0 to 1.
    pub(super) fn write(
        self,
        animation: &Animation<'_>,
        path: &Path,
        mut progress: impl FnMut(f64),
    ) -> Result<(), Failure> {
        let Some((encoder, settings)) = self.encoder() else { return Ok(animation.save_gif(path)?) };
        let folder = temporary(path)?;
        let count = animation.frames.len() as f64;
        animation.save_pictures(folder.path(), |last| progress((last + 1) as f64 / count))?;
        let rate = format!("1000/{}", animation.frame_milliseconds);
        let film = if self == Self::Mp4 { "film.mp4" } else { "film.webm" };
        let before =
            ["-nostdin", "-hide_banner", "-loglevel", "error", "-framerate", &rate, "-i", "%05d.png", "-c:v", encoder];
        // Colours as browsers and players expect them of a small film, and no marks of the machine in the file.
        let after = [
            "-vf",
            "scale=out_color_matrix=bt709:out_range=tv",
            "-pix_fmt",
            "yuv420p",
            "-colorspace",
            "bt709",
            "-color_primaries",
            "bt709",
            "-color_trc",
            "bt709",
            "-fflags",
            "+bitexact",
            "-flags:v",
            "+bitexact",
            film,
        ];
        let arguments: Vec<String> =
            before.iter().chain(settings).chain(&after).map(|word| (*word).to_owned()).collect();
        let said = ffmpeg(path, folder.path(), &arguments)?;
        if !said.is_done {
            let said = said.error.unwrap_or_else(|| "it says nothing".to_owned());
            return Err(failed(path, &said));
        }
        let bytes = fs::read(folder.path().join(film)).map_err(of(path))?;
        write_whole(path, bytes).map_err(of(path))
    }
}

/// The output of ffmpeg, and how it has ended.
struct Said {
    is_done: bool,
    output: Vec<String>,
    /// The last line on standard error.
    error: Option<String>,
}

fn ffmpeg(path: &Path, folder: &Path, arguments: &[String]) -> Result<Said, Failure> {
    let (mut output, mut error) = (Vec::new(), None);
    let hear = |stream, line: String| match stream {
        Stream::Output => output.push(line),
        Stream::Error if line.trim().is_empty() => {}
        Stream::Error => error = Some(line.trim().to_owned()),
    };
    match ForeignProgram::new(&named(FFMPEG, "ffmpeg"), folder).args(arguments).run(LIMITS, || false, hear) {
        Ok(status) => Ok(Said { is_done: status.success(), output, error }),
        Err(ProgramError::Start(cause)) => {
            let help = format!(
                "install ffmpeg (Debian: apt install ffmpeg), name it in {FFMPEG}, or give the file a name that ends in .gif, which needs no \
                 other program"
            );
            let words = format!("a film is made by ffmpeg, but `{}` cannot be started: {cause}", program());
            Err(Kind::Io.of(path).help(help).says(words))
        }
        Err(cause) => Err(failed(path, &cause.to_string())),
    }
}

fn failed(path: &Path, said: &str) -> Failure {
    let words = format!("`{}` cannot make the film: {said}", program());
    Kind::Io.of(path).help("try a name that ends in .gif").says(words)
}

fn program() -> String {
    named(FFMPEG, "ffmpeg").to_string_lossy().into_owned()
}

fn temporary(path: &Path) -> Result<TemporaryFolder, Failure> {
    TemporaryFolder::new().map_err(of(path))
}

fn of(path: &Path) -> impl Fn(io::Error) -> Failure + use<> {
    let path = path.to_owned();
    move |error| WriteError::of(&path)(error).into()
}
