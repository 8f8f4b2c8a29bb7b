//! Tables for the terminal and for the page, made from the same rows.

use std::fmt;

use comfy_table::{CellAlignment, ContentArrangement, LineStyle, TableStyle};

/// Lines above and below the rows and under the titles; none between rows, which read well without.
const STYLE: TableStyle = TableStyle::new()
    .top_border(LineStyle::none().fill('\u{2500}').junction('\u{2500}'))
    .header_separator(LineStyle::none().fill('\u{2500}').junction('\u{2500}'))
    .bottom_border(LineStyle::none().fill('\u{2500}').junction('\u{2500}'));

/// Width below which a terminal's word is not taken for it, characters: lines are then as long as they are.
const NARROWEST: u16 = 20;

/// A column and how its cells line up.
#[derive(Clone, Debug)]
pub struct Column {
    title: String,
    numeric: bool,
}

impl Column {
    /// A column of words, aligned left.
    pub fn text(title: &str) -> Self {
        Self {
            title: title.into(),
            numeric: false,
        }
    }

    /// Figures, aligned right; put the unit in the title.
    pub fn number(title: &str) -> Self {
        Self {
            title: title.into(),
            numeric: true,
        }
    }
}

/// What a cell means, shown as colour in the page beside its words (never instead of them).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Tone {
    #[default]
    Neutral,
    Good,
    Warning,
    Bad,
}

/// One cell; text converts into it.
#[derive(Clone, Debug, Default)]
pub struct Cell {
    text: String,
    tone: Tone,
    gauge: Option<Gauge>,
}

/// A bar with a mark at its limit, in parts of the cell's width.
#[derive(Clone, Copy, Debug)]
struct Gauge {
    bar: f64,
    limit: f64,
}

/// Where the mark of a limit is in a gauge whose bar does not go far beyond it.
const LIMIT_AT: f64 = 0.7;

impl Cell {
    /// "ok", or what else says that all is well.
    pub fn good(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            tone: Tone::Good,
            gauge: None,
        }
    }

    /// A cell that needs the reader's attention; shown in amber.
    pub fn warning(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            tone: Tone::Warning,
            gauge: None,
        }
    }

    /// A cell with a failed check; shown in red.
    pub fn bad(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            tone: Tone::Bad,
            gauge: None,
        }
    }

    /// "yes" as good or "NO" as bad, for the outcome of a check.
    pub fn check(met: bool) -> Self {
        if met { Self::good("yes") } else { Self::bad("NO") }
    }

    /// A value as a bar against its limit, green where `met`. A limit of zero or of another sign than the value has no scale,
    /// and the cell is empty.
    pub fn gauge(value: f64, limit: f64, met: bool) -> Self {
        let share = value / limit;
        let gauge = (share.is_finite() && share >= 0.0).then(|| {
            let scale = LIMIT_AT / (share * LIMIT_AT).max(1.0);
            Gauge {
                bar: share * scale,
                limit: scale,
            }
        });
        Self {
            text: String::new(),
            tone: if met { Tone::Good } else { Tone::Bad },
            gauge,
        }
    }
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self {
            text: text.into(),
            tone: Tone::Neutral,
            gauge: None,
        }
    }
}

impl Gauge {
    fn to_html(self) -> String {
        let percent = |part: f64| (1000.0 * part).round() / 10.0;
        format!(
            "<i class=\"gauge\"><i style=\"width:{}%\"></i><b style=\"left:{}%\"></b></i>",
            percent(self.bar),
            percent(self.limit)
        )
    }
}

/// Rows under titled columns. `Display` is the form for a terminal.
#[derive(Clone, Debug)]
pub struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new(columns: impl IntoIterator<Item = Column>) -> Self {
        Self {
            columns: columns.into_iter().collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row; missing cells are empty, surplus ones are dropped. For rows that mix text and [`Cell`]s, convert the
    /// text with `.into()`.
    pub fn row<C: Into<Cell>>(&mut self, cells: impl IntoIterator<Item = C>) -> &mut Self {
        let mut row: Vec<Cell> = cells.into_iter().map(Into::into).collect();
        row.resize_with(self.columns.len(), Cell::default);
        self.rows.push(row);
        self
    }

    /// Number of rows in the table.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    pub(crate) fn to_html(&self) -> String {
        let align = |column: &Column| if column.numeric { " class=\"number\"" } else { "" };
        let mut html = String::from("<div class=\"scroll\"><table><thead><tr>");
        for column in &self.columns {
            html += &format!("<th{} scope=\"col\">{}</th>", align(column), escape(&column.title));
        }
        html += "</tr></thead><tbody>";
        for row in &self.rows {
            html += "<tr>";
            for (cell, column) in row.iter().zip(&self.columns) {
                let text = cell.gauge.map_or_else(|| escape(&cell.text), Gauge::to_html);
                let text = match cell.tone {
                    _ if text.is_empty() => text,
                    Tone::Neutral => text,
                    Tone::Good => format!("<span class=\"good\">{text}</span>"),
                    Tone::Warning => format!("<span class=\"warning\">{text}</span>"),
                    Tone::Bad => format!("<span class=\"bad\">{text}</span>"),
                };
                // A figure and what stands behind it stay on one line; words in a column of figures may wrap.
                let is_figure = cell
                    .text
                    .starts_with(|first: char| first.is_ascii_digit() || "+-<>".contains(first));
                let class = match (column.numeric, is_figure) {
                    (true, true) => " class=\"number figure\"",
                    _ => align(column),
                };
                html += &format!("<td{class}>{text}</td>");
            }
            html += "</tr>";
        }
        html + "</tbody></table></div>"
    }
}

