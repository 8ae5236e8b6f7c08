//! Values of options, as they are written on the command line.

use std::time::Duration;

use flexframe::campbell::{AboutRest, Speeds};
use flexframe::figures::View;
use flexframe::frequencies::Frequencies;
use scene::Interpolation;

/// A number of modes.
pub fn mode_count(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| *count > 0);
    count.ok_or_else(|| "expected a whole number, 1 or more, such as 10".to_owned())
}

/// A finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| "expected a finite number".to_owned())
}

/// A time of a run.
pub fn at_time(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|time| *time >= 0.0).ok_or_else(|| "expected a time, 0 or more".to_owned())
}

/// A number above zero.
pub fn positive(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|number| *number > 0.0).ok_or_else(|| "expected a positive number".to_owned())
}

/// A relative error: a part, or per cent.
pub fn accuracy(text: &str) -> Result<f64, String> {
    let number = match text.strip_suffix('%') {
        Some(percent) => finite(percent.trim_end()).map(|percent| percent / 100.0),
        None => finite(text),
    };
    let accuracy = number.ok().filter(|accuracy| *accuracy > 0.0 && *accuracy < 1.0);
    accuracy.ok_or_else(|| "expected an error above 0 and below 1, such as 1% or 0.01".to_owned())
}

/// Seconds that are worth measuring, and that someone may wait for.
pub fn patience(text: &str) -> Result<Duration, String> {
    let seconds = finite(text).ok().filter(|seconds| (1e-3..=1e6).contains(seconds));
    seconds
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or_else(|| "expected a number of seconds from 0.001 to 1000000".to_owned())
}

/// An angular velocity by its components.
pub fn angular_velocity(text: &str) -> Result<[f64; 3], String> {
    three_numbers(text).ok_or_else(|| "expected three finite numbers, such as 0,0,6.3".to_owned())
}

/// An axis by its name, or by three numbers.
pub fn axis(text: &str) -> Result<[f64; 3], String> {
    let named = match text {
        "x" => Some([1.0, 0.0, 0.0]),
        "y" => Some([0.0, 1.0, 0.0]),
        "z" => Some([0.0, 0.0, 1.0]),
        _ => None,
    };
    named
        .or_else(|| three_numbers(text).filter(|v| *v != [0.0; 3]))
        .ok_or_else(|| "expected x, y, z, or three numbers that are not all zero, such as 0,0.6,0.8".to_owned())
}

/// The way from row to row of a table, by its name in scenes.
pub fn interpolation(text: &str) -> Result<Interpolation, String> {
    match text {
        "linear" => Ok(Interpolation::Linear),
        "monotone-cubic" => Ok(Interpolation::MonotoneCubic),
        _ => Err("expected linear or monotone-cubic".to_owned()),
    }
}

/// Three finite numbers.
fn three_numbers(text: &str) -> Option<[f64; 3]> {
    let parts = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|part| !part.is_empty());
    let numbers: Vec<f64> = parts.map(str::parse).collect::<Result<_, _>>().ok()?;
    <[f64; 3]>::try_from(numbers).ok().filter(|v| v.iter().all(|x| x.is_finite()))
}

/// A point by its coordinates.
pub fn point(text: &str) -> Result<[f64; 3], String> {
    three_numbers(text).ok_or_else(|| "expected three numbers, such as 0,0,1.5".to_owned())
}

/// Where a viewer is: on an axis, or at two angles.
pub fn view(text: &str) -> Result<View, String> {
    let angles = || {
        let (azimuth, elevation) = text.split_once(',')?;
        Some((finite(azimuth.trim()).ok()?, finite(elevation.trim()).ok()?))
    };
    let by_angles = || match angles() {
        Some((azimuth, elevation)) if (-90.0..=90.0).contains(&elevation) => Some(View { azimuth, elevation }),
        _ => None,
    };
    View::named(text).or_else(by_angles).ok_or_else(|| {
        "expected iso, xy, xz, yz, x, y, z, -x, -y, -z, or two angles in degrees, the second from -90 to 90, such as -60,25"
            .to_owned()
    })
}

/// About what the vibrations of a spinning body are.
pub fn about_rest(text: &str) -> Result<AboutRest, String> {
    match text {
        "auto" => Ok(AboutRest::Auto),
        "always" => Ok(AboutRest::Always),
        "never" => Ok(AboutRest::Never),
        _ => Err("expected auto, always or never".to_owned()),
    }
}

/// Speeds as start:end:count.
pub fn speeds(text: &str) -> Result<Speeds, String> {
    let parts: Vec<&str> = text.split(':').collect();
    let speeds = match parts[..] {
        [start, end, count] => match (start.parse(), end.parse(), count.parse()) {
            (Ok(start), Ok(end), Ok(count)) => Some(Speeds { start, end, count }),
            _ => None,
        },
        _ => None,
    };
    speeds.ok_or_else(|| "expected start:end:count, such as 0:200:50".to_owned())
}

pub fn frequencies(text: &str) -> Result<Frequencies, String> {
    let Speeds { start, end, count } = speeds(text).map_err(|_| "expected start:end:count, such as 1:2000:200")?;
    Ok(Frequencies { start, end, count })
}

/// A band of frequencies.
pub fn band(text: &str) -> Result<[f64; 2], String> {
    let expected = || "expected start:end, such as 20:2000".to_owned();
    let (start, end) = text.split_once(':').ok_or_else(expected)?;
    let [start, end] = [start, end].map(|number| finite(number.trim()));
    Ok([start.map_err(|_| expected())?, end.map_err(|_| expected())?])
}
