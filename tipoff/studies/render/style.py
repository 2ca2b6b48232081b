"""The style of the page: one column, system fonts; colour is never the only sign of a meaning."""

from tipoff.studies.render import palette

_PAGE = """
:root { color-scheme: light dark; --ink: #24292f; --soft: #59636e; --rule: #d9dee3; --tint: #f5f7f9; \
--accent: #1d3461; --paper: #fff; --warn: #fdf6ee; --good: #1a7f37; --bad: #b42318; }
@media screen and (prefers-color-scheme: dark) {
  :root { --ink: #e6e8eb; --soft: #a3adb8; --rule: #39424c; --tint: #1d242c; --accent: #9db8ea; \
--paper: #13181e; --warn: #2b2115; --good: #4ac26b; --bad: #ff8a80; }
  main p > img { background: #fff; border-radius: 6px; }
}
html { scroll-padding-top: 84px; }
* { box-sizing: border-box; }
body { margin: 0; color: var(--ink); background: var(--paper); \
font: 16px/1.55 system-ui, "Segoe UI", Roboto, "Liberation Sans", sans-serif; }
main, header { max-width: 1440px; margin: 0 auto; padding: 0 28px; }
header { padding-top: 26px; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 6px; letter-spacing: -0.01em; }
h2 { font-size: 21px; margin: 52px 0 12px; padding-top: 14px; border-top: 2px solid var(--accent); }
h3 { font-size: 16px; margin: 22px 0 8px; }
main > section:first-child > h2 { margin-top: 20px; border: 0; padding: 0; }
main > h2.part + section > h2 { margin-top: 20px; }
p { max-width: 78ch; margin: 8px 0; } li { max-width: 120ch; }
.lead { font-size: 18px; color: var(--soft); }
.caption { color: var(--soft); font-size: 14px; max-width: 92ch; }
nav { position: sticky; top: 0; z-index: 5; background: var(--paper); border-bottom: 1px solid var(--rule); \
font-size: 13px; padding: 6px max(28px, calc((100% - 1384px) / 2)); max-height: 30vh; overflow-y: auto; }
nav b { color: var(--soft); font-weight: 600; margin-right: 10px; }
nav span { display: inline-block; margin-right: 18px; }
nav a { margin-right: 10px; white-space: nowrap; }
h2.part { font-size: 26px; border: 0; margin: 64px 0 0; padding: 0; color: var(--accent); }
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
table.judged td:last-child, table.judged th:last-child { position: sticky; right: 0; background: var(--paper); \
box-shadow: -1px 0 0 var(--rule); }
table.judged tbody tr:nth-child(even) td:last-child { background: var(--tint); }
tr.good td:last-child::before { color: var(--good); content: "\\2713\\00a0"; }
tr.bad td:last-child, tr.best td { font-weight: 600; }
tr.bad td:last-child::before { color: var(--bad); content: "\\2717\\00a0"; }
tr.doubt td:last-child { font-style: italic; }
.none { color: #9aa1a9; }
.small { color: var(--soft); font-size: 12px; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(180px, 1fr)); gap: 12px; margin: 14px 0; }
.figures div { border: 1px solid var(--rule); border-radius: 6px; padding: 8px 14px; }
.figures b { display: block; font-size: 20px; line-height: 1.25; font-variant-numeric: tabular-nums; }
.figures span { display: block; color: var(--soft); font-size: 13px; line-height: 1.4; }
.notice { border-left: 4px solid #b4540a; background: var(--warn); padding: 8px 14px; margin: 12px 0; max-width: 92ch; }
.absent { border-left: 4px solid var(--rule); padding: 6px 14px; color: var(--soft); }
img, svg.picture { max-width: 100%; height: auto; } svg.picture { fill: currentColor; }
details { margin: 10px 0; } summary { cursor: pointer; color: var(--accent); }
footer { max-width: 1240px; margin: 60px auto 40px; padding: 0 28px; color: var(--soft); font-size: 13px; }
.drawing { display: flex; flex-wrap: wrap; gap: 14px; }
.drawing svg { flex: 1 1 440px; min-width: 0; max-width: 640px; }
.drawing text { fill: var(--ink); font-size: 13px; }
.drawing .payload { fill: var(--tint); stroke: var(--soft); } .drawing .rail { fill: var(--soft); }
.drawing .mount { fill: var(--ink); } .drawing .pad { fill: #e8a33d; stroke: #8c6d46; stroke-width: .6; }
.drawing line, .drawing path { fill: none; stroke-width: 1.6; stroke: var(--accent); }
.drawing .dot { fill: var(--ink); stroke: none; } .drawing path.payload { stroke: var(--soft); }
.drawing path.tip { fill: context-stroke; stroke: none; }
.drawing .thrust { stroke: #d1495b; stroke-width: 3; } .drawing .tilt { stroke: #d1495b; stroke-width: 2.4; }
.drawing .shift { stroke: #2e8b7a; stroke-width: 2.4; stroke-dasharray: 5 3; }
@media (max-width: 700px) {
  main, header { padding: 0 14px; } header { padding-top: 20px; } h1 { font-size: 24px; }
  nav { padding: 6px 14px; max-height: 98px; } .figures { display: block; } .figures div { margin: 8px 0; }
  .drawing { display: block; }
  table.judged td:last-child, table.judged th:last-child { position: static; box-shadow: none; }
}
@page { size: A4 landscape; margin: 12mm; }
@media print {
  :root { --ink: #000; --soft: #444; --rule: #bbb; --tint: #f2f2f2; --accent: #1d3461; --paper: #fff; --warn: #fff; }
  body { font-size: 10pt; } main, header, footer { max-width: none; padding: 0; } nav { display: none; }
  img, svg.picture { max-height: 145mm; width: auto; }  /* with its heading on one page */
  h2, h3 { break-after: avoid; } tr, img, svg.picture, .drawing, .figures { break-inside: avoid; }
  .wide { overflow: visible; } table { width: 100%; font-size: 8pt; } table.dense { font-size: 6.5pt; }
  th, td, table.dense th, table.dense td { padding: 2px 4px 2px 2px; }
  details td.number { white-space: normal; overflow-wrap: anywhere; } .dense td:last-child { min-width: 0; }
  table.judged td:last-child, table.judged th:last-child { position: static; box-shadow: none; }
}
"""
CSS = palette.css() + _PAGE
