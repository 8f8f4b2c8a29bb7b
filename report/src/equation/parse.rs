//! Reads the plain text of an equation.

/// What an equation is made of.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Number(String),
    /// A word of a sentence, such as "with".
    Word(String),
    Symbol(String),
    Operator(&'static str),
    /// Between the factors of a product.
    Space,
    Comma,
    Group(Vec<Node>),
    Magnitude(Vec<Node>),
    Root(Vec<Node>),
    Call(&'static str, Vec<Node>),
    /// d of something, with its order where that is not one.
    Differential(String, Vec<Node>),
    Difference(Vec<Node>),
    Fraction(Box<Node>, Box<Node>),
    Power(Box<Node>, Box<Node>),
    Index(Box<Node>, String),
}

/// Functions whose argument is in brackets.
const FUNCTIONS: [&str; 6] = ["exp", "sin", "tanh", "sgn", "min", "max"];
/// Words that stand in equations.
const WORDS: [&str; 7] = ["with", "unless", "it", "is", "given", "constant", "where"];

#[derive(Clone, Debug, PartialEq)]
enum Token<'t> {
    Name(&'t str),
    Number(&'t str),
    Sign(char),
    AtMost,
}

/// The nodes of an equation; `None` where the text is not one.
pub(super) fn parse(text: &str) -> Option<Vec<Node>> {
    let tokens = tokens(text)?;
    let mut reader = Reader { tokens: &tokens, at: 0 };
    let nodes = reader.sequence(None)?;
    let is_equation = nodes
        .iter()
        .any(|node| matches!(node, Node::Operator("=" | "\u{2264}")));
    (is_equation && reader.at == tokens.len()).then_some(nodes)
}

fn tokens(text: &str) -> Option<Vec<Token<'_>>> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let taken = if first.is_ascii_alphabetic() {
            let end = rest
                .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
                .unwrap_or(rest.len());
            tokens.push(Token::Name(&rest[..end]));
            end
        } else if first.is_ascii_digit() {
            let end = rest
                .find(|c: char| !(c.is_ascii_digit() || c == '.'))
                .unwrap_or(rest.len());
            tokens.push(Token::Number(&rest[..end]));
            end
        } else if rest.starts_with("<=") {
            tokens.push(Token::AtMost);
            2
        } else if "+-*/^=(),|_".contains(first) {
            tokens.push(Token::Sign(first));
            1
        } else {
            return None;
        };
        rest = rest[taken..].trim_start();
    }
    Some(tokens)
}

struct Reader<'a, 't> {
    tokens: &'a [Token<'t>],
    at: usize,
}

