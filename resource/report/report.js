// Sorts the tables of a report by a click on a heading, and draws its plots with uPlot. The texts of the plots come from
// the block of JSON, and uPlot sets them as text. A page without scripts shows all numbers in its tables.
"use strict";

// What a cell sorts as: a number, for a duration its seconds; null: missing; undefined: a text.
function numberIn(text) {
  if (text === "–" || text === "") return null;
  if (/^(\d+:)?\d+:\d\d\.\d$/.test(text)) return text.split(":").reduce((sum, part) => 60 * sum + Number(part), 0);
  return /^-?\d+(\.\d+)?%?$/.test(text) ? parseFloat(text) : undefined;
}

// Sort rows by a column: numbers by their size, others as texts, missing values last.
function sort(table, column, down) {
  const rows = [...table.tBodies[0].rows].map(row => {
    const text = row.cells[column].textContent.trim();
    return {row, text, number: numberIn(text)};
  });
  const numeric = rows.every(({number}) => number !== undefined);
  const order = new Intl.Collator("en", {numeric: true});
  rows.sort((a, b) => (a.number === null) - (b.number === null)
    || (down ? -1 : 1) * (numeric ? a.number - b.number : order.compare(a.text, b.text)));
  table.tBodies[0].append(...rows.map(({row}) => row));
}

for (const table of document.querySelectorAll("table.sorted")) {
  const headings = table.tHead.rows[0].cells;
  for (const heading of headings) {
    heading.tabIndex = 0;
    heading.setAttribute("role", "button");
    const click = () => {
      const down = heading.getAttribute("aria-sort") === "ascending";
      for (const other of headings) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", down ? "descending" : "ascending");
      sort(table, heading.cellIndex, down);
    };
    heading.addEventListener("click", click);
    heading.addEventListener("keydown", event => { if (event.key === "Enter") click(); });
  }
}

const COLOURS = ["#1b5faa", "#c2410c", "#15803d", "#7e22ce", "#b91c1c", "#0e7490", "#a16207", "#475569"];
const DASHES = [[], [8, 4], [2, 3]];
const LABEL_PX = 18, BESIDE_PX = 100;  // between two labels of the x axis, and of a plot's width beside that axis

// The places on the x axis whose labels do not overlap in a plot of this width.
function spaced(places, width) {
  const least = (places[places.length - 1] - places[0]) * LABEL_PX / (width - BESIDE_PX), shown = [];
  for (const x of places) if (!shown.length || x - shown[shown.length - 1] >= least) shown.push(x);
  return shown;
}

// A plot has `x` and `y` (what the axes show), `ticks` (place and text of each), `labels` (text of each point),
// `series` (their names), `data` (the places, then the values of each series), `bars`, `lines` (between the points), and
// `least` (the y axis reaches at least this).
for (const place of document.querySelectorAll("[data-plot]")) {
  const plot = JSON.parse(document.getElementById(place.dataset.plot).textContent);
  const texts = new Map(plot.ticks);
  const series = plot.series.map((name, i) => {
    const colour = COLOURS[i % COLOURS.length];
    return {
      label: name, stroke: colour, spanGaps: false, width: 2, points: {show: !plot.bars, size: 6, fill: colour},
      dash: DASHES[Math.floor(i / COLOURS.length) % DASHES.length], fill: plot.bars ? colour : undefined,
      paths: plot.bars ? uPlot.paths.bars({size: [0.7, 60]}) : plot.lines ? undefined : () => null,
      value: (_, y) => y == null ? "" : String(Math.round(100 * y) / 100),
    };
  });
  const axis = text => ({label: text, font: "12px sans-serif", labelFont: "12px sans-serif", labelSize: 22});
  const isLong = plot.ticks.some(([, text]) => text.length > 6);
  const size = () => ({width: Math.max(280, place.clientWidth), height: isLong ? 340 : 280});
  const shown = new uPlot({
    ...size(), padding: [null, isLong ? 70 : 16, null, null],
    series: [{label: plot.x, value: (self, x, _, i) => i == null ? "" : plot.labels[i]}, ...series],
    scales: {
      x: {time: false, range: plot.bars ? (_, low, high) => [low - 0.6, high + 0.6] : undefined},
      y: {range: (_, low, high) => [Math.min(0, low), Math.max(1.05 * high, plot.least)]},
    },
    axes: [{
      ...axis(plot.x), splits: self => spaced([...texts.keys()], self.width), values: (_, marks) => marks.map(x => texts.get(x)),
      ...(isLong ? {rotate: -40, size: 100} : {}),
    }, axis(plot.y)],
  }, plot.data, place);
  new ResizeObserver(() => shown.setSize(size())).observe(place);
}
