// Joining a class: by its code and a name; the way back to one's own bench is kept in this browser.

import { $, put, query } from './page.js';
import { loadWords, say } from './words.js';

const KEPT = 'kapitsa-bench';
await loadWords(`?lang=${document.documentElement.lang}`);
$('code').value = new URLSearchParams(query).get('join') || '';
const kept = localStorage.getItem(KEPT);
if (kept) {
  $('back').href = kept;
  $('again').hidden = false;
}
$('form').addEventListener('submit', async (event) => {
  event.preventDefault();
  try {
    const body = JSON.stringify({ code: $('code').value, name: $('name').value });
    const answer = await fetch(`join?lang=${document.documentElement.lang}`, { method: 'POST', body });
    const { link, why } = await answer.json();
    if (!answer.ok) {
      put('said', why);
      return;
    }
    const language = new URLSearchParams(query).get('lang');
    const address = language ? `${link}&lang=${encodeURIComponent(language)}` : link;
    localStorage.setItem(KEPT, address);
    location.assign(address);
  } catch {
    put('said', say('the server of the class does not answer'));
  }
});
