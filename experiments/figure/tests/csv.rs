//! A figure written as CSV and read back is the same figure; a bad file is refused by line.
#![allow(clippy::unwrap_used, reason = "tests")]

use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use turbid_figure::{
    Align, Along, At, Axis, Band, Color, Corner, Dash, Error, Figure, Heatmap, Histogram, Layer, Legend,
    Line, Marker, Note, Panel, Points, Rule, Scale, Shading, Width,
};

/// The same cases on every run.
fn runner(cases: u32) -> TestRunner {
    TestRunner::new(Config {
        cases,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..Config::default()
    })
}

/// Numbers at every size that a column may hold.
const NUMBERS: [f64; 9] = [0.1, -0.0, 1e-300, 4.9e-324, -1e300, 1.0 / 3.0, 1e16, -2.5e-7, 123_456_789.0];

/// One layer of every kind and variant; the writer's match has no wildcard, so that it cannot miss a new one.
fn specimens() -> Vec<Layer> {
    let x = NUMBERS.to_vec();
    let intervals: Vec<(f64, f64)> = NUMBERS.iter().map(|v| (v - v.abs(), v + v.abs())).collect();
    let points = Points::new("a, \"quoted\" label; # and comma", 3, x.clone(), x.clone());
    let edges = vec![-1e300, -0.5, 0.1, 2.0 / 3.0, 1e16];
    let map = Heatmap {
        x_edges: edges.clone(),
        y_edges: vec![0.0, 0.1, 0.30000000000000004],
        values: (0..8).map(|i| 0.1 * f64::from(i) - 0.3).collect(),
        shading: Shading::Diverging,
        quantity: Axis::linear("Error", "%").with_range(-0.2, 0.2),
    };
    let note = |at, align| Note { text: " spaces at both ends ".to_owned(), at, align };
    let all: Vec<Layer> = vec![
        points.clone().into(),
        points.clone().with_x_interval(intervals.clone()).into(),
        points.clone().with_y_interval(intervals.clone()).into(),
        Points { color: Color::Grey, ..points.with_x_interval(intervals.clone()) }
            .with_y_interval(intervals.clone())
            .into(),
        Line::new("", 11, x.clone(), x.clone()).into(),
        Line::theory("σ_t r → 10⁻⁶", x.clone(), x.clone()).with_dash(Dash::DashDot).into(),
        Band::new("band", 1, x, intervals).into(),
        Histogram { below: 3, above: 9, ..Histogram::new("bars", 2, edges, vec![0.0, 1.0, 0.25, 1e-9]) }
            .into(),
        Rule::new(Along::Horizontal(-0.0)).into(),
        Rule::new(Along::Vertical(0.1)).with_label("here").with_dash(Dash::Dotted).into(),
        Rule::new(Along::Diagonal).into(),
        map.clone().into(),
        Heatmap { shading: Shading::Sequential, quantity: Axis::linear("Q", ""), ..map }.into(),
        note(At::Data(0.1, 1e-300), Align::Start).into(),
        note(At::Fraction(0.5, 0.25), Align::Middle).into(),
        note(At::Fraction(1.0, 0.25), Align::End).into(),
    ];
    all
}

fn axes() -> Panel {
    Panel::new(Axis::linear("x", ""), Axis::linear("y", "W/m²"))
}

/// Equal as written and as bits: -0 and 0 differ in what is written.
fn assert_back(figure: &Figure, description: &str) {
    let text = figure.csv(description).unwrap();
    let (back, words) = Figure::from_csv(&text).unwrap();
    assert_eq!(&back, figure, "{text}");
    assert_eq!(words, description);
    assert_eq!(back.csv(&words).unwrap(), text);
}

#[test]
fn every_kind_of_layer_comes_back() {
    for layer in specimens() {
        assert_back(&Figure::new(vec![axes().with(layer)]), "one layer");
    }
    let panel = specimens().into_iter().fold(axes(), Panel::with);
    assert_back(
        &Figure { columns: 2, ..Figure::new(vec![panel.clone(), axes().with(specimens().remove(0)), panel]) },
        "",
    );
}

