// The connection to the server: requests with replies, messages, automatic reconnection.

const WAITS = [300, 600, 1200, 2500, 5000]; // time before each attempt to connect again [ms]

export class Link {
  /**
   * `hear(message)` is called for each message of the server, and `change(connected)` when the
   * connection opens or ends. `opened` states whether it has ever opened.
   */
  constructor(token, hear, change) {
    Object.assign(this, { token, hear, change, opened: false, number: 0, waiting: new Map(), failed: 0 });
    this.connect();
  }

  /**
   * An address of the server, below the path of the page, with the token. A notebook's proxy also
   * serves the page without the slash at the end of its path.
   */
  address(path, more = {}) {
    const url = new URL(location.href);
    url.hash = "";
    url.pathname += url.pathname.endsWith("/") ? path : `/${path}`;
    url.search = new URLSearchParams({ token: this.token, ...more }).toString();
    return url;
  }

  connect() {
    const url = this.address("live");
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(url);
    this.socket = socket;
    socket.addEventListener("open", () => {
      this.failed = 0;
      this.opened = true;
      this.change(true);
    });
    socket.addEventListener("message", (event) => this.take(JSON.parse(event.data)));
    socket.addEventListener("close", () => this.lost());
  }

  lost() {
    for (const done of this.waiting.values()) done({ ok: false, error: "the connection was lost", hint: "" });
    this.waiting.clear();
    this.change(false);
    const wait = WAITS[Math.min(this.failed, WAITS.length - 1)];
    this.failed += 1;
    setTimeout(() => this.connect(), wait);
  }

  take(message) {
    if (!("re" in message)) {
      this.hear(message);
      return;
    }
    const done = this.waiting.get(message.re);
    this.waiting.delete(message.re);
    if (done) done(message);
  }

  /** Send a request; resolves to its reply {ok, error, hint}. */
  send(request) {
    if (this.socket.readyState !== WebSocket.OPEN) {
      return Promise.resolve({ ok: false, error: "there is no connection to kilter", hint: "the page tries to connect again" });
    }
    this.number += 1;
    const id = this.number;
    this.socket.send(JSON.stringify({ id, ...request }));
    return new Promise((done) => this.waiting.set(id, done));
  }
}
