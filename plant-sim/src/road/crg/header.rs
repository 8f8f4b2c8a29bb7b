//! Reads the header of an OpenCRG file: which channels it has and where the grid is.

use super::super::RoadError;

/// How the numbers after the header are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    /// Text, this many characters a number.
    Text(usize),
    /// Big-endian binary numbers of 32 bits.
    Real,
    /// Big-endian binary numbers of 64 bits.
    Double,
}

/// All that is needed to find the heights.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) format: Format,
    /// Number of values in each row.
    pub(super) channels: usize,
    /// Channel of each long section, right to left.
    pub(super) columns: Vec<usize>,
    /// Place of each long section, m, ascending (right is negative).
    pub(super) lateral_m: Vec<f64>,
    /// Distance between rows, m.
    pub(super) spacing_m: f64,
    /// Rows, where the header says so.
    pub(super) rows: Option<usize>,
    /// First byte of the data.
    pub(super) data_start: usize,
    /// Line of that byte, from 1.
    pub(super) data_line: usize,
}

#[derive(Default)]
struct Draft {
    format: Option<Format>,
    channels: usize,
    /// (channel, number or position, line)
    numbered: Vec<(usize, f64, usize)>,
    positioned: Vec<(usize, f64, usize)>,
    start_u: Option<f64>,
    end_u: Option<f64>,
    increment: Option<f64>,
    v_right: Option<f64>,
    v_left: Option<f64>,
    v_increment: Option<f64>,
    defined: bool,
}

/// Most rows that are accepted: a corrupt header must not exhaust the memory.
const MAX_ROWS: f64 = 1e8;

/// Reads the header of an OpenCRG file.
pub(super) fn parse(bytes: &[u8], path: &str) -> Result<Header, RoadError> {
    let mut draft = Draft::default();
    let mut section = String::new();
    let mut position = 0;
    let mut line = 0;
    loop {
        let rest = bytes.get(position..).unwrap_or_default();
        if rest.is_empty() {
            return Err(RoadError::line(
                path,
                line.max(1),
                "the header ends with no line of '$$$$' before the data: is this an OpenCRG file?",
            ));
        }
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        let text = String::from_utf8_lossy(&rest[..length]);
        position += (length + 1).min(rest.len());
        line += 1;
        let text = text.trim_end();
        if text.starts_with("$$") {
            return finish(draft, position, line + 1, path);
        }
        if let Some(name) = text.strip_prefix('$') {
            section = word(name);
            draft.defined |= section == "KD_DEFINITION";
            if section == "ROAD_CRG_MODS" || section == "ROAD_CRG_FILE" {
                let problem = format!("${section} is not supported: resolve it with the OpenCRG tools first");
                return Err(RoadError::line(path, line, problem));
            }
            continue;
        }
        if section == "CT" || text.starts_with('*') || text.trim().is_empty() {
            continue;
        }
        let content = text.split('!').next().unwrap_or_default().trim();
        match section.as_str() {
            "ROAD_CRG" => draft.parameter(content, line, path)?,
            "KD_DEFINITION" => draft.channel(content, line, path)?,
            _ => {}
        }
    }
}

/// First word in capitals: a section's or a parameter's name.
fn word(text: &str) -> String {
    text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
        .next()
        .unwrap_or_default()
        .to_ascii_uppercase()
}

impl Draft {
    /// `name = value` of the section `$ROAD_CRG`.
    fn parameter(&mut self, content: &str, line: usize, path: &str) -> Result<(), RoadError> {
        let Some((name, value)) = content.split_once('=') else {
            return Ok(());
        };
        let name = name.trim();
        let target = match word(name).as_str() {
            "REFERENCE_LINE_START_U" => &mut self.start_u,
            "REFERENCE_LINE_END_U" => &mut self.end_u,
            "REFERENCE_LINE_INCREMENT" => &mut self.increment,
            "LONG_SECTION_V_RIGHT" => &mut self.v_right,
            "LONG_SECTION_V_LEFT" => &mut self.v_left,
            "LONG_SECTION_V_INCREMENT" => &mut self.v_increment,
            _ => return Ok(()),
        };
        let number = number(value)
            .ok_or_else(|| RoadError::line(path, line, format!("{name}: '{}' is not a number", value.trim())))?;
        *target = Some(number);
        Ok(())
    }