#[test]
fn every_look_comes_back() {
    let line = || Line::theory("", vec![1.0], vec![1.0]);
    for scale in [Scale::Linear, Scale::Log, Scale::LogClipped, Scale::SymLog { threshold: 0.1 }] {
        let mut axis = Axis::new("a \\ \"label\"", "mfp", scale).with_range(0.1, 30.0);
        axis.names = vec![(1.0, "one: 1".to_owned()), (2.5, String::new())];
        assert_back(
            &Figure::new(vec![Panel::new(axis.clone(), axis).with(line())]),
            "two\nlines, \"quotes\"",
        );
    }
    let corners = [
        Corner::TopRight,
        Corner::TopLeft,
        Corner::BottomRight,
        Corner::BottomLeft,
        Corner::Top,
        Corner::Bottom,
        Corner::Right,
        Corner::Left,
    ];
    let legends = [Legend::Auto, Legend::Right, Legend::Below, Legend::Hidden];
    for legend in corners.map(Legend::Inside).into_iter().chain(legends) {
        assert_back(&Figure::new(vec![axes().with(line()).with_legend(legend).with_title("t")]), "");
    }
    for color in [Color::Class(0), Color::Class(usize::MAX), Color::Black, Color::Grey] {
        let dashes = [Dash::Solid, Dash::Dashed, Dash::Dotted, Dash::DashDot];
        let lines = dashes.map(|dash| Layer::from(Line { color, dash, ..line() }));
        assert_back(&Figure::new(vec![lines.into_iter().fold(axes(), Panel::with)]), "");
    }
    for class in 0..7 {
        let points = Points { marker: Marker::of_class(class), ..Points::new("", 0, vec![1.0], vec![1.0]) };
        assert_back(&Figure::new(vec![axes().with(points)]), "");
    }
    for width in [Width::Single, Width::Double, Width::Millimetres(120.5)] {
        let figure = Figure { width, ..Figure::new(vec![axes().with(line()); 3]) };
        let heights = vec![0.1, 1.0 / 3.0];
        assert_back(
            &Figure { columns: 2, heights, shared_legend: true, title: "T".to_owned(), ..figure },
            "",
        );
    }
}

#[test]
fn every_finite_number_comes_back() {
    let finite = any::<f64>().prop_filter("finite", |v| v.is_finite());
    let lists = proptest::collection::vec((finite.clone(), finite), 1..20);
    runner(300)
        .run(&lists, |pairs| {
            let (x, y): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
            let intervals = pairs.iter().map(|&(a, b)| (a.min(b), a.max(b))).collect();
            let points = Points::new("p", 0, x.clone(), y.clone()).with_y_interval(intervals);
            let (mut edges, mut map) = (x.clone(), y);
            edges.push(0.0);
            edges.push(1.0);
            for list in [&mut edges, &mut map] {
                list.sort_by(f64::total_cmp);
                list.dedup();
            }
            let bars = Histogram::new("h", 1, edges.clone(), vec![0.5; edges.len() - 1]);
            assert_back(&Figure::new(vec![axes().with(points).with(bars)]), "any");
            Ok(())
        })
        .unwrap();
}

#[test]
fn the_drawing_is_the_same() {
    let figure = Figure {
        columns: 2,
        width: Width::Double,
        ..Figure::new(vec![
            axes().with(Points::new("p", 0, vec![0.1, 0.7], vec![1.0, 2.0])),
            axes().with(Histogram::density("h", 1, &[0.1, 0.2, 0.9], vec![0.0, 0.5, 1.0])),
        ])
    };
    let (back, _) = Figure::from_csv(&figure.csv("").unwrap()).unwrap();
    assert_eq!(back.svg().unwrap(), figure.svg().unwrap());
    assert_eq!(back.png().unwrap(), figure.png().unwrap());
}

#[test]
fn what_cannot_be_drawn_is_not_written() {
    let bad = Line::theory("", vec![f64::NAN], vec![1.0]);
    assert!(matches!(Figure::new(vec![axes().with(bad)]).csv(""), Err(Error::NotFinite { .. })));
}

/// What a person reads: this text is the format.
const GOOD: &str = r##"# turbid figure: 1
# description: "What to see."
# figure: {"title":"","width":"single","columns":1,"heights":[],"shared_legend":false}
# panel 1: {"title":"","x":{"label":"radius","unit":"mfp","scale":"log"},"y":{"label":"error","unit":"%","scale":{"sym_log":{"threshold":1.0}}},"legend":"auto"}
# layer 1.1: {"color":{"class":0},"marker":"circle"}
# layer 1.2: {"color":"black","dash":"solid"}
panel,layer,kind,x,y,y_low,y_high,label
1,1,points,0.1,-3.0,-4.0,-2.0,measured
1,1,points,0.2,-12.5,-13.5,-11.5,measured
1,2,line,0.1,-3.25,,,exact
1,2,line,0.2,-12.0,,,exact
"##;

