//! Sets an equation that is written as plain text, such as `dp1/dt = beta / (V - A x) (A dx/dt - Q1 - Q2)`, as MathML, which
//! browsers draw without a library.
//!
//! The text is what the code's documentation uses: a product is a space, a fraction is `a / b` of the two neighbouring factors,
//! `_` begins an index, `^` an exponent, `dx/dt` is a derivative, and `dp` outside of one is a difference. Greek letters have
//! their names. A text that does not follow this is shown as it is. (AsciiMath is another language: it reads `p1` as a product, and
//! its parsers for Rust have had no release since 2021 and 2023.)

mod parse;

use parse::{Node, parse};

use crate::table::escape;

/// An equation as an element of MathML; plain text in `<code>` where the text is not an equation.
pub(crate) fn to_mathml(text: &str) -> String {
    match parse(text) {
        Some(nodes) => format!(
            "<math display=\"block\" aria-label=\"{}\">{}</math>",
            escape(text),
            row(&nodes)
        ),
        None => format!("<code>{}</code>", escape(text)),
    }
}

/// Nodes side by side as one element.
fn row(nodes: &[Node]) -> String {
    match nodes {
        [one] => element(one),
        _ => format!("<mrow>{}</mrow>", nodes.iter().map(element).collect::<String>()),
    }
}

fn element(node: &Node) -> String {
    match node {
        Node::Number(digits) => format!("<mn>{digits}</mn>"),
        Node::Word(word) => format!(
            "<mspace width=\"0.4em\"/><mtext>{}</mtext><mspace width=\"0.4em\"/>",
            escape(word)
        ),
        Node::Symbol(name) => symbol(name),
        Node::Operator(sign) => format!("<mo>{}</mo>", escape(sign)),
        Node::Space => "<mspace width=\"0.2em\"/>".to_owned(),
        Node::Comma => "<mo separator=\"true\">,</mo><mspace width=\"0.8em\"/>".to_owned(),
        Node::Group(inside) => format!("<mrow><mo>(</mo>{}<mo>)</mo></mrow>", row(inside)),
        Node::Magnitude(inside) => format!("<mrow><mo>|</mo>{}<mo>|</mo></mrow>", row(inside)),
        Node::Root(inside) => format!("<msqrt>{}</msqrt>", row(inside)),
        Node::Call(name, inside) => format!(
            "<mrow><mi mathvariant=\"normal\">{name}</mi><mo>(</mo>{}<mo>)</mo></mrow>",
            row(inside)
        ),
        Node::Differential(order, of) => {
            let d = "<mi mathvariant=\"normal\">d</mi>";
            let d = if order.is_empty() {
                d.to_owned()
            } else {
                format!("<msup>{d}<mn>{order}</mn></msup>")
            };
            format!("<mrow>{d}{}</mrow>", row(of))
        }
        Node::Difference(of) => format!("<mrow><mi mathvariant=\"normal\">\u{394}</mi>{}</mrow>", row(of)),
        Node::Fraction(above, below) => format!("<mfrac>{}{}</mfrac>", bare(above), bare(below)),
        Node::Power(base, exponent) => format!("<msup>{}{}</msup>", element(base), bare(exponent)),
        Node::Index(base, index) => format!("<msub>{}{}</msub>", element(base), symbol(index)),
    }
}

/// A part of a fraction or an exponent: brackets around all of it are not needed there.
fn bare(node: &Node) -> String {
    match node {
        Node::Group(inside) => row(inside),
        other => element(other),
    }
}

/// A letter in italics, a Greek letter, or several letters upright; digits at the end and what is behind `_` are an index.
fn symbol(name: &str) -> String {
    if let Some((base, index)) = name.split_once('_') {
        return format!(
            "<msub>{}<mtext>{}</mtext></msub>",
            symbol(base),
            escape(&index.replace('_', " "))
        );
    }
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = &name[letters.len()..];
    let base = match greek(letters) {
        Some(letter) => format!("<mi>{letter}</mi>"),
        None if letters.chars().count() == 1 => format!("<mi>{letters}</mi>"),
        None => format!("<mtext>{}</mtext>", escape(letters)),
    };
    match (letters, digits) {
        ("", digits) => format!("<mn>{digits}</mn>"),
        (_, "") => base,
        _ => format!("<msub>{base}<mn>{digits}</mn></msub>"),
    }
}

fn greek(name: &str) -> Option<&'static str> {
    Some(match name {
        "alpha" => "\u{3b1}",
        "beta" => "\u{3b2}",
        "delta" => "\u{3b4}",
        "mu" => "\u{3bc}",
        "phi" => "\u{3c6}",
        "pi" => "\u{3c0}",
        "rho" => "\u{3c1}",
        "sum" => "\u{2211}",
        "tau" => "\u{3c4}",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_fractions_and_products() {
        let set = to_mathml("dp1/dt = beta / (V - A x) (A dx/dt - Q1)");
        assert!(set.starts_with("<math display=\"block\" aria-label=\"dp1/dt"), "{set}");
        assert!(
            set.contains("<mfrac><mrow><mi mathvariant=\"normal\">d</mi><msub><mi>p</mi><mn>1</mn></msub></mrow>"),
            "{set}"
        );
        // The brackets of a denominator go, those of a factor stay.
        assert!(
            set.contains("<mfrac><mi>\u{3b2}</mi><mrow><mi>V</mi><mo>\u{2212}</mo><mi>A</mi>"),
            "{set}"
        );
        assert_eq!(set.matches("<mo>(</mo>").count(), 1, "{set}");
    }

    #[test]
    fn a_difference_is_no_derivative() {
        let set = to_mathml("Q = c dp / sqrt(|dp| + p_t)");
        assert_eq!(
            set.matches("<mi mathvariant=\"normal\">\u{394}</mi><mi>p</mi>").count(),
            2,
            "{set}"
        );
        assert!(
            set.contains("<msqrt>") && set.contains("<msub><mi>p</mi><mtext>t</mtext></msub>"),
            "{set}"
        );
        let set = to_mathml("F = m d2x/dt2");
        assert!(
            set.contains("<msup><mi mathvariant=\"normal\">d</mi><mn>2</mn></msup><mi>x</mi>"),
            "{set}"
        );
        assert!(set.contains("<msup><mi>t</mi><mn>2</mn></msup>"), "{set}");
    }

    #[test]
    fn a_derivative_of_what_is_in_brackets_is_one_fraction() {
        let set = to_mathml("p = 1 + delta d(alpha_r)/d(delta)");
        let d = "<mrow><mi mathvariant=\"normal\">d</mi>";
        assert_eq!(set.matches(d).count(), 2, "{set}");
        assert_eq!(set.matches("<mfrac>").count(), 1, "{set}");
    }

    #[test]
    fn words_and_what_is_no_equation() {
        assert!(to_mathml("p V^n = constant").contains("<mtext>constant</mtext>"));
        assert_eq!(to_mathml("the tabulated law"), "<code>the tabulated law</code>");
        assert_eq!(to_mathml("F = (c"), "<code>F = (c</code>");
        assert_eq!(to_mathml("a <b>"), "<code>a &lt;b&gt;</code>");
    }
}