    /// A line of `$KD_DEFINITION`: `#:format` or `D:channel,unit`.
    fn channel(&mut self, content: &str, line: usize, path: &str) -> Result<(), RoadError> {
        let (kind, rest) = content.split_once(':').unwrap_or((content, ""));
        match kind.trim().to_ascii_uppercase().as_str() {
            "#" => {
                self.format = Some(match word(rest.trim()).as_str() {
                    "LRFI" => Format::Text(10),
                    "LDFI" => Format::Text(20),
                    "KRBI" => Format::Real,
                    "KDBI" => Format::Double,
                    other => {
                        let problem = format!("data format '{other}' is not one of LRFI, LDFI, KRBI, KDBI");
                        return Err(RoadError::line(path, line, problem));
                    }
                });
            }
            "D" => {
                let name = rest.trim().to_ascii_lowercase();
                if let Some(which) = name.strip_prefix("long section") {
                    let which = which.split(',').next().unwrap_or_default().trim();
                    let (list, text) = match which.split_once('=') {
                        Some((_, position)) => (&mut self.positioned, position),
                        None => (&mut self.numbered, which),
                    };
                    let value = number(text)
                        .ok_or_else(|| RoadError::line(path, line, format!("'{rest}': long section has no number")))?;
                    list.push((self.channels, value, line));
                }
                self.channels += 1;
            }
            _ => {}
        }
        Ok(())
    }
}

/// A finite number; Fortran's exponent letter D is accepted.
fn number(text: &str) -> Option<f64> {
    text.trim()
        .replace(['d', 'D'], "e")
        .parse()
        .ok()
        .filter(|value: &f64| value.is_finite())
}

fn finish(draft: Draft, data_start: usize, data_line: usize, path: &str) -> Result<Header, RoadError> {
    let header_line = data_line - 1;
    let fail = |problem: String| RoadError::line(path, header_line, problem);
    if !draft.defined {
        return Err(fail(
            "the header has no $KD_DEFINITION section: is this an OpenCRG file?".into(),
        ));
    }
    let format = draft
        .format
        .ok_or_else(|| fail("$KD_DEFINITION has no '#:' line with the data format".into()))?;
    let spacing_m = draft.increment.unwrap_or(0.01);
    if !(1e-6..=1e6).contains(&spacing_m) {
        return Err(fail(format!(
            "reference_line_increment {spacing_m} must lie between 1e-6 and 1e6 m"
        )));
    }
    let (columns, lateral_m) = long_sections(&draft, path, header_line)?;
    let rows = match draft.end_u {
        Some(end) => {
            let rows = ((end - draft.start_u.unwrap_or(0.0)) / spacing_m).round() + 1.0;
            if !(2.0..=MAX_ROWS).contains(&rows) {
                return Err(fail(format!(
                    "reference_line_start_u, _end_u and _increment make {rows} rows"
                )));
            }
            Some(rows as usize)
        }
        None => None,
    };
    Ok(Header {
        format,
        channels: draft.channels,
        columns,
        lateral_m,
        spacing_m,
        rows,
        data_start,
        data_line,
    })
}

/// Channels and lateral positions of the long sections, right to left.
fn long_sections(draft: &Draft, path: &str, header_line: usize) -> Result<(Vec<usize>, Vec<f64>), RoadError> {
    let fail = |line: usize, problem: String| RoadError::line(path, line, problem);
    if !draft.positioned.is_empty() {
        if let Some(&(_, _, line)) = draft.numbered.first() {
            return Err(fail(
                line,
                "long sections have numbers here and positions elsewhere: use one of them".into(),
            ));
        }
        let mut sections = draft.positioned.clone();
        sections.sort_by(|a, b| a.1.total_cmp(&b.1));
        if let Some(pair) = sections.windows(2).find(|pair| pair[1].1 - pair[0].1 < 1e-6) {
            return Err(fail(pair[1].2, format!("two long sections at v = {}", pair[1].1)));
        }
        return Ok(sections.iter().map(|s| (s.0, s.1)).unzip());
    }
    let mut sections = draft.numbered.clone();
    sections.sort_by(|a, b| a.1.total_cmp(&b.1));
    if sections.is_empty() {
        return Err(fail(
            header_line,
            "$KD_DEFINITION has no 'D:long section' channel".into(),
        ));
    }
    for (index, &(_, value, line)) in sections.iter().enumerate() {
        if value != (index + 1) as f64 {
            return Err(fail(
                line,
                format!("long section {value} where {} was expected", index + 1),
            ));
        }
    }
    let intervals = (sections.len() - 1) as f64;
    let step = match (draft.v_right, draft.v_left, draft.v_increment) {
        (Some(right), Some(left), _) if intervals > 0.0 => (left - right) / intervals,
        (_, _, increment) => increment.unwrap_or(0.01),
    };
    if !(1e-6..=1e6).contains(&step) {
        return Err(fail(
            header_line,
            "long_section_v_right, _left and _increment do not ascend by 1e-6 to 1e6 m".into(),
        ));
    }
    let right = draft
        .v_right
        .or(draft.v_left.map(|left| left - step * intervals))
        .unwrap_or(-0.5 * step * intervals);
    Ok(sections
        .iter()
        .enumerate()
        .map(|(i, s)| (s.0, right + step * i as f64))
        .unzip())
}
