//! What stands on a page, and its HTML.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::Verdict;
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
    // A value JSON cannot hold became null long before; a drawing is plain data.
    let drawing = serde_json::to_string(&figure.drawing).unwrap_or_else(|_| "{\"data\":[],\"layout\":{}}".into());
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
