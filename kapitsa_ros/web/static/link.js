// The link to the server: taken up again when it is lost.

const AGAIN = 500; // ms

const randomName = () =>
  Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, '0')).join('');

export class Link {
  constructor(query, onText, onMotion, onState) {
    this.onText = onText;
    this.onMotion = onMotion;
    this.onState = onState;
    let key = sessionStorage.getItem('bench-key');
    if (!key) {
      key = randomName();
      sessionStorage.setItem('bench-key', key);
    }
    const asked = new URLSearchParams(query);
    asked.set('key', key);
    asked.set('load', randomName()); // a doubled tab has the same key
    asked.set('lang', document.documentElement.lang);
    this.address = `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/bench?${asked}`;
    this.open();
  }

  open() {
    this.socket = new WebSocket(this.address);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => this.onState(true, '');
    this.socket.onmessage = ({ data }) => (typeof data === 'string' ? this.onText(JSON.parse(data)) : this.onMotion(data));
    this.socket.onclose = ({ reason }) => {
      this.onState(false, reason);
      setTimeout(() => this.open(), AGAIN);
    };
  }

  ask(name, value) {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    this.socket.send(JSON.stringify(value === undefined ? { do: name } : { do: name, value }));
  }
}
