//! The table of keys, ranges and units that stands beside every struct of a model file.
//!
//! It is data, so that the check, the documentation and a schema of the file are made from the same lines.

use serde::Serialize;

use super::error::InvalidValue;
use super::path::Step;
use super::range::{Number, Range};

/// A number of a model file as its table of limits describes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Key in the file.
    pub key: &'static str,
    /// Values that it may have.
    pub range: Range,
    /// Unit, empty for a ratio or a count.
    pub unit: &'static str,
}

impl Quantity {
    /// Refuse a number outside the range.
    ///
    /// # Errors
    /// The number, the range and the unit, under `step`.
    pub fn check(&self, number: f64, step: impl Into<Step>) -> Result<(), InvalidValue> {
        if self.range.contains(number) {
            return Ok(());
        }
        let what = format!("is {}: {}", Number(number), self.range.demand(self.unit));
        Err(InvalidValue::new(step, what))
    }
}

/// A quantity together with the way to read it from the struct `T`.
pub struct Limit<T> {
    quantity: Quantity,
    field: Field<T>,
}

/// How a quantity is held by a struct.
enum Field<T> {
    One(fn(&T) -> f64),
    Optional(fn(&T) -> Option<f64>),
    List(fn(&T) -> &[f64]),
}

impl<T> Limit<T> {
    /// The limit of a single number.
    pub const fn one(key: &'static str, range: Range, unit: &'static str, field: fn(&T) -> f64) -> Self {
        let quantity = Quantity { key, range, unit };
        let field = Field::One(field);
        Self { quantity, field }
    }

    /// A number that may be absent.
    pub const fn optional(key: &'static str, range: Range, unit: &'static str, field: fn(&T) -> Option<f64>) -> Self {
        let quantity = Quantity { key, range, unit };
        let field = Field::Optional(field);
        Self { quantity, field }
    }

    /// An array of numbers, each of which must lie in the range.
    pub const fn list(key: &'static str, range: Range, unit: &'static str, field: fn(&T) -> &[f64]) -> Self {
        let quantity = Quantity { key, range, unit };
        let field = Field::List(field);
        Self { quantity, field }
    }

    fn check(&self, holder: &T) -> Result<(), InvalidValue> {
        let key = self.quantity.key;
        match self.field {
            Field::One(field) => self.quantity.check(field(holder), key),
            Field::Optional(field) => field(holder).map_or(Ok(()), |number| self.quantity.check(number, key)),
            Field::List(field) => (field(holder).iter().enumerate())
                .try_for_each(|(position, number)| self.quantity.check(*number, position))
                .map_err(|invalid| invalid.inside(key)),
        }
    }
}

/// A struct of a model file that knows which values it may have.
pub trait Checked: Sized + 'static {
    /// One line for each of its numbers: key, range, unit, field.
    const LIMITS: &'static [Limit<Self>];

    /// Refuse what the range of a single number cannot tell: the order of a list, two keys that contradict each other,
    /// the tables within this one.
    ///
    /// # Errors
    /// The first value that is not allowed.
    fn check_together(&self) -> Result<(), InvalidValue> {
        Ok(())
    }

    /// Refuse impossible values, in this table and in all within it.
    ///
    /// # Errors
    /// The first value that is not allowed.
    fn check(&self) -> Result<(), InvalidValue> {
        Self::LIMITS.iter().try_for_each(|limit| limit.check(self))?;
        self.check_together()
    }

    /// The numbers of this table, for documentation and schemas.
    fn quantities() -> Vec<Quantity> {
        Self::LIMITS.iter().map(|limit| limit.quantity).collect()
    }
}

/// Check a table that stands under `key` in the one around it.
///
/// # Errors
/// The first value that is not allowed, with its path.
pub fn checked(part: &impl Checked, key: &'static str) -> Result<(), InvalidValue> {
    part.check().map_err(|invalid| invalid.inside(key))
}

/// Check the entries of an array of tables that stands under `key`.
///
/// # Errors
/// The first value that is not allowed, with its path.
pub fn each_checked(parts: &[impl Checked], key: &'static str) -> Result<(), InvalidValue> {
    (parts.iter().enumerate())
        .try_for_each(|(position, part)| part.check().map_err(|invalid| invalid.inside(position)))
        .map_err(|invalid| invalid.inside(key))
}

/// Refuse a list of fewer than two numbers or one that does not increase. The numbers must be known to be finite.
///
/// # Errors
/// The key with the number of entries, or the first entry that is not above the one before it.
pub fn increasing(key: &'static str, numbers: &[f64]) -> Result<(), InvalidValue> {
    if numbers.len() < 2 {
        let what = format!("has {} entries: must have two or more", numbers.len());
        return Err(InvalidValue::new(key, what));
    }
    match (1..numbers.len()).find(|&k| numbers[k] <= numbers[k - 1]) {
        None => Ok(()),
        Some(k) => {
            let (number, before) = (Number(numbers[k]), Number(numbers[k - 1]));
            let what = format!("is {number}: must be above the entry before it, which is {before}");
            Err(InvalidValue::new(k, what).inside(key))
        }
    }
}

/// Refuse a list that has not as many numbers as another.
///
/// # Errors
/// The key with both lengths.
pub fn as_many(key: &'static str, numbers: &[f64], as_key: &'static str, others: &[f64]) -> Result<(), InvalidValue> {
    if numbers.len() == others.len() {
        return Ok(());
    }
    let (has, wanted) = (numbers.len(), others.len());
    let what = format!("has {has} entries: must have as many as {as_key}, which has {wanted}");
    Err(InvalidValue::new(key, what))
}

/// Keys of the numbers that `example` writes into a file and for which its table has no line, or the other way about.
///
/// For tests: a struct whose numbers are not all in its table of limits would be read without being checked.
pub fn forgotten_keys<T: Checked + Serialize>(example: &T) -> Vec<String> {
    let Ok(toml::Value::Table(written)) = toml::Value::try_from(example) else {
        return vec!["not a table".to_owned()];
    };
    let is_number = |value: &toml::Value| value.is_float() || value.is_integer();
    let numbers: Vec<&String> = written
        .iter()
        .filter(|(_, value)| is_number(value) || value.as_array().is_some_and(|all| all.iter().all(is_number)))
        .map(|(key, _)| key)
        .collect();
    let listed: Vec<&str> = T::LIMITS.iter().map(|limit| limit.quantity.key).collect();
    let unlisted = numbers
        .iter()
        .filter(|key| !listed.contains(&key.as_str()))
        .map(|key| key.to_string());
    let unwritten = listed
        .iter()
        .filter(|key| !numbers.iter().any(|n| n == *key))
        .map(|key| (*key).to_owned());
    unlisted.chain(unwritten).collect()
}
