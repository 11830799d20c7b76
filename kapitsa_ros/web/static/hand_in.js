// What a student of a class is told, and hands in.

import { $, number, put } from './page.js';
import { say } from './words.js';

export function showClass(report) {
  $('class').hidden = false;
  put('told', say('{name}, bench {bench}: your rod is {length} mm long, by a ruler that errs by {error} mm; its stroke, friction, play and inertia are sealed.', {
    name: report.name, bench: report.bench,
    length: (1000 * report.told_length).toFixed(1), error: (1000 * report.ruler_error).toFixed(1),
  }));
  const [stroke, error] = report.told_stroke.map((each) => (1000 * each).toFixed(1));
  put('told-stroke', say('The fit of this page takes the stroke for {stroke} mm, give or take {error} mm (standard uncertainty).', { stroke, error }));
  if (!report.last) return;
  const [value, low, high] = report.last.map((speed) => String(Number(speed.toPrecision(6))));
  put('handed-in', say('Handed in: {value} RPM, {low} to {high} RPM (of {count} the last counts)', { count: report.handed_in, value, low, high }));
}

export function bindHandIn(ask, refuse) {
  $('hand-in').addEventListener('submit', (event) => {
    event.preventDefault();
    const [omega, low, high] = ['omega-crit', 'low', 'high'].map((id) => number($(id).value, refuse));
    if (![omega, low, high].includes(null)) ask('hand-in', { omega_crit_rpm: omega, low_rpm: low, high_rpm: high });
  });
}
