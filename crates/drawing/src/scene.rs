//! Scenes: lists of shapes and texts in pixels.

use super::bitmap::Bitmap;
use super::font::{fitted, text_width};
use super::style::{Colour, INK, LINE, PAPER, SOFT, TINY};
use glam::DVec2;

/// Anchor of a text relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The start of the text.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// A drawn item. Later items cover earlier ones.
#[derive(Clone, Debug)]
pub enum Item {
    Polygon {
        points: Vec<DVec2>,
        fill: Colour,
    },
    Line {
        points: Vec<DVec2>,
        width: f64,
        colour: Colour,
    },
    Disc {
        centre: DVec2,
        radius: f64,
        fill: Colour,
    },
    Text(Text),
    /// An image stretched over the rectangle from `low` to `high`.
    Picture {
        low: DVec2,
        high: DVec2,
        pixels: Bitmap,
    },
}

/// A line of text; `at` is the point of its baseline selected by `anchor`.
#[derive(Clone, Debug)]
pub struct Text {
    pub at: DVec2,
    pub text: String,
    /// Pixels per em.
    pub em: f64,
    pub anchor: Anchor,
    /// Whether the text runs upwards.
    pub upwards: bool,
    pub colour: Colour,
}

/// A rectangle by its minimum and maximum coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Left and top edge.
    pub low: DVec2,
    /// Right and bottom edge.
    pub high: DVec2,
}

impl Frame {
    pub fn new(low: DVec2, high: DVec2) -> Self {
        Self { low, high }
    }

    pub fn extent(&self) -> DVec2 {
        self.high - self.low
    }

    /// Whether both overlap.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.low.cmplt(other.high).all() && other.low.cmplt(self.high).all()
    }

    /// Whether `other` is inside.
    pub fn holds(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && other.high.cmple(self.high).all()
    }

    pub fn inset(&self, by: f64) -> Self {
        self.grown(-by)
    }

    fn grown(&self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    pub fn corners(&self) -> [DVec2; 4] {
        let (a, b) = (self.low, self.high);
        [a, DVec2::new(b.x, a.y), b, DVec2::new(a.x, b.y)]
    }
}

impl Text {
    /// Where the text begins, from its point, and its width.
    pub(super) fn span(&self) -> (f64, f64) {
        let width = text_width(&self.text, self.em);
        let left = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -width / 2.0,
            Anchor::End => -width,
        };
        (left, width)
    }

    /// Bounds of the text: capitals, digits and descenders.
    pub fn frame(&self) -> Frame {
        let (left, width) = self.span();
        let (above, below) = (0.72 * self.em, 0.2 * self.em);
        if self.upwards {
            let low = DVec2::new(self.at.x - above, self.at.y - left - width);
            return Frame::new(low, low + DVec2::new(above + below, width));
        }
        let low = DVec2::new(self.at.x + left, self.at.y - above);
        Frame::new(low, low + DVec2::new(width, above + below))
    }
}

/// A drawing of `width` x `height` pixels.
#[derive(Clone, Debug)]
pub struct Scene {
    pub width: u32,
    pub height: u32,
    pub items: Vec<Item>,
}

impl Scene {
    /// Every line of text and its rectangle.
    pub fn labels(&self) -> Vec<(String, Frame)> {
        self.texts().map(|text| (text.text.clone(), text.frame())).collect()
    }

