//! Reads formulas.
//!
//! ```text
//! sum     = product (("+" | "-") product)*
//! product = signed (("*" | "/" | "%") signed | power)*
//! signed  = ("+" | "-")* power
//! power   = atom ("^" ("+" | "-")* atom)?
//! atom    = number | "t" | "pi" | "e" | function "(" sum ("," sum)* ")" | "(" sum ")"
//! ```
//!
//! A power right after a factor is multiplied by it, unless it begins with a digit.

use std::f64::consts::{E, PI};

use super::functions::{Binary, DIFFERENCE, FUNCTIONS, Function, NEGATIVE, POWER, PRODUCT, QUOTIENT, REMAINDER, SUM};
use super::law::Law;

/// Parentheses within parentheses. They are read and evaluated by recursion: with a hundred thousand the stack would
/// overflow, which ends the program.
const DEEPEST: usize = 100;

/// Error of a text that is no formula: its byte, the problem, and help.
pub(super) struct Refusal {
    pub byte: usize,
    pub problem: Box<str>,
    pub help: Box<str>,
}

/// The formula of a text.
pub(super) fn read(text: &str) -> Result<Law, Refusal> {
    let mut reader = Reader { text, at: 0, depth: 0 };
    let law = reader.sum()?;
    match reader.next() {
        None => Ok(law),
        Some(_) => Err(reader.unexpected()),
    }
}

struct Reader<'a> {
    text: &'a str,
    /// Bytes read.
    at: usize,
    /// Parentheses open.
    depth: usize,
}

impl<'a> Reader<'a> {
    fn sum(&mut self) -> Result<Law, Refusal> {
        let mut law = self.product()?;
        while let Some(operator) = self.operator(&[('+', &SUM), ('-', &DIFFERENCE)]) {
            law = Law::binary(operator, law, self.product()?);
        }
        Ok(law)
    }

    fn product(&mut self) -> Result<Law, Refusal> {
        let mut law = self.signed()?;
        loop {
            law = if let Some(operator) = self.operator(&[('*', &PRODUCT), ('/', &QUOTIENT), ('%', &REMAINDER)]) {
                Law::binary(operator, law, self.signed()?)
            } else if self.next().is_some_and(|c| c == '(' || begins_name(c)) {
                Law::binary(&PRODUCT, law, self.power()?)
            } else {
                return Ok(law);
            }
        }
    }

    fn signed(&mut self) -> Result<Law, Refusal> {
        let negative = self.signs();
        let law = self.power()?;
        Ok(if negative { Law::unary(&NEGATIVE, law) } else { law })
    }

    fn power(&mut self) -> Result<Law, Refusal> {
        let base = self.atom()?;
        if !self.take('^') {
            return Ok(base);
        }
        let negative = self.signs();
        let exponent = self.atom()?;
        if self.next() == Some('^') {
            let help = "put parentheses: (a^b)^c or a^(b^c)";
            return Err(refusal(self.at, "a power of a power is read in two ways", help));
        }
        let exponent = if negative { Law::unary(&NEGATIVE, exponent) } else { exponent };
        Ok(Law::binary(&POWER, base, exponent))
    }

