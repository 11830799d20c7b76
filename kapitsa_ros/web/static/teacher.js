// The teacher's page: who is where, and what was handed in.

import { $, put, query } from './page.js';
import { loadWords, say } from './words.js';

const EVERY = 2000; // ms

const states = () => ({
  free: say('free'), broken: say('broken'), starting: say('starting'), away: say('away'),
  asleep: say('asleep'), paused: say('paused'), 'at work': say('at work'),
});

const rpm = (value) => (value === null ? '' : String(Number(value.toPrecision(6))));

function show({ benches, join, code, coverage }) {
  $('join-link').href = join;
  put('join-link', join);
  put('code', code);
  const names = states();
  const rows = benches.map((bench) => {
    const row = document.createElement('tr');
    const held = bench.covered === null ? '' : say(bench.covered ? 'yes' : 'no');
    const interval = bench.low_rpm === null ? '' : `${rpm(bench.low_rpm)} … ${rpm(bench.high_rpm)}`;
    const texts = [
      bench.bench, bench.name || '', names[bench.state], bench.run || '', bench.run ? rpm(bench.speed_rpm) : '',
      bench.readings || '', rpm(bench.omega_crit_rpm), interval,
      bench.truth_rpm === null ? '' : bench.truth_rpm.toFixed(1), held,
      bench.width_rpm === null ? '' : String(Number(bench.width_rpm.toPrecision(4))),
    ];
    for (const text of texts) row.insertCell().textContent = String(text);
    const last = row.insertCell();
    if (bench.link) last.append(Object.assign(document.createElement('a'), { href: bench.link, textContent: say('link') }));
    return row;
  });
  document.querySelector('#benches tbody').replaceChildren(...rows);
  const values = { students: coverage.students, handed: coverage.handed_in, covered: coverage.covered, judged: coverage.judged };
  const texts = [say('{handed} of {students} have handed in.', values)];
  if (coverage.judged) {
    const [low, high] = coverage.share_range.map((end) => (100 * end).toFixed(0));
    const more = { low, high, width: coverage.median_width_percent.toFixed(1), deviation: coverage.median_deviation_percent.toFixed(1) };
    texts.push(
      say('{covered} of {judged} intervals hold the threshold of their rod (95 % range of that share: {low} to {high} %).', { ...values, ...more }),
      say('Median width {width} % of it; the median critical speed deviates by {deviation} %.', more),
    );
  }
  put('coverage', texts.join(' '));
}

async function look() {
  try {
    const answer = await fetch(`teacher.json${query}`);
    if (!answer.ok) throw new Error(await answer.text());
    show(await answer.json());
    $('banner').hidden = true;
  } catch {
    put('banner-text', say('The link to the class is lost: it is tried again.'));
    $('banner').hidden = false;
  }
  setTimeout(look, EVERY);
}

await loadWords(`?lang=${document.documentElement.lang}`);
for (const id of ['class-csv', 'books-csv', 'report']) $(id).href += query;
await look();
