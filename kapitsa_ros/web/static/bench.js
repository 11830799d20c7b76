// The page: what the server reports is shown, what the person does is asked for.

import { showBook } from './book.js';
import { color, drawLamp, drawRig, drawScale } from './drawing.js';
import { bindKeys, bindKnobs, showKnobs } from './knobs.js';
import { Link } from './link.js';
import { MotionStore } from './motion_store.js';
import { drawAngle, drawFit } from './plots.js';
import { bindPull } from './pull.js';
import { Saw } from './sound.js';
import { loadWords, say } from './words.js';

const EXPOSURE = 1 / 30; // s of wall time that an eye, and a frame, takes together
const LYING = 1.5; // rad
const STILL = 250; // ms between two pictures for those who want less motion

const $ = (id) => document.getElementById(id);
const store = new MotionStore();
const saw = new Saw();
const bench = { knobs: null, rig: null, fit: null, book: [], pulled: null, linked: false, frames: 0 };
const less = matchMedia('(prefers-reduced-motion: reduce)');
const query = location.search;
let colors = {};

function readColors() {
  for (const name of ['ink', 'faint', 'line', 'accent', 'rod', 'metal']) colors[name] = color(`--${name}`);
}

const wall = () => performance.now() / 1000;
const now = () => store.now(wall());

function tell(text) {
  $('said').textContent = text;
}

const shows = {
  knobs(report) {
    bench.knobs = report;
    showKnobs(report);
  },
  rig(report) {
    bench.rig = report;
    if (report.run > store.run) store.forget(report.run);
    store.setPace(report.pace, report.paused);
    $('hands').disabled = !report.works || report.failure !== null;
    for (const id of ['pause', 'step', 'pace', 'next-run', 'look', 'rig-readings-button']) $(id).disabled = !report.works;
    $('step').disabled = !report.works || !report.paused;
    $('pause').textContent = say(report.paused ? 'Go on' : 'Pause');
    $('pause').setAttribute('aria-pressed', String(report.paused));
    showPace(report.pace);
    $('look').setAttribute('aria-pressed', String(report.plot_seen));
    $('angle-plot').hidden = !report.plot_seen;
    $('rig-readings-button').setAttribute('aria-pressed', String(report.rig_readings_seen));
    list('rig-readings', report.rig_readings);
    showBanner();
  },
  book(report) {
    bench.book = report.lines;
    showBook(report.lines, (number) => link.ask('strike', number));
  },
  fit(report) {
    bench.fit = report;
    const { omega_crit_rpm: speed, interval_rpm: ends, decimals } = report;
    if (speed === undefined) $('fit').textContent = report.why;
    else {
      const [low, high] = ends.map((end) => (end === null ? say('unbounded') : end.toFixed(decimals)));
      $('fit').textContent = [
        say('ω_crit = {speed} RPM, 95 % interval {low} to {high} RPM', { speed: speed.toFixed(decimals), low, high }),
        ...(report.inverse_rpm === null ? [] : [say('the line alone: {speed} RPM', { speed: report.inverse_rpm.toFixed(1) })]),
        ...report.warnings,
      ].join('; ');
    }
    drawFit($('fit-plot'), report, colors);
  },
  messages(report) {
    list('messages', report.messages);
  },
  refusal(report) {
    tell(report.why);
  },
};

function list(id, texts) {
  const shown = Array.from($(id).children, (item) => item.textContent);
  if (shown.join('\n') === texts.join('\n')) return;
  $(id).replaceChildren(...texts.map((text) => Object.assign(document.createElement('li'), { textContent: text })));
}

function showBanner() {
  const { rig } = bench;
  let text = '';
  if (!bench.linked) text = say('The link to the bench is lost: it is tried again.');
  else if (rig && rig.failure) text = say('The rig broke down: {why}', { why: rig.failure });
  else if (rig && !rig.works) text = say('Another page works this bench: this one watches.');
  if ($('banner-text').textContent !== text) $('banner-text').textContent = text;
  $('banner').hidden = !text;
  $('repair').hidden = !(bench.linked && rig && rig.failure && rig.works);
}

