//! An axis of a figure. Its constructor requires a quantity and a unit.

use serde_json::{Value, json};

/// Quantity, unit and scale of one axis.
#[derive(Clone, Debug)]
pub struct Axis {
    quantity: String,
    unit: String,
    logarithmic: bool,
    range: Option<(f64, f64)>,
    ticks: Option<Vec<(f64, String)>>,
}

impl Axis {
    /// Linear axis whose range follows the data. `unit` may be empty for a pure number.
    pub fn new(quantity: &str, unit: &str) -> Self {
        Self {
            quantity: quantity.into(),
            unit: unit.into(),
            logarithmic: false,
            range: None,
            ticks: None,
        }
    }

    /// Logarithmic scale; values not above zero are not drawn.
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    /// Fixed initial range in data units (also on a logarithmic axis).
    pub fn range(mut self, from: f64, to: f64) -> Self {
        self.range = Some((from, to));
        self
    }

    /// Named ticks, for states such as "open" and "closed".
    pub fn ticks<'a>(mut self, ticks: impl IntoIterator<Item = (f64, &'a str)>) -> Self {
        self.ticks = Some(ticks.into_iter().map(|(at, label)| (at, label.to_owned())).collect());
        self
    }

    /// "Force, N" or "Count" where there is no unit.
    pub fn label(&self) -> String {
        if self.unit.is_empty() {
            self.quantity.clone()
        } else {
            format!("{}, {}", self.quantity, self.unit)
        }
    }

    /// Unit as given, empty for a pure number.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// Whether the scale is logarithmic.
    pub(crate) fn is_logarithmic(&self) -> bool {
        self.logarithmic
    }

    /// The axis as plotly.js expects it.
    pub(crate) fn to_json(&self) -> Value {
        let mut axis = json!({ "title": { "text": escape_plotly(&self.label()) }, "automargin": true });
        if self.logarithmic {
            axis["type"] = json!("log");
        }
        if let Some((from, to)) = self.range {
            // plotly.js wants the range of a logarithmic axis as exponents.
            axis["range"] = if self.logarithmic {
                json!([libm::log10(from), libm::log10(to)])
            } else {
                json!([from, to])
            };
        }
        if let Some(ticks) = &self.ticks {
            axis["tickvals"] = ticks.iter().map(|tick| json!(tick.0)).collect();
            axis["ticktext"] = ticks.iter().map(|tick| json!(escape_plotly(&tick.1))).collect();
        }
        axis
    }
}

/// plotly.js reads a subset of HTML in texts: a name from a file must not become markup.
pub(crate) fn escape_plotly(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn label_carries_the_unit() {
        assert_eq!(Axis::new("Force", "kN").label(), "Force, kN");
        assert_eq!(Axis::new("Damper factor", "").label(), "Damper factor");
    }

    #[test]
    fn logarithmic_range_is_in_exponents() {
        let axis = Axis::new("Frequency", "Hz").logarithmic().range(0.1, 100.0).to_json();
        assert_eq!(axis["type"], "log");
        assert_eq!(axis["range"], json!([-1.0, 2.0]));
    }

    #[test]
    fn markup_in_a_name_stays_text() {
        assert_eq!(
            Axis::new("<b>x</b>", "").to_json()["title"]["text"],
            "&lt;b&gt;x&lt;/b&gt;"
        );
    }
}
