// What    The connection to kdray: JSON texts both ways, and frames (four bytes with the length of a JSON text, the text,
//         a picture). It is made again when it is lost.

const FIRST_WAIT = 500, LONGEST_WAIT = 8000;  // milliseconds
const NO_TOKEN = 4003;

export class Link {
  // receive(message, picture): called for each message; status(text): what is wrong, or nothing.
  constructor(token, receive, status) {
    this.token = token;
    this.receive = receive;
    this.status = status;
    this.wait = FIRST_WAIT;
    this.connect();
  }

  connect() {
    const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(`${scheme}//${location.host}/socket`);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => this.send({type: 'hello', token: this.token});
    socket.onmessage = (event) => this.received(event.data);
    socket.onclose = (event) => this.closed(event);
    this.socket = socket;
  }

  get open() { return this.socket.readyState === WebSocket.OPEN; }

  send(message) {
    if (this.open) this.socket.send(JSON.stringify(message));
  }

  received(data) {
    this.wait = FIRST_WAIT;
    this.status('');
    if (typeof data === 'string') return this.receive(JSON.parse(data), null);
    const n = new DataView(data).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, n)));
    this.receive(head, new Blob([new Uint8Array(data, 4 + n)], {type: head.mime}));
  }

  closed(event) {
    if (event.code === NO_TOKEN)
      return this.status('This page has no token, or an old one. Copy the whole address that kdray view has printed in its terminal, with what ' +
                         'follows #token=, and open that.');
    this.status(event.reason || 'kdray is not there any more, or the network is not. Trying again …');
    setTimeout(() => this.connect(), this.wait);
    this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
  }
}
