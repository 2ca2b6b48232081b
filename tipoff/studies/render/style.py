"""The look of the page: one column, system fonts, no colour that carries meaning alone."""

CSS = """
:root { --ink: #24292f; --soft: #59636e; --rule: #d9dee3; --tint: #f5f7f9; --accent: #1d3461; }
* { box-sizing: border-box; }
body { margin: 0; color: var(--ink); background: #fff; \
font: 16px/1.55 system-ui, "Segoe UI", Roboto, "Liberation Sans", sans-serif; }
main, header { max-width: 1240px; margin: 0 auto; padding: 0 28px; }
header { padding-top: 40px; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 6px; letter-spacing: -0.01em; }
h2 { font-size: 21px; margin: 52px 0 12px; padding-top: 14px; border-top: 2px solid var(--accent); }
h3 { font-size: 16px; margin: 26px 0 8px; }
p { max-width: 78ch; margin: 8px 0; }
.lead { font-size: 18px; color: var(--soft); }
.caption { color: var(--soft); font-size: 14px; max-width: 92ch; }
nav { margin: 20px 0 0; font-size: 14px; }
nav a { margin-right: 14px; white-space: nowrap; }
a { color: var(--accent); }
code { font: 0.9em/1.4 ui-monospace, "SF Mono", Menlo, Consolas, monospace; \
background: var(--tint); padding: 1px 4px; border-radius: 3px; }
.wide { overflow-x: auto; margin: 12px 0; }
table { border-collapse: collapse; font-size: 14px; line-height: 1.4; }
th {
  text-align: left; vertical-align: bottom; font-weight: 600; border-bottom: 1.5px solid var(--ink);
  padding: 5px 12px 5px 6px;
}
td { vertical-align: top; border-bottom: 1px solid var(--rule); padding: 4px 12px 4px 6px; }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
table.dense { font-size: 13px; } .dense td:last-child { min-width: 190px; } \
.dense th { padding-right: 8px; } .dense td { padding-right: 8px; }
tbody tr:nth-child(even) { background: var(--tint); }
tr.good td:last-child::before { content: "\\2713\\00a0"; }
tr.bad td:last-child { font-weight: 600; }
tr.bad td:last-child::before { content: "\\2717\\00a0"; }
tr.doubt td:last-child { font-style: italic; }
.none { color: #9aa1a9; }
.small { color: var(--soft); font-size: 12px; }
.figures { display: flex; flex-wrap: wrap; gap: 14px; margin: 18px 0; }
.figures div { border: 1px solid var(--rule); border-radius: 6px; padding: 10px 16px; min-width: 150px; }
.figures b { display: block; font-size: 22px; font-variant-numeric: tabular-nums; }
.figures span { color: var(--soft); font-size: 13px; }
.notice { border-left: 4px solid #b4540a; background: #fdf6ee; padding: 8px 14px; margin: 12px 0; max-width: 92ch; }
.absent { border-left: 4px solid var(--rule); padding: 6px 14px; color: var(--soft); }
img { max-width: 100%; height: auto; }
details { margin: 10px 0; } summary { cursor: pointer; color: var(--accent); }
footer { max-width: 1240px; margin: 60px auto 40px; padding: 0 28px; color: var(--soft); font-size: 13px; }
@media print {
  body { font-size: 11pt; } main, header, footer { max-width: none; padding: 0; } nav { display: none; }
  h2 { break-after: avoid; } table, img, .plotly-graph-div { break-inside: avoid; }
}
"""
