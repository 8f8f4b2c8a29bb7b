//! A curve and a size.

use std::fmt;
use std::str::FromStr;

use super::curve::Curve;
use crate::failure::Failure;

/// A point of a curve; `vehicles:100` on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Point {
    pub curve: Curve,
    pub size: u64,
}

impl Point {
    /// Why a point could not be measured.
    pub fn failed(self, why: &str) -> Failure {
        Failure::new(format!("{self}: {why}"))
    }
}

impl fmt::Display for Point {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}:{}", self.curve, self.size)
    }
}

impl FromStr for Point {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let read = || -> Option<Self> {
            let (curve, size) = text.split_once(':')?;
            Some(Self {
                curve: curve.parse().ok()?,
                size: size.parse().ok().filter(|size| *size > 0)?,
            })
        };
        read().ok_or_else(|| "give a curve and a size, such as vehicles:100".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_read_as_it_is_written() {
        let point = Point {
            curve: Curve::LogFrames,
            size: 300,
        };
        assert_eq!(point.to_string(), "log-frames:300");
        assert_eq!("log-frames:300".parse(), Ok(point));
        for wrong in ["log-frames", "log-frames:0", "log:3", "log-frames:-1"] {
            assert!(wrong.parse::<Point>().is_err(), "{wrong}");
        }
    }
}
