//! A figure as LaTeX with pgfplots, which reads the numbers from the figure's table.
//!
//! Plots, ticks and legends stand where the SVG has them. What pgfplots has no word for is named in a comment of the file.

use crate::axis::Scale;
use crate::check;
use crate::crowd::Look;
use crate::error::Error;
use crate::figure::{Corner, Figure, Legend as Place, Panel};
use crate::frame::AxisFrame;
use crate::layer::{Align, Along, At, Layer, Points};
use crate::mark::Rect;
use crate::page::{Laid, lay_out};
use crate::palette::{Color, Dash, Marker};
use crate::plot::Plot;
use crate::scale::Span;
use crate::style::{LIGHT, LINE, RULE};
use crate::text::Fonts;
use std::fmt::Write;

/// What every file begins with, the second part behind the name of the table.
const COMMENTS: &str = r"% The preamble needs \usepackage{pgfplots}, \usepgfplotslibrary{fillbetween} and \pgfplotsset{compat=1.16}.
% Where the table is not in the folder that LaTeX runs in: \newcommand\turbidfolder{FOLDER} before \input.
% Not in this drawing: arrows for points beyond the limits, and the counts beyond a histogram.
";
/// More points than this with bars may not fit into five million words, the memory of TeX Live's pdflatex: 1,100 do, 7,700
/// do not.
const MANY: usize = 2000;
const MACROS: &str = r"\providecommand\turbidfolder{.}
% \turbidplot{LOOK}{PANEL}{LAYER}{COLUMNS}: the rows of one layer. The lines above them have signs of TeX's own, for which
% they are no more than letters.
\def\turbidplot#1#2#3#4{%
  \def\turbidpanel{#2}\def\turbidlayer{#3}%
  \catcode37=12 \catcode92=12 \catcode123=12 \catcode125=12
  \addplot[forget plot,#1] table[col sep=comma,#4] {\turbidfolder/\turbidtable};%
  \catcode37=14 \catcode92=0 \catcode123=1 \catcode125=2 }
% An expression in a row of the layer; nothing in any other row.
\def\turbidrow#1{\ifnum\thisrow{panel}=\turbidpanel\space
  \ifnum\thisrow{layer}=\turbidlayer\space#1\else nan\fi\else nan\fi}
\pgfplotsset{/pgf/declare function={
  turbidsymlog(\v,\t)=sign(\v)*(min(abs(\v)/\t,1)+ln(max(abs(\v)/\t,1))/ln(10));
}}
\pgfplotsset{filter discard warning=false}
";

/// The text of the file, which reads its numbers from the table of this name in `\turbidfolder`.
pub(crate) fn write(figure: &Figure, table: &str) -> Result<String, Error> {
    let fonts = Fonts::load()?;
    check::figure(figure, &fonts)?;
    let laid = lay_out(figure, &fonts)?;
    let mut out = String::new();
    let failed = |e: std::fmt::Error| Error::Backend(e.to_string());
    lines(figure, table, &laid, &fonts, &mut out).map_err(failed)?;
    Ok(out)
}

fn lines(figure: &Figure, table: &str, laid: &Laid, fonts: &Fonts, out: &mut String) -> std::fmt::Result {
    writeln!(out, "% A figure of turbid; its numbers are in {table}, its layers numbered as there.")?;
    let is_map = |panel: &Panel| panel.layers.iter().any(|l| matches!(l, Layer::Heatmap(_)));
    let maps: Vec<String> =
        (1..=figure.panels.len()).filter(|i| is_map(&figure.panels[i - 1])).map(|i| i.to_string()).collect();
    if !maps.is_empty() {
        writeln!(out, "% Nor the heat map of panel {}: take it from the SVG.", maps.join(", "))?;
    }
    let points = |l: &Layer| if let Layer::Points(points) = l { points.x.len() } else { 0 };
    if figure.panels.iter().flat_map(|p| &p.layers).map(points).sum::<usize>() > MANY {
        writeln!(out, "% So many points are more than pdflatex has memory for: lualatex has.")?;
    }
    write!(out, "{COMMENTS}\\begingroup\n\\def\\turbidtable{{{table}}}\n{MACROS}")?;
    for class in (0..7).map(Color::Class).chain([Color::Grey]) {
        let (r, g, b) = class.rgb();
        writeln!(out, "\\definecolor{{{}}}{{RGB}}{{{r},{g},{b}}}", color(class))?;
    }
    writeln!(out, "\\begin{{tikzpicture}}[font=\\scriptsize]")?;
    writeln!(out, "\\useasboundingbox (0,0) rectangle ({},{});", bp(laid.width), bp(laid.height))?;
    if !figure.title.is_empty() {
        let (style, text) = ("anchor=north west,font=\\small\\bfseries", latex(&figure.title));
        writeln!(out, "\\node[{style}] at (0,{}) {{{text}}};", bp(laid.height))?;
    }
    for (i, panel) in figure.panels.iter().enumerate() {
        let plot = Plot { rect: laid.rects[i], spans: laid.spans[i] };
        let frame = &laid.frames[i];
        writeln!(out, "\\begin{{axis}}[")?;
        let Rect { left, width, height, .. } = plot.rect;
        writeln!(
            out,
            "  at={{({},{})}}, anchor=south west,",
            bp(left),
            bp(laid.height - plot.rect.bottom())
        )?;
        writeln!(out, "  scale only axis, width={}, height={},", bp(width), bp(height))?;
        writeln!(out, "  scaled ticks=false, tick align=outside, tick pos=left, grid=major,")?;
        writeln!(out, "  grid style={{black!10}}, major tick length=3bp, minor tick length=1.7bp,")?;
        writeln!(
            out,
            "  label style={{font=\\footnotesize}}, title style={{font=\\footnotesize\\bfseries,yshift=-1ex}},
  xlabel shift=-2bp, ylabel shift=-2bp, log origin=infty,"
        )?;
        writeln!(
            out,
            "  legend cell align=left, legend style={{/tikz/every even column/.append style={{column sep=6bp}},{}}},",
            legend_place(figure, i, laid, fonts)
        )?;
        if !panel.title.is_empty() {
            writeln!(out, "  title={{{}}},", latex(&panel.title))?;
        }
        axis("x", &frame.x, out)?;
        axis("y", &frame.y, out)?;
        writeln!(out, "]")?;
        let order = |layer: &&(usize, &Layer)| match layer.1 {
            Layer::Heatmap(_) | Layer::Band(_) | Layer::Histogram(_) => 0,
            Layer::Rule(_) => 1,
            Layer::Line(_) => 2,
            Layer::Points(_) => 3,
            Layer::Note(_) => 4,
        };
        let look = Look::of(&panel.layers);
        let all: Vec<(usize, &Layer)> = panel.layers.iter().enumerate().collect();
        let mut sorted: Vec<&(usize, &Layer)> = all.iter().collect();
        sorted.sort_by_key(order);
        for &&(l, layer) in &sorted {
            self::layer(&plot, (i + 1, l + 1), layer, &look, out)?;
        }
        if !figure.shared_legend {
            legend(panel.layers.iter(), laid.places[i], out)?;
        } else if i + 1 == figure.panels.len() {
            legend(figure.panels.iter().flat_map(|p| &p.layers), Place::Below, out)?;
        }
        writeln!(out, "\\end{{axis}}")?;
    }
    writeln!(out, "\\end{{tikzpicture}}\n\\endgroup")
}

/// Limits, ticks and label of an axis; the numbers of a symmetric logarithm are transformed by us.
fn axis(name: &str, frame: &AxisFrame, out: &mut String) -> std::fmt::Result {
    let Span { scale, low, high } = frame.span;
    let back = |t: f64| if matches!(scale, Scale::SymLog { .. }) { t } else { scale.backward(t) };
    if scale.is_log() {
        writeln!(out, "  {name}mode=log,")?;
    }
    writeln!(out, "  {name}min={:?}, {name}max={:?},", back(low), back(high))?;
    let list = |at: &mut dyn Iterator<Item = f64>| {
        at.map(|t| format!("{:?}", back(t))).collect::<Vec<_>>().join(",")
    };
    let major = list(&mut frame.ticks.major.iter().map(|t| t.at));
    let names: Vec<String> = frame.ticks.major.iter().map(|t| format!("{{{}}}", latex(&t.label))).collect();
    writeln!(out, "  {name}tick={{{major}}},\n  {name}ticklabels={{{}}},", names.join(","))?;
    // An empty list would mean pgfplots' own.
    if !frame.ticks.minor.is_empty() {
        writeln!(out, "  minor {name}tick={{{}}},", list(&mut frame.ticks.minor.iter().copied()))?;
    }
    writeln!(out, "  {name}label={{{}}},", latex(&frame.label.join(" ")))
}

/// A column of the table as an expression, on the scale of its axis.
fn number(span: &Span, column: &str) -> String {
    match span.scale {
        Scale::SymLog { threshold } => format!("turbidsymlog(\\thisrow{{{column}}},{threshold:?})"),
        _ => format!("\\thisrow{{{column}}}"),
    }
}

/// The lower end of an interval: on a logarithmic axis no lower than the axis, since 0 has no place there.
fn low_end(span: &Span, column: &str) -> String {
    let number = number(span, column);
    if span.scale.is_log() { format!("max({number},{:?})", span.scale.backward(span.low)) } else { number }
}

/// One layer: all of its numbers come from the table, but for a rule's ends and a note's place.
fn layer(
    plot: &Plot,
    (p, l): (usize, usize),
    layer: &Layer,
    look: &Look,
    out: &mut String,
) -> std::fmt::Result {
    let (x, y) = (&plot.spans.x, &plot.spans.y);
    // Columns of pgfplots, each an expression of columns of the table.
    let columns = |columns: &[(&str, String)]| {
        let one = |(name, number): &(&str, String)| format!("{name} expr={{\\turbidrow{{{number}}}}}");
        columns.iter().map(one).collect::<Vec<_>>().join(",")
    };
    let bars = |drawn: &str, dirs: &str| format!(",error bars/.cd,{drawn}{dirs}");
    let plot_rows = |out: &mut String, look: String, numbers: &[(&str, String)]| {
        writeln!(out, "\\turbidplot{{{look}}}{{{p}}}{{{l}}}{{{}}}", columns(numbers))
    };
    writeln!(out, "% {p}.{l}: {}", layer.kind())?;
    match layer {
        Layer::Points(points) => {
            let (at_x, at_y) = (number(x, "x"), number(y, "y"));
            let (mut dirs, mut numbers) = (String::new(), vec![("x", at_x.clone()), ("y", at_y.clone())]);
            if points.x_interval.is_some() {
                dirs.push_str(",x dir=both,x explicit");
                numbers.push(("x error plus", format!("{}-{at_x}", number(x, "x_high"))));
                numbers.push(("x error minus", format!("{at_x}-{}", low_end(x, "x_low"))));
            }
            if points.y_interval.is_some() {
                dirs.push_str(",y dir=both,y explicit");
                numbers.push(("y error plus", format!("{}-{at_y}", number(y, "y_high"))));
                numbers.push(("y error minus", format!("{at_y}-{}", low_end(y, "y_low"))));
            }
            let bars =
                if dirs.is_empty() { String::new() } else { bars(&bar_style(points.color, look), &dirs) };
            plot_rows(out, marker_style(points, look) + &bars, &numbers)
        }
        Layer::Line(_) => plot_rows(out, style(layer), &[("x", number(x, "x")), ("y", number(y, "y"))]),
        Layer::Band(_) => {
            for (end, height) in [("low", low_end(y, "y_low")), ("high", number(y, "y_high"))] {
                let look = format!("draw=none,name path=turbid{end}{p}-{l}");
                plot_rows(out, look, &[("x", number(x, "x")), ("y", height)])?;
            }
            let between = format!("fill between[of=turbidlow{p}-{l} and turbidhigh{p}-{l}]");
            writeln!(out, "\\addplot[{},forget plot] {between};", style(layer))
        }
        Layer::Histogram(bars) => {
            let (low, high) = (number(x, "x_low"), number(x, "x_high"));
            let numbers = [("x", format!("0.5*({low}+{high})")), ("y", number(y, "y"))];
            let width = |e: &[f64]| x.scale.forward(e[1]) - x.scale.forward(e[0]);
            let first = width(&bars.edges[..2]);
            let is_even = bars.edges.windows(2).all(|e| (width(e) / first - 1.0).abs() < 1e-6);
            // pgfplots draws bars of one width, on an axis whose numbers are those of the table or ours.
            if is_even && !x.scale.is_log() {
                let look = format!("ybar,bar shift=0pt,bar width={first:?},{}", style(layer));
                return plot_rows(out, look, &numbers);
            }
            writeln!(out, "% The bars are not of one width: points at the middles of their tops.")?;
            plot_rows(out, format!("only marks,mark=-,color={}", color(bars.color)), &numbers)
        }
        Layer::Rule(rule) => {
            let points =
                if rule.along == Along::Diagonal { plot.diagonal() } else { plot.rule(rule.along).to_vec() };
            // As fractions of the plot: the axis has its limits from us.
            let at = points.iter().map(|&(a, b)| {
                let (u, v) =
                    ((a - plot.rect.left) / plot.rect.width, (plot.rect.bottom() - b) / plot.rect.height);
                format!("(rel axis cs:{u:.5},{v:.5})")
            });
            let path = at.collect::<Vec<_>>().join(" -- ");
            writeln!(out, "\\draw[{}] {path};", style(layer))
        }
        Layer::Heatmap(_) => writeln!(out, "% (not drawn)"),
        Layer::Note(note) => {
            let at = match note.at {
                At::Data(x, y) => plot.at(x, y),
                At::Fraction(x, y) => (plot.x_at(x), plot.y_at(y)),
            };
            let u = (at.0 - plot.rect.left) / plot.rect.width;
            let v = (plot.rect.bottom() - at.1) / plot.rect.height;
            let anchor = match note.align {
                Align::Start => "base west",
                Align::Middle => "base",
                Align::End => "base east",
            };
            let node = format!("anchor={anchor},inner sep=0pt,fill=white,fill opacity=0.8,text opacity=1");
            writeln!(out, "\\node[{node}] at (rel axis cs:{u:.5},{v:.5}) {{{}}};", latex(&note.text))
        }
    }
}

/// Colour, line and marker of a layer.
fn style(layer: &Layer) -> String {
    let stroke = |c: Color, dash: Dash, width: f64| {
        let dash = match dash {
            Dash::Solid => "solid",
            Dash::Dashed => "dashed",
            Dash::Dotted => "dotted",
            Dash::DashDot => "dashdotted",
        };
        format!("no marks,color={},{dash},line width={}", color(c), bp(width))
    };
    match layer {
        Layer::Points(l) => marker_style(l, &Look::FEW),
        Layer::Line(l) => stroke(l.color, l.dash, LINE),
        Layer::Rule(l) => stroke(l.color, l.dash, RULE),
        Layer::Histogram(l) => {
            let color = color(l.color);
            format!("draw={color},fill={color},fill opacity={LIGHT},line width=0.8bp")
        }
        Layer::Band(l) => format!("draw=none,fill={},fill opacity={LIGHT}", color(l.color)),
        Layer::Heatmap(_) | Layer::Note(_) => String::new(),
    }
}

/// The markers of points, by how many there are.
fn marker_style(points: &Points, look: &Look) -> String {
    let mark = match points.marker {
        Marker::Circle => "*",
        Marker::Square => "square*",
        Marker::Triangle => "triangle*",
        Marker::Diamond => "diamond*",
        Marker::TriangleDown => "triangle*,mark options={rotate=180}",
        Marker::Cross => "x",
        Marker::Plus => "+",
    };
    // A square of this size is twice as wide.
    let size = bp(look.radius * if points.marker == Marker::Square { 0.886 } else { 1.0 });
    let alpha = if look.alpha < 1.0 { format!(",opacity={}", look.alpha) } else { String::new() };
    format!("only marks,color={}{alpha},mark size={size},mark={mark}", color(points.color))
}

/// The bars of their intervals.
fn bar_style(bars: Color, look: &Look) -> String {
    let caps = if look.cap > 0.0 {
        format!("error mark options={{rotate=90,mark size={},line width={}}}", bp(look.cap), bp(look.bar))
    } else {
        "error mark=none".to_owned()
    };
    let tint = 100.0 * look.tint;
    format!("error bar style={{line width={},color={}!{tint:.0}}},{caps}", bp(look.bar), color(bars))
}

/// Each label once, with the look of its points, if it has any.
fn legend<'a>(layers: impl Iterator<Item = &'a Layer>, place: Place, out: &mut String) -> std::fmt::Result {
    let mut entries: Vec<&Layer> = Vec::new();
    for layer in layers.filter(|l| !l.label().is_empty() && place != Place::Hidden) {
        match entries.iter_mut().find(|e| e.label() == layer.label()) {
            Some(entry) if matches!(layer, Layer::Points(_)) && !matches!(entry, Layer::Points(_)) => {
                *entry = layer
            }
            Some(_) => {}
            None => entries.push(layer),
        }
    }
    for layer in entries {
        let area = if matches!(layer, Layer::Band(_) | Layer::Histogram(_)) { "area legend," } else { "" };
        writeln!(out, "\\addlegendimage{{{area}{}}}", style(layer))?;
        writeln!(out, "\\addlegendentry{{{}}}", latex(layer.label()))?;
    }
    Ok(())
}