impl fmt::Display for Table {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = comfy_table::Table::new();
        table
            .load_style(STYLE)
            .set_content_arrangement(ContentArrangement::Dynamic);
        // Terminals that do not know their width (of hosted CI, of some editors) call it 0.
        if table.width().is_some_and(|width| width < NARROWEST) {
            table.set_content_arrangement(ContentArrangement::Disabled);
        }
        table.set_header(self.columns.iter().map(|column| column.title.clone()));
        for row in &self.rows {
            table.add_row(row.iter().map(|cell| cell.text.clone()));
        }
        for (index, column) in self.columns.iter().enumerate() {
            if let Some(shown) = table.column_mut(index).filter(|_| column.numeric) {
                shown.set_cell_alignment(CellAlignment::Right);
            }
        }
        for line in table.lines() {
            writeln!(formatter, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// `value` with `digits` significant digits, plain between 1e-3 and 1e7 and with an exponent outside: "4.18", "1.50e9".
///
/// ```
/// use oleo_report::significant;
/// assert_eq!(significant(4.1789, 3), "4.18");
/// assert_eq!(significant(1.5e9, 3), "1.50e9");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    let digits = digits.max(1);
    if !value.is_finite() {
        return if value.is_nan() {
            "-".into()
        } else if value > 0.0 {
            "inf".into()
        } else {
            "-inf".into()
        };
    }
    let scientific = format!("{value:.*e}", digits - 1);
    let exponent: i32 = scientific
        .split_once('e')
        .and_then(|parts| parts.1.parse().ok())
        .unwrap_or(0);
    if value == 0.0 {
        "0".into()
    } else if (-3..7).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        scientific
    }
}

/// Text as it stands in HTML.
pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gauge_keeps_its_bar_and_its_limit_in_the_cell() {
        for (value, limit, bar, mark) in [
            (35.0, 50.0, 0.49, 0.7),
            (50.0, 50.0, 0.7, 0.7),
            (200.0, 50.0, 1.0, 0.25),
        ] {
            let gauge = Cell::gauge(value, limit, value <= limit).gauge.expect("a scale");
            assert!(
                (gauge.bar - bar).abs() < 1e-12 && (gauge.limit - mark).abs() < 1e-12,
                "{gauge:?}"
            );
        }
        assert!(Cell::gauge(1.0, 0.0, false).gauge.is_none() && Cell::gauge(-1.0, 2.0, true).gauge.is_none());
        let mut table = Table::new([Column::text("Figure against limit")]);
        table.row([Cell::gauge(35.0, 50.0, true)]);
        assert!(table.to_html().contains("width:49%") && table.to_html().contains("left:70%"));
    }

    fn example() -> Table {
        let mut table = Table::new([Column::text("Limit"), Column::number("Value, MPa"), Column::text("Met")]);
        table.row([Cell::from("pressure <= 20"), "19.5".into(), Cell::check(true)]);
        table.row(["travel"]);
        table
    }

    #[test]
    fn terminal_form_has_titles_and_right_aligned_figures() {
        let text = example().to_string();
        assert!(text.contains("Limit") && text.contains("yes"), "{text}");
        assert!(text.lines().any(|line| line.contains("      19.5")), "{text}");
        assert!(text.lines().all(|line| line == line.trim_end()));
    }

    #[test]
    fn html_form_escapes_and_marks() {
        let html = example().to_html();
        assert!(html.contains("pressure &lt;= 20"));
        assert!(html.contains("<span class=\"good\">yes</span>"));
        assert_eq!(html.matches("<td").count(), 6, "a short row is filled up");
    }

    #[test]
    fn significant_digits() {
        let cases = [
            (4.1789, "4.18"),
            (0.0, "0"),
            (1.5e9, "1.50e9"),
            (-0.012_34, "-0.0123"),
            (38_000.0, "38000"),
        ];
        for (value, text) in cases {
            assert_eq!(significant(value, 3), text);
        }
        assert_eq!(significant(f64::NAN, 3), "-");
        assert_eq!(significant(2.5e-7, 2), "2.5e-7");
    }
}