impl<'t> Reader<'_, 't> {
    fn peek(&self) -> Option<&Token<'t>> {
        self.tokens.get(self.at)
    }

    fn take(&mut self, sign: char) -> Option<()> {
        let is = self.peek() == Some(&Token::Sign(sign));
        self.at += usize::from(is);
        is.then_some(())
    }

    /// Everything until the closing sign, which is left, or until the end.
    fn sequence(&mut self, until: Option<char>) -> Option<Vec<Node>> {
        let mut nodes: Vec<Node> = Vec::new();
        let mut after_factor = false;
        while let Some(token) = self.peek() {
            if until.is_some_and(|sign| *token == Token::Sign(sign)) {
                break;
            }
            let operator = match token {
                Token::Sign('+') => Some(Node::Operator("+")),
                Token::Sign('-') => Some(Node::Operator("\u{2212}")),
                Token::Sign('*') => Some(Node::Operator("\u{b7}")),
                Token::Sign('=') => Some(Node::Operator("=")),
                Token::Sign(',') => Some(Node::Comma),
                Token::AtMost => Some(Node::Operator("\u{2264}")),
                _ => None,
            };
            if let Some(operator) = operator {
                self.at += 1;
                nodes.push(operator);
                after_factor = false;
                continue;
            }
            if after_factor {
                nodes.push(Node::Space);
            }
            nodes.push(self.quotient()?);
            after_factor = true;
        }
        Some(nodes)
    }

    /// A factor, over another one where `/` follows.
    fn quotient(&mut self) -> Option<Node> {
        let above_at = self.at;
        let mut above = self.power(false)?;
        if self.take('/').is_some() {
            let below_at = self.at;
            let differential = self.is_differential(above_at) && self.is_differential(below_at);
            if differential {
                self.at = above_at;
                above = self.power(true)?;
                self.take('/')?;
            }
            let below = self.power(differential)?;
            return Some(Node::Fraction(Box::new(above), Box::new(below)));
        }
        Some(above)
    }

    /// Whether a name with a d before it is at this place: a derivative where it is so above and below.
    fn is_differential(&self, at: usize) -> bool {
        match self.tokens.get(at) {
            Some(Token::Name("d")) => self.tokens.get(at + 1) == Some(&Token::Sign('(')),
            Some(Token::Name(name)) => name.starts_with('d') && *name != "delta" && !name.starts_with("drop"),
            _ => false,
        }
    }

    /// A factor with its exponent.
    fn power(&mut self, differential: bool) -> Option<Node> {
        let base = self.factor(differential)?;
        if self.take('^').is_some() {
            let exponent = self.factor(false)?;
            return Some(Node::Power(Box::new(base), Box::new(exponent)));
        }
        Some(base)
    }

    fn inside(&mut self, open: char, close: char) -> Option<Vec<Node>> {
        self.take(open)?;
        let nodes = self.sequence(Some(close))?;
        self.take(close)?;
        Some(nodes)
    }

    fn factor(&mut self, differential: bool) -> Option<Node> {
        match self.peek()?.clone() {
            Token::Number(digits) => {
                self.at += 1;
                Some(Node::Number(digits.to_owned()))
            }
            Token::Sign('(') => {
                let group = Node::Group(self.inside('(', ')')?);
                if self.take('_').is_some() {
                    let Some(Token::Name(index)) = self.peek().cloned() else {
                        return None;
                    };
                    self.at += 1;
                    return Some(Node::Index(Box::new(group), index.to_owned()));
                }
                Some(group)
            }
            Token::Sign('|') => Some(Node::Magnitude(self.inside('|', '|')?)),
            Token::Sign('-') => {
                // Of an exponent.
                self.at += 1;
                let number = self.factor(false)?;
                Some(Node::Group(vec![Node::Operator("\u{2212}"), number]))
            }
            Token::Name(name) => {
                self.at += 1;
                self.name(name, differential)
            }
            _ => None,
        }
    }

    fn name(&mut self, name: &str, differential: bool) -> Option<Node> {
        let called = self.peek() == Some(&Token::Sign('('));
        if name == "sqrt" && called {
            return Some(Node::Root(self.inside('(', ')')?));
        }
        if let Some(function) = FUNCTIONS.into_iter().find(|f| *f == name && called) {
            return Some(Node::Call(function, self.inside('(', ')')?));
        }
        if name == "d" && called {
            return Some(Node::Differential(String::new(), self.inside('(', ')')?));
        }
        if WORDS.contains(&name) {
            return Some(Node::Word(name.to_owned()));
        }
        let of = name.strip_prefix('d').filter(|of| !of.is_empty());
        match of {
            Some(of) if differential => {
                let order = of.trim_start_matches(|c: char| c.is_ascii_digit());
                let (order, of) = (&of[..of.len() - order.len()], order);
                // "dt2" is the second power of dt.
                let node = match of.strip_suffix('2') {
                    Some(once) if once == "t" => Node::Power(
                        Box::new(Node::Symbol(once.to_owned())),
                        Box::new(Node::Number("2".into())),
                    ),
                    _ => Node::Symbol(of.to_owned()),
                };
                Some(Node::Differential(order.to_owned(), vec![node]))
            }
            Some(of) if of.len() == 1 => Some(Node::Difference(vec![Node::Symbol(of.to_owned())])),
            _ => Some(Node::Symbol(name.to_owned())),
        }
    }
}