/// Where the legend of a panel stands, and in how many columns.
fn legend_place(figure: &Figure, panel: usize, laid: &Laid, fonts: &Fonts) -> String {
    let (rect, frame) = (&laid.rects[panel], &laid.frames[panel]);
    if let Some((legend, (x, y))) = laid.shared(figure, fonts) {
        let (x, y) = (x + 0.5 * legend.width() - rect.left, y - rect.bottom());
        return format!(
            "draw=none,legend columns={},at={{(0,0)}},anchor=north,xshift={},yshift={}",
            legend.columns(),
            bp(x),
            bp(-y)
        );
    }
    let beside = |corner: Corner| match corner {
        Corner::TopRight => "at={(0.97,0.97)},anchor=north east",
        Corner::TopLeft => "at={(0.03,0.97)},anchor=north west",
        Corner::BottomRight => "at={(0.97,0.03)},anchor=south east",
        Corner::BottomLeft => "at={(0.03,0.03)},anchor=south west",
        Corner::Top => "at={(0.5,0.97)},anchor=north",
        Corner::Bottom => "at={(0.5,0.03)},anchor=south",
        Corner::Right => "at={(0.97,0.5)},anchor=east",
        Corner::Left => "at={(0.03,0.5)},anchor=west",
    };
    match laid.places[panel] {
        Place::Inside(corner) => format!("draw=black!25,{}", beside(corner)),
        Place::Right => format!("draw=none,at={{(1,1)}},anchor=north west,xshift={}", bp(frame.right + 3.0)),
        Place::Below | Place::Auto | Place::Hidden => {
            let outside = laid.outside(&figure.panels[panel], laid.places[panel], fonts);
            let columns = outside.map_or(1, |legend| legend.columns());
            format!(
                "draw=none,legend columns={columns},at={{(0.5,0)}},anchor=north,yshift={}",
                bp(-frame.bottom - 3.0)
            )
        }
    }
}