#[test]
fn the_format_is_this() {
    let points = Points::new("measured", 0, vec![0.1, 0.2], vec![-3.0, -12.5])
        .with_y_interval(vec![(-4.0, -2.0), (-13.5, -11.5)]);
    let error = Axis::new("error", "%", Scale::SymLog { threshold: 1.0 });
    let panel = Panel::new(Axis::log("radius", "mfp"), error).with(points).with(Line::theory(
        "exact",
        vec![0.1, 0.2],
        vec![-3.25, -12.0],
    ));
    let figure = Figure::new(vec![panel]);
    assert_eq!(figure.csv("What to see.").unwrap(), GOOD);
    assert_eq!(Figure::from_csv(GOOD).unwrap(), (figure, "What to see.".to_owned()));
}

#[test]
fn edits_by_other_programs_are_understood() {
    let good = Figure::from_csv(GOOD).unwrap();
    // Other line ends, a mark of the encoding, other orders of columns and layers, a row left out, whole numbers.
    let windows = format!("\u{feff}{}", GOOD.replace('\n', "\r\n"));
    assert_eq!(Figure::from_csv(&windows).unwrap(), good);
    let (head, _) = GOOD.split_once("panel,layer").unwrap();
    let table = "kind,y_high,label,panel,layer,y,x,y_low\n\
                 line,,exact,1,2,-3.25,0.1,\n\
                 points,-2,measured,1,1,-3,0.1,-4\n\
                 # points,0,measured,1,1,0,0.15,0\n\
                 line,,exact,1,2,-12,2e-1,\n\
                 points,-11.5,measured,1,1, -12.5 ,0.2,-13.5";
    assert_eq!(Figure::from_csv(&format!("{head}{table}")).unwrap(), good);
}

#[test]
fn bad_files_are_refused_by_line() {
    for (from, to, message) in [
        ("0.2,-12.5,", "0.2,abc,", "9: column y is \"abc\"; allowed: a finite number or nothing"),
        ("0.2,-12.5,", "0.2,NaN,", "9: column y is \"NaN\"; allowed: a finite number or nothing"),
        ("0.2,-12.5,", "0.2,,", "9: column y is empty; allowed: a number in every row of a points layer"),
        ("0.2,-12.0,,", "0.2,-12.0,1,", "11: column y_low is filled; allowed for a line layer: x, y"),
        ("-13.5,-11.5", ",", "9: column y_low is empty; allowed: a number in every row of a points layer"),
        (
            "-4.0,-2.0",
            "-4.0,-5.0",
            "8: panel 1, points \"measured\": y_interval[0] runs from -4 down to -5; give (low, high)",
        ),
        (
            "line,0.2",
            "line,-0.2",
            "11: panel 1, line \"exact\": x[1] is -0.2, on a logarithmic axis; use Scale::LogClipped to mark it at the border, or Scale::SymLog",
        ),
        (
            "1,2,line,0.2,-12.0,,,exact",
            "1,2,line,0.2,-12.0,,,other",
            "11: column label is \"other\"; allowed: \"exact\", as in line 10 of the same layer",
        ),
        (
            "1,2,line,0.2",
            "1,2,points,0.2",
            "11: column kind is \"points\"; allowed: \"line\", as in line 10 of the same layer",
        ),
        (
            "1,2,line,0.2",
            "1,3,line,0.2",
            "11: there is no layer 1.3; allowed: those with a line # layer 1.3: ...",
        ),
        ("1,2,line,0.2", "0,2,line,0.2", "11: column panel is \"0\"; allowed: a whole number from 1"),
        ("1,2,line,0.2", "1,line,0.2", "11: the row has 7 cells; allowed: 8"),
        (
            "kind,x,",
            "kind,x,x,",
            "7: there is no column \"x\"; allowed, once each: panel, layer, kind, label, x, y, x_low, x_high, y_low, y_high, value",
        ),
        (
            "panel,layer,kind,x",
            "panel,layer,x",
            "7: column kind is missing; allowed: panel, layer, kind, label and numbers",
        ),
        ("\"black\"", "\"blakc\"", "6:29: unknown variant `blakc`, expected one of `class`, `black`, `grey`"),
        (
            "\"marker\":\"circle\"",
            "\"marker\":\"circle\",\"size\":2",
            "5:58: unknown field `size`, expected `color` or `marker`",
        ),
        ("{\"class\":0}", "{\"class\":-1}", "5:33: invalid value: integer `-1`, expected usize"),
        (
            "\"columns\":1",
            "\"columns\":0",
            "3: the figure is empty: a figure needs panels, a panel needs layers with data",
        ),
        (
            "\"scale\":\"log\"",
            "\"scale\":\"log\",\"range\":[0,1]",
            "4: panel 1: x cannot run from 0 to 1; give finite limits, low below high by more than 1e-300, positive on a logarithmic axis",
        ),
        (
            "# layer 1.2:",
            "# layer 1.3:",
            "6: \"layer 1.3\" is out of order; allowed: turbid figure first, description and figure once, panel 1, its layers 1.1, 1.2 and so on, then panel 2",
        ),
        (
            "# layer 1.2:",
            "# shade 1.2:",
            "6: \"shade 1.2\" is unknown; allowed: turbid figure, description, figure, panel N, layer N.M",
        ),
        ("# turbid figure: 1", "# turbid figure: 2", "1: the format is 2; allowed: 1"),
        ("# turbid figure: 1\n", "", "1: the file is no figure; its first line would be # turbid figure: 1"),
        (
            "1,2,line,0.1,-3.25,,,exact\n1,2,line,0.2,-12.0,,,exact\n",
            "",
            "6: no row has panel 1 and layer 2; allowed: one or more",
        ),
    ] {
        assert!(GOOD.contains(from), "{from}");
        let error = Figure::from_csv(&GOOD.replacen(from, to, 1)).unwrap_err().to_string();
        assert_eq!(error, message, "{from} -> {to}");
    }
    for (text, message) in [
        ("", "1: the file is no figure; its first line would be # turbid figure: 1"),
        ("x,y\n1,2\n", "1: the file is no figure; its first line would be # turbid figure: 1"),
        ("# turbid figure: 1\n", "1: the header ends without a line # figure: ..."),
        (
            GOOD.split_once("panel,").unwrap().0,
            "7: the table is missing; allowed: a row of names, panel, layer, kind, label among them",
        ),
    ] {
        assert_eq!(Figure::from_csv(text).unwrap_err().to_string(), message, "{text}");
    }
}

