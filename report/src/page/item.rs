//! What stands on a page, and its HTML.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use serde_json::{Value, json};

use super::verdict::Verdict;
use crate::equation::to_mathml;
use crate::figure::Figure;
use crate::scene::Scene;
use crate::table::{Table, escape};

/// One thing on a page.
#[derive(Clone)]
pub(super) enum Item {
    Verdict(Verdict, String),
    Text(String),
    Table(Table),
    Details(String, Table),
    Code(String, String),
    Drawing(String, String),
    Equation(String),
    Download {
        label: String,
        name: String,
        content: String,
    },
    Figure(Box<Figure>),
    Choice(String, Vec<(String, Figure)>),
    Scene(Box<Scene>),
}

/// How many of each numbered thing have been put on the page.
#[derive(Default)]
pub(super) struct Count {
    pub(super) figures: usize,
    scenes: usize,
    choices: usize,
}

impl Count {
    /// The number of the next figure.
    fn figure(&mut self) -> usize {
        self.figures += 1;
        self.figures
    }
}

impl Item {
    pub(super) fn to_html(&self, count: &mut Count) -> String {
        match self {
            Self::Verdict(verdict, sentence) => {
                let class = match verdict {
                    Verdict::Pass => "good",
                    Verdict::Attention => "warning",
                    Verdict::Fail => "bad",
                };
                format!("<div class=\"verdict {class}\">{}</div>\n", escape(sentence))
            }
            Self::Text(text) => format!("<p>{}</p>\n", escape(text)),
            Self::Table(table) => table.to_html() + "\n",
            Self::Details(summary, table) => {
                format!(
                    "<details><summary>{}</summary>{}</details>\n",
                    escape(summary),
                    table.to_html()
                )
            }
            Self::Code(summary, text) => {
                format!(
                    "<details><summary>{}</summary><pre>{}</pre></details>\n",
                    escape(summary),
                    escape(text)
                )
            }
            Self::Drawing(svg, caption) => {
                format!("<figure>{svg}<figcaption>{}</figcaption></figure>\n", escape(caption))
            }
            Self::Figure(figure) => figure_html(figure, count.figure()),
            Self::Equation(text) => format!("<div class=\"equation\">{}</div>\n", to_mathml(text)),
            Self::Download { label, name, content } => format!(
                "<p><a class=\"download\" download=\"{}\" href=\"data:text/csv;base64,{}\">{}</a></p>\n",
                escape(name),
                STANDARD.encode(content),
                escape(label)
            ),
            Self::Choice(label, figures) => choice_html(label, figures, count),
            Self::Scene(scene) => {
                count.scenes += 1;
                scene.to_html(count.scenes)
            }
        }
    }
}

fn figure_html(figure: &Figure, number: usize) -> String {
    let drawing = drawing_json(figure).to_string();
    // "</script>" inside the data would end it.
    let drawing = drawing.replace("</", "<\\/");
    let link = figure
        .link
        .as_ref()
        .map_or(String::new(), |name| format!(" data-link=\"{}\"", escape(name)));
    let caption = if figure.caption.is_empty() {
        String::new()
    } else {
        format!("<figcaption>{}</figcaption>", escape(&figure.caption))
    };
    format!(
        "<figure><h3>{title}</h3><div class=\"chart\" id=\"figure-{number}\" style=\"height:{height}px\"{link}></div>{caption}\
         <script type=\"application/json\" id=\"figure-{number}-data\">{drawing}</script></figure>\n",
        title = escape(&figure.title),
        height = figure.height_px,
    )
}

/// Fewest values of a series that is worth a reference.
const SHARED: usize = 50;

/// The figure as plotly.js takes it, but a series on the same places as an earlier one has the number of that one as its `x`, which
/// the page's script puts in: the places are half of the data of most pages.
fn drawing_json(figure: &Figure) -> Value {
    // A value JSON cannot hold became null long before; a drawing is plain data.
    let mut drawing = serde_json::to_value(&figure.drawing).unwrap_or_else(|_| json!({ "data": [], "layout": {} }));
    let Some(data) = drawing["data"].as_array_mut() else {
        return drawing;
    };
    for index in 1..data.len() {
        let (before, rest) = data.split_at_mut(index);
        let x = &mut rest[0]["x"];
        if x.as_array().is_none_or(|x| x.len() < SHARED) {
            continue;
        }
        if let Some(same) = before.iter().position(|trace| trace["x"] == *x) {
            *x = json!(same);
        }
    }
    drawing
}

/// Figures behind buttons; the first is shown.
fn choice_html(label: &str, figures: &[(String, Figure)], count: &mut Count) -> String {
    count.choices += 1;
    let group = count.choices;
    let (mut buttons, mut shown) = (String::new(), String::new());
    for (index, (name, figure)) in figures.iter().enumerate() {
        let (checked, hidden) = if index == 0 { (" checked", "") } else { ("", " hidden") };
        buttons += &format!(
            "<label><input type=\"radio\" name=\"choice-{group}\" value=\"{index}\"{checked}>{}</label>",
            escape(name)
        );
        shown += &format!(
            "<div class=\"option\"{hidden}>{}</div>",
            figure_html(figure, count.figure())
        );
    }
    format!(
        "<div class=\"choice\"><fieldset><legend>{}</legend>{buttons}</fieldset>{shown}</div>\n",
        escape(label)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Curves};

    #[test]
    fn places_that_series_share_are_in_the_page_once() {
        let time: Vec<f64> = (0..100).map(f64::from).collect();
        let later: Vec<f64> = time.iter().map(|t| t + 0.5).collect();
        let mut curves = Curves::new("Strut", Axis::new("Time", "s"));
        curves.panel(Axis::new("Force", "N"));
        curves
            .line("a", &time, &time)
            .line("b", &later, &time)
            .line("c", &time, &later);
        curves
            .line("short", &[0.0, 1.0], &[0.0, 1.0])
            .line("as short", &[0.0, 1.0], &[1.0, 0.0]);
        let drawing = drawing_json(&curves.into());
        let x = |trace: usize| &drawing["data"][trace]["x"];
        assert_eq!(
            (x(0).as_array().map(Vec::len), x(1).as_array().map(Vec::len)),
            (Some(100), Some(100))
        );
        assert_eq!((x(2), x(4)), (&json!(0), &json!([0.0, 1.0])));
    }
}