    fn atom(&mut self) -> Result<Law, Refusal> {
        match self.next() {
            Some('(') => {
                self.open()?;
                let law = self.sum()?;
                self.close()?;
                Ok(law)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if begins_name(c) => self.named(),
            _ => Err(self.unexpected()),
        }
    }

    fn open(&mut self) -> Result<(), Refusal> {
        if self.depth == DEEPEST {
            let problem = format!("it has more than {DEEPEST} parentheses within each other");
            return Err(refusal(self.at, problem, "write it flatter"));
        }
        self.at += 1;
        self.depth += 1;
        Ok(())
    }

    fn close(&mut self) -> Result<(), Refusal> {
        if !self.take(')') {
            return Err(self.unexpected());
        }
        self.depth -= 1;
        Ok(())
    }

    fn number(&mut self) -> Result<Law, Refusal> {
        let start = self.at;
        self.take_while(|c| c.is_ascii_digit() || c == '.');
        // An e without digits is the constant.
        let rest = &self.text[self.at..];
        let digits = rest.strip_prefix(['e', 'E']).map(|rest| rest.strip_prefix(['+', '-']).unwrap_or(rest));
        if let Some(digits) = digits.filter(|digits| digits.starts_with(|c: char| c.is_ascii_digit())) {
            self.at = self.text.len() - digits.len();
            self.take_while(|c| c.is_ascii_digit());
        }
        let found = &self.text[start..self.at];
        match found.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Law::Number(number)),
            Ok(_) => Err(refusal(start, format!("`{found}` is too large, above 1.8e308"), "write a smaller number")),
            Err(_) => Err(refusal(start, format!("`{found}` is not a number"), "write it like 1.5 or 1.5e-3")),
        }
    }

    fn named(&mut self) -> Result<Law, Refusal> {
        let start = self.at;
        self.take_while(|c| begins_name(c) || c.is_ascii_digit());
        let name = &self.text[start..self.at];
        match name {
            "t" => return Ok(Law::Time),
            "pi" => return Ok(Law::Number(PI)),
            "e" => return Ok(Law::Number(E)),
            "log" => return Err(refusal(start, "`log` means two things", "write ln or log10")),
            _ => {}
        }
        let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
            return Err(refusal(start, format!("`{name}` is not known"), unknown_name(name, self.next() == Some('.'))));
        };
        if self.next() != Some('(') {
            let problem = format!("`{name}` needs parentheses after it");
            return Err(refusal(start, problem, format!("write them, as in {name}(t)")));
        }
        self.open()?;
        let mut arguments = vec![self.sum()?];
        while self.take(',') {
            arguments.push(self.sum()?);
        }
        self.close()?;
        let found = arguments.len();
        let takes = |expected: &str| {
            let help = format!("give `{name}` {expected}, with commas between several");
            Err(refusal(start, format!("`{name}` takes {expected}, found {found}"), help))
        };
        let mut arguments = arguments.into_iter();
        match (function, arguments.next(), arguments.next(), arguments.next()) {
            (Function::Unary(function), Some(x), None, _) => Ok(Law::unary(function, x)),
            (Function::Unary(_), ..) => takes("one argument"),
            (Function::Binary(function), Some(x), Some(y), None) => Ok(Law::binary(function, x, y)),
            (Function::Binary(_), ..) => takes("two arguments"),
            (Function::Repeated(_), None, ..) => takes("one argument or more"),
            (Function::Repeated(function), Some(first), second, third) => {
                let others = second.into_iter().chain(third).chain(arguments);
                Ok(others.fold(first, |law, next| Law::binary(function, law, next)))
            }
        }
    }

    /// Signs in a row: whether they turn the sign.
    fn signs(&mut self) -> bool {
        let mut negative = false;
        loop {
            if self.take('-') {
                negative = !negative;
            } else if !self.take('+') {
                return negative;
            }
        }
    }

    fn operator(&mut self, operators: &[(char, &'static Binary)]) -> Option<&'static Binary> {
        operators.iter().find(|(symbol, _)| self.take(*symbol)).map(|(_, operator)| *operator)
    }

    /// The next character that is no space.
    fn next(&mut self) -> Option<char> {
        self.take_while(|c| c.is_ascii_whitespace());
        self.text[self.at..].chars().next()
    }

    fn take(&mut self, symbol: char) -> bool {
        let found = self.next() == Some(symbol);
        if found {
            self.at += symbol.len_utf8();
        }
        found
    }

    fn take_while(&mut self, belongs: impl Fn(char) -> bool) {
        let rest = &self.text[self.at..];
        self.at += rest.find(|c| !belongs(c)).unwrap_or(rest.len());
    }

    /// Message about the next character where it cannot stand.
    fn unexpected(&mut self) -> Refusal {
        let next = self.next();
        if next == Some('*') && self.text[..self.at].ends_with('*') {
            return refusal(self.at - 1, "`**` is not an operator", "write a power with ^, as in t^2");
        }
        let (problem, help) = match next {
            None if self.depth > 0 => ("it ends too early: `)` is missing".to_owned(), "close each `(`"),
            None => ("it ends too early".to_owned(), "complete it, e.g. sin(2*pi*50*t)"),
            Some(',') => (
                "`,` stands only between the arguments of a function".to_owned(),
                "write decimals with a point, as in 2.5",
            ),
            Some('0'..='9' | '.') => ("a number right after a factor".to_owned(), "write `*` between them"),
            Some(c @ ('+' | '-' | '*' | '/' | '%' | '^' | '(' | ')')) => {
                (format!("`{c}` cannot stand here"), "write a number, t, a function or `(` before it, or remove it")
            }
            Some(c) => (format!("`{}` is not known", c.escape_debug()), unknown_character(c)),
        };
        refusal(self.at, problem, help)
    }
}

fn refusal(byte: usize, problem: impl Into<Box<str>>, help: impl Into<Box<str>>) -> Refusal {
    Refusal { byte, problem: problem.into(), help: help.into() }
}

/// Help for a name that is not known; it may be that of a module.
fn unknown_name(name: &str, is_module: bool) -> String {
    let small = name.to_lowercase();
    let same =
        ["t", "pi", "e"].into_iter().chain(FUNCTIONS.iter().map(|(known, _)| *known)).find(|known| *known == small);
    match (same, small.as_str()) {
        (Some(same), _) => format!("write {same}, in small letters"),
        _ if is_module => "write functions without a module, as in sin(t)".to_owned(),
        (None, "if" | "heaviside" | "h" | "step" | "where" | "and" | "or") => CONDITIONS.to_owned(),
        _ => format!(
            "a formula has the time t, numbers, pi and e, + - * / % ^ and parentheses, and the functions {}; write other \
             quantities as numbers",
            super::function_names()
        ),
    }
}

const CONDITIONS: &str = "a formula has no conditions: use a history of kind `step`, `ramp`, `half-sine` or `table`, or a \
                          `product` of such with a formula";

fn unknown_character(c: char) -> &'static str {
    match c {
        '<' | '>' | '=' | '?' | '!' | '&' | '|' => CONDITIONS,
        '²' | '³' => "write a power with ^, as in t^2",
        'π' => "write pi",
        '·' | '×' | '∙' | '⋅' => "write a product with *, as in 2*t",
        '−' | '–' | '—' => "write the minus sign of the keyboard, -",
        '[' | '{' | ']' | '}' => "write parentheses, ( and )",
        _ => "remove it: a formula has t, numbers, names, + - * / % ^ , and parentheses",
    }
}

fn begins_name(c: char) -> bool {
    c.is_ascii_alphabetic() || c == '_'
}