#[test]
fn cells_of_a_map_and_bins_must_follow_each_other() {
    let map = Heatmap {
        x_edges: vec![0.0, 1.0, 2.0],
        y_edges: vec![0.0, 1.0, 2.0],
        values: vec![1.0, 2.0, 3.0, 4.0],
        shading: Shading::Sequential,
        quantity: Axis::linear("q", ""),
    };
    let bars = Histogram::new("h", 0, vec![0.0, 1.0, 2.0], vec![1.0, 2.0]);
    let text = Figure::new(vec![axes().with(map).with(bars)]).csv("").unwrap();
    for (from, to, message) in [
        ("1,1,heatmap,,1.0,2.0,1.0,2.0,4.0,\n", "", "the last row of cells has 1; allowed: 2"),
        (
            "heatmap,,1.0,2.0,0.0,1.0,2.0",
            "heatmap,,1.5,2.0,0.0,1.0,2.0",
            "x_low is 1.5; allowed: 1, where the row before ends",
        ),
        (
            "heatmap,,1.0,2.0,1.0,2.0",
            "heatmap,,1.0,3.0,1.0,2.0",
            "a cell at x from 1 to 3, y from 1 to 2; allowed: x from 1 to 2, y from 1 to 2",
        ),
        ("histogram,2.0,1.0,2.0", "histogram,2.0,1.0,1.0", "a bin from 1 to 1; allowed: x_low below x_high"),
    ] {
        assert!(text.contains(from), "{from} in {text}");
        let error = Figure::from_csv(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}

/// Whatever happens to a file, reading it gives a figure that can be written, or an error with a line of the file.
#[test]
fn damaged_files_give_one_line() {
    let panel = specimens().into_iter().fold(axes(), Panel::with);
    let good = Figure::new(vec![panel]).csv("damage").unwrap();
    let lines = good.lines().count();
    let bytes = good.as_bytes();
    let damage = (0..bytes.len(), any::<u8>(), 0..4_u8, 0..bytes.len());
    runner(3000)
        .run(&damage, |(at, byte, how, other)| {
            let mut bad = bytes.to_vec();
            match how {
                0 => bad[at] = byte,
                1 => bad.truncate(at),
                2 => drop(bad.drain(at.min(other)..at.max(other))),
                _ => bad.swap(at, other),
            }
            match Figure::from_csv(&String::from_utf8_lossy(&bad)) {
                Ok((figure, words)) => drop(figure.csv(&words).unwrap()),
                Err(Error::Csv { line, problem, .. }) => {
                    // A byte may become a line end.
                    prop_assert!((1..=lines + 1).contains(&line), "{line}");
                    prop_assert!(!problem.contains('\n') && !problem.is_empty(), "{problem}");
                }
                Err(other) => prop_assert!(false, "{other}"),
            }
            Ok(())
        })
        .unwrap();
}
