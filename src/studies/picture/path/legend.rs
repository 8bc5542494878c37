//! The legend of lines, marks and letters.

use crate::studies::picture::axis::Axis;
use crate::studies::picture::path::curve::{Curve, Event};
use crate::studies::picture::path::strokes::{Stretch, Stroke, marker};
use crate::studies::picture::shapes::{Drawn, FAINT_INK, FINE, INK, Lettering, Place, Sheet};

/// The most stages and events that are listed; the others are counted.
const LISTED_STAGES: usize = 20;
pub const LISTED_EVENTS: usize = 200;
/// Heights of rows, in pixels.
const LINE_ROW: i32 = 20;
const EVENT_ROW: i32 = 34;
const MORE_ROW: i32 = 13;
/// Columns, in pixels from the legend's left edge.
const SAMPLE_END: i32 = 34;
const MARK: i32 = 8;
const LETTER: i32 = 30;
const WORDS: i32 = 50;
/// Characters that fit into a row, in plain and in faint text.
const LONGEST: usize = 48;
const LONGEST_FAINT: usize = 56;
/// The most lines of what happens at a point.
const MOST_LINES: usize = 3;

const PLAIN: Lettering = Lettering { size: 12, color: &INK, bold: false, centred: false };
const BOLD: Lettering = Lettering { bold: true, centred: true, ..PLAIN };
const FAINT: Lettering = Lettering { size: 11, color: &FAINT_INK, ..PLAIN };

#[derive(Debug)]
enum Row<'a> {
    Stroke { stroke: Stroke, words: String },
    Event { event: &'a Event, load: String },
    Rest(String),
}

/// The rows of a legend.
#[derive(Debug)]
pub struct Legend<'a>(Vec<Row<'a>>);

impl<'a> Legend<'a> {
    pub fn new(curve: &'a Curve, load: &Axis) -> Self {
        let mut rows = Vec::new();
        for (stage, drawn) in curve.stages.iter().enumerate().take(LISTED_STAGES) {
            let words = format!("stage {}", drawn.name);
            rows.push(Row::Stroke { stroke: Stroke { stage, stretch: Stretch::Plain }, words });
        }
        rows.extend(rest(curve.stages.len(), LISTED_STAGES, "stages"));
        for (stretch, words) in
            [(Stretch::Bifurcation, "bifurcation points"), (Stretch::Jump, "jump: no equilibrium between")]
        {
            if curve.stages.iter().any(|stage| stage.stretches().any(|own| own == stretch)) {
                rows.push(Row::Stroke { stroke: Stroke { stage: 0, stretch }, words: words.to_owned() });
            }
        }
        for event in curve.events.iter().take(LISTED_EVENTS) {
            rows.push(Row::Event { event, load: load.number(event.at.1) });
        }
        rows.extend(rest(curve.events.len(), LISTED_EVENTS, "events"));
        Self(rows)
    }

    /// In pixels.
    pub fn height(&self) -> i32 {
        self.0.iter().map(Row::height).sum()
    }

    pub fn draw(&self, sheet: &Sheet<'_>, corner: Place) -> Drawn {
        let (left, mut top) = corner;
        for row in &self.0 {
            row.draw(sheet, (left, top))?;
            top += row.height() * FINE;
        }
        Ok(())
    }
}

/// What happens at a point, in lines that fit into rows; what is left of a long text stands in the last one, and is cut there.
fn lines_of(event: &Event) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in event.words.iter().flat_map(|words| words.split(' ')) {
        let many = lines.len();
        match lines.last_mut() {
            Some(line) if many == MOST_LINES || line.chars().count() + 1 + word.chars().count() <= LONGEST_FAINT => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn rest(count: usize, listed: usize, things: &str) -> Option<Row<'static>> {
    (count > listed).then(|| Row::Rest(format!("and {} more {things}", count - listed)))
}

impl Row<'_> {
    fn height(&self) -> i32 {
        match self {
            Self::Stroke { .. } | Self::Rest(_) => LINE_ROW,
            Self::Event { event, .. } => EVENT_ROW + MORE_ROW * (lines_of(event).len().max(1) - 1) as i32,
        }
    }

    fn draw(&self, sheet: &Sheet<'_>, (left, top): Place) -> Drawn {
        let at = |column: i32, down: i32| (left + column * FINE, top + down * FINE);
        match self {
            Self::Stroke { stroke, words } => {
                let middle = LINE_ROW / 2;
                stroke.line(sheet, vec![at(0, middle), at(SAMPLE_END, middle)])?;
                stroke.dot(sheet, at(SAMPLE_END / 2, middle))?;
                PLAIN.write(sheet, at(WORDS, middle), words, LONGEST)
            }
            Self::Event { event, load } => {
                let (first, second) = (EVENT_ROW / 2 - 7, EVENT_ROW / 2 + 7);
                marker(sheet, event.kind, at(MARK, first))?;
                BOLD.write(sheet, at(LETTER, first), &event.label, LONGEST)?;
                let words = format!("{}, load factor {load}", event.kind.words());
                PLAIN.write(sheet, at(WORDS, first), &words, LONGEST)?;
                (0..).zip(lines_of(event)).try_for_each(|(number, line)| {
                    FAINT.write(sheet, at(WORDS, second + MORE_ROW * number), &line, LONGEST_FAINT)
                })
            }
            Self::Rest(words) => PLAIN.write(sheet, at(WORDS, LINE_ROW / 2), words, LONGEST),
        }
    }
}
