//! The span of a quantity within a window: its largest less its smallest value.

/// Smallest and largest value so far.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Span {
    least: f32,
    most: f32,
}

impl Span {
    /// Before the first window. Whoever begins a window sets [`Span::EMPTY`].
    pub const INITIAL: Self = Self { least: 0.0, most: 0.0 };

    /// Before the first value. Its width is negative.
    pub const EMPTY: Self = Self {
        least: f32::MAX,
        most: f32::MIN,
    };

    /// After the first value.
    pub const fn at(value: f32) -> Self {
        Self {
            least: value,
            most: value,
        }
    }

    /// Takes a value in.
    pub fn add(&mut self, value: f32) {
        if value < self.least {
            self.least = value;
        }
        if value > self.most {
            self.most = value;
        }
    }

    /// The span, in the unit of the values.
    pub fn width(&self) -> f32 {
        self.most - self.least
    }
}
