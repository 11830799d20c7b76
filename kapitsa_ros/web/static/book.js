// The book as a table: lines are struck out, and never taken away.

import { say } from './words.js';

let shown = '';

export function showBook(lines, strike) {
  const state = JSON.stringify(lines);
  if (state === shown) return;
  shown = state;
  let number = 0;
  const rows = lines.map((line) => {
    const row = document.createElement('tr');
    if (line.note !== undefined) {
      const cell = row.insertCell();
      cell.colSpan = 6;
      cell.className = 'note';
      cell.textContent = line.note;
      return row;
    }
    number += 1;
    const own = number;
    const texts = [own, line.run, Number(line.forcing_rpm.toPrecision(6)), line.period_s.toFixed(3), line.swings];
    for (const text of texts) row.insertCell().textContent = String(text);
    const last = row.insertCell();
    if (line.struck) {
      row.className = 'struck';
      last.textContent = say('struck out');
    } else {
      const button = document.createElement('button');
      button.textContent = '✕';
      button.setAttribute('aria-label', say('strike out line {number}', { number: own }));
      button.addEventListener('click', () => strike(own));
      last.append(button);
    }
    return row;
  });
  document.querySelector('#book tbody').replaceChildren(...rows);
}
