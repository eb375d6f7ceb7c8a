// Line charts on a canvas, in the colours of the page.

const colour = (element, name) => getComputedStyle(element).getPropertyValue(name).trim();

// Returns round numbers between two bounds.
export function ticks(low, high, count) {
  const raw = (high - low) / count;
  const size = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * size).find((step) => step >= raw) ?? raw;
  const list = [];
  for (let tick = Math.ceil(low / step) * step; tick <= high + step * 1e-9; tick += step) list.push(Math.abs(tick) < step * 1e-9 ? 0 : tick);
  return list;
}

const label = (tick) => String(Number(tick.toPrecision(6))).replace("-", "−");

// Draws series of the form `{values, colour, dots, width, start}` with common axes. The labels below count values from
// `from`, times `step`.
export function plot(canvas, series, { from = 1, line = null, step = 1, unit = "" } = {}) {
  const ratio = devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  if (!width || !height) return;
  [canvas.width, canvas.height] = [width * ratio, height * ratio];
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  pen.font = "11px system-ui, sans-serif";
  // the axis ignores the lowest and the highest hundredth of each series, and the lowest and the highest twentieth of a
  // series in the background
  let [low, high] = [Infinity, -Infinity];
  for (const { values, background } of series) {
    const stride = Math.ceil(values.length / 4000);
    const sorted = values.filter((value, i) => i % stride === 0 && Number.isFinite(value)).sort((a, b) => a - b);
    if (!sorted.length) continue;
    const cut = sorted.length < 50 ? 0 : Math.floor(sorted.length / (background ? 20 : 100));
    [low, high] = [Math.min(low, sorted[cut]), Math.max(high, sorted[sorted.length - 1 - cut])];
  }
  if (low > high) return;
  if (line !== null) [low, high] = [Math.min(low, line), Math.max(high, line)];
  if (low === high) [low, high] = [low - 1, high + 1];
  const length = Math.max(2, ...series.map(({ values }) => values.length));
  const marks = ticks(low, high, Math.max(2, height / 45));
  const left = 10 + Math.max(...marks.map((tick) => pen.measureText(label(tick)).width));
  const [right, top, bottom] = [width - 6, 8, height - 20];
  const x = (i) => left + ((right - left) * i) / (length - 1);
  const y = (value) => bottom - ((bottom - top) * (value - low)) / (high - low);
  pen.strokeStyle = colour(canvas, "--line");
  pen.fillStyle = colour(canvas, "--quiet");
  pen.lineWidth = 1;
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const tick of marks) {
    pen.beginPath();
    pen.moveTo(left, Math.round(y(tick)) + 0.5);
    pen.lineTo(right, Math.round(y(tick)) + 0.5);
    pen.stroke();
    pen.fillText(label(tick), left - 5, y(tick));
  }
  pen.textAlign = "center";
  pen.textBaseline = "bottom";
  const whole = ticks(from, from + length - 1, Math.max(2, width / 90)).filter(Number.isInteger);
  for (const tick of whole) {
    const text = label(tick * step) + unit;
    pen.fillText(text, Math.min(Math.max(x(tick - from), left + 4), width - pen.measureText(text).width / 2), height - 2);
  }
  if (line !== null) {
    pen.strokeStyle = colour(canvas, "--good");
    pen.setLineDash([4, 4]);
    pen.beginPath();
    pen.moveTo(left, y(line));
    pen.lineTo(right, y(line));
    pen.stroke();
    pen.setLineDash([]);
  }
  pen.save();
  pen.beginPath();
  pen.rect(left, top - 4, right - left + 6, bottom - top + 8);
  pen.clip();
  for (const { values, colour: name, dots = false, width: thick = 1.75, background = false } of series) {
    pen.strokeStyle = pen.fillStyle = colour(canvas, name);
    pen.lineWidth = thick;
    pen.lineJoin = "round";
    pen.beginPath();
    let drawn = false;
    // if there are more values than pixel columns: the last value of each column, or for the background the least and
    // the greatest
    const every = Math.max(1, Math.floor(values.length / (right - left)));
    for (let i = 0; i < values.length; i += every) {
      const part = every > 1 ? values.slice(i, i + every).filter(Number.isFinite) : [values[i]];
      if (!part.length || !Number.isFinite(part[0])) continue;
      for (const value of every > 1 && background ? [Math.min(...part), Math.max(...part)] : part.slice(-1)) {
        if (drawn) pen.lineTo(x(i), y(value));
        else pen.moveTo(x(i), y(value));
        drawn = true;
      }
    }
    pen.stroke();
    if (dots && values.length <= 120) {
      for (let i = 0; i < values.length; i++) {
        if (!Number.isFinite(values[i])) continue;
        pen.beginPath();
        pen.arc(x(i), y(values[i]), 2.5, 0, 7);
        pen.fill();
      }
    }
  }
  pen.restore();
}

// Returns for each value the mean of the last `width` values.
export function smooth(values, width) {
  const means = new Array(values.length);
  let sum = 0;
  for (let i = 0; i < values.length; i++) {
    sum += values[i] - (i >= width ? values[i - width] : 0);
    means[i] = sum / Math.min(i + 1, width);
  }
  return means;
}
