// The page of a replay: recorded runs, drawn as the bench draws what happens.

import { drawLamp, drawRig, drawScale } from './drawing.js';
import { fitText } from './fit_text.js';
import {
  $, colors, described, drawFrames, exposure, faster, followColors, list, number, put, query, showPace, slower, wall,
} from './page.js';
import { drawAngle, drawFit, drawOverview } from './plots.js';
import { RecordedMotion } from './recorded_motion.js';
import { Saw } from './sound.js';
import { loadWords, say } from './words.js';

const JUMP = 5; // s
const MOST_IMAGES = 9;
const saw = new Saw();
const replay = { runs: [], place: 0, motion: null, fit: null, dial: 0, pace: 1, loop: false };

function address(name, values = {}) {
  const asked = new URLSearchParams(query);
  for (const [key, value] of Object.entries(values)) asked.set(key, String(value));
  asked.set('lang', document.documentElement.lang);
  return `${name}?${asked}`;
}

function fail(text) {
  put('banner-text', text);
  $('banner').hidden = !text;
}

const run = () => replay.runs[replay.place];

function open(place, time, playing) {
  replay.place = Math.min(Math.max(place, 0), replay.runs.length - 1);
  replay.motion = new RecordedMotion((values) => address('motion', values), { ...run(), place: replay.place }, fail);
  replay.motion.dial = replay.dial;
  replay.motion.pace = replay.pace;
  replay.motion.playing = playing && run().step !== null;
  replay.motion.wall = wall();
  replay.motion.goTo(time);
  $('place').max = String(run().duration);
  $('run').value = String(replay.place);
  list('readings', run().readings);
  showPause();
  drawOverview($('overview'), run(), colors);
}

function showPause() {
  put('pause', say(replay.motion.playing ? 'Pause' : 'Go on'));
  $('pause').setAttribute('aria-pressed', String(!replay.motion.playing));
}

function pause() {
  const { motion } = replay;
  if (!motion.playing && motion.ended) motion.goTo(0);
  motion.playing = !motion.playing;
  showPause();
}

function move(seconds) {
  if (!run().step) return;
  if (Math.abs(seconds) < 1) {
    replay.motion.playing = false;
    showPause();
  }
  replay.motion.goTo(replay.motion.time + seconds);
}

function setPace(pace) {
  replay.pace = replay.motion.pace = Math.min(Math.max(pace, 1 / 8), 32);
  showPace(replay.pace);
}

function refuse(why) {
  put('said', why);
  $('dial').value = String(Number(replay.dial.toPrecision(6)));
}

function turnTo(text) {
  const dial = number(text, refuse);
  if (dial !== null) turn(Number(dial));
}

function turn(dial) {
  if (!Number.isFinite(dial)) {
    refuse(say('the dial of the lamp shows flashes a minute: give a number'));
    return;
  }
  put('said', '');
  replay.dial = Math.min(Math.max(dial, 0), run().dial_end);
  $('dial').value = String(Number(replay.dial.toPrecision(6)));
  replay.motion.turn(replay.dial);
  showForcing();
}

function showForcing() {
  const { graduation } = run();
  const images = Math.min(Math.max(Math.round(Number($('images').value)) || 1, 1), MOST_IMAGES);
  $('images').value = String(images);
  const reading = graduation ? Math.round(replay.dial / graduation) * graduation : replay.dial;
  put('forcing', String(Number((reading / images).toPrecision(6))));
}

function showRuns() {
  const rows = replay.runs.map((each) => {
    const row = document.createElement('tr');
    const state = [each.complete ? say('whole') : say('cut off'), each.fell ? say('fell') : '', each.unverified ? say('unverified') : ''];
    const texts = [
      each.name, each.duration.toFixed(1), each.speed_reading_rpm === null ? '' : Number(each.speed_reading_rpm.toPrecision(6)),
      each.period_s === null ? '' : each.period_s.toFixed(3), state.filter(Boolean).join(', '),
    ];
    for (const text of texts) row.insertCell().textContent = String(text);
    const parts = each.name.split('_').flatMap((part, i) => (i ? ['_', document.createElement('wbr'), part] : [part]));
    row.cells[0].replaceChildren(...parts); // on a narrow page a name may go on below
    return row;
  });
  document.querySelector('#runs tbody').replaceChildren(...rows);
  $('run').replaceChildren(...replay.runs.map((each, place) => new Option(each.name, String(place))));
}

async function loadFit() {
  const answer = await fetch(address('fit.json'));
  replay.fit = await answer.json();
  put('fit', fitText(replay.fit));
  drawFit($('fit-plot'), replay.fit, colors);
}

function asked(time) {
  let speed = 0;
  for (const [since, rpm] of run().asked_rpm) if (since <= time + 1e-9) speed = rpm;
  return speed;
}

