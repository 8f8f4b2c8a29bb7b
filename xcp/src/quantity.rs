//! What the tables say of a quantity.

/// How a value is stored, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A byte.
    U8,
    /// Two bytes.
    U16,
    /// Four bytes.
    U32,
    /// A number in single precision; what is not valid is NaN.
    F32,
}

impl Kind {
    /// Number of bytes.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// What a description file says of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// Name. It ends in the unit, as the columns of `timeseries.csv` do.
    pub name: &'static str,
    /// What it is, in one sentence.
    pub description: &'static str,
    /// Unit; empty for a number without one.
    pub unit: &'static str,
    /// How it is stored.
    pub kind: Kind,
    /// Where a tool finds it.
    pub address: u32,
    /// Smallest and largest value that is expected, or for a parameter permitted.
    pub range: (f32, f32),
    /// Names of the values of an enumeration, by number; empty for a number.
    pub names: &'static [&'static str],
}
