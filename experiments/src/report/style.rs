//! The look of the report: a page of print, on screen and on paper, without anything from elsewhere.

/// Embedded in the page.
pub(super) const CSS: &str = "
:root { --ink: #1c1f23; --soft: #5b6470; --line: #d5dae0; --wash: #f5f6f8; --good: #1d6b3a; --bad: #a3231f; --open: #8a5a00; }
* { box-sizing: border-box; }
html { background: #fff; color: var(--ink); }
body { max-width: 1080px; margin: 0 auto; padding: 48px 28px 80px; font: 17px/1.55 Charter, 'Bitstream Charter', Georgia, 'Times New Roman', serif; }
h1 { font-size: 34px; line-height: 1.2; margin: 4px 0 10px; font-weight: 600; }
h2 { font-size: 25px; line-height: 1.25; margin: 64px 0 8px; padding-top: 18px; border-top: 2px solid var(--ink); font-weight: 600; }
h3 { font-size: 18px; margin: 32px 0 8px; font-weight: 600; }
p { margin: 0 0 14px; max-width: 44em; }
.kicker, .byline, figcaption, caption, table, .plain, pre, .badge, summary, nav { font-family: system-ui, 'Segoe UI', 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif; }
.kicker { letter-spacing: .08em; text-transform: uppercase; font-size: 13px; color: var(--soft); }
.byline { font-size: 14px; color: var(--soft); margin-bottom: 28px; }
.question { font-style: italic; font-size: 18px; }
.verdicts { font-family: system-ui, Arial, 'DejaVu Sans', sans-serif; font-size: 14px; font-variant-numeric: tabular-nums; }
.verdicts b { font-weight: 600; margin-left: 8px; }
.find input { font: inherit; font-size: 15px; padding: 4px 8px; border: 1px solid var(--line); border-radius: 4px; }
dl.words { display: grid; grid-template-columns: max-content 1fr; gap: 4px 16px; font-size: 15px; max-width: 60em; } dl.words dt { font-weight: 600; } dl.words dd { margin: 0; }
.lead { font-weight: 600; } td > div:not(.advice) { white-space: nowrap; }
ul { padding-left: 1.2em; margin: 0 0 14px; } li { margin-bottom: 6px; }
a { color: #1a4f8b; text-decoration: none; } a:hover { text-decoration: underline; }
.scroll { overflow-x: auto; margin: 18px 0 28px; background: linear-gradient(90deg, #fff 40%, #fff0) 0 0 / 48px 100% local, linear-gradient(270deg, #fff 40%, #fff0) 100% 0 / 48px 100% local, linear-gradient(90deg, #0003, #0000) 0 0 / 16px 100% scroll, linear-gradient(270deg, #0003, #0000) 100% 0 / 16px 100% scroll; background-repeat: no-repeat; }
table { border-collapse: collapse; width: 100%; font-size: 14px; line-height: 1.4; font-variant-numeric: tabular-nums; }
caption, figcaption { text-align: left; font-size: 14px; line-height: 1.45; color: var(--ink); padding-bottom: 8px; caption-side: top; }
.scroll caption { position: sticky; left: 0; max-width: min(1024px, 100vw - 28px); }
caption b, figcaption b { margin-right: 4px; }
th { text-align: left; font-weight: 600; border-bottom: 1.5px solid var(--ink); border-top: 1.5px solid var(--ink); padding: 6px 14px 6px 0; vertical-align: bottom; }
td { border-bottom: 1px solid var(--line); padding: 5px 12px 5px 0; vertical-align: top; }
td.claim { min-width: 15em; }
th.n, td.n { text-align: right; white-space: nowrap; }
th:last-child, td:last-child { padding-right: 0; }
tr.group td { font-weight: 600; border-bottom: none; padding-top: 14px; }
.advice { color: var(--soft); font-size: 13px; }
.badge { font-size: 12.5px; font-weight: 600; border-radius: 3px; padding: 1px 8px; white-space: nowrap; border: 1px solid currentColor; }
.upheld { color: var(--good); } .rejected { color: #fff; background: var(--bad); border-color: var(--bad); } .undecided { color: var(--open); border-style: dashed; }
figure { margin: 28px 0 34px; }
figure.narrow { max-width: 620px; }
figure svg { display: block; width: 100%; height: auto; margin-bottom: 10px; }
nav.contents { border-top: 1.5px solid var(--ink); border-bottom: 1.5px solid var(--ink); margin: 8px 0 26px; padding: 4px 0 8px; }
nav.contents ol { margin: 0; padding-left: 1.8em; font-size: 15px; line-height: 1.45; }
nav.contents li { margin: 5px 0 0; }
nav.contents .title { font-weight: 600; }
nav.contents .places { color: var(--soft); font-size: 13.5px; margin-left: 8px; } nav.contents .places a { margin-left: 4px; }
h2 .up { font-size: 17px; color: var(--soft); margin-left: 6px; }
summary { cursor: pointer; color: #1a4f8b; font-size: 14px; padding: 4px 0; }
.fold { margin-bottom: 28px; } .fold .scroll { margin-bottom: 4px; }
.fold:not(:has(details[open])) tr.more:not(:has(td:target)) { display: none; }
.fold details[open] .closed, .fold details:not([open]) .opened { display: none; }
tr:has(td:target), figure:target { background: #fff6d8; }
.note { border-left: 3px solid var(--line); padding: 2px 0 2px 14px; font-size: 15.5px; color: #333a42; }
.warning { border-left: 3px solid var(--bad); padding: 6px 0 6px 14px; }
pre { background: var(--wash); border: 1px solid var(--line); border-radius: 4px; padding: 12px 14px; font-family: ui-monospace, Menlo, Consolas, 'DejaVu Sans Mono', monospace; font-size: 13.5px; white-space: pre-wrap; }
code { font-family: ui-monospace, Menlo, Consolas, 'DejaVu Sans Mono', monospace; font-size: .86em; }
details.rest > summary { margin-bottom: 12px; }
@media (max-width: 600px) { body { padding: 24px 14px 48px; font-size: 16px; } h1 { font-size: 27px; } h2 { font-size: 21px; margin-top: 44px; } dl.words { grid-template-columns: 1fr; } dl.words dd { margin-bottom: 8px; } figure { overflow-x: auto; } figure svg { min-width: 560px; } figure.narrow svg { min-width: 0; } }
@media print {
  @page { size: A4; margin: 13mm 15mm; }
  body { max-width: none; padding: 0; font-size: 9pt; line-height: 1.35; }
  h1 { font-size: 19pt; } h2 { font-size: 13pt; margin: 4mm 0 1mm; padding-top: 1.5mm; break-after: avoid; } h1 + .byline { margin-bottom: 3mm; } .verdicts { font-size: 8pt; } .question { font-size: 10pt; }
  p { margin-bottom: 2mm; max-width: none; } figure { margin: 2mm 0; } figure svg { max-height: 45mm; width: auto; max-width: 100%; margin-bottom: 2mm; }
  figure, tr, .note, section > p { break-inside: avoid; } h3, caption { break-after: avoid; } thead { display: table-header-group; }
  .fold:not(:has(details[open])) tr.more:not(:has(td:target)) { display: table-row; }
  details:not([open]), .fold details, .find, h2 .up, nav.contents, .behind, section > .question { display: none; }
  .scroll { overflow: visible; background: none; margin: 3mm 0; } .scroll caption { max-width: none; } table { font-size: 7pt; line-height: 1.25; } figcaption, caption { font-size: 8pt; line-height: 1.35; }
  th, td { padding: 2px 6px 2px 0; overflow-wrap: break-word; } th.n, td.n { white-space: normal; } td.claim { min-width: 0; width: 44%; } #answer td:first-child { min-width: 22mm; } #answer td > div:not(.lead) { display: inline; white-space: normal; } #answer td > div:not(.lead):not(:last-child)::after { content: '; '; } .advice, .badge { font-size: 7pt; } .badge { padding: 0 4px; } figure.narrow svg { max-height: 45mm; } #answer figure svg { max-height: 68mm; } #answer table { font-size: 6.3pt; } #answer caption { font-size: 7pt; } #answer td { padding: 1px 5px 1px 0; }
  .badge, .rejected { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  a { color: inherit; } dl.words, pre { font-size: 8pt; } h3 { font-size: 10pt; margin: 3mm 0 1mm; }
}
";
