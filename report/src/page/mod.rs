//! The one page a run leaves for people: what was run, the outcome first, then the figures. Everything it needs is inside
//! it, so it opens from a disk, a mail or an archive years later; the drawing library is in it once.

mod item;
mod library;
#[cfg(any(test, not(feature = "packed")))]
mod packing;
mod verdict;

use item::{Count, Item};
use library::library;
pub use verdict::Verdict;

use crate::figure::Figure;
use crate::scene::Scene;
use crate::table::{Table, escape};

/// A page being put together, top to bottom. Texts are plain: markup in them is shown, not obeyed.
#[derive(Clone)]
pub struct Page {
    title: String,
    command: String,
    facts: Vec<(String, String)>,
    sections: Vec<Section>,
    topic: Option<String>,
}

/// A stretch of the page under a heading (the first has none).
#[derive(Clone, Default)]
struct Section {
    heading: String,
    items: Vec<(Option<String>, Item)>,
}

impl Page {
    /// `command` is the command line that makes this page again.
    pub fn new(title: &str, command: &str) -> Self {
        Self {
            title: title.into(),
            command: command.into(),
            facts: Vec::new(),
            sections: vec![Section::default()],
            topic: None,
        }
    }

    /// A line in the head of the page: what strut, which road, which seed.
    pub fn fact(&mut self, name: &str, value: &str) -> &mut Self {
        self.facts.push((name.into(), value.into()));
        self
    }

    /// The outcome in a sentence.
    pub fn verdict(&mut self, verdict: Verdict, sentence: &str) -> &mut Self {
        self.push(Item::Verdict(verdict, sentence.into()))
    }

    /// The table that says how the run came out; also what belongs on standard output.
    pub fn outcome(&mut self, table: Table) -> &mut Self {
        self.push(Item::Table(table))
    }

    /// Starts a section; what follows is in it, and of no topic.
    pub fn section(&mut self, heading: &str) -> &mut Self {
        self.topic = None;
        self.sections.push(Section {
            heading: heading.into(),
            items: Vec::new(),
        });
        self
    }