    /// An empty drawing.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width: width.ceil() as u32, height: height.ceil() as u32, items: Vec::new() }
    }

    /// The drawing's rectangle.
    pub fn frame(&self) -> Frame {
        Frame::new(DVec2::ZERO, DVec2::new(f64::from(self.width), f64::from(self.height)))
    }

    pub fn texts(&self) -> impl Iterator<Item = &Text> {
        self.items.iter().filter_map(|item| if let Item::Text(text) = item { Some(text) } else { None })
    }

    /// Adds a filled polygon.
    pub fn polygon(&mut self, points: impl Into<Vec<DVec2>>, fill: Colour) {
        self.items.push(Item::Polygon { points: points.into(), fill });
    }

    /// Adds a line through `points`.
    pub fn line(&mut self, points: impl Into<Vec<DVec2>>, width: f64, colour: Colour) {
        let points = points.into();
        if points.len() > 1 {
            self.items.push(Item::Line { points, width, colour });
        }
    }

    /// Adds a closed line.
    pub fn outline(&mut self, points: impl Into<Vec<DVec2>>, width: f64, colour: Colour) {
        let mut points = points.into();
        points.extend(points.first().copied());
        self.line(points, width, colour);
    }

    /// Adds a dashed line with dashes and gaps of `dash` pixels.
    pub fn dashed(&mut self, points: &[DVec2], width: f64, colour: Colour, dash: f64) {
        let (mut drawn, mut left) = (true, dash);
        let mut piece: Vec<DVec2> = points.first().copied().into_iter().collect();
        for pair in points.windows(2) {
            let (mut from, to) = (pair[0], pair[1]);
            while from.distance(to) > left {
                from = from + (to - from).normalize() * left;
                piece.push(from);
                if drawn {
                    self.line(std::mem::take(&mut piece), width, colour);
                }
                (drawn, left, piece) = (!drawn, dash, vec![from]);
            }
            left -= from.distance(to);
            piece.push(to);
        }
        if drawn {
            self.line(piece, width, colour);
        }
    }

    /// Adds a disc.
    pub fn disc(&mut self, centre: DVec2, radius: f64, fill: Colour) {
        self.items.push(Item::Disc { centre, radius, fill });
    }

    /// Adds the outline of a circle.
    pub fn circle(&mut self, centre: DVec2, radius: f64, width: f64, colour: Colour) {
        let points: Vec<DVec2> =
            (0..360).map(|k| centre + DVec2::from_angle(f64::from(k).to_radians()) * radius).collect();
        self.outline(points, width, colour);
    }

    /// Adds `pixels`, stretched over the rectangle from `low` to `high`.
    pub fn picture_at(&mut self, low: DVec2, high: DVec2, pixels: Bitmap) {
        self.items.push(Item::Picture { low, high, pixels });
    }

    /// Adds a line of text.
    pub fn text(&mut self, at: DVec2, text: &str, em: f64, anchor: Anchor, colour: Colour) {
        let text = Text { at, text: text.to_owned(), em, anchor, upwards: false, colour };
        self.items.push(Item::Text(text));
    }

    /// Adds text centred at `centre`.
    pub fn centred(&mut self, centre: DVec2, text: &str, em: f64, colour: Colour) {
        self.text(centre + DVec2::new(0.0, 0.35 * em), text, em, Anchor::Middle, colour);
    }

    /// Adds upward text centred at `centre`.
    pub fn upwards(&mut self, centre: DVec2, text: &str, em: f64, colour: Colour) {
        let at = centre + DVec2::new(0.35 * em, 0.0);
        let text = Text { at, text: text.to_owned(), em, anchor: Anchor::Middle, upwards: true, colour };
        self.items.push(Item::Text(text));
    }

    /// Adds text wrapped to `width` pixels; returns the baseline of the next line.
    pub fn paragraph(&mut self, at: DVec2, text: &str, em: f64, width: f64) -> f64 {
        let mut baseline = at.y;
        for line in wrapped(text, em, width) {
            self.text(DVec2::new(at.x, baseline), &line, em, Anchor::Start, SOFT);
            baseline += LINE * em;
        }
        baseline
    }

    /// Adds a label on a white plate at least `gap` pixels from `point`. Tries positions around the point
    /// from the right, and takes the first within `bounds` that covers no other text, else the right.
    pub fn label(&mut self, point: DVec2, text: &str, em: f64, gap: f64, bounds: &Frame) {
        let texts = self.texts().map(|text| text.frame().grown(2.0));
        let taken: Vec<Frame> = texts.chain(self.dots(point)).collect();
        let half = DVec2::new(text_width(text, em), em) / 2.0;
        let place = |angle: f64, distance: f64| {
            let way = DVec2::from_angle(angle);
            // Place the plate's nearest side or corner.
            let side = DVec2::select(way.abs().cmpgt(DVec2::splat(0.1)), way.signum(), DVec2::ZERO);
            let at = point + way * distance + side * half + DVec2::new(0.0, 0.35 * em);
            Text { at, text: text.to_owned(), em, anchor: Anchor::Middle, upwards: false, colour: INK }
        };
        let quarter = std::f64::consts::FRAC_PI_4;
        let places = [gap, gap + 7.0, gap + 17.0]
            .into_iter()
            .flat_map(|distance| (0..8).map(move |k| (f64::from(k) * quarter, distance)));
        let fits = |text: &Text| {
            let frame = text.frame().grown(2.0);
            bounds.holds(&frame) && !taken.iter().any(|other| other.overlaps(&frame))
        };
        let mut texts = places.map(|(angle, distance)| place(angle, distance));
        let text = texts.find(fits).unwrap_or_else(|| place(0.0, gap));
        self.polygon(text.frame().grown(1.5).corners(), PAPER);
        self.items.push(Item::Text(text));
    }

    /// Dots that labels must not cover, except the one at `point`.
    fn dots(&self, point: DVec2) -> impl Iterator<Item = Frame> {
        self.items.iter().filter_map(move |item| match item {
            Item::Disc { centre, radius, .. } if centre.distance(point) > 1.0 && *radius > 4.0 => {
                Some(Frame::new(centre - *radius, centre + *radius))
            }
            _ => None,
        })
    }

    /// Adds a dot with a [`Scene::label`].
    pub fn point(&mut self, point: DVec2, text: &str, bounds: &Frame) {
        self.label(point, text, TINY, 9.0, bounds);
        self.disc(point, 4.5, PAPER);
        self.disc(point, 3.2, INK);
    }

    /// Adds a straight arrow.
    pub fn arrow(&mut self, from: DVec2, to: DVec2, width: f64, colour: Colour) {
        let way = (to - from).normalize();
        let (back, across) = (to - way * 9.0, way.perp() * 3.6);
        self.line(vec![from, back], width, colour);
        self.polygon(vec![to, back + across, back - across], colour);
    }
}

/// Wraps `text` to lines of at most `width` pixels; shortens longer words.
pub fn wrapped(text: &str, em: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    // Keep non-breaking spaces.
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), em) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(fitted(word, em, width)),
        }
    }
    lines
}
