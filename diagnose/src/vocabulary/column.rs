//! Columns of a recording.

use std::borrow::Cow;
use std::fmt;

/// A column of a recording, named after its quantity and its SI unit.
///
/// ```
/// use oleo_diagnose::vocabulary::Column;
///
/// let p1 = Column::known("p1_Pa");
/// assert_eq!((p1.quantity(), p1.unit()), ("p1", "Pa"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Column(Cow<'static, str>);

impl Column {
    /// Displacement of the actuator or the piston, m.
    pub const DISPLACEMENT: Self = Self::known("displacement_m");
    /// Force of the load cell, N.
    pub const FORCE: Self = Self::known("force_N");

    /// Position of the carriage of a drive, m.
    pub const POSITION: Self = Self::known("position_m");

    /// A column that a kind of specimen always has.
    #[must_use]
    pub const fn known(name: &'static str) -> Self {
        Self(Cow::Borrowed(name))
    }

    /// A column that a model file names.
    #[must_use]
    pub const fn named(name: String) -> Self {
        Self(Cow::Owned(name))
    }

    /// The name as the file's header has it.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The quantity: the name without its unit.
    #[must_use]
    pub fn quantity(&self) -> &str {
        self.0.rsplit_once('_').map_or(&self.0, |(quantity, _)| quantity)
    }

    /// The unit: what follows the last underscore; empty where there is none.
    #[must_use]
    pub fn unit(&self) -> &str {
        self.0.rsplit_once('_').map_or("", |(_, unit)| unit)
    }
}

impl fmt::Display for Column {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.0)
    }
}

impl PartialEq<&str> for Column {
    fn eq(&self, other: &&str) -> bool {
        self.0 == *other
    }
}