function goOn() {
  const { motion } = replay;
  if (!motion.playing || !motion.ended) return;
  if (replay.place + 1 < replay.runs.length) open(replay.place + 1, 0, true);
  else if (replay.loop) open(0, 0, true);
  else pause();
}

function shown() {
  const { motion, dial, pace } = replay;
  return [motion.now(wall()), motion, motion.steps, motion.playing, dial, pace];
}

function draw() {
  const { motion } = replay;
  const { time } = motion;
  const values = { run: run().name, time: time.toFixed(1), end: run().duration.toFixed(1), rpm: asked(time).toFixed(0) };
  if (document.activeElement !== $('place') || motion.playing) $('place').value = String(time);
  $('place').setAttribute('aria-valuetext', `${time.toFixed(1)} s`);
  if (run().step && motion.isComing(time)) { // what was drawn stays: it is of another time
    put('status', say('{run} · {time} of {end} s · is being loaded …', values));
    return;
  }
  const missing = motion.isMissing(time) || !run().step;
  const rig = { ...run(), pace: replay.pace, paused: !motion.playing };
  drawRig($('rig'), rig, colors, missing ? { exposure: () => [] } : motion, time, motion.playing ? exposure(replay.pace) : 0, null);
  drawLamp($('lamp'), rig, motion, time, replay.dial > 0, say('the lamp is off'));
  drawScale($('scale'), replay.dial, run().graduation, colors);
  drawAngle($('angle-plot'), motion, time, colors);
  saw.follow(motion, time, rig);
  put('status', missing ? say('{run} · {time} of {end} s · nothing was recorded here', values)
    : say('{run} · {time} of {end} s · {rpm} RPM asked for', values));
  goOn();
}

function describe() {
  const { time } = replay.motion;
  const seen = replay.motion.at(time);
  put('said', seen ? described(run().number, time, seen) : $('status').textContent);
}

const keys = {
  ' ': pause,
  ArrowLeft: () => move(-run().step),
  ArrowRight: () => move(run().step),
  PageUp: () => move(-JUMP),
  PageDown: () => move(JUMP),
  Home: () => move(-run().duration),
  End: () => move(run().duration),
  '<': () => setPace(slower(replay.pace)),
  '>': () => replay.pace && setPace(faster(replay.pace)),
  n: () => open(replay.place + 1, 0, replay.motion.playing),
  b: () => open(replay.place - 1, 0, replay.motion.playing),
  v: describe,
};

function bind() {
  const on = (id, act) => $(id).addEventListener('click', (event) => {
    act();
    if (event.detail) $(id).blur(); // so that the space bar pauses again
  });
  on('pause', pause);
  on('back', () => move(-run().step));
  on('step', () => move(run().step));
  on('describe', describe);
  on('sound', () => $('sound').setAttribute('aria-pressed', String(saw.toggle())));
  $('pace').addEventListener('change', () => setPace(Number($('pace').value)));
  $('run').addEventListener('change', () => open(Number($('run').value), 0, replay.motion.playing));
  $('place').addEventListener('input', () => replay.motion.goTo(Number($('place').value)));
  $('dial').addEventListener('change', () => turnTo($('dial').value));
  $('images').addEventListener('change', showForcing);
  for (const button of document.querySelectorAll('[data-turn]')) {
    button.addEventListener('click', () => turn(replay.dial + Number(button.dataset.turn) * run().touch));
  }
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const target = event.target;
    if (event.key === 'Escape' && target.matches('input, select')) target.blur(); // so that the keys are the page's again
    if (target.matches('input, select, .scroll') || (event.key === ' ' && target.matches('button, a, summary'))) return;
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  for (const control of document.querySelectorAll(':disabled')) control.disabled = false;
}

followColors(() => {
  drawFit($('fit-plot'), replay.fit, colors);
  drawOverview($('overview'), run(), colors);
});
await loadWords(`?lang=${document.documentElement.lang}`);
const { runs, warnings, start, rate, paused, loop } = await (await fetch(address('runs.json'))).json();
Object.assign(replay, { runs, loop, pace: rate });
showRuns();
$('report').href = address('report.html');
list('warnings', [...warnings, ...new Set(runs.flatMap((each) => each.defects.map((defect) => `${each.name}: ${defect}`)))]);
let place = 0;
let within = start; // of all runs laid end to end
while (place + 1 < runs.length && within >= runs[place].duration) within -= runs[place++].duration;
open(place, within, !paused);
showPace(replay.pace);
bind();
new ResizeObserver(() => drawFit($('fit-plot'), replay.fit, colors)).observe($('fit-plot'));
new ResizeObserver(() => drawOverview($('overview'), run(), colors)).observe($('overview'));
drawFrames(() => true, shown, draw);
await loadFit();