    /// Adds a paragraph of text.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.push(Item::Text(text.into()))
    }

    /// A table in full.
    pub fn table(&mut self, table: Table) -> &mut Self {
        self.push(Item::Table(table))
    }

    /// A long table behind a line to click.
    pub fn details(&mut self, summary: &str, table: Table) -> &mut Self {
        self.push(Item::Details(summary.into(), table))
    }

    /// Text to copy, such as a file, behind a line to click.
    pub fn code(&mut self, summary: &str, text: &str) -> &mut Self {
        self.push(Item::Code(summary.into(), text.into()))
    }

    /// What follows is about a topic, or several with spaces between them, until the next section or topic. A click on an element
    /// of a drawing with one of them as its `data-topic` shows the items of that topic only. `None` is what is always shown.
    pub fn topic(&mut self, topic: Option<&str>) -> &mut Self {
        self.topic = topic.map(str::to_owned);
        self
    }

    /// An equation that is written as plain text, such as `dp/dt = beta / V (A dx/dt - Q)`.
    pub fn equation(&mut self, text: &str) -> &mut Self {
        self.push(Item::Equation(text.into()))
    }

    /// A link that saves `content` as a file of this name.
    pub fn download(&mut self, label: &str, name: &str, content: &str) -> &mut Self {
        self.push(Item::Download {
            label: label.into(),
            name: name.into(),
            content: content.into(),
        })
    }

    /// Figures of the same kind of which one is shown at a time, each with the word that selects it.
    pub fn choice(&mut self, label: &str, figures: impl IntoIterator<Item = (String, Figure)>) -> &mut Self {
        self.push(Item::Choice(label.into(), figures.into_iter().collect()))
    }

    /// A drawing that moves.
    pub fn scene(&mut self, scene: Scene) -> &mut Self {
        self.push(Item::Scene(Box::new(scene)))
    }

    /// A drawing of one's own as an `<svg>` element, shown as it is, with words under it. Draw with `currentColor` and the
    /// page's classes, so that it can be seen on light and dark grounds.
    pub fn drawing(&mut self, svg: &str, caption: &str) -> &mut Self {
        self.push(Item::Drawing(svg.into(), caption.into()))
    }

    /// A [`Curves`](crate::Curves), [`Lanes`](crate::Lanes), [`Dots`](crate::Dots), [`Field`](crate::Field) or
    /// [`Bars`](crate::Bars).
    pub fn figure(&mut self, figure: impl Into<Figure>) -> &mut Self {
        self.push(Item::Figure(Box::new(figure.into())))
    }

    fn push(&mut self, item: Item) -> &mut Self {
        if let Some(section) = self.sections.last_mut() {
            section.items.push((self.topic.clone(), item));
        }
        self
    }

    /// The page as HTML. The same page has the same bytes.
    pub fn render(&self) -> String {
        let mut body = String::new();
        let mut count = Count::default();
        for (index, section) in self.sections.iter().enumerate() {
            if index > 0 {
                body += &format!(
                    "<section id=\"section-{index}\"><h2>{}</h2>\n",
                    escape(&section.heading)
                );
            }
            for (topic, item) in &section.items {
                let html = item.to_html(&mut count);
                body += &match topic {
                    Some(topic) => format!("<div data-topic=\"{}\">{html}</div>\n", escape(topic)),
                    None => html,
                };
            }
            if index > 0 {
                body += "</section>\n";
            }
        }
        let title = escape(&self.title);
        let command = escape(&self.command);
        let version = env!("CARGO_PKG_VERSION");
        let mut facts =
            format!("<dt>Command</dt><dd><code>{command}</code></dd><dt>Version</dt><dd>oleo {version}</dd>");
        for (name, value) in &self.facts {
            facts += &format!("<dt>{}</dt><dd>{}</dd>", escape(name), escape(value));
        }
        // No library where there is nothing to draw: such a page is a few kilobytes.
        let library = if count.figures > 0 { library() } else { "" };
        let script = if count.figures > 0 {
            concat!(include_str!("charts.js"), include_str!("widgets.js"))
        } else {
            ""
        };
        format!(
            "<!doctype html>\n<html lang=\"en-GB\"><head><meta charset=\"utf-8\">\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
             <title>{title}</title>\n<style>{style}</style>\n{library}</head>\n<body><main>\n\
             <header><h1>{title}</h1><dl class=\"facts\">{facts}</dl></header>\n\
             <noscript><p>The figures need JavaScript; the data are in the files beside this page.</p></noscript>\n\
             {contents}{body}\
             <footer>Drag to zoom, double-click to see everything, click a name in a legend to hide it. The data are in the \
             files beside this page.</footer>\n</main>\n<script>{script}</script></body></html>\n",
            style = include_str!("style.css"),
            contents = self.contents(),
        )
    }

    /// Links to the sections, where there are enough of them to get lost in.
    fn contents(&self) -> String {
        if self.sections.len() < 4 {
            return String::new();
        }
        let mut links = String::from("<nav>");
        for (index, section) in self.sections.iter().enumerate().skip(1) {
            links += &format!("<a href=\"#section-{index}\">{}</a>", escape(&section.heading));
        }
        links + "</nav>\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Bars, Column, Curves, Field, FieldStyle};
    use base64::Engine;
    use base64::engine::general_purpose::STANDARD;
    use packing::drawing_library;

    fn example() -> Page {
        let mut page = Page::new("Rig <damping>", "oleo rig damping --out x");
        page.fact("Strut", "defender110 & co").verdict(Verdict::Pass, "all met");
        let mut curves = Curves::new("Force", Axis::new("Time", "s"));
        curves
            .panel(Axis::new("Force", "N"))
            .line("</script>", &[0.0, 1.0], &[1.0, 2.0])
            .link("time");
        page.section("Force").figure(curves);
        let mut bars = Bars::new("Bars", ["a"], Axis::new("n", ""));
        bars.series("s", &[1.0]);
        page.section("Bars").figure(bars);
        let axes = [Axis::new("x", "m"), Axis::new("y", "m"), Axis::new("z", "m")];
        page.section("Field")
            .figure(Field::new("f", FieldStyle::Contour, axes, &[0.0], &[0.0], &[vec![1.0]]));
        page
    }

    #[test]
    fn a_page_is_self_contained_with_one_library() {
        let html = example().render();
        assert_eq!(html.matches("id=\"library\"").count(), 1);
        assert!(html.len() < 2_500_000, "{} bytes", html.len());
        // The library contains the address of icons for maps, which are not used here; the page itself contains no address.
        let own = html.replace(library(), "");
        assert!(!own.contains("http"), "nothing is fetched");
        // What a browser will unpack is plotly.js, whole, and nothing else.
        let packed = library()
            .split_once('>')
            .and_then(|(_, rest)| rest.split_once('<'))
            .map(|(packed, _)| STANDARD.decode(packed).expect("base64"))
            .expect("a script element");
        let mut source = String::new();
        std::io::Read::read_to_string(&mut flate2::read::GzDecoder::new(&packed[..]), &mut source).expect("gzip");
        assert!(source.contains("plotly.js v") && source.len() > 3_000_000);
        assert!(source == drawing_library() && !source.contains("MathJax={"));
        assert_eq!(html.matches("class=\"chart\"").count(), 3);
        assert!(html.contains("data-link=\"time\"") && html.contains("<nav>"));
    }

    #[test]
    fn names_cannot_break_out() {
        let html = example().render();
        assert!(html.contains("<h1>Rig &lt;damping&gt;</h1>") && html.contains("defender110 &amp; co"));
        let data = html
            .split("figure-1-data\">")
            .nth(1)
            .and_then(|rest| rest.split("</script>").next())
            .expect("data");
        serde_json::from_str::<serde_json::Value>(data).expect("the data end where they should");
    }

    #[test]
    fn one_of_a_choice_is_shown_and_a_topic_is_around_its_items() {
        let figure = |title: &str| {
            let mut curves = Curves::new(title, Axis::new("Time", "s"));
            curves
                .panel(Axis::new("Force", "N"))
                .line("force", &[0.0, 1.0], &[1.0, 2.0]);
            (title.to_owned(), curves.into())
        };
        let mut page = Page::new("Choice", "oleo hil");
        page.choice("Corner", [figure("front left"), figure("front right")])
            .topic(Some("path-1"))
            .text("about path 1")
            .section("Next")
            .text("about everything")
            .equation("F = k x")
            .download("Save", "a.csv", "time_s\n0\n");
        let html = page.render();
        assert_eq!(html.matches("type=\"radio\"").count(), 2);
        assert_eq!(html.matches("class=\"option\" hidden").count(), 1, "the second figure");
        assert!(html.contains("<div data-topic=\"path-1\"><p>about path 1</p>\n</div>"));
        assert!(html.contains("<p>about everything</p>") && html.contains("<math "));
        assert!(html.contains("download=\"a.csv\" href=\"data:text/csv;base64,dGltZV9zCjAK\""));
    }

    #[test]
    fn a_page_without_figures_is_small_and_the_same_every_time() {
        let mut page = Page::new("Check", "oleo hil");
        let mut table = Table::new([Column::text("Check")]);
        table.row(["a"]);
        page.outcome(table.clone())
            .details("all", table)
            .code("model.toml", "a = 1 < 2");
        assert!(page.render().contains("<pre>a = 1 &lt; 2</pre>"));
        assert!(page.render().len() < 20_000);
        assert_eq!(page.render(), page.render());
    }
}
