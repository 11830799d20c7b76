// Sentences of the page in its language; those of the page itself are put in by the server.

let words = {};

export async function loadWords(query) {
  const answer = await fetch(`words.json${query}`);
  if (answer.ok) words = await answer.json();
}

// {name} in a sentence is filled with values.
export function say(english, values = {}) {
  const sentence = words[english] || english;
  return sentence.replace(/\{(\w+)\}/g, (_, name) => String(values[name]));
}
