// The page: what the server reports is shown, what the person does is asked for.

import { showBook } from './book.js';
import { drawLamp, drawRig, drawScale } from './drawing.js';
import { fitText } from './fit_text.js';
import { bindHandIn, showClass } from './hand_in.js';
import { bindKeys, bindKnobs, showKnobs } from './knobs.js';
import { Link } from './link.js';
import { MotionStore } from './motion_store.js';
import { $, colors, described, drawFrames, exposure, followColors, list, put, query, showPace, wall } from './page.js';
import { drawAngle, drawFit } from './plots.js';
import { bindPull } from './pull.js';
import { Saw } from './sound.js';
import { loadWords, say } from './words.js';

const store = new MotionStore();
const saw = new Saw();
const bench = { knobs: null, rig: null, fit: null, book: [], pulled: null, linked: false };

const now = () => store.now(wall());

function tell(text) {
  $('said').textContent = text;
  $('said').classList.remove('refused');
}

const shows = {
  knobs(report) {
    bench.knobs = report;
    showKnobs(report);
  },
  rig(report) {
    const another = bench.rig && bench.rig.sitting !== report.sitting; // a server that was started again
    bench.rig = report;
    if (another || report.run > store.run) store.forget(report.run);
    const rpm = report.threshold_rpm;
    put('threshold', rpm === null ? '' : say('Below {rpm} RPM an ideal rod cannot stand.', { rpm: rpm.toFixed(0) }));
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
    showBook(report.lines, (number) => ask('strike', number));
  },
  fit(report) {
    bench.fit = report;
    put('fit', fitText(report));
    drawFit($('fit-plot'), report, colors);
  },
  class: showClass,
  messages(report) {
    list('messages', report.messages);
  },
  refusal(report) {
    refuse(report.why);
  },
};

function refuse(why) {
  tell(why);
  $('said').classList.add('refused'); // seen wherever the page is scrolled to
  if (bench.knobs) showKnobs(bench.knobs);
}

function showBanner() {
  const { rig } = bench;
  let text = '';
  if (!bench.linked) text = say('The link to the bench is lost: it is tried again.');
  else if (rig && rig.failure) text = say('The rig broke down: {why}', { why: rig.failure });
  else if (rig && !rig.works) text = say('Another page works this bench: this one watches.');
  put('banner-text', text);
  $('banner').hidden = !text;
  $('repair').hidden = !(bench.linked && rig && rig.failure && rig.works);
}

function showStatus(time) {
  const { rig } = bench;
  if (!rig || !rig.run || !rig.runs) {
    if (!rig || !rig.failure) $('status').textContent = say('the nodes are starting …');
    return;
  }
  const values = { run: rig.run, time: time.toFixed(1), pace: rig.pace || '∞' };
  const text = say(rig.paused ? 'run {run} · {time} s · paused' : 'run {run} · {time} s · × {pace}', values);
  put('status', text);
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
  put('stopwatch', text);
}

function draw() {
  const time = now();
  drawRig($('rig'), bench.rig, colors, store, time, exposure(bench.rig.pace), bench.pulled);
  drawLamp($('lamp'), bench.rig, store, time, bench.knobs.dial > 0, say('the lamp is off'));
  drawScale($('scale'), bench.knobs.dial, bench.knobs.graduation, colors);
  showStatus(time);
  showWatch(time);
  if (bench.rig.plot_seen) drawAngle($('angle-plot'), store, time, colors);
  saw.follow(store, time, bench.rig);
}

function describe() {
  const seen = store.at(now());
  if (!seen || !bench.rig) return;
  tell(described(bench.rig.run, now(), seen));
}

followColors(() => drawFit($('fit-plot'), bench.fit, colors));
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
const ask = (name, value) => {
  if ($('said').classList.contains('refused')) tell('');
  link.ask(name, value);
};
bindKnobs(ask, now, bench, { describe, saw, refuse });
bindKeys(ask, now, bench, { describe });
bindPull($('rig'), ask, bench, () => store.at(now()));
bindHandIn(ask, refuse);
for (const id of ['describe', 'sound']) $(id).disabled = false; // the others wait for the first report
drawFrames(() => bench.rig && bench.knobs, () => [now(), bench.rig, bench.knobs, bench.pulled], draw);
