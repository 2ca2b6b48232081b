// Curves over time: axes with units, the exit, the settled window, and thin curves of the run that the
// reader kept. They are drawn once for a run; the instant that is played is a line that moves over them.

const LEFT = 50, RIGHT = 10, TOP = 26, BOTTOM = 36; // margins of a chart

// Round numbers that divide a range into some four parts.
function ticks(low, high) {
  const rough = (high - low) / 4, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((item) => item * power >= rough) * power, found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step);
  return { step, found };
}

function limits(runs, columns, factor) {
  let low = Infinity, high = -Infinity;
  for (const run of runs) {
    for (const column of columns) {
      for (let i = 0; i < run.count; i++) {
        const value = factor * run.rows[i * run.width + column];
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
  }
  const room = 0.06 * (high - low) || Math.abs(high) || 1e-3;
  return [low - room, high + room];
}

// ``chart``: title, unit, columns, names and colours of the lines, factor from the column to the unit.
function drawChart(canvas, chart, run, kept, look) {
  const { pen, width, height } = sheet(canvas), runs = kept ? [run, kept] : [run];
  const end = endOf(run, kept), [low, high] = limits(runs, chart.columns, chart.factor);
  const left = LEFT, right = width - RIGHT, top = TOP, bottom = height - BOTTOM;
  const x = (value) => left + value / end * (right - left), y = (value) => bottom - (value - low) / (high - low) * (bottom - top);
  pen.font = "12px system-ui, sans-serif";
  if (run.answer.window_ms !== null) { // the window over which settled values are means
    pen.fillStyle = look.grid;
    pen.fillRect(x(run.answer.window_ms), top, x(Math.min(end, run.answer.window_ms + 2)) - x(run.answer.window_ms), bottom - top);
    rule(pen, x(run.answer.exit_ms), top, bottom, look.faint, [4, 3]);
  }
  grid(pen, { x, y, low, high, end, left, right, top, bottom }, look);
  heading(pen, chart, left, look);
  pen.fillStyle = look.text;
  pen.textAlign = "center";
  pen.fillText("time after ignition (ms)", (left + right) / 2, height - 9);
  pen.save();
  pen.beginPath();
  pen.rect(left, top, right - left, bottom - top);
  pen.clip();
  if (kept) chart.columns.forEach((column, i) => curve(pen, kept, column, chart.factor, x, y, look.axes[chart.colours[i]], 1, [3, 3]));
  chart.columns.forEach((column, i) => curve(pen, run, column, chart.factor, x, y, look.axes[chart.colours[i]], 1.8, []));
  pen.restore();
}

const endOf = (run, kept) => Math.max(run.end, kept ? kept.end : 0);

// Moves the line of the instant that is played.
function moveCursor(figure, run, kept, time) {
  const width = figure.clientWidth - LEFT - RIGHT;
  figure.lastChild.style.transform = `translateX(${LEFT + time / endOf(run, kept) * width}px)`;
}

function grid(pen, frame, look) {
  pen.textBaseline = "middle";
  pen.lineWidth = 1;
  const { step, found } = ticks(frame.low, frame.high), digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  for (const value of found) {
    pen.strokeStyle = Math.abs(value) < 1e-9 * step ? look.faint : look.grid;
    pen.beginPath();
    pen.moveTo(frame.left, frame.y(value));
    pen.lineTo(frame.right, frame.y(value));
    pen.stroke();
    pen.fillStyle = look.text;
    pen.textAlign = "right";
    pen.fillText((Math.abs(value) < 1e-9 * step ? 0 : value).toFixed(digits), frame.left - 6, frame.y(value));
  }
  pen.textAlign = "center";
  for (const value of ticks(0, frame.end).found) {
    pen.fillText(`${value}`, frame.x(value), frame.bottom + 11);
    rule(pen, frame.x(value), frame.bottom, frame.bottom + 4, look.faint, []);
  }
}

function heading(pen, chart, left, look) {
  pen.textAlign = "left";
  pen.fillStyle = look.text;
  pen.font = "600 12px system-ui, sans-serif";
  const title = `${chart.title} (${chart.unit})`;
  pen.fillText(title, 4, 12);
  let at = Math.max(left, 4 + pen.measureText(title).width + 14);
  chart.names.forEach((name, i) => {
    pen.fillStyle = look.axes[chart.colours[i]];
    pen.fillText(name, at, 12);
    at += pen.measureText(name).width + 12;
  });
  pen.font = "12px system-ui, sans-serif";
}

function curve(pen, run, column, factor, x, y, colour, width, dashes) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dashes);
  pen.beginPath();
  for (let i = 0; i < run.count; i++) pen.lineTo(x(run.rows[i * run.width]), y(factor * run.rows[i * run.width + column]));
  pen.stroke();
  pen.setLineDash([]);
}

function rule(pen, x, top, bottom, colour, dashes) {
  pen.strokeStyle = colour;
  pen.lineWidth = 1;
  pen.setLineDash(dashes);
  pen.beginPath();
  pen.moveTo(x, top);
  pen.lineTo(x, bottom);
  pen.stroke();
  pen.setLineDash([]);
}
