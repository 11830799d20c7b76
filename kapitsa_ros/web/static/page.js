// What every page with a picture needs.

import { color } from './drawing.js';
import { say } from './words.js';

const EXPOSURE = 1 / 30; // s of wall time that an eye, and a frame, takes together
const STILL = 250; // ms between two pictures for those who want less motion
const PACES = [0.125, 0.25, 0.5, 1, 2, 4, 8, 16, 32];

export const $ = (id) => document.getElementById(id);
export const wall = () => performance.now() / 1000;
export const query = location.search;
export const colors = {};
const less = matchMedia('(prefers-reduced-motion: reduce)');

let stale = true;

// Draw the next frame whatever has changed or has not.
export function redraw() {
  stale = true;
}

// Read the colours of the page, now and whenever they change; `drawPlots` draws what is in no frame.
export function followColors(drawPlots) {
  const read = () => {
    for (const name of ['ink', 'faint', 'line', 'accent', 'rod', 'metal']) colors[name] = color(`--${name}`);
  };
  read();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    read();
    redraw();
    drawPlots();
  });
}

// Seconds of the run that are seen together at a pace; 0: as fast as it can, which nobody knows beforehand.
export function exposure(pace) {
  return (less.matches ? STILL / 1000 : EXPOSURE) * (pace || 1);
}

// The next pace; the slowest and the fastest are the server's to say.
export const slower = (pace) => (pace === 0 ? PACES.at(-1) : pace / 2);
export const faster = (pace) => 2 * pace;

// What was typed, with a point for the comma that other languages write; null where a point may stand for thousands
// there, which `refuse` is told.
export function number(text, refuse) {
  const typed = text.trim();
  if (document.documentElement.lang === 'en') return typed;
  if (/^[1-9]\d{0,2}\.\d{3}$/.test(typed)) {
    const values = { typed, whole: typed.replace('.', ''), decimal: typed.replace('.', ',') };
    refuse(say('{typed} may mean either of two numbers: write {whole} or {decimal}', values));
    return null;
  }
  return typed.replace(/^([^.,]*),([^.,]*)$/, '$1.$2');
}

// Draw as often as the display shows it, or now and then for those who want less motion, where one of the values of
// `shown` is another than in the last frame: a page on which nothing moves leaves the processor to the rig.
export function drawFrames(ready, shown, draw) {
  let drawn = 0;
  let frames = 0;
  let last = [];
  const observer = new ResizeObserver(redraw); // a canvas of another size is empty
  for (const canvas of document.querySelectorAll('canvas')) observer.observe(canvas);
  const frame = (stamp) => {
    requestAnimationFrame(frame);
    if (!ready() || (less.matches && stamp - drawn < STILL)) return;
    const values = [window.devicePixelRatio, ...shown()];
    if (!stale && values.every((value, i) => value === last[i])) return;
    stale = false;
    last = values;
    drawn = stamp;
    draw();
    frames += 1;
    document.documentElement.dataset.frames = String(frames);
  };
  requestAnimationFrame(frame);
}

export function list(id, texts) {
  const shown = Array.from($(id).children, (item) => item.textContent);
  if (shown.join('\n') === texts.join('\n')) return;
  $(id).replaceChildren(...texts.map((text) => Object.assign(document.createElement('li'), { textContent: text })));
}

export function put(id, text) {
  if ($(id).textContent !== text) $(id).textContent = text;
}

export function showPace(pace) {
  const select = $('pace');
  const values = PACES.includes(pace) ? PACES : [pace, ...PACES];
  if (values.join() !== Array.from(select.options, (option) => option.value).join()) {
    select.replaceChildren(...values.map((value) => new Option(value ? `× ${value}` : '∞', String(value))));
  }
  if (document.activeElement !== select) select.value = String(pace);
}

const LYING = 1.5; // rad

// What is seen at a time of a run, in words.
export function described(run, time, seen) {
  const values = { run, time: time.toFixed(1), angle: seen.angle.toFixed(2) };
  const lies = Math.abs(seen.angle) > LYING;
  return say(lies ? 'run {run}, {time} s: the rod lies' : 'run {run}, {time} s: the rod is at {angle} rad', values);
}