const PACES = [0.125, 0.25, 0.5, 1, 2, 4, 8, 16, 32];

function showPace(pace) {
  const select = $('pace');
  const values = PACES.includes(pace) ? PACES : [pace, ...PACES];
  if (select.options.length !== values.length) {
    select.replaceChildren(...values.map((value) => new Option(value ? `× ${value}` : '∞', String(value))));
  }
  if (document.activeElement !== select) select.value = String(pace);
}

function showStatus(time) {
  const { rig } = bench;
  if (!rig || !rig.run || !rig.runs) {
    if (!rig || !rig.failure) $('status').textContent = say('the nodes are starting …');
    return;
  }
  const values = { run: rig.run, time: time.toFixed(1), pace: rig.pace || '∞' };
  const text = say(rig.paused ? 'run {run} · {time} s · paused' : 'run {run} · {time} s · × {pace}', values);
  if ($('status').textContent !== text) $('status').textContent = text;
}

function showWatch(time) {
  const { knobs } = bench;
  const digits = knobs.watch_digit > 0 ? Math.max(0, Math.round(-Math.log10(knobs.watch_digit))) : 3;
  let shown = knobs.watch_shown;
  if (knobs.watch_started !== null) {
    shown = Math.max(0, (time - knobs.watch_started) * knobs.watch_gain);
    if (knobs.watch_digit > 0) shown = Math.floor(shown / knobs.watch_digit) * knobs.watch_digit;
  }
  const text = shown.toFixed(digits);
  if ($('stopwatch').textContent !== text) $('stopwatch').textContent = text;
}

let drawn = 0;

function frame(stamp) {
  requestAnimationFrame(frame);
  if (!bench.rig || !bench.knobs || (less.matches && stamp - drawn < STILL)) return;
  drawn = stamp;
  const time = now();
  const exposure = (less.matches ? STILL / 1000 : EXPOSURE) * Math.max(bench.rig.pace, 0.001);
  drawRig($('rig'), bench.rig, colors, store, time, exposure, bench.pulled);
  drawLamp($('lamp'), bench.rig, store, time, bench.knobs.dial > 0, say('the lamp is off'));
  drawScale($('scale'), bench.knobs.dial, bench.knobs.graduation, colors);
  showStatus(time);
  showWatch(time);
  if (bench.rig.plot_seen) drawAngle($('angle-plot'), store, time, colors);
  saw.follow(store, time, bench.rig);
  bench.frames += 1;
  document.documentElement.dataset.frames = String(bench.frames);
}

function describe() {
  const seen = store.at(now());
  if (!seen || !bench.rig) return;
  const values = { run: bench.rig.run, time: now().toFixed(1), angle: seen.angle.toFixed(2) };
  const lies = Math.abs(seen.angle) > LYING;
  tell(say(lies ? 'run {run}, {time} s: the rod lies' : 'run {run}, {time} s: the rod is at {angle} rad', values));
}

readColors();
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
  readColors();
  drawFit($('fit-plot'), bench.fit, colors);
});
new ResizeObserver(() => drawFit($('fit-plot'), bench.fit, colors)).observe($('fit-plot'));
$('csv').href = `book.csv${query}`;
await loadWords(`?lang=${document.documentElement.lang}`);
const link = new Link(
  query,
  (report) => shows[report.kind](report),
  (buffer) => store.add(buffer, wall()),
  (linked, reason) => {
    bench.linked = linked;
    showBanner();
    if (reason) tell(reason);
  },
);
const ask = (name, value) => link.ask(name, value);
bindKnobs(ask, now, bench, { describe, saw });
bindKeys(ask, now, bench, { describe });
bindPull($('rig'), ask, bench);
requestAnimationFrame(frame);
