//! Refuses text nested so deeply that parsing it would overflow the stack.
//!
//! The parser and what it builds recurse, and a stack that overflows ends the whole program. So the
//! text is measured first, without a parser: each open bracket counts, and in each bracket the
//! operators, dots and nesting words since the last comma, since all of these may nest.

/// Deepest nesting that is accepted: many times what a person can still read.
const DEEPEST: usize = 48;
/// An `elif` nests in the `if` before it.
const MOST_ELIFS: usize = 48;
/// Words that nest what follows them.
const NESTING_WORDS: [&str; 8] = ["not", "if", "else", "lambda", "and", "or", "in", "for"];

/// Line and column, from 1, where `text` becomes too deep.
pub(super) fn too_deep(text: &str) -> Option<(u32, u32)> {
    let mut meter = NestingMeter::default();
    let mut chars = text.char_indices().peekable();
    let (mut line, mut line_start) = (1, 0);
    while let Some((at, c)) = chars.next() {
        match c {
            '\n' => {
                (line, line_start) = (line + 1, at + 1);
                let indent = text[line_start..]
                    .bytes()
                    .take_while(|b| b" \t".contains(b))
                    .count();
                meter.end_line(indent);
            }
            '#' => while chars.next_if(|(_, c)| *c != '\n').is_some() {},
            '"' | '\'' => {
                let end = at + string_length(&text[at..], c);
                while let Some((at, c)) = chars.next_if(|(at, _)| *at < end) {
                    if c == '\n' {
                        (line, line_start) = (line + 1, at + 1);
                    }
                }
            }
            c if c.is_alphanumeric() || c == '_' => {
                let mut end = at + c.len_utf8();
                while let Some((at, c)) = chars.next_if(|(_, c)| c.is_alphanumeric() || *c == '_') {
                    end = at + c.len_utf8();
                }
                meter.word(&text[at..end]);
            }
            c => meter.sign(c),
        }
        if meter.depth() > DEEPEST || meter.elifs > MOST_ELIFS {
            return Some((line, (at - line_start.min(at)) as u32 + 1));
        }
    }
    None
}

/// Bytes of the string that `text` begins with.
fn string_length(text: &str, quote: char) -> usize {
    let triple: String = [quote; 3].iter().collect();
    let end = if text.starts_with(&triple) {
        triple.as_str()
    } else {
        &triple[..1]
    };
    let mut at = end.len();
    while let Some(c) = text[at..].chars().next() {
        if text[at..].starts_with(end) {
            return at + end.len();
        }
        if c == '\n' && end.len() == 1 {
            return at;
        }
        at += c.len_utf8();
        if c == '\\' {
            at += text[at..].chars().next().map_or(0, char::len_utf8);
        }
    }
    text.len()
}

#[derive(Default)]
struct NestingMeter {
    indent: usize,
    /// Weight of the part before each open bracket.
    outer: Vec<usize>,
    outer_sum: usize,
    here: usize,
    elifs: usize,
}

impl NestingMeter {
    fn depth(&self) -> usize {
        self.indent + self.outer.len() + self.outer_sum + self.here
    }

    fn word(&mut self, word: &str) {
        if NESTING_WORDS.contains(&word) {
            self.here += 1;
        }
        if word == "elif" {
            self.elifs += 1;
        }
    }

    fn sign(&mut self, c: char) {
        match c {
            '(' | '[' | '{' => {
                self.outer.push(self.here);
                self.outer_sum += self.here;
                self.here = 0;
            }
            ')' | ']' | '}' => {
                let before = self.outer.pop().unwrap_or(0);
                self.outer_sum -= before;
                // What follows a call or an index is built around it.
                self.here = before + 1;
            }
            ',' | ';' => self.here = 0,
            c if c.is_ascii_punctuation() && c != '\\' => self.here += 1,
            _ => {}
        }
    }

    fn end_line(&mut self, indent: usize) {
        if self.outer.is_empty() {
            self.here = 0;
            self.indent = indent;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::too_deep;

    #[test]
    fn deep_text_is_found_and_long_text_is_not() {
        let deep = [
            "[".repeat(500),
            "-".repeat(500),
            "not ".repeat(500),
            "a.".repeat(500),
            "a".to_owned() + &"()".repeat(500),
            "1 + ".repeat(500),
            "lambda: ".repeat(500) + "1",
            "1 if 1 else ".repeat(500),
            "if 1:\n  pass\n".to_owned() + &"elif 1:\n  pass\n".repeat(500),
            (0..500).map(|n| " ".repeat(n) + "if 1:\n").collect(),
        ];
        for text in deep {
            assert!(too_deep(&text).is_some(), "{}", &text[..20]);
        }
        let long = [
            "step('((((', do = [tacho.speed(kmh(3))])\n".repeat(500),
            format!("x = [{}]", "kmh(1) + kmh(2), ".repeat(500)),
            format!("'''{}'''", "((((\n".repeat(500)),
            "# ((((((\n".repeat(500),
        ];
        for text in long {
            assert_eq!(too_deep(&text), None, "{}", &text[..20]);
        }
        assert_eq!(
            too_deep(&format!("x\ny = {}", "(".repeat(500))),
            Some((2, 52))
        );
    }
}
