// Buttons, fields and keys, and what is asked for when they are used.

import { $, faster, number, put, slower } from './page.js';

const FIELDS = { speed: 'speed', dial: 'dial', release: 'angle', images: 'images', swings: 'swings' };
const WHOLE = new Set(['images', 'swings']);

export function showKnobs(knobs) {
  for (const [id, name] of Object.entries(FIELDS)) {
    const text = String(Number(knobs[name].toPrecision(6)));
    if (document.activeElement !== $(id) && $(id).value !== text) $(id).value = text;
  }
  put('dial-reading', knobs.dial_reading.toFixed(knobs.graduation ? 0 : 1));
  put('forcing', String(Number(knobs.forcing.toPrecision(6))));
  put('period', knobs.period === null ? '' : `→ ${knobs.period.toFixed(3)} s`);
}

export function bindKnobs(ask, now, bench, { describe, saw, refuse }) {
  for (const [id, name] of Object.entries(FIELDS)) {
    const send = () => {
      const text = number($(id).value, refuse);
      if (text) ask(name, WHOLE.has(name) && Number.isFinite(Number(text)) ? Number(text) : text);
    };
    $(id).addEventListener('change', send);
    $(id).addEventListener('blur', () => bench.knobs && showKnobs(bench.knobs)); // not what was refused
    $(id).addEventListener('keydown', (event) => {
      if (event.key === 'Enter') {
        send();
        if (id === 'release') ask('release');
      } else if (event.key === 'Escape') $(id).blur();
    });
  }
  const on = (id, act) => $(id).addEventListener('click', (event) => {
    act();
    if (event.detail) $(id).blur(); // so that the space bar is the stopwatch's again
  });
  for (const button of document.querySelectorAll('[data-speed]')) {
    button.addEventListener('click', () => changeSpeed(ask, bench, Number(button.dataset.speed)));
  }
  for (const button of document.querySelectorAll('[data-dial]')) {
    button.addEventListener('click', () => ask('dial', bench.knobs.dial + Number(button.dataset.dial)));
  }
  for (const button of document.querySelectorAll('[data-touch]')) {
    button.addEventListener('click', () => ask('touch', Number(button.dataset.touch)));
  }
  for (const button of document.querySelectorAll('#hands .row button')) {
    button.addEventListener('click', (event) => event.detail && button.blur());
  }
  on('let-go', () => ask('release'));
  on('clear', () => ask('clear'));
  on('write', () => ask('write'));
  on('pause', () => ask('pause'));
  on('step', () => ask('step'));
  on('next-run', () => ask('next-run'));
  on('repair', () => ask('repair'));
  on('look', () => ask('look'));
  on('rig-readings-button', () => ask('rig-readings'));
  on('describe', describe);
  on('sound', () => $('sound').setAttribute('aria-pressed', String(saw.toggle())));
  $('pace').addEventListener('change', () => ask('pace', Number($('pace').value)));
  // The watch is pressed when the button goes down; a click without a pointer is a key's or a screen reader's.
  $('stopwatch').addEventListener('pointerdown', (event) => event.button === 0 && ask('watch', now()));
  $('stopwatch').addEventListener('click', (event) => event.detail === 0 && ask('watch', now()));
}

function changeSpeed(ask, bench, change) {
  ask('speed', Math.min(Math.max(bench.knobs.speed + change, 0), bench.knobs.fastest));
}

export function bindKeys(ask, now, bench, { describe }) {
  const keys = {
    ArrowUp: () => changeSpeed(ask, bench, 10),
    ArrowDown: () => changeSpeed(ask, bench, -10),
    PageUp: () => changeSpeed(ask, bench, 100),
    PageDown: () => changeSpeed(ask, bench, -100),
    ArrowRight: () => ask('touch', 1),
    ArrowLeft: () => ask('touch', -1),
    ']': () => ask('dial', bench.knobs.dial + 100),
    '[': () => ask('dial', bench.knobs.dial - 100),
    r: () => ask('release'),
    c: () => ask('clear'),
    '+': () => ask('swings', bench.knobs.swings + 1),
    '=': () => ask('swings', bench.knobs.swings + 1),
    '-': () => ask('swings', bench.knobs.swings - 1),
    w: () => ask('write'),
    u: () => ask('strike', 0),
    p: () => ask('pause'),
    n: () => ask('step'),
    '<': () => ask('pace', slower(bench.rig.pace)),
    '>': () => bench.rig.pace && ask('pace', faster(bench.rig.pace)),
    x: () => ask('next-run'),
    v: describe,
  };
  for (const count of [1, 2, 3, 4, 5]) keys[count] = () => ask('images', count);
  const once = new Set(['r', 'c', 'w', 'u', 'p', 'x', 'v']); // however long the key is held
  document.addEventListener('keydown', (event) => {
    if (!$('keys').checked || event.ctrlKey || event.altKey || event.metaKey || !bench.knobs || !bench.rig) return;
    const target = event.target;
    if (target.matches('input:not([type="checkbox"]), select, textarea')) return;
    if (event.key === ' ') {
      if (target.matches('button, a, summary, input')) return; // it presses these
      event.preventDefault();
      if (!event.repeat) ask('watch', now());
      return;
    }
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act || (event.key.startsWith('Arrow') && target.closest('.scroll'))) return;
    event.preventDefault();
    if (!event.repeat || !once.has(event.key.toLowerCase())) act();
  });
}