fn color(color: Color) -> String {
    match color {
        Color::Class(i) => format!("turbid{}", i % 7),
        Color::Black => "black".to_owned(),
        Color::Grey => "turbidgrey".to_owned(),
    }
}

/// A length on the page.
fn bp(points: f64) -> String {
    format!("{points:.2}bp")
}

/// A text for LaTeX: what it would take for a command is escaped, what pdflatex has no glyph for is named in mathematics.
pub fn latex(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\\' => out.push_str(r"\textbackslash{}"),
            '~' => out.push_str(r"\textasciitilde{}"),
            '^' => out.push_str(r"\textasciicircum{}"),
            '{' | '}' | '$' | '&' | '#' | '%' | '_' => {
                out.push('\\');
                out.push(c);
            }
            '<' | '>' | '|' => out.push_str(&format!(r"\ensuremath{{{c}}}").replace('|', r"\vert")),
            '"' => out.push_str("''"),
            ' '..='~' => out.push(c),
            other => match symbol(other) {
                Some(math) => out.push_str(&format!(r"\ensuremath{{{math}}}")),
                // Named rather than lost.
                None => out.push_str(&format!("[U+{:04X}]", u32::from(other))),
            },
        }
    }
    out
}

/// A character in mathematics.
fn symbol(c: char) -> Option<&'static str> {
    const GREEK: [(char, &str); 33] = [
        ('α', r"\alpha"),
        ('β', r"\beta"),
        ('γ', r"\gamma"),
        ('δ', r"\delta"),
        ('ε', r"\varepsilon"),
        ('ζ', r"\zeta"),
        ('η', r"\eta"),
        ('θ', r"\theta"),
        ('ι', r"\iota"),
        ('κ', r"\kappa"),
        ('λ', r"\lambda"),
        ('μ', r"\mu"),
        ('ν', r"\nu"),
        ('ξ', r"\xi"),
        ('π', r"\pi"),
        ('ρ', r"\rho"),
        ('σ', r"\sigma"),
        ('τ', r"\tau"),
        ('υ', r"\upsilon"),
        ('φ', r"\varphi"),
        ('χ', r"\chi"),
        ('ψ', r"\psi"),
        ('ω', r"\omega"),
        ('Γ', r"\Gamma"),
        ('Δ', r"\Delta"),
        ('Θ', r"\Theta"),
        ('Λ', r"\Lambda"),
        ('Ξ', r"\Xi"),
        ('Π', r"\Pi"),
        ('Σ', r"\Sigma"),
        ('Φ', r"\Phi"),
        ('Ψ', r"\Psi"),
        ('Ω', r"\Omega"),
    ];
    const OTHERS: [(char, &str); 39] = [
        ('−', "-"),
        ('×', r"\times"),
        ('·', r"\cdot"),
        ('±', r"\pm"),
        ('∞', r"\infty"),
        ('≤', r"\le"),
        ('≥', r"\ge"),
        ('≠', r"\ne"),
        ('≈', r"\approx"),
        ('∝', r"\propto"),
        ('√', r"\surd"),
        ('→', r"\to"),
        ('°', r"{}^\circ"),
        ('µ', r"\mu"),
        ('–', r"\mbox{--}"),
        ('—', r"\mbox{---}"),
        ('’', r"\mbox{'}"),
        ('…', r"\dots"),
        ('\u{a0}', r"~"),
        ('½', r"\frac12"),
        ('⁰', "^0"),
        ('¹', "^1"),
        ('²', "^2"),
        ('³', "^3"),
        ('⁴', "^4"),
        ('⁵', "^5"),
        ('⁶', "^6"),
        ('⁷', "^7"),
        ('⁸', "^8"),
        ('⁹', "^9"),
        ('⁻', "^-"),
        ('₀', "_0"),
        ('₁', "_1"),
        ('₂', "_2"),
        ('₃', "_3"),
        ('₄', "_4"),
        ('₅', "_5"),
        ('∑', r"\sum"),
        ('∫', r"\int"),
    ];
    GREEK.iter().chain(&OTHERS).find(|s| s.0 == c).map(|s| s.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_safe_for_latex() {
        for (text, expected) in [
            ("5 % of a_b & c#1", r"5 \% of a\_b \& c\#1"),
            (r"a\b{c}$d^e~f", r"a\textbackslash{}b\{c\}\$d\textasciicircum{}e\textasciitilde{}f"),
            ("W/m²", r"W/m\ensuremath{^2}"),
            ("10⁻⁷", r"10\ensuremath{^-}\ensuremath{^7}"),
            ("−4 < τ", r"\ensuremath{-}4 \ensuremath{<} \ensuremath{\tau}"),
            ("Ж", "[U+0416]"),
        ] {
            assert_eq!(latex(text), expected);
        }
    }
}
