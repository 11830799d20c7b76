// Plots: the readings with the fitted line, the angle over the last seconds, and over a whole run.

import { prepare } from './drawing.js';
import { say } from './words.js';

const LEFT = 46;
const BOTTOM = 40;
const TOP = 10;
const RIGHT = 12;

function axes(pen, width, height, colors, xText, yText) {
  pen.strokeStyle = colors.line;
  pen.fillStyle = colors.faint;
  pen.lineWidth = 1;
  pen.font = '12px system-ui, sans-serif';
  pen.beginPath();
  pen.moveTo(LEFT, TOP);
  pen.lineTo(LEFT, height - BOTTOM);
  pen.lineTo(width - RIGHT, height - BOTTOM);
  pen.stroke();
  pen.textAlign = 'right';
  pen.fillText(xText, width - RIGHT, height - 4);
  pen.textAlign = 'left';
  pen.fillText(yText, LEFT + 6, TOP + 8);
}

// Round values from low to high, four to eight of them, with the digits that tell them apart.
export function ticks(low, high) {
  const rough = (high - low) / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => size >= 0.8 * rough);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const marks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) {
    marks.push({ value: i * step, text: (i * step).toFixed(decimals).replace('-', '−') });
  }
  return marks;
}

export function drawFit(canvas, fit, colors) {
  const { pen, width, height } = prepare(canvas);
  axes(pen, width, height, colors, say('ω², 10⁶ RPM²'), say('Ω², 10³ RPM²'));
  if (!fit || !fit.forcing_rpm) return;
  const points = fit.forcing_rpm.map((speed, i) => [speed ** 2 / 1e6, fit.slow_rpm[i] ** 2 / 1e3]);
  const ends = fit.interval_rpm.filter((end) => end !== null).map((end) => end ** 2 / 1e6);
  const crossing = fit.inverse_rpm === null ? fit.omega_crit_rpm : fit.inverse_rpm;
  const xs = [...points.map(([x]) => x), ...ends, fit.omega_crit_rpm ** 2 / 1e6, crossing ** 2 / 1e6];
  const low = 0.9 * Math.min(...xs);
  const high = 1.05 * Math.max(...xs);
  const top = 1.15 * Math.max(...points.map(([, y]) => y));
  const px = (x) => LEFT + ((x - low) / (high - low)) * (width - LEFT - RIGHT);
  const py = (y) => height - BOTTOM - (y / top) * (height - BOTTOM - TOP);
  pen.textAlign = 'center';
  pen.fillStyle = colors.faint;
  for (const { value, text } of ticks(low, high)) pen.fillText(text, px(value), height - BOTTOM + 20);
  pen.textAlign = 'right';
  for (const { value, text } of ticks(0, top)) pen.fillText(text, LEFT - 6, py(value) + 4);
  if (fit.slope !== null && fit.inverse_rpm !== null) {
    const line = (x) => fit.slope * (x - crossing ** 2 / 1e6) * 1e3;
    pen.strokeStyle = colors.accent;
    pen.lineWidth = 2;
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, TOP, width - LEFT - RIGHT, height - TOP - BOTTOM);
    pen.clip();
    pen.beginPath();
    pen.moveTo(px(crossing ** 2 / 1e6), py(0));
    pen.lineTo(px(high), py(line(high)));
    pen.stroke();
    pen.restore();
  }
  if (ends.length) { // the interval of the best estimate, on the axis; an end that is not there has no cap
    const [from, to] = fit.interval_rpm;
    const a = from === null ? LEFT : px(from ** 2 / 1e6);
    const b = to === null ? width - RIGHT : px(to ** 2 / 1e6);
    pen.fillStyle = colors.accent;
    pen.globalAlpha = 0.35;
    pen.fillRect(a, height - BOTTOM - 5, b - a, 10);
    pen.globalAlpha = 1;
  }
  pen.fillStyle = colors.accent;
  pen.fillRect(px(fit.omega_crit_rpm ** 2 / 1e6) - 2, height - BOTTOM - 9, 4, 18);
  pen.fillStyle = colors.ink;
  for (const [x, y] of points) {
    pen.beginPath();
    pen.arc(px(x), py(y), 4, 0, 2 * Math.PI);
    pen.fill();
  }
}

export function drawAngle(canvas, store, time, colors) {
  const { pen, width, height } = prepare(canvas);
  const span = 6;
  axes(pen, width, height, colors, 's', 'θ, rad');
  const count = Math.min(width, 600);
  const seen = [];
  for (let i = 0; i <= count; i++) {
    const at = time - span + (span * i) / count;
    seen.push(store.at(at)?.angle ?? null);
  }
  const reach = Math.max(0.05, ...seen.map((angle) => Math.abs(angle))) * 1.1;
  const px = (part) => LEFT + part * (width - LEFT - RIGHT);
  const py = (angle) => TOP + ((reach - angle) / (2 * reach)) * (height - TOP - BOTTOM);
  pen.textAlign = 'right';
  for (const { value, text } of ticks(-reach, reach)) pen.fillText(text, LEFT - 6, py(value) + 4);
  pen.textAlign = 'center';
  for (const { value, text } of ticks(-span, 0)) pen.fillText(text, px((value + span) / span), height - BOTTOM + 20);
  pen.strokeStyle = colors.accent;
  pen.lineWidth = 1.5;
  pen.beginPath();
  seen.forEach((angle, i) => {
    if (angle === null) return;
    const place = [px(i / count), py(angle)];
    if (i && seen[i - 1] !== null) pen.lineTo(...place);
    else pen.moveTo(...place);
  });
  pen.stroke();
}

// The range of the angle in each part of a run; what is missing is hatched.
export function drawOverview(canvas, run, colors) {
  const { pen, width, height } = prepare(canvas);
  const parts = run.range_rad;
  const reach = Math.max(0.05, ...parts.map((ends) => (ends ? Math.max(-ends[0], ends[1]) : 0)));
  const py = (angle) => height / 2 - (angle / reach) * (height / 2 - 2);
  const wide = width / Math.max(1, parts.length);
  parts.forEach((ends, i) => {
    pen.fillStyle = ends ? colors.accent : colors.line;
    if (ends) pen.fillRect(i * wide, py(ends[1]), Math.max(1, wide), Math.max(1, py(ends[0]) - py(ends[1])));
    else if (i % 2) pen.fillRect(i * wide, 0, Math.max(1, wide), height);
  });
}
