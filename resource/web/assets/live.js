// Live data of the gateway: its documents, the box's clock, and whether both are current (docs/web.md, "Live data").

const RECONNECT_MS = 1000;
// The gateway sends the clock each second.
const SILENT_S = 3.5;
// A connection that is not made by then is tried again: the system would try it less and less often.
const CONNECT_S = 5;
// How much slower than ours the box's clock may run.
const DRIFT = 2e-4;

export const seconds = () => performance.now() / 1000;

// Estimates the box's clock: the message with the least delay gives the best estimate (box_clock.py does the same).
export class BoxClock {
  sample(now, clock) {
    const offset = clock - now;
    const isFirst = this.offset === undefined || clock < this.lastClock;
    this.offset = isFirst ? offset : Math.max(offset, this.offset - DRIFT * (now - this.lastNow));
    this.lastClock = clock;
    this.lastNow = now;
  }

  at(now) {
    return this.offset === undefined ? null : now + this.offset;
  }
}

// `onChange` is called when something on the page may change, with the names of the documents that came; none: the data
// became old or current again. `path` and `query` name the documents. `known`: those of before, which are old.
export class Live {
  constructor(path, query, onChange, silentS = SILENT_S, known = null) {
    this.silentS = silentS;
    this.data = known || {};  // document by name
    this.missed = 0;  // changes that were replaced by later ones before they came
    this.clock = new BoxClock();
    this.silentSince = known ? 0 : null;  // the box's clock at the last sign of life, while the data is old; 0: not known
    this.said = 0;  // what the gateway said of the box's clock last
    this.onChange = onChange;
    this.numbers = {};
    this.heardAt = -Infinity;
    this.openedAt = -Infinity;  // when the newest connection was opened
    this.isHeard = false;
    this.path = path;
    this.setQuery(query);
    this.connect();
    this.timer = setInterval(() => this.watch(), 250);
  }

  setQuery(query) {
    this.address = `${location.protocol === "https:" ? "wss:" : "ws:"}//${location.host}/api/v1/${this.path}?${
      new URLSearchParams(query)}`;
  }

  // Ask for something else, with a new connection. One that is being opened is not given up: browsers then let the next
  // ones wait for seconds.
  reopen(query) {
    this.setQuery(query);
    if (this.socket && this.socket.readyState === WebSocket.CONNECTING) {
      this.socket.onopen = () => this.replace();
    } else {
      this.replace();
    }
  }

  // What is known may be of before a sleep: it is old until a new connection says that it is not.
  wake() {
    this.heardAt = -Infinity;
    this.replace();
    this.watch();
  }

  replace() {
    const old = this.socket;
    this.connect();
    if (old) {
      old.close();
    }
  }

  connect() {
    const opening = new WebSocket(this.address);
    this.socket = opening;
    this.startedAt = seconds();
    opening.onopen = () => {
      this.openedAt = seconds();
    };
    opening.onmessage = (event) => {
      if (this.socket === opening) {
        this.receive(JSON.parse(event.data));
      }
    };
    opening.onclose = () => this.reconnect(opening);
  }

  close() {
    clearInterval(this.timer);
    const closing = this.socket;
    this.socket = null;
    this.isClosed = true;
    if (closing) {
      closing.close();
    }
  }

  reconnect(socket) {
    if (this.socket === socket) {
      this.socket = null;
      socket.close();
      // Not all pages of a hall at the same moment.
      setTimeout(() => this.isClosed || this.socket || this.connect(), RECONNECT_MS * (1 + Math.random()));
      this.watch();
    }
  }

  receive(message) {
    const now = seconds();
    this.heardAt = now;
    this.isHeard = message.heard;
    this.said = message.clock || 0;
    if (message.heard) {
      this.clock.sample(now, message.clock);
    }
    if (message.type === "clock") {
      // A change was lost: begin again with a snapshot.
      if (Object.entries(message.numbers).some(([name, number]) => this.numbers[name] !== number)) {
        this.reconnect(this.socket);
      }
    } else {
      for (const [name, document] of Object.entries(message.documents)) {
        if (message.type === "change" && document.number !== this.numbers[name] + 1) {
          this.missed += 1;
        }
        this.numbers[name] = document.number;
        this.data[name] = document.data;
      }
    }
    this.watch(message.type === "clock" ? null : Object.keys(message.documents));
  }

  // Notice silence: of the gateway, or of the box behind it. A lost connection sends nothing. `changed`: what came.
  watch(changed = null) {
    const now = seconds();
    const gatewayIsSilent = now - this.heardAt > this.silentS;
    // On a slow network, the first message comes long after the connection.
    const hasHadTime = now - Math.max(this.heardAt, this.openedAt) > this.silentS;
    const {readyState} = this.socket || {};
    const isStuck = readyState === WebSocket.CONNECTING && now - this.startedAt > CONNECT_S;
    if (this.socket && (isStuck || (hasHadTime && readyState === WebSocket.OPEN))) {
      this.reconnect(this.socket);
    }
    const isSilent = gatewayIsSilent || !this.isHeard || !this.socket;
    if (isSilent && this.silentSince === null) {
      // A page that was opened in a silence has never heard the box's clock.
      this.silentSince = this.clock.at(Math.min(now, this.lastSign())) || this.said;
      changed = [];
    } else if (!isSilent && this.silentSince !== null) {
      this.silentSince = null;
      changed = [];
    }
    if (changed !== null) {
      this.onChange(changed);
    }
  }

  lastSign() {
    return this.clock.lastNow === undefined ? Infinity : this.clock.lastNow;
  }

  // The box's clock in UTC seconds. It is stopped while the data is old.
  now() {
    return this.silentSince === null ? this.clock.at(seconds()) : this.silentSince;
  }
}
